// SPDX-License-Identifier: MIT
// Shapes that are larger than their objects' bounds, scaled by transforms, or without end; rays at them.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "shape_pose.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

// A bound of any kind around a place that need not contain the shape; where the shape stands.
Bound any_bound(RandomShapes& random, const glm::dvec3& place, double size) {
    const auto half = [&] { return static_cast<float>(size * std::exp2(random.number(-6.0, 0.5))); };
    switch (random.index(3)) {
        case 0:
            return Sphere{place, static_cast<double>(half())};
        case 1:
            return Obb{place, glm::mat3(1.0f), {half(), half(), half()}};
        default:
            return Obb{place, glm::mat3(random.rotation()), {half(), half(), half()}};
    }
}
RigidTransform pose_of(const Bound& bound) {
    if (bound.kind == BoundKind::sphere) return at(bound.box.center);
    return testing::pose_of(bound.box);
}

struct Thing {
    std::optional<convex::Shape> shape;
    Bound bound;
    ObjectHandle object;
    bool lives = true;
    std::uint32_t layers = ~0u;
    bool alone = false;  // the object has a shape and nothing else; `bound` is then the box that says where

    [[nodiscard]] RigidTransform pose() const { return ::pose_of(bound); }
};

// With the thing's layers, which are those it collides with.
void add_to(World& world, Thing& thing) {
    ObjectDescription description{.shape = &*thing.shape};
    if (thing.alone)
        description.transform = Transform{thing.pose().rotation, thing.pose().translation};
    else
        description.bound = thing.bound;
    description.layers = description.collides_with = thing.layers;
    thing.object = world.add(description).value();
}
void move(World& world, const Thing& thing) {
    if (!thing.alone) REQUIRE(world.set_bound(thing.object, thing.bound).has_value());
    const Transform transform{thing.pose().rotation, thing.pose().translation};
    if (thing.alone) REQUIRE(world.set_transform(thing.object, transform).has_value());
}

void require_contacts(const World& world, const std::vector<Thing>& things, double margin) {
    std::set<IndexPair> expected, now, paired;
    convex::Manifolds found;
    for (const Thing& a : things)
        for (const Thing& b : things) {
            if (!a.lives || !b.lives || !a.shape || !b.shape || a.object.index >= b.object.index) continue;
            if ((a.layers & b.layers) == 0) continue;
            convex::contact_manifolds({*a.shape, a.pose()}, {*b.shape, b.pose()}, {.margin = margin}, found);
            if (!found.all().empty()) expected.insert({a.object.index, b.object.index});
        }
    for (const ObjectPair& pair : world.pairs()) paired.insert({pair.first.object.index, pair.second.object.index});
    REQUIRE(paired.size() == world.pairs().size());
    for (const Contact& contact : world.contacts()) {
        const IndexPair pair{contact.first.object.index, contact.second.object.index};
        REQUIRE(paired.count(pair) == (contact.phase == ContactPhase::ended ? paired.count(pair) : 1));
        if (!contact.shape_points.empty()) now.insert(pair);
    }
    REQUIRE(now == expected);
}

void require_queries(RandomShapes& random, const World& world, const std::vector<Thing>& things, double extent) {
    const convex::Shape probe = any_shape(random, 1.0);
    const RigidTransform pose{random.rotation(), extent * random.number(0.0, 1.0) * random.direction()};
    const convex::Motion motion{.velocity = 3.0 * extent * random.direction()};
    std::vector<std::uint32_t> meeting;
    double nearest = HUGE_VAL, first = HUGE_VAL;
    for (const Thing& thing : things) {
        if (!thing.lives || !thing.shape) continue;
        const convex::ShapeAtPose placed{*thing.shape, thing.pose()};
        if (convex::intersects({probe, pose}, placed)) meeting.push_back(thing.object.index);
        nearest = std::min(nearest, convex::distance({probe, pose}, placed).distance);
        const auto impact = convex::cast({probe, pose}, motion, placed, {}).value();
        if (impact.result == convex::CastResult::hit) first = std::min(first, impact.time);
    }
    Vector<ObjectRef> found;
    world.overlap(probe, pose, found);
    std::sort(meeting.begin(), meeting.end());
    REQUIRE(found.size() == meeting.size());
    for (std::size_t i = 0; i < meeting.size(); ++i) REQUIRE(found[i].object.index == meeting[i]);
    const auto closest = world.closest(probe, pose, HUGE_VAL);
    REQUIRE(closest.has_value() == (nearest < HUGE_VAL));
    if (closest) REQUIRE(closest->distance == nearest);
    const auto hit = world.cast(probe, pose, motion, {});
    REQUIRE(hit.has_value());
    REQUIRE(hit->has_value() == (first < HUGE_VAL));
    if (*hit) REQUIRE(std::abs((*hit)->time - first) <= 1e-5);  // both within the tolerance
}

void require_rays(RandomShapes& random, const World& world, const std::vector<Thing>& things, double extent) {
    for (int k = 0; k < 4; ++k) {
        const glm::dvec3 origin = extent * (k == 0 ? 0.3 : k == 1 ? 1000.0 : 2.0) * random.direction();
        const glm::dvec3 aim = extent * random.number(0.0, 1.0) * random.direction();
        const Ray ray{origin, std::exp2(random.number(-200.0, 200.0)) * (aim - origin)};
        std::map<std::uint32_t, convex::RayHit> expected;
        for (const Thing& thing : things) {
            if (!thing.lives || !thing.shape) continue;
            if (const auto hit = convex::raycast({*thing.shape, thing.pose()}, ray))
                expected.emplace(thing.object.index, *hit);
        }
        Vector<ObjectHit> hits;
        world.raycast_all(ray, hits);
        REQUIRE(hits.size() == expected.size());
        for (std::size_t i = 0; i < hits.size(); ++i) {
            REQUIRE(expected.count(hits[i].object.index) == 1);
            const convex::RayHit& right = expected.at(hits[i].object.index);
            REQUIRE(hits[i].t == right.t);
            REQUIRE(hits[i].point == right.point);
            REQUIRE(hits[i].normal == right.normal);
            REQUIRE(hits[i].started_inside == right.started_inside);
            REQUIRE(hits[i].child == right.part.child);
            REQUIRE(hits[i].triangle == kNoTriangle);
            if (i > 0) REQUIRE(hits[i - 1].t <= hits[i].t);
        }
        const auto nearest = world.raycast(ray);
        REQUIRE(nearest.has_value() == !expected.empty());
        REQUIRE(world.raycast_any(ray) == !expected.empty());
        if (nearest) {
            REQUIRE(nearest->object == hits[0].object);
            REQUIRE(nearest->t == hits[0].t);
            REQUIRE(nearest->normal == hits[0].normal);
        }
    }
}

TriangleMesh cube_mesh() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    const std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces)
        for (const std::uint32_t i : {f[0], f[1], f[2], f[0], f[2], f[3]}) mesh.indices.push_back(i);
    return mesh;
}
MeshHandle add_cube(World& world) {
    const TriangleMesh mesh = cube_mesh();
    return world
        .add_mesh({.positions = std::span<const glm::vec3>(mesh.positions.data(), mesh.positions.size()),
                   .indices = std::span<const std::uint32_t>(mesh.indices.data(), mesh.indices.size())})
        .value();
}

glm::dmat3 scaling(const glm::dvec3& s) {
    return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}};
}

// A World with one object of a mesh, with a shape, and the same shape made by hand.
struct Scaled {
    explicit Scaled(const convex::Shape& shape, const Transform& transform) {
        object = world.add({.mesh = add_cube(world), .transform = transform}).value();
        set = world.set_shape(object, &shape);
        REQUIRE(world.update().has_value());
    }
    // Against a shape that has been scaled by hand, at a rigid pose.
    void require_same(RandomShapes& random, const convex::Shape& right, const RigidTransform& pose, double size) const {
        REQUIRE(set.has_value());
        for (int i = 0; i < 20; ++i) {
            const convex::Shape probe = convex::Shape::sphere(0.1 * size).value();
            const RigidTransform there = at(pose.translation + size * random.number(0.2, 3.0) * random.direction());
            const auto closest = world.closest(probe, there, HUGE_VAL);
            REQUIRE(closest.has_value());
            const double gap = convex::distance({probe, there}, {right, pose}).distance;
            REQUIRE(std::abs(closest->distance - gap) <= 1e-6 * size);
            const Ray ray{there.translation, pose.translation + 0.3 * size * random.direction() - there.translation};
            const auto hit = world.raycast(ray);
            const auto expected = convex::raycast({right, pose}, ray);
            // Near the rim the one may hit and the other miss: sizes are rounded to float.
            if (hit.has_value() != expected.has_value()) continue;
            if (!hit || hit->started_inside || expected->started_inside) continue;
            if (std::abs(glm::dot(expected->normal, glm::normalize(ray.direction))) < 0.05) continue;
            REQUIRE(glm::length(hit->point - expected->point) <= 1e-4 * size);
        }
    }

    World world;
    ObjectHandle object;
    Result<void> set;
};

}  // namespace

TEST_SUITE("world/shape_extents") {
    TEST_CASE(
        "a shape that is larger than its object's bound loses nothing: contacts, shapes, casts and rays find it") {
        for (const double margin : {0.0, 0.3}) {
            for (std::uint64_t seed = 0; seed < 12; ++seed) {
                RandomShapes random(5200 + seed);
                World world({.contact_margin = margin, .updates_to_rest = 3});
                std::vector<Thing> things;
                const auto add = [&] {
                    Thing thing{any_shape(random, 1.0), any_bound(random, 5.0 * random.direction(), 1.0), {}};
                    thing.layers = random.index(8) == 0 ? 2u : ~0u;
                    thing.alone = random.index(3) == 0;
                    add_to(world, thing);
                    things.push_back(thing);
                };
                for (int i = 0; i < 30; ++i) add();
                for (int frame = 0; frame < 14; ++frame) {
                    REQUIRE(world.update().has_value());
                    require_contacts(world, things, margin);
                    require_queries(random, world, things, 5.0);
                    require_rays(random, world, things, 5.0);
                    for (Thing& thing : things) {
                        if (!thing.lives) continue;
                        const int what = random.index(12);
                        if (what < 3) {
                            thing.bound.box.center += 0.5 * random.direction();
                            move(world, thing);
                        } else if (what == 3) {
                            thing.bound = any_bound(random, thing.bound.box.center, 1.0);
                            move(world, thing);
                        } else if (what == 4) {
                            thing.shape = any_shape(random, random.number(0.2, 2.0));
                            REQUIRE(world.set_shape(thing.object, &*thing.shape).has_value());
                        } else if (what == 5 && random.index(4) == 0) {
                            REQUIRE(world.remove(thing.object).has_value());
                            thing.lives = false;
                        }
                    }
                    if (frame % 3 == 0) add();
                }
            }
        }
    }

    TEST_CASE("many boxes set at once cover their shapes too, and moving ones stay the caller's") {
        RandomShapes random(5300);
        // Some boxes are as large as their shapes to the bit, or lack a bit.
        const auto any_half_extents = [&](const convex::Shape& shape) {
            const int what = random.index(4);
            if (what == 0) return glm::vec3(static_cast<float>(random.number(0.0, 2.0)));
            glm::vec3 half(glm::max(glm::abs(shape.bounds().min), glm::abs(shape.bounds().max)));
            for (int k = 0; k < 3; ++k) half[k] = std::nextafter(half[k], what == 1 && k == 1 ? 0.0f : HUGE_VALF);
            return half;
        };
        World world;
        std::vector<Thing> things;
        for (int i = 0; i < 60; ++i) {
            Thing thing{any_shape(random, 1.0), Obb{6.0 * random.direction(), glm::mat3(1.0f), glm::vec3(0.2f)}, {}};
            thing.object = world.add({.bound = thing.bound}).value();
            REQUIRE(world.set_shape(thing.object, &*thing.shape).has_value());
            things.push_back(thing);
        }
        for (int frame = 0; frame < 25; ++frame) {
            REQUIRE(world.update().has_value());
            require_contacts(world, things, 0.0);
            for (const Thing& thing : things) {
                const Obb box = world.box_of(thing.object).value();
                const glm::dmat3 to_box = glm::inverse(glm::dmat3(box.axes));
                for (int i = 0; i < 10 && thing.shape->is_convex(); ++i) {
                    const glm::dvec3 way = random.direction(), local = glm::transpose(thing.pose().rotation) * way;
                    const glm::dvec3 tip =
                        thing.pose().rotation * convex::support_point(*thing.shape, local) + thing.pose().translation;
                    const glm::dvec3 in_box = glm::abs(to_box * (tip - box.center));
                    for (int k = 0; k < 3; ++k) REQUIRE(in_box[k] <= static_cast<double>(box.half_extents[k]) + 1e-9);
                }
            }
            std::vector<ObjectHandle> handles;
            std::vector<Obb> boxes;
            for (Thing& thing : things) {
                thing.bound.box.center += 0.2 * random.direction();
                thing.bound.box.half_extents = any_half_extents(*thing.shape);
                if (random.index(2) == 0) thing.bound.box.axes = glm::mat3(random.rotation());
                handles.push_back(thing.object);
                boxes.push_back(thing.bound.box);
            }
            REQUIRE(world.set_bounds(handles, boxes).has_value());
        }
    }

    TEST_CASE(
        "the box is as it was given where the shape fits, covers both where not, and comes back with the shape's end") {
        World world;
        const convex::Shape sphere = convex::Shape::sphere(1.0).value();
        const Obb given{{3, 0, 0}, glm::mat3(1.0f), {0.5f, 2.0f, 0.5f}};
        const ObjectHandle object = world.add({.bound = given}).value();
        const ObjectHandle fits = world.add({.bound = Sphere{{9, 0, 0}, 1.0}}).value();
        REQUIRE(world.update().has_value());
        const Obb before = world.box_of(fits).value();
        REQUIRE(world.set_shape(object, &sphere).has_value());
        REQUIRE(world.set_shape(fits, &sphere).has_value());
        REQUIRE(world.update().has_value());
        const Obb grown = world.box_of(object).value();
        for (int k = 0; k < 3; ++k) {
            CHECK(std::abs(grown.center[k] - given.center[k]) < 1e-6);
            CHECK(grown.half_extents[k] == doctest::Approx(k == 1 ? 2.0 : 1.0).epsilon(1e-6));
            CHECK(grown.half_extents[k] >= (k == 1 ? 2.0f : 1.0f));
        }
        CHECK(world.box_of(fits)->half_extents == before.half_extents);
        // Views see what the shape has.
        ViewResult seen;
        const Camera camera{.position = {2.1, 0, -5}, .forward = {0, 0, 1}, .up = {0, 1, 0}, .fov_y = 0.02};
        REQUIRE(world.view({.camera = camera}, seen).has_value());
        CHECK(seen.size() == 1);
        REQUIRE(world.set_shape(object, nullptr).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(object)->half_extents == given.half_extents);
        CHECK(world.box_of(object)->center == given.center);
        REQUIRE(world.view({.camera = camera}, seen).has_value());
        CHECK(seen.size() == 0);
    }

    TEST_CASE("an object needs only its shape: its box is the smallest in the shape's frame, for every shape") {
        RandomShapes random(6100);
        std::vector<float> heights(20);
        for (float& h : heights) h = static_cast<float>(random.number(3.0, 4.0));
        const convex::HeightField field =
            convex::HeightField::build({.columns = 5, .rows = 4, .heights = heights, .spacing = {0.5, 0.7}}).value();
        for (int i = 0; i < 400; ++i) {
            World world;
            const NodeHandle node = world.add_node({}).value();
            // Off their origins, so that a box around that as well would be larger.
            const std::vector<convex::CompoundChild> children{
                {random.box(0.5), {random.rotation(), glm::dvec3(4, 0, 0) + random.direction()}},
                {*convex::Shape::capsule(0.5f, 0.2f), {random.rotation(), glm::dvec3(4, 0, 0) + random.direction()}}};
            const convex::Compound compound = convex::Compound::build(children).value();
            const Surface surface = ground(random, 3, 0.5, [](double x, double) { return 5.0 + x; });
            std::vector<glm::vec3> points = random.points(20);
            for (glm::vec3& p : points) p.x += 3.0f;
            const convex::Hull hull = convex::Hull::build(points).value();
            const convex::Shape shapes[] = {any_shape(random, 1.0), convex::Shape::hull(hull),
                                            convex::Shape::compound(compound), surface.shape(),
                                            convex::Shape::height_field(field)};
            const convex::Shape& shape = shapes[i % 5];
            const double scale = i % 2 == 0 ? 1.0 : random.number(0.2, 3.0);
            const double far = i % 7 == 0 ? 1e9 : 9.0;
            const RigidTransform pose{random.rotation(), far * random.direction()};
            const Transform transform{scale * pose.rotation, pose.translation};
            const bool has_node = i % 3 == 0;
            const ObjectHandle object = has_node ? world.add({.node = node, .shape = &shape}).value()
                                                 : world.add({.transform = Transform(), .shape = &shape}).value();
            REQUIRE(world.update().has_value());
            REQUIRE(
                (has_node ? world.set_transform(node, transform) : world.set_transform(object, transform)).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.transform_of(object)->translation == pose.translation);
            const Obb box = world.box_of(object).value();
            const glm::dvec3 middle = pose.rotation * (scale * shape.bounds().center()) + pose.translation;
            const glm::dvec3 half = scale * shape.bounds().half_extents();
            CAPTURE(i);
            for (int k = 0; k < 3; ++k) {
                CHECK(glm::length(glm::dvec3(box.axes[k]) - pose.rotation[k]) < 1e-6);
                CHECK(std::abs(box.center[k] - middle[k]) < 1e-5);
                CHECK(std::abs(static_cast<double>(box.half_extents[k]) - half[k]) < 1e-5);
            }
            // And nothing of the shape sticks out.
            const glm::dmat3 to_box = glm::inverse(glm::dmat3(box.axes));
            for (int n = 0; n < 30 && shape.is_convex(); ++n) {
                const glm::dvec3 tip = scale * convex::support_point(shape, random.direction());
                const glm::dvec3 in_box = glm::abs(to_box * (pose.rotation * tip + (pose.translation - box.center)));
                const double rounding = i % 2 == 0 ? 1e-14 * far : 1e-6;  // a scaled shape's sizes are floats
                for (int k = 0; k < 3; ++k) CHECK(in_box[k] <= static_cast<double>(box.half_extents[k]) + rounding);
            }
        }
    }

    TEST_CASE("an object of a shape alone takes other shapes and transforms, and says what it has not") {
        World world;
        const convex::Shape ball = convex::Shape::sphere(1.0).value(), box = convex::Shape::box({1, 1, 1}).value();
        const NodeHandle node = world.add_node({}).value();
        const MeshHandle mesh = add_cube(world);
        const Transform uneven{scaling({1, 2, 1}), {0, 0, 0}};
        CHECK(error_of(world.add({})).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.add({.transform = uneven, .shape = &ball})).code == ErrorCode::unsupported);
        CHECK(error_of(world.add({.mesh = mesh, .transform = uneven, .shape = &ball})).code == ErrorCode::unsupported);
        CHECK(error_of(world.add({.transform = Transform{glm::dmat3(NAN), {0, 0, 0}}, .shape = &ball})).code ==
              ErrorCode::non_finite);
        CHECK(error_of(world.add({.node = node, .bound = Sphere{{0, 0, 0}, 1.0}, .shape = &ball})).code ==
              ErrorCode::invalid_argument);
        ObjectDescription occluder{.shape = &ball};
        occluder.only_occludes = true;
        CHECK(error_of(world.add(occluder)).code == ErrorCode::invalid_argument);
        CHECK(world.object_count() == 0);
        const ObjectHandle own = world.add({.shape = &ball}).value(),
                           below = world.add({.node = node, .shape = &box}).value();
        CHECK(error_of(world.set_bound(own, Sphere{{0, 0, 0}, 1.0})).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_mesh(own, mesh)).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_occludes(own, false)).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_shape(own, nullptr)).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_transform(own, uneven)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_transform(below, {})).code == ErrorCode::invalid_argument);
        REQUIRE(world.set_transform(own, {glm::dmat3(1.0), {1.9, 0, 0}}).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].shape_points[0].contact.depth == doctest::Approx(0.1));
        REQUIRE(world.set_shape(own, &box).has_value());
        REQUIRE(world.set_transform(node, uneven).has_value());  // boxes take it
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(own)->half_extents.x == doctest::Approx(1.0));
        CHECK(world.box_of(below)->half_extents[1] == doctest::Approx(2.0));
        CHECK(error_of(world.set_shape(below, &ball)).code == ErrorCode::unsupported);
        // A view lists what it sees of it.
        ViewResult seen;
        const Camera camera{.position = {0, 1.9, -5}, .forward = {0, 0, 1}, .up = {0, 1, 0}, .fov_y = 0.02};
        REQUIRE(world.view({.camera = camera}, seen).has_value());
        CHECK(seen.size() == 1);
        REQUIRE(world.remove(node).has_value());
        REQUIRE(world.remove(own).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.object_count() == 0);
        CHECK(!world.raycast({{0, 0, -9}, {0, 0, 1}}).has_value());
    }

    TEST_CASE("a box whose axes are left-handed or a little off carries its shape") {
        const convex::Shape box = convex::Shape::box({1, 1, 1}).value();
        for (const float off : {0.0f, 3e-5f}) {
            World world;
            glm::mat3 axes(1.0f);
            axes[1].x = off;
            if (off == 0.0f) axes[2] = -axes[2];
            const ObjectHandle a = world.add({.bound = Obb{{0, 0, 0}, axes, glm::vec3(1.0f)}}).value();
            const ObjectHandle b = world.add({.bound = Obb{{1.9, 0, 0}, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
            REQUIRE(world.set_shape(a, &box).has_value());
            REQUIRE(world.set_shape(b, &box).has_value());
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            CHECK(world.contacts()[0].shape_points[0].contact.depth == doctest::Approx(0.1).epsilon(1e-3));
        }
    }

    TEST_CASE(
        "an object with a mesh whose shape is larger than it touches with the shape, under moving nodes as well") {
        RandomShapes random(5400);
        World world;
        const MeshHandle mesh = add_cube(world);
        const NodeHandle node = world.add_node({}).value();
        const convex::Shape large = convex::Shape::sphere(3.0).value(), small = convex::Shape::sphere(0.5).value();
        const ObjectHandle a = world.add({.mesh = mesh, .node = node}).value();
        const ObjectHandle b = world.add({.bound = Sphere{{0, 0, 0}, 0.5}}).value();
        REQUIRE(world.set_shape(a, &large).has_value());
        REQUIRE(world.set_shape(b, &small).has_value());
        for (int i = 0; i < 60; ++i) {
            const glm::dvec3 place = random.number(2.0, 5.0) * random.direction();
            REQUIRE(world.set_transform(node, {random.rotation(), place}).has_value());
            REQUIRE(world.update().has_value());
            const bool touches = glm::length(place) <= 3.5;
            std::size_t touching = 0;
            for (const Contact& c : world.contacts()) touching += c.phase != ContactPhase::ended;
            CHECK(touching == (touches ? 1u : 0u));
        }
    }

    TEST_CASE("a uniform scale scales a shape of any kind, mirrored or not") {
        RandomShapes random(5500);
        for (int i = 0; i < 240; ++i) {
            const double s = std::exp2(random.number(-3.0, 3.0));
            const float h = static_cast<float>(random.number(0.2, 1.0)),
                        r = static_cast<float>(random.number(0.2, 1.0));
            const double rounding = random.number(0.1, 0.5);
            const auto points = random.points(20);
            std::vector<glm::vec3> scaled_points;
            for (const glm::vec3& p : points) scaled_points.emplace_back(s * glm::dvec3(p));
            const convex::Hull hull = convex::Hull::build(points).value(),
                               scaled = convex::Hull::build(scaled_points).value();
            const auto f = [&](float x) { return static_cast<float>(s * static_cast<double>(x)); };
            const std::pair<convex::Shape, convex::Shape> kinds[] = {
                {*convex::Shape::sphere(rounding), *convex::Shape::sphere(s * rounding)},
                {*convex::Shape::capsule(h, r), *convex::Shape::capsule(f(h), f(r))},
                {*convex::Shape::cylinder(h, r), *convex::Shape::cylinder(f(h), f(r))},
                {*convex::Shape::cone(h, r), *convex::Shape::cone(f(h), f(r))},
                {*convex::Shape::box({h, r, h}), *convex::Shape::box({f(h), f(r), f(h)})},
                {convex::Shape::hull(hull), convex::Shape::hull(scaled)},
                {*convex::Shape::rounded(*convex::Shape::box({h, r, h}), rounding),
                 *convex::Shape::rounded(*convex::Shape::box({f(h), f(r), f(h)}), s * rounding)},
                {*convex::Shape::rounded(*convex::Shape::cylinder(h, r), rounding),
                 *convex::Shape::rounded(*convex::Shape::cylinder(f(h), f(r)), s * rounding)},
            };
            const auto& [shape, right] = kinds[i % 8];
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            glm::dmat3 linear = s * pose.rotation;
            const bool symmetric = i % 8 != 5;
            if (i % 3 == 0 && symmetric) linear[0] = -linear[0];  // these look alike in a mirror
            CAPTURE(i);
            Scaled(shape, {linear, pose.translation}).require_same(random, right, pose, s);
        }
    }

    TEST_CASE(
        "an uneven scale or a shear moves every vertex of what has vertices, and a mirror turns triangles round") {
        RandomShapes random(5600);
        for (int i = 0; i < 120; ++i) {
            const bool shears = i % 2 == 1;
            const glm::dvec3 s(random.number(0.3, 3.0), random.number(0.3, 3.0), random.number(0.3, 3.0));
            const glm::dmat3 linear = random.rotation() * scaling(s) * (shears ? random.rotation() : glm::dmat3(1.0));
            const glm::dvec3 place = 5.0 * random.direction();
            const auto image = [&](const glm::dvec3& p) { return glm::vec3(linear * p); };
            // The image by hand, at a pose that only moves.
            const convex::Shape box = random.box();
            const auto points = random.points(20);
            std::vector<glm::vec3> corners, moved;
            for (int k = 0; k < 8; ++k) corners.push_back(image(box.vertex(k)));
            for (const glm::vec3& p : points) moved.push_back(image(glm::dvec3(p)));
            const convex::Hull hull = convex::Hull::build(points).value();
            const convex::Hull right_hull = convex::Hull::build(moved).value(),
                               right_box = convex::Hull::build(corners).value();
            const glm::vec3 a(random.direction()), b(random.direction()), c(random.direction());
            const convex::Shape triangle = convex::Shape::triangle(a, b, c).value();
            const convex::Shape right_triangle =
                convex::Shape::triangle(image(glm::dvec3(a)), image(glm::dvec3(b)), image(glm::dvec3(c))).value();
            Surface surface = soup(random, 30, 1.0, 0.8), right_surface = surface;
            for (glm::vec3& p : right_surface.mesh.positions) p = image(glm::dvec3(p));
            right_surface.build();
            // Children of a compound that stand askew are sheared.
            const std::vector<convex::CompoundChild> children{
                {box, {random.rotation(), random.direction()}},
                {convex::Shape::hull(hull), {random.rotation(), random.direction()}}};
            std::vector<glm::vec3> child_points[2];
            for (int k = 0; k < 2; ++k)
                for (int v = 0; v < children[std::size_t(k)].shape.vertex_count(); ++v)
                    child_points[k].push_back(
                        image(children[std::size_t(k)].pose.rotation * children[std::size_t(k)].shape.vertex(v) +
                              children[std::size_t(k)].pose.translation));
            const convex::Hull child_hulls[2] = {convex::Hull::build(child_points[0]).value(),
                                                 convex::Hull::build(child_points[1]).value()};
            const std::vector<convex::CompoundChild> right_children{
                {convex::Shape::hull(child_hulls[0]), at({0, 0, 0})},
                {convex::Shape::hull(child_hulls[1]), at({0, 0, 0})}};
            const convex::Compound compound = convex::Compound::build(children).value(),
                                   right_compound = convex::Compound::build(right_children).value();
            const std::pair<convex::Shape, convex::Shape> kinds[] = {
                {box, convex::Shape::hull(right_box)},
                {convex::Shape::hull(hull), convex::Shape::hull(right_hull)},
                {triangle, right_triangle},
                {surface.shape(), right_surface.shape()},
                {convex::Shape::compound(compound), convex::Shape::compound(right_compound)},
            };
            const auto& [shape, right] = kinds[i % 5];
            CAPTURE(i);
            Scaled(shape, {linear, place}).require_same(random, right, at(place), 3.0);
        }
        // One-sided: from outside the mirrored cube is met, from inside it is passed.
        const TriangleMesh cube = cube_mesh();
        const mesh::MeshTree tree = mesh::MeshTree::build(cube).value();
        const convex::Shape shape = convex::Shape::mesh(tree, convex::Sides::front).value();
        for (const double mirror : {-2.0, 2.0}) {
            const Scaled scaled(shape, {scaling({mirror, 1.0, 3.0}), {0, 0, 0}});
            REQUIRE(scaled.set.has_value());
            const auto hit = scaled.world.raycast({{-9, 0.1, 0.2}, {1, 0, 0}});
            REQUIRE(hit.has_value());
            CHECK(hit->t == doctest::Approx(7.0));
            CHECK(hit->normal.x == doctest::Approx(-1.0));
            CHECK(hit->triangle != kNoTriangle);
            CHECK(!scaled.world.raycast({{0, 0.1, 0.2}, {1, 0, 0}}));
        }
    }

    TEST_CASE("cylinders, cones and height fields take a scale along their axes, half-spaces take any") {
        RandomShapes random(5700);
        for (int i = 0; i < 60; ++i) {
            const double along = random.number(0.3, 3.0), wide = random.number(0.3, 3.0);
            const RigidTransform pose{random.rotation(), 4.0 * random.direction()};
            const Transform transform{pose.rotation * scaling({wide, along, wide}), pose.translation};
            const auto h = static_cast<float>(along * 0.5), r = static_cast<float>(wide * 0.5);
            Scaled(*convex::Shape::cylinder(0.5f, 0.5f), transform)
                .require_same(random, *convex::Shape::cylinder(h, r), pose, 2.0);
            Scaled(*convex::Shape::cone(0.5f, 0.5f), transform)
                .require_same(random, *convex::Shape::cone(h, r), pose, 2.0);
            std::vector<float> heights(20), scaled(20);
            for (std::size_t k = 0; k < 20; ++k) {
                heights[k] = static_cast<float>(random.number(-1.0, 1.0));
                scaled[k] = static_cast<float>(along * static_cast<double>(heights[k]));
            }
            const convex::HeightField field =
                convex::HeightField::build({.columns = 5, .rows = 4, .heights = heights, .spacing = {0.5, 0.7}})
                    .value();
            const convex::HeightField right =
                convex::HeightField::build(
                    {.columns = 5, .rows = 4, .heights = scaled, .spacing = {0.5 * wide, 0.7 * wide}})
                    .value();
            Scaled(convex::Shape::height_field(field), transform)
                .require_same(random, convex::Shape::height_field(right), pose, 2.0);
            const glm::dmat3 any = random.rotation() * scaling({wide, along, 1.0}) * random.rotation();
            const Scaled ground(*convex::Shape::half_space({{0, 1, 0}, 0.0}), {any, pose.translation});
            REQUIRE(ground.set.has_value());
            // The plane goes through the images of the plane's points.
            const glm::dvec3 on_plane = any * glm::dvec3(7.0, 0.0, -3.0) + pose.translation,
                             above = any * glm::dvec3(7.0, -2.0, -3.0) + pose.translation;
            const auto hit = ground.world.raycast({above, on_plane - above});
            REQUIRE(hit.has_value());
            CHECK(hit->t == doctest::Approx(1.0));
        }
    }

    TEST_CASE(
        "a transform that would make another kind of shape is refused by whoever sets it, and nothing has changed") {
        const convex::Shape sphere = convex::Shape::sphere(1.0).value();
        const Transform uneven{scaling({1, 2, 1}), {0, 0, 0}}, even{scaling({2, 2, 2}), {0, 0, 0}};
        World world;
        const MeshHandle mesh = add_cube(world);
        const NodeHandle outer = world.add_node({}).value(), inner = world.add_node({.parent = outer}).value(),
                         other = world.add_node({.transform = uneven}).value();
        const ObjectHandle own = world.add({.mesh = mesh, .node = inner, .transform = Transform{}}).value();
        const ObjectHandle shares = world.add({.mesh = mesh, .node = inner}).value();
        const ObjectHandle scaled = world.add({.mesh = mesh, .transform = uneven}).value();
        // Before the first update as well.
        CHECK(error_of(world.set_shape(scaled, &sphere)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_shape(scaled, &sphere)).item == scaled.index);
        REQUIRE(world.set_shape(own, &sphere).has_value());
        REQUIRE(world.set_shape(shares, &sphere).has_value());
        for (int round = 0; round < 2; ++round) {
            CHECK(error_of(world.set_transform(own, uneven)).code == ErrorCode::unsupported);
            CHECK(error_of(world.set_transform(own, uneven)).item == own.index);
            CHECK(error_of(world.set_transform(inner, uneven)).code == ErrorCode::unsupported);
            CHECK(error_of(world.set_transform(outer, uneven)).code == ErrorCode::unsupported);
            CHECK(error_of(world.set_parent(inner, other)).code == ErrorCode::unsupported);
            const std::vector<NodeHandle> nodes{other, outer};
            const std::vector<Transform> transforms{even, uneven};
            CHECK(error_of(world.set_transforms(nodes, transforms)).item == 1);
            REQUIRE(world.set_transform(other, uneven).has_value());
            const std::vector<ObjectHandle> objects{scaled, own};
            CHECK(error_of(world.set_transforms(objects, transforms)).item == 1);
            REQUIRE(world.set_transform(scaled, uneven).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.transform_of(own)->linear == glm::dmat3(1.0));
            CHECK(world.transform_of(shares)->linear == glm::dmat3(1.0));
            // Uneven above and its inverse below are rigid together.
            REQUIRE(world.set_transform(outer, even).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.transform_of(own)->linear == 2.0 * glm::dmat3(1.0));
            REQUIRE(world.set_transform(outer, {}).has_value());
        }
        REQUIRE(world.set_shape(scaled, nullptr).has_value());
        // What hides has no shape meanwhile, and what comes back has one.
        REQUIRE(world.set_transform(outer, {scaling({0, 0, 0}), {0, 0, 0}}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.closest(sphere, at({0, 0, 0}), 1.0).has_value() == false);  // the unscaled object is there
        Vector<ObjectHit> hits;
        world.raycast_all({{-9, 0, 0}, {1, 0, 0}}, hits);
        for (const ObjectHit& hit : hits) CHECK(hit.object == scaled);
        REQUIRE(world.set_transform(outer, even).has_value());
        REQUIRE(world.update().has_value());
        world.raycast_all({{-9, 0, 0}, {1, 0, 0}}, hits);
        CHECK(hits.size() == 3);
        CHECK(hits[0].t == doctest::Approx(7.0));
    }

    TEST_CASE("scaled shapes touch as deep as their sizes say, while nodes above them scale and turn") {
        RandomShapes random(5800);
        World world;
        const MeshHandle mesh = add_cube(world);
        const NodeHandle node = world.add_node({}).value();
        const convex::Shape sphere = convex::Shape::sphere(1.0).value();
        const ObjectHandle a =
            world.add({.mesh = mesh, .node = node, .transform = Transform{glm::dmat3(1.0), {1, 0, 0}}}).value();
        const ObjectHandle b = world.add({.bound = Sphere{{0, 0, 0}, 1.0}}).value();
        REQUIRE(world.set_shape(a, &sphere).has_value());
        REQUIRE(world.set_shape(b, &sphere).has_value());
        for (int i = 0; i < 200; ++i) {
            const double s = random.number(0.2, 4.0);
            const Transform transform{s * random.rotation(), random.number(0.0, 6.0) * random.direction()};
            REQUIRE(world.set_transform(node, transform).has_value());
            REQUIRE(world.update().has_value());
            const glm::dvec3 center = transform.linear * glm::dvec3(1, 0, 0) + transform.translation;
            const double depth = s + 1.0 - glm::length(center);
            if (std::abs(depth) < 1e-9) continue;
            double found = -1.0;
            for (const Contact& c : world.contacts())
                if (c.phase != ContactPhase::ended) found = c.shape_points[0].contact.depth;
            CHECK((found >= 0.0) == (depth > 0.0));
            if (depth > 0.0) CHECK(found == doctest::Approx(depth).epsilon(1e-9));
        }
    }

    TEST_CASE("a half-space, or a compound that contains one, is infinite ground for every query") {
        for (int round = 0; round < 24; ++round) {
            RandomShapes random(5900 + static_cast<std::uint64_t>(round));
            const double margin = round % 2 == 0 ? 0.0 : 0.2;
            World world({.contact_margin = margin, .updates_to_rest = 3});
            const glm::dvec3 normal = round % 3 == 0 ? glm::dvec3(0, -1, 0) : random.direction();
            const convex::Shape level = convex::Shape::half_space({normal, -1.0}).value();
            std::vector<convex::CompoundChild> children{
                {level, at({0, 0, 0})}, {random.box(2.0), {random.rotation(), 4.0 * random.direction()}}};
            const convex::Compound compound = convex::Compound::build(children).value();
            std::vector<Thing> things;
            // The bound only says where the ground's frame is.
            Thing ground{
                round % 4 < 2 ? level : convex::Shape::compound(compound),
                Obb{50.0 * random.direction() * (round % 3 == 0 ? 0.0 : 1.0), glm::mat3(1.0f), glm::vec3(0.0f)},
                {}};
            if (round % 3 != 0) ground.bound.box.center -= glm::dot(ground.bound.box.center, normal) * normal;
            ground.alone = round % 8 < 4;
            add_to(world, ground);
            things.push_back(ground);
            for (int i = 0; i < 40; ++i) {
                Thing thing{any_shape(random, 1.0), any_bound(random, 40.0 * random.direction(), 1.0), {}};
                thing.bound.box.center -=
                    (glm::dot(thing.bound.box.center, normal) - random.number(-2.0, 3.0)) * normal;
                thing.alone = i % 3 == 0;
                add_to(world, thing);
                if (i % 5 == 0) thing.layers = 0u;  // of what it collides with
                if (i % 5 == 0) REQUIRE(world.set_collides_with(thing.object, 0u).has_value());
                things.push_back(thing);
            }
            for (int frame = 0; frame < 8; ++frame) {
                REQUIRE(world.update().has_value());
                CAPTURE(round);
                require_contacts(world, things, margin);
                require_queries(random, world, things, 8.0);
                require_rays(random, world, things, 8.0);
                // Spheres, boxes and capsules by the plane, where there is nothing else.
                for (int k = 0; k < 5; ++k) {
                    const Sphere sphere{1e4 * random.direction(), random.number(0.0, 3.0)};
                    const double height =
                        -(glm::dot(normal, sphere.center - things[0].bound.box.center) - 1.0 + sphere.radius);
                    Vector<ObjectRef> found;
                    world.overlap(sphere, found);
                    CHECK(found.size() == (things[0].lives && height <= 0.0 ? 1u : 0u));
                    const auto closest = world.closest(sphere, 1e9);
                    if (things[0].lives && round % 4 < 2 && height < 5e3) {
                        REQUIRE(closest.has_value());
                        CHECK(closest->object == things[0].object);
                        CHECK(closest->distance == doctest::Approx(std::max(height, 0.0)).epsilon(1e-9));
                    }
                }
                for (std::size_t i = 0; i < things.size(); ++i) {
                    if (!things[i].lives || random.index(4) != 0) continue;
                    things[i].bound.box.center += 0.7 * random.direction();
                    move(world, things[i]);
                }
                if (frame == 4) REQUIRE(world.set_hidden(things[0].object, true).has_value());
                if (frame == 4) things[0].lives = false;
                if (frame == 5) REQUIRE(world.set_hidden(things[0].object, false).has_value());
                if (frame == 5) things[0].lives = true;
                if (frame == 6) REQUIRE(world.remove(things[0].object).has_value());
                if (frame == 6) things[0].lives = false;
            }
        }
    }

    TEST_CASE("an object without a shape lies on the ground with its box, sphere or triangles, and leaves it") {
        World world;
        const convex::Shape level = convex::Shape::half_space({{0, -1, 0}, 0.0}).value();
        const ObjectHandle ground = world.add({.bound = Obb{{0, 0, 0}, glm::mat3(1.0f), glm::vec3(0.0f)}}).value();
        REQUIRE(world.set_shape(ground, &level).has_value());
        const ObjectHandle sphere = world.add({.bound = Sphere{{1e6, 0.9, 0}, 1.0}}).value();
        const ObjectHandle box = world.add({.bound = Obb{{-1e6, 0.75, 3}, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
        const Transform stretched{scaling({1, 2, 1}), {40, 1.5, 0}};
        const ObjectHandle mesh = world.add({.mesh = add_cube(world), .transform = stretched}).value();
        const ObjectHandle high = world.add({.bound = Sphere{{5, 9, 0}, 1.0}}).value();
        for (int frame = 0; frame < 4; ++frame) {
            if (frame == 2) REQUIRE(world.set_bound(sphere, Sphere{{1e6, 1.1, 0}, 1.0}).has_value());
            REQUIRE(world.update().has_value());
            std::map<std::uint32_t, double> depths;
            for (const Contact& contact : world.contacts()) {
                CHECK(contact.first.object == ground);
                const ContactPhase phase = frame == 0 ? ContactPhase::began : ContactPhase::stayed;
                const bool ended = frame == 2 && contact.second.object == sphere;
                CHECK(contact.phase == (ended ? ContactPhase::ended : phase));
                if (ended) continue;
                depths[contact.second.object.index] = contact.depth;
                CHECK(glm::length(contact.normal - glm::dvec3(0, 1, 0)) < 1e-12);
                CHECK(contact.points.size() == (contact.second.object == sphere ? 1u : 4u));
            }
            CHECK(depths.size() == (frame < 2 ? 3u : 2u));
            if (frame < 2) CHECK(depths.at(sphere.index) == doctest::Approx(0.1));
            CHECK(depths.at(box.index) == doctest::Approx(0.25));
            CHECK(depths.at(mesh.index) == doctest::Approx(0.5));
            CHECK(depths.count(high.index) == 0);
            for (const Contact& contact : world.contacts()) CHECK(contact.shape_points.empty());
        }
    }

    TEST_CASE("hits of boxes, spheres and meshes have the normal that faces the ray, and say where it began inside") {
        RandomShapes random(6000);
        for (int i = 0; i < 400; ++i) {
            World world;
            const glm::dvec3 place = 3.0 * random.direction();
            const Obb box{place, glm::mat3(random.rotation()), {0.5f, 1.0f, 0.25f}};
            const glm::dmat3 linear = random.rotation() * scaling({random.number(-2, 2), 1.5, 0.5}) * random.rotation();
            const int kind = i % 3;
            if (kind == 0) REQUIRE(world.add({.bound = box}).has_value());
            if (kind == 1) REQUIRE(world.add({.bound = Sphere{place, 0.8}}).has_value());
            if (kind == 2)
                REQUIRE(world.add({.mesh = add_cube(world), .transform = Transform{linear, place}}).has_value());
            REQUIRE(world.update().has_value());
            const glm::dvec3 origin = i % 5 == 0 ? place + 0.05 * random.direction() : place + 6.0 * random.direction();
            const Ray ray{origin, place + 0.3 * random.direction() - origin};
            const auto hit = world.raycast(ray);
            if (!hit) continue;
            CHECK(hit->child == 0);
            CHECK(hit->started_inside == (i % 5 == 0 && kind != 2));
            if (hit->started_inside) {
                CHECK(hit->t == 0.0);
                CHECK(hit->normal == glm::dvec3(0.0));
                continue;
            }
            CHECK(glm::length(hit->normal) == doctest::Approx(1.0).epsilon(1e-12));
            CHECK(glm::dot(hit->normal, ray.direction) <= 0.0);
            if (kind == 1) {
                CHECK(glm::length(hit->normal - (hit->point - place) / 0.8) < 1e-9);
                continue;
            }
            // In the unit cube's frame the point is on a face; planes' normals go by the inverse's transpose.
            const glm::dmat3 to_world =
                kind == 2 ? linear : glm::dmat3(box.axes) * scaling(glm::dvec3(box.half_extents));
            const glm::dvec3 local = glm::inverse(to_world) * (hit->point - place);
            int axis = 0;
            for (int k = 1; k < 3; ++k)
                if (std::abs(local[k]) > std::abs(local[axis])) axis = k;
            CHECK(std::abs(local[axis]) == doctest::Approx(1.0).epsilon(1e-6));
            glm::dvec3 face(0.0);
            face[axis] = 1.0;
            glm::dvec3 expected = glm::normalize(glm::transpose(glm::inverse(to_world)) * face);
            if (glm::dot(expected, ray.direction) > 0.0) expected = -expected;
            CHECK(glm::length(hit->normal - expected) < 1e-6);
        }
    }
}
