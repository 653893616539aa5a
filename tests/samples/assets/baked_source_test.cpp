// SPDX-License-Identifier: MIT
// What a .crofton file keeps of the scene that it was baked of.
#include <doctest/doctest.h>
#include <algorithm>
#include <assets/baked_source.hpp>
#include <assets/scene_source.hpp>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <limits>

#include "gltf_asset.hpp"
#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::Asset;
using test_files::TemporaryFile;

namespace {

std::string text_of(const Vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<assets::SceneSource> through_a_file(const assets::SceneSource& source, bake::BakeOptions options = {}) {
    const auto bytes = assets::bake_source(source, serial_executor(), options);
    if (!bytes) return bytes.error();
    const TemporaryFile file("baked.crofton", text_of(*bytes));
    return assets::load_scene(file.path());
}

// Flags beyond the end of a list are 0.
void check_same_flags(std::vector<std::uint8_t> a, std::vector<std::uint8_t> b) {
    a.resize(std::max(a.size(), b.size()));
    b.resize(a.size());
    CHECK(a == b);
}

bool same(const assets::Room& a, const assets::Room& b) {
    return a.corners == b.corners && a.floor == b.floor && a.ceiling == b.ceiling && a.is_wall == b.is_wall &&
           a.has_floor == b.has_floor && a.has_ceiling == b.has_ceiling;
}

// All that a picture, a camera path, light and cells are made of.
void check_same_source(const assets::SceneSource& a, const assets::SceneSource& b) {
    REQUIRE(a.scene.mesh_count() == b.scene.mesh_count());
    for (scene::MeshId m = 0; m < a.scene.mesh_count(); ++m) {
        CHECK(a.scene.mesh(m).positions == b.scene.mesh(m).positions);
        CHECK(a.scene.mesh(m).indices == b.scene.mesh(m).indices);
        CHECK(a.scene.mesh(m).colors == b.scene.mesh(m).colors);
        CHECK(a.scene.mesh_name(m) == b.scene.mesh_name(m));
        REQUIRE((a.scene.polygon(m) != nullptr) == (b.scene.polygon(m) != nullptr));
        if (a.scene.polygon(m) == nullptr) continue;
        CHECK(a.scene.polygon(m)->polygon.points == b.scene.polygon(m)->polygon.points);
        CHECK(a.scene.polygon(m)->color == b.scene.polygon(m)->color);
    }
    REQUIRE(a.scene.instance_count() == b.scene.instance_count());
    for (scene::InstanceId i = 0; i < a.scene.instance_count(); ++i) {
        const Transform &p = a.scene.world(a.scene.node_of(i)), &q = b.scene.world(b.scene.node_of(i));
        CHECK(a.scene.mesh_of(i) == b.scene.mesh_of(i));
        CHECK(p.linear == q.linear);
        CHECK(p.translation == q.translation);
        CHECK(a.scene.layer_masks()[i] == b.scene.layer_masks()[i]);
    }
    CHECK(a.unit == b.unit);
    CHECK(a.walk == b.walk);
    CHECK(std::equal(a.rooms.begin(), a.rooms.end(), b.rooms.begin(), b.rooms.end(), same));
    check_same_flags(a.flat, b.flat);
    check_same_flags(a.one_sided, b.one_sided);
    check_same_flags(a.unlit, b.unlit);
    CHECK(a.unlit.empty() == b.unlit.empty());  // haze
    for (std::size_t m = 0; m < std::max(a.emission.size(), b.emission.size()); ++m)
        CHECK((m < a.emission.size() ? a.emission[m] : std::vector<glm::vec3>()) ==
              (m < b.emission.size() ? b.emission[m] : std::vector<glm::vec3>()));
}

void check_kept(const std::string& path) {
    CAPTURE(path);
    auto source = assets::load_scene(path);
    REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
    source->scene.update();
    auto baked = through_a_file(*source);
    REQUIRE_MESSAGE(baked.has_value(), test_files::message(baked));
    baked->scene.update();
    check_same_source(*source, *baked);
    // Once more: what was baked of a baked scene is the same.
    auto again = through_a_file(*baked).value();
    again.scene.update();
    check_same_source(*source, again);
}

// Five primitives of one wedge: flat and one-sided, smooth, two-sided, unlit, mirrored and glowing.
Asset looks() {
    Asset asset;
    const std::size_t positions =
        asset.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 1, 1, 0}, "VEC3");
    const std::size_t indices =
        asset.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3, 0, 4, 5, 0, 5, 1}, "SCALAR");
    asset.mesh(positions, indices);
    asset.mesh(positions, indices)["attributes"]["NORMAL"] = positions;
    asset.mesh(positions, indices)["material"] = 0;
    asset.mesh(positions, indices)["material"] = 1;
    asset.mesh(positions, indices)["material"] = 2;
    asset.root["materials"] = {{{"doubleSided", true}},
                               {{"extensions", {{"KHR_materials_unlit", test_files::Json::object()}}}},
                               {{"emissiveFactor", {1.0, 0.5, 0.0}}, {"doubleSided", true}}};
    asset.root["nodes"] = test_files::Json::array();
    asset.root["scenes"][0]["nodes"] = test_files::Json::array();
    for (std::size_t i = 0; i < 5; ++i) {
        asset.root["nodes"].push_back({{"mesh", i}, {"translation", {2.0 * static_cast<double>(i), 0.0, 0.0}}});
        asset.root["scenes"][0]["nodes"].push_back(i);
    }
    asset.root["nodes"][4]["scale"] = {-1.0, 1.0, 1.0};
    return asset;
}

}  // namespace

TEST_SUITE("assets/baked_source") {
    TEST_CASE("a baked glTF keeps which meshes are flat, one-sided, unlit and glow, and that lengths are metres") {
        const TemporaryFile file("looks.glb", looks().glb());
        const auto source = assets::load_scene(file.path());
        REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
        // By the format: without NORMAL flat, without doubleSided one-sided.
        check_same_flags(source->flat, {1, 0, 1, 1, 1});
        check_same_flags(source->one_sided, {1, 1, 0, 1, 0});
        check_same_flags(source->unlit, {0, 0, 0, 1, 0});
        CHECK(source->unit == 1.0);
        CHECK(source->emission.size() == 5);
        check_kept(file.path());
    }

    TEST_CASE("a baked OBJ, a baked level and baked built-in scenes are what they were baked of") {
        const TemporaryFile obj("glow.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 1 0\nf 1 2 3 5\nf 1 5 3 4\n"),
            level("level.wad", test_files::Wad().file());
        check_kept(obj.path());
        check_kept(level.path());
        for (const char* made : {"room", "office", "valley"}) check_kept(made);
        const auto town = assets::load_scene("town", {.instances = 300}).value();
        const auto baked = through_a_file(town);
        REQUIRE_MESSAGE(baked.has_value(), test_files::message(baked));
        CHECK(town.walk == baked->walk);
        check_same_flags(town.one_sided, baked->one_sided);
    }

    TEST_CASE("baked meshes come with the clusters that cutting them gives, unless they are left out") {
        auto source = assets::load_scene("room").value();
        source.scene.update();
        const auto baked = through_a_file(source), without = through_a_file(source, {.clusters = false});
        REQUIRE(baked.has_value());
        REQUIRE(without.has_value());
        CHECK(without->clusters.empty());
        REQUIRE(baked->clusters.size() == source.scene.mesh_count());
        for (scene::MeshId m = 0; m < source.scene.mesh_count(); ++m) {
            const TriangleMesh& mesh = source.scene.mesh(m);
            CHECK(baked->clusters[m].serialise() ==
                  depth::ClusteredMesh::cut(mesh.positions, mesh.indices)->serialise());
        }
    }

    TEST_CASE("a file without what the samples write besides the scene is read, as older versions wrote it") {
        auto source = assets::load_scene("room").value();
        source.scene.update();
        const auto bytes = bake::bake(source.scene, serial_executor(), {.clusters = false}).value();
        const TemporaryFile file("old.crofton", text_of(bytes));
        const auto old = assets::load_scene(file.path());
        REQUIRE_MESSAGE(old.has_value(), test_files::message(old));
        CHECK(old->unit == 0.0);
        CHECK(old->walk.empty());
        CHECK(old->flat.empty());
        CHECK(old->clusters.empty());
    }

    TEST_CASE("a walk, a room, a light and counts that are none are refused by their section") {
        auto source = assets::load_scene("room").value();
        source.scene.update();
        source.rooms.resize(2);
        const auto refused = [&](assets::SceneSource& bad, const char* section) {
            const auto bytes = assets::bake_source(bad, serial_executor()).value();
            assets::SceneSource read{"", scene::Scene(), {}, {}, {}, {}};
            for (scene::MeshId m = 0; m < bad.scene.mesh_count(); ++m)
                REQUIRE(read.scene.add_mesh(bad.scene.mesh(m), ""));
            const auto result = assets::read_visit(bytes, read);
            REQUIRE_FALSE(result.has_value());
            CHECK(result.error().code == ErrorCode::parse);
            CHECK_MESSAGE(result.error().message.find(section) != std::string::npos, result.error().message);
        };
        const auto with = [&](auto change, const char* section) {
            auto bad = assets::load_scene("room");
            bad->scene.update();
            bad->rooms.resize(2);
            change(*bad);
            refused(*bad, section);
        };
        const double nan = std::numeric_limits<double>::quiet_NaN();
        with([&](assets::SceneSource& s) { s.walk[1].y = nan; }, "vi_walk");
        with([&](assets::SceneSource& s) { s.rooms[1].ceiling = nan; }, "vi_rooms");
        with([&](assets::SceneSource& s) { s.rooms[0].corners[3].y = HUGE_VAL; }, "vi_rooms");
        const auto glowing = std::size_t(
            std::find_if(source.emission.begin(), source.emission.end(), [](const auto& e) { return !e.empty(); }) -
            source.emission.begin());
        REQUIRE(glowing < source.emission.size());
        with([&](assets::SceneSource& s) { s.emission[glowing][0].x = -1.0f; }, "vi_glow");
        with([&](assets::SceneSource& s) { s.emission[glowing].push_back(glm::vec3(1.0f)); }, "vi_glend");
        with([&](assets::SceneSource& s) { s.emission.resize(1000); }, "vi_glend");
    }
}
