// SPDX-License-Identifier: MIT
// A part of the proofs: does a body of few or many planes meet every segment between two others?
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <shaft.hpp>

using namespace crofton;
using pvs::Blocker;
using pvs::Corners;

namespace {

constexpr double kMargin = 1e-6;

// How deep a segment passes inside of all planes. The depth is concave along it: each third that is left out holds no
// more than what is kept.
double depth_in(const Blocker& body, const glm::dvec3& p, const glm::dvec3& q) {
    const auto depth = [&](double t) {
        double least = std::numeric_limits<double>::infinity();
        for (const Plane& plane : body.planes)
            least = std::min(least, glm::dot(plane.normal, p + t * (q - p)) + plane.offset);
        return least;
    };
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 80; ++i) {
        const double a = (2.0 * low + high) / 3.0, b = (low + 2.0 * high) / 3.0;
        (depth(a) < depth(b) ? low : high) = depth(a) < depth(b) ? a : b;
    }
    return std::max({depth(0.0), depth(low), depth(1.0)});
}

double least_depth(const Blocker& body, const Corners& eyes, const Corners& object) {
    double least = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : eyes)
        for (const glm::dvec3& q : object) least = std::min(least, depth_in(body, p, q));
    return least;
}

// Planes that touch the unit sphere; the body is outside of none.
Blocker random_body(sampling::Random& random, std::size_t planes) {
    Blocker body;
    for (std::size_t k = 0; k < planes; ++k) body.planes.push_back({sampling::direction(random.point<2>()), 1.0});
    return body;
}

Corners box_near(sampling::Random& random, const glm::dvec3& center, double half) {
    const glm::dvec3 at = center + glm::dvec3(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), 0.0);
    return pvs::corners_of({at - half, at + half});
}

}  // namespace

TEST_SUITE("pvs/shaft") {
    TEST_CASE("a body blocks where the least deep segment passes deeper than the margin, of 1 to 40 planes") {
        sampling::Random random(71);
        int blocked = 0, open = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            const Blocker body = random_body(random, 1 + static_cast<std::size_t>(trial) % 40);
            const Corners eyes = box_near(random, {0.0, 0.0, -3.0}, 0.3),
                          object = box_near(random, {0.0, 0.0, 3.0}, 0.5);
            const double depth = least_depth(body, eyes, object);
            if (std::abs(depth - kMargin) < 1e-9) continue;
            CHECK(pvs::blocks_all(body, eyes, object, kMargin) == (depth > kMargin));
            ++(depth > kMargin ? blocked : open);
        }
        CHECK(blocked > 500);
        CHECK(open > 500);
    }

    TEST_CASE("the last of 17 to 20 planes alone may decide") {
        sampling::Random random(72);
        const Corners eyes = pvs::corners_of({glm::dvec3(-0.1, -0.1, -3.1), glm::dvec3(0.1, 0.1, -2.9)}),
                      object = pvs::corners_of({glm::dvec3(-0.1, -0.1, 2.9), glm::dvec3(0.1, 0.1, 3.1)});
        for (int trial = 0; trial < 200; ++trial) {
            // The sphere, which all segments pass through the middle of, is inside of these.
            Blocker body = random_body(random, 16 + static_cast<std::size_t>(trial) % 4);
            REQUIRE(pvs::blocks_all(body, eyes, object, kMargin));
            const glm::dvec3 normal = sampling::direction(random.point<2>());
            body.planes.push_back({normal, 5.0});  // far beyond both boxes
            CHECK(pvs::blocks_all(body, eyes, object, kMargin));
            body.planes.back().offset = -5.0;  // both are outside
            CHECK_FALSE(pvs::blocks_all(body, eyes, object, kMargin));
            // Where segments enter or leave the sphere: beyond it on one side, half of it on the other.
            for (const double side : {-1.0, 1.0}) {
                body.planes.back() = {glm::dvec3(0.0, 0.0, side), -1.5};
                const bool reaches = least_depth(body, eyes, object) > kMargin;
                CHECK(pvs::blocks_all(body, eyes, object, kMargin) == reaches);
                body.planes.back().offset = 0.0;
                CHECK(pvs::blocks_all(body, eyes, object, kMargin));
            }
        }
    }

    TEST_CASE("a body for eyes on one side of a plane may prove for boxes that are all there, whatever the normal") {
        sampling::Random random(73);
        int all_there = 0, others = 0;
        for (int trial = 0; trial < 600; ++trial) {
            const glm::dvec3 middle(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
            const Aabb eyes{middle - 0.3, middle + 0.3};
            Blocker body;
            Plane plane{sampling::direction(random.point<2>()), 0.3};
            if (trial % 4 != 0) {  // along an axis
                plane.normal = glm::dvec3(0.0);
                plane.normal[trial % 3] = trial % 2 ? 1.0 : -1.0;
            }
            body.eyes.push_back(plane);
            double least = std::numeric_limits<double>::infinity();
            for (const glm::dvec3& p : pvs::corners_of(eyes))
                least = std::min(least, glm::dot(plane.normal, p) + plane.offset);
            if (std::abs(least - kMargin) < 1e-9) continue;
            CHECK(pvs::may_prove_for(body, eyes, 0.0, kMargin) == (least > kMargin));
            ++(least > kMargin ? all_there : others);
        }
        CHECK(all_there > 100);
        CHECK(others > 100);
    }
}
