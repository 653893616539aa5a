// SPDX-License-Identifier: MIT
// Manifolds and depths of two boxes, which have a way of their own, beside hulls of the same corners, which have not.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <optional>
#include <vector>

#include "penetration_fields.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

constexpr double kOffsets[] = {0.0, 1e3, 1e7};

// Cubes, plates, rods, rectangles, segments; one in eight is rounded.
Shape random_box(RandomShapes& random) {
    glm::dvec3 half(random.number(0.1, 1), random.number(0.1, 1), random.number(0.1, 1));
    const int form = random.index(8);
    if (form == 0) half.y *= 1e-4;
    if (form == 1) half.y *= 1e-3, half.z *= 1e-3;
    if (form == 2) half.x = 0.0;
    if (form == 3) half *= std::pow(10.0, random.number(-3, 3));
    const Shape box = Shape::box(glm::vec3(half)).value();
    return random.index(8) == 0 ? Shape::rounded(box, 0.1f).value() : box;
}

// Turned a little against a, so that edges are parallel, nearly or not at all.
glm::dmat3 nearly(RandomShapes& random, const glm::dmat3& rotation) {
    if (random.index(4) == 0) return rotation;
    const double angle = std::pow(10.0, random.number(-13, 0));
    const glm::dvec3 axis = random.index(2) == 0 ? rotation[1] : random.direction();
    return glm::mat3_cast(glm::angleAxis(angle, axis)) * rotation;
}

// As far from a rotation as a valid pose may be.
void skew(RandomShapes& random, glm::dmat3& rotation) {
    for (int k = 0; k < 3; ++k) rotation[k] += 2e-7 * random.direction();
}

struct BoxCase {
    Shape a, b;
    RigidTransform pose_a, pose_b;
    double gap, size;
};
BoxCase random_case(RandomShapes& random) {
    BoxCase c{random_box(random), random_box(random), {}, {}, 0.0, 0.0};
    c.gap = std::pow(10.0, -random.number(1, 12)) * (random.index(2) == 0 ? 1.0 : -1.0);
    const CasePair where = nearly_touching(random, c.a, c.b, c.gap, kOffsets[random.index(3)]);
    c.pose_a = where.pose_a;
    c.pose_b = where.pose_b;
    if (random.index(2) == 0) c.pose_b.rotation = nearly(random, c.pose_a.rotation);
    if (random.index(2) == 0) skew(random, c.pose_a.rotation);
    if (random.index(2) == 0) skew(random, c.pose_b.rotation);
    c.size = c.a.core_radius() + c.b.core_radius() + c.a.radius() + c.b.radius() +
             glm::length(c.pose_b.translation - c.pose_a.translation);
    return c;
}

// As above, but b stands anywhere where the boxes may overlap.
BoxCase deep_case(RandomShapes& random) {
    BoxCase c = random_case(random);
    if (random.index(4) == 0) return c;
    const double reach = c.a.core_radius() + c.b.core_radius();
    c.pose_b.translation = c.pose_a.translation + random.number(0, 1) * reach * random.direction();
    c.size = reach + c.a.radius() + c.b.radius() + glm::length(c.pose_b.translation - c.pose_a.translation);
    return c;
}

double off(double value, double low, double high) {
    return std::max(0.0, std::max(low - value, value - high));
}

// A hull of the box's corners, with its rounding.
class BoxAsHull {
  public:
    explicit BoxAsHull(const Shape& box) : hull_(Hull::build(corners_of(box)).value()), shape_(Shape::hull(hull_)) {
        if (box.radius() > 0.0) shape_ = Shape::rounded(shape_, box.radius()).value();
    }
    BoxAsHull(const BoxAsHull&) = delete;
    BoxAsHull& operator=(const BoxAsHull&) = delete;
    [[nodiscard]] const Shape& shape() const { return shape_; }

  private:
    static std::vector<glm::vec3> corners_of(const Shape& box) {
        const glm::vec3 h(box.half_extents());
        std::vector<glm::vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.emplace_back((i & 1) != 0 ? h.x : -h.x, (i & 2) != 0 ? h.y : -h.y, (i & 4) != 0 ? h.z : -h.z);
        return corners;
    }
    Hull hull_;
    Shape shape_;
};

bool is_solid(const Shape& box) {
    const glm::dvec3 h = box.half_extents();
    return h.x > 0.0 && h.y > 0.0 && h.z > 0.0;
}

// By the search that all polytopes share.
Penetration general_penetration(const BoxCase& c) {
    if (!is_solid(c.a) || !is_solid(c.b)) return penetration({c.a, c.pose_a}, {c.b, c.pose_b});
    const BoxAsHull a(c.a), b(c.b);
    return penetration({a.shape(), c.pose_a}, {b.shape(), c.pose_b});
}

// The least overlap of two boxes over all axes that can be the least: the difference body has six directions of edges,
// and each face is across two of them. Negative if an axis parts them.
double exact_depth(const ShapeAtPose& a, const ShapeAtPose& b) {
    using Vector3 = std::array<mpq_class, 3>;
    const auto exact = [](const glm::dvec3& v) { return Vector3{mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)}; };
    const auto dot = [](const Vector3& u, const Vector3& v) {
        return mpq_class(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
    };
    std::array<Vector3, 6> edges;
    Vector3 between = exact(b.pose.translation);
    const Vector3 from = exact(a.pose.translation);
    for (std::size_t k = 0; k < 3; ++k) {
        between[k] -= from[k];
        for (std::size_t side = 0; side < 2; ++side) {
            const ShapeAtPose& box = side == 0 ? a : b;
            const auto axis = static_cast<int>(k);
            edges[3 * side + k] = exact(box.pose.rotation[axis]);
            for (mpq_class& x : edges[3 * side + k]) x *= box.shape.half_extents()[axis];
        }
    }
    std::optional<mpq_class> least;  // squared
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = i + 1; j < 6; ++j) {
            Vector3 m;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
                m[k] = edges[i][u] * edges[j][v] - edges[i][v] * edges[j][u];
            }
            const mpq_class squared = dot(m, m);
            if (squared == 0) continue;
            mpq_class overlap = -abs(dot(m, between));
            for (const Vector3& edge : edges) overlap += abs(dot(m, edge));
            if (overlap < 0) return -1.0;
            const mpq_class depth = overlap * overlap / squared;
            if (!least || depth < *least) least = depth;
        }
    return std::sqrt(least->get_d());
}

// How far the manifold's depth is beyond what is proven of the pair, and its points outside of the shapes.
double wrong_depth(const BoxCase& c, const Manifold& m) {
    const ShapeAtPose a{c.a, c.pose_a}, b{c.b, c.pose_b};
    if (const Penetration p = general_penetration(c); p.overlapping) return off(m.depth, p.lower, p.upper);
    const Distance d = distance(a, b);
    return off(-m.depth, d.lower, d.upper);
}

// Along a unit vector from a to b, with roundings.
double overlap_along(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& n) {
    const auto radius = [&n](const ShapeAtPose& p) {
        double sum = p.shape.radius();
        for (int k = 0; k < 3; ++k) sum += p.shape.half_extents()[k] * std::abs(glm::dot(p.pose.rotation[k], n));
        return sum;
    };
    return radius(a) + radius(b) - glm::dot(n, b.pose.translation - a.pose.translation);
}

double wrong_place(const BoxCase& c, const ContactPoint& p) {
    // Midway between the surfaces, along the normal.
    const double allowed = 0.5 * std::abs(p.depth);
    return std::max(closest_point({c.a, c.pose_a}, p.position).distance,
                    closest_point({c.b, c.pose_b}, p.position).distance) -
           allowed;
}

// Rotations as poses of crates have them: none, quarter turns, turns about one axis, any; skewed or not.
glm::dmat3 crate_rotation(RandomShapes& random) {
    const int form = random.index(6);
    if (form == 0) return glm::dmat3(1.0);
    if (form == 5) return glm::dmat3(1.0, 0.0, 0.0, 1e-20, 1.0, 0.0, 0.0, -1e-17, 1.0);
    if (form == 1) return glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1);
    if (form == 2) {
        const double angle = random.index(2) == 0 ? 0.7853981633974483 : random.number(0, 6);
        const double c = std::cos(angle), s = std::sin(angle);
        return glm::dmat3(c, 0, -s, 0, 1, 0, s, 0, c);
    }
    glm::dmat3 rotation = random.rotation();
    if (form == 3) skew(random, rotation);
    return rotation;
}

// Whether the boxes meet, by the search in exact integers, which boxes do not take otherwise.
bool meet_by_distance(const ShapeAtPose& a, const ShapeAtPose& b) {
    return distance(a, b).distance == 0.0;
}

void check_touch(const ShapeAtPose& a, const ShapeAtPose& b, bool meet, double size) {
    CHECK(intersects(a, b) == meet);
    CHECK(intersects(b, a) == meet);
    for (const double margin : {0.0, 1e-3 * size}) {
        PairCache cache;
        for (int frame = 0; frame < 3; ++frame) {
            const Manifold m =
                contact_manifold(a, b, {.margin = margin, .max_points = 8}, frame == 2 ? nullptr : &cache);
            CHECK((m.count > 0) == (meet || margin > 0.0));
            if (m.count == 0) continue;
            CHECK(std::abs(m.depth) <= 1e-13 * size);
            if (!meet) CHECK(m.depth <= 0.0);
            if (meet) CHECK(m.depth >= (margin == 0.0 ? 0.0 : -1e-15 * size));
            CHECK(glm::length(m.normal) == doctest::Approx(1.0).epsilon(1e-12));
            // Along the normal the boxes overlap by no more than rounding.
            CHECK(std::abs(overlap_along(a, b, m.normal)) <= 1e-13 * size + 1e-15 * glm::length(a.pose.translation));
            for (int k = 0; k < m.count; ++k)
                for (const ShapeAtPose* const shape : {&a, &b})
                    CHECK(closest_point(*shape, m.points[k].position).distance <=
                          0.5 * std::abs(m.points[k].depth) + 1e-9 * size + 1e-15 * glm::length(a.pose.translation));
        }
    }
}

}  // namespace

TEST_SUITE("convex/box_pair") {
    TEST_CASE("crates that touch exactly at faces, edges and corners meet, and 2^-50 beyond do not") {
        RandomShapes random(41);
        const auto dyadic = [&](double most) { return random.index(static_cast<int>(most * 64)) / 64.0 + 1.0 / 64; };
        for (int i = 0; i < 2000; ++i) {
            CAPTURE(i);
            const glm::dvec3 ha(dyadic(2), dyadic(2), dyadic(2)), hb(dyadic(2), dyadic(2), dyadic(2));
            const Shape a = Shape::box(glm::vec3(ha)).value(), b = Shape::box(glm::vec3(hb)).value();
            const glm::dvec3 place = i % 3 == 0 ? glm::dvec3(0.0) : glm::dvec3(dyadic(100), -dyadic(100), dyadic(100));
            glm::dvec3 offset(0.0);
            int touching = random.index(7) + 1;
            for (int k = 0; k < 3; ++k) {
                offset[k] = (touching >> k & 1) != 0 ? ha[k] + hb[k] : 0.5 * random.number(-1, 1) * (ha[k] + hb[k]);
                if (random.index(2) != 0) offset[k] = -offset[k];
            }
            const int axis = (touching & 1) != 0 ? 0 : (touching & 2) != 0 ? 1 : 2;
            const double size = glm::length(ha) + glm::length(hb) + glm::length(offset);
            for (const double beyond : {0.0, 0x1p-44, -0x1p-44}) {
                glm::dvec3 moved = place + offset;
                moved[axis] = place[axis] + (offset[axis] + std::copysign(beyond, beyond * offset[axis]));
                check_touch({a, at(place)}, {b, at(moved)}, beyond <= 0.0, size);
            }
        }
    }

    TEST_CASE(
        "boxes in one tilted frame that touch exactly, but for 2^-80 to 2^-102, meet iff that is towards each other") {
        RandomShapes random(49);
        for (int i = 0; i < 4000; ++i) {
            CAPTURE(i);
            // Half edges of powers of two keep the way from face to face exact.
            const glm::dvec3 ha(std::ldexp(1.0, -random.index(3)), std::ldexp(1.0, -random.index(3)),
                                std::ldexp(1.0, -random.index(3)));
            const Shape box = Shape::box(glm::vec3(ha)).value();
            const glm::dmat3 r = random.rotation();
            const int k = random.index(3);
            const glm::dvec3 normal = glm::cross(r[(k + 1) % 3], r[(k + 2) % 3]);
            const double beyond = std::ldexp(1.0, -80 - random.index(23));
            const bool towards = random.index(2) == 0;
            const RigidTransform a{r, (towards ? beyond : -beyond) * normal}, b{r, 2.0 * ha[k] * r[k]};
            CHECK(intersects({box, a}, {box, b}) == towards);
            CHECK(intersects({box, b}, {box, a}) == towards);
            CHECK((contact_manifold({box, a}, {box, b}).count > 0) == towards);
            CHECK(intersects({box, {r, glm::dvec3(0.0)}}, {box, b}));
        }
    }

    TEST_CASE("boxes that touch along an edge have a point at each end of their common stretch, and no other") {
        RandomShapes random(50);
        int meeting = 0;
        for (int i = 0; i < 12000; ++i) {
            CAPTURE(i);
            const auto side = [&] {
                return static_cast<float>(i % 3 == 0 ? (1 + random.index(8)) / 8.0 : random.number(0.2, 1.0));
            };
            const float ax = side(), ay = side(), az = side(), bx = side(), by = side(), bz = side();
            const glm::dvec3 ha(ax, ay, az), hb(bx, by, bz);
            const Shape a = Shape::box(glm::vec3(ha)).value(), b = Shape::box(glm::vec3(hb)).value();
            // b stands at a's edge x, z; in a's frame, or turned about the edge.
            const double turn = i % 2 == 0 ? 0.0 : random.number(-0.7, 0.7), c = std::cos(turn), s = std::sin(turn);
            const glm::dmat3 about_edge(c, 0, -s, 0, 1, 0, s, 0, c);
            const int how = random.index(4);
            const double yaw = how == 1 ? random.number(0, 6) : 0.0;
            const glm::dmat3 ra =
                how >= 2 ? random.rotation()
                         : glm::dmat3(std::cos(yaw), 0, -std::sin(yaw), 0, 1, 0, std::sin(yaw), 0, std::cos(yaw));
            const glm::dvec3 edge_b = about_edge * glm::dvec3(-hb.x, 0.0, -hb.z);
            const double y = random.number(-0.8, 0.8) * (ha.y + hb.y);
            const glm::dvec3 place = how == 3 ? 100.0 * random.direction() : glm::dvec3(0.0);
            const RigidTransform pose_a{ra, place},
                pose_b{ra * about_edge, place + ra * glm::dvec3(ha.x - edge_b.x, y, ha.z - edge_b.z)};
            const double ends[2] = {std::max(-ha.y, y - hb.y), std::min(ha.y, y + hb.y)};
            const double margin = random.index(2) == 0 ? 0.0 : 0.02;
            for (const bool swapped : {false, true}) {
                const ShapeAtPose first{swapped ? b : a, swapped ? pose_b : pose_a},
                    second{swapped ? a : b, swapped ? pose_a : pose_b};
                PairCache cache;
                for (int frame = 0; frame < 3; ++frame) {
                    const Manifold m = contact_manifold(first, second, {.margin = margin, .max_points = 8}, &cache);
                    if (margin == 0.0 && !intersects(first, second)) {
                        CHECK(m.count == 0);
                        continue;
                    }
                    ++meeting;
                    REQUIRE(m.count == 2);
                    for (const double end : ends) {
                        const glm::dvec3 at = place + ra * glm::dvec3(ha.x, end, ha.z);
                        CHECK(std::min(glm::distance(m.points[0].position, at),
                                       glm::distance(m.points[1].position, at)) <= 1e-12 * (1.0 + glm::length(place)));
                    }
                    CHECK(std::abs(m.depth) <= 1e-14 * (10.0 + glm::length(place)));
                    if (frame == 1) cache = {};
                }
            }
        }
        CHECK(meeting > 40000);
    }

    TEST_CASE("crates in frames of their own meet iff exact integers say so, at all ranges of sizes") {
        RandomShapes random(43);
        int meeting = 0, apart = 0;
        for (int i = 0; i < 8000; ++i) {
            CAPTURE(i);
            const double scale = i % 16 == 0 ? std::pow(10.0, random.number(-18, 14)) : 1.0;
            const Shape a = random.box(scale), b = random.box(scale);
            const glm::dvec3 ha = a.half_extents(), hb = b.half_extents();
            const glm::dmat3 ra = crate_rotation(random), yaw = crate_rotation(random);
            // Turned about a's axis y, or as it is, or anyhow.
            const int how = random.index(4);
            const double c = std::cos(0.3 * how), s = std::sin(0.3 * how);
            const glm::dmat3 rb = how == 0 ? ra : how == 3 ? yaw : ra * glm::dmat3(c, 0, -s, 0, 1, 0, s, 0, c);
            glm::dvec3 offset(random.number(-1, 1) * ha.x, ha.y + hb.y, random.number(-1, 1) * ha.z);
            if (how == 0 && random.index(2) == 0) offset.x = ha.x + hb.x;
            if (how == 3) offset = scale * random.direction();
            const RigidTransform pose_a{ra, i % 3 == 0 ? glm::dvec3(0.0) : 10.0 * scale * random.direction()};
            RigidTransform pose_b{rb, pose_a.translation + ra * offset};
            if (how == 3) {
                const glm::dvec3 n = random.index(2) == 0 ? glm::normalize(ra[1]) : random.direction();
                const double out = overlap_along({a, pose_a}, {b, pose_b}, n);
                pose_b.translation += out * n;
            }
            const double size =
                glm::length(ha) + glm::length(hb) + glm::length(pose_b.translation - pose_a.translation);
            const ShapeAtPose first{a, pose_a}, second{b, pose_b};
            const bool meet = meet_by_distance(first, second);
            CHECK(intersects(first, second) == meet);
            CHECK(intersects(second, first) == meet);
            CHECK((contact_manifold(first, second).count > 0) == meet);
            meeting += meet;
            apart += !meet;
            if (penetration(first, second).depth < 1e-14 * size && distance(first, second).distance < 1e-14 * size)
                check_touch(first, second, meet, size);
        }
        MESSAGE(meeting, " meet, ", apart, " do not");
        CHECK(meeting > 1000);
        CHECK(apart > 1000);
    }

    TEST_CASE(
        "the depth of two boxes is that of hulls of their corners, and every field is that of the shortest way out") {
        RandomShapes random(47);
        int deep = 0;
        for (int i = 0; i < 20000; ++i) {
            const BoxCase c = deep_case(random);
            if (!is_solid(c.a) || !is_solid(c.b)) continue;
            CAPTURE(i);
            const Penetration general = general_penetration(c);
            for (const bool swap : {false, true}) {
                const ShapeAtPose a = swap ? ShapeAtPose{c.b, c.pose_b} : ShapeAtPose{c.a, c.pose_a},
                                  b = swap ? ShapeAtPose{c.a, c.pose_a} : ShapeAtPose{c.b, c.pose_b};
                PairCache cache;
                const Penetration p = penetration(a, b), cached = penetration(a, b, &cache);
                REQUIRE(p.overlapping == general.overlapping);
                CHECK(intersects(a, b) == p.overlapping);
                CHECK((distance(a, b).distance == 0.0) == p.overlapping);
                CHECK(cached.depth == p.depth);
                CHECK(cached.normal == p.normal);
                CHECK(p.part_a == PartId{});
                CHECK(p.part_b == PartId{});
                if (!p.overlapping) {
                    CHECK(p.depth == 0.0);
                    CHECK(p.upper == 0.0);
                    CHECK(p.normal == glm::dvec3(0.0));
                    continue;
                }
                CHECK(p.lower <= general.upper);
                CHECK(general.lower <= p.upper);
                check_penetration_fields(a, b, p, 1e-9 * c.size, c.size, random);
                ++deep;
            }
        }
        CHECK(deep > 13000);
    }

    // Upright along any coordinate, by any of their edges, either way up; the other edges are skewed as far as poses
    // may be. They touch at a side, a corner, above each other or at an edge, within some ulps or 1e-16 to 1e-3.
    TEST_CASE("crates that stand upright meet iff rationals say so, and are as deep") {
        RandomShapes random(44);
        int meeting = 0, apart = 0;
        const auto stand = [&](int k) {
            const double angle = random.number(0, 6.2), c = std::cos(angle), s = std::sin(angle),
                         up = random.index(2) == 0 ? 1.0 : -1.0, bend = random.index(2) == 0 ? 3e-7 : 0.0;
            const int upright = random.index(3);
            glm::dmat3 r(0.0);
            r[upright][k] = up;
            r[(upright + 1) % 3][(k + 1) % 3] = c + bend * random.number(-1, 1);
            r[(upright + 1) % 3][(k + 2) % 3] = s + bend * random.number(-1, 1);
            r[(upright + 2) % 3][(k + 1) % 3] = -up * s + bend * random.number(-1, 1);
            r[(upright + 2) % 3][(k + 2) % 3] = up * c + bend * random.number(-1, 1);
            return r;
        };
        for (int i = 0; i < 6000; ++i) {
            CAPTURE(i);
            const int k = random.index(3);
            const double scale = i % 8 == 0 ? std::pow(10.0, random.number(-3, 3)) : 1.0;
            const Shape a = random.box(), b = random.box(scale);
            RigidTransform pose_a{stand(k), {}}, pose_b{stand(k), {}};
            if (i % 2 == 0) pose_a.translation = 10.0 * random.direction();
            pose_b.translation = pose_a.translation + 0.5 * random.number(0, 1) * random.direction();
            // Out along one or two of the directions that can part them.
            for (int times = 1 + random.index(2); times > 0; --times) {
                const int way = random.index(3);
                glm::dvec3 n(0.0);
                if (way == 0) n[k] = 1.0;
                if (way == 1) n = glm::normalize(pose_a.rotation[random.index(3)]);
                if (way == 2) n = glm::normalize(pose_b.rotation[random.index(3)]);
                pose_b.translation += overlap_along({a, pose_a}, {b, pose_b}, n) * n;
            }
            const double size =
                a.core_radius() + b.core_radius() + glm::length(pose_b.translation - pose_a.translation);
            if (random.index(2) == 0)
                pose_b.translation += std::pow(10.0, random.number(-16, -3)) * size * random.direction();
            const ShapeAtPose first{a, pose_a}, second{b, pose_b};
            REQUIRE(validate_pose(pose_a));
            const double exact = exact_depth(first, second);
            const bool meet = exact >= 0.0;
            CHECK(intersects(first, second) == meet);
            CHECK(intersects(second, first) == meet);
            for (const bool swapped : {false, true}) {
                const ShapeAtPose &low = swapped ? second : first, &top = swapped ? first : second;
                const Manifold m = contact_manifold(low, top);
                CHECK((m.count > 0) == meet);
                if (meet) CHECK(std::abs(m.depth - exact) <= 1e-9 * size);
                if (meet) CHECK(std::abs(overlap_along(low, top, m.normal) - exact) <= 2e-9 * size);
            }
            const Penetration p = penetration(first, second);
            CHECK(p.overlapping == meet);
            if (meet) CHECK(p.lower <= exact * (1.0 + 1e-14));
            if (meet) CHECK(exact <= p.upper * (1.0 + 1e-14));
            ++(meet ? meeting : apart);
        }
        CHECK(meeting > 1500);
        CHECK(apart > 1500);
    }

    TEST_CASE("the depth of two boxes lies between its bounds as rationals have it") {
        RandomShapes random(48);
        int deep = 0;
        for (int i = 0; i < 6000; ++i) {
            const BoxCase c = deep_case(random);
            const ShapeAtPose a{c.a, c.pose_a}, b{c.b, c.pose_b};
            if (!is_solid(c.a) || !is_solid(c.b) || c.a.radius() > 0.0 || c.b.radius() > 0.0) continue;
            const double exact = exact_depth(a, b);
            const Penetration p = penetration(a, b);
            CAPTURE(i);
            REQUIRE(p.overlapping == (exact >= 0.0));
            if (!p.overlapping) continue;
            CHECK(p.lower <= exact * (1.0 + 1e-14));
            CHECK(exact <= p.upper * (1.0 + 1e-14));
            ++deep;
        }
        CHECK(deep > 1300);
    }

    // A face looks 2e-10 deep; an axis across two edges parts them, by less than a choice among axes tells.
    TEST_CASE("a thin box 7e-10 m from one of 1 km has no points") {
        const auto shape = [](float x, float y, float z) { return Shape::box({x, y, z}).value(); };
        const Shape thin = shape(0x1.065462p-2f, 0x1.0c426cp-12f, 0x1.410614p-12f),
                    large = shape(0x1.c4ae06p+7f, 0x1.65cfdcp+8f, 0x1.a0a068p+8f);
        const RigidTransform at{glm::dmat3(0x1.f563fd76fadfbp-1, 0x1.fb8c772fd04d2p-5, 0x1.8adf0bef27dfdp-3,
                                           -0x1.d469129b59742p-5, 0x1.feed78dc8674fp-1, -0x1.efa2dfb42407cp-6,
                                           -0x1.8de1f9dd76a3bp-3, 0x1.30bd3641158f2p-6, 0x1.f6277d2b6d981p-1),
                                {0x1.312dp+23, -0x1.ab3fp+22, 0x1.6e36p+21}};
        const RigidTransform beside{glm::dmat3(0x1.8546febbe1443p-1, -0x1.971e047dc35ddp-2, -0x1.0700ff5ea8846p-1,
                                               0x1.bd5787192ae37p-2, 0x1.cc45ca81266a6p-1, -0x1.aa8fc6d08a00ap-5,
                                               0x1.ee1062f9b8ef8p-2, -0x1.78724f6dd761ap-3, 0x1.b67a24e0b488ap-1),
                                    {0x1.312e7195d9f4ap+23, -0x1.ab39c3a954d48p+22, 0x1.6e4433de8cc0fp+21}};
        const ShapeAtPose a{thin, at}, b{large, beside};
        REQUIRE(distance(a, b).lower > 6e-10);
        REQUIRE_FALSE(intersects(a, b));
        CHECK(contact_manifold(a, b).count == 0);
        CHECK(contact_manifold(b, a).count == 0);
        CHECK(contact_manifold(a, b, {.margin = 5e-10}).count == 0);
        CHECK(contact_manifold(a, b, {.margin = 8e-10}).count > 0);
    }

    // Edges that are parallel to 1.2e-11: the axis across them parts the boxes. A face looks deeper than that axis's
    // neighbours by less than a choice among faces tells.
    TEST_CASE("two boxes that an axis across nearly parallel edges parts by less than 1e-15 m have no points") {
        const Shape cube = Shape::box({1.0f, 1.0f, 1.0f}).value(), slab = Shape::box({0.125f, 0.5f, 0.5f}).value();
        const double angle = 1.2212201636500881e-11;
        const RigidTransform low{glm::dmat3(1, 0, 0, 0, 0.8, 0.6, 0, -0.6, 0.8), {}};
        const RigidTransform top{glm::dmat3(1, 0, -angle, 0.8 * angle, 0.6, 0.8, 0.6 * angle, -0.8, 0.6),
                                 {-0x1.141b37c691c86p-2, 0x1.0cccccccccccdp+1, -0x1.999999999bb81p-4}};
        const ShapeAtPose a{cube, low}, b{slab, top};
        REQUIRE_FALSE(intersects(a, b));
        REQUIRE(distance(a, b).upper < 1e-13);
        CHECK(contact_manifold(a, b).count == 0);
        CHECK(contact_manifold(b, a).count == 0);
    }

    TEST_CASE(
        "boxes of all forms have points iff they meet, as deep as is proven, cold and warm, skewed poses or not") {
        RandomShapes random(11);
        int meeting = 0, edges = 0, gaps = 0;
        for (int i = 0; i < 20000; ++i) {
            const BoxCase c = random_case(random);
            CAPTURE(i);
            const ShapeAtPose a{c.a, c.pose_a}, b{c.b, c.pose_b};
            const bool meet = intersects(a, b);
            const Manifold tight = contact_manifold(a, b);
            CHECK((tight.count > 0) == meet);
            meeting += meet;
            const double margin = 2.0 * std::abs(c.gap) + 1e-9;
            PairCache cache;
            const Manifold cold = contact_manifold(a, b, {.margin = margin, .max_points = 8}, &cache);
            const Manifold warm = contact_manifold(a, b, {.margin = margin, .max_points = 8}, &cache);
            const Distance d = distance(a, b);
            if (d.upper <= margin) CHECK(cold.count > 0);
            if (d.lower > margin) CHECK(cold.count == 0);
            CHECK((warm.count > 0) == (cold.count > 0));
            if (cold.count == 0) continue;
            gaps += !meet;
            CHECK(wrong_depth(c, cold) <= 1e-9 * c.size);
            CHECK(std::abs(warm.depth - cold.depth) <= 1.1e-4 * c.size);
            CHECK(glm::length(cold.normal) == doctest::Approx(1.0).epsilon(1e-12));
            const double tolerance = 1e-9 * c.size + 1e-15 * glm::length(c.pose_a.translation);
            for (int k = 0; k < cold.count; ++k) {
                CHECK(cold.points[k].depth <= cold.depth);
                const Feature &on_a = cold.points[k].on_a, &on_b = cold.points[k].on_b;
                // Rounded edges within 2 degrees of parallel have points at their ends, midway between them.
                const bool at_ends = on_a.kind != FeatureKind::face && on_b.kind != FeatureKind::face &&
                                     (on_a.kind == FeatureKind::vertex || on_b.kind == FeatureKind::vertex) &&
                                     c.a.radius() > 0.0 && c.b.radius() > 0.0;
                CHECK(wrong_place(c, cold.points[k]) <=
                      tolerance + 1e-6 * c.size +
                          (at_ends ? 0.036 * std::min(c.a.core_radius(), c.b.core_radius()) : 0.0));
                edges += cold.points[k].on_a.kind == FeatureKind::edge && cold.points[k].on_b.kind == FeatureKind::edge;
            }
        }
        MESSAGE(meeting, " meet, ", gaps, " gaps, ", edges, " points of two edges");
        CHECK(meeting > 5000);
        CHECK(gaps > 1000);
        CHECK(edges > 1000);
    }

    TEST_CASE("the face of the frame before stays while nothing is less deep by 1e-4, and is given up beyond") {
        const Shape cube = Shape::box(glm::vec3(1.0f)).value();
        PairCache cache;
        const RigidTransform ground = at({});
        // The overlap across x falls below that across y.
        int kept = 0;
        for (int i = 0; i <= 200; ++i) {
            const RigidTransform place = at({1.9 + 1e-5 * i, 1.901, 0.0});
            const Manifold m = contact_manifold({cube, ground}, {cube, place}, {}, &cache);
            const double better = (2.0 - 1.901) - (2.0 - place.translation.x);
            if (i == 0) CHECK(m.normal.y == doctest::Approx(1.0));
            const double allowed = 1e-4 * (2.0 * std::sqrt(3.0) + glm::length(place.translation));
            kept += better > 0.0 && m.normal.y > 0.5;
            if (m.normal.y > 0.5) CHECK(better <= allowed * 1.001);
        }
        CHECK(kept > 10);
    }

    TEST_CASE("a face that a cache names is used only if no axis is less deep by 1e-4 of the size") {
        RandomShapes random(29);
        int taken = 0, others = 0, meeting = 0;
        for (int i = 0; i < 8000; ++i) {
            BoxCase c = random_case(random);
            if (i % 2 == 0) {  // face on face, as they rest, turned about the normal, tilted
                const glm::dmat3& r = c.pose_a.rotation;
                const int k = random.index(3);
                const double turn = std::pow(10.0, random.number(-6, 0));
                c.pose_b.rotation = glm::mat3_cast(glm::angleAxis(turn, glm::normalize(r[k]))) * r;
                if (i % 4 == 0) {
                    const double tilt = std::pow(10.0, random.number(-5, -1));
                    c.pose_b.rotation = glm::mat3_cast(glm::angleAxis(tilt, random.direction())) * c.pose_b.rotation;
                }
                const glm::dvec3 ha = c.a.half_extents(), hb = c.b.half_extents(), across(1.0);
                glm::dvec3 place = random.number(-1, 1) * ha + random.number(-1, 1) * hb * across;
                place[k] = ha[k] + hb[k] + c.a.radius() + c.b.radius() + c.gap;
                c.pose_b.translation = c.pose_a.translation + r * place;
                c.size = c.a.core_radius() + c.b.core_radius() + c.a.radius() + c.b.radius() +
                         glm::length(c.pose_b.translation - c.pose_a.translation);
            }
            CAPTURE(i);
            const ShapeAtPose a{c.a, c.pose_a}, b{c.b, c.pose_b};
            const ManifoldOptions options{.margin = 2.0 * std::abs(c.gap) + 1e-9, .max_points = 8};
            const Manifold cold = contact_manifold(a, b, options);
            meeting += cold.count > 0 && cold.depth > 0.0;
            for (std::uint16_t reference = 1; reference <= 2; ++reference) {
                for (std::uint16_t face = 0; face < 6; ++face) {
                    PairCache cache;
                    cache.axis = random.direction();
                    cache.reference = reference;
                    cache.face = face;
                    const Manifold warm = contact_manifold(a, b, options, &cache);
                    CHECK((warm.count > 0) == (cold.count > 0));
                    if (warm.count == 0 || cold.count == 0) continue;
                    CHECK(std::abs(warm.depth - cold.depth) <= 1.1e-4 * c.size);
                    // The overlap along the normal is no less than the least, and no more but for what is allowed.
                    const double along = overlap_along(a, b, warm.normal);
                    if (cold.depth > 0.0) CHECK(off(along, cold.depth, cold.depth + 1e-4 * c.size) <= 1e-9 * c.size);
                    const bool named = cache.reference == reference && cache.face == face;
                    taken += named;
                    others += named && glm::dot(warm.normal, cold.normal) < 1.0 - 1e-6;
                }
            }
        }
        MESSAGE(meeting, " meet, ", taken, " faces taken, ", others, " of them another than without a cache");
        CHECK(taken > 5000);
        CHECK(others > 200);
    }

    TEST_CASE("thin plates that pass to a face's other side: its depth is not taken for theirs") {
        for (const float half : {0.0f, 2e-5f}) {
            const Shape plate = Shape::box({1, half, 1}).value();
            std::vector<glm::vec3> corners;
            for (int i = 0; i < 8; ++i)
                corners.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? half : -half, i & 4 ? 1.0f : -1.0f);
            std::vector<Shape> plates{plate};
            const auto hull = Hull::build(corners);
            if (hull) plates.push_back(Shape::hull(*hull));
            for (const Shape& shape : plates)
                for (const double below : {-5e-5, -1e-5, -4e-5, -1e-4}) {
                    CAPTURE(half);
                    CAPTURE(below);
                    PairCache cache;
                    REQUIRE(
                        contact_manifold({shape, at({})}, {shape, at({0, 5e-5, 0})}, {.margin = 1e-3}, &cache).count >
                        0);
                    const Manifold warm =
                        contact_manifold({shape, at({})}, {shape, at({0, below, 0})}, {.margin = 1e-3}, &cache);
                    REQUIRE(warm.count > 0);
                    CHECK(warm.normal.y == doctest::Approx(-1.0));
                    CHECK(warm.depth == doctest::Approx(2.0 * double{half} + below).epsilon(1e-6));
                }
        }
    }

    TEST_CASE("faces a little farther than the margin, nearer to each other than rounding: no contact, warm or cold") {
        const Shape cube = Shape::box(glm::vec3(1.0f)).value();
        for (std::uint16_t reference = 0; reference < 3; ++reference) {
            PairCache cache;
            cache.reference = reference;
            cache.face = 1;
            for (const double more : {3e-12, 1e-12, 5e-12}) {
                const RigidTransform place = at({2.01, 2.01 + more, 0.0});
                CHECK(contact_manifold({cube, at({})}, {cube, place}, {.margin = 0.01}, &cache).count == 0);
            }
        }
    }

    TEST_CASE("a pose that is not quite a rotation: the normal is that of the face, warm and cold, boxes and hulls") {
        const Shape slab = Shape::box({4, 1, 4}).value(), cube = Shape::box(glm::vec3(0.5f)).value();
        std::vector<glm::vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.emplace_back(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f);
        const Hull hull = Hull::build(corners).value();
        RigidTransform ground = at({});
        ground.rotation[1] += glm::dvec3(4e-7, 0, 0);
        const glm::dvec3 across = glm::normalize(glm::cross(ground.rotation[2], ground.rotation[0]));
        for (const Shape& top : {cube, Shape::hull(hull)}) {
            PairCache cache;
            for (int frame = 0; frame < 3; ++frame) {
                const RigidTransform place = at({0.1, 1.49, 0.0});
                const Manifold m = contact_manifold({slab, ground}, {top, place}, {}, &cache);
                CHECK(glm::length(m.normal - across) < 1e-12);
                const Penetration p = penetration({slab, ground}, {top, place});
                CHECK(off(m.depth, p.lower, p.upper) <= 1e-9 * 8.0);
            }
        }
    }
}
