// SPDX-License-Identifier: MIT
// Regions from baked files.
#include <algorithm>
#include <crofton/bake/region_files.hpp>
#include <crofton/crofton.hpp>
#include <crofton/scene/scene.hpp>
#include <filesystem>
#include <fstream>
#include <vector>

#include "../region_folder.hpp"
#include "world_fixture.hpp"

using namespace crofton::capi_test;
using crofton::testing::RegionFolder;

namespace {

using IndexHandle = Owned<crofton_region_index, crofton_region_index_destroy>;

// 12 × 12 tetrahedra on the ground, four metres apart.
crofton::scene::Scene field() {
    using namespace crofton;
    scene::Scene scene;
    const TriangleMesh tetrahedron{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                   .indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3},
                                   .colors = {}};
    const auto mesh = scene.add_mesh(tetrahedron).value();
    for (int i = 0; i < 144; ++i) {
        const Transform place{.translation = {4.0 * (i % 12), 0.0, 4.0 * (i / 12)}};
        static_cast<void>(scene.add_instance(scene.add_node(scene::kNone, place).value(), mesh).value());
    }
    scene.update();
    return scene;
}

IndexHandle opened(const std::string& folder) {
    crofton_region_index* index = nullptr;
    REQUIRE(crofton_region_index_open(folder.c_str(), &index) == CROFTON_OK);
    return IndexHandle(index);
}

std::vector<crofton_region_file> files_of(const IndexHandle& index) {
    const crofton_region_file* files = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_region_index_files(index.get(), &files, &count) == CROFTON_OK);
    return {files, files + count};
}

// User numbers of what rays straight down hit, over the whole field.
std::vector<std::uint64_t> hits_of(const WorldHandle& world) {
    std::vector<crofton_ray> rays;
    for (int i = 0; i < 144; ++i)
        rays.push_back({{4.0 * (i % 12) + 0.1, 5.0, 4.0 * (i / 12) + 0.1}, {0.0, -1.0, 0.0}, 100.0});
    std::vector<crofton_object_hit> hits(rays.size());
    REQUIRE(crofton_world_raycast(world.get(), rays.data(), rays.size(), nullptr, hits.data()) == CROFTON_OK);
    std::vector<std::uint64_t> users;
    for (const crofton_object_hit& hit : hits) users.push_back(hit.object.index == CROFTON_NONE ? ~0u : hit.user);
    return users;
}

}  // namespace

TEST_SUITE("capi/baked regions") {
    TEST_CASE("a folder of regions is opened by its index, and its regions answer as those that C++ opens") {
        const RegionFolder folder(field(), 3, 2);
        const IndexHandle index = opened(folder.path);
        const auto files = files_of(index);
        const auto expected = crofton::bake::open_region_index(folder.path).value();
        REQUIRE(files.size() == 6);
        REQUIRE(files.size() == expected.size());
        WorldHandle world = make_world();
        crofton::World theirs;
        std::uint64_t objects = 0;
        for (std::size_t i = 0; i < files.size(); ++i) {
            CHECK(files[i].name == expected[i].name);
            CHECK(files[i].objects == 24);
            CHECK(files[i].bytes == std::filesystem::file_size(folder.path + "/" + files[i].name));
            for (int k = 0; k < 3; ++k) {
                CHECK(files[i].origin[k] == expected[i].origin[k]);
                CHECK(files[i].min[k] == expected[i].bounds.min[k]);
                CHECK(files[i].max[k] == expected[i].bounds.max[k]);
            }
            crofton_region* prepared = nullptr;
            REQUIRE(crofton_region_index_prepare(index.get(), i, nullptr, nullptr, &prepared) == CROFTON_OK);
            const RegionOwner region(prepared);
            auto info = sized<crofton_region_info>();
            REQUIRE(crofton_region_get_info(region.get(), &info) == CROFTON_OK);
            CHECK(info.object_count == 24);
            CHECK(info.bytes > 0);
            const crofton::Region same = crofton::bake::open_region(folder.path, expected[i]).value();
            for (int k = 0; k < 3; ++k) {
                CHECK(info.min[k] == same.bounds().min[k]);
                CHECK(info.max[k] == same.bounds().max[k]);
            }
            std::uint32_t mesh = 7;
            REQUIRE(crofton_region_mesh_of(region.get(), 23, &mesh) == CROFTON_OK);
            CHECK(mesh == 0);
            CHECK(crofton_region_mesh_of(region.get(), 24, &mesh) == CROFTON_OUT_OF_RANGE);
            crofton_clusters clusters{};
            REQUIRE(crofton_region_clusters_of(region.get(), 0, &clusters) == CROFTON_OK);
            CHECK(clusters.triangle_count == 4);
            REQUIRE(clusters.cluster_count == 1);
            CHECK(clusters.clusters[0].triangle_count == 4);
            CHECK(crofton_region_clusters_of(region.get(), 1, &clusters) == CROFTON_EMPTY);
            crofton_attached_region attached{};
            REQUIRE(crofton_world_attach(world.get(), region.get(), files[i].origin, &attached) == CROFTON_OK);
            REQUIRE(theirs.attach(same, expected[i].origin).has_value());
            objects += info.object_count;
        }
        CHECK(objects == 144);
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        REQUIRE(theirs.update().has_value());
        const auto users = hits_of(world);
        CHECK(std::count(users.begin(), users.end(), ~0u) == 0);
        int i = 0;
        for (const std::uint64_t user : users) {
            const auto hit = theirs.raycast({{4.0 * (i % 12) + 0.1, 5.0, 4.0 * (i / 12) + 0.1}, {0.0, -1.0, 0.0}});
            REQUIRE(hit.has_value());
            CHECK(hit->user == user);
            ++i;
        }
    }

    TEST_CASE("one baked file is a region, its options do what their names say") {
        const RegionFolder folder(field(), 1, 1);
        const std::string path = folder.path + "/" + files_of(opened(folder.path)).front().name;
        crofton_baked_region_options options = crofton_default_baked_region_options();
        CHECK(options.triangles == 1);
        CHECK(options.occluders == 1);
        CHECK(options.trust_contents == 0);
        CHECK(options.max_origin == 1e9);
        const auto open = [&] {
            crofton_region* region = nullptr;
            REQUIRE(crofton_baked_region_open(path.c_str(), &options, nullptr, &region) == CROFTON_OK);
            return RegionOwner(region);
        };
        const auto hit_at = [&](const RegionOwner& region, std::uint32_t layers_of_probe) {
            WorldHandle world = make_world();
            const double origin[3] = {0.0, 0.0, 0.0};
            crofton_attached_region attached{};
            REQUIRE(crofton_world_attach(world.get(), region.get(), origin, &attached) == CROFTON_OK);
            auto info = sized<crofton_region_info>();
            REQUIRE(crofton_region_get_info(region.get(), &info) == CROFTON_OK);
            // A sphere of the world's own where the first object is.
            crofton_bound bound{};
            bound.kind = CROFTON_BOUND_SPHERE;
            std::copy_n(info.min, 3, bound.center);
            bound.radius = 0.5;
            crofton_object_description description = crofton_default_object_description();
            description.bound = &bound;
            description.layers = layers_of_probe;
            crofton_object own{};
            REQUIRE(crofton_world_add(world.get(), &description, &own) == CROFTON_OK);
            REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
            const crofton_object_pair* pairs = nullptr;
            std::size_t count = 0;
            REQUIRE(crofton_world_pairs(world.get(), &pairs, &count) == CROFTON_OK);
            // Past the slope of the tetrahedron, within its box.
            const crofton_ray ray{{info.min[0] + 0.9, 5.0, info.min[2] + 0.9}, {0.0, -1.0, 0.0}, 100.0};
            const crofton_query_filter all = crofton_default_query_filter();
            int hit = 0;
            REQUIRE(crofton_world_raycast_any(world.get(), &ray, &all, &hit) == CROFTON_OK);
            return std::pair(count, hit);
        };
        CHECK(hit_at(open(), 1) == std::pair(std::size_t{1}, 0));
        options.collides_with = 2;
        CHECK(hit_at(open(), 1) == std::pair(std::size_t{0}, 0));
        options.collides_with = ~0u;
        options.triangles = 0;
        CHECK(hit_at(open(), 1) == std::pair(std::size_t{1}, 1));
        options.trust_contents = 1;
        options.occluders = 0;
        CHECK(hit_at(open(), 1) == std::pair(std::size_t{1}, 1));
        crofton_region* none = nullptr;
        options.max_objects = 143;
        CHECK(crofton_baked_region_open(path.c_str(), &options, nullptr, &none) == CROFTON_OUT_OF_RANGE);
        options.max_objects = 144;
        options.max_origin = 1e3;
        const RegionOwner near = open();
        WorldHandle world = make_world();
        const double far[3] = {0.0, 0.0, 2e3};
        crofton_attached_region attached{};
        CHECK(crofton_world_attach(world.get(), near.get(), far, &attached) == CROFTON_OUT_OF_RANGE);
        options.size = 7;
        CHECK(crofton_baked_region_open(path.c_str(), &options, nullptr, &none) == CROFTON_WRONG_SIZE);
        CHECK(none == nullptr);
    }

    TEST_CASE("missing, damaged and exchanged files are reported by name") {
        const RegionFolder folder(field(), 2, 1);
        crofton_region_index* none = nullptr;
        CHECK(crofton_region_index_open("no_such_folder", &none) == CROFTON_IO);
        CHECK(std::string(crofton_last_error()).find("no_such_folder") != std::string::npos);
        CHECK(crofton_region_index_open(nullptr, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_region_index_open(folder.path.c_str(), nullptr) == CROFTON_INVALID_ARGUMENT);
        const IndexHandle index = opened(folder.path);
        const auto files = files_of(index);
        crofton_region* region = nullptr;
        CHECK(crofton_region_index_prepare(index.get(), 2, nullptr, nullptr, &region) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 2);
        CHECK(crofton_region_index_prepare(index.get(), 0, nullptr, nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_region_open(nullptr, nullptr, nullptr, &region) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_region_open("no_such_file.crofton", nullptr, nullptr, &region) == CROFTON_IO);
        const std::string path = folder.path + "/" + files[0].name;
        std::filesystem::resize_file(path, files[0].bytes - 1);
        CHECK(crofton_region_index_prepare(index.get(), 0, nullptr, nullptr, &region) == CROFTON_PARSE);
        CHECK(std::string(crofton_last_error()).find(files[0].name) != std::string::npos);
        CHECK(crofton_baked_region_open(path.c_str(), nullptr, nullptr, &region) == CROFTON_PARSE);
        std::filesystem::remove(path);
        CHECK(crofton_region_index_prepare(index.get(), 0, nullptr, nullptr, &region) == CROFTON_IO);
        std::ofstream(folder.path + "/index.crofton") << "no index";
        CHECK(crofton_region_index_open(folder.path.c_str(), &none) == CROFTON_PARSE);
        CHECK(none == nullptr);
        CHECK(region == nullptr);
    }
}
