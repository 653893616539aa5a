// SPDX-License-Identifier: MIT
// Rays at the triangles of meshes in a World, and what they touch.
#include <doctest/doctest.h>
#include <counting_memory.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <oracle/random_boxes.hpp>
#include <set>
#include <shape/mesh/meshes.hpp>

#include "../../ranges.hpp"
#include "cubes.hpp"
#include "new_counter.hpp"

using namespace crofton;
using namespace crofton::testing;

TEST_SUITE("world/mesh_contacts") {
    TEST_CASE("rays hit triangles as a test of each triangle says, whatever the transform") {
        oracle::NearMisses random(21);
        World world;
        const TriangleMesh ring = wavy_torus(1.0, 0.3, 0.2, 16, 8);
        const auto mesh = world.add_mesh(described(ring)).value();
        std::vector<std::pair<ObjectHandle, Transform>> objects;
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

    TEST_CASE("contacts of meshes, boxes and spheres with meshes are where their triangles meet") {
        World world({.mesh_depth = true});
        const TriangleMesh ring = wavy_torus(1.0, 0.3, 0.0);
        const auto torus = world.add_mesh(described(ring)).value();
        const auto a = world.add({.mesh = torus, .transform = at({})}).value();
        const auto b = world.add({.mesh = torus, .transform = at({2.5, 0.0, 0.0})}).value();  // overlaps by 0.1
        world.add({.bound = Sphere{{0.0, 0.0, 0.0}, 0.5}}).value();  // in the hole: touches nothing
        const auto sphere = world.add({.bound = Sphere{{-1.5, 0.0, 0.0}, 0.25}}).value();  // depth 0.05
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
        CHECK(touch.second.object == sphere);
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

    TEST_CASE("a sphere whose center is in a room leaves it by the nearest wall, whether a mesh or a box is the room") {
        oracle::NearMisses random(23);
        const glm::dvec3 half(6.0, 5.0, 4.0);
        const TriangleMesh walls = box_mesh(glm::vec3(-half), glm::vec3(half)), unit = cube_mesh();
        for (int kind = 0; kind < 3; ++kind) {  // a mesh, a scaled mesh, a box
            World world;
            const MeshHandle mesh = world.add_mesh(described(kind == 0 ? walls : unit)).value();
            struct Expected {
                double depth;
                glm::dvec3 normal, on_wall, deepest;
            };
            std::map<std::uint32_t, Expected> expected;
            for (int i = 0; i < 300; ++i) {
                const glm::dmat3 turn = glm::mat3_cast(
                    glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
                const glm::dvec3 place(40.0 * i, 0.0, 0.0);
                glm::dmat3 linear = turn;
                for (int k = 0; kind == 1 && k < 3; ++k) linear[k] *= half[k];
                if (kind == 2)
                    (void)world.add({.bound = Obb{place, glm::mat3(turn), glm::vec3(half)}}).value();
                else
                    (void)world.add({.mesh = mesh, .transform = at(place, linear)}).value();
                glm::dvec3 local;
                for (int k = 0; k < 3; ++k) local[k] = random.number(-0.999, 0.999) * half[k];
                const double radius = random.number(0.1, 2.0);
                const auto sphere = world.add({.bound = Sphere{place + turn * local, radius}}).value();
                int k = 0;
                for (int j = 1; j < 3; ++j)
                    if (half[j] - std::abs(local[j]) < half[k] - std::abs(local[k])) k = j;
                const double gap = half[k] - std::abs(local[k]), side = local[k] < 0.0 ? -1.0 : 1.0;
                glm::dvec3 wall = local;
                wall[k] = side * half[k];
                Expected& e = expected[sphere.index];
                e = {radius + gap, side * turn[k], place + turn * wall, {}};
                e.deepest = place + turn * local - (radius - 0.5 * e.depth) * e.normal;
            }
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == expected.size());
            for (const Contact& contact : world.contacts()) {
                const Expected& e = expected.at(contact.second.object.index);
                const double slack = kind == 0 ? 1e-9 : 1e-5;  // boxes and scaled meshes are kept in float
                CHECK(std::abs(contact.depth - e.depth) <= slack);
                CHECK(glm::distance(contact.normal, e.normal) <= slack);
                REQUIRE(contact.points.size() == 1);
                CHECK(contact.points[0].depth == contact.depth);
                CHECK(glm::distance(contact.points[0].position, kind == 2 ? e.deepest : e.on_wall) <= 2.0 * slack);
            }
        }
    }

    TEST_CASE("pairs of moving meshes that touch are those of all pairs of their triangles") {
        oracle::NearMisses random(22);
        World serial, parallel;
        ThreadPool pool(3);
        const TriangleMesh meshes[] = {wavy_torus(1.0, 0.3, 0.2, 10, 6), cube_mesh()};
        struct Thing {
            ObjectHandle object, twin;  // in `parallel`
            std::size_t mesh;
            Transform place;
        };
        std::vector<Thing> things;
        MeshHandle handles[2], twins[2];
        for (std::size_t m = 0; m < 2; ++m) {
            handles[m] = serial.add_mesh(described(meshes[m])).value();
            twins[m] = parallel.add_mesh(described(meshes[m])).value();
            CHECK(twins[m].index == handles[m].index);
        }
        for (std::size_t i = 0; i < 40; ++i) {
            glm::dmat3 linear =
                glm::mat3_cast(glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
            if (i % 3 == 0) linear[1] *= 0.5;
            const auto place = at(4.0 * random.direction(), linear);
            things.push_back({serial.add({.mesh = handles[i % 2], .transform = place}).value(),
                              parallel.add({.mesh = twins[i % 2], .transform = place}).value(), i % 2, place});
            REQUIRE(things.back().twin.index == things.back().object.index);
        }
        std::size_t touching = 0, apart = 0;
        std::set<std::pair<std::uint32_t, std::uint32_t>> before;
        for (int frame = 0; frame < 4; ++frame) {
            REQUIRE(serial.update().has_value());
            REQUIRE(parallel.update(pool).has_value());
            std::map<std::pair<std::uint32_t, std::uint32_t>, ContactPhase> phases;
            for (const Contact& contact : serial.contacts())
                phases[{contact.first.object.index, contact.second.object.index}] = contact.phase;
            CHECK(test::ranges::equal(serial.contacts(), parallel.contacts(), [](const Contact& x, const Contact& y) {
                return x.first.object.index == y.first.object.index && x.second.object.index == y.second.object.index &&
                       x.phase == y.phase && x.normal == y.normal && x.triangles.size() == y.triangles.size();
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
                REQUIRE(parallel.set_transform(thing.twin, thing.place).has_value());
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
            std::vector<Transform> places;
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

    TEST_CASE("a mirrored mesh touches as its mirror image does, scaled or not") {
        // Cubes are their own mirror images.
        const TriangleMesh cube = cube_mesh();
        for (const bool box : {false, true})
            for (const double width_a : {1.0, -1.0, 2.0, -2.0})
                for (const double width_b : {1.0, -1.0, 2.0, -2.0}) {
                    CAPTURE(box);
                    CAPTURE(width_a);
                    CAPTURE(width_b);
                    World world;
                    const auto mesh = world.add_mesh(described(cube)).value();
                    const auto width = [](double x) { return glm::dmat3(x, 0, 0, 0, 1, 0, 0, 0, 1); };
                    const glm::dvec3 place(std::abs(width_a) + std::abs(width_b) - 0.1, 0.3, 0.2);
                    REQUIRE(world.add({.mesh = mesh, .transform = at({}, width(width_a))}).has_value());
                    if (box) {
                        const Obb other{place, glm::mat3(width_b > 0.0 ? 1 : -1, 0, 0, 0, 1, 0, 0, 0, 1),
                                        glm::vec3(std::abs(width_b), 1.0, 1.0)};
                        REQUIRE(world.add({.bound = other}).has_value());
                    } else {
                        REQUIRE(world.add({.mesh = mesh, .transform = at(place, width(width_b))}).has_value());
                    }
                    REQUIRE(world.update().has_value());
                    REQUIRE(world.contacts().size() == 1);
                    const Contact& contact = world.contacts()[0];
                    CHECK(contact.normal.x > 0.99);
                    CHECK(contact.depth == doctest::Approx(0.1).epsilon(0.01));
                    // Triangles look out of the second shape; their segments go round, seen from it.
                    double around = 0.0;
                    for (const mesh::MeshContact& found : contact.triangles) {
                        const glm::dvec3 middle = 0.5 * (found.segment.begin + found.segment.end);
                        CHECK(glm::dot(found.normal, middle - place) > 0.0);
                        around += glm::cross(found.segment.begin - place, found.segment.end - place).x;
                    }
                    CHECK(around > 0.0);
                }
    }

    TEST_CASE("a mesh that is mirrored within its own box takes its contacts along") {
        // Three of the eight corners of its box are a triangle.
        TriangleMesh mesh;
        for (int i = 0; i < 8; ++i)
            mesh.positions.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? 2.0f : -2.0f, i & 4 ? 3.0f : -3.0f);
        mesh.indices = {7, 6, 5};
        World world;
        const auto shape = world.add_mesh(described(mesh)).value();
        const glm::dmat3 turn = glm::mat3_cast(glm::dquat(glm::dvec3(0.3, 0.4, 0.5)));
        const auto object = world.add({.mesh = shape, .transform = at({}, turn)}).value();
        world.add({.bound = Sphere{turn * glm::dvec3(1.0, 2.0, 3.0), 0.05}}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().size() == 1);
        const Obb box = world.box_of(object).value();
        // What is mirrored along the third axis keeps the first two, and the third is their product.
        const glm::dvec3 axis = glm::normalize(glm::cross(glm::dvec3(box.axes[0]), glm::dvec3(box.axes[1])));
        const glm::dmat3 mirror = glm::dmat3(1.0) - 2.0 * glm::outerProduct(axis, axis);
        for (int i = 0; i < 4; ++i) {
            REQUIRE(world.set_transform(object, at({}, i % 2 == 0 ? mirror * turn : turn)).has_value());
            REQUIRE(world.update().has_value());
            const Obb now = world.box_of(object).value();
            CHECK(std::memcmp(&box, &now, sizeof box) == 0);
            REQUIRE(world.contacts().size() == 1);
            CHECK((world.contacts()[0].phase == ContactPhase::ended) == (i % 2 == 0));
            CHECK(world.statistics().boxes_changed == 1);
        }
    }

    TEST_CASE("a stretched mesh that is replaced within its own box takes its contacts along") {
        // Of a cube's corners three are a triangle: those beside one corner, or beside the opposite one.
        TriangleMesh near, far;
        for (int i = 0; i < 8; ++i)
            near.positions.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
        far.positions = near.positions;
        near.indices = {7, 6, 5};
        far.indices = {0, 1, 2};
        for (const double stretch : {1.0, 2.0}) {
            World world;
            const auto shape = world.add_mesh(described(near)).value();
            const glm::dmat3 linear = glm::dmat3(stretch, 0, 0, 0, 1, 0, 0, 0, 1);
            REQUIRE(world.add({.mesh = shape, .transform = at({}, linear)}).has_value());
            REQUIRE(world.add({.bound = Sphere{linear * glm::dvec3(1.0), 0.05}}).has_value());
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            for (int i = 0; i < 4; ++i) {
                REQUIRE(world.replace_mesh(shape, described(i % 2 == 0 ? far : near)).has_value());
                REQUIRE(world.update().has_value());
                REQUIRE(world.contacts().size() == 1);
                CAPTURE(stretch);
                CAPTURE(i);
                CHECK((world.contacts()[0].phase == ContactPhase::ended) == (i % 2 == 0));
            }
        }
    }

    TEST_CASE("rays hit what rotations and a flat scale have flattened in its plane") {
        oracle::NearMisses random(24);
        const TriangleMesh cube = cube_mesh();
        const auto turn = [&] {
            return glm::mat3_cast(
                glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
        };
        for (int i = 0; i < 200; ++i) {
            World world;
            const auto mesh = world.add_mesh(described(cube)).value();
            const glm::dmat3 outer = turn();
            const auto flat = world.add_node({.transform = at({}, outer * glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 0))});
            REQUIRE(world.add({.mesh = mesh, .node = flat.value(), .transform = at({}, turn())}).has_value());
            REQUIRE(world.update().has_value());
            const auto hit = world.raycast({5.0 * outer[2], -outer[2]});
            REQUIRE(hit.has_value());
            CHECK(hit->t == doctest::Approx(5.0).epsilon(1e-6));
            CHECK(!world.raycast({5.0 * outer[2] + 4.0 * outer[0], -outer[2]}));
        }
    }

    TEST_CASE("normals of contacts with meshes are of unit length, however floats have rounded the boxes' axes") {
        oracle::NearMisses random(23);
        World world({.mesh_depth = true});
        const MeshHandle mesh = world.add_mesh(described(cube_mesh())).value();
        const auto turned = [&] {
            return glm::mat3_cast(
                glm::dquat(glm::dvec3(random.number(0, 6), random.number(0, 6), random.number(0, 6))));
        };
        for (int i = 0; i < 60; ++i) {
            const glm::dvec3 place = 3.0 * random.direction();
            if (i % 3 == 0) {
                REQUIRE(world.add({.mesh = mesh, .transform = at(place, turned())}).has_value());
            } else if (i % 3 == 1) {
                REQUIRE(world.add({.bound = Sphere{place, 0.6}}).has_value());
            } else {
                REQUIRE(world.add({.bound = Obb{place, glm::mat3(turned()), {0.5f, 0.7f, 0.3f}}}).has_value());
            }
        }
        REQUIRE(world.update().has_value());
        std::size_t normals = 0;
        for (const Contact& contact : world.contacts()) {
            if (contact.normal != glm::dvec3(0.0)) CHECK(std::abs(glm::length(contact.normal) - 1.0) < 1e-15);
            for (const mesh::MeshContact& touch : contact.triangles)
                if (touch.normal != glm::dvec3(0.0)) CHECK(std::abs(glm::length(touch.normal) - 1.0) < 1e-14);
            normals += 1 + contact.triangles.size();
        }
        CHECK(normals > 100);
    }
}
