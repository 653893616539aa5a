// SPDX-License-Identifier: MIT
// Every kind of shape asked about every kind, all questions: their answers agree with each other.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <optional>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct Named {
    std::string name;
    Shape shape;
    double tolerance = 1e-9;  // of a depth, relative to the pair's size
    bool one_sided = false;
};

// One of each kind, with rounded ones. What they are views of lives as long as this.
class AllKinds {
  public:
    explicit AllKinds(RandomShapes& random)
        : mesh_(tangle(random, 8, 12)), floor_(ground(random, 3, 0.5, [](double x, double z) { return 0.2 * x * z; })) {
        const std::vector<float> heights{0, 0.2f, 0.1f, 0.3f, 0, 0.4f, 0.1f, 0.2f, 0, 0.3f, 0.2f, 0};
        const std::vector<std::uint8_t> materials{0, 1, 2, kHole, 0, 0};
        field_ = HeightField::build(
                     {.columns = 4, .rows = 3, .heights = heights, .spacing = {0.5, 0.6}, .materials = materials})
                     .value();
        const Shape box = random.box(), hull = random.hull(16),
                    triangle = Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value();
        const Shape cylinder = Shape::cylinder(0.5f, 0.4f).value();
        add("sphere", Shape::sphere(0.6f).value());
        add("capsule", Shape::capsule(0.5f, 0.3f).value());
        add("cylinder", cylinder, 1e-5);
        add("cone", Shape::cone(0.5f, 0.4f).value(), 1e-5);
        add("box", box);
        add("triangle", triangle);
        add("hull", hull);
        add("half-space", Shape::half_space({{0.3, 1, 0.2}, -0.1}).value());
        add("rounded box", Shape::rounded(box, 0.1f).value());
        add("rounded hull", Shape::rounded(hull, 0.1f).value());
        add("rounded triangle", Shape::rounded(triangle, 0.1f).value());
        add("rounded cylinder", Shape::rounded(cylinder, 0.1f).value(), 1e-5);
        add("mesh", mesh_.shape());
        add("front of a mesh", floor_.shape(Sides::front)).one_sided = true;
        add("height field", Shape::height_field(*field_, Sides::both));
        const std::vector<CompoundChild> inner{{hull, at({0.4, 0, 0})}, {cylinder, at({-0.4, 0.1, 0})}};
        inner_ = Compound::build(inner).value();
        outer_ = Compound::build(std::vector<CompoundChild>{{Shape::compound(*inner_), at({0, 0.3, 0})},
                                                            {mesh_.shape(), at({0, -0.5, 0.3})},
                                                            {Shape::sphere(0.3f).value(), at({0, 0, -0.5})}})
                     .value();
        add("compound", Shape::compound(*outer_), 1e-5);
    }
    [[nodiscard]] const std::vector<Named>& all() const { return shapes_; }

  private:
    Named& add(const std::string& name, const Shape& shape, double tolerance = 1e-9) {
        shapes_.push_back({name, shape, tolerance, false});
        return shapes_.back();
    }
    Surface mesh_, floor_;
    std::optional<HeightField> field_;
    std::optional<Compound> inner_, outer_;
    std::vector<Named> shapes_;
};

// A pair, and how far its answers may be from each other.
struct AskedPair {
    const Named &first, &second;
    RigidTransform pose_a, pose_b;

    [[nodiscard]] ShapeAtPose a() const { return {first.shape, pose_a}; }
    [[nodiscard]] ShapeAtPose b() const { return {second.shape, pose_b}; }
    [[nodiscard]] double size() const {
        return std::min(first.shape.core_radius(), 4.0) + std::min(second.shape.core_radius(), 4.0) +
               glm::distance(pose_a.translation, pose_b.translation);
    }
    [[nodiscard]] double tolerance() const { return size() * std::max(first.tolerance, second.tolerance); }
    [[nodiscard]] bool are_convex() const { return first.shape.is_convex() && second.shape.is_convex(); }
    [[nodiscard]] bool one_sided() const { return first.one_sided || second.one_sided; }
    [[nodiscard]] bool are_half_spaces() const {
        return first.shape.kind() == Kind::half_space && second.shape.kind() == Kind::half_space;
    }
};

// `visit` is given poses for both, about half of which meet.
template <class Visit>
void for_each_pair(RandomShapes& random, int poses, Visit visit) {
    const AllKinds kinds(random);
    for (const Named& a : kinds.all())
        for (const Named& b : kinds.all()) {
            CAPTURE(a.name);
            CAPTURE(b.name);
            for (int i = 0; i < poses; ++i) {
                CAPTURE(i);
                const glm::dvec3 place(random.number(-3, 3), random.number(-3, 3), random.number(-3, 3));
                visit(AskedPair{a, b, RigidTransform{random.rotation(), place},
                                RigidTransform{random.rotation(), place + random.number(0, 2.4) * random.direction()}});
            }
        }
}

RigidTransform shifted(RigidTransform pose, const glm::dvec3& way) {
    pose.translation += way;
    return pose;
}

// The part of that id, where it stands.
Part part_of(const ShapeAtPose& shape, const ShapeAtPose& other, const PartId& id) {
    Vector<Part> parts;
    parts_near(shape, other, 0.1, parts);
    for (const Part& part : parts)
        if (part.id == id || shape.shape.is_convex()) return part;
    FAIL("the part is not among those near");
    return parts.front();
}

void check_distance(const AskedPair& pair, bool meet) {
    const Distance d = distance(pair.a(), pair.b()), back = distance(pair.b(), pair.a());
    CHECK((d.distance == 0.0) == meet);
    CHECK((back.distance == 0.0) == meet);
    CHECK(d.lower <= d.distance + 1e-12 * pair.size());
    CHECK(d.distance <= d.upper + 1e-12 * pair.size());
    CHECK(std::abs(d.distance - back.distance) <= pair.tolerance());
    if (pair.are_half_spaces()) return;
    const double slack = 1e-9 * pair.size() + pair.tolerance();
    CHECK(closest_point(pair.a(), d.on_a).distance <= slack);
    CHECK(closest_point(pair.b(), d.on_b).distance <= slack);
    CHECK(std::abs(glm::distance(d.on_a, d.on_b) - d.distance) <= slack);
    // A point is a sphere without radius, and no farther from the shape than from its nearest point.
    const Shape point = Shape::sphere(0.0).value();
    const Distance from_point = closest_point(pair.a(), d.on_b);
    CHECK(std::abs(from_point.distance - distance(pair.a(), {point, at(d.on_b)}).distance) <= slack);
    CHECK(from_point.distance <= d.distance + slack);
    if (!meet) CHECK(from_point.distance >= d.distance - slack);
}

void check_penetration(RandomShapes& random, const AskedPair& pair, bool meet) {
    const Penetration p = penetration(pair.a(), pair.b()), back = penetration(pair.b(), pair.a());
    CHECK(p.overlapping == meet);
    CHECK(back.overlapping == meet);
    if (!meet) {
        CHECK(p.depth == 0.0);
        return;
    }
    if (pair.are_half_spaces()) {
        CHECK(std::isinf(p.depth));
        return;
    }
    CHECK(p.lower <= p.depth + 1e-12 * pair.size());
    CHECK(p.depth <= p.upper + 1e-12 * pair.size());
    CHECK(std::abs(p.depth - back.depth) <= pair.tolerance());
    CHECK(glm::length(p.normal) == doctest::Approx(1.0));
    const double beyond = p.depth + 2.0 * pair.tolerance();
    if (pair.are_convex()) {
        CHECK_FALSE(intersects(pair.a(), {pair.second.shape, shifted(pair.pose_b, beyond * p.normal)}));
    } else {
        const Part a = part_of(pair.a(), pair.b(), p.part_a), b = part_of(pair.b(), pair.a(), p.part_b);
        CHECK_FALSE(intersects({a.shape, a.pose}, {b.shape, shifted(b.pose, beyond * p.normal)}));
    }
    // No way that is shorter than the lower bound parts them, along the normal or any other.
    const double within = p.lower - 1e-9 * pair.size();
    for (int k = 0; k < 4 && within > 0.0; ++k) {
        const glm::dvec3 way = within * (k == 0 ? p.normal : random.direction());
        CHECK(intersects(pair.a(), {pair.second.shape, shifted(pair.pose_b, way)}));
    }
}

void check_manifold(const AskedPair& pair, bool meet) {
    const Manifold m = contact_manifold(pair.a(), pair.b()), back = contact_manifold(pair.b(), pair.a());
    if (!meet) {
        CHECK(m.count == 0);
        CHECK(back.count == 0);
    } else if (!pair.one_sided() && !pair.are_half_spaces()) {
        CHECK(m.count > 0);
        CHECK(back.count > 0);
    }
    Manifolds all;
    contact_manifolds(pair.a(), pair.b(), {}, all);
    CHECK(all.all().empty() == (m.count == 0));
    if (!pair.are_convex() || pair.are_half_spaces()) return;
    const double depth = meet ? penetration(pair.a(), pair.b()).depth : -distance(pair.a(), pair.b()).distance;
    // Points are off by 1e-5 of the size where a hull's face is not quite flat.
    const bool is_hull = pair.first.shape.hull() != nullptr || pair.second.shape.hull() != nullptr;
    const double slack = 2.0 * std::max(pair.tolerance(), is_hull ? 1e-5 * pair.size() : 0.0);
    const Manifold wide = contact_manifold(pair.a(), pair.b(), {.margin = 3.0, .max_points = 8});
    for (const Manifold& told : {m, wide, contact_manifold(pair.b(), pair.a(), {.margin = 3.0})}) {
        if (told.count == 0) continue;
        CHECK(std::abs(told.depth - depth) <= slack);
        double deepest = -HUGE_VAL;
        for (int i = 0; i < told.count; ++i) deepest = std::max(deepest, told.points[i].depth);
        CHECK(std::abs(deepest - depth) <= slack);
    }
    CHECK((wide.count > 0) == (depth >= -3.0));
}

// How many casts were not resolved.
int check_cast(RandomShapes& random, const AskedPair& pair, bool meet) {
    const auto motion = [&](const Shape& shape) {
        Motion m{random.number(0, 4) * random.direction(), {}, {}};
        if (shape.kind() != Kind::half_space) m.spin = random.number(0, 3) * random.direction();
        return m;
    };
    const Motion motion_a = motion(pair.first.shape), motion_b = motion(pair.second.shape);
    const auto impact = cast(pair.a(), motion_a, pair.b(), motion_b);
    // Two half-spaces meet, or `distance` tells when: a refusal.
    if (pair.are_half_spaces()) {
        CHECK(error_of(impact).code == ErrorCode::unsupported);
        return 0;
    }
    REQUIRE(impact.has_value());
    const auto poses = [&](double t) {
        return std::pair(moved(pair.pose_a, motion_a, t), moved(pair.pose_b, motion_b, t));
    };
    if (impact->result == CastResult::hit) {
        const auto then = poses(impact->time);
        CHECK(distance({pair.first.shape, then.first}, {pair.second.shape, then.second}).distance <=
              1.01e-6 + 1e-9 * pair.size());
    }
    if (pair.one_sided()) return 0;
    if (meet) {
        CHECK(impact->result == CastResult::hit);
        CHECK(impact->time == 0.0);
        return 0;
    }
    const double end = impact->result == CastResult::miss ? 1.0 : impact->time;
    for (int k = 0; k < 12; ++k) {
        const auto then = poses(end * k / 12);
        CHECK_FALSE(intersects({pair.first.shape, then.first}, {pair.second.shape, then.second}));
    }
    return impact->result == CastResult::unresolved;
}

}  // namespace

TEST_SUITE("convex/every_pair") {
    TEST_CASE("every kind with every kind: they meet iff their distance is 0, whichever comes first") {
        RandomShapes random(31);
        int meeting = 0, asked = 0;
        for_each_pair(random, 8, [&](const AskedPair& pair) {
            const bool meet = intersects(pair.a(), pair.b());
            CHECK(intersects(pair.b(), pair.a()) == meet);
            PairCache cache;
            for (int k = 0; k < 2; ++k) CHECK(intersects(pair.a(), pair.b(), &cache) == meet);
            check_distance(pair, meet);
            meeting += meet;
            ++asked;
        });
        CHECK(meeting > asked / 4);
        CHECK(meeting < 3 * asked / 4);
    }

    TEST_CASE("every kind with every kind: the depth parts them, and nothing shorter does") {
        RandomShapes random(32);
        for_each_pair(random, 8,
                      [&](const AskedPair& pair) { check_penetration(random, pair, intersects(pair.a(), pair.b())); });
    }

    TEST_CASE("every kind with every kind: there are contact points iff they meet, as deep as the depth") {
        RandomShapes random(33);
        for_each_pair(random, 8, [&](const AskedPair& pair) { check_manifold(pair, intersects(pair.a(), pair.b())); });
    }

    TEST_CASE("every kind with every kind: a cast ends where they are near, and before they do not meet") {
        RandomShapes random(34);
        int unresolved = 0, asked = 0;
        for_each_pair(random, 8, [&](const AskedPair& pair) {
            unresolved += check_cast(random, pair, intersects(pair.a(), pair.b()));
            ++asked;
        });
        CHECK(unresolved < asked / 50);
    }
}
