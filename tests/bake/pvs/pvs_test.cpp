// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/crofton.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstring>
#include <error_of.hpp>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

const Aabb kBounds{{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}};

Pvs baked(const BakeGeometry& geometry, const Cells& cells) {
    Bake bake = Bake::create(geometry, cells, {.epsilon = 1e-2, .confidence = 0.9}).value();
    REQUIRE(bake.run().has_value());
    std::vector<occlude::FoundOccluder> found;
    std::vector<PlacedOccluder> placed;
    for (const Obb& box : geometry.boxes) {
        occlude::FoundOccluder occluder;
        occluder.box = box;
        occluder.piece_bounds = aabb_of(box);
        found.push_back(occluder);
    }
    for (const auto& occluder : found) placed.push_back({&occluder, {}});
    return Pvs::finish(bake, placed).value();
}

void check_same(const Pvs& a, const Pvs& b) {
    REQUIRE(a.cells().size() == b.cells().size());
    REQUIRE(a.object_count() == b.object_count());
    CHECK(a.epsilon() == b.epsilon());
    CHECK(a.confidence() == b.confidence());
    CHECK(a.geometry_fingerprint() == b.geometry_fingerprint());
    for (std::size_t c = 0; c < a.cells().size(); ++c) {
        CHECK(a.cells().box(c).min == b.cells().box(c).min);
        CHECK(a.cells().box(c).max == b.cells().box(c).max);
        CHECK(a.cells().corners(c).corners == b.cells().corners(c).corners);
        CHECK(a.kind(c) == b.kind(c));
        for (const Mode mode : {Mode::conservative, Mode::statistical}) {
            const auto x = a.visible_from(static_cast<std::uint32_t>(c), mode);
            const auto y = b.visible_from(static_cast<std::uint32_t>(c), mode);
            CHECK(std::equal(x.begin(), x.end(), y.begin(), y.end()));
        }
    }
}

}  // namespace

TEST_SUITE("pvs/pvs") {
    TEST_CASE("a file returns the sets that were stored, of grids, boxes and convex cells, alone and with a scene") {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            BakeGeometry geometry = random_geometry(seed, 40 + static_cast<int>(seed) * 17);
            geometry.boxes.push_back(geometry.boxes[0]);  // one that moves
            std::vector<Aabb> boxes;
            for (int i = 0; i < 9; ++i) boxes.push_back(box_around({2.0 * i - 9.0, 1.0, 3.0}, glm::dvec3(1.2)));
            sampling::Random random(seed);
            std::vector<ConvexCell> convex;
            for (const Aabb& box : boxes) convex.push_back(random_cell(random, box.center(), 1.5));
            const Cells cells = seed == 1   ? Cells::grid(kBounds, {7, 2, 5}).value()
                                : seed == 2 ? Cells::boxes(boxes).value()
                                            : Cells::convex(convex).value();
            const Pvs pvs = baked(geometry, cells);
            const PairCounts counts = pvs.counts();
            std::uint64_t of_state[3] = {};
            for (std::uint32_t c = 0; c < pvs.cells().size(); ++c)
                for (std::uint32_t object = 0; object < pvs.object_count(); ++object)
                    if (pvs.kind(c) != CellKind::solid && pvs.is_baked(object))
                        ++of_state[static_cast<std::size_t>(pvs.state(c, object))];
            CHECK(counts.hidden == of_state[static_cast<std::size_t>(PairState::hidden)]);
            CHECK(counts.unseen == of_state[static_cast<std::size_t>(PairState::unseen)]);
            CHECK(counts.seen == of_state[static_cast<std::size_t>(PairState::seen)]);
            CHECK(counts.hidden > 0);
            CHECK(counts.unseen > 0);
            CHECK(counts.seen > 0);
            const auto file = pvs.to_file().value();
            check_same(pvs, Pvs::from_memory(file).value());
            CHECK(plain(Pvs::from_memory(file).value().to_file().value()) == plain(file));

            scene::Scene scene;
            const auto mesh = scene.add_mesh(geometry.mesh).value();
            const auto node = scene.add_node(scene::kNone, {}).value();
            REQUIRE(scene.add_instance(node, mesh).has_value());
            scene.update();
            const auto scene_file = bake::bake(scene).value();
            const auto together = pvs.to_file(scene_file).value();
            check_same(pvs, Pvs::from_memory(together).value());
            CHECK(bake::BakedScene::from_memory(together).value().instances().size() == 1);
            CHECK(error_of(pvs.to_file(together)).code == ErrorCode::invalid_argument);
            CHECK(error_of(Pvs::from_memory(scene_file)).code == ErrorCode::parse);
            CHECK_FALSE(pvs.to_file(std::span(scene_file).first(100)).has_value());
        }
    }

    TEST_CASE("damaged files are refused, forged ones read as something or refused") {
        bool convex = false;
        SUBCASE("grid") {}
        SUBCASE("convex cells") {
            convex = true;
        }
        sampling::Random random(1);
        std::vector<ConvexCell> few;
        for (int i = 0; i < 2; ++i) few.push_back(random_cell(random, {2.0 * i - 8.0, 1.0, 3.0}, 1.5));
        const Cells cells = convex ? Cells::convex(few).value() : Cells::grid(kBounds, {4, 1, 4}).value();
        const Pvs pvs = baked(random_geometry(1, 30), cells);
        const auto file = pvs.to_file().value();
        for (std::size_t at = 0; at < file.size(); at += 7) {
            Vector<std::byte> damaged = file;
            damaged[at] ^= std::byte{4};
            CHECK_FALSE(Pvs::from_memory(damaged).has_value());
        }
        const auto reader = bake::Reader::open(file).value();
        int refused = 0;
        for (const bake::Section& which : reader.sections())
            for (std::size_t at = 0; at < which.size; ++at)
                for (const std::byte value : {std::byte{0}, std::byte{0x7f}, std::byte{0xff}}) {
                    bake::Writer writer;
                    for (const bake::Section& section : reader.sections()) {
                        std::vector<std::byte> bytes(
                            file.begin() + static_cast<std::ptrdiff_t>(section.offset),
                            file.begin() + static_cast<std::ptrdiff_t>(section.offset + section.size));
                        if (&section == &which) bytes[at] = value;
                        const std::string_view name(section.name, 8);
                        writer.add_bytes(name.substr(0, name.find('\0')), bytes, section.element_size, section.version);
                    }
                    const auto forged = writer.finish();
                    const auto read = Pvs::from_memory(forged);
                    refused += !read.has_value();
                    if (read && read->object_count() > 0) (void)read->visible_from(0, Mode::statistical);
                }
        CHECK(refused > 50);
        CHECK(Pvs::open("/no/such/file.crofton").error().message.find("/no/such/file") != std::string::npos);
    }

    TEST_CASE("a small file that demands very many pairs is refused before the memory is allocated") {
        const Pvs pvs = baked(random_geometry(1, 30), Cells::grid(kBounds, {4, 1, 4}).value());
        const auto file = pvs.to_file().value();
        const std::uint64_t all = pvs.cells().size() * pvs.object_count();
        CHECK(Pvs::from_memory(file, {.pairs = all}).has_value());
        const auto error = error_of(Pvs::from_memory(file, {.pairs = all - 1}));
        CHECK(error.code == ErrorCode::out_of_range);
        CHECK(error.message.find("ReadLimits::pairs") != std::string::npos);
        // 2^21 cells and 1,000 objects in 2 MB, none of them seen from anywhere.
        const auto reader = bake::Reader::open(file).value();
        bake::Writer writer;
        for (const bake::Section& section : reader.sections()) {
            std::vector<std::byte> bytes(file.begin() + static_cast<std::ptrdiff_t>(section.offset),
                                         file.begin() + static_cast<std::ptrdiff_t>(section.offset + section.size));
            std::string_view name(section.name, 8);
            name = name.substr(0, name.find('\0'));
            const std::uint32_t counts[4] = {2048, 1, 1024, 1000};  // the last one: objects
            if (name == "pvs_head") std::memcpy(bytes.data() + 6 * sizeof(double), counts, sizeof counts);
            if (name == "pvs_kind") bytes.assign(1 << 21, std::byte{2});
            if (name == "pvs_from") bytes.assign(16 * sizeof(std::uint64_t), std::byte{0xff});
            if (name == "pvs_pair") bytes.assign(200'000, std::byte{0xff});
            writer.add_bytes(name, bytes, section.element_size, section.version);
        }
        const auto large = writer.finish();
        CHECK(error_of(Pvs::from_memory(large)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("states of neighbours that are alike take a small part of a bit") {
        // Two rooms: what cells of one see is the same but for the door.
        BakeGeometry geometry;
        add_box(geometry, {{-20.0, 0.0, -10.0}, {20.0, 4.0, 10.0}}, true);
        add_box(geometry, {{-0.5, 0.0, -10.0}, {0.5, 4.0, 10.0}});
        for (int i = 0; i < 200; ++i)
            add_box(geometry,
                    box_around({(i % 2 ? 1.0 : -1.0) * (2.0 + 0.17 * i / 2), 3.5, -9.0 + 0.09 * i}, glm::dvec3(0.05)));
        const Cells cells = Cells::grid({{-20.0, 0.0, -10.0}, {20.0, 3.0, 10.0}}, {40, 2, 20}).value();
        const Pvs pvs = baked(geometry, cells);
        const double bits = 8.0 * static_cast<double>(pvs.to_file().value().size());
        CHECK(bits / (1600.0 * 202.0) < 0.25);
    }

    TEST_CASE("a view keeps what its eye may see, what moves, and everything where no cell is") {
        const BakeGeometry geometry = random_geometry(6, 50);
        const Cells cells = Cells::grid(kBounds, {6, 1, 6}).value();
        const Pvs pvs = baked(geometry, cells);
        World world;
        for (const Obb& box : geometry.boxes) REQUIRE(world.add({.bound = box}).has_value());
        Obb mover;
        mover.center = {0.0, 1.0, 0.0};
        mover.half_extents = glm::vec3(0.1f);
        REQUIRE(world.add({.bound = mover}).has_value());
        REQUIRE(world.update().has_value());
        ViewResult visible;
        Vector<std::uint32_t> kept;
        sampling::Random random(1);
        std::size_t culled = 0;
        for (int i = 0; i < 200; ++i) {
            Camera camera;
            camera.position = sampling::box_point({{-12.0, 0.5, -12.0}, {12.0, 2.5, 12.0}}, random.point<3>());
            camera.forward = sampling::direction(random.point<2>());
            REQUIRE(world.view({.camera = camera}, visible).has_value());
            const std::uint32_t cell = pvs.keep_visible(camera.position, Mode::statistical, visible.ids(), kept);
            CHECK(cell == pvs.find_cell(camera.position));
            std::vector<std::uint32_t> expected;
            for (const std::uint32_t id : visible.ids())
                if (cell == kNoCell || id == 50 || pvs.state(cell, id) == PairState::seen) expected.push_back(id);
            CHECK(std::vector<std::uint32_t>(kept.begin(), kept.end()) == expected);
            culled += visible.size() - kept.size();
        }
        CHECK(culled > 100);
        CHECK(pvs.keep_visible({50.0, 0.0, 0.0}, Mode::conservative, visible.ids(), kept) == kNoCell);
        CHECK(kept.size() == visible.size());
    }

    TEST_CASE("a scene's instances are its objects, the moving ones left out") {
        scene::Scene scene;
        BakeGeometry shape;
        add_box(shape, box_around({}, glm::dvec3(1.0)));
        const auto mesh = scene.add_mesh(shape.mesh).value();
        for (int i = 0; i < 4; ++i) {
            glm::dmat3 linear(1.0);
            if (i == 1) linear[0][0] = -1.0;  // mirrored: still counter-clockwise from outside
            const auto node = scene.add_node(scene::kNone, {linear, {1e7 + 5.0 * i, 0.0, 0.0}}).value();
            REQUIRE(scene.add_instance(node, mesh).has_value());
        }
        REQUIRE(scene.remove_instance(3).has_value());
        CHECK(error_of(geometry_of(scene, std::vector<scene::InstanceId>{0, 1, 2})).code == ErrorCode::empty);
        scene.update();
        const std::vector<scene::InstanceId> moving = {2};
        const BakeGeometry geometry = geometry_of(scene, moving).value();
        CHECK(geometry.object_of.size() == 24);
        CHECK(geometry.boxes.size() == 4);
        CHECK(geometry.origin.x > 0.9e7);
        for (std::size_t t = 0; t < 24; ++t) {
            glm::dvec3 corner[3];
            for (std::size_t k = 0; k < 3; ++k)
                corner[k] = geometry.origin + glm::dvec3(geometry.mesh.positions[geometry.mesh.indices[3 * t + k]]);
            const glm::dvec3 center = scene.world_boxes()[geometry.object_of[t]].center;
            CHECK(glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), corner[0] - center) > 0.0);
        }
        CHECK(error_of(geometry_of(scene, std::vector<scene::InstanceId>{0, 1, 2})).code == ErrorCode::empty);
    }

    TEST_CASE("sets say of which triangles they are") {
        const BakeGeometry geometry = random_geometry(3, 20);
        const Pvs pvs = baked(geometry, Cells::grid(kBounds, {2, 1, 2}).value());
        CHECK(pvs.geometry_fingerprint() == fingerprint_of(geometry));
        BakeGeometry moved = geometry, other = geometry, whose = geometry, away = geometry, boxes = geometry;
        moved.mesh.positions[7].y += 1e-6f;
        std::swap(other.mesh.indices[3], other.mesh.indices[4]);
        std::swap(whose.object_of.front(), whose.object_of.back());
        away.origin.x += 1.0;
        boxes.boxes[0].half_extents.x += 1.0f;
        for (const BakeGeometry* changed : {&moved, &other, &whose, &away})
            CHECK(pvs.geometry_fingerprint() != fingerprint_of(*changed));
        CHECK(pvs.geometry_fingerprint() == fingerprint_of(boxes));
    }
}
