// SPDX-License-Identifier: MIT
// Rays at shapes of all kinds, against slow oracles in long double.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using crofton::testing::at;
using crofton::testing::RandomShapes;
using crofton::testing::Surface;

namespace {

using Real = long double;
struct Point {
    Real x, y, z;
};
Point operator+(const Point& a, const Point& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Point operator-(const Point& a, const Point& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Point operator*(Real s, const Point& a) {
    return {s * a.x, s * a.y, s * a.z};
}
Real dot(const Point& a, const Point& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Point cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real length(const Point& a) {
    return std::sqrt(dot(a, a));
}
Point real(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

// The nearest point of a triangle by its regions (Ericson), in long double.
Real distance_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
    const auto segment = [&](const Point& s, const Point& e) {
        const Point d = e - s;
        const Real squared = dot(d, d), t = squared > 0 ? std::clamp<Real>(dot(p - s, d) / squared, 0, 1) : 0;
        return length(p - (s + t * d));
    };
    Real best = std::min({segment(a, b), segment(b, c), segment(c, a)});
    const Point n = cross(b - a, c - a);
    if (const Real squared = dot(n, n); squared > 0) {
        const bool above =
            dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
        if (above) best = std::min(best, std::abs(dot(p - a, n)) / std::sqrt(squared));
    }
    return best;
}

// The signed distance of a point from a shape's core, in its frame: by formulas, of hulls by their triangles. Inside it
// is negative, and not always the distance there.
Real core_gap(const Shape& shape, const Point& p) {
    const Point h = real(shape.half_extents());
    if (shape.kind() == Kind::sphere) return length(p);
    if (shape.kind() == Kind::capsule) {
        const Real end = std::abs(shape.vertex(0).y);
        return length(p - Point{0, std::clamp(p.y, -end, end), 0});
    }
    if (shape.kind() == Kind::box) {
        const Point q{std::abs(p.x) - h.x, std::abs(p.y) - h.y, std::abs(p.z) - h.z};
        const Real inside = std::max({q.x, q.y, q.z});
        return inside <= 0 ? inside : length({std::max<Real>(q.x, 0), std::max<Real>(q.y, 0), std::max<Real>(q.z, 0)});
    }
    const Real across = std::hypot(p.x, p.z);
    if (shape.kind() == Kind::cylinder) {
        const Real x = across - h.x, y = std::abs(p.y) - h.y;
        return x <= 0 || y <= 0 ? std::max(x, y) : std::hypot(x, y);
    }
    if (shape.kind() == Kind::cone) {
        // The half plane's triangle (0, h), (r, −h), (0, −h): a flat one in space.
        const Point q{across, p.y, 0}, apex{0, h.y, 0}, rim{h.x, -h.y, 0}, base{0, -h.y, 0};
        const Real side = cross(apex - rim, q - rim).z / length(apex - rim);
        if (p.y >= -h.y && side >= 0) return -std::min(side, p.y + h.y);
        return distance_to_triangle(q, apex, rim, base);
    }
    Real best = std::numeric_limits<Real>::infinity();
    if (shape.kind() == Kind::triangle)
        return distance_to_triangle(p, real(shape.vertex(0)), real(shape.vertex(1)), real(shape.vertex(2)));
    const std::span<const std::uint16_t> t = shape.hull()->triangles();
    Real outermost = -std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i + 2 < t.size(); i += 3) {
        const Point a = real(shape.vertex(t[i])), b = real(shape.vertex(t[i + 1])), c = real(shape.vertex(t[i + 2]));
        const Point n = cross(b - a, c - a);
        outermost = std::max(outermost, dot(p - a, n) / length(n));
        best = std::min(best, distance_to_triangle(p, a, b, c));
    }
    return outermost <= 0 ? outermost : best;
}

struct Expected {
    bool hit = false, unsure = false;
    Real t = 0;
};

// Where the ray's gap to the shape, a convex function, first is 0: its least place by ternary search, then by halves.
Expected first_in(const std::function<Real(Real)>& gap, Real to, Real tolerance) {
    Real low = 0, high = to;
    for (int i = 0; i < 300; ++i) {
        const Real a = low + (high - low) / 3, b = high - (high - low) / 3;
        (gap(a) <= gap(b) ? high : low) = gap(a) <= gap(b) ? b : a;
    }
    Expected result;
    Real in = low;
    for (const Real t : {Real{0}, low, high, to})
        if (gap(t) < gap(in)) in = t;
    result.unsure = std::abs(gap(in)) <= tolerance;
    result.hit = gap(in) <= 0;
    if (!result.hit) return result;
    Real out = 0;
    if (gap(out) <= 0) return result;
    for (int i = 0; i < 200; ++i) {
        const Real middle = (out + in) / 2;
        (gap(middle) > 0 ? out : in) = middle;
    }
    result.t = in;
    return result;
}

// The oracle's shape: the core's gap less the rounding, in the shape's frame.
struct Scene {
    Shape shape;
    RigidTransform pose;
    [[nodiscard]] Point local(const Point& p) const {
        const Point off = p - real(pose.translation);
        const Point x = real(pose.rotation[0]), y = real(pose.rotation[1]), z = real(pose.rotation[2]);
        // By Cramer's rule: poses are rotations to 1e-6 alone.
        const Real d = dot(x, cross(y, z));
        return {dot(off, cross(y, z)) / d, dot(off, cross(z, x)) / d, dot(off, cross(x, y)) / d};
    }
    [[nodiscard]] Real gap(const Point& p) const { return core_gap(shape, local(p)) - Real{shape.radius()}; }
};

Shape shape_of_kind(RandomShapes& random, int kind, double size) {
    const auto length = [&] { return static_cast<float>(size * random.number(0.1, 1.0)); };
    const double rounding = size * random.number(0.02, 0.5);
    switch (kind) {
        case 0:
            return *Shape::sphere(size * random.number(0.1, 1.0));
        case 1:
            return *Shape::capsule(length(), length());
        case 2:
            return random.box(size);
        case 3:
            return random.hull(4 + random.index(40), size);
        case 4:
            return *Shape::cylinder(length(), length());
        case 5:
            return *Shape::cone(length(), length());
        case 6:
            return *Shape::rounded(random.box(size), rounding);
        case 7:
            return *Shape::rounded(random.hull(4 + random.index(12), size), rounding);
        case 8:
            return *Shape::rounded(*Shape::cylinder(length(), length()), rounding);
        case 9:
            return *Shape::rounded(*Shape::cone(length(), length()), rounding);
        default:
            break;
    }
    const auto p = random.points(3, size);
    return *Shape::rounded(*Shape::triangle(p[0], p[1], p[2]), rounding);
}
constexpr int kKinds = 11;

// Checks all fields against the oracle. Returns whether it could tell.
bool check_ray(const Scene& scene, const Ray& ray, double size) {
    const auto hit = raycast({scene.shape, scene.pose}, ray);
    const Point origin = real(ray.origin), direction = real(ray.direction);
    const Real per_length = 1 / length(direction);
    // The oracle begins where the ray comes near the shape, by exact enough steps of its own.
    const Real nearest = dot(real(scene.pose.translation) - origin, direction) * per_length;
    const Real start = std::max<Real>(0, nearest - 4 * Real{size});
    const Real end = std::min<Real>(Real{ray.max_t} / per_length, std::max<Real>(0, nearest + 4 * Real{size}));
    if (end < start) return !hit;
    const auto gap = [&](Real way) { return scene.gap(origin + ((start + way) * per_length) * direction); };
    const Real tolerance = 1e-12L * Real{size} + 1e-18L * (length(origin) + length(real(scene.pose.translation)));
    const Expected expected = first_in(gap, end - start, tolerance);
    if (expected.unsure) return true;
    REQUIRE(hit.has_value() == expected.hit);
    if (!hit) return true;
    CHECK(hit->part == PartId{});
    if (std::abs(gap(0)) <= tolerance) return true;  // it begins on the surface
    const bool inside = start == 0 && gap(0) < 0;
    REQUIRE(hit->started_inside == inside);
    if (inside) {
        REQUIRE(hit->t == 0.0);
        REQUIRE(hit->point == ray.origin);
        REQUIRE(hit->normal == glm::dvec3(0.0));
        return true;
    }
    // The way is off by the tolerance over the cosine.
    const Point point = real(hit->point), normal = real(hit->normal);
    const Real cosine = std::max<Real>(-dot(normal, direction) * per_length, 1e-7L);
    const Real way = start + expected.t, far = 1e-15L * (1 + length(origin) + length(real(scene.pose.translation)));
    REQUIRE(std::abs(Real{hit->t} / per_length - way) <= tolerance / cosine + 1e-15L * way + 1e-15L * Real{size});
    REQUIRE(length(point - (origin + (way * per_length) * direction)) <= tolerance / cosine + far);
    REQUIRE(std::abs(scene.gap(point)) <= tolerance + far);
    REQUIRE(std::abs(length(normal) - 1) <= 1e-14L);
    REQUIRE(dot(normal, direction) <= 0);
    // No point of the shape lies beyond the plane through the point: the normal is the surface's.
    const glm::dvec3 local = glm::transpose(scene.pose.rotation) * hit->normal;
    const Point farthest = real(scene.pose.rotation * support_point(scene.shape, local) + scene.pose.translation);
    REQUIRE(dot(farthest - point, normal) <= 1e-6L * Real{size} + far);
    return true;
}

// Keeps the hit of triangle k, of `corners`, if it is nearer than `nearest`.
void keep_nearest(const Ray& ray, const Triangle& corners, std::uint32_t k, Sides sides,
                  std::optional<RayHit>& nearest) {
    const glm::dvec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const auto t = mesh::raycast(ray, corners);
    if (!t || (sides == Sides::front && glm::dot(n, ray.direction) >= 0.0)) return;
    if (nearest && nearest->t <= *t) return;
    nearest = RayHit{*t, ray.origin + *t * ray.direction, glm::normalize(n), false, {0, k}};
    if (glm::dot(n, ray.direction) > 0.0) nearest->normal = -nearest->normal;
}

}  // namespace

TEST_SUITE("convex/ray") {
    TEST_CASE("a ray meets a shape of any kind at its first point, with its normal") {
        RandomShapes random(4101);
        for (int i = 0; i < 3300; ++i) {
            const double size = std::exp2(random.number(-20.0, 20.0));
            const Shape shape = shape_of_kind(random, i % kKinds, size);
            const glm::dvec3 place = size * std::exp2(random.number(-4.0, 10.0)) * random.direction();
            const Scene scene{shape, {random.rotation(), place}};
            // From near, inside or far, at a point of about the shape.
            const double away = size * (i % 7 == 0 ? random.number(0.0, 0.5) : random.number(1.0, 20.0));
            const glm::dvec3 origin = place + away * random.direction();
            const glm::dvec3 aim = place + size * random.number(0.0, 1.2) * random.direction();
            const double stretch = std::exp2(random.number(-30.0, 30.0));
            Ray ray{origin, stretch * (aim - origin)};
            if (i % 5 == 0) ray.max_t = random.number(0.0, 2.0) / stretch;
            CAPTURE(i);
            check_ray(scene, ray, 3.0 * size);
        }
    }
    TEST_CASE("a ray from very far away meets a shape where it does from near") {
        RandomShapes random(4102);
        for (int i = 0; i < 1100; ++i) {
            const Shape shape = shape_of_kind(random, i % kKinds, 1.0);
            const Scene scene{shape, {random.rotation(), glm::dvec3(0.0)}};
            // Powers of two keep the ray the same line.
            const glm::dvec3 near = glm::dvec3(glm::vec3(4.0 * random.direction())),
                             way = glm::dvec3(glm::vec3(0.3 * random.direction() - near));
            const int exponent = 10 + random.index(19);
            const Ray from_near{near, way}, from_far{near - std::exp2(exponent) * way, way};
            if ((from_far.origin + std::exp2(exponent) * way) != near) continue;
            const auto expected = raycast({shape, scene.pose}, from_near), hit = raycast({shape, scene.pose}, from_far);
            CAPTURE(i);
            REQUIRE(hit.has_value() == expected.has_value());
            if (!hit) continue;
            REQUIRE(glm::length(hit->point - expected->point) <= 1e-10);
            REQUIRE(std::abs(hit->t - std::exp2(exponent) - expected->t) <= 1e-10 + 1e-15 * hit->t);
            REQUIRE(glm::length(hit->normal - expected->normal) <= 1e-6);
        }
    }
    TEST_CASE("directions of any length, down to the least and up to the largest double, meet the same point") {
        RandomShapes random(4103);
        for (int i = 0; i < 220; ++i) {
            const Shape shape = shape_of_kind(random, i % kKinds, 1.0);
            const RigidTransform pose{random.rotation(), {1.0, 2.0, 3.0}};
            const glm::dvec3 origin = pose.translation + 5.0 * random.direction();
            const glm::dvec3 way = glm::dvec3(glm::vec3(pose.translation - origin));
            const auto expected = raycast({shape, pose}, {origin, way});
            for (const int exponent : {-1000, -600, -200, 200, 600, 1000}) {
                const glm::dvec3 scaled(std::scalbn(way.x, exponent), std::scalbn(way.y, exponent),
                                        std::scalbn(way.z, exponent));
                const auto hit = raycast({shape, pose}, {origin, scaled});
                REQUIRE(hit.has_value() == expected.has_value());
                if (!hit) continue;
                REQUIRE(hit->point == expected->point);
                REQUIRE(hit->normal == expected->normal);
                REQUIRE(hit->t == std::scalbn(expected->t, -exponent));
            }
        }
    }
    TEST_CASE("rays that are none hit nothing") {
        const Shape sphere = *Shape::sphere(1.0);
        const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
        const glm::dvec3 x(1.0, 0.0, 0.0);
        for (const Ray& ray : {Ray{x, {0, 0, 0}}, Ray{x, {nan, 0, 0}}, Ray{{nan, 0, 0}, x}, Ray{{0, infinite, 0}, x},
                               Ray{x, {infinite, 0, 0}}, Ray{x, x, nan}, Ray{x, x, -1.0}})
            CHECK(!raycast({sphere, at({0, 0, 0})}, ray));
        CHECK(!raycast({sphere, at({nan, 0, 0})}, {{-5, 0, 0}, x}));
        CHECK(!raycast({sphere, {glm::dmat3(2.0), {0, 0, 0}}}, {{-5, 0, 0}, x}));
        CHECK(raycast({sphere, at({0, 0, 0})}, {{-5, 0, 0}, x}));
        CHECK(raycast({sphere, at({0, 0, 0})}, {{-5, 0, 0}, x, 4.0}));  // its end touches
        CHECK(!raycast({sphere, at({0, 0, 0})}, {{-5, 0, 0}, x, 3.999}));
        CHECK(!raycast({sphere, at({0, 0, 0})}, {{5, 0, 0}, x}));
    }
    TEST_CASE("a ray that starts on a box's surface has started inside, as intersects says") {
        const Shape box = *Shape::box({1, 1, 1});
        const auto on = raycast({box, at({0, 0, 0})}, {{1, 0.5, 0.5}, {1, 0, 0}}).value();
        CHECK(on.started_inside);
        CHECK(!raycast({box, at({0, 0, 0})}, {{std::nextafter(1.0, 2.0), 0.5, 0.5}, {1, 0, 0}}));
        const auto before = raycast({box, at({0, 0, 0})}, {{std::nextafter(-1.0, -2.0), 0.5, 0.5}, {1, 0, 0}}).value();
        CHECK(!before.started_inside);
        CHECK(before.normal == glm::dvec3(-1, 0, 0));
        CHECK(before.t <= 1e-15);
    }
    TEST_CASE("a ray that begins on a surface enters at once, or has left, whatever rounding says") {
        RandomShapes random(4108);
        int entered = 0, left = 0;
        for (int i = 0; i < 11000; ++i) {
            const Shape shape = shape_of_kind(random, i % kKinds, 1.0);
            const RigidTransform pose{random.rotation(), 20.0 * random.direction()};
            const glm::dvec3 from = pose.translation + 5.0 * random.direction();
            const auto first = raycast({shape, pose}, {from, pose.translation + 0.3 * random.direction() - from});
            if (!first) continue;
            const double slip = 1e-14 * random.number(-1.0, 1.0);
            const Ray out{first->point + slip * first->normal, first->normal + 0.5 * random.direction()},
                in{out.origin, -first->normal + 0.5 * random.direction()};
            CAPTURE(i);
            // Into the solid: at once. Out of it: only a start inside is a hit.
            const auto comes = raycast({shape, pose}, in), goes = raycast({shape, pose}, out);
            REQUIRE(comes.has_value());
            REQUIRE(comes->t <= 1e-12);
            REQUIRE((comes->started_inside || glm::dot(comes->normal, in.direction) < 0.0));
            if (goes) REQUIRE(goes->started_inside);
            entered += !comes->started_inside;
            left += !goes.has_value();
        }
        CHECK(entered > 2000);
        CHECK(left > 2000);
    }
    TEST_CASE("a ray at a half-space meets its plane, from however far away") {
        RandomShapes random(4104);
        for (int i = 0; i < 2000; ++i) {
            const Plane plane{random.number(0.1, 5.0) * random.direction(), random.number(-3.0, 3.0)};
            const Shape ground = *Shape::half_space(plane);
            const RigidTransform pose{random.rotation(), std::exp2(random.number(-3.0, 12.0)) * random.direction()};
            const Ray ray{pose.translation + std::exp2(random.number(-3.0, 12.0)) * random.direction(),
                          std::exp2(random.number(-9.0, 9.0)) * random.direction()};
            const Point n = real(glm::dvec3(plane.normal));
            const Scene scene{ground, pose}, turned{ground, {pose.rotation, glm::dvec3(0.0)}};
            const Real from = dot(n, scene.local(real(ray.origin))) + Real{plane.offset},
                       speed = dot(n, turned.local(real(ray.direction)));
            const auto hit = raycast({ground, pose}, ray);
            const bool inside = from >= 0, expected = inside || speed > 0;
            REQUIRE(hit.has_value() == expected);
            if (!hit) continue;
            REQUIRE(hit->started_inside == inside);
            if (inside) continue;
            // The plane by 1e-13 of the size nearer or farther, which counts for much where the ray grazes it.
            const Real t = -from / speed, way = t * length(real(ray.direction)),
                       size = length(real(ray.origin) - real(pose.translation)) + way;
            REQUIRE(std::abs(Real{hit->t} - t) <= 0x1p-51L * t + 1e-13L * size * length(n) / speed);
            REQUIRE(glm::length(hit->normal + glm::normalize(pose.rotation * plane.normal)) <= 1e-12);
            REQUIRE(glm::length(hit->point - (ray.origin + hit->t * ray.direction)) <=
                    1e-12 * glm::length(hit->point) + 1e-12 * glm::length(ray.origin));
        }
    }
    TEST_CASE("a ray at a surface meets the triangle that all triangles one by one say, one-sided or not") {
        RandomShapes random(4105);
        for (int round = 0; round < 60; ++round) {
            const bool is_ground = round % 2 == 0;
            const auto waves = [](double x, double z) { return 0.4 * std::sin(2.0 * x) * std::cos(1.7 * z); };
            const Surface surface =
                is_ground ? testing::ground(random, 12, 0.5, waves) : testing::soup(random, 150, 3.0, 0.8);
            const Sides sides = round % 4 < 2 ? Sides::both : Sides::front;
            const Shape shape = surface.shape(sides);
            const RigidTransform pose{round % 3 == 0 ? glm::dmat3(1.0) : random.rotation(), 10.0 * random.direction()};
            for (int i = 0; i < 100; ++i) {
                const glm::dvec3 from = 6.0 * random.direction(), aim = 2.0 * random.direction();
                const Ray ray{pose.rotation * from + pose.translation, pose.rotation * (aim - from)};
                std::optional<RayHit> expected;
                for (std::uint32_t k = 0; k < surface.size(); ++k) {
                    Triangle corners;
                    for (int v = 0; v < 3; ++v)
                        corners[std::size_t(v)] = pose.rotation * surface.triangle(k).vertex(v) + pose.translation;
                    keep_nearest(ray, corners, k, sides, expected);
                }
                const auto hit = raycast({shape, pose}, ray);
                REQUIRE(hit.has_value() == expected.has_value());
                if (!hit) continue;
                REQUIRE(std::abs(hit->t - expected->t) <= 1e-12);
                REQUIRE(hit->part == expected->part);
                REQUIRE(!hit->started_inside);
                REQUIRE(glm::length(hit->point - expected->point) <= 1e-11);
                REQUIRE(glm::length(hit->normal - expected->normal) <= 1e-7);
            }
        }
    }
    TEST_CASE("a ray at hills meets the triangle that all triangles one by one say, and passes holes") {
        RandomShapes random(4106);
        for (int round = 0; round < 40; ++round) {
            const std::uint32_t columns = 2 + std::uint32_t(random.index(30)),
                                rows = 2 + std::uint32_t(random.index(30));
            std::vector<float> heights(std::size_t{columns} * rows);
            for (float& h : heights) h = static_cast<float>(random.number(-1.0, 1.0));
            std::vector<std::uint8_t> materials(std::size_t{columns - 1} * (rows - 1));
            for (std::uint8_t& m : materials) m = random.index(6) == 0 ? kHole : 0;
            materials[0] = 0;
            const HeightField field = HeightField::build({columns, rows, heights, {0.7, 1.3}, materials}).value();
            const Sides sides = round % 2 == 0 ? Sides::front : Sides::both;
            const Shape shape = Shape::height_field(field, sides);
            const RigidTransform pose{random.rotation(), 30.0 * random.direction()};
            const glm::dvec3 size = field.bounds().max - field.bounds().min;
            for (int i = 0; i < 60; ++i) {
                const auto inside = [&] {
                    return field.bounds().min +
                           size * glm::dvec3(random.number(0, 1), random.number(0, 1), random.number(0, 1));
                };
                const glm::dvec3 to = inside(), from = i % 2 == 0 ? inside() : to + 20.0 * random.direction();
                const Ray ray{pose.rotation * from + pose.translation, pose.rotation * (to - from)};
                std::optional<RayHit> expected;
                for (std::uint32_t k = 0; k < 2 * field.cell_count(); ++k) {
                    if (field.material(k / 2) == kHole) continue;
                    Triangle corners = field.triangle(k);
                    for (glm::dvec3& p : corners) p = pose.rotation * p + pose.translation;
                    keep_nearest(ray, corners, k, sides, expected);
                }
                const auto hit = raycast({shape, pose}, ray);
                REQUIRE(hit.has_value() == expected.has_value());
                if (!hit) continue;
                REQUIRE(std::abs(hit->t - expected->t) * glm::length(ray.direction) <= 1e-10);
                REQUIRE(hit->part == expected->part);
                REQUIRE(glm::length(hit->point - expected->point) <= 1e-10);
                REQUIRE(glm::length(hit->normal - expected->normal) <= 1e-7);
            }
        }
    }
    TEST_CASE("a ray at a compound meets the first of its parts, those of compounds within, and its ground") {
        RandomShapes random(4107);
        for (int round = 0; round < 150; ++round) {
            std::vector<CompoundChild> inner, children;
            std::vector<Surface> surfaces(1);
            surfaces[0] = testing::soup(random, 20, 1.0, 0.7);
            for (int i = 0; i < 3; ++i)
                inner.push_back(
                    {shape_of_kind(random, random.index(kKinds), 0.5), {random.rotation(), random.direction()}});
            const Compound part = Compound::build(inner).value();
            for (int i = 0; i < 6; ++i)
                children.push_back(
                    {shape_of_kind(random, random.index(kKinds), 0.5), {random.rotation(), 3.0 * random.direction()}});
            children.push_back({Shape::compound(part), {random.rotation(), 3.0 * random.direction()}});
            children.push_back({surfaces[0].shape(), {random.rotation(), 3.0 * random.direction()}});
            if (round % 2 == 0)
                children.push_back(
                    {*Shape::half_space({random.direction(), -2.0}), {random.rotation(), random.direction()}});
            const Compound whole = Compound::build(children).value();
            const RigidTransform pose{random.rotation(), 8.0 * random.direction()};
            for (int i = 0; i < 40; ++i) {
                const glm::dvec3 origin = pose.translation + (i % 3 == 0 ? 2.0 : 9.0) * random.direction();
                const Ray ray{origin, pose.translation + 2.0 * random.direction() - origin};
                std::optional<RayHit> expected;
                std::uint32_t number = 0;
                const auto ask = [&](const Shape& shape, const RigidTransform& place) {
                    auto hit = raycast({shape, place}, ray);
                    if (hit) hit->part.child = number;
                    ++number;
                    if (!hit || (expected && expected->started_inside)) return;
                    if (!expected || hit->started_inside || hit->t < expected->t) expected = hit;
                };
                const auto product = [](const RigidTransform& outer, const RigidTransform& child) {
                    return RigidTransform{outer.rotation * child.rotation,
                                          outer.rotation * child.translation + outer.translation};
                };
                for (const CompoundChild& child : children) {
                    const RigidTransform place = product(pose, child.pose);
                    if (child.shape.compound() == nullptr)
                        ask(child.shape, place);
                    else
                        for (const CompoundChild& below : inner) ask(below.shape, product(place, below.pose));
                }
                const auto hit = raycast({Shape::compound(whole), pose}, ray);
                REQUIRE(hit.has_value() == expected.has_value());
                if (!hit) continue;
                REQUIRE(hit->t == expected->t);
                REQUIRE(hit->point == expected->point);
                REQUIRE(hit->normal == expected->normal);
                REQUIRE(hit->started_inside == expected->started_inside);
                REQUIRE(hit->part == expected->part);
            }
        }
    }
}
