// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/flat_scene.hpp>
#include <assets/obj_file.hpp>
#include <assets/scene_source.hpp>
#include <filesystem>

#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::message;
using test_files::says;
using test_files::TemporaryFile;

namespace {

Result<assets::SceneSource> load_obj(const std::string& text) {
    const TemporaryFile file("shape.obj", text);
    return assets::load_scene(file.path());
}

}  // namespace

TEST_SUITE("assets/obj_loader") {
    TEST_CASE("bad lines are named by number, and nothing is loaded") {
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 nan\n")), "line 2: vertex 2"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0\n")), "line 2"));
        CHECK(says(message(load_obj("v 1e99 0 0\n")), "line 1"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")), "line 4: face: vertex 4 of 3"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n")), "vertex 0"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n")), "vertex -4"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nf 1 2\n")), "fewer than three"));
        CHECK(says(message(load_obj("v 0 0 0\nf 1 x 1\n")), "'x'"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n")), "line 4"));
        CHECK(says(message(load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\n")), "nothing to draw"));
        CHECK(says(message(load_obj("")), "the file is empty"));
    }

    TEST_CASE("missing files, folders and unknown kinds of file are refused by name") {
        CHECK(says(message(assets::load_scene("/nonexistent/a.obj")), "/nonexistent/a.obj: cannot open"));
        CHECK(says(message(assets::load_scene("shape.fbx")), "unknown kind"));
        CHECK(says(message(assets::load_scene("shape")), "unknown kind"));
        const auto folder = std::filesystem::temp_directory_path() / "crofton_folder.obj";
        std::filesystem::create_directory(folder);
        CHECK(says(message(assets::load_scene(folder.string())), "folder"));
        std::filesystem::remove(folder);
        assets::LoadOptions options;
        options.map = "MAP01";
        CHECK(says(message(assets::load_scene("shape.obj", options)), "map"));
    }

    TEST_CASE("convex polygons become fans, negative indices count from the end, parts have their own vertices") {
        const auto source = load_obj(
            "o quad\nv 0 0 0\nv 2 0 0 \r\nv 2 1 0\nv 0 1 0\nf 1/1/1 2//2 3 4\n"
            "o tri\nv 5 5 5 0.25 0.5 0.75\nv 6 5 5\nv 5 6 5\nf -3 -2 -1\n");
        REQUIRE_MESSAGE(source.has_value(), message(source));
        REQUIRE(source->scene.instance_count() == 2);
        CHECK(source->scene.mesh(0).triangle_count() == 2);
        CHECK(source->scene.mesh(1).positions.size() == 3);
        CHECK(source->scene.mesh(1).colors[0] == glm::vec3(0.25f, 0.5f, 0.75f));
    }

    TEST_CASE("what is too far out for floats keeps its shape and its place") {
        auto source = load_obj("v 500000.25 5400000.125 7\nv 500001 5400000.125 7\nv 500001 5400001.5 7.5\nf 1 2 3\n");
        REQUIRE_MESSAGE(source.has_value(), message(source));
        source->scene.update();
        const TriangleMesh& mesh = source->scene.mesh(0);
        const Transform& world = source->scene.world(source->scene.node_of(0));
        CHECK(world * glm::dvec3(mesh.positions[0]) == glm::dvec3(500000.25, 5400000.125, 7.0));
        CHECK(world * glm::dvec3(mesh.positions[2]) == glm::dvec3(500001.0, 5400001.5, 7.5));
        const auto near = load_obj("v 0 0 0\nv 9 0 0\nv 9 100 0\nf 1 2 3\n");
        CHECK(near->scene.local(0).translation == glm::dvec3(0.0));
    }

    TEST_CASE("large meshes are cut into pieces that together hold every triangle once") {
        std::string text;
        for (int i = 0; i <= 60; ++i)
            for (int j = 0; j <= 60; ++j) text += "v " + std::to_string(i) + " 0 " + std::to_string(j) + "\n";
        for (int i = 0; i < 60; ++i)
            for (int j = 1; j <= 60; ++j) {
                const auto at = [&](int a, int b) { return std::to_string(61 * a + b) + " "; };
                text += "f " + at(i, j) + at(i, j + 1) + at(i + 1, j + 1) + at(i + 1, j) + "\n";
            }
        const auto source = load_obj(text);
        REQUIRE_MESSAGE(source.has_value(), message(source));
        std::size_t triangles = 0;
        double area = 0.0;
        for (scene::MeshId m = 0; m < source->scene.mesh_count(); ++m) {
            const TriangleMesh& mesh = source->scene.mesh(m);
            CHECK(mesh.triangle_count() <= 512);
            triangles += mesh.triangle_count();
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                const glm::vec3 &a = mesh.positions[mesh.indices[t]], &b = mesh.positions[mesh.indices[t + 1]],
                                &c = mesh.positions[mesh.indices[t + 2]];
                area += 0.5 * static_cast<double>(std::abs((b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x)));
            }
        }
        CHECK(triangles == 7200);
        CHECK(area == 3600.0);
    }

    TEST_CASE("a real dungeon loads") {
        const std::string path = std::string(CROFTON_SHARED_DATA) + "/scenes/recast_dungeon.obj";
        if (!std::filesystem::exists(path)) return;
        const auto source = assets::load_scene(path);
        REQUIRE_MESSAGE(source.has_value(), message(source));
        std::size_t triangles = 0;
        for (scene::MeshId m = 0; m < source->scene.mesh_count(); ++m)
            triangles += source->scene.mesh(m).triangle_count();
        CHECK(triangles == 10133);
        CHECK(source->scene.instance_count() > 20);
    }

    TEST_CASE("a flat scene lacks the triangles of no area alone, however small the others are") {
        for (const std::string unit : {"1e-9", "1e-3", "1", "1e9"}) {
            CAPTURE(unit);
            const TemporaryFile file("small.obj", "v 0 0 0\nv " + unit + " 0 0\nv 0 " + unit + " 0\nv -" + unit +
                                                      " 0 0\nf 1 2 3\nf 1 2 4\nf 1 3 4\n");
            auto source = assets::load_scene(file.path());
            REQUIRE(source.has_value());
            source->scene.update();
            const auto flat = assets::flat_scene(*source);
            REQUIRE(flat.has_value());
            CHECK(flat->mesh.triangle_count() == 2);
        }
    }

    TEST_CASE("a UTF-8 mark is skipped, UTF-16 and binary garbage say so, bad lines spoil only themselves") {
        const auto load_text = [](const std::string& text) { return message(load_obj(text)); };
        const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        CHECK(load_text("\xEF\xBB\xBF" + triangle) == "loaded");
        std::string wide = "\xFF\xFE";
        for (const char c : triangle) wide += {c, '\0'};
        CHECK(says(load_text(wide), "UTF-16"));
        CHECK(says(load_text(std::string("\xFE\xFF\0v", 4)), "UTF-16"));
        CHECK(says(load_text(std::string("\x7f"
                                         "ELF\2\1\1\0\0\0",
                                         10)),
                   "is no text: byte 7 is 0"));
        const TemporaryFile file("mixed.obj", "v 0 0 0\nv x 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 3 99\nf 1\n");
        const auto source = assets::load_scene(file.path());
        REQUIRE_MESSAGE(source.has_value(), message(source));
        REQUIRE(source->warnings.size() == 4);
        CHECK(says(source->warnings[0], "line 2: vertex 2"));
        CHECK(says(source->warnings[1], "line 5: face: vertex 2 makes no sense"));
        CHECK(says(source->warnings[2], "line 7: face: vertex 99 of 4"));
        CHECK(says(source->warnings[3], "line 8"));
        REQUIRE(source->scene.instance_count() == 1);
        CHECK(source->scene.mesh(0).positions[1] == glm::vec3(1.0f, 0.0f, 0.0f));
        // Beyond what boxes can hold.
        const TemporaryFile far("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2e30 0 0\nf 1 2 3\nf 1 2 4\n");
        const auto near = assets::load_scene(far.path());
        REQUIRE_MESSAGE(near.has_value(), message(near));
        CHECK(near->scene.mesh(0).triangle_count() == 1);
        REQUIRE(near->warnings.size() == 2);
        CHECK(says(near->warnings[0], "line 4: vertex 4"));
        CHECK(says(near->warnings[1], "line 6: face: vertex 4 makes no sense"));
        // Who computes from the numbers gets all of them or none.
        CHECK_FALSE(assets::read_obj(file.path()).has_value());
        CHECK(says(message(assets::load_scene(file.path(), {.strict = true})), "line 2"));
    }
}
