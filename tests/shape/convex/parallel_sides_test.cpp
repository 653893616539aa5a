// SPDX-License-Identifier: MIT
// Straight round sides and edges that lie along each other: a point at each end of their common stretch.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// A shape with a straight side or edge: which of its lines touches, in its frame, and which way that looks.
struct Side {
    std::string name;
    Shape shape;
    glm::dvec3 from, to, outward;  // of the core's line
    bool round;                    // no sharp edge
};

class StraightSides {
  public:
    explicit StraightSides(double scale) {
        const auto f = [scale](double x) { return static_cast<float>(scale * x); };
        const auto v = [&](double x, double y, double z) {
            return glm::dvec3(double(f(x)), double(f(y)), double(f(z)));
        };
        const Shape box = Shape::box({f(0.4), f(1.0), f(0.3)}).value();
        const Shape triangle = Shape::triangle({f(0.5), f(-1), 0}, {f(0.5), f(1), 0}, {f(-0.5), f(0.2), 0}).value();
        // A prism whose edge at x = 0.5 runs along y; its sides meet there at 45 degrees from x.
        const std::vector<glm::vec3> corners{{f(0.5), f(-1), 0},    {f(0.5), f(1), 0},   {0, f(-1), f(0.5)},
                                             {0, f(1), f(0.5)},     {0, f(-1), f(-0.5)}, {0, f(1), f(-0.5)},
                                             {f(-0.3), f(-0.9), 0}, {f(-0.3), f(0.9), 0}};
        hull_ = std::make_unique<Hull>(Hull::build(corners).value());
        const Shape hull = Shape::hull(*hull_), cylinder = Shape::cylinder(f(1.0), f(0.3)).value(),
                    cone = Shape::cone(f(1.0), f(0.5)).value();
        const double diagonal = std::sqrt(0.5);
        const glm::dvec3 x(1, 0, 0), edge(diagonal, 0, diagonal);
        const glm::dvec3 of_cone = glm::normalize(glm::dvec3(2.0 * double(f(1.0)), double(f(0.5)), 0.0));
        add("capsule", Shape::capsule(f(1.0), f(0.3)).value(), v(0, -1, 0), v(0, 1, 0), x, true);
        add("cylinder", cylinder, v(0.3, -1, 0), v(0.3, 1, 0), x, true);
        add("cone", cone, v(0.5, -1, 0), v(0, 1, 0), of_cone, true);
        add("rounded cylinder", Shape::rounded(cylinder, scale * 0.1).value(), v(0.3, -1, 0), v(0.3, 1, 0), x, true);
        add("rounded cone", Shape::rounded(cone, scale * 0.1).value(), v(0.5, -1, 0), v(0, 1, 0), of_cone, true);
        add("rounded box", Shape::rounded(box, scale * 0.1).value(), v(0.4, -1, 0.3), v(0.4, 1, 0.3), edge, true);
        add("rounded triangle", Shape::rounded(triangle, scale * 0.1).value(), v(0.5, -1, 0), v(0.5, 1, 0), x, true);
        add("rounded hull", Shape::rounded(hull, scale * 0.1).value(), v(0.5, -1, 0), v(0.5, 1, 0), x, true);
        add("box", box, v(0.4, -1, 0.3), v(0.4, 1, 0.3), edge, false);
        add("hull", hull, v(0.5, -1, 0), v(0.5, 1, 0), x, false);
        add("triangle", triangle, v(0.5, -1, 0), v(0.5, 1, 0), x, false);
    }
    std::vector<Side> all;

  private:
    void add(std::string name, const Shape& shape, const glm::dvec3& from, const glm::dvec3& to,
             const glm::dvec3& outward, bool round) {
        all.push_back({std::move(name), shape, from, to, outward, round});
    }
    std::unique_ptr<Hull> hull_;
};

struct SegmentInWorld {
    glm::dvec3 from, to;
};

// The stretch of a's line that is beside b's: both ends, on either line.
struct Stretch {
    glm::dvec3 on_a[2], on_b[2];
};
Stretch common(const SegmentInWorld& a, const SegmentInWorld& b) {
    const glm::dvec3 u = a.to - a.from, v = b.to - b.from;
    const auto along = [&](const glm::dvec3& p) { return glm::dot(p - a.from, u) / glm::dot(u, u); };
    double t0 = along(b.from), t1 = along(b.to);
    if (t0 > t1) std::swap(t0, t1);
    Stretch s;
    const double ends[2] = {std::max(0.0, t0), std::min(1.0, t1)};
    for (int k = 0; k < 2; ++k) {
        s.on_a[k] = a.from + ends[k] * u;
        const double r = (ends[k] - along(b.from)) / (along(b.to) - along(b.from));
        s.on_b[k] = b.from + r * v;
    }
    return s;
}

// A frame whose y axis is along the side's line and whose x axis looks outward.
glm::dmat3 frame_of(const Side& side) {
    const glm::dvec3 y = glm::normalize(side.to - side.from), z = glm::normalize(glm::cross(side.outward, y));
    return {glm::cross(y, z), y, z};
}

}  // namespace

TEST_SUITE("convex/parallel_sides") {
    TEST_CASE("round sides and edges within 2 degrees of parallel have a point at each end of their common stretch") {
        RandomShapes random(5);
        int asked = 0;
        for (const double scale : {1.0, 1e-3, 250.0, 1e6}) {
            const StraightSides sides(scale);
            for (const Side& a : sides.all)
                for (const Side& b : sides.all) {
                    if (!a.round && !b.round) continue;
                    const bool both = a.round && b.round;  // others where they are parallel but for rounding
                    CAPTURE(scale);
                    CAPTURE(a.name);
                    CAPTURE(b.name);
                    for (int i = 0; i < 12; ++i) {
                        // b's line above a's, turned about x by an angle below two degrees, one of a degree and a half
                        // and more in most, with a shift along it, overlapping by a little where they are nearest.
                        const double degrees = i == 0 || !both ? 0.0
                                               : i == 1        ? 1.99
                                               : i == 2        ? 1.85
                                                               : random.number(0.0, 1.99);
                        const double turn = glm::radians(degrees) * (i % 2 == 0 ? 1.0 : -1.0);
                        const glm::dmat3 about_x = glm::mat3_cast(glm::angleAxis(turn, glm::dvec3(1, 0, 0)));
                        const glm::dmat3 half_turn(-1, 0, 0, 0, 1, 0, 0, 0, -1);
                        const RigidTransform world{random.rotation(), scale * 3.0 * random.direction()};
                        // Into the common frame: a looks along x, b along −x.
                        const glm::dmat3 turn_a = glm::transpose(frame_of(a)),
                                         turn_b = about_x * half_turn * glm::transpose(frame_of(b));
                        const double overlap = scale * random.number(0.06, 0.09), shift = scale * random.number(-1, 1);
                        const glm::dvec3 middle_a = turn_a * (0.5 * (a.from + a.to)),
                                         middle_b = turn_b * (0.5 * (b.from + b.to));
                        const double apart = a.shape.radius() + b.shape.radius() - overlap;
                        const glm::dvec3 move_b = middle_a + glm::dvec3(apart, shift, 0) - middle_b;
                        const RigidTransform pose_a{world.rotation * turn_a, world.translation},
                            pose_b{world.rotation * turn_b, world.rotation * move_b + world.translation};
                        const auto placed = [](const Side& side, const RigidTransform& pose) {
                            return SegmentInWorld{transform(pose, side.from), transform(pose, side.to)};
                        };
                        const SegmentInWorld line_a = placed(a, pose_a), line_b = placed(b, pose_b);
                        const ShapeAtPose pa{a.shape, pose_a}, pb{b.shape, pose_b};
                        const Manifold m = contact_manifold(pa, pb, {.max_points = 8});
                        CAPTURE(i);
                        CAPTURE(degrees);
                        CHECK(m.count >= 2);
                        if (m.count < 2) continue;
                        // Where the cores overlap another way out may be shorter; here it is along x.
                        const glm::dvec3 x = world.rotation[0];
                        if (glm::dot(m.normal, x) < 0.999) continue;
                        ++asked;
                        const Stretch s = common(line_a, line_b);
                        for (int k = 0; k < 2; ++k) {
                            const glm::dvec3 p = s.on_a[k] + a.shape.radius() * m.normal,
                                             q = s.on_b[k] - b.shape.radius() * m.normal, middle = 0.5 * (p + q);
                            double nearest = HUGE_VAL, depth = 0.0;
                            for (int j = 0; j < m.count; ++j)
                                if (const double d = glm::distance(m.points[j].position, middle); d < nearest) {
                                    nearest = d;
                                    depth = m.points[j].depth;
                                }
                            // The stretch may be measured along either line: its ends differ by the angle's square.
                            CHECK(nearest <= scale * 4e-3);
                            CHECK(std::abs(depth - glm::dot(p - q, m.normal)) <= scale * 4e-3);
                        }
                    }
                }
        }
        CHECK(asked > 3000);
    }

    // There the normal is nearly the face's, though the face holds nothing of the side.
    TEST_CASE("a round side just outside a box's face has two points on the face's edge") {
        RandomShapes random(6);
        for (int i = 0; i < 2000; ++i) {
            CAPTURE(i);
            const bool cylinder = i % 2 == 0;
            const float half = float(random.number(0.2, 1.0)), radius = float(random.number(0.1, 0.5));
            const Shape side = cylinder ? Shape::cylinder(half, radius).value() : Shape::capsule(half, radius).value();
            const glm::vec3 h(random.number(0.3, 1.0), random.number(0.3, 1.0), random.number(0.3, 1.0));
            const Shape box = Shape::box(h).value();
            // Beyond the face's edge at x = h.x; upright shapes, side by side.
            const double off = std::pow(10.0, -random.number(cylinder ? 6.0 : 9.0, 12.0)), y = random.number(-0.8, 0.8),
                         depth = random.number(0.0, 0.2 * double(radius));
            const RigidTransform frame{random.rotation(), 10.0 * random.direction()};
            const auto placed = [&](const glm::dvec3& p) {
                return RigidTransform{frame.rotation, frame.rotation * p + frame.translation};
            };
            const RigidTransform pose = placed({double(h.x) + off, y, double(h.z) + double(radius) - depth});
            const Manifold m = contact_manifold({box, frame}, {side, pose});
            const double low = std::max(-double(h.y), y - double(half)), high = std::min(double(h.y), y + double(half));
            if (high - low < depth + 0.01) continue;  // out over an end
            CHECK(m.count == 2);
            double told[2] = {HUGE_VAL, -HUGE_VAL};
            for (int k = 0; k < m.count; ++k) {
                const glm::dvec3 p = glm::transpose(frame.rotation) * (m.points[k].position - frame.translation);
                told[0] = std::min(told[0], p.y), told[1] = std::max(told[1], p.y);
                CHECK(std::abs(p.x - double(h.x)) <= 1e-5);
                CHECK(std::abs(m.points[k].depth - depth) <= 1e-5);
            }
            CHECK(std::abs(told[0] - low) <= 1e-5);
            CHECK(std::abs(told[1] - high) <= 1e-5);
        }
    }

    TEST_CASE("a round side just outside a surface's own triangle has two points on the triangle's edge") {
        RandomShapes random(7);
        for (int i = 0; i < 2000; ++i) {
            CAPTURE(i);
            const float half = float(random.number(0.2, 1.0)), radius = float(random.number(0.1, 0.5));
            const bool cylinder = i % 2 == 0;
            const Shape side = cylinder ? Shape::cylinder(half, radius).value() : Shape::capsule(half, radius).value();
            // Its edge at x = 0 runs along y.
            Surface sheet;
            const float low_y = float(random.number(-1.5, -0.3)), high_y = float(random.number(0.3, 1.5));
            sheet.mesh.positions = {{0, low_y, 0}, {0, high_y, 0}, {-float(random.number(0.5, 2.0)), 0, 0}};
            sheet.mesh.indices = {0, 1, 2};
            sheet.build();
            const Shape surface = sheet.shape(random.index(2) != 0 ? Sides::both : Sides::front);
            const double off = std::pow(10.0, -random.number(cylinder ? 6.0 : 9.0, 12.0)), y = random.number(-0.8, 0.8),
                         depth = random.number(0.0, 0.2 * double(radius));
            const RigidTransform frame{random.rotation(), 10.0 * random.direction()};
            const RigidTransform pose{frame.rotation, transform(frame, glm::dvec3(off, y, double(radius) - depth))};
            const double low = std::max(double(low_y), y - double(half)),
                         high = std::min(double(high_y), y + double(half));
            if (high - low < depth + 0.01) continue;  // out over an end
            const bool flip = random.index(2) != 0;
            const ShapeAtPose a{surface, frame}, b{side, pose};
            const Manifold m = flip ? contact_manifold(b, a) : contact_manifold(a, b);
            CHECK(m.count == 2);
            double told[2] = {HUGE_VAL, -HUGE_VAL};
            for (int k = 0; k < m.count; ++k) {
                const glm::dvec3 p = glm::transpose(frame.rotation) * (m.points[k].position - frame.translation);
                told[0] = std::min(told[0], p.y), told[1] = std::max(told[1], p.y);
                CHECK(std::abs(p.x) <= 1e-5);
                CHECK(std::abs(m.points[k].depth - depth) <= 1e-5);
            }
            CHECK(std::abs(told[0] - low) <= 1e-5);
            CHECK(std::abs(told[1] - high) <= 1e-5);
        }
    }

    TEST_CASE("capsules have two points up to two degrees and one beyond, whatever their size") {
        for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e9})
            for (const double degrees : {1.5, 1.85, 1.99, 1.999, 2.001, 2.01, 2.5}) {
                const Shape capsule = Shape::capsule(float(scale), float(0.5 * scale)).value();
                // Nearest at one end: the other is farther by the tilt.
                const double turn = glm::radians(degrees);
                const RigidTransform low = at({}), high{glm::mat3_cast(glm::angleAxis(turn, glm::dvec3(0, 0, 1))),
                                                        scale * glm::dvec3(0.93, 0, 0)};
                const Manifold m = contact_manifold({capsule, low}, {capsule, high});
                CAPTURE(scale);
                CAPTURE(degrees);
                CHECK(m.count == (degrees < 2.0 ? 2 : 1));
                CHECK(m.depth == doctest::Approx(scale * (1.0 - (0.93 - std::sin(turn)))).epsilon(2e-2));
            }
    }
}
