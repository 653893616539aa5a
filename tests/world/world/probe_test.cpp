// SPDX-License-Identifier: MIT
// What a shape that is no object meets: all hits of a cast, contacts, and the parts that answers name.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/world/object_manifold.hpp>
#include <deque>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "cubes.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

constexpr std::uint32_t kStatic = 1, kProbe = 2;

// What a World may hold: tiles of a floor, shapes, meshes, compounds, bounds, ground.
class Scene {
  public:
    explicit Scene(std::uint64_t seed) : random(seed), random_seed(seed), surface(soup(random, 40, 1.0, 0.5)) {
        std::vector<convex::CompoundChild> children;
        for (int i = 0; i < 3; ++i)
            children.push_back({any_shape(random, 0.5), {random.rotation(), random.direction()}});
        children.push_back({surface.shape(), {random.rotation(), {}}});
        compound = convex::Compound::build(children).value();
    }

    enum class Kinds { shapes, bounds, all };

    // Adds them to a World that may hold the probe already.
    void fill(World& world, Kinds kinds = Kinds::all) {
        RandomShapes& same = fills_.emplace_back(random_seed);
        user_ = 100;
        const auto tile = convex::Shape::box({0.5f, 0.25f, 0.5f}).value();
        const auto solid = [&](const convex::Shape& shape, const RigidTransform& pose) {
            add(world, {.transform = Transform{pose.rotation, pose.translation}, .shape = &shape});
        };
        if (kinds == Kinds::bounds) return fill_with_bounds(world, same);
        for (int x = -2; x < 2; ++x)
            for (int z = -2; z < 2; ++z) solid(tile, {glm::dmat3(1.0), {x + 0.5, -0.25, z + 0.5}});
        for (int i = 0; i < 8; ++i) solid(any_shape(same, 0.6), {same.rotation(), 2.5 * same.direction()});
        solid(convex::Shape::compound(compound), {same.rotation(), 2.0 * same.direction()});
        solid(surface.shape(), {same.rotation(), 2.0 * same.direction()});
        if (same.index(2) == 0) {
            const auto ground = convex::Shape::half_space({{0.0, 1.0, 0.0}, 1.5}).value();
            add(world, {.bound = Obb{{}}, .shape = &ground});
        }
        if (kinds == Kinds::all) return fill_with_bounds(world, same);
        world.update().value();
    }

    RandomShapes random;
    std::uint64_t random_seed;
    Surface surface;
    convex::Compound compound;

  private:
    void fill_with_bounds(World& world, RandomShapes& same) {
        for (int i = 0; i < 4; ++i) {
            add(world, {.bound = Obb{2.0 * same.direction(), glm::mat3(same.rotation()), glm::vec3(0.4f)}});
            add(world, {.bound = Sphere{2.0 * same.direction(), 0.5}});
        }
        const MeshHandle mesh = world.add_mesh(described(surface.mesh)).value();
        add(world, {.mesh = mesh, .transform = Transform{same.rotation(), 2.0 * same.direction()}});
        world.update().value();
    }
    void add(World& world, ObjectDescription description) {
        description.layers = kStatic;
        description.collides_with = kProbe;
        description.user = user_++;
        (void)world.add(description).value();
    }
    std::uint64_t user_ = 0;
    std::deque<RandomShapes> fills_;  // which hold the hulls
};

struct Probe {
    Probe(RandomShapes& random, std::uint64_t seed)
        : shape(any_shape(random, 0.7)), margin(seed % 4 == 0 ? 0.05 : 0.0) {
        glm::dvec3 place = 1.5 * random.direction();
        if (seed % 3 == 0) place.y = random.number(0.0, 0.6);  // on the floor
        pose = {seed % 2 ? random.rotation() : glm::dmat3(1.0), place};
    }
    ObjectHandle add_to(World& world) const {
        return world
            .add({.transform = Transform{pose.rotation, pose.translation},
                  .shape = &shape,
                  .layers = kProbe,
                  .collides_with = kStatic})
            .value();
    }
    convex::Shape shape;
    double margin;
    RigidTransform pose;
};

struct Point {
    std::uint64_t user;
    glm::dvec3 position, normal;
    double depth;
};

bool is_before(const Point& a, const Point& b) {
    if (a.user != b.user) return a.user < b.user;
    for (int k = 0; k < 3; ++k)
        if (a.position[k] != b.position[k]) return a.position[k] < b.position[k];
    return a.depth < b.depth;
}

}  // namespace

TEST_SUITE("world/probes") {
    TEST_CASE("the contacts of a probe with shapes are those that it has as an object") {
        int touching = 0, several = 0;
        for (std::uint64_t seed = 1; seed <= 400; ++seed) {
            CAPTURE(seed);
            Scene scene(seed);
            const Probe probe(scene.random, seed);
            World with({.contact_margin = probe.margin}), without;
            const ObjectHandle own = probe.add_to(with);
            scene.fill(with, Scene::Kinds::shapes);
            scene.fill(without, Scene::Kinds::shapes);
            Vector<ObjectManifold> found;
            without.contact_manifolds(probe.shape, probe.pose, {.margin = probe.margin}, found).value();
            std::vector<Point> points, expected;
            for (const ObjectManifold& touch : found) {
                CHECK(without.user_of(touch.object).value() == touch.user);
                CHECK(touch.manifold.count > 0);
                for (int k = 0; k < touch.manifold.count; ++k)
                    points.push_back({touch.user, touch.manifold.points[k].position, touch.manifold.normal,
                                      touch.manifold.points[k].depth});
            }
            for (const Contact& contact : with.contacts()) {
                REQUIRE(contact.first.object == own);
                for (const convex::TrackedPoint& p : contact.shape_points)
                    expected.push_back({contact.second.user, p.contact.position, p.normal, p.contact.depth});
            }
            std::sort(points.begin(), points.end(), is_before);
            std::sort(expected.begin(), expected.end(), is_before);
            REQUIRE(points.size() == expected.size());
            for (std::size_t i = 0; i < points.size(); ++i) {
                CHECK(points[i].user == expected[i].user);
                CHECK(points[i].position == expected[i].position);
                CHECK(points[i].normal == expected[i].normal);
                CHECK(points[i].depth == expected[i].depth);
            }
            touching += points.empty() ? 0 : 1;
            several += found.size() > 1 ? 1 : 0;
        }
        CHECK(touching > 200);
        CHECK(several > 100);
    }

    TEST_CASE("the contacts of a probe with a box, sphere or mesh alone are those that it has as an object") {
        int touching = 0;
        for (std::uint64_t seed = 1; seed <= 400; ++seed) {
            CAPTURE(seed);
            Scene scene(seed);
            const Probe probe(scene.random, seed);
            World with, without;
            const ObjectHandle own = probe.add_to(with);
            scene.fill(with, Scene::Kinds::bounds);
            scene.fill(without, Scene::Kinds::bounds);
            Vector<ObjectRef> all;
            without.overlap(Sphere{{}, 100.0}, all);
            for (const ObjectRef& object : all) {
                std::vector<ObjectHandle> others;
                for (const ObjectRef& other : all)
                    if (!(other.object == object.object)) others.push_back(other.object);
                Vector<ObjectManifold> found;
                without.contact_manifolds(probe.shape, probe.pose, {}, found, {.ignored = others}).value();
                const auto contact = std::find_if(with.contacts().begin(), with.contacts().end(),
                                                  [&](const Contact& c) { return c.second.user == object.user; });
                const bool touches = contact != with.contacts().end() && contact->inside == mesh::Containment::none;
                REQUIRE(touches == !found.empty());
                if (!touches) continue;
                ++touching;
                REQUIRE(contact->first.object == own);
                CHECK(found[0].manifold.depth == contact->depth);
                CHECK(found[0].manifold.normal == contact->normal);
                REQUIRE(static_cast<std::size_t>(found[0].manifold.count) == contact->points.size());
                for (std::size_t k = 0; k < contact->points.size(); ++k)
                    CHECK(found[0].manifold.points[k].position == contact->points[k].position);
            }
        }
        CHECK(touching > 150);
    }

    TEST_CASE("a cast lists the hit that each object alone has, in order of time") {
        int hits_in_all = 0;
        for (std::uint64_t seed = 1; seed <= 200; ++seed) {
            CAPTURE(seed);
            Scene scene(seed);
            World world;
            scene.fill(world);
            std::vector<ObjectHandle> objects;
            Vector<ObjectRef> everything;
            world.overlap(Sphere{{}, 100.0}, everything);
            for (const ObjectRef& ref : everything) objects.push_back(ref.object);
            const convex::Shape probe = any_shape(scene.random, 0.5);
            const glm::dvec3 start = 9.0 * scene.random.direction();
            const RigidTransform pose{scene.random.rotation(), {start.x, 1.0 + std::abs(start.y), start.z}};
            const convex::Motion motion{-2.0 * start, seed % 2 ? 2.0 * scene.random.direction() : glm::dvec3(0.0), {}};
            Vector<ShapeHit> hits;
            const double early_out = seed % 5 == 0 ? 0.4 : HUGE_VAL;
            world.cast_all(probe, pose, motion, {.early_out = early_out}, hits).value();
            std::size_t at = 0;
            for (std::size_t i = 1; i < hits.size(); ++i) {
                const bool ordered =
                    hits[i - 1].time < hits[i].time ||
                    (hits[i - 1].time == hits[i].time && hits[i - 1].object.index < hits[i].object.index);
                CHECK(ordered);
            }
            for (std::size_t i = 0; i < objects.size(); ++i) {
                std::vector<ObjectHandle> others = objects;
                others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
                const auto alone =
                    world.cast(probe, pose, motion, {.early_out = early_out}, {.ignored = others}).value();
                const auto found = std::find_if(hits.begin(), hits.end(),
                                                [&](const ShapeHit& hit) { return hit.object == objects[i]; });
                REQUIRE((found != hits.end()) == alone.has_value());
                if (!alone) continue;
                ++at;
                CHECK(found->time == alone->time);
                CHECK(found->user == alone->user);
                CHECK(found->point == alone->point);
                CHECK(found->normal == alone->normal);
                CHECK(found->triangle == alone->triangle);
                CHECK(found->child == alone->child);
                CHECK(found->distance == alone->distance);
            }
            CHECK(hits.size() == at);
            const auto first = world.cast(probe, pose, motion, {.early_out = early_out}).value();
            REQUIRE(first.has_value() == !hits.empty());
            if (first) CHECK(std::abs(first->time - hits[0].time) < 1e-6);  // either within the tolerance
            hits_in_all += static_cast<int>(hits.size());
        }
        CHECK(hits_in_all > 400);
    }

    TEST_CASE("a shape that slides on flush objects meets none of their sides, and what overlaps is met at once") {
        World world;
        const auto tile = convex::Shape::box({0.5f, 0.25f, 0.5f}).value();
        for (int x = 0; x < 8; ++x)
            (void)world.add({.transform = Transform{glm::dmat3(1.0), {1.0 * x, -0.25, 0.0}}, .shape = &tile}).value();
        const ObjectHandle wall =
            world.add({.transform = Transform{glm::dmat3(1.0), {6.0, 0.25, 0.0}}, .shape = &tile}).value();
        world.update().value();
        const auto crate = convex::Shape::box({0.25f, 0.25f, 0.25f}).value();
        Vector<ShapeHit> hits;
        world.cast_all(crate, {glm::dmat3(1.0), {0.0, 0.25, 0.0}}, {{7.0, 0.0, 0.0}}, {}, hits).value();
        REQUIRE(hits.size() == 1);
        CHECK(hits[0].object == wall);
        CHECK(hits[0].time == doctest::Approx(5.25 / 7.0).epsilon(1e-6));
        world.cast_all(crate, {glm::dmat3(1.0), {5.9, 0.2, 0.0}}, {{0.1, 0.0, 0.0}}, {}, hits).value();
        CHECK(hits.size() == 2);
        for (const ShapeHit& hit : hits) CHECK(hit.time == 0.0);
        world
            .cast_all(crate, {glm::dmat3(1.0), {5.9, 0.2, 0.0}}, {{0.1, 0.0, 0.0}}, {.ignore_initial_overlaps = true},
                      hits)
            .value();
        CHECK(hits.empty());
    }

    TEST_CASE("the triangle and the child that an answer names are where its point is") {
        int triangles = 0, children = 0;
        for (std::uint64_t seed = 1; seed <= 300; ++seed) {
            CAPTURE(seed);
            Scene scene(seed);
            World world;
            const glm::dmat3 turn = scene.random.rotation();
            const Transform at{turn, {}};
            const int kind = static_cast<int>(seed % 3);  // a mesh, the shape of it, a compound
            const convex::Shape mesh_shape = scene.surface.shape(), compound = convex::Shape::compound(scene.compound);
            ObjectDescription description{.transform = at};
            if (kind == 0) description.mesh = world.add_mesh(described(scene.surface.mesh)).value();
            if (kind == 1) description.shape = &mesh_shape;
            if (kind == 2) description.shape = &compound;
            (void)world.add(description).value();
            world.update().value();
            const convex::Shape probe = any_shape(scene.random, 0.3);
            const glm::dvec3 from = 4.0 * scene.random.direction();
            const RigidTransform pose{scene.random.rotation(), from};
            const auto check = [&](std::uint32_t triangle, std::uint32_t child, const glm::dvec3& point) {
                convex::Shape part = mesh_shape;
                RigidTransform stand{turn, {}};
                if (kind == 2) {
                    const convex::CompoundChild& of = scene.compound.children()[child];
                    part = of.shape;
                    stand = {turn * of.pose.rotation, turn * of.pose.translation};
                    children += child > 0 ? 1 : 0;
                }
                REQUIRE((triangle == kNoTriangle) == part.is_convex());
                if (triangle != kNoTriangle) part = scene.surface.triangle(triangle), ++triangles;
                CHECK(convex::closest_point({part, stand}, point).distance < 2e-6);
            };
            const auto nearest = world.closest(probe, pose, kInfinity);
            REQUIRE(nearest.has_value());
            check(nearest->triangle, nearest->child, nearest->on_object);
            if (const auto hit = world.cast(probe, pose, {-1.2 * from}, {}).value())
                check(hit->triangle, hit->child, hit->point);
            const auto small = world.closest(Sphere{from, 0.2}, kInfinity);
            REQUIRE(small.has_value());
            check(small->triangle, small->child, small->on_object);
        }
        CHECK(triangles > 300);
        CHECK(children > 50);
    }

    TEST_CASE("what cannot be asked is refused by name, and leaves an empty list") {
        World world;
        const auto box = convex::Shape::box({1.0f, 1.0f, 1.0f}).value();
        (void)world.add({.transform = Transform{}, .shape = &box}).value();
        world.update().value();
        const RigidTransform pose{glm::dmat3(1.0), {}};
        Vector<ObjectManifold> found;
        world.contact_manifolds(box, pose, {}, found).value();
        CHECK(found.size() == 1);
        const auto refused = [&](const convex::Shape& probe, const RigidTransform& stand,
                                 const convex::ManifoldOptions& options, ErrorCode code) {
            found.resize(3);
            const auto done = world.contact_manifolds(probe, stand, options, found);
            REQUIRE(!done);
            CHECK(done.error().code == code);
            CHECK(found.empty());
        };
        const auto ground = convex::Shape::half_space({{0.0, 1.0, 0.0}, 0.0}).value();
        refused(ground, pose, {}, ErrorCode::unsupported);
        refused(box, {glm::dmat3(1.0), {kNan, 0.0, 0.0}}, {}, ErrorCode::non_finite);
        for (const double margin : {-1.0, kNan, kInfinity, 1e31})
            refused(box, pose, {.margin = margin}, ErrorCode::out_of_range);
        for (const int points : {0, 9, -5}) refused(box, pose, {.max_points = points}, ErrorCode::out_of_range);
        Vector<ShapeHit> hits(2);
        CHECK(!world.cast_all(ground, pose, {}, {}, hits));
        CHECK(hits.empty());
        hits.resize(2);
        CHECK(world.cast_all(box, pose, convex::Motion{{kNan, 0.0, 0.0}}, {}, hits).error().code ==
              ErrorCode::non_finite);
        CHECK(hits.empty());
        hits.resize(2);
        CHECK(!world.cast_all(box, pose, {}, {.duration = -1.0}, hits));
        CHECK(hits.empty());
    }
}
