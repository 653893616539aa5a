// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <error_of.hpp>
#include <memory>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

RigidTransform product(const RigidTransform& outer, const RigidTransform& inner) {
    return {outer.rotation * inner.rotation, outer.rotation * inner.translation + outer.translation};
}

// Children and what they stand for one by one, with compounds within put in their place.
struct Tree {
    std::vector<std::unique_ptr<Compound>> inner;
    std::unique_ptr<Compound> compound;
    std::vector<CompoundChild> flat;
};

Tree random_tree(RandomShapes& random, int children, int levels, const Surface* surface = nullptr) {
    Tree tree;
    std::vector<CompoundChild> list;
    for (int i = 0; i < children; ++i) {
        const RigidTransform pose{random.rotation(), random.number(0, 2) * random.direction()};
        if (levels > 1 && i % 3 == 0) {
            Tree below = random_tree(random, 3, levels - 1);
            for (const CompoundChild& child : below.flat) tree.flat.push_back({child.shape, product(pose, child.pose)});
            for (auto& c : below.inner) tree.inner.push_back(std::move(c));
            list.push_back({Shape::compound(*below.compound), pose});
            tree.inner.push_back(std::move(below.compound));
        } else {
            const Shape shape = surface != nullptr && i == 1 ? surface->shape() : any_shape(random, 0.4);
            list.push_back({shape, pose});
            tree.flat.push_back({shape, pose});
        }
    }
    tree.compound = std::make_unique<Compound>(Compound::build(list).value());
    return tree;
}

}  // namespace

TEST_SUITE("convex/compound") {
    TEST_CASE("no children and bad poses are named errors, with the child") {
        CHECK(error_of(Compound::build({})).code == ErrorCode::empty);
        const Shape box = Shape::box({1, 1, 1}).value();
        std::vector<CompoundChild> children{{box, at({})}, {box, at({})}};
        children[1] = {box, at({0, NAN, 0})};
        REQUIRE_FALSE(Compound::build(children).has_value());
        CHECK(error_of(Compound::build(children)).code == ErrorCode::non_finite);
        CHECK(error_of(Compound::build(children)).item == 1);
        children[1].pose = at({0, 1, 0});
        children[1].pose.rotation[2] = -children[1].pose.rotation[2];  // mirrors
        CHECK(error_of(Compound::build(children)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("a compound with half-spaces is ground without end: it answers as its children, in either order") {
        RandomShapes random(4110);
        for (int round = 0; round < 300; ++round) {
            const bool all_ground = round % 5 == 0;
            std::vector<CompoundChild> children;
            children.push_back({Shape::half_space({random.direction(), random.number(-1.0, 1.0)}).value(),
                                {random.rotation(), random.direction()}});
            if (!all_ground)
                for (int i = 0; i < 7; ++i)
                    children.push_back({random.polytope(12), {random.rotation(), 4.0 * random.direction()}});
            const Compound level = Compound::build(children).value();
            CHECK(!Shape::compound(level).is_bounded());
            // Ground within a compound is ground as well.
            const CompoundChild within{Shape::compound(level), {random.rotation(), random.direction()}};
            const Compound outer = Compound::build({&within, 1}).value();
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            const RigidTransform inner{pose.rotation * within.pose.rotation,
                                       pose.rotation * within.pose.translation + pose.translation};
            const std::vector<CompoundChild> spheres{{Shape::sphere(0.5).value(), at({0.3, 0, 0})},
                                                     {random.box(), at({-0.6, 0, 0})}};
            const Compound pair = Compound::build(spheres).value();
            const Shape shape = round % 3 == 0 ? Shape::compound(pair) : random.polytope(12);
            const RigidTransform place{random.rotation(), pose.translation + 6.0 * random.direction()};
            const ShapeAtPose ground{Shape::compound(outer), pose}, thing{shape, place};
            bool meets = false;
            double nearest = HUGE_VAL, deepest = 0.0, first = HUGE_VAL;
            const Motion fall{.velocity = 8.0 * random.direction(), .spin = 2.0 * random.direction()};
            for (const CompoundChild& child : children) {
                const RigidTransform at{inner.rotation * child.pose.rotation,
                                        inner.rotation * child.pose.translation + inner.translation};
                const ShapeAtPose part{child.shape, at};
                meets = meets || intersects(part, thing);
                nearest = std::min(nearest, distance(part, thing).distance);
                deepest = std::max(deepest, penetration(part, thing).depth);
                const auto impact = cast(thing, fall, part, {}).value();
                if (impact.result == CastResult::hit) first = std::min(first, impact.time);
            }
            CAPTURE(round);
            for (const bool swap : {false, true}) {
                const ShapeAtPose &a = swap ? thing : ground, &b = swap ? ground : thing;
                CHECK(intersects(a, b) == meets);
                CHECK(distance(a, b).distance == doctest::Approx(nearest).epsilon(1e-8));
                CHECK(penetration(a, b).depth == doctest::Approx(deepest).epsilon(1e-8));
                Manifolds found;
                contact_manifolds(a, b, {}, found);
                CHECK(found.all().empty() == !meets);
                const auto impact = swap ? cast(a, fall, b, {}).value() : cast(a, {}, b, fall).value();
                CHECK((impact.result == CastResult::hit) == (first < HUGE_VAL));
                if (first < HUGE_VAL) CHECK(impact.time == doctest::Approx(first).epsilon(1e-4));
            }
            CHECK(error_of(cast(ground, fall, thing, {})).code == ErrorCode::unsupported);
            CHECK(error_of(cast(thing, {}, ground, fall)).item == 1);
            CHECK(error_of(cast(ground, {}, ground, {})).code == ErrorCode::unsupported);
            CHECK(error_of(mass_properties(Shape::compound(level))).code == ErrorCode::unsupported);
            int lines = 0;
            outline(ground, [&](const glm::dvec3& from, const glm::dvec3& to) {
                lines += std::isfinite(glm::length(from) + glm::length(to)) ? 1 : -1000;
            });
            CHECK(lines > 0);
        }
    }

    TEST_CASE("compounds in compounds: sixteen deep work, the seventeenth is a named error, so a thousand never nest") {
        std::vector<std::unique_ptr<Compound>> chain;
        Shape shape = Shape::sphere(0.5f).value();
        int built = 0;
        for (; built < 1000; ++built) {
            const CompoundChild child{shape, at({1, 0, 0})};
            auto next = Compound::build({&child, 1});
            if (!next) {
                CHECK(next.error().code == ErrorCode::out_of_range);
                CHECK(next.error().item == 0);
                break;
            }
            chain.push_back(std::make_unique<Compound>(std::move(*next)));
            shape = Shape::compound(*chain.back());
        }
        CHECK(built == kMaxCompoundDepth);
        CHECK(chain.back()->depth() == kMaxCompoundDepth);
        const Shape point = Shape::sphere(0.0f).value();
        CHECK(intersects({shape, at({})}, {point, at({16.4, 0, 0})}));
        CHECK_FALSE(intersects({shape, at({})}, {point, at({16.6, 0, 0})}));
        CHECK(distance({shape, at({})}, {point, at({20, 0, 0})}).distance == doctest::Approx(3.5));
    }

    TEST_CASE("children are numbered through, with those of compounds within in their place") {
        RandomShapes random(1);
        const Tree tree = random_tree(random, 9, 3);
        REQUIRE(tree.compound->part_count() == tree.flat.size());
        for (std::uint32_t i = 0; i < tree.compound->part_count(); ++i)
            CHECK(tree.compound->part(i).shape.kind() == tree.flat[i].shape.kind());
    }

    TEST_CASE("all answers are those of the children one by one") {
        RandomShapes random(2);
        const Surface patch = soup(random, 20, 1.0, 0.4);
        int meeting = 0, hits = 0;
        Manifolds found;
        for (int round = 0; round < 120; ++round) {
            const Tree tree =
                random_tree(random, 1 + random.index(12), 1 + round % 3, round % 2 == 0 ? &patch : nullptr);
            const Shape shape = Shape::compound(*tree.compound), b = any_shape(random, 0.6);
            const RigidTransform pose{random.rotation(), random.number(0, 1e5) * random.direction()};
            const RigidTransform pose_b{random.rotation(),
                                        pose.translation + random.number(0, 2.8) * random.direction()};
            const Motion spin{random.direction(), random.direction(), {}}, still;
            const Motion& motion = round % 4 == 0 ? spin : still;
            const Motion fly{1.5 * (pose.translation - pose_b.translation), 3.0 * random.direction(), {}};
            bool meets = false;
            double least = HUGE_VAL, deepest = -1.0, first = 1.0, depth = 0.0;
            std::uint32_t nearest = 0;
            for (std::size_t i = 0; i < tree.flat.size(); ++i) {
                const RigidTransform place = product(pose, tree.flat[i].pose);
                const ShapeAtPose child{tree.flat[i].shape, place};
                meets = meets || intersects(child, {b, pose_b});
                const double d = distance(child, {b, pose_b}).distance;
                if (d < least) least = d, nearest = static_cast<std::uint32_t>(i);
                contact_manifolds(child, {b, pose_b}, {.margin = 0.02}, found);
                for (const Manifold& m : found.all()) deepest = std::max(deepest, m.depth);
                depth = std::max(depth, penetration(child, {b, pose_b}).depth);
                Motion own = motion;
                own.pivot = glm::transpose(tree.flat[i].pose.rotation) * (motion.pivot - tree.flat[i].pose.translation);
                first = std::min(first, cast(child, own, {b, pose_b}, fly, {.max_steps = 5000}).value().time);
            }
            CHECK(intersects({shape, pose}, {b, pose_b}) == meets);
            const Distance d = distance({shape, pose}, {b, pose_b});
            CHECK(d.distance == doctest::Approx(least).epsilon(1e-6));
            if (least > 0.0) CHECK(d.part_a.child == nearest);
            contact_manifolds({b, pose_b}, {shape, pose}, {.margin = 0.02}, found);
            double told = -1.0;
            for (const Manifold& m : found.all()) told = std::max(told, m.depth);
            CHECK(told == doctest::Approx(deepest).epsilon(1e-6));
            CHECK(penetration({shape, pose}, {b, pose_b}).depth == doctest::Approx(depth).epsilon(1e-6));
            const Impact impact = cast({shape, pose}, motion, {b, pose_b}, fly, {.max_steps = 5000}).value();
            CHECK(std::abs(impact.time - first) <= 1e-5);
            meeting += meets;
            hits += impact.result == CastResult::hit;
        }
        CHECK(meeting > 20);
        CHECK(hits > 30);
    }

    TEST_CASE("compound against compound: every pair of children") {
        RandomShapes random(3);
        int meeting = 0;
        for (int round = 0; round < 100; ++round) {
            const Tree a = random_tree(random, 6, 2), b = random_tree(random, 5, 1);
            const Shape shape_a = Shape::compound(*a.compound), shape_b = Shape::compound(*b.compound);
            const RigidTransform pose_a{random.rotation(), {}},
                pose_b{random.rotation(), random.number(1, 2.5) * random.direction()};
            const Motion fly{-2.0 * pose_b.translation, {}, {}};
            bool meets = false;
            double least = HUGE_VAL, first = 1.0;
            for (const CompoundChild& x : a.flat)
                for (const CompoundChild& y : b.flat) {
                    const RigidTransform px = product(pose_a, x.pose), py = product(pose_b, y.pose);
                    meets = meets || intersects({x.shape, px}, {y.shape, py});
                    least = std::min(least, distance({x.shape, px}, {y.shape, py}).distance);
                    first = std::min(first, cast({x.shape, px}, {}, {y.shape, py}, fly).value().time);
                }
            CHECK(intersects({shape_a, pose_a}, {shape_b, pose_b}) == meets);
            CHECK(distance({shape_a, pose_a}, {shape_b, pose_b}).distance == doctest::Approx(least).epsilon(1e-6));
            CHECK(std::abs(cast({shape_a, pose_a}, {}, {shape_b, pose_b}, fly).value().time - first) <= 1e-5);
            meeting += meets;
        }
        CHECK(meeting > 10);
    }

    TEST_CASE("a child far from the compound's origin meets what it meets alone, also where they only touch") {
        RandomShapes random(7);
        int meeting = 0;
        for (int round = 0; round < 2000; ++round) {
            const Shape box = Shape::box({1, 1, 1}).value();
            const CompoundChild child{box, {random.rotation(), 1e6 * random.direction()}};
            const Compound compound = Compound::build({&child, 1}).value();
            RigidTransform pose{random.rotation(), {}};
            pose.translation = random.direction() - pose.rotation * child.pose.translation;
            const RigidTransform there = product(pose, child.pose);
            RigidTransform other{round % 2 != 0 ? there.rotation : random.rotation(), 3.0 * random.direction()};
            const Distance apart = distance({box, there}, {box, other});
            const Penetration deep = penetration({box, there}, {box, other});
            other.translation += deep.depth * deep.normal - apart.distance * apart.normal;
            const bool meet = intersects({box, there}, {box, other});
            CHECK(intersects({Shape::compound(compound), pose}, {box, other}) == meet);
            meeting += meet;
        }
        CHECK(meeting > 200);
    }

    TEST_CASE("a compound's cast far from the world's origin is that of its child, but for the place's rounding") {
        RandomShapes random(8);
        const Shape box = Shape::box({0.5f, 0.5f, 0.5f}).value();
        for (int round = 0; round < 200; ++round) {
            const CompoundChild child{box, {random.rotation(), random.direction()}};
            const Compound compound = Compound::build({&child, 1}).value();
            const RigidTransform pose{random.rotation(), glm::dvec3(1e10, -1e10, 1e10)},
                there = product(pose, child.pose),
                other{random.rotation(), pose.translation + 5.0 * random.direction()};
            const Motion fly{2.0 * (pose.translation - other.translation), {}, {}};
            const CastOptions close{.tolerance = 1e-9};
            const Impact whole = cast({Shape::compound(compound), pose}, {}, {box, other}, fly, close).value(),
                         alone = cast({box, there}, {}, {box, other}, fly, close).value();
            CHECK(whole.result == alone.result);
            CHECK(std::abs(whole.time - alone.time) * 10.0 <= 5e-6);  // places are off by 2e-6
        }
    }

    TEST_CASE("a compound far out answers as its child where the rounded product of the poses puts it") {
        RandomShapes random(9);
        const Shape cube = Shape::box({0.5f, 0.5f, 0.5f}).value();
        int touching = 0;
        for (int round = 0; round < 3000; ++round) {
            const double far = std::pow(10.0, random.number(0, 12));
            const bool nested = round % 3 == 0, turned = round % 2 == 0;
            const CompoundChild child{cube, {turned ? random.rotation() : glm::dmat3(1.0), 0.7 * random.direction()}};
            const Compound inner = Compound::build({&child, 1}).value();
            const CompoundChild middle{Shape::compound(inner), {glm::dmat3(1.0), 0.9 * random.direction()}};
            const Compound compound = Compound::build({nested ? &middle : &child, 1}).value();
            const Shape whole = Shape::compound(compound);
            const RigidTransform pose{turned ? random.rotation() : glm::dmat3(1.0), far * random.direction()};
            RigidTransform part = nested ? product(pose, middle.pose) : pose;
            part = product(part, child.pose);
            // Axes alike: the sum of the half extents away, or the next number beside it, along one axis.
            RigidTransform other{glm::dmat3(1.0), part.translation};
            const int k = round % 5 == 0 ? 1 : 0;
            other.translation[k] += round % 7 == 0 ? -1.0 : 1.0;
            if (round % 3 == 1) other.translation[k] = std::nextafter(other.translation[k], 1e300);
            const ShapeAtPose a{whole, pose}, alone{cube, part}, b{cube, other};
            const bool meet = intersects(alone, b);
            touching += meet;
            CAPTURE(round);
            CHECK(intersects(a, b) == meet);
            CHECK(intersects(b, a) == meet);
            const Distance d = distance(a, b), expected = distance(alone, b);
            CHECK(d.distance == expected.distance);
            CHECK(d.lower <= expected.upper);
            CHECK(d.upper >= expected.lower);
            CHECK(d.on_a == expected.on_a);
            CHECK(d.on_b == expected.on_b);
            CHECK(d.normal == expected.normal);
            const Penetration p = penetration(a, b), alone_deep = penetration(alone, b);
            CHECK(p.overlapping == meet);
            CHECK(p.depth == alone_deep.depth);
            CHECK(p.normal == alone_deep.normal);
            CHECK(p.on_a == alone_deep.on_a);
            CHECK(p.on_b == alone_deep.on_b);
            Manifolds found;
            contact_manifolds(a, b, {}, found);
            const Manifold m = contact_manifold(alone, b);
            CHECK(found.all().size() == (m.count > 0 ? 1 : 0));
            CHECK(found.all().empty() != meet);
            if (!found.all().empty()) CHECK(found.all()[0].count == m.count);
            // Two compounds.
            const CompoundChild at_home{cube, {}};
            const Compound second = Compound::build({&at_home, 1}).value();
            CHECK(intersects(a, {Shape::compound(second), other}) == meet);
        }
        CHECK(touching > 500);
        CHECK(touching < 2900);
    }
}
