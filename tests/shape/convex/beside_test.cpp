// SPDX-License-Identifier: MIT
// Pairs of shapes in a crowd: what is found of pairs once, and left out where it cannot matter, changes no contact.
#include <doctest/doctest.h>
#include <crofton/convex/push_out_of_union.hpp>
#include <vector>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct Crowd {
    std::vector<Shape> shapes;
    std::vector<RigidTransform> poses;

    [[nodiscard]] ShapeAtPose at(std::size_t i) const { return {shapes[i], poses[i]}; }
};

// Boxes and hulls within a cube, anywhere or pushed together as crates that overlap a little.
Crowd random_crowd(RandomShapes& random, int count, double width) {
    Crowd crowd;
    for (int i = 0; i < count; ++i) {
        const int kind = random.index(5);
        crowd.shapes.push_back(kind == 0   ? random.box()
                               : kind == 1 ? Shape::rounded(random.box(0.8), 0.2).value()
                                           : random.hull(12, 1.0));
        const double x = random.number(-width, width), y = random.number(-width, width),
                     z = random.number(-width, width);
        const glm::dmat3 rotation = random.rotation();
        crowd.poses.push_back({rotation, {x, y, z}});
    }
    return crowd;
}
Crowd wall_of_crates(RandomShapes& random, double off) {
    Crowd crowd;
    for (int i = 0; i < 18; ++i) {
        crowd.shapes.push_back(Shape::box(glm::vec3(0.5f)).value());
        glm::dvec3 place(i % 3, i / 3 % 3, i / 9);
        for (int k = 0; k < 3; ++k) place[k] += random.number(-off, off);
        crowd.poses.push_back({glm::dmat3(1.0), place});
    }
    return crowd;
}

bool are_same_points(const ContactPoint& p, const ContactPoint& q) {
    return p.position == q.position && p.depth == q.depth && p.on_a == q.on_a && p.on_b == q.on_b &&
           p.part_a == q.part_a && p.part_b == q.part_b;
}
bool are_same(std::span<const Manifold> a, std::span<const Manifold> b) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k) {
        if (a[k].normal != b[k].normal || a[k].depth != b[k].depth || a[k].count != b[k].count) return false;
        for (int i = 0; i < a[k].count; ++i)
            if (!are_same_points(a[k].points[i], b[k].points[i])) return false;
    }
    return true;
}

// What overlaps one of a pair lies beside the other.
struct BesideOf {
    std::vector<ShapeAtPose> shapes[2];
    std::vector<std::uint32_t> numbers[2];

    BesideOf(const Crowd& crowd, std::size_t first, std::size_t second) {
        for (std::size_t i = 0; i < crowd.shapes.size(); ++i) {
            if (i == first || i == second) continue;
            for (int side = 0; side < 2; ++side) {
                if (!intersects(crowd.at(side == 0 ? second : first), crowd.at(i))) continue;
                shapes[side].push_back(crowd.at(i));
                numbers[side].push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    [[nodiscard]] Beside all() const { return {shapes[0], shapes[1]}; }
};

// A point within a shape and away from another, in whose bounds it may lie.
std::optional<glm::dvec3> point_away(RandomShapes& random, const ShapeAtPose& of, const ShapeAtPose& from) {
    for (int tries = 0; tries < 20; ++tries) {
        const glm::dvec3 direction = random.direction();
        const glm::dvec3 local = 0.7 * support_point(of.shape, direction);
        const glm::dvec3 point = of.pose.rotation * local + of.pose.translation;
        const glm::dvec3 near = glm::transpose(from.pose.rotation) * (point - from.pose.translation);
        const Aabb& bounds = from.shape.bounds();
        const bool is_near = glm::all(glm::lessThan(bounds.min, near)) && glm::all(glm::lessThan(near, bounds.max));
        if (is_near && closest_point(of, point).distance == 0.0 && closest_point(from, point).distance > 0.05)
            return point;
    }
    return std::nullopt;
}

}  // namespace

TEST_SUITE("convex/beside") {
    TEST_CASE("contacts in a crowd are the same whether pairs are asked one by one or remembered together") {
        RandomShapes random(4901);
        int touching = 0, changed = 0;
        const auto check = [&](const Crowd& crowd) {
            PairMemory memory;
            Manifolds alone, remembered, direct;
            const ManifoldOptions options{.margin = 0.01};
            for (std::size_t i = 0; i < crowd.shapes.size(); ++i)
                for (std::size_t k = i + 1; k < crowd.shapes.size(); ++k) {
                    const ShapeAtPose a = crowd.at(i), b = crowd.at(k);
                    PairCache cache, same;
                    contact_manifolds(a, b, options, alone, &cache);
                    if (alone.all().empty()) continue;
                    ++touching;
                    const BesideOf beside(crowd, i, k);
                    contact_manifolds(a, b, options, remembered, &cache);
                    push_out_of_union(a, b,
                                      {beside.all(), static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k),
                                       beside.numbers[0], beside.numbers[1]},
                                      options, remembered, memory, cache);
                    contact_manifolds(a, b, options, alone, &same);
                    contact_manifolds(a, b, beside.all(), options, direct, &same);
                    CHECK(are_same(remembered.all(), direct.all()));
                    changed += !are_same(direct.all(), alone.all());
                }
        };
        for (int round = 0; round < 120; ++round) check(random_crowd(random, 16, 1.0 + 0.01 * round));
        for (int round = 0; round < 500; ++round)
            check(wall_of_crates(random, std::pow(10.0, -random.number(1.5, 6.0))));
        CHECK(touching > 20000);
        CHECK(changed > 2000);
    }

    // A second part that touches nothing makes the first a shape of parts, which has all contacts beside it found.
    TEST_CASE("a contact that no flush neighbour covers stays the same if all contacts around it are computed") {
        RandomShapes random(4902);
        int asked = 0;
        Manifolds as_one, as_parts;
        const ManifoldOptions options{.margin = 0.01};
        for (int round = 0; round < 400; ++round) {
            const Crowd crowd = random_crowd(random, 14, 1.0 + 0.003 * round);
            for (std::size_t i = 0; i < crowd.shapes.size(); ++i)
                for (std::size_t k = 0; k < crowd.shapes.size(); ++k) {
                    if (i == k || !intersects(crowd.at(i), crowd.at(k))) continue;
                    const ShapeAtPose a = crowd.at(i), b = crowd.at(k);
                    const auto point = point_away(random, a, b);
                    if (!point) continue;
                    const BesideOf beside(crowd, i, k);
                    const Shape grain = Shape::sphere(1e-4).value();
                    const CompoundChild parts[] = {
                        {a.shape, {}},
                        {grain, {glm::dmat3(1.0), glm::transpose(a.pose.rotation) * (*point - a.pose.translation)}}};
                    const Compound compound = Compound::build(parts).value();
                    const Shape both = Shape::compound(compound);
                    contact_manifolds(a, b, beside.all(), options, as_one);
                    contact_manifolds({both, a.pose}, b, beside.all(), options, as_parts);
                    CHECK(are_same(as_one.all(), as_parts.all()));
                    ++asked;
                }
        }
        CHECK(asked > 1500);
    }
}
