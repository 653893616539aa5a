// SPDX-License-Identifier: MIT
// Few boxes about bodies of one to twelve planes, which wedges, slabs and repeated planes are among. Every list path
// must give classify's verdict. edge_test.cpp compares that with exact arithmetic.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

#include "classified.hpp"

using namespace crofton;
using cull::CullMode;
using cull::Verdict;
using testing::TargetInTurn;

namespace {

// Up to twelve planes at distances of about 1 from the origin, some of them opposed, repeated, or nearly so.
Frustum body_of_planes(oracle::NearMisses& random, std::uint32_t planes, double far) {
    Frustum body{};
    body.origin = far * random.direction();
    body.plane_count = planes;
    for (std::uint32_t i = 0; i < planes; ++i) {
        glm::dvec3 normal = random.direction();
        const unsigned kind = i > 0 ? random.index(5) : 4;
        const glm::dvec3 before = body.planes[i > 0 ? i - 1 : 0].normal;
        if (kind == 0) normal = -before;
        if (kind == 1) normal = before;
        if (kind == 2) normal = glm::normalize(1e-4 * normal - before);
        if (kind == 3) normal = glm::normalize(0.3 * normal - before);
        body.planes[i].normal = normal;
        body.planes[i].offset = random.index(4) ? random.number(0.0, 1.0) : random.number(-1.0, 0.0);
    }
    return body;
}

// A box that touches a plane of the body, or contains it, or is near where two of them meet; moved by next to nothing.
Obb box_about(oracle::NearMisses& random, const Frustum& body) {
    Obb box;
    const glm::dvec3 axis = random.direction();
    const double angle = random.index(3) ? random.number(0.0, 6.2) : 0.0;
    box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)));
    const double size = std::exp(random.number(-4.0, 1.0));
    for (int k = 0; k < 3; ++k) box.half_extents[k] = random.index(5) ? float(size * random.number(0.05, 1.0)) : 0.0f;
    glm::dvec3 at(random.number(-2, 2), random.number(-2, 2), random.number(-2, 2));
    const unsigned passes = random.index(4);
    for (unsigned pass = 0; pass < passes; ++pass) {
        const Plane& plane = body.planes[random.index(body.plane_count)];
        double projected_radius = 0.0;
        for (int k = 0; k < 3; ++k)
            projected_radius +=
                double{box.half_extents[k]} * std::fabs(glm::dot(plane.normal, glm::dvec3(box.axes[k])));
        const double side = random.index(3) == 0 ? 0.0 : random.index(2) ? 1.0 : -1.0;
        at -= (glm::dot(plane.normal, at) + plane.offset + side * projected_radius) * plane.normal;
    }
    if (random.index(2)) at += std::exp(random.number(-36.0, -4.0)) * random.direction();
    box.center = body.origin + at;
    return box;
}

void check_verdicts(const std::vector<Obb>& boxes, const cull::View& view, CullMode mode) {
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits bits;
    cull::find_visible(set, boxes, view, bits, mode);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, boxes[i], mode));
    cull::VisibleSet visible;
    cull::find_visible(boxes, {}, view, visible, {mode});
    REQUIRE(testing::Classified(boxes, {}, view, mode).is_answer(visible));
}

}  // namespace

TEST_SUITE("cull/few boxes") {
    TEST_CASE("boxes about up to twelve planes, many opposed or repeated, get classify's verdicts") {
        oracle::NearMisses random(41);
        int outside = 0, tested = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const TargetInTurn target(trial / 12);
            const Frustum body =
                body_of_planes(random, 1 + static_cast<std::uint32_t>(trial % 12), trial % 5 ? 1.0 : 1e6);
            const std::size_t counts[] = {3, 20, 64, 65, 255, 257};
            std::vector<Obb> boxes(counts[random.index(trial % 8 ? 4 : 6)]);
            for (Obb& box : boxes) box = box_about(random, body);
            for (const CullMode mode : {CullMode::exact, CullMode::conservative}) check_verdicts(boxes, {body}, mode);
            outside += cull::classify(body, boxes[0]) == Verdict::outside;
            ++tested;
        }
        CHECK(outside > tested / 5);
        CHECK(outside < tested * 9 / 10);
    }

    TEST_CASE("planes about all of a list are dropped only while they are, whatever moves") {
        oracle::NearMisses random(42);
        int crossed = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const TargetInTurn target(trial);
            const Frustum body = body_of_planes(random, 1 + random.index(7), 1.0);
            const Plane plane = body.planes[0];
            // A cluster whose farthest corner is at the plane, inside of it, to some thousandths.
            std::vector<Obb> boxes(1 + random.index(20));
            const double size = std::exp(random.number(-6.0, 2.0));
            double least = 1e9;
            for (Obb& box : boxes) {
                box = box_about(random, body);
                box.center = body.origin + size * random.number(0.0, 1.0) * random.direction();
                box.half_extents *= static_cast<float>(size);
                double projected_radius = 0.0;
                for (int k = 0; k < 3; ++k)
                    projected_radius +=
                        double{box.half_extents[k]} * std::fabs(glm::dot(plane.normal, glm::dvec3(box.axes[k])));
                least =
                    std::min(least, glm::dot(plane.normal, box.center - body.origin) + plane.offset - projected_radius);
            }
            const double margin = size * random.number(-0.01, 0.01) * random.index(2);
            for (Obb& box : boxes) box.center += (margin - least) * plane.normal;
            cull::BoxSet set;
            set.assign(boxes);
            // One moves beyond the plane, a little or so far that it leaves the chunk's frame, or grows.
            for (int change = 0; change < 3; ++change) {
                const std::uint32_t i = random.index(static_cast<unsigned>(boxes.size()));
                const double step = size * std::exp(random.number(-8.0, 8.0));
                if (random.index(3))
                    boxes[i].center -= step * plane.normal;
                else
                    boxes[i].half_extents *= static_cast<float>(1.0 + std::min(step, 1e3));
                set.update(std::span(&i, 1), boxes);
                cull::VerdictBits bits;
                cull::find_visible(set, boxes, {body}, bits);
                for (std::size_t k = 0; k < boxes.size(); ++k) {
                    const Verdict expected = cull::classify(body, boxes[k]);
                    REQUIRE(bits.verdict(k) == expected);
                    crossed += expected == Verdict::straddling;
                }
            }
        }
        CHECK(crossed > 1000);
    }
}
