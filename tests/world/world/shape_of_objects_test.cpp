// SPDX-License-Identifier: MIT
// Overlap, nearest object and casts among objects with meshes and shapes, against a look at every triangle.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <oracle/impacts.hpp>
#include <oracle/random_boxes.hpp>
#include <oracle/triangle_distance.hpp>
#include <shape/mesh/meshes.hpp>
#include <vector>

#include "cubes.hpp"
#include "new_counter.hpp"

using namespace crofton;
using namespace crofton::testing;
using oracle::NearMisses;

namespace {

// Triangles in the world, and all points within `radius` of them; if `solid`, the points that they enclose as well.
struct Soup {
    std::vector<Triangle> triangles;
    double radius = 0.0;
    bool solid = false;
};

// By the parity of crossings with a line that meets no edge of these soups.
bool encloses(const Soup& soup, const glm::dvec3& point) {
    const glm::dvec3 far = point + 1e3 * glm::normalize(glm::dvec3(0.6180339, 0.4142135, 0.7320508));
    int crossings = 0;
    for (const Triangle& triangle : soup.triangles) crossings += oracle::pierces(point, far, triangle);
    return crossings % 2 == 1;
}

// Between a probe and an object: their surfaces, or 0 where one encloses the other. `contained`: also where the object
// is a closed mesh, which encloses.
double distance_of(const Soup& probe, const Soup& object, bool contained) {
    double least = kInfinity;
    for (const Triangle& a : probe.triangles)
        for (const Triangle& b : object.triangles) {
            const double reach = std::max(glm::distance(a[0], a[1]), glm::distance(a[0], a[2])) +
                                 std::max(glm::distance(b[0], b[1]), glm::distance(b[0], b[2]));
            if (glm::distance(a[0], b[0]) - reach < least) least = std::min(least, oracle::distance_of_triangles(a, b));
        }
    if (probe.solid && encloses(probe, object.triangles[0][0])) return 0.0;
    if (contained && object.solid && encloses(object, probe.triangles[0][0])) return 0.0;
    return std::max(0.0, least - probe.radius - object.radius);
}

Soup soup_of(const TriangleMesh& mesh, const Transform& place, bool closed) {
    Soup soup;
    soup.solid = closed;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = place * glm::dvec3(mesh.positions[mesh.indices[i + k]]);
        soup.triangles.push_back(t);
    }
    return soup;
}
Soup soup_of(const Obb& box) {
    Transform place{glm::dmat3(box.axes), box.center};
    for (int k = 0; k < 3; ++k) place.linear[k] *= static_cast<double>(box.half_extents[k]);
    return soup_of(box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f)), place, true);
}

glm::dmat3 random_rotation(NearMisses& random) {
    const glm::dvec3 axis = random.direction();
    const double angle = random.number(0.0, 6.2);
    return glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis));
}

TriangleMesh random_soup(NearMisses& random, std::uint32_t triangles) {
    TriangleMesh mesh;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const glm::dvec3 middle = random.vector(-1.5, 1.5);
        for (std::uint32_t k = 0; k < 3; ++k) {
            mesh.positions.push_back(glm::vec3(middle + random.vector(-0.5, 0.5)));
            mesh.indices.push_back(3 * t + k);
        }
    }
    return mesh;
}

// A World of objects with meshes, under all kinds of transform, with shapes and with bounds; and what the oracle sees.
struct Scene {
    World world;
    std::vector<ObjectHandle> handles;
    std::vector<Soup> soups;
    std::vector<bool> is_mesh;
    std::vector<TriangleMesh> meshes;
    std::vector<bool> closed;

    Scene(NearMisses& random, int count, double spread, const WorldOptions& options = {}) : world(options) {
        meshes = {box_mesh(glm::vec3(-1.0f, -0.6f, -0.8f), glm::vec3(1.0f, 0.6f, 0.8f)),
                  wavy_torus(1.0, 0.4, 0.1, 8, 6), random_soup(random, 30)};
        closed = {true, true, false};
        std::vector<MeshHandle> added;
        for (const TriangleMesh& mesh : meshes) added.push_back(world.add_mesh(described(mesh)).value());
        for (int i = 0; i < count; ++i) {
            const std::size_t which = random.index(3);
            Transform place{random_rotation(random), spread * random.vector(-1, 1)};
            const unsigned kind = random.index(8);
            if (kind == 1) place.linear *= random.number(0.2, 3.0);
            if (kind == 2)
                for (int k = 0; k < 3; ++k) place.linear[k] *= random.number(0.2, 3.0);
            if (kind == 3) place.linear[0] += 0.7 * place.linear[1];  // a shear
            if (kind == 4) place.linear[2] = -1.5 * place.linear[2];
            if (kind == 5) place.linear[1] *= random.index(2) ? 0.0 : 1e-9;
            is_mesh.push_back(kind < 6);
            if (kind < 6) {
                handles.push_back(world.add({.mesh = added[which], .transform = place}).value());
                soups.push_back(soup_of(meshes[which], place, closed[which] && kind != 5));
                continue;
            }
            const Obb box = oracle::random_box(random, place.translation, 0.0);
            if (kind == 6) {
                handles.push_back(world.add({.bound = box}).value());
                soups.push_back(soup_of(box));
                continue;
            }
            const float radius = static_cast<float>(random.number(0.1, 1.0));
            const auto shape = convex::Shape::capsule(1.0f, radius).value();
            handles.push_back(world.add({.transform = place, .shape = &shape}).value());
            const glm::dvec3 end = place.linear[1];
            soups.push_back({{{place.translation - end, place.translation + end, place.translation + end}},
                             static_cast<double>(radius),
                             false});
        }
    }
};

}  // namespace

namespace {

// A probe to ask with: as the World takes it, and as triangles.
struct Probe {
    enum class Kind { box, sphere, capsule, shape } kind = Kind::box;
    Obb box;
    Sphere sphere;
    collide::Capsule capsule;
    std::optional<convex::Shape> shape;
    RigidTransform pose;
    Soup soup;
};

Probe random_probe(NearMisses& random, const convex::Hull& hull, double spread) {
    Probe probe;
    probe.kind = static_cast<Probe::Kind>(random.index(4));
    const glm::dvec3 place = spread * random.vector(-1, 1);
    const double size = std::exp(random.number(-3.0, 0.5));
    switch (probe.kind) {
        case Probe::Kind::box:
            probe.box = oracle::random_box(random, place, 0.0);
            probe.soup = soup_of(probe.box);
            break;
        case Probe::Kind::sphere:
            probe.sphere = {place, size};
            probe.soup = {{{place, place, place}}, size, false};
            break;
        case Probe::Kind::capsule:
            probe.capsule = {place, place + random.number(0.0, 2.0) * random.direction(), size};
            probe.soup = {{{place, probe.capsule.end, probe.capsule.end}}, size, false};
            break;
        case Probe::Kind::shape:
            probe.pose = {random_rotation(random), place};
            probe.shape = convex::Shape::hull(hull);
            for (std::size_t t = 0; t < 4; ++t) {
                Triangle corners;
                for (std::size_t k = 0; k < 3; ++k)
                    corners[k] = transform(probe.pose, probe.shape->vertex(hull.triangles()[3 * t + k]));
                probe.soup.triangles.push_back(corners);
            }
            probe.soup.solid = true;
            break;
    }
    return probe;
}

template <class Visit>
void with(const Probe& probe, const Visit& visit) {
    if (probe.kind == Probe::Kind::box) visit(probe.box);
    if (probe.kind == Probe::Kind::sphere) visit(probe.sphere);
    if (probe.kind == Probe::Kind::capsule) visit(probe.capsule);
    if (probe.kind == Probe::Kind::shape) visit(*probe.shape, probe.pose);
}

convex::Hull tetrahedron() {
    const std::array<glm::vec3, 4> points{glm::vec3(0, 0, 0), {1, 0, 0.1f}, {0.2f, 0.9f, 0}, {0.3f, 0.2f, 0.8f}};
    return convex::Hull::build(points).value();
}

}  // namespace

TEST_SUITE("world/shape of objects") {
    TEST_CASE("overlap and closest ask an object's triangles or shape, under any transform") {
        NearMisses random(501);
        const convex::Hull hull = tetrahedron();
        int overlaps = 0, inside = 0, near = 0;
        for (int round = 0; round < 12; ++round) {
            const bool contained = round % 3 != 0;
            const Scene scene(random, 10, 3.0, {.containment = contained});
            REQUIRE(const_cast<World&>(scene.world).update().has_value());
            for (int i = 0; i < 50; ++i) {
                CAPTURE(round);
                CAPTURE(i);
                const Probe probe = random_probe(random, hull, 3.0);
                std::vector<double> distance;
                for (std::size_t o = 0; o < scene.soups.size(); ++o) {
                    distance.push_back(distance_of(probe.soup, scene.soups[o], contained || !scene.is_mesh[o]));
                    inside += distance.back() == 0.0 && distance_of(probe.soup, scene.soups[o], false) > 1e-6;
                }
                Vector<ObjectRef> found;
                with(probe, [&](const auto&... asked) { scene.world.overlap(asked..., found); });
                for (std::size_t o = 0; o < distance.size(); ++o) {
                    const bool listed = std::any_of(found.begin(), found.end(), [&](const ObjectRef& ref) {
                        return ref.object == scene.handles[o];
                    });
                    overlaps += listed;
                    CAPTURE(o);
                    CAPTURE(distance[o]);
                    if (distance[o] == 0.0 || distance[o] > 1e-6) CHECK(listed == (distance[o] == 0.0));
                }
                const double least = *std::min_element(distance.begin(), distance.end());
                for (const double limit : {0.9 * least, 1.1 * least + 1e-6, kInfinity}) {
                    CAPTURE(limit);
                    std::optional<ClosestObject> closest;
                    with(probe, [&](const auto&... asked) { closest = scene.world.closest(asked..., limit); });
                    REQUIRE(closest.has_value() == (least == 0.0 || limit > least));
                    if (!closest) continue;
                    ++near;
                    const auto at = std::find(scene.handles.begin(), scene.handles.end(), closest->object);
                    REQUIRE(at != scene.handles.end());
                    const auto o = static_cast<std::size_t>(at - scene.handles.begin());
                    CHECK(closest->distance == doctest::Approx(least).epsilon(1e-6));
                    CHECK(distance[o] == doctest::Approx(least).epsilon(1e-6));
                    CHECK(glm::distance(closest->on_shape, closest->on_object) ==
                          doctest::Approx(closest->distance).epsilon(1e-6));
                    const Soup on_shape{{{closest->on_shape, closest->on_shape, closest->on_shape}}, 0.0, false},
                        on_object{{{closest->on_object, closest->on_object, closest->on_object}}, 0.0, false};
                    CHECK(distance_of(on_shape, probe.soup, true) < 2e-6);
                    CHECK(distance_of(on_object, scene.soups[o], contained || !scene.is_mesh[o]) < 2e-6);
                }
            }
        }
        CHECK(overlaps > 300);
        CHECK(inside > 10);
        CHECK(near > 1000);
    }

    TEST_CASE("a cast stops at the first triangle or shape in its way, turning or not") {
        NearMisses random(502);
        const convex::Hull hull = tetrahedron();
        const convex::Shape shape = convex::Shape::hull(hull);
        int hits = 0, misses = 0, on_meshes = 0, starts = 0;
        for (int round = 0; round < 6; ++round) {
            const Scene scene(random, 10, 5.0);
            REQUIRE(const_cast<World&>(scene.world).update().has_value());
            for (int i = 0; i < 40; ++i) {
                CAPTURE(round);
                CAPTURE(i);
                const RigidTransform pose{random_rotation(random), 8.0 * random.vector(-1, 1)};
                convex::Motion motion{8.0 * random.vector(-1, 1) - pose.translation, {}, {0.3, 0.3, 0.2}};
                if (i % 2) motion.spin = random.number(0.0, 3.0) * random.direction();
                const auto distances_at = [&](double time) {
                    const RigidTransform there = convex::moved(pose, motion, time);
                    Soup soup{{}, 0.0, true};
                    for (std::size_t t = 0; t < 4; ++t) {
                        Triangle corners;
                        for (std::size_t k = 0; k < 3; ++k)
                            corners[k] = transform(there, shape.vertex(hull.triangles()[3 * t + k]));
                        soup.triangles.push_back(corners);
                    }
                    std::vector<double> distances;
                    for (const Soup& object : scene.soups) distances.push_back(distance_of(soup, object, false));
                    return distances;
                };
                const auto least_at = [&](double time) {
                    const auto all = distances_at(time);
                    return *std::min_element(all.begin(), all.end());
                };
                const auto hit = scene.world.cast(shape, pose, motion, {});
                REQUIRE(hit.has_value());
                const double end = *hit ? (**hit).time : 1.0;
                const double at_start = least_at(0.0);
                if (at_start > 0.0 && at_start < 1e-4) continue;
                if (at_start == 0.0) {
                    ++starts;
                    REQUIRE(hit->has_value());
                    CHECK((**hit).time == 0.0);
                    CHECK((**hit).distance <= 0.0);
                    continue;
                }
                for (int step = 0; step < 10; ++step) CHECK(least_at(end * step / 10.0) > 0.0);
                misses += !*hit;
                if (!*hit) continue;
                ++hits;
                const ShapeHit& found = **hit;
                CHECK(found.resolved);
                const auto at = std::find(scene.handles.begin(), scene.handles.end(), found.object);
                REQUIRE(at != scene.handles.end());
                const auto o = static_cast<std::size_t>(at - scene.handles.begin());
                const auto then = distances_at(end);
                CHECK(then[o] <= 2e-6);
                CHECK(then[o] == doctest::Approx(found.distance).epsilon(1e-3));
                CHECK(glm::length(found.normal) == doctest::Approx(1.0));
                const Soup point{{{found.point, found.point, found.point}}, 0.0, false};
                CHECK(distance_of(point, scene.soups[o], false) < 2e-6);
                if (!scene.is_mesh[o]) continue;
                ++on_meshes;
                REQUIRE(found.triangle < scene.soups[o].triangles.size());
                const Triangle& t = scene.soups[o].triangles[found.triangle];
                CHECK(oracle::distance_to_triangle(found.point, t[0], t[1], t[2]) < 2e-6);
            }
        }
        CHECK(hits > 60);
        CHECK(misses > 20);
        CHECK(on_meshes > 40);
        CHECK(starts > 3);
    }

    TEST_CASE(
        "a probe inside a closed mesh overlaps it where contacts count that, and casts reach the wall from inside") {
        const TriangleMesh crate = box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        TriangleMesh open = crate;
        open.indices.resize(30);
        for (const bool containment : {true, false})
            for (const bool is_open : {true, false}) {
                World world({.containment = containment});
                const auto mesh = world.add_mesh(described(is_open ? open : crate)).value();
                REQUIRE(world.add({.mesh = mesh, .transform = at({}, glm::dmat3(2.0))}).has_value());
                REQUIRE(world.update().has_value());
                const Sphere sphere{{0.5, 0.0, 0.0}, 0.25};
                const bool counts = containment && !is_open;
                Vector<ObjectRef> found;
                world.overlap(sphere, found);
                CHECK(found.size() == (counts ? 1 : 0));
                const auto closest = world.closest(sphere, kInfinity);
                REQUIRE(closest.has_value());
                CHECK(closest->distance == (counts ? 0.0 : doctest::Approx(1.25)));
                const auto hit = world.cast(convex::Shape::sphere(0.25).value(), {glm::dmat3(1.0), sphere.center},
                                            {{5.0, 0.0, 0.0}, {}, {}}, {});
                REQUIRE(hit.has_value());
                REQUIRE(hit->has_value());
                CHECK((**hit).time == doctest::Approx(0.25).epsilon(1e-5));
            }
    }

    TEST_CASE("objects with shapes are asked by their shapes, whatever the probe") {
        World world;
        const auto hull = tetrahedron();
        const convex::Shape shape = convex::Shape::hull(hull),
                            ground = convex::Shape::half_space({{0, -1, 0}, -5.0}).value();
        REQUIRE(world.add({.transform = at({}), .shape = &shape}).has_value());
        REQUIRE(world.add({.transform = at({}), .shape = &ground}).has_value());
        REQUIRE(world.update().has_value());
        // In the tetrahedron's box, but outside of it.
        const glm::dvec3 corner(0.95, 0.85, 0.75);
        Vector<ObjectRef> found;
        world.overlap(Sphere{corner, 0.05}, found);
        CHECK(found.empty());
        world.overlap(collide::Capsule{corner, corner + glm::dvec3(0, 1, 0), 0.05}, found);
        CHECK(found.empty());
        Obb box;
        box.center = corner;
        box.half_extents = glm::vec3(0.05f);
        world.overlap(box, found);
        CHECK(found.empty());
        box.center = {0.3, 0.2, 0.2};
        world.overlap(box, found);
        CHECK(found.size() == 1);
        box.center = {0.0, -5.04, 0.0};
        world.overlap(box, found);
        REQUIRE(found.size() == 1);
        CHECK(world.closest(Sphere{{0.0, -4.0, 0.0}, 0.25}, 0.8)->distance == doctest::Approx(0.75));
        CHECK(!world.closest(Sphere{{0.0, -4.0, 0.0}, 0.25}, 0.7));
    }

    TEST_CASE("queries of meshes follow their deformation, and allocate nothing once warm") {
        testing::CountingMemory memory;
        {
            World world;
            TriangleMesh crate = box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
            const auto mesh = world.add_mesh(described(crate)).value();
            REQUIRE(world.add({.mesh = mesh, .transform = at({})}).has_value());
            REQUIRE(world.add({.mesh = mesh, .transform = at({5, 0, 0}, glm::dmat3(0.5))}).has_value());
            Vector<ObjectRef> found;
            const convex::Shape ball = convex::Shape::sphere(0.25).value();
            for (const float side : {1.0f, 2.0f, 1.5f}) {
                for (glm::vec3& p : crate.positions) p = glm::sign(p) * side;
                REQUIRE(world.set_vertices(mesh, crate.positions).has_value());
                REQUIRE(world.update().has_value());
                const auto queries = [&] {
                    world.overlap(Sphere{{0.0, 0.0, double{side} + 0.2}, 0.25}, found);
                    CHECK(found.size() == 1);
                    CHECK(world.closest(Sphere{{0.0, 0.0, 4.0}, 0.25}, 10.0)->distance ==
                          doctest::Approx(3.75 - double{side}));
                    const auto hit = world.cast(ball, {glm::dmat3(1.0), {5.0, 0.0, 4.0}}, {{0, 0, -4}, {}, {}}, {});
                    REQUIRE(hit->has_value());
                    CHECK((**hit).time == doctest::Approx((3.75 - 0.5 * double{side}) / 4.0).epsilon(1e-5));
                };
                queries();
                const std::size_t before = memory.allocations(), news = testing::operator_news();
                queries();
                CHECK(memory.allocations() == before);
                CHECK(testing::operator_news() == news);
            }
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
