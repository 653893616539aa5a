// SPDX-License-Identifier: MIT
// Objects with meshes, under nodes and by themselves.
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <cmath>
#include <error_of.hpp>

#include "cubes.hpp"

using namespace crofton;
using namespace crofton::testing;

TEST_SUITE("world/meshes") {
    TEST_CASE("meshes, nodes and transforms that are none are refused with a reason, and spoil nothing") {
        World world;
        const TriangleMesh box = cube_mesh();
        const auto mesh = world.add_mesh(described(box)).value();
        const auto node = world.add_node().value();
        const auto good = world.add({.mesh = mesh, .transform = at({})}).value();
        CHECK(error_of(world.add_mesh({})).code == ErrorCode::empty);
        TriangleMesh bad = box;
        bad.indices[5] = 8;
        CHECK(error_of(world.add_mesh(described(bad))).code == ErrorCode::out_of_range);
        CHECK(error_of(world.replace_mesh(mesh, described(bad))).code == ErrorCode::out_of_range);
        bad = box;
        bad.positions[3].y = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(world.add_mesh(described(bad))).item == 3);
        CHECK_FALSE(world.set_vertices(mesh, bad.positions).has_value());
        CHECK(error_of(world.set_vertices(mesh, std::vector<glm::vec3>(7))).code == ErrorCode::invalid_argument);
        for (const double number : {kNan, kInfinity, 1e16}) {
            CHECK_FALSE(world.add_node({.transform = at({number, 0.0, 0.0})}).has_value());
            CHECK_FALSE(world.add({.mesh = mesh, .transform = at({}, glm::dmat3(number))}).has_value());
            CHECK_FALSE(world.set_transform(node, at({0.0, number, 0.0})).has_value());
            CHECK(error_of(world.set_transform(good, at({0.0, number, 0.0}))).item == good.index);
        }
        CHECK(error_of(world.add({.mesh = mesh, .bound = Sphere{{}, 1.0}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.add({.node = node, .bound = Sphere{{}, 1.0}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_bound(good, Sphere{{}, 1.0})).code == ErrorCode::invalid_argument);
        const auto on_node = world.add({.mesh = mesh, .node = node}).value();
        CHECK(error_of(world.set_transform(on_node, at({}))).code == ErrorCode::invalid_argument);
        const auto bound = world.add({.bound = Sphere{{0.0, 0.0, 20.0}, 1.0}}).value();
        CHECK(error_of(world.set_transform(bound, at({}))).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.set_mesh(bound, mesh)).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.transform_of(bound)).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.remove(mesh)).code == ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        CHECK(world.object_count() == 3);
        CHECK(world.transform_of(good)->translation == glm::dvec3(0.0));
        CHECK(seen(world) == 3);
    }

    TEST_CASE("a mesh has the box that is known of it, and one that does not contain it is refused by the vertex") {
        const TriangleMesh cube = testing::box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        Obb wide, narrow;
        wide.half_extents = glm::vec3(2.0f, 1.0f, 1.0f);
        narrow.half_extents = glm::vec3(1.0f, std::nextafter(1.0f, 0.0f), 1.0f);
        Obb bad = wide;
        bad.half_extents.x = -1.0f;
        const auto described = [&](const Obb* box) {
            return MeshDescription{.positions = cube.positions, .indices = cube.indices, .box = box};
        };
        World world;
        const MeshHandle mesh = world.add_mesh(described(&wide)).value();
        const ObjectHandle object = world.add({.mesh = mesh}).value();
        const auto longest = [&] {
            const glm::vec3 half = world.box_of(object)->half_extents;
            return std::max({half.x, half.y, half.z});
        };
        world.update().value();
        CHECK(longest() == doctest::Approx(2.0));
        for (const auto& refused :
             {world.replace_mesh(mesh, described(&narrow)), world.replace_mesh(mesh, described(&bad))})
            CHECK(error_of(refused).code == ErrorCode::invalid_argument);
        CHECK(error_of(world.add_mesh(described(&narrow))).item == 0);
        CHECK(error_of(world.add_mesh(described(&narrow))).message.find("vertex 0") != std::string::npos);
        world.update().value();
        CHECK(longest() == doctest::Approx(2.0));
        REQUIRE(world.replace_mesh(mesh, described(nullptr)));
        world.update().value();
        CHECK(longest() == doctest::Approx(1.0));
    }

    TEST_CASE("inputs of either precision and width are read where they are") {
        struct Vertex {
            char color[3];
            float place[3];
        };
        const TriangleMesh box = cube_mesh();
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
        const auto mesh = world.add_mesh(described(cube_mesh())).value();
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
        CHECK(error_of(world.set_parent(ship, arm)).code == ErrorCode::invalid_argument);
        REQUIRE(world.set_parent(arm, {}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.box_of(hand)->center == glm::dvec3(0.0, 5.0, 4.0));
        REQUIRE(world.set_parent(arm, ship).has_value());
        REQUIRE(world.set_layers(ship, 2).has_value());
        REQUIRE(world.set_layers(hull, 6).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.raycast(down(0.0, 0.0), {4}));
        CHECK(world.raycast(down(0.0, 0.0), {2})->object == hull);
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
        CHECK(error_of(world.remove(ship)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.set_transform(arm, at({}))).code == ErrorCode::stale_handle);
        CHECK(error_of(world.add({.mesh = mesh, .node = arm})).code == ErrorCode::stale_handle);
        CHECK(error_of(world.add_node({.parent = arm})).code == ErrorCode::stale_handle);
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
        CHECK(error_of(world.add({.mesh = mesh, .node = later})).code == ErrorCode::stale_handle);
        CHECK(error_of(world.set_vertices(mesh, cube_mesh().positions)).code == ErrorCode::stale_handle);
        REQUIRE(world.update().has_value());
        CHECK(seen(world) == 0);
    }

    TEST_CASE("meshes are exchanged, replaced and deformed, and rays and boxes follow") {
        World world;
        TriangleMesh box = cube_mesh(), large = cube_mesh();
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
        const auto mesh = world.add_mesh(described(cube_mesh())).value();
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

    TEST_CASE("an object has no transform to the world before its first update, also where its node was another's") {
        World world;
        const auto mesh = world.add_mesh(described(cube_mesh())).value();
        const auto old = world.add({.mesh = mesh, .transform = at({5.0, 0.0, 0.0})}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.transform_of(old)->translation.x == 5.0);
        REQUIRE(world.remove(old).has_value());
        const auto fresh = world.add({.mesh = mesh, .transform = at({7.0, 0.0, 0.0})}).value();
        CHECK(error_of(world.transform_of(fresh)).code == ErrorCode::empty);
        REQUIRE(world.set_hidden(fresh, true).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.transform_of(fresh)->translation.x == 7.0);
    }

    TEST_CASE("a large mesh is built by all threads, small ones side by side, and answers are the same") {
        // Serial, but says that it has four threads. Counts the calls for more than one mesh or part.
        class FourThreads final : public Executor {
          public:
            [[nodiscard]] unsigned concurrency() const override { return 4; }
            void parallel_for(std::size_t count, std::size_t grain, RangeTask task) override {
                calls += count > grain ? 1 : 0;
                for (std::size_t begin = 0; begin < count; begin += grain)
                    task(begin, std::min(begin + grain, count), static_cast<unsigned>(begin / grain % 4));
            }
            std::size_t calls = 0;
        };
        TriangleMesh hills;
        constexpr std::uint32_t kSide = 150;
        for (std::uint32_t z = 0; z <= kSide; ++z)
            for (std::uint32_t x = 0; x <= kSide; ++x)
                hills.positions.push_back({0.1f * static_cast<float>(x),
                                           std::sin(0.3f * static_cast<float>(x * z % 97)),
                                           0.1f * static_cast<float>(z)});
        for (std::uint32_t z = 0; z < kSide; ++z)
            for (std::uint32_t x = 0; x < kSide; ++x) {
                const std::uint32_t a = z * (kSide + 1) + x, c = a + kSide + 1;
                for (const std::uint32_t corner : {a, c, a + 1, a + 1, c, c + 1}) hills.indices.push_back(corner);
            }
        const TriangleMesh cube = cube_mesh();
        const auto update = [&](World& world, Executor& executor, std::initializer_list<const TriangleMesh*> meshes) {
            for (const TriangleMesh* mesh : meshes) {
                const MeshHandle handle = world.add_mesh(described(*mesh)).value();
                const double x = 20.0 * static_cast<double>(world.object_count());
                REQUIRE(world.add({.mesh = handle, .transform = at({x, 0.0, 0.0})}).has_value());
                REQUIRE(world.add({.mesh = handle, .transform = at({x + 0.3, 0.2, 0.1})}).has_value());
            }
            REQUIRE(world.update(executor).has_value());
        };
        FourThreads few, many;
        World small, large, serial;
        update(small, few, {&cube});
        update(large, many, {&cube, &hills, &cube});
        CHECK(many.calls > few.calls + 1);
        ThreadPool pool(3);
        World threaded;
        update(threaded, pool, {&cube, &hills, &cube});
        update(serial, serial_executor(), {&cube, &hills, &cube});
        for (World* other : {&large, &threaded}) {
            REQUIRE(other->contacts().size() == serial.contacts().size());
            for (std::size_t i = 0; i < serial.contacts().size(); ++i) {
                CHECK(other->contacts()[i].triangles.size() == serial.contacts()[i].triangles.size());
                CHECK(other->contacts()[i].points.size() == serial.contacts()[i].points.size());
            }
            for (int n = 0; n < 200; ++n) {
                const Ray ray{{40.0 + 0.07 * n, 9.0, 0.07 * n}, {0.01 * n - 1.0, -5.0, 0.3}};
                const auto a = other->raycast(ray), b = serial.raycast(ray);
                REQUIRE(a.has_value() == b.has_value());
                if (a) CHECK((a->t == b->t && a->normal == b->normal && a->object.index == b->object.index));
            }
        }
    }
}
