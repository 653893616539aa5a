// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>

using namespace crofton;
using namespace crofton::sampling;
using std::numbers::pi;

namespace {

const Sphere kSphere{glm::dvec3(1.0, -2.0, 0.5), 2.0};
constexpr int kLines = 100'000;

bool meets(const Line& line, const glm::dvec3& center, double radius) {
    const glm::dvec3 d = center - line.point;
    const double along = glm::dot(d, line.direction);
    return glm::dot(d, d) - along * along <= radius * radius;
}

// Whether `hits` of n lines, each with the chance p, is within 4.5 standard errors.
bool plausible(double hits, double n, double p) {
    return std::abs(hits - n * p) <= 4.5 * std::sqrt(n * p * (1.0 - p));
}

// Uniform lines through kSphere hit a ball of radius r anywhere inside with chance r²/R².
template <class Sample>
bool sees_every_place_alike(Sample sample) {
    const glm::dvec3 places[] = {{0.0, 0.0, 0.0}, {1.2, 0.0, 0.0}, {0.0, -1.2, 0.0}, {0.6, 0.6, 0.85}, {0.0, 0.0, 1.6}};
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        Random random(seed, 77);
        const double r = 0.4;
        int hits = 0;
        for (int i = 0; i < kLines; ++i) hits += meets(sample(random), kSphere.center + places[seed], r);
        if (!plausible(hits, kLines, r * r / 4.0)) return false;
    }
    return true;
}

}  // namespace

TEST_SUITE("sampling/global_lines") {
    TEST_CASE("a hull without area or with bad indices is refused") {
        TriangleMesh mesh;
        CHECK(error_of(LinesFromHull::make(mesh)).code == ErrorCode::empty);
        mesh.positions = {glm::vec3(0.0f), glm::vec3(1.0f), glm::vec3(2.0f)};
        mesh.indices = {0, 1, 2};
        CHECK(error_of(LinesFromHull::make(mesh)).code == ErrorCode::empty);
        mesh.indices = {0, 1, 3};
        CHECK(error_of(LinesFromHull::make(mesh)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("lines through the ball by two sphere points see every place alike") {
        CHECK(sees_every_place_alike([](Random& r) { return line_through_two_sphere_points(kSphere, r.point<4>()); }));
    }
    TEST_CASE("lines through the ball by a disc point see every place alike") {
        CHECK(sees_every_place_alike([](Random& r) { return line_through_disc(kSphere, r.point<4>()); }));
    }
    TEST_CASE("a turned box and a hull of triangles are sampled like the box") {
        Random random(4);
        Obb box;
        box.center = glm::dvec3(5.0, 6.0, 7.0);
        box.axes = glm::mat3(rotation({0.3, 0.6, 0.9}));
        box.half_extents = glm::vec3(2.0f, 1.0f, 0.25f);
        TriangleMesh hull;
        for (const glm::dvec3& c : corners(box)) hull.positions.emplace_back(c);
        hull.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
        const auto from_hull = LinesFromHull::make(hull).value();
        CHECK(from_hull.area() == doctest::Approx(surface_area(box)));
        const double r = 0.2, chance = 4.0 * pi * r * r / surface_area(box);
        const glm::dvec3 place = box.center + 1.5 * glm::dvec3(box.axes[0]) - 0.5 * glm::dvec3(box.axes[1]);
        int box_hits = 0, hull_hits = 0;
        for (int i = 0; i < kLines; ++i) {
            const Line line = line_from_box(box, random.point<5>());
            box_hits += meets(line, place, r);
            CHECK(contains(box, box.center + 0.999 * (line.point - box.center)));
            hull_hits += meets((from_hull)(random.point<5>()), place, r);
        }
        CHECK(plausible(box_hits, kLines, chance));
        CHECK(plausible(hull_hits, kLines, chance));
    }
    TEST_CASE("a box without thickness still gives lines from both its sides") {
        const Aabb flat{glm::dvec3(-1.0, -1.0, 0.0), glm::dvec3(1.0, 1.0, 0.0)};
        Random random(8);
        int up = 0;
        for (int i = 0; i < 10'000; ++i) {
            const Line line = line_from_box(flat, random.point<5>());
            CHECK(line.point.z == 0.0);
            up += line.direction.z > 0.0;
        }
        CHECK(plausible(up, 10'000, 0.5));
    }

    TEST_CASE("bundles hold πR²/Δ lines and see every place alike") {
        Random random(5);
        Vector<Line> lines;
        const double cell = 0.05;
        const int bundles = 2'000;
        for (int i = 0; i < bundles; ++i) append_line_bundle(kSphere, cell, random, lines);
        const double expected = pi * 4.0 / cell;
        CHECK(static_cast<double>(lines.size()) / bundles == doctest::Approx(expected).epsilon(0.003));
        const double r = 0.4;
        double hits = 0.0;
        for (const Line& line : lines) hits += meets(line, kSphere.center + glm::dvec3(0.0, 1.2, 0.9), r);
        CHECK(hits / bundles == doctest::Approx(pi * r * r / cell).epsilon(0.02));
    }
}
