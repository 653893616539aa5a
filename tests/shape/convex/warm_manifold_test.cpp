// SPDX-License-Identifier: MIT
// Manifolds of pairs that remember the frame before.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <limits>
#include <set>
#include <vector>

#include "contact_ids.hpp"
#include "counting_memory.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// The area of the points' polygon, in their order.
double area(const Manifold& m) {
    glm::dvec3 sum(0.0);
    for (int i = 1; i + 1 < m.count; ++i)
        sum += glm::cross(m.points[i].position - m.points[0].position, m.points[i + 1].position - m.points[0].position);
    return 0.5 * glm::length(sum);
}

// What of a polygon is within the prism over a face along its normal, by cutting it plane by plane.
std::vector<glm::dvec3> cut_by_prism(std::vector<glm::dvec3> polygon, const std::vector<glm::dvec3>& face,
                                     const glm::dvec3& normal) {
    for (std::size_t k = 0; k < face.size(); ++k) {
        const glm::dvec3 outward = glm::normalize(glm::cross(face[(k + 1) % face.size()] - face[k], normal));
        std::vector<glm::dvec3> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double from = glm::dot(outward, p - face[k]), to = glm::dot(outward, q - face[k]);
            if (from <= 0.0) kept.push_back(p);
            if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) kept.push_back(p + from / (from - to) * (q - p));
        }
        polygon = kept;
    }
    return polygon;
}

std::vector<glm::dvec3> corners_of_face(const Hull& hull, int face, const RigidTransform& pose) {
    std::vector<glm::dvec3> corners;
    for (const std::uint16_t v : hull.face_vertices(face))
        corners.push_back(pose.rotation * glm::dvec3(hull.vertices()[v]) + pose.translation);
    return corners;
}

}  // namespace

TEST_SUITE("convex/warm_manifold") {
    TEST_CASE("a warm call returns what a cold one does, up to ties, and ids stay while a shape slides and rocks") {
        RandomShapes random(2);
        int kept = 0, frames = 0;
        for (int i = 0; i < 60; ++i) {
            const Shape a = Shape::box({2, 0.5f, 2}).value(),
                        b = i % 2 == 0 ? Shape::box({0.5f, 0.5f, 0.5f}).value() : random.hull(32);
            const RigidTransform ground = at({});
            PairCache cache;
            std::set<std::pair<Feature, Feature>> last;
            for (int frame = 0; frame < 60; ++frame) {
                const double t = frame / 60.0;
                RigidTransform pose = at({0.05 * t, 0.0, 0.03 * t});
                pose.rotation = glm::mat3_cast(glm::angleAxis(1e-3 * std::sin(9 * t), glm::dvec3(0.6, 0, 0.8)));
                const glm::dvec3 low = support_point(b, glm::transpose(pose.rotation) * glm::dvec3(0, -1, 0));
                pose.translation.y = 0.5 - (pose.rotation * low).y - 1e-3 - 1e-4 * std::sin(20 * t);
                const ShapeAtPose pa{a, ground}, pb{b, pose};
                const Manifold warm = contact_manifold(pa, pb, {.margin = 0.01}, &cache);
                const Manifold cold = contact_manifold(pa, pb, {.margin = 0.01});
                CHECK(std::abs(warm.depth - cold.depth) <= 1e-4 * (a.core_radius() + b.core_radius() + 1.0));
                CHECK(glm::dot(warm.normal, cold.normal) == doctest::Approx(1.0).epsilon(1e-6));
                if (frame > 0) ++frames, kept += ids(warm) == last;
                last = ids(warm);
            }
        }
        CHECK(kept >= frames * 95 / 100);
    }

    // The face of the frame before tells of a gap, 2e-6 of the size, where other points meet.
    TEST_CASE("round shapes that meet by little have a point, whatever face the frame before had") {
        const std::vector<glm::vec3> points{{7.75f, 0.0859069824f, -11.125f}, {-6.78479385f, 14.875f, 12.375f},
                                            {0.25f, -11.625f, -9.875f},       {12.75f, 5.75f, 0.625f},
                                            {-12.5f, 0.75f, 1.15012884f},     {0.0f, -12.375f, 3.03466797f},
                                            {14.125f, 1.24355674f, 0.0f}};
        const Hull hull = Hull::build(points).value();
        const Shape a = Shape::hull(hull), b = Shape::rounded(Shape::box(glm::vec3(1.5f)).value(), 2.125f).value();
        const RigidTransform pose_a{{{-0.95819209039547992, 0.15819209039548021, -0.23841807909604518},
                                     {-0.072316384180790949, 0.67231638418079109, 0.7367231638418078},
                                     {0.2768361581920904, 0.72316384180790949, -0.63276836158192085}},
                                    {0.94829255342483521, 0.125, -15.125}};
        const RigidTransform pose_b{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                    {-12.753576550384418, -9.2189960879518615, -12.068284181183571}};
        REQUIRE(intersects({a, pose_a}, {b, pose_b}));
        int tried = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0})
                for (int exponent = 0; exponent < 60; ++exponent) {
                    RigidTransform before = pose_b;
                    before.translation[axis] += std::ldexp(sign, -exponent);
                    PairCache cache;
                    tried += contact_manifold({a, pose_a}, {b, before}, {}, &cache).count > 0;
                    CHECK(contact_manifold({a, pose_a}, {b, pose_b}, {}, &cache).count > 0);
                }
        CHECK(tried > 100);
    }

    // Found by fuzzing: a sliver's clipped face was from 2e-5 to 7e-4 deep, and the proof took all of it for the least.
    TEST_CASE("a sliver that slides off a face has no point, whatever face the frame before had") {
        const std::vector<glm::vec3> sliver = {{0, -0x1p-3f, -0x1p-3f},
                                               {-0x1p-3f, -0x1.ff5718p-4f, 0},
                                               {0, -0x1p-3f, -0x1.cp+1f},
                                               {-0x1.ff5718p-4f, -0x1.ff5718p-4f, -0x1.ff5718p-4f}};
        const std::vector<glm::vec3> wedge = {{0x1.48p+3f, -0x1p-3f, -0x1.ff5718p-4f},
                                              {-0x1.ff5718p-4f, -0x1.ff5718p-4f, -0x1.15c5fp-3f},
                                              {0x1.48p+3f, 0x1.48p+3f, 0x1.48p+3f},
                                              {0x1.48p+3f, -0x1.ff5718p-4f, 0x1.6f869ap+2f},
                                              {-0x1.ff5718p-4f, -0x1.ff5718p-4f, 0x1.6aa8e8p+3f},
                                              {-0x1p-3f, -0x1p-3f, 0}};
        const Hull a = Hull::build(sliver).value(), b = Hull::build(wedge).value();
        const ShapeAtPose thin{Shape::hull(a), at({0, -0x1.102a3ap-3, -0x1.ff5718p-4})};
        const Shape wide = Shape::hull(b);
        const RigidTransform touching = at({-0x1.4cp+3, -0x1.0fd5c6p-3, 0}), past = at({-0x1.2cp+3, -0x1.0fd5c6p-3, 0});
        PairCache cache;
        REQUIRE(contact_manifold(thin, {wide, touching}, {}, &cache).count > 0);
        REQUIRE(cache.reference != 0);
        CHECK_FALSE(intersects(thin, {wide, past}));
        CHECK(contact_manifold(thin, {wide, past}, {}, &cache).count == 0);

        // The same from many places nearby.
        RandomShapes random(77);
        int meeting = 0, apart = 0;
        for (int i = 0; i < 20000; ++i) {
            PairCache from = cache;
            RigidTransform near = past;
            near.translation +=
                glm::dvec3(random.number(-1.0, 1.0), random.number(-1e-3, 1e-3), random.number(-1e-3, 1e-3));
            const bool meet = intersects(thin, {wide, near});
            ++(meet ? meeting : apart);
            CHECK((contact_manifold(thin, {wide, near}, {}, &from).count > 0) == meet);
        }
        CHECK(meeting > 5000);
        CHECK(apart > 5000);
    }

    TEST_CASE("a face that is no longer the least deep is given up") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const RigidTransform ground = at({}), top = at({0.5, 1.99, 0.25}), side = at({1.9, 1.5, 0.25});
        PairCache cache;
        CHECK(contact_manifold({box, ground}, {box, top}, {}, &cache).normal.y == doctest::Approx(1.0));
        const Manifold m = contact_manifold({box, ground}, {box, side}, {}, &cache);
        CHECK(m.normal.x == doctest::Approx(1.0));
        CHECK(m.depth == doctest::Approx(0.1));
        RandomShapes random(5);
        for (int i = 0; i < 400; ++i) {
            const Shape a = random.polytope(24), b = random.polytope(24);
            const CasePair where = nearly_touching(random, a, b, -0.01, 0.0);
            RigidTransform next = where.pose_b;
            next.translation += (i % 2 == 0 ? 0.3 : 0.03) * random.direction();
            PairCache kept;
            (void)contact_manifold({a, where.pose_a}, {b, where.pose_b}, {.margin = 0.02}, &kept);
            const Manifold warm = contact_manifold({a, where.pose_a}, {b, next}, {.margin = 0.02}, &kept);
            const Manifold cold = contact_manifold({a, where.pose_a}, {b, next}, {.margin = 0.02});
            const double size =
                a.core_radius() + b.core_radius() + glm::length(next.translation - where.pose_a.translation);
            CHECK((warm.count > 0) == (cold.count > 0));
            CHECK(std::abs(warm.depth - cold.depth) <= 1.5e-4 * size);
        }
    }

    // A corner, an edge or a face of b comes down on a face of a, in its middle or near its rim. A neighbor of the
    // corner is about as high as the margin, or the edge to it passes the rim about there.
    TEST_CASE("warm points are the corners of what both faces have in common within the margin") {
        RandomShapes random(91);
        int asked = 0, lone = 0, several = 0, at_rim = 0;
        for (int i = 0; i < 20000; ++i) {
            const double size_b = i % 3 == 0 ? 0.1 : 1.0;
            const HullOptions flat{.face_tolerance = 0.0f};
            const Hull a = Hull::build(random.points(4 + random.index(12)), flat).value(),
                       b = Hull::build(random.points(4 + random.index(28), size_b), flat).value();
            const Shape shape_a = Shape::hull(a), shape_b = Shape::hull(b);
            const int face = random.index(a.face_count());
            const RigidTransform pose_a{random.rotation(), 3.0 * random.direction()};
            const glm::dvec3 normal = glm::normalize(pose_a.rotation * a.face_normal(face));
            const std::vector<glm::dvec3> rim = corners_of_face(a, face, pose_a);
            // A vertex of b downwards, or nearly a face.
            const glm::dvec3 down = i % 2 == 0 ? random.direction()
                                               : b.face_normal(random.index(b.face_count())) +
                                                     std::pow(10.0, random.number(-4, 0)) * random.direction();
            RigidTransform pose_b{pose_a.rotation, {}};
            const glm::dquat turn(glm::normalize(down), -glm::normalize(a.face_normal(face)));
            pose_b.rotation = pose_a.rotation * glm::mat3_cast(glm::normalize(turn));
            const glm::dvec3 low = support_point(shape_b, glm::transpose(pose_b.rotation) * -normal);
            glm::dvec3 place(0.0);
            double whole = 0.0;
            for (const glm::dvec3& corner : rim) {
                const double weight = std::pow(random.number(0, 1), 4.0);
                place += weight * corner, whole += weight;
            }
            const double depth = random.number(-0.02, 0.02) * size_b;
            pose_b.translation = place / whole - pose_b.rotation * low - depth * normal;
            const ShapeAtPose pa{shape_a, pose_a}, pb{shape_b, pose_b};
            // The margin: as high as a vertex of b, or as where an edge of b passes the rim, or any.
            const auto height = [&](const glm::dvec3& p) { return glm::dot(normal, p - rim[0]); };
            std::vector<double> heights{random.number(0.0, 0.5) * size_b};
            for (const glm::vec3& v : b.vertices())
                heights.push_back(height(pose_b.rotation * glm::dvec3(v) + pose_b.translation));
            for (int f = 0; f < b.face_count(); ++f)
                for (const glm::dvec3& p : cut_by_prism(corners_of_face(b, f, pose_b), rim, normal))
                    heights.push_back(height(p));
            const double near = heights[static_cast<std::size_t>(random.index(static_cast<int>(heights.size())))];
            const double margin = std::max(
                0.0, near + std::pow(10.0, random.number(-12, -2)) * (random.index(2) == 0 ? -1.0 : 1.0) * size_b);
            PairCache cache;
            cache.reference = 1;
            cache.face = static_cast<std::uint16_t>(face);
            const ManifoldOptions options{.margin = margin, .max_points = 8};
            Manifold warm = contact_manifold(pa, pb, options, &cache);
            if (cache.reference != 1 || cache.face != face || warm.count == 0) continue;
            if (glm::dot(warm.normal, normal) < 1.0 - 1e-12) continue;
            // Both faces, as the manifold has them.
            const glm::dvec3 against = glm::transpose(pose_b.rotation) * -normal;
            int facing = 0;
            for (int f = 1; f < b.face_count(); ++f)
                if (glm::dot(b.face_normal(f), against) > glm::dot(b.face_normal(facing), against)) facing = f;
            const double pair_size = 4.0 + size_b, near_enough = 1e-9 * pair_size;
            std::vector<glm::dvec3> wanted;
            for (const glm::dvec3& p : cut_by_prism(corners_of_face(b, facing, pose_b), rim, normal))
                wanted.push_back(p);
            ++asked;
            // The deepest vertex is there, also where it is not of the face that looks down most.
            const glm::dvec3 deepest = pose_b.rotation * low + pose_b.translation;
            wanted.push_back(deepest);
            const auto is_at = [&](const glm::dvec3& p, const ContactPoint& c) {
                return glm::distance(p - 0.5 * height(p) * normal, c.position) <= 30.0 * near_enough;
            };
            int within = 0;
            bool is_wrong = false;
            for (int k = 0; k < warm.count; ++k) {
                const ContactPoint& c = warm.points[k];
                bool found = false;
                for (const glm::dvec3& p : wanted)
                    found = found || (is_at(p, c) && std::abs(c.depth + height(p)) <= 30.0 * near_enough);
                is_wrong = is_wrong || !found || c.depth < -margin - 1e-12 * pair_size;
            }
            for (std::size_t w = 0; w + 1 < wanted.size(); ++w) {
                if (height(wanted[w]) > margin - near_enough) continue;
                ++within;
                bool found = warm.count == 8;  // of more, eight are kept
                for (int k = 0; k < warm.count; ++k) found = found || is_at(wanted[w], warm.points[k]);
                is_wrong = is_wrong || !found;
            }
            CHECK_FALSE(is_wrong);
            lone += warm.count == 1;
            several += within > 1;
            for (int k = 0; k < warm.count; ++k) at_rim += warm.points[k].on_a.kind != FeatureKind::face;
        }
        MESSAGE(asked << " asked, " << lone << " with one point, " << several << " with several, " << at_rim
                      << " points at the rim");
        CHECK(asked > 10000);
        CHECK(lone > 1000);
        CHECK(several > 1000);
        CHECK(at_rim > 1000);
    }

    TEST_CASE("warm calls allocate nothing") {
        RandomShapes random(4);
        for (int i = 0; i < 50; ++i) {
            const Shape a = random.hull(32), b = i % 2 == 0 ? random.box() : random.hull(32);
            const CasePair where = nearly_touching(random, a, b, 0.02 * (i % 3 - 1.5), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            PairCache cache;
            (void)contact_manifold(pa, pb, {.margin = 0.1}, &cache);
            const CountingMemory memory;
            (void)contact_manifold(pa, pb, {.margin = 0.1}, &cache);
            (void)intersects(pa, pb, &cache);
            (void)distance(pa, pb, &cache);
            (void)cast(pa, {}, pb, {.velocity = -where.normal, .spin = {1, 2, 3}}, {}, &cache);
            CHECK(memory.allocations() == 0);
        }
    }

    // Prisms on eight corners that stand on each other and sway: which corner is the deepest goes round.
    TEST_CASE("if there are more points than wanted, those of the last frame stay while they are as good") {
        std::vector<glm::vec3> corners;
        for (int k = 0; k < 8; ++k)
            for (const float y : {-0.5f, 0.5f}) {
                const float angle = 0.785398f * static_cast<float>(k) + 0.3f;
                corners.emplace_back(std::cos(angle), y, std::sin(angle));
            }
        const Hull hull = Hull::build(corners).value();
        for (glm::vec3& p : corners) p *= glm::vec3(1.3f, 1.0f, 1.3f);
        const Hull wide_hull = Hull::build(corners).value();
        const Shape box = Shape::box({1.5f, 0.5f, 1.5f}).value(), prism = Shape::hull(hull),
                    wide = Shape::hull(wide_hull);
        for (const Shape* below : {&wide, &box}) {
            PairCache cache;
            std::set<std::pair<Feature, Feature>> before;
            int kept = 0, all = 0, eight = 0;
            for (int frame = 0; frame < 2000; ++frame) {
                const double round = 0.02 * frame;
                RigidTransform top = at({1e-4 * std::cos(round), 0.999, 1e-4 * std::sin(round)});
                top.rotation = glm::mat3_cast(
                    glm::angleAxis(2e-5 * std::sin(0.37 * frame), glm::dvec3(std::cos(round), 0, std::sin(round))));
                const RigidTransform low = at({});
                PairCache same = cache;
                const Manifold m = contact_manifold({*below, low}, {prism, top}, {}, &cache),
                               full = contact_manifold({*below, low}, {prism, top}, {.max_points = 8}, &same),
                               fresh = contact_manifold({*below, low}, {prism, top});
                REQUIRE(m.count == 4);
                eight += full.count == 8;
                CHECK(std::abs(m.depth - fresh.depth) <= 2e-4);
                double deepest = -1.0;
                for (int i = 0; i < 4; ++i) {
                    deepest = std::max(deepest, m.points[i].depth);
                    CHECK(ids(full).count({m.points[i].on_a, m.points[i].on_b}) == 1);
                }
                CHECK(deepest >= full.depth - 4e-4);
                CHECK(area(m) >= 0.9 * area(fresh) - 1e-12);
                for (const auto& id : ids(m)) kept += static_cast<int>(before.count(id));
                if (frame > 0) all += 4;
                before = ids(m);
            }
            CHECK(eight > 1500);
            CHECK(kept >= 0.99 * all);
        }
    }

    TEST_CASE("points of the frame before that lie together now make room for others") {
        const Shape box = Shape::box({1, 1, 1}).value();
        PairCache cache;
        for (int frame = 0; frame < 200; ++frame) {
            RigidTransform top = at({0.01 * frame, 1.99, 0.004 * frame});
            top.rotation = glm::mat3_cast(glm::angleAxis(0.785398 + 0.002 * frame, glm::dvec3(0, 1, 0)));
            const RigidTransform low = at({});
            const Manifold m = contact_manifold({box, low}, {box, top}, {}, &cache),
                           fresh = contact_manifold({box, low}, {box, top});
            CHECK(m.count == fresh.count);
            CHECK(m.depth == doctest::Approx(0.01));
            CHECK(area(m) >= 0.9 * area(fresh) - 1e-12);
        }
    }
}
