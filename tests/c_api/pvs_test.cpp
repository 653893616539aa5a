// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/crofton.hpp>
#include <crofton/pvs/pvs.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

using SetsHandle = Owned<crofton_pvs, crofton_pvs_destroy>;

// A wall between the eyes' one cell and the second of two boxes; object 3 has no triangles, as it moves.
const crofton::Aabb kPvsBoxes[] = {{{-60.0, -40.0, -10.5}, {60.0, 40.0, -9.5}},
                                   {{-0.5, 0.5, -5.5}, {0.5, 1.5, -4.5}},
                                   {{-0.5, 0.5, -15.5}, {0.5, 1.5, -14.5}},
                                   {{1.5, 0.5, -15.5}, {2.5, 1.5, -14.5}}};

std::string file_of_sets() {
    using namespace crofton;
    pvs::BakeGeometry geometry;
    for (std::uint32_t o = 0; o < 4; ++o) {
        geometry.boxes.push_back(obb_of(kPvsBoxes[o]));
        if (o == 3) continue;
        const auto first = static_cast<std::uint32_t>(geometry.mesh.positions.size());
        for (const glm::dvec3& p : corners(geometry.boxes[o])) geometry.mesh.positions.push_back(glm::vec3(p));
        for (const std::uint32_t i : {0u, 4u, 6u, 0u, 6u, 2u, 1u, 3u, 7u, 1u, 7u, 5u, 0u, 1u, 5u, 0u, 5u, 4u,
                                      2u, 6u, 7u, 2u, 7u, 3u, 0u, 2u, 3u, 0u, 3u, 1u, 4u, 5u, 7u, 4u, 7u, 6u})
            geometry.mesh.indices.push_back(first + i);
        geometry.object_of.insert(geometry.object_of.end(), 12, o);
    }
    const auto cells = pvs::Cells::grid({{-2.0, 0.0, -2.0}, {2.0, 2.0, 2.0}}, {1, 1, 1}).value();
    auto bake = pvs::Bake::create(geometry, cells, {.epsilon = 1e-2}).value();
    REQUIRE(bake.run().has_value());
    const auto bytes = pvs::Pvs::finish(bake).value().to_file().value();
    const std::string path = (std::filesystem::temp_directory_path() / "crofton_capi_pvs.crofton").string();
    REQUIRE(bake::write_file(path, bytes).has_value());
    return path;
}

std::vector<std::uint32_t> ids_in_view(const crofton_view_result* visible) {
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_view_result_ids(visible, &ids, &count, nullptr, nullptr) == CROFTON_OK);
    return {ids, ids + count};
}

}  // namespace

TEST_SUITE("capi/pvs") {
    TEST_CASE("a file of sets is opened, queried for an eye, and removes static objects behind a wall from a view") {
        const std::string path = file_of_sets();
        crofton_pvs* opened = nullptr;
        REQUIRE(crofton_pvs_open(path.c_str(), &opened) == CROFTON_OK);
        const SetsHandle sets(opened);
        std::filesystem::remove(path);
        std::size_t cells = 0, objects = 0;
        REQUIRE(crofton_pvs_counts(sets.get(), &cells, &objects) == CROFTON_OK);
        CHECK(cells == 1);
        CHECK(objects == 4);
        const double inside[3] = {0.0, 1.0, 0.0}, outside[3] = {0.0, 1.0, 50.0};
        std::uint32_t cell = 7;
        REQUIRE(crofton_pvs_find_cell(sets.get(), inside, &cell) == CROFTON_OK);
        CHECK(cell == 0);
        REQUIRE(crofton_pvs_find_cell(sets.get(), outside, &cell) == CROFTON_OK);
        CHECK(cell == CROFTON_PVS_NO_CELL);

        const WorldHandle world = make_world();
        for (const crofton::Aabb& box : kPvsBoxes) {
            crofton_bound bound{};
            bound.kind = CROFTON_BOUND_ALIGNED_BOX;
            for (int k = 0; k < 3; ++k) bound.min[k] = box.min[k], bound.max[k] = box.max[k];
            add_bound(world, bound);
        }
        for (int i = 0; i < 40; ++i) update(world);  // what is new counts as moving at first
        const ViewResultHandle visible = make_view_result();
        crofton_camera camera = crofton_default_camera();
        for (int k = 0; k < 3; ++k) camera.position[k] = inside[k];
        crofton_view_request request = request_of(camera);
        REQUIRE(crofton_world_view(world.get(), &request, 1, nullptr, visible.get()) == CROFTON_OK);
        CHECK(ids_in_view(visible.get()) == std::vector<std::uint32_t>{0, 1, 2, 3});
        REQUIRE(crofton_pvs_visible(sets.get(), inside, CROFTON_PVS_STATISTICAL, &request.candidate_mask,
                                    &request.candidate_words) == CROFTON_OK);
        REQUIRE(crofton_world_view(world.get(), &request, 1, nullptr, visible.get()) == CROFTON_OK);
        CHECK(ids_in_view(visible.get()) == std::vector<std::uint32_t>{0, 1, 3});
        // A caller compiled before there were sets.
        request.size = offsetof(crofton_view_request, candidate_mask);
        REQUIRE(crofton_world_view(world.get(), &request, 1, nullptr, visible.get()) == CROFTON_OK);
        CHECK(ids_in_view(visible.get()).size() == 4);
        // Without a cell everything is drawn.
        request.size = sizeof request;
        REQUIRE(crofton_pvs_visible(sets.get(), outside, CROFTON_PVS_CONSERVATIVE, &request.candidate_mask,
                                    &request.candidate_words) == CROFTON_OK);
        CHECK(request.candidate_mask == nullptr);
        CHECK(request.candidate_words == 0);
        REQUIRE(crofton_world_view(world.get(), &request, 1, nullptr, visible.get()) == CROFTON_OK);
        CHECK(ids_in_view(visible.get()).size() == 4);
    }

    TEST_CASE("sets are read from memory that starts anywhere, and a part of the file is refused") {
        const std::string path = file_of_sets();
        std::ifstream file(path, std::ios::binary);
        std::vector<char> bytes(1);  // so that the file does not start at a multiple of 64
        bytes.insert(bytes.end(), std::istreambuf_iterator<char>(file), {});
        std::filesystem::remove(path);
        const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data()) + 1;
        const std::size_t count = bytes.size() - 1;
        crofton_pvs* read = nullptr;
        for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, count / 2, count - 1})
            CHECK(crofton_pvs_read(first, cut, &read) == CROFTON_PARSE);
        CHECK(read == nullptr);
        CHECK(crofton_pvs_read(nullptr, count, &read) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_pvs_read(first, count, nullptr) == CROFTON_INVALID_ARGUMENT);
        REQUIRE(crofton_pvs_read(first, count, &read) == CROFTON_OK);
        const SetsHandle sets(read);
        bytes.assign(bytes.size(), 0);  // it was copied
        const double inside[3] = {0.0, 1.0, 0.0};
        const std::uint64_t* words = nullptr;
        std::size_t word_count = 0;
        REQUIRE(crofton_pvs_visible(sets.get(), inside, CROFTON_PVS_STATISTICAL, &words, &word_count) == CROFTON_OK);
        REQUIRE(word_count == 1);
        CHECK((words[0] & 0b0111) == 0b0011);
    }

    TEST_CASE("mistakes are reported by name") {
        crofton_pvs* opened = nullptr;
        CHECK(crofton_pvs_open("no_such_file.crofton", &opened) != CROFTON_OK);
        CHECK(crofton_pvs_open(nullptr, &opened) == CROFTON_INVALID_ARGUMENT);
        const std::string path = file_of_sets();
        CHECK(crofton_pvs_open(path.c_str(), nullptr) == CROFTON_INVALID_ARGUMENT);
        REQUIRE(crofton_pvs_open(path.c_str(), &opened) == CROFTON_OK);
        const SetsHandle sets(opened);
        std::filesystem::remove(path);
        const double eye[3] = {0.0, 1.0, 0.0}, nowhere[3] = {0.0, std::nan(""), 0.0};
        std::uint32_t cell = 0;
        const std::uint64_t* words = nullptr;
        std::size_t count = 0;
        CHECK(crofton_pvs_find_cell(sets.get(), nowhere, &cell) == CROFTON_NON_FINITE);
        CHECK(crofton_pvs_find_cell(sets.get(), nullptr, &cell) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_pvs_find_cell(sets.get(), eye, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_pvs_visible(sets.get(), eye, 2, &words, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_pvs_visible(sets.get(), eye, 0, nullptr, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_pvs_counts(nullptr, nullptr, nullptr) != CROFTON_OK);
        const ViewResultHandle visible = make_view_result();
        const WorldHandle world = make_world();
        crofton_camera camera = crofton_default_camera();
        crofton_view_request request = request_of(camera);
        request.candidate_words = 3;
        CHECK(crofton_world_view(world.get(), &request, 1, nullptr, visible.get()) == CROFTON_INVALID_ARGUMENT);
    }
}
