// SPDX-License-Identifier: MIT
// Shapes that fly straight at surfaces of many triangles, beside the same cast at each triangle by itself.
#include <doctest/doctest.h>

#include <hwy/targets.h>
#include <algorithm>
#include <array>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct Flight {
    RigidTransform surface, shape;
    Motion of_surface, of_shape;
    double speed;
};

// At a point near one of the triangles, from up to `far` sizes away, past it by about the shape's size.
Flight fly(RandomShapes& random, const Surface& s, const Shape& shape, double far, double offset) {
    Flight f;
    f.surface.rotation = random.rotation();
    f.surface.translation = offset * random.direction();
    const double size = shape.core_radius() + shape.radius();
    const Shape triangle = s.triangle(static_cast<std::size_t>(random.index(static_cast<int>(s.size()))));
    glm::dvec3 target = f.surface.rotation * triangle.vertex(random.index(3)) + f.surface.translation;
    const double beside = random.number(0, 1.2) * size;
    target += beside * random.direction();
    const double length = random.number(0.5, far);
    const glm::dvec3 way = length * random.direction();
    f.shape = {random.rotation(), target - way};
    if (random.index(2) == 0) f.of_surface.velocity = random.direction();
    const glm::dvec3 velocity = random.number(1.0, 2.0) * way;
    f.of_shape.velocity = velocity + f.of_surface.velocity;
    f.speed = glm::length(velocity);
    return f;
}

struct Counts {
    int hits = 0, misses = 0;
};

// Checks a cast at a whole surface, in both orders, against those at its triangles.
void check_flight(const Surface& s, const Shape& whole, const Shape& shape, const Flight& f, const CastOptions& options,
                  Counts& counts) {
    // How far apart the answers of two ways to advance may be, and what double leaves of the places.
    const double size = whole.core_radius() + shape.core_radius() + shape.radius();
    const double round = shape.has_polytope_core() ? 0.0 : 1e-7 * size;
    const double places = 1e-11 * (size + glm::length(f.shape.translation - f.surface.translation)) + round;
    const double apart = (options.tolerance + places) / f.speed;
    Impact first;
    first.time = options.duration;
    for (std::size_t t = 0; t < s.size(); ++t) {
        const Impact i = cast({s.triangle(t), f.surface}, f.of_surface, {shape, f.shape}, f.of_shape, options).value();
        if (i.result != CastResult::miss && i.time < first.time) first = i;
    }
    const Impact i = cast({whole, f.surface}, f.of_surface, {shape, f.shape}, f.of_shape, options).value();
    const Impact back = cast({shape, f.shape}, f.of_shape, {whole, f.surface}, f.of_surface, options).value();
    CHECK(i.result == first.result);
    CHECK(back.result == i.result);
    CHECK(back.time == i.time);
    CHECK(back.part_b == i.part_a);
    if (i.time > 0.0) CHECK(glm::length(back.normal + i.normal) <= 1e-6);  // 6e-5 of a degree
    (first.result == CastResult::hit ? counts.hits : counts.misses) += 1;
    if (i.result != CastResult::hit || first.result != CastResult::hit) return;
    // Steep or grazing: the gap closes at least this fast.
    const double closing = std::max(1e-6, -glm::dot(i.normal, (f.of_shape.velocity - f.of_surface.velocity) / f.speed));
    CHECK(std::abs(i.time - first.time) <= 2.0 * apart / closing);
    // Where the shapes stand then, and that they have not come nearer before.
    const RigidTransform then = moved(f.surface, f.of_surface, i.time), b_then = moved(f.shape, f.of_shape, i.time);
    const Distance d = distance({s.triangle(i.part_a.triangle), then}, {shape, b_then});
    if (i.time > 0.0) {
        CHECK(d.distance <= options.tolerance + places);
        CHECK(std::abs(d.distance - i.distance) <= places);
        CHECK(distance({whole, then}, {shape, b_then}).distance >= i.distance - 1e-3 * options.tolerance - places);
        for (int k = 1; k < 4; ++k) {
            const double time = i.time * 0.25 * k;
            CHECK_FALSE(
                intersects({whole, moved(f.surface, f.of_surface, time)}, {shape, moved(f.shape, f.of_shape, time)}));
        }
    }
    CHECK(glm::length(i.on_b - i.on_a - i.distance * i.normal) <= places + 1e-12 * glm::length(i.on_a));
    CHECK(std::abs(glm::length(i.normal) - 1.0) <= 1e-12);
}

}  // namespace

TEST_SUITE("convex/straight_cast") {
    TEST_CASE("straight flights hit the first of a surface's triangles, whatever flies and however it passes") {
        RandomShapes random(11);
        Counts counts;
        for (int round = 0; round < 1200; ++round) {
            const int kind = round % 4;
            const Surface s = kind == 0   ? soup(random, 60, 2.0, 0.5)
                              : kind == 1 ? tangle(random, 12, 40)
                              : kind == 2
                                  ? ground(random, 6, 0.4, [](double x, double z) { return 0.3 * std::sin(3 * x + z); })
                                  : ground(random, 6, 0.05, [](double x, double z) { return x * z; });
            // Triangles from larger than the shape to a hundred times smaller.
            const Shape shape = any_shape(random, round % 3 == 0 ? 0.05 : round % 3 == 1 ? 0.5 : 4.0);
            const Flight f = fly(random, s, shape, round % 5 == 0 ? 1e4 : 5.0, round % 7 == 0 ? 1e5 : 0.0);
            const double tolerance = round % 7 == 0 || round % 5 == 0 ? 1e-4 : round % 2 == 0 ? 1e-6 : 1e-3;
            check_flight(s, s.shape(), shape, f,
                         {.duration = random.number(0.5, 2.0), .tolerance = tolerance, .max_steps = 5000}, counts);
        }
        CHECK(counts.hits > 500);
        CHECK(counts.misses > 150);
    }

    TEST_CASE("at the edge of a touch: balls, capsules and boxes that miss or hit a triangle by a hair") {
        RandomShapes random(12);
        int told[2] = {0, 0};
        for (int round = 0; round < 1500; ++round) {
            const Surface s = soup(random, 1, 0.5, 0.5);
            const Shape triangle = s.triangle(0);
            const Shape shape = round % 3 == 0   ? Shape::sphere(0.3f).value()
                                : round % 3 == 1 ? Shape::capsule(0.3f, 0.2f).value()
                                                 : random.box(0.5);
            // Along a plane across n they are `gap` apart all the way, where n is what parts them.
            const glm::dvec3 n = random.direction(), along = glm::normalize(glm::cross(n, random.direction()));
            const glm::dmat3 turned = random.rotation();
            const glm::dvec3 high = support_point(triangle, n),
                             low = turned * support_point(shape, glm::transpose(turned) * -n);
            const double gap = (round % 2 == 0 ? 1.0 : -1.0) * random.number(1e-7, 1e-5);
            const RigidTransform from{turned, high - low + gap * n - 2.0 * along};
            const CastOptions options{.duration = 1.0, .tolerance = 1e-8};
            const Impact i = cast({s.shape(), at({})}, {}, {shape, from}, {4.0 * along, {}, {}}, options).value();
            if (gap > 0.0) {
                CHECK(i.result == CastResult::miss);
            } else {
                // Its highest point against the other's lowest: they overlap in the middle of the way.
                CHECK(i.result == CastResult::hit);
                CHECK(i.time <= 0.5);
                CHECK(i.time >= 0.0);
            }
            ++told[gap > 0.0 ? 0 : 1];
        }
        CHECK(told[0] == told[1]);
    }

    TEST_CASE("of triangles hit at one time the least number counts, in whatever order they stand") {
        RandomShapes random(15);
        int hits = 0;
        for (int round = 0; round < 600; ++round) {
            Surface s = ground(random, 8, 0.2, [&](double, double) { return random.number(-0.1, 0.1); });
            // Each triangle three times, at random numbers.
            std::vector<std::array<std::uint32_t, 3>> triangles;
            for (std::size_t i = 0; i < 3 * s.mesh.indices.size(); i += 3) {
                const std::uint32_t* const corner = &s.mesh.indices[i % s.mesh.indices.size()];
                triangles.push_back({corner[0], corner[1], corner[2]});
            }
            for (std::size_t i = triangles.size() - 1; i > 0; --i)
                std::swap(triangles[i], triangles[static_cast<std::size_t>(random.index(static_cast<int>(i) + 1))]);
            s.mesh.indices.clear();
            for (const auto& t : triangles) s.mesh.indices.insert(s.mesh.indices.end(), t.begin(), t.end());
            s.build();
            const Shape shape = round % 2 == 0 ? Shape::sphere(0.3f).value() : Shape::capsule(0.3f, 0.2f).value();
            const Flight f = fly(random, s, shape, 5.0, 0.0);
            const Impact i =
                cast({s.shape(), f.surface}, f.of_surface, {shape, f.shape}, f.of_shape, {.tolerance = 1e-4}).value();
            if (i.result != CastResult::hit || i.time == 0.0) continue;
            ++hits;
            const std::uint32_t hit = i.part_a.triangle;
            CHECK(std::find(triangles.begin(), triangles.end(), triangles[hit]) - triangles.begin() == hit);
        }
        CHECK(hits > 200);
    }

    TEST_CASE("a straight cast tells the same bits on every instruction set") {
        RandomShapes random(13);
        const Surface s =
            ground(random, 24, 0.1, [](double x, double z) { return 0.1 * std::sin(5 * x) * std::cos(4 * z); });
        const Shape surface = s.shape();
        for (int round = 0; round < 60; ++round) {
            const Shape shape = any_shape(random, round % 2 == 0 ? 0.4 : 0.05);
            const Flight f = fly(random, s, shape, 5.0, 0.0);
            const auto ask = [&] {
                return cast({surface, f.surface}, f.of_surface, {shape, f.shape}, f.of_shape, {.tolerance = 1e-3})
                    .value();
            };
            const Impact best = ask();
            for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                const Impact i = ask();
                hwy::SetSupportedTargetsForTest(0);
                CHECK(i.result == best.result);
                CHECK(i.time == best.time);
                CHECK(i.part_a == best.part_a);
                CHECK(i.normal == best.normal);
                CHECK(i.on_a == best.on_a);
                CHECK(i.distance == best.distance);
            }
        }
    }

    TEST_CASE("height fields with holes: straight flights hit the first of the cells' triangles") {
        RandomShapes random(14);
        int hits = 0;
        for (int round = 0; round < 200; ++round) {
            constexpr std::uint32_t kSide = 14;
            std::vector<float> heights;
            std::vector<std::uint8_t> materials;
            for (std::uint32_t i = 0; i < kSide * kSide; ++i)
                heights.push_back(static_cast<float>(random.number(-0.4, 0.4)));
            for (std::uint32_t i = 0; i < (kSide - 1) * (kSide - 1); ++i)
                materials.push_back(random.index(5) == 0 ? kHole : std::uint8_t{0});
            const HeightField field = HeightField::build({kSide, kSide, heights, {0.7, 0.4}, materials}).value();
            Surface s;
            std::vector<std::uint32_t> number;
            for (std::uint32_t t = 0; t < 2 * field.cell_count(); ++t) {
                if (field.material(t / 2) == kHole) continue;
                for (const glm::dvec3& corner : field.triangle(t)) {
                    s.mesh.indices.push_back(static_cast<std::uint32_t>(s.mesh.positions.size()));
                    s.mesh.positions.emplace_back(corner);
                }
                number.push_back(t);
            }
            const Shape shape = any_shape(random, 0.5);
            const Flight f = fly(random, s, shape, 6.0, 0.0);
            const CastOptions options{.tolerance = 1e-5, .max_steps = 5000};
            Impact first;
            first.time = 1.0;
            for (const std::uint32_t t : number) {
                const Triangle c = field.triangle(t);
                const Shape triangle = Shape::triangle(glm::vec3(c[0]), glm::vec3(c[1]), glm::vec3(c[2])).value();
                const Impact i =
                    cast({triangle, f.surface}, f.of_surface, {shape, f.shape}, f.of_shape, options).value();
                if (i.result != CastResult::miss && i.time < first.time) first = i;
            }
            const Impact i = cast({Shape::height_field(field, Sides::both), f.surface}, f.of_surface, {shape, f.shape},
                                  f.of_shape, options)
                                 .value();
            CHECK(i.result == first.result);
            if (i.result != CastResult::hit) continue;
            ++hits;
            const double closing =
                std::max(1e-6, -glm::dot(i.normal, (f.of_shape.velocity - f.of_surface.velocity) / f.speed));
            CHECK(std::abs(i.time - first.time) <= 2.0 * (1e-5 + 1e-6) / f.speed / closing);
        }
        CHECK(hits > 80);
    }
}
