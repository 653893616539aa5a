// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/scene_source.hpp>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>

#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::glb;
using test_files::gltf_json;
using test_files::message;
using test_files::says;
using test_files::TemporaryFile;

namespace {

Result<assets::SceneSource> load_glb(const std::string& json) {
    const TemporaryFile file("scene.glb", glb(json));
    return assets::load_scene(file.path());
}

const std::string kShared = std::string(CROFTON_SHARED_DATA) + "/scenes/";

}  // namespace

TEST_SUITE("assets/gltf_loader") {
    TEST_CASE("nodes with NaN, projective or damaged transforms are named") {
        const std::string huge = message(load_glb(gltf_json("[{\"name\":\"huge\",\"mesh\":0,\"scale\":[1,1e16,1]}]")));
        CHECK(says(huge, "scene.glb"));
        CHECK(says(huge, "node 0 'huge'"));
        CHECK(says(huge, "more than 1e15"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0,\"matrix\":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]}]"))),
                   "projective"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0,\"rotation\":[0,0,0,0]}]"))), "quaternion"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0,\"translation\":[1e300,0,0]}]"))), "exceeds"));
        CHECK_FALSE(load_glb(gltf_json("[{\"mesh\":0,\"translation\":[1e999,0,0]}]")).has_value());
        CHECK_FALSE(load_glb(gltf_json("[{\"mesh\":0,\"translation\":[NaN,0,0]}]")).has_value());
    }

    TEST_CASE("one bad object is left out with a warning that names it, and the rest is loaded") {
        const auto source =
            load_glb(gltf_json("[{\"children\":[1,2,3]},{\"mesh\":0,\"translation\":[1,0,0]},"
                               "{\"name\":\"bad\",\"mesh\":0,\"rotation\":[0,0,0,0],\"children\":[4]},"
                               "{\"mesh\":0,\"translation\":[3,0,0]},{\"mesh\":0}]"));
        REQUIRE(source.has_value());
        CHECK(source->scene.node_count() == 3);
        CHECK(source->scene.instance_count() == 2);
        REQUIRE(source->warnings.size() == 1);
        CHECK(says(source->warnings[0], "node 2 'bad'"));
        CHECK(says(source->warnings[0], "quaternion"));
    }

    TEST_CASE("whole numbers may be written with a point or an exponent") {
        const auto source = load_glb(gltf_json("[{\"children\":[1.0,20e-1]},{\"mesh\":0.0},{\"mesh\":0e3}]")).value();
        CHECK(source.scene.instance_count() == 2);
        CHECK(source.warnings.empty());
        for (const char* wrong : {"1.5", "-1.0", "1e300", "2e19"})
            CHECK(
                says(message(load_glb(gltf_json("[{\"children\":[" + std::string(wrong) + "]},{}]"))), "is no index"));
    }

    TEST_CASE("a scale that flattens is data: flat things are flat, a zero scale hides") {
        for (const bool hidden : {false, true}) {
            const std::string scale = hidden ? "[0,0,0]" : "[1,0,1]";
            auto source = load_glb(gltf_json("[{\"mesh\":0,\"scale\":" + scale + "}]")).value();
            source.scene.update();
            CHECK(source.scene.layer_masks()[0] == (hidden ? 0 : ~0u));
        }
    }

    TEST_CASE("cycles, missing nodes, meshes and accessors are named") {
        const auto cycle = load_glb(gltf_json("[{\"children\":[1]},{\"children\":[0],\"mesh\":0}]")).value();
        CHECK(cycle.scene.instance_count() == 1);
        REQUIRE(cycle.warnings.size() == 1);
        CHECK(says(cycle.warnings[0], "node 0: left out: has two parents, or is its own ancestor"));
        CHECK(says(message(load_glb(gltf_json("[{\"children\":[7]}]"))), "node 7"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":3}]"))), "mesh 3"));
        CHECK_FALSE(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":9,\"count\":3")).has_value());
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":4000000000"))),
                   "do not fit"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":4"))), "do not fit"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"byteOffset\":4,\"count\":3"))),
                   "do not fit"));
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":2"))), "multiple"));
    }

    TEST_CASE("an index beyond the vertices and a vertex that is not a number are named") {
        // The floats of the positions read as indices are far beyond three vertices.
        const std::string far =
            message(load_glb(gltf_json("[{\"mesh\":0}]", "\"bufferView\":0,\"byteOffset\":12,\"count\":3")));
        CHECK(says(far, "of 3"));
        std::string file = glb(gltf_json("[{\"mesh\":0}]"));
        const float nan = std::numeric_limits<float>::quiet_NaN();
        std::memcpy(file.data() + file.size() - 44 + 12, &nan, sizeof nan);
        const TemporaryFile damaged("nan.glb", file);
        CHECK(says(message(assets::load_scene(damaged.path())), "vertex 1"));
    }

    TEST_CASE("a damaged accessor is named with mesh and primitive, deep nesting is refused before it is parsed") {
        const auto of = [](const std::string& indices) {
            return message(load_glb(gltf_json("[{\"mesh\":0}]", indices)));
        };
        CHECK(says(of("\"bufferView\":1,\"count\":-3"), "mesh 0 'sail': primitive 0: left out: indices: accessor 1"));
        CHECK(
            says(of("\"bufferView\":1,\"count\":\"3\""), "mesh 0 'sail': primitive 0: left out: indices: accessor 1"));
        CHECK(says(of("\"bufferView\":9,\"count\":3"), "mesh 0 'sail': primitive 0: left out: indices: accessor 1"));
        const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
        CHECK(says(message(load_glb(gltf_json("[{\"mesh\":0,\"extras\":" + deep + "}]"))), "deeper"));
    }

    TEST_CASE("scenes without triangles and files that are something else are refused") {
        CHECK(says(message(load_glb(gltf_json("[{\"name\":\"nothing\"}]"))), "nothing to draw"));
        CHECK_FALSE(load_glb("{}").has_value());
        const TemporaryFile empty("empty.gltf", "");
        CHECK_FALSE(assets::load_scene(empty.path()).has_value());
        const TemporaryFile text("text.glb", "this is no binary glTF file, but it is long enough for a header");
        CHECK(says(message(assets::load_scene(text.path())), "text.glb"));
    }

    TEST_CASE("nodes share a mesh, with matrices, translation, rotation and scale, and their parents'") {
        auto source = load_glb(
            gltf_json("[{\"children\":[1,2],\"translation\":[0,0,10]},"
                      "{\"mesh\":0,\"matrix\":[2,0,0,0,0,2,0,0,0,0,2,0,5,0,0,1]},"
                      "{\"mesh\":0,\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\"scale\":[3,1,1]}]"));
        REQUIRE_MESSAGE(source.has_value(), message(source));
        scene::Scene& scene = source->scene;
        scene.update();
        REQUIRE(scene.instance_count() == 2);
        CHECK(scene.mesh_count() == 1);
        const glm::dvec3 a = scene.world(scene.node_of(0)) * glm::dvec3(1, 0, 0);
        const glm::dvec3 b = scene.world(scene.node_of(1)) * glm::dvec3(1, 0, 0);
        CHECK(a == glm::dvec3(7, 0, 10));
        CHECK(glm::length(b - glm::dvec3(0, 3, 10)) < 1e-12);
    }

    TEST_CASE("real scenes load: a forest of 1.1 million triangles, a city with a palette texture") {
        if (!std::filesystem::exists(kShared)) return;
        const auto forest = assets::load_scene(kShared + "stk_black_forest.glb");
        REQUIRE_MESSAGE(forest.has_value(), message(forest));
        CHECK(forest->scene.instance_count() == 2933);
        CHECK(forest->scene.mesh_count() == 204);
        std::size_t triangles = 0;
        for (scene::InstanceId i = 0; i < forest->scene.instance_count(); ++i)
            triangles += forest->scene.mesh(forest->scene.mesh_of(i)).triangle_count();
        CHECK(triangles > 1'000'000);
        const auto taxi = assets::load_scene(kShared + "kaykit_city/car_taxi.gltf");
        REQUIRE_MESSAGE(taxi.has_value(), message(taxi));
        CHECK(taxi->warnings.empty());
        // A taxi is yellow: much red and green, little blue.
        bool yellow = false;
        for (scene::MeshId m = 0; m < taxi->scene.mesh_count(); ++m)
            for (const glm::vec3& c : taxi->scene.mesh(m).colors)
                yellow = yellow || (c.x > 0.5f && c.y > 0.2f && c.z < 0.15f);
        CHECK(yellow);
    }

    TEST_CASE("a material's emission is its factor times its strength, without one nothing glows") {
        const auto with_material = [](const std::string& material) {
            std::string text = gltf_json("[{\"mesh\":0}]");
            text.insert(text.find("\"indices\":1") + 11, ",\"material\":0");
            return load_glb(text.insert(1, "\"materials\":[" + material + "],"));
        };
        const auto lamp = with_material(
                              "{\"emissiveFactor\":[1,0.5,0.25],\"extensions\":{\"KHR_materials_emissive_strength\":{"
                              "\"emissiveStrength\":8}}}")
                              .value();
        REQUIRE(lamp.emission.size() == 1);
        REQUIRE(lamp.emission[0].size() == 1);
        CHECK(lamp.emission[0][0] == glm::vec3(8.0f, 4.0f, 2.0f));
        const auto dim = with_material("{\"emissiveFactor\":[1,0.5,0.25]}").value();
        CHECK(dim.emission.at(0).at(0) == glm::vec3(1.0f, 0.5f, 0.25f));
        const auto dark = with_material("{}").value();
        CHECK(dark.emission.empty());
    }

    TEST_CASE("faces are one-sided unless the material says otherwise") {
        const std::string plain = gltf_json("[{\"mesh\":0}]");
        for (const bool twice : {false, true}) {
            std::string text = plain;
            text.insert(text.find("\"indices\":1") + 11, ",\"material\":0");
            text.insert(1, std::string("\"materials\":[{\"doubleSided\":") + (twice ? "true" : "false") + "}],");
            const auto scene = load_glb(text).value();
            CHECK(scene.one_sided == std::vector<std::uint8_t>{twice ? std::uint8_t{0} : std::uint8_t{1}});
        }
        const auto bare = load_glb(plain).value();
        CHECK(bare.one_sided == std::vector<std::uint8_t>{1});
    }
}
