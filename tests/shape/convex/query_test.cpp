// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <crofton/convex/query.hpp>
#include <cstddef>
#include <cstdlib>
#include <error_of.hpp>
#include <limits>
#include <new>

#include "oracle/exact_convex.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct Wrong {
    int verdicts = 0, cached = 0, brute = 0, meeting = 0;
};

// Yes or no of pairs that touch up to `gap`, cold and with what a neighbouring pose has left, against exact proofs.
//
// 15 pairs a class; CROFTON_CONVEX_PAIRS=14000 makes a million in all.
int pairs_per_class() {
    const char* const asked = std::getenv("CROFTON_CONVEX_PAIRS");
    return asked != nullptr ? std::atoi(asked) : 15;
}
Wrong count_wrong(std::uint64_t seed, int pairs, double gap, double offset) {
    Wrong wrong;
    RandomShapes random(seed);
    for (int i = 0; i < pairs; ++i) {
        const Shape a = random.polytope(20), b = random.polytope(20);
        const CasePair where = nearly_touching(random, a, b, gap * random.number(0.2, 1.0), offset);
        const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
        const bool answer = intersects(pa, pb);
        PairCache cache;
        RigidTransform earlier = where.pose_b;
        earlier.translation += 0.01 * random.direction();
        (void)intersects(pa, {b, earlier}, &cache);
        const bool warm = intersects(pa, pb, &cache);
        const Distance d = distance(pa, pb);
        // Guesses from the neighbourhood of a's origin, where coordinates are small.
        const RigidTransform near_a{where.pose_a.rotation, glm::dvec3(0.0)};
        const RigidTransform near_b{where.pose_b.rotation, where.pose_b.translation - where.pose_a.translation};
        const Penetration p = penetration({a, near_a}, {b, near_b});
        bool brute = false;
        const bool truth =
            oracle::meet(oracle::exact_polytope(pa), oracle::exact_polytope(pb), {where.normal, d.normal},
                         where.pose_a.translation, {0.5 * (p.on_a + p.on_b)}, &brute);
        wrong.brute += brute;
        wrong.verdicts += answer != truth;
        wrong.cached += warm != truth;
        wrong.meeting += truth;
        CHECK((d.distance == 0.0) == truth);
    }
    return wrong;
}

}  // namespace

TEST_SUITE("convex/query") {
    TEST_CASE("the depth of two spheres lies between its bounds, in rationals") {
        RandomShapes random(31);
        int meeting = 0;
        for (int i = 0; i < 20'000; ++i) {
            const Shape a = Shape::sphere(random.number(0.0, 1.0)).value();
            const Shape b = Shape::sphere(std::exp2(random.number(-30.0, 0.0))).value();
            const double between = (a.radius() + b.radius()) * (1.0 - std::exp2(random.number(-50.0, 0.0)));
            const Penetration p = penetration({a, at({0, 0, 0})}, {b, at({between, 0, 0})});
            if (p.depth <= 0.0) continue;
            ++meeting;
            const mpq_class depth = mpq_class(a.radius()) + mpq_class(b.radius()) - mpq_class(between);
            CHECK(mpq_class(p.lower) <= depth);
            CHECK(depth <= mpq_class(p.upper));
        }
        CHECK(meeting > 19'000);
    }

    TEST_CASE("a pose with NaN meets nothing, and a pose that mirrors is refused") {
        const Shape box = Shape::box({1, 1, 1}).value();
        RigidTransform bad = at({});
        bad.translation.x = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(intersects({box, at({})}, {box, bad}));
        CHECK_FALSE(penetration({box, at({})}, {box, bad}).overlapping);
        CHECK(error_of(validate_pose(bad)).code == ErrorCode::non_finite);
        RigidTransform mirror = at({});
        mirror.rotation[0].x = -1.0;
        CHECK(error_of(validate_pose(mirror, 7)).item == 7);
    }

    TEST_CASE("points, segments, discs and coincident shapes have answers") {
        const Shape point = Shape::sphere(0).value(), needle = Shape::capsule(1, 0).value();
        const Shape disc = Shape::cylinder(0, 1).value(), box = Shape::box({1, 1, 1}).value();
        const Shape flat = Shape::box({1, 0, 1}).value(),
                    triangle = Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value();
        for (const Shape* a : {&point, &needle, &disc, &box, &flat, &triangle})
            for (const Shape* b : {&point, &needle, &disc, &box, &flat, &triangle}) {
                CHECK(intersects({*a, at({})}, {*b, at({})}));
                const Penetration p = penetration({*a, at({})}, {*b, at({})});
                CHECK(p.overlapping);
                CHECK(std::isfinite(p.depth));
                CHECK_FALSE(intersects({*a, at({})}, {*b, at({0, 0, 9})}));
            }
        CHECK(penetration({box, at({})}, {box, at({})}).depth == doctest::Approx(2.0));
        CHECK(penetration({point, at({})}, {point, at({})}).depth == doctest::Approx(0.0));
    }

    TEST_CASE("distances and depths known by hand, of every kind") {
        const Shape sphere = Shape::sphere(0.5f).value(), capsule = Shape::capsule(1, 0.25f).value();
        const Shape cylinder = Shape::cylinder(1, 2).value(), cone = Shape::cone(1, 2).value();
        const Shape box = Shape::box({1, 2, 3}).value();
        const Shape floor = Shape::half_space({{0, -1, 0}, 0}).value();  // solid below y = 0
        CHECK(distance({sphere, at({})}, {sphere, at({3, 0, 0})}).distance == doctest::Approx(2.0));
        CHECK(distance({sphere, at({0, 3, 0})}, {cylinder, at({})}).distance == doctest::Approx(1.5));
        CHECK(distance({sphere, at({0, -3, 0})}, {cone, at({})}).distance == doctest::Approx(1.5));
        CHECK(distance({sphere, at({0, 3, 0})}, {cone, at({})}).distance == doctest::Approx(1.5));
        CHECK(distance({capsule, at({5, 0, 0})}, {box, at({})}).distance == doctest::Approx(3.75));
        CHECK(distance({box, at({0, 5, 0})}, {floor, at({})}).distance == doctest::Approx(3.0));
        CHECK(distance({floor, at({})}, {box, at({0, 5, 0})}).normal.y == doctest::Approx(1.0));
        CHECK(penetration({floor, at({})}, {box, at({0, 1.5, 0})}).depth == doctest::Approx(0.5));
        CHECK(penetration({floor, at({})}, {box, at({0, 1.5, 0})}).normal.y == doctest::Approx(1.0));
        CHECK(penetration({sphere, at({})}, {sphere, at({0.75, 0, 0})}).depth == doctest::Approx(0.25));
        CHECK(penetration({cylinder, at({})}, {cylinder, at({0, 1.75, 0})}).depth == doctest::Approx(0.25));
        CHECK(penetration({cylinder, at({})}, {cylinder, at({3.75, 0, 0})}).depth == doctest::Approx(0.25));
        const Shape round = Shape::rounded(box, 0.5f).value();
        CHECK(penetration({round, at({})}, {round, at({2.75, 0, 0})}).depth == doctest::Approx(0.25));
        CHECK(closest_point({box, at({})}, {4, 0, 0}).distance == doctest::Approx(3.0));
        CHECK(closest_point({box, at({})}, {4, 0, 0}).on_b.x == doctest::Approx(1.0));
    }

    TEST_CASE("shapes apart by less than rounding have bounds that contain their distance") {
        // Found by fuzz_convex: the four corners seemed to contain the origin, and the bound stayed 0.
        const Shape a = Shape::box({0x1.fp+1f, 0x1p-3f, 0x1.8p-2f}).value();
        const Shape b = Shape::box({0x1.2p+0f, 0x1.8p+1f, 0x1.8p-2f}).value();
        const RigidTransform pose_a = at({-0x1.ap+2, 0x1.b4p+3, 0x1.dfffffffffffdp+2});
        const RigidTransform pose_b = {glm::dmat3(0x1.5e0d3f2958c0cp-1, -0x1.5ba0bc7f81bbcp-1, 0x1.11f41b2b7d1c7p-2,
                                                  0x1.23b5b4a274a0ap-1, 0x1.11f41b2b7d1c8p-2, -0x1.8dda4a0336898p-1,
                                                  0x1.d2f60d05708a7p-2, 0x1.5e0d3f2958c0cp-1, 0x1.23b5b4a274a0ap-1),
                                       {0x1.8fc4ecdcda94p-6, 0x1.b971e4c614bp+3, 0x1.53bdd29f77cfcp+2}};
        const ShapeAtPose pa{a, pose_a}, pb{b, pose_b};
        const bool meet = intersects(pa, pb);
        CHECK(meet == oracle::meet_by_axes(oracle::exact_polytope(pa), oracle::exact_polytope(pb)));
        const Distance d = distance(pa, pb);
        CHECK((d.distance == 0.0) == meet);
        CHECK(d.lower <= d.distance);
        CHECK(d.distance <= d.upper);
        CHECK(d.upper < 1e-9);
    }

    TEST_CASE("round shapes that overlap do so by a depth that is not negative, however little it is") {
        RandomShapes random(41);
        int overlapping = 0;
        for (int i = 0; i < 6000; ++i) {
            const Shape box = random.box();
            const Shape a = i % 2 == 0 ? Shape::rounded(box, 0.3f).value() : box;
            const Shape b = i % 3 == 0 ? Shape::sphere(0.7f).value() : Shape::capsule(0.5f, 0.2f).value();
            const double gap = std::pow(10.0, -random.number(12.0, 17.0)) * (i % 4 < 2 ? 1.0 : -1.0);
            const CasePair where = nearly_touching(random, a, b, gap, 0.0);
            const Penetration p = penetration({a, where.pose_a}, {b, where.pose_b});
            CHECK(p.depth >= 0.0);
            CHECK(p.lower <= p.upper);
            overlapping += p.overlapping;
        }
        CHECK(overlapping > 1000);
    }

    TEST_CASE("shapes may lie at any address that suits doubles") {
        // Found by fuzz_convex, compiled by clang: corners were loaded as if they lay at multiples of 16.
        alignas(16) std::byte memory[sizeof(Shape) + 8];
        for (const std::size_t offset : {std::size_t{0}, std::size_t{8}}) {
            const Shape* box = new (memory + offset) Shape(Shape::box({1, 2, 3}).value());
            CHECK(intersects({*box, at({})}, {*box, at({2, 0, 0})}));
            CHECK_FALSE(intersects({*box, at({})}, {*box, at({2.5, 0, 0})}));
        }
    }

    TEST_CASE("touching exactly counts: kissing boxes, a corner on a face, an edge across an edge") {
        const Shape box = Shape::box({1, 1, 1}).value();
        for (const double far : {0.0, 1e3, 0x1p23}) {
            const glm::dvec3 o(far, -far, far);
            CHECK(intersects({box, at(o)}, {box, at(o + glm::dvec3(2, 0.5, 0))}));
            CHECK(intersects({box, at(o)}, {box, at(o + glm::dvec3(2, 2, 2))}));
            CHECK_FALSE(intersects({box, at(o)}, {box, at(o + glm::dvec3(2.0 + 0x1p-29, 0, 0))}));
            CHECK(intersects({box, at(o)}, {box, at(o + glm::dvec3(2.0 - 0x1p-29, 0, 0))}));
            const Penetration p = penetration({box, at(o)}, {box, at(o + glm::dvec3(2, 0.5, 0))});
            CHECK(p.overlapping);
            CHECK(p.upper < 1e-8 * (1.0 + far));
        }
    }

    // Points, segments and rectangles in the plane z = 0, turned by a Pythagorean angle. What is known by hand: one
    // side of the rectangle is x cos + y sin = 0.25 there, and the point moves across it.
    TEST_CASE(
        "shapes within one plane overlap or not as exact arithmetic says, and the oracle agrees with hand-made cases") {
        const Shape plate = Shape::box({4, 0.25f, 0}).value(), point = Shape::box({0, 0, 0}).value(),
                    rod = Shape::box({2, 0, 0}).value();
        RigidTransform turned = at({});
        turned.rotation = glm::dmat3(0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0);
        int met = 0, apart = 0;
        for (const Shape* other : {&point, &rod, &plate})
            for (int step = -40; step <= 40; ++step) {
                // 0.15 + 0.2 along the side's normal is on the side, but for rounding.
                const double by = step < -20 ? -0.01 : step > 20 ? 0.01 : step * 1e-17;
                const RigidTransform place = at({-0.15 - 0.6 * by, 0.2 + 0.8 * by, 0.0});
                const bool meet = intersects({plate, turned}, {*other, place});
                CHECK(meet == intersects({*other, place}, {plate, turned}));
                CHECK(meet == oracle::meet_by_axes(oracle::exact_polytope({plate, turned}),
                                                   oracle::exact_polytope({*other, place})));
                CHECK(meet == oracle::meet_quickly({plate, turned}, {*other, place}, {}, {}));
                if (other == &point && step < -20) CHECK(meet);
                if (other == &point && step > 20) CHECK_FALSE(meet);
                ++(meet ? met : apart);
            }
        CHECK(met > 80);
        CHECK(apart > 20);
        CHECK_FALSE(intersects({rod, at({})}, {rod, at({4.5, 0, 0})}));
        CHECK_FALSE(oracle::meet_by_axes(oracle::exact_polytope({rod, at({})}),
                                         oracle::exact_polytope({rod, at({4.5, 0, 0})})));
        CHECK(intersects({rod, at({})}, {rod, at({4, 0, 0})}));
        CHECK(oracle::meet_by_axes(oracle::exact_polytope({point, at({})}), oracle::exact_polytope({point, at({})})));
    }

    TEST_CASE("yes and no are exact in each decade of gap and overlap, at each offset, cold and warm") {
        std::uint64_t seed = 1;
        int pairs = 0, brute = 0, meeting = 0;
        for (const double offset : {0.0, 1e3, 1e7})
            for (int decade = 1; decade <= 12; ++decade)
                for (const double sign : {1.0, -1.0}) {
                    const Wrong wrong = count_wrong(seed++, pairs_per_class(), sign * std::pow(10.0, -decade), offset);
                    CHECK(wrong.verdicts == 0);
                    CHECK(wrong.cached == 0);
                    brute += wrong.brute;
                    meeting += wrong.meeting;
                    pairs += pairs_per_class();
                }
        MESSAGE(pairs << " pairs, " << meeting << " of them meet; " << brute << " needed brute force");
    }

    TEST_CASE("sizes from 1e-6 to 1e6 in one pair") {
        RandomShapes random(5);
        for (int i = 0; i < 300; ++i) {
            const double size_a = std::pow(10.0, random.number(-6, 6)), size_b = std::pow(10.0, random.number(-6, 6));
            const Shape a = random.polytope(12, size_a), b = random.polytope(12, size_b);
            const double gap = std::min(size_a, size_b) * std::pow(10.0, random.number(-9, -1)) * (i % 2 ? 1 : -1);
            const CasePair where = nearly_touching(random, a, b, gap, 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const bool truth =
                oracle::meet(oracle::exact_polytope(pa), oracle::exact_polytope(pb), {where.normal}, {}, {});
            CHECK(intersects(pa, pb) == truth);
        }
    }

    TEST_CASE("distance: the bounds are close, hold in exact arithmetic, and the points lie on the shapes") {
        RandomShapes random(6);
        for (int i = 0; i < 400; ++i) {
            const Shape a = random.polytope(32), b = random.polytope(32);
            const CasePair where = nearly_touching(random, a, b, std::pow(10.0, random.number(-11, 1)), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const Distance d = distance(pa, pb);
            const double size =
                a.core_radius() + b.core_radius() + glm::length(where.pose_a.translation - where.pose_b.translation);
            if (d.distance == 0.0) continue;
            CHECK(d.upper - d.lower <= 1e-9 * size);
            CHECK(d.distance >= d.lower);
            CHECK(d.distance <= d.upper);
            CHECK(glm::distance(d.on_a, d.on_b) == doctest::Approx(d.distance).epsilon(1e-6));
            const auto ea = oracle::exact_polytope(pa), eb = oracle::exact_polytope(pb);
            // The gap along n proves the lower bound: gap ≥ lower · |n|.
            const oracle::Vec3z n = oracle::scaled(d.normal, 2 * oracle::kBits);
            const mpz_class gap = oracle::gap_along(ea, eb, n), lower = oracle::scaled(d.lower, 2 * oracle::kBits);
            CHECK(gap > 0);
            CHECK(gap * gap >= lower * lower * oracle::dot(n, n));
            const Distance inside_a = distance({a, where.pose_a}, {Shape::sphere(0).value(), at(d.on_a)});
            CHECK(inside_a.distance <= 1e-13 * size);
        }
    }

    TEST_CASE("depth: the bounds are close and hold against all faces of the difference body, in rationals") {
        RandomShapes random(7);
        for (int i = 0; i < 60; ++i) {
            const Shape a = i % 4 == 0 ? random.box() : random.hull(4 + random.index(4));
            const Shape b = random.hull(4 + random.index(i % 4 == 0 ? 2 : 4));
            const double overlap = i % 3 == 0 ? 0.3 : std::pow(10.0, random.number(-8, -1));
            const CasePair where = nearly_touching(random, a, b, -overlap, i % 5 == 0 ? 1e5 : 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const Penetration p = penetration(pa, pb);
            if (!p.overlapping) continue;
            const auto ea = oracle::exact_polytope(pa), eb = oracle::exact_polytope(pb);
            const mpq_class truth = oracle::squared_depth(ea, eb);
            CHECK(mpq_class(p.lower) * mpq_class(p.lower) <= truth);
            CHECK(mpq_class(p.upper) * mpq_class(p.upper) >= truth);
            const double size =
                a.core_radius() + b.core_radius() + glm::length(where.pose_a.translation - where.pose_b.translation);
            CHECK(p.upper - p.lower <= 1e-9 * size);
            CHECK(p.depth == doctest::Approx(std::sqrt(truth.get_d())).epsilon(1e-7));
        }
    }

    TEST_CASE("moving by the depth parts the shapes, and the bounds are close, for hulls of 32 vertices") {
        RandomShapes random(8);
        int overlapping = 0;
        for (int i = 0; i < 1000; ++i) {
            const Shape a = random.polytope(32), b = random.polytope(32);
            const CasePair where = nearly_touching(random, a, b, -std::pow(10.0, random.number(-10, 0)), 0.0);
            const Penetration p = penetration({a, where.pose_a}, {b, where.pose_b});
            CHECK(p.overlapping == intersects({a, where.pose_a}, {b, where.pose_b}));
            if (!p.overlapping) continue;
            ++overlapping;
            const double size =
                a.core_radius() + b.core_radius() + glm::length(where.pose_a.translation - where.pose_b.translation);
            CHECK(p.upper - p.lower <= 1e-9 * size);
            RigidTransform moved = where.pose_b;
            moved.translation += p.normal * (p.upper + 1e-14 * size);
            CHECK_FALSE(intersects({a, where.pose_a}, {b, moved}));
        }
        CHECK(overlapping > 500);
    }

    TEST_CASE("cylinders and cones: the bounds hold each other, and moving by the upper one parts the shapes") {
        RandomShapes random(9);
        double widest_depth = 0.0, widest_gap = 0.0;
        for (int i = 0; i < 400; ++i) {
            const float h = static_cast<float>(random.number(0.2, 1)), r = static_cast<float>(random.number(0.2, 1));
            const Shape a = i % 2 == 0 ? Shape::cylinder(h, r).value() : Shape::cone(h, r).value();
            const Shape b = i % 3 == 0 ? Shape::cone(r, h).value() : i % 3 == 1 ? random.hull(20) : random.box();
            const CasePair where =
                nearly_touching(random, a, b, std::pow(10.0, random.number(-6, -0.5)) * (i % 4 < 2 ? 1 : -1), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const double size = a.core_radius() + b.core_radius() + glm::length(where.pose_b.translation);
            const Distance d = distance(pa, pb);
            widest_gap = std::max(widest_gap, (d.upper - d.lower) / size);
            const Penetration p = penetration(pa, pb);
            CHECK(p.overlapping == intersects(pa, pb));
            if (!p.overlapping) continue;
            CHECK(p.lower <= p.upper);
            widest_depth = std::max(widest_depth, (p.upper - p.lower) / size);
            RigidTransform moved = where.pose_b;
            moved.translation += p.normal * (p.upper + 1e-7 * size);
            CHECK_FALSE(intersects(pa, {b, moved}));
        }
        MESSAGE("bounds of distances within " << widest_gap << ", of depths within " << widest_depth << " of the size");
        CHECK(widest_gap <= 1e-9);
        CHECK(widest_depth <= 1e-5);
    }

    TEST_CASE("one shape at two poses is as deep in itself as its copy is, thinner than rounding of normals") {
        RandomShapes random(9);
        int overlapping = 0;
        for (int i = 0; i < 3000; ++i) {
            std::vector<glm::vec3> points;
            const double y = std::pow(10.0, random.number(-8.5, -7.0)), z = std::pow(10.0, random.number(-8.5, -7.0));
            const int count = 4 + random.index(8);
            for (int k = 0; k < count; ++k)
                points.emplace_back(random.number(-1, 1), y * random.number(-1, 1), z * random.number(-1, 1));
            const Result<Hull> hull = Hull::build(points);
            if (!hull) continue;
            const Shape shape = Shape::hull(*hull), copy = shape;
            const RigidTransform here{random.rotation(), {}};
            RigidTransform there{here.rotation, 1e-8 * random.direction()};
            const double turn = std::pow(10.0, random.number(-9.0, -1.0));
            there.rotation = here.rotation * glm::mat3_cast(glm::angleAxis(turn, random.direction()));
            const Penetration same = penetration({shape, here}, {shape, there}),
                              other = penetration({shape, here}, {copy, there});
            CHECK(same.overlapping == other.overlapping);
            CHECK(same.lower <= same.upper);
            CHECK(same.lower == other.lower);
            CHECK(same.upper == other.upper);
            overlapping += same.overlapping;
        }
        CHECK(overlapping > 1000);
    }

    TEST_CASE("thin discs that nearly lie on each other and are apart by 2e-7 of the size do not meet") {
        RandomShapes random(10);
        int asked = 0;
        for (int i = 0; i < 1500; ++i) {
            const auto disc = [&] {
                const auto height = static_cast<float>(std::pow(10.0, random.number(-4, -2)));
                return Shape::cylinder(height, static_cast<float>(random.number(0.05, 0.2))).value();
            };
            const Shape a = disc(), b = disc();
            const RigidTransform here{random.rotation(), {}};
            const double turn = std::pow(10.0, random.number(-9, -1));
            RigidTransform there{here.rotation * glm::mat3_cast(glm::angleAxis(turn, random.direction())),
                                 std::pow(10.0, random.number(-4, -1.3)) * random.direction()};
            const Penetration p = penetration({a, here}, {b, there});
            if (!p.overlapping) continue;
            const double size = a.core_radius() + b.core_radius() + glm::length(there.translation);
            there.translation += p.normal * (p.upper + 2e-7 * size);
            CHECK_FALSE(intersects({a, here}, {b, there}));
            ++asked;
        }
        CHECK(asked > 300);
    }
}
