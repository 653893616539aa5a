// SPDX-License-Identifier: MIT
// Objects with meshes, under nodes and by themselves.
#include <doctest/doctest.h>
#include <counting_memory.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <mesh/meshes.hpp>
#include <oracle/code_of.hpp>
#include <oracle/random_boxes.hpp>
#include <set>

#include "model.hpp"
#include "new_counter.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

scene::Transform at(const glm::dvec3& place, const glm::dmat3& linear = glm::dmat3(1.0)) {
    return {linear, place};
}

MeshDescription described(const TriangleMesh& mesh) {
    return {.positions = mesh.positions, .indices = mesh.indices};
}

// [-1, 1]³.
TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

Ray down(double x, double y) {
    return {{x, y, 100.0}, {0.0, 0.0, -1.0}};
}

std::size_t seen(const World& world) {
    VisibleObjects visible;
    Camera camera;
    camera.position.z = 50.0;
    REQUIRE(world.view(camera, visible).has_value());
    return visible.size();
}

}  // namespace

TEST_SUITE("world/meshes") {
    TEST_CASE("meshes, nodes and transforms that are none are refused with a reason, and spoil nothing") {
        World world;
        const TriangleMesh box = cube();
        const auto mesh = world.add_mesh(described(box)).value();
        const auto node = world.add_node().value();
        const auto good = world.add({.mesh = mesh, .transform = at({})}).value();
        CHECK(world.add_mesh({}).error().code == ErrorCode::empty);
        TriangleMesh bad = box;
        bad.indices[5] = 8;
        CHECK(world.add_mesh(described(bad)).error().code == ErrorCode::out_of_range);
        CHECK(world.replace_mesh(mesh, described(bad)).error().code == ErrorCode::out_of_range);
        bad = box;
        bad.positions[3].y = std::numeric_limits<float>::quiet_NaN();
        CHECK(world.add_mesh(described(bad)).error().item == 3);
        CHECK_FALSE(world.set_vertices(mesh, bad.positions).has_value());
        CHECK(oracle::code_of(world.set_vertices(mesh, std::vector<glm::vec3>(7))) == ErrorCode::invalid_argument);
        for (const double number : {kNan, kInfinity, 1e16}) {
            CHECK_FALSE(world.add_node({.transform = at({number, 0.0, 0.0})}).has_value());
            CHECK_FALSE(world.add({.mesh = mesh, .transform = at({}, glm::dmat3(number))}).has_value());
            CHECK_FALSE(world.set_transform(node, at({0.0, number, 0.0})).has_value());
            CHECK(world.set_transform(good, at({0.0, number, 0.0})).error().item == good.index);
        }
        CHECK(oracle::code_of(world.add({.mesh = mesh, .bound = Sphere{{}, 1.0}})) == ErrorCode::invalid_argument);
        CHECK(oracle::code_of(world.add({.node = node, .bound = Sphere{{}, 1.0}})) == ErrorCode::invalid_argument);
        CHECK(oracle::code_of(world.set_bound(good, Sphere{{}, 1.0})) == ErrorCode::invalid_argument);
        const auto on_node = world.add({.mesh = mesh, .node = node}).value();
        CHECK(oracle::code_of(world.set_transform(on_node, at({}))) == ErrorCode::invalid_argument);
        const auto bound = world.add({.bound = Sphere{{0.0, 0.0, 20.0}, 1.0}}).value();
        CHECK(oracle::code_of(world.set_transform(bound, at({}))) == ErrorCode::invalid_argument);
        CHECK(oracle::code_of(world.set_mesh(bound, mesh)) == ErrorCode::invalid_argument);
        CHECK(oracle::code_of(world.transform_of(bound)) == ErrorCode::invalid_argument);
        CHECK(oracle::code_of(world.remove(mesh)) == ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        CHECK(world.object_count() == 3);
        CHECK(world.transform_of(good)->translation == glm::dvec3(0.0));
        CHECK(seen(world) == 3);
    }

    TEST_CASE("inputs of either precision and width are read where they are") {
        struct Vertex {
            char color[3];
            float place[3];
        };
        const TriangleMesh box = cube();
        std::vector<Vertex> vertices(8);
        std::vector<glm::dvec3> doubles;
        std::vector<std::uint16_t> shorts(box.indices.begin(), box.indices.end());
        std::vector<glm::vec3> soup;
        for (std::size_t i = 0; i < 8; ++i) {
            for (int k = 0; k < 3; ++k) vertices[i].place[k] = box.positions[i][k];
            doubles.push_back(glm::dvec3(box.positions[i]));
        }
        for (const std::uint32_t i : box.indices) soup.push_back(box.positions[i]);
        World world;
        const std::vector<std::uint32_t> longs(box.indices.begin(), box.indices.end());
        const MeshDescription kinds[] = {{.positions = {vertices[0].place, 8, sizeof(Vertex)}, .indices = shorts},
                                         {.positions = doubles, .indices = longs},
                                         {.positions = {&doubles[0].x, 8}, .indices = {shorts.data(), shorts.size()}},
                                         {.positions = soup}};
        double x = 0.0;
        for (const MeshDescription& kind : kinds) {
            const auto mesh = world.add_mesh(kind).value();
            const auto object = world.add({.mesh = mesh, .transform = at({x, 0.0, 0.0})}).value();
            REQUIRE(world.update().has_value());
            const auto hit = world.raycast(down(x + 0.5, 0.25));
            REQUIRE(hit.has_value());
            CHECK(hit->object == object);
            CHECK(hit->t == 99.0);
            CHECK(hit->triangle >= 10);
            x += 10.0;
        }
    }

    TEST_CASE("a node moves, hides and removes all below it") {
        World world;
        const auto mesh = world.add_mesh(described(cube())).value();
        const auto ship = world.add_node({.transform = at({10.0, 0.0, 0.0})}).value();
        const auto arm = world.add_node({.parent = ship, .transform = at({0.0, 5.0, 0.0})}).value();
        const auto hull = world.add({.mesh = mesh, .node = ship}).value();
        const auto hand =
            world.add({.mesh = mesh, .node = arm, .transform = at({0.0, 0.0, 3.0}, glm::dmat3(0.5))}).value();
        const auto rock = world.add({.mesh = mesh, .transform = at({-10.0, 0.0, 0.0})}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(hand)->center == glm::dvec3(10.0, 5.0, 3.0));
        CHECK(world.box_of(hand)->half_extents.x == doctest::Approx(0.5));
        REQUIRE(world.set_transform(ship, at({0.0, 0.0, 1.0})).has_value());
        REQUIRE(world.set_transform(hand, at({0.0, 0.0, 4.0})).has_value());
        CHECK(world.box_of(hand)->center == glm::dvec3(10.0, 5.0, 3.0));  // until the update
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(hand)->center == glm::dvec3(0.0, 5.0, 5.0));
        CHECK(world.box_of(hull)->center == glm::dvec3(0.0, 0.0, 1.0));
        CHECK(oracle::code_of(world.set_parent(ship, arm)) == ErrorCode::invalid_argument);
        REQUIRE(world.set_parent(arm, {}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(hand)->center == glm::dvec3(0.0, 5.0, 4.0));
        REQUIRE(world.set_parent(arm, ship).has_value());
        REQUIRE(world.set_layers(ship, 2).has_value());
        REQUIRE(world.set_layers(hull, 6).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.raycast(down(0.0, 0.0), 4));
        CHECK(world.raycast(down(0.0, 0.0), 2)->object == hull);
        CHECK(seen(world) == 3);
        REQUIRE(world.set_transform(ship, at({}, glm::dmat3(0.0))).has_value());
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 1);
        CHECK(!world.raycast(down(0.0, 0.0)));
        REQUIRE(world.set_transform(ship, at({})).has_value());
        REQUIRE(world.set_hidden(hull, true).has_value());
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 2);
        REQUIRE(world.set_transform(ship, at({1.0, 0.0, 0.0})).has_value());
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 2);
        REQUIRE(world.set_hidden(hull, false).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.raycast(down(1.0, 0.0))->object == hull);
        REQUIRE(world.remove(ship).has_value());
        CHECK(!world.contains(ship));
        CHECK(!world.contains(arm));
        CHECK(!world.contains(hull));
        CHECK(!world.contains(hand));
        CHECK(world.contains(rock));
        CHECK(world.object_count() == 1);
        CHECK(!world.raycast(down(1.0, 0.0)));
        CHECK(world.remove(ship).error().code == ErrorCode::stale_handle);
        CHECK(world.set_transform(arm, at({})).error().code == ErrorCode::stale_handle);
        CHECK(world.add({.mesh = mesh, .node = arm}).error().code == ErrorCode::stale_handle);
        CHECK(world.add_node({.parent = arm}).error().code == ErrorCode::stale_handle);
        // Ids are used again before the update, too.
        const auto later = world.add_node({.transform = at({0.0, 20.0, 0.0})}).value();
        const auto box = world.add({.mesh = mesh, .node = later}).value();
        CHECK(!world.contains(hull));
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 2);
        CHECK(world.raycast(down(0.0, 20.0))->object == box);
        CHECK(world.box_of(box)->center == glm::dvec3(0.0, 20.0, 0.0));
        CHECK(!world.contains(ship));
        REQUIRE(world.remove(box).has_value());
        REQUIRE(world.remove(rock).has_value());
        REQUIRE(world.remove(mesh).has_value());
        CHECK(!world.contains(mesh));
        CHECK(world.add({.mesh = mesh, .node = later}).error().code == ErrorCode::stale_handle);
        CHECK(world.set_vertices(mesh, cube().positions).error().code == ErrorCode::stale_handle);
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 0);
    }

    TEST_CASE("meshes are exchanged, replaced and deformed, and rays and boxes follow") {
        World world;
        TriangleMesh box = cube(), large = cube();
        for (glm::vec3& p : large.positions) p *= 3.0f;
        const auto small_mesh = world.add_mesh(described(box)).value(),
                   large_mesh = world.add_mesh(described(large)).value();
        const auto object = world.add({.mesh = small_mesh, .transform = at({})}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.raycast(down(0.0, 0.0))->t == 99.0);
        REQUIRE(world.set_mesh(object, large_mesh).has_value());
        CHECK(world.raycast(down(0.0, 0.0))->t == 99.0);
        REQUIRE(world.remove(small_mesh).has_value());
        CHECK(world.raycast(down(0.0, 0.0))->t == 99.0);  // as of the last update
        REQUIRE(world.update().has_value());
        CHECK(world.raycast(down(2.5, 0.0))->t == 97.0);
        for (glm::vec3& p : large.positions) p.z += 2.0f;
        REQUIRE(world.set_vertices(large_mesh, large.positions).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.raycast(down(2.5, 0.0))->t == 95.0);
        CHECK(world.box_of(object)->center.z == doctest::Approx(2.0));
        REQUIRE(world.replace_mesh(large_mesh, described(box)).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.raycast(down(2.5, 0.0)));
        CHECK(world.raycast(down(0.5, 0.0))->t == 99.0);
        // Without triangles its box answers: here a tetrahedron's.
        TriangleMesh tetrahedron;
        tetrahedron.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
        tetrahedron.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
        MeshDescription description = described(tetrahedron);
        REQUIRE(world.replace_mesh(large_mesh, description).has_value());
        REQUIRE(world.update().has_value());
        const auto by_triangles = world.raycast(down(0.75, 0.75));
        REQUIRE(by_triangles.has_value());
        CHECK(by_triangles->t == doctest::Approx(99.5));
        CHECK(by_triangles->triangle == 3);
        description.triangles = false;
        REQUIRE(world.replace_mesh(large_mesh, description).has_value());
        REQUIRE(world.update().has_value());
        const auto by_box = world.raycast(down(0.75, 0.75));
        REQUIRE(by_box.has_value());
        CHECK(by_box->triangle == kNoTriangle);
        CHECK(by_box->t <= 99.5);
    }

    TEST_CASE("a flat scale gives a flat object that is seen and hit, and out of range it is hidden until it returns") {
        World world;
        const auto mesh = world.add_mesh(described(cube())).value();
        const auto node = world.add_node().value();
        const auto object =
            world.add({.mesh = mesh, .node = node, .transform = at({}, glm::dmat3({2, 0, 0}, {0, 3, 0}, {0, 0, 0}))})
                .value();
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(object).has_value());
        CHECK(seen(world) == 1);
        const auto hit = world.raycast(down(1.5, 2.5));
        REQUIRE(hit.has_value());
        CHECK(hit->t == doctest::Approx(100.0));
        REQUIRE(world.set_transform(node, at({}, glm::dmat3(1e15))).has_value());
        REQUIRE(world.set_transform(object, at({}, glm::dmat3(1e15))).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().out_of_range == 1);
        CHECK(seen(world) == 0);
        REQUIRE(world.set_transform(object, at({}, glm::dmat3(1e-15))).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().out_of_range == 0);
        CHECK(seen(world) == 1);
    }

    TEST_CASE("rays hit triangles as a test of each triangle says, whatever the transform") {
        oracle::NearMisses random(21);
        World world;
        const TriangleMesh ring = wavy_torus(1.0, 0.3, 0.2, 16, 8);
        const auto mesh = world.add_mesh(described(ring)).value();
        std::vector<std::pair<ObjectHandle, scene::Transform>> objects;
        for (int i = 0; i < 60; ++i) {
            glm::dmat3 linear =
                glm::mat3_cast(glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
            for (int k = 0; k < 3; ++k)
                linear[k] *= i % 3 == 0 ? 1.0 : (i % 5 == 0 && k == 1 ? -1.0 : 1.0) * random.number(0.5, 3.0);
            const auto place = at(6.0 * random.direction(), linear);
            objects.emplace_back(world.add({.mesh = mesh, .transform = place}).value(), place);
        }
        REQUIRE(world.update().has_value());
        std::size_t hits = 0;
        Vector<ObjectHit> all;
        for (int i = 0; i < 400; ++i) {
            Ray ray{15.0 * random.direction(), {}};
            ray.direction = 5.0 * random.direction() - ray.origin;
            std::map<double, ObjectHandle> expected;
            for (const auto& [object, place] : objects) {
                double least = kInfinity;
                for (std::size_t t = 0; t < ring.indices.size(); t += 3) {
                    Triangle triangle;
                    for (std::size_t k = 0; k < 3; ++k)
                        triangle[k] = place * glm::dvec3(ring.positions[ring.indices[t + k]]);
                    if (const auto hit = mesh::raycast(ray, triangle)) least = std::min(least, *hit);
                }
                if (least < kInfinity) expected[least] = object;
            }
            world.raycast_all(ray, all);
            REQUIRE(all.size() == expected.size());
            std::size_t at_hit = 0;
            for (const auto& [t, object] : expected) {
                CHECK(all[at_hit].object == object);
                CHECK(all[at_hit].t == doctest::Approx(t).epsilon(1e-9));
                ++at_hit;
            }
            CHECK(world.raycast_any(ray) == !expected.empty());
            const auto nearest = world.raycast(ray);
            CHECK(nearest.has_value() == !expected.empty());
            if (nearest) CHECK(nearest->object == expected.begin()->second);
            hits += all.size();
        }
        CHECK(hits > 200);
    }

    TEST_CASE("contacts of meshes, boxes and balls with meshes are where their triangles meet") {
        World world({.mesh_depth = true});
        const TriangleMesh ring = wavy_torus(1.0, 0.3, 0.0);
        const auto torus = world.add_mesh(described(ring)).value();
        const auto a = world.add({.mesh = torus, .transform = at({})}).value();
        const auto b = world.add({.mesh = torus, .transform = at({2.5, 0.0, 0.0})}).value();  // overlaps by 0.1
        world.add({.bound = Sphere{{0.0, 0.0, 0.0}, 0.5}}).value();                      // in the hole: touches nothing
        const auto ball = world.add({.bound = Sphere{{-1.5, 0.0, 0.0}, 0.25}}).value();  // depth 0.05
        Obb inner;
        inner.center = {0.0, 1.0, 0.0};
        inner.half_extents = glm::vec3(0.01f);
        const auto box = world.add({.bound = inner}).value();  // inside the tube
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 3);
        const Contact& rings = world.contacts()[0];
        CHECK(rings.first.object == a);
        CHECK(rings.second.object == b);
        CHECK(!rings.triangles.empty());
        CHECK(rings.normal.x == doctest::Approx(1.0).epsilon(0.05));
        CHECK(rings.depth == doctest::Approx(0.1).epsilon(0.3));
        for (const mesh::MeshContact& contact : rings.triangles) CHECK(std::abs(contact.segment.begin.x - 1.25) < 0.1);
        const Contact& touch = world.contacts()[1];
        CHECK(touch.second.object == ball);
        CHECK(touch.depth == doctest::Approx(0.05).epsilon(0.05));
        CHECK(touch.normal.x == doctest::Approx(-1.0).epsilon(0.01));
        REQUIRE(touch.points.size() == 1);
        CHECK(touch.points[0].position.x == doctest::Approx(-1.3).epsilon(0.01));
        const Contact& inside = world.contacts()[2];
        CHECK(inside.second.object == box);
        CHECK(inside.inside == mesh::Containment::b_inside_a);
        CHECK(inside.triangles.empty());
        CHECK(world.pairs().size() > 3);
    }

    TEST_CASE("pairs of moving meshes that touch are those of all pairs of their triangles") {
        oracle::NearMisses random(22);
        World serial, parallel;
        ThreadPool pool(3);
        const TriangleMesh meshes[] = {wavy_torus(1.0, 0.3, 0.2, 10, 6), cube()};
        struct Thing {
            ObjectHandle object;
            std::size_t mesh;
            scene::Transform place;
        };
        std::vector<Thing> things;
        MeshHandle handles[2];
        for (std::size_t m = 0; m < 2; ++m) {
            handles[m] = serial.add_mesh(described(meshes[m])).value();
            CHECK(parallel.add_mesh(described(meshes[m])).value() == handles[m]);
        }
        for (std::size_t i = 0; i < 40; ++i) {
            glm::dmat3 linear =
                glm::mat3_cast(glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
            if (i % 3 == 0) linear[1] *= 0.5;
            const auto place = at(4.0 * random.direction(), linear);
            things.push_back({serial.add({.mesh = handles[i % 2], .transform = place}).value(), i % 2, place});
            REQUIRE(parallel.add({.mesh = handles[i % 2], .transform = place}).value() == things.back().object);
        }
        std::size_t touching = 0, apart = 0;
        std::set<std::pair<std::uint32_t, std::uint32_t>> before;
        for (int frame = 0; frame < 4; ++frame) {
            REQUIRE(serial.update().has_value());
            REQUIRE(parallel.update(pool).has_value());
            std::map<std::pair<std::uint32_t, std::uint32_t>, ContactPhase> phases;
            for (const Contact& contact : serial.contacts())
                phases[{contact.first.object.index, contact.second.object.index}] = contact.phase;
            CHECK(std::ranges::equal(serial.contacts(), parallel.contacts(), [](const Contact& x, const Contact& y) {
                return x.first.object == y.first.object && x.second.object == y.second.object && x.phase == y.phase &&
                       x.normal == y.normal && x.triangles.size() == y.triangles.size();
            }));
            std::set<std::pair<std::uint32_t, std::uint32_t>> now;
            for (std::size_t i = 0; i < things.size(); ++i)
                for (std::size_t j = i + 1; j < things.size(); ++j) {
                    const auto triangles = [&](const Thing& thing) {
                        const TriangleMesh& mesh = meshes[thing.mesh];
                        std::vector<Triangle> list;
                        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                            list.emplace_back();
                            for (std::size_t k = 0; k < 3; ++k)
                                list.back()[k] = thing.place * glm::dvec3(mesh.positions[mesh.indices[t + k]]);
                        }
                        return list;
                    };
                    bool meet = false;
                    if (glm::length(things[i].place.translation - things[j].place.translation) < 3.5)
                        for (const auto& x : triangles(things[i]))
                            for (const auto& y : triangles(things[j])) meet = meet || mesh::intersects(x, y);
                    const std::pair key{things[i].object.index, things[j].object.index};
                    const auto found = phases.find(key);
                    const bool hit = found != phases.end() && found->second != ContactPhase::ended;
                    // A mesh within another touches it, too.
                    if (meet) CHECK(hit);
                    (hit ? touching : apart) += 1;
                    if (hit) now.insert(key);
                    if (hit) CHECK((found->second == ContactPhase::stayed) == before.contains(key));
                    if (!hit) CHECK((found != phases.end()) == before.contains(key));
                }
            before = now;
            for (Thing& thing : things) {
                thing.place.translation += 0.3 * random.direction();
                REQUIRE(serial.set_transform(thing.object, thing.place).has_value());
                REQUIRE(parallel.set_transform(thing.object, thing.place).has_value());
            }
        }
        CHECK(touching > 50);
        CHECK(apart > 50);
    }

    TEST_CASE("a warm world of moving meshes allocates nothing, neither through the memory hook nor past it") {
        CountingMemory memory;
        {
            World world({.rebuild_budget = 0});
            oracle::NearMisses random(23);
            const auto mesh = world.add_mesh(described(wavy_torus(1.0, 0.3, 0.2, 10, 6))).value();
            std::vector<ObjectHandle> objects;
            std::vector<scene::Transform> places;
            for (int i = 0; i < 300; ++i) {
                places.push_back(at(9.0 * random.direction(), glm::dmat3(i % 3 ? 1.0 : 0.5)));
                objects.push_back(world.add({.mesh = mesh, .transform = places.back()}).value());
            }
            Vector<ObjectHit> hits;
            const auto frame = [&](double shift) {
                for (std::size_t i = 0; i < 300; i += 2) places[i].translation.x += shift;
                REQUIRE(world.set_transforms(objects, places).has_value());
                REQUIRE(world.update().has_value());
                world.raycast_all({{-20.0, 0.0, 9.0}, {1.0, 0.0, 0.0}}, hits);
            };
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            const std::size_t before = memory.allocations(), news = operator_news();
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            CHECK(memory.allocations() == before);
            CHECK(operator_news() == news);
            CHECK(world.contacts().size() > 20);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
