// SPDX-License-Identifier: MIT
// Objects of regions with meshes: what they hide, the triangles that pictures list, and what is refused.
#include <doctest/doctest.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <limits>
#include <map>
#include <thread>
#include <vector>

#include "box_at.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using oracle::NearMisses;
using testing::box_at;

namespace {

const TriangleMesh& house() {
    static const TriangleMesh kHouse = testing::cuboid({4.0f, 6.0f, 5.0f});
    return kHouse;
}

std::vector<RegionMesh> town_meshes() {
    static const TriangleMesh kTower = testing::cuboid({3.0f, 9.0f, 3.0f});
    std::vector<RegionMesh> meshes;
    for (const TriangleMesh* mesh : {&house(), &kTower}) {
        meshes.push_back({.mesh = testing::description_of(*mesh, true)});
        meshes.back().mesh.clusters = true;
        meshes.back().mesh.one_sided = true;
    }
    return meshes;
}

// Houses, some of which are drawn transparent or only hide, and small things between them.
std::vector<RegionObject> town_objects(NearMisses& random, std::size_t houses, std::size_t things) {
    std::vector<RegionObject> objects;
    for (std::size_t i = 0; i < houses; ++i) {
        RegionObject object{.user = i};
        object.mesh = random.index(2);
        object.transform = testing::Town::place(random);
        const double x = random.number(0.0, 120.0), z = random.number(0.0, 120.0);
        object.transform.translation += glm::dvec3(x, 0.0, z);
        if (random.index(6) == 0) object.transform.linear[0] *= -1.0;
        object.occludes = random.index(5) != 0;
        object.only_occludes = random.index(8) == 0;
        if (random.index(6) == 0) object.layers = 1u << random.index(2);
        objects.push_back(object);
    }
    for (std::size_t i = 0; i < things; ++i) {
        const double x = random.number(-20.0, 140.0), y = random.number(-3.0, 3.0), z = random.number(-20.0, 140.0);
        objects.push_back({.bound = box_at({x, y, z}, 0.4f), .user = houses + i});
    }
    return objects;
}

// A World with regions, and one with each of their objects by itself; users are numbers that are the same in both.
struct Pair {
    World with{{.pairs = false}}, single{{.pairs = false}};
    std::vector<MeshHandle> meshes;
    std::map<RegionHandle, std::vector<ObjectHandle>> singles;
    std::map<RegionHandle, std::vector<std::uint64_t>> numbers;
    std::uint64_t next = 0;

    explicit Pair(const std::vector<RegionMesh>& of_regions) {
        for (const RegionMesh& mesh : of_regions) meshes.push_back(single.add_mesh(mesh.mesh).value());
    }
    RegionHandle attach(const Region& region, const std::vector<RegionObject>& objects, const glm::dvec3& origin) {
        const RegionHandle handle = with.attach(region, origin).value();
        for (const RegionObject& object : objects) {
            ObjectDescription description{.user = next,
                                          .layers = object.layers,
                                          .occludes = object.occludes,
                                          .only_occludes = object.only_occludes};
            numbers[handle].push_back(next++);
            if (object.mesh != kNoIndex) {
                description.mesh = meshes[object.mesh];
                description.transform = object.transform;
                description.transform->translation += origin;
            } else {
                description.bound = object.bound;
                description.bound.box.center += origin;
            }
            singles[handle].push_back(single.add(description).value());
        }
        return handle;
    }
    void detach(RegionHandle handle) {
        with.detach(handle).value();
        for (const ObjectHandle object : singles.at(handle)) single.remove(object).value();
        singles.erase(handle);
    }
    void update() {
        single.update().value();
        do with.update().value();
        while (with.statistics().occluders_waiting > 0);
    }
    [[nodiscard]] std::uint64_t number(const ObjectRef& ref) const {
        const RegionPlace place = with.place_of(ref.object).value();
        return numbers.at(place.region)[place.index];
    }
    [[nodiscard]] std::vector<std::uint64_t> numbers_with(const ViewResult& visible,
                                                          std::span<const std::uint32_t> ids) const {
        std::vector<std::uint64_t> result;
        for (const std::uint32_t id : ids) result.push_back(number(visible.ref(id)));
        std::sort(result.begin(), result.end());
        return result;
    }
    [[nodiscard]] static std::vector<std::uint64_t> users(const ViewResult& visible,
                                                          std::span<const std::uint32_t> ids) {
        std::vector<std::uint64_t> result;
        for (const std::uint32_t id : ids) result.push_back(visible.ref(id).user);
        std::sort(result.begin(), result.end());
        return result;
    }
};

Camera camera_in(NearMisses& random, const glm::dvec3& far) {
    Camera camera;
    const double x = random.number(-20.0, 140.0), y = random.number(-2.0, 4.0), z = random.number(-20.0, 140.0);
    camera.position = far + glm::dvec3(x, y, z);
    const double u = random.number(-1.0, 1.0), v = random.number(-0.2, 0.2), w = random.number(-1.0, 1.0);
    camera.forward = {u, v, w};
    camera.far_distance = 400.0;
    return camera;
}

}  // namespace

TEST_SUITE("world/region_solids") {
    TEST_CASE("houses of regions hide what stands behind them, as if each had been added by itself") {
        for (const glm::dvec3 far : {glm::dvec3(0.0), glm::dvec3(1e7 + 0.1, -2e6, 3e6 + 0.3)}) {
            NearMisses random(91);
            const auto meshes = town_meshes();
            Pair worlds(meshes);
            std::vector<std::vector<RegionObject>> objects;
            std::vector<Region> regions;
            for (const std::size_t houses : {20u, 7u, 0u}) {
                objects.push_back(town_objects(random, houses, 300));
                regions.push_back(Region::prepare(objects.back(), {.meshes = meshes}).value());
            }
            std::size_t hidden = 0, named = 0;
            ViewResult found, expected;
            for (int step = 0; step < 40; ++step) {
                if (worlds.singles.size() < 5) {
                    const std::size_t which = random.index(3);
                    const double x = random.number(-20.0, 20.0), z = random.number(-20.0, 20.0);
                    worlds.attach(regions[which], objects[which], far + glm::dvec3(x, 0.0, z));
                } else {
                    worlds.detach(worlds.singles.begin()->first);
                }
                const auto some = worlds.singles.begin();
                if (step % 2 != 0 && some != worlds.singles.end()) {
                    const std::uint32_t place = random.index(static_cast<unsigned>(some->second.size()));
                    const bool is_hidden = random.index(3) != 0;
                    worlds.with.set_hidden(worlds.with.object_in(some->first, place % 7).value(), is_hidden).value();
                    worlds.single.set_hidden(some->second[place % 7], is_hidden).value();
                }
                worlds.update();
                for (int v = 0; v < 6; ++v) {
                    const Camera camera = camera_in(random, far);
                    ViewRequest request{.camera = camera,
                                        .layers = random.index(3) ? ~0u : 1u,
                                        .occlusion = OcclusionOptions{
                                            .max_occluders = 100000, .least_cover = 0.0f, .list_occluded = true}};
                    cull::DrawLimits limits;
                    limits.eye = camera.position;
                    limits.max_distance_in_radii = 30.0;
                    if (v == 5) request.limits = &limits;
                    worlds.with.view(request, found).value();
                    worlds.single.view(request, expected).value();
                    CHECK(worlds.numbers_with(found, found.ids()) == Pair::users(expected, expected.ids()));
                    CHECK(worlds.numbers_with(found, found.occluded_ids()) ==
                          Pair::users(expected, expected.occluded_ids()));
                    CHECK(found.occlusion_statistics().drawn.pieces_drawn ==
                          expected.occlusion_statistics().drawn.pieces_drawn);
                    hidden += found.occluded_ids().size();
                    if (found.occluded_ids().empty()) continue;
                    // Who hides it: objects of regions, that have occluders.
                    Vector<OccluderRef> occluders, drawn;
                    const ObjectRef first = found.ref(found.occluded_ids()[0]);
                    worlds.with.hidden_by(first.object, found, occluders).value();
                    worlds.with.drawn_occluders(found, drawn).value();
                    for (const OccluderRef& occluder : occluders) {
                        CHECK(worlds.with.contains(occluder.object));
                        CHECK(occluder.user == worlds.with.user_of(occluder.object).value());
                        CHECK(std::any_of(drawn.begin(), drawn.end(), [&](const OccluderRef& other) {
                            return other.object == occluder.object && other.place == occluder.place;
                        }));
                        ++named;
                    }
                }
            }
            CHECK(hidden > 1000);
            CHECK(named > 100);
        }
    }

    TEST_CASE("many occluders come and go in small parts, and hide nothing once their region is detached") {
        const auto meshes = town_meshes();
        std::vector<RegionObject> objects;
        for (int i = 0; i < 2000; ++i) {
            RegionObject object{.mesh = static_cast<std::uint32_t>(i % 2)};
            object.transform = testing::at(10.0 * (i % 50), 0.0, -20.0 - 10.0 * (i / 50));
            objects.push_back(object);
        }
        const Region region = Region::prepare(objects, {.meshes = meshes}).value();
        World world({.pairs = false});
        const ObjectHandle thing = world.add({.bound = box_at({10.0, 0.0, -600.0}, 0.5f)}).value();
        world.update().value();
        Camera camera;
        camera.position = {10.0, 0.0, 10.0};
        camera.far_distance = 1000.0;
        const ViewRequest request{.camera = camera, .occlusion = OcclusionOptions{}};
        ViewResult visible;
        const auto sees_thing = [&] {
            world.view(request, visible).value();
            return visible.verdict_of(thing.index) != occlude::Verdict::outside &&
                   std::find(visible.ids().begin(), visible.ids().end(), thing.index) != visible.ids().end();
        };
        for (int round = 0; round < 3; ++round) {
            const RegionHandle handle = world.attach(region, glm::dvec3(0.0)).value();
            world.update().value();
            std::size_t waiting = world.statistics().occluders_waiting;
            CHECK(waiting > 1000);
            for (int i = 0; i < 20 && waiting > 0; ++i) {
                world.update().value();
                CHECK(world.statistics().occluders_waiting < waiting);
                waiting = world.statistics().occluders_waiting;
            }
            CHECK(waiting == 0);
            CHECK(!sees_thing());
            world.detach(handle).value();
            CHECK(sees_thing());
            world.update().value();
            CHECK(sees_thing());
            CHECK(visible.size() == 1);
            // Detached while some wait.
            const RegionHandle again = world.attach(region, glm::dvec3(0.0)).value();
            world.update().value();
            world.detach(again).value();
            world.update().value();
            CHECK(world.statistics().occluders_waiting == 0);
            CHECK(sees_thing());
        }
        for (int i = 0; i < 40; ++i) world.update().value();
        CHECK(sees_thing());
        CHECK(visible.occlusion_statistics().occluders_drawn == 0);
    }

    TEST_CASE("a picture lists the triangles of regions' meshes, and their objects hide, as if each were by itself") {
        for (const glm::dvec3 far : {glm::dvec3(0.0), glm::dvec3(1e6 + 0.25, 0.5, -1e6)}) {
            NearMisses random(92);
            const auto meshes = town_meshes();
            Pair worlds(meshes);
            const auto objects = town_objects(random, 40, 100);
            const Region region = Region::prepare(objects, {.meshes = meshes}).value();
            worlds.attach(region, objects, far);
            worlds.attach(region, objects, far + glm::dvec3(30.5, 0.0, -17.25));
            worlds.update();
            std::size_t triangles = 0;
            for (int v = 0; v < 30; ++v) {
                std::vector<ViewRequest> requests(3);
                for (ViewRequest& request : requests) {
                    request.camera = camera_in(random, far);
                    request.picture = depth::PictureView{.width = 320, .height = 180};
                }
                requests[2].picture = {};
                MultiViewResult many, many_expected;
                worlds.with.view(requests, many).value();
                worlds.single.view(requests, many_expected).value();
                using Listed = std::tuple<std::uint64_t, std::uint32_t, std::uint64_t>;
                const auto listed = [&](std::span<const depth::VisibleCluster> clusters, bool single,
                                        const ViewResult& visible) {
                    std::vector<Listed> result;
                    for (const depth::VisibleCluster& cluster : clusters) {
                        const ObjectRef ref = visible.ref(cluster.object);
                        result.emplace_back(single ? ref.user : worlds.number(ref), cluster.cluster,
                                            static_cast<std::uint64_t>(cluster.triangles));
                    }
                    std::sort(result.begin(), result.end());
                    return result;
                };
                std::map<std::uint64_t, std::uint32_t> masks, expected_masks;
                for (std::size_t i = 0; i < many.size(); ++i) masks[worlds.number(many[i])] = many.view_mask(i);
                for (std::size_t i = 0; i < many_expected.size(); ++i)
                    expected_masks[many_expected[i].user] = many_expected.view_mask(i);
                CHECK(masks == expected_masks);
                for (const auto order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
                    ViewRequest request = requests[0];
                    request.order = order;
                    ViewResult found, expected;
                    worlds.with.view(request, found).value();
                    worlds.single.view(request, expected).value();
                    CHECK(found.has_picture());
                    CHECK(worlds.numbers_with(found, found.ids()) == Pair::users(expected, expected.ids()));
                    CHECK(found.inside_count() == expected.inside_count());
                    const auto of_view = listed(found.triangles(), false, found);
                    CHECK(of_view == listed(expected.triangles(), true, expected));
                    CHECK(of_view == listed(many.triangles(0), false, found));
                    CHECK(found.picture_statistics().triangles_listed ==
                          expected.picture_statistics().triangles_listed);
                    for (const std::uint32_t id : found.ids()) CHECK(found.verdict_of(id) != occlude::Verdict::outside);
                    triangles += of_view.size();
                }
                CHECK(many.triangles(2).empty());
            }
            CHECK(triangles > 300);
        }
    }

    TEST_CASE("the box of an object with a mesh contains each vertex, at any origin up to the largest that was named") {
        NearMisses random(93);
        const auto meshes = town_meshes();
        for (const double most : {1.0, 1e5, 1e9, 1e12}) {
            std::vector<RegionObject> objects = town_objects(random, 60, 0);
            for (RegionObject& object : objects) {
                const double size = random.number(0.01, 2.0);
                object.transform.linear *= size;
            }
            const Region region = Region::prepare(objects, {.meshes = meshes, .max_origin = most}).value();
            World world({.pairs = false});
            for (int n = 0; n < 10; ++n) {
                const double x = random.number(-most, most), y = random.number(-most, most),
                             z = n == 0 ? most : random.number(-most, most);
                const glm::dvec3 origin(x, y, z);
                const RegionHandle handle = world.attach(region, origin).value();
                for (std::uint32_t i = 0; i < objects.size(); ++i) {
                    const ObjectHandle object = world.object_in(handle, i).value();
                    const Obb box = world.box_of(object).value();
                    const Transform transform = world.transform_of(object).value();
                    CHECK(transform.translation == objects[i].transform.translation + origin);
                    CHECK(transform.linear == objects[i].transform.linear);
                    // In long double, which rounds by a thousandth of what the box allows for.
                    for (const glm::vec3& vertex : house().positions) {
                        if (objects[i].mesh != 0) break;
                        for (int k = 0; k < 3; ++k) {
                            long double along = 0.0L, square = 0.0L;
                            for (int c = 0; c < 3; ++c) {
                                long double at = static_cast<long double>(transform.translation[c]) - box.center[c];
                                for (int j = 0; j < 3; ++j)
                                    at += static_cast<long double>(transform.linear[j][c]) * vertex[j];
                                along += at * box.axes[k][c];
                                square += static_cast<long double>(box.axes[k][c]) * box.axes[k][c];
                            }
                            CHECK(std::abs(along / square) <=
                                  static_cast<long double>(box.half_extents[k]) * 1.0000001L);
                        }
                    }
                }
                world.detach(handle).value();
                world.update().value();
            }
            const Error error = error_of(world.attach(region, {0.0, 1.001 * most, 0.0}));
            CHECK(error.code == ErrorCode::out_of_range);
        }
    }

    TEST_CASE("a region tells the mesh, the clusters and the occluders of its objects") {
        NearMisses random(94);
        const auto meshes = town_meshes();
        const auto objects = town_objects(random, 10, 3);
        const Region region = Region::prepare(objects, {.meshes = meshes}).value();
        World world;
        const MeshHandle single = world.add_mesh(meshes[0].mesh).value();
        for (std::uint32_t i = 0; i < objects.size(); ++i) CHECK(region.mesh_of(i) == objects[i].mesh);
        REQUIRE(region.clusters_of(0) != nullptr);
        const auto order = region.clusters_of(0)->triangle_order(),
                   expected = world.clusters_of(single)->triangle_order();
        CHECK(std::equal(order.begin(), order.end(), expected.begin(), expected.end()));
        CHECK(region.occluders_of(0).size() == world.occluders_of(single).size());
        CHECK(!region.occluders_of(0).empty());
        CHECK(region.clusters_of(2) == nullptr);
        CHECK(region.occluders_of(2).empty());
        CHECK(Region().clusters_of(0) == nullptr);
        // Occluders that were stored are those of the mesh.
        const std::span<const occlude::FoundOccluder> stored = region.occluders_of(0);
        RegionMesh with_stored{.mesh = testing::description_of(house(), false), .occluders = stored};
        const std::vector<RegionObject> one{{.mesh = 0}};
        const Region again = Region::prepare(one, {.meshes = {&with_stored, 1}}).value();
        CHECK(again.occluders_of(0).size() == stored.size());
        CHECK(again.clusters_of(0) == nullptr);
        CHECK(region.bytes() > again.bytes());
    }

    TEST_CASE("meshes, shapes and places that are wrong are refused when the region is prepared, by their places") {
        auto meshes = town_meshes();
        std::vector<RegionObject> objects(5, RegionObject{.bound = box_at(glm::dvec3(0.0))});
        const convex::Shape ball = convex::Shape::sphere(1.0).value();
        const convex::Shape ground = convex::Shape::half_space({{0.0, -1.0, 0.0}, 0.0}).value();
        const auto refused = [&](const RegionObject& object, ErrorCode code) {
            objects[3] = object;
            const Error error = error_of(Region::prepare(objects, {.meshes = meshes}));
            CHECK(error.code == code);
            CHECK(error.item == 3);
        };
        refused({.mesh = 2}, ErrorCode::invalid_argument);
        refused({.bound = box_at(glm::dvec3(0.0)), .mesh = 0}, ErrorCode::invalid_argument);
        refused({.bound = box_at(glm::dvec3(0.0)), .only_occludes = true}, ErrorCode::invalid_argument);
        refused({.shape = &ground}, ErrorCode::unsupported);
        refused({.bound = box_at(glm::dvec3(0.0)), .shape = &ground}, ErrorCode::unsupported);
        Transform flat;
        flat.linear[1] *= 0.5;
        refused({.shape = &ball, .transform = flat}, ErrorCode::unsupported);
        Transform bad;
        bad.translation.x = std::numeric_limits<double>::quiet_NaN();
        refused({.mesh = 0, .transform = bad}, ErrorCode::non_finite);
        objects.resize(3);
        meshes[1].mesh.positions = {};
        const Error mesh = error_of(Region::prepare(objects, {.meshes = meshes}));
        CHECK(mesh.item == 1);
        meshes = town_meshes();
        occlude::FoundOccluder occluder;
        occluder.box = box_at(glm::dvec3(0.0));
        occluder.box.half_extents.x = std::numeric_limits<float>::quiet_NaN();
        meshes[1].mesh.occluders = false;
        meshes[1].occluders = {&occluder, 1};
        const Error of_occluder = error_of(Region::prepare(objects, {.meshes = meshes}));
        CHECK(of_occluder.code == ErrorCode::non_finite);
        CHECK(of_occluder.item == 1);
        for (const double most : {-1.0, 1e30, std::numeric_limits<double>::quiet_NaN()})
            CHECK(error_of(Region::prepare(objects, {.max_origin = most})).code == ErrorCode::out_of_range);
    }

    TEST_CASE("a region with meshes outlives its World, its memory is returned, and warm queries allocate nothing") {
        {  // The mesh that stands for boxes in pictures is cut once in a program, and fits fill their tables once.
            NearMisses random(95);
            const auto meshes = town_meshes();
            CHECK(Region::prepare(town_objects(random, 50, 200), {.meshes = meshes}).has_value());
            World world;
            world.add({.bound = box_at({0.0, 0.0, -5.0}, 1.0f)}).value();
            world.update().value();
            ViewResult seen;
            world.view({.camera = Camera{}, .picture = depth::PictureView{64, 64}}, seen).value();
        }
        testing::CountingMemory memory;
        {
            NearMisses random(95);
            const auto meshes = town_meshes();
            auto objects = town_objects(random, 50, 200);
            const convex::Shape ball = convex::Shape::sphere(1.0).value();
            for (std::size_t i = 50; i < 100; ++i) objects[i].shape = &ball;
            Region region;
            {
                World world;
                region = Region::prepare(objects, {.meshes = meshes}).value();
                const ObjectHandle mover = world.add({.bound = box_at({20.0, 0.0, 20.0}, 5.0f)}).value();
                world.set_shape(mover, &ball).value();
                Camera camera;
                camera.position = {60.0, 1.0, -10.0};
                camera.forward = {0.0, 0.0, 1.0};
                camera.far_distance = 300.0;
                const ViewRequest hiding{.camera = camera, .occlusion = OcclusionOptions{}};
                ViewRequest picture{.camera = camera};
                picture.picture = depth::PictureView{.width = 160, .height = 90};
                ViewResult visible, drawn;
                Vector<ObjectHit> hits;
                Vector<ObjectRef> found;
                std::size_t before = 0;
                world.attach(region, glm::dvec3(0.0)).value();
                const RegionHandle second = world.attach(region, glm::dvec3(200.0, 0.0, 0.0)).value();
                for (int i = 0; i < 20; ++i) world.update().value();
                for (int round = 0; round < 3; ++round) {
                    if (round == 2) before = memory.allocations();
                    world.view(hiding, visible).value();
                    world.view(picture, drawn).value();
                    world.raycast_all({{-20.0, 1.0, 60.0}, {1.0, 0.0, 0.05}}, hits);
                    world.overlap(Sphere{{60.0, 0.0, 60.0}, 20.0}, found);
                    CHECK(world.closest(Sphere{{60.0, 0.0, 60.0}, 0.1}, 50.0).has_value());
                }
                CHECK(memory.allocations() == before);
                CHECK(!hits.empty());
                CHECK(visible.occlusion_statistics().occluders_drawn > 0);
                CHECK(!found.empty());
                CHECK(!drawn.triangles().empty());
                world.detach(second).value();
                world.update().value();
            }
            World other({.pairs = false});
            other.attach(region, glm::dvec3(0.0)).value();
            region = Region();
            other.update().value();
            CHECK(other.raycast({{-20.0, 1.0, 60.0}, {1.0, 0.0, 0.05}}).has_value());
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("many threads ask a World while others prepare, copy and free regions, and hear what one thread hears") {
        NearMisses random(96);
        const auto meshes = town_meshes();
        const auto objects = town_objects(random, 25, 150);
        const Region region = Region::prepare(objects, {.meshes = meshes}).value();
        const convex::Shape ball = convex::Shape::sphere(1.5).value();
        World world;
        std::vector<RegionHandle> attached;
        std::vector<ObjectHandle> movers;
        for (int i = 0; i < 10; ++i) {
            const double x = random.number(0.0, 120.0), z = random.number(0.0, 120.0);
            movers.push_back(world.add({.bound = box_at({x, 0.0, z}, 2.0f), .shape = i % 2 ? &ball : nullptr}).value());
        }
        std::atomic<bool> done{false};
        std::thread loader([&] {
            while (!done) {
                const Region prepared = Region::prepare(objects, {.meshes = meshes}).value();
                const Region copy = region;
                CHECK(copy.object_count() == prepared.object_count());
            }
        });
        for (int step = 0; step < 12; ++step) {
            const double x = random.number(-30.0, 30.0);
            attached.push_back(world.attach(region, {x, 0.0, 0.25 * x}).value());
            if (attached.size() > 3) {
                world.detach(attached.front()).value();
                attached.erase(attached.begin());
            }
            for (const ObjectHandle mover : movers) {
                const double y = random.number(-2.0, 2.0), z = random.number(0.0, 120.0);
                world.set_bound(mover, box_at({60.0 + y, y, z}, 2.0f)).value();
            }
            world.update().value();
            const Camera camera = camera_in(random, {});
            const ViewRequest hiding{.camera = camera, .occlusion = OcclusionOptions{}};
            ViewRequest picture{.camera = camera};
            picture.picture = depth::PictureView{.width = 64, .height = 36};
            const double u = random.number(-1.0, 1.0), w = random.number(-1.0, 1.0);
            const Ray ray{camera.position, {u, 0.02, w}};
            struct Heard {
                std::vector<std::uint32_t> seen, drawn, found;
                std::vector<double> hits;
                double nearest = 0.0;
                std::size_t contacts = 0;
            };
            const auto ask = [&](Heard& heard) {
                ViewResult visible;
                world.view(hiding, visible).value();
                heard.seen.assign(visible.ids().begin(), visible.ids().end());
                world.view(picture, visible).value();
                heard.drawn.assign(visible.ids().begin(), visible.ids().end());
                Vector<ObjectHit> hits;
                world.raycast_all(ray, hits);
                for (const ObjectHit& hit : hits) heard.hits.push_back(hit.t);
                Vector<ObjectRef> found;
                world.overlap(ball, {glm::dmat3(1.0), camera.position}, found);
                for (const ObjectRef& ref : found) heard.found.push_back(ref.object.index);
                if (const auto nearest = world.closest(Sphere{camera.position, 1.0}, 100.0))
                    heard.nearest = nearest->distance;
                heard.contacts = world.contacts().size();
            };
            Heard alone, heard[3];
            std::vector<std::thread> threads;
            for (Heard& one : heard) threads.emplace_back([&] { ask(one); });
            for (std::thread& thread : threads) thread.join();
            ask(alone);
            for (const Heard& one : heard) {
                CHECK(one.seen == alone.seen);
                CHECK(one.drawn == alone.drawn);
                CHECK(one.hits == alone.hits);
                CHECK(one.found == alone.found);
                CHECK(one.nearest == alone.nearest);
                CHECK(one.contacts == alone.contacts);
            }
        }
        done = true;
        loader.join();
    }
}
