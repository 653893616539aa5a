// SPDX-License-Identifier: MIT
// Boxes around points, and hulls, in the same bits everywhere.
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// Points on a sphere, in a stretched one, on a grid, and those of a turned box.
std::vector<std::vector<glm::vec3>> clouds() {
    Random random(31);
    std::vector<std::vector<glm::vec3>> clouds(4);
    for (int i = 0; i < 300; ++i) clouds[0].push_back(glm::vec3(sampling::direction(random.point<2>())));
    const glm::dmat3 turn = sampling::rotation(random.point<3>());
    for (int i = 0; i < 2000; ++i)
        clouds[1].push_back(glm::vec3(turn * (glm::dvec3(5.0, 2.0, 0.5) * sampling::ball_point(random.point<3>()))));
    for (int i = 0; i < 125; ++i) clouds[2].push_back(glm::vec3(i % 5, i / 5 % 5, i / 25));
    for (const glm::dvec3& corner : corners(random_box(random, glm::dvec3(7.0), 1.0, 4.0)))
        clouds[3].push_back(glm::vec3(corner));
    return clouds;
}

std::uint64_t boxes() {
    Digest digest;
    for (const auto& cloud : clouds()) {
        for (const auto quality : {fit::Quality::fast, fit::Quality::tight, fit::Quality::exact})
            for (const auto& criterion :
                 {measure::minimal_perimeter(), measure::minimal_area(), measure::minimal_volume()})
                digest.add(*fit::fit_obb(cloud, {criterion, quality}));
        const auto exact = *fit::fit_exact(cloud);
        digest.add(exact.value).add(exact.lower_bound).add(exact.cells);
    }
    return digest.value();
}

std::uint64_t many(Executor& executor) {
    Random random(32);
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices, ends;
    for (std::uint32_t i = 0; i < 3000; ++i)
        positions.push_back(glm::vec3(10.0 * sampling::ball_point(random.point<3>())));
    for (std::uint32_t cluster = 0; cluster < 150; ++cluster) {
        for (std::uint32_t k = 0; k <= cluster % 40; ++k) indices.push_back(index(random, 3000));
        ends.push_back(static_cast<std::uint32_t>(indices.size()));
    }
    std::vector<Obb> boxes(ends.size());
    (void)fit::fit_many({positions, indices, ends}, {}, executor, boxes);
    return Digest().add(boxes).value();
}

std::uint64_t hulls() {
    Digest digest;
    for (const auto& cloud : clouds()) {
        const auto hull = *convex_hull(cloud);
        digest.add(hull.vertices).add(hull.triangles);
    }
    return digest.value();
}

std::uint64_t rectangles() {
    Digest digest;
    Random random(33);
    std::vector<glm::dvec2> points;
    for (int i = 0; i < 500; ++i) points.push_back(glm::dvec2(3.0, 1.0) * sampling::disc_point(random.point<2>()));
    for (const auto criterion : {fit::PlanarCriterion::perimeter, fit::PlanarCriterion::area}) {
        const auto rectangle = *fit::minimal_rectangle(points, criterion);
        digest.add(rectangle.center).add(rectangle.axis).add(rectangle.half_extents);
    }
    const auto disc = *fit::minimal_disc(points);
    return digest.add(disc.center).add(disc.radius).value();
}

}  // namespace

TEST_SUITE("determinism/fit") {
    TEST_CASE("boxes of every quality and criterion, rectangles and discs are the same bits everywhere") {
        check_everywhere(0x9f6f1f0b470c895, [](Executor&) { return boxes(); });
        check_everywhere(0xa91c379ce287e4dc, [](Executor& e) { return many(e); });
        check_everywhere(0x96e3a163dc4f22a0, [](Executor&) { return rectangles(); });
    }

    TEST_CASE("hulls have the same corners and faces everywhere") {
        check_everywhere(0xbcbb9cae2e6bff02, [](Executor&) { return hulls(); });
    }

    TEST_CASE("the published sphere contains its points, is proved best, and the hull has no point outside") {
        for (const auto& cloud : clouds()) {
            for (const auto quality : {fit::Quality::fast, fit::Quality::tight, fit::Quality::exact}) {
                const Obb box = *fit::fit_obb(cloud, {measure::minimal_perimeter(), quality});
                for (const glm::vec3& p : cloud) CHECK(contains(box, glm::dvec3(p)));
            }
            const auto exact = *fit::fit_exact(cloud);
            CHECK(exact.complete);
            CHECK(exact.gap - exact.rounding <= 2e-7 * (1.0 + 1e-6));
            const auto hull = *convex_hull(cloud);
            for (std::size_t t = 0; t < hull.triangles.size(); t += 3) {
                const glm::dvec3 a(cloud[hull.triangles[t]]), b(cloud[hull.triangles[t + 1]]),
                    c(cloud[hull.triangles[t + 2]]);
                const glm::dvec3 normal = glm::cross(b - a, c - a);
                for (const glm::vec3& p : cloud)
                    CHECK(glm::dot(normal, glm::dvec3(p) - a) <= 1e-12 * (1.0 + glm::dot(normal, normal)));
            }
        }
    }
}
