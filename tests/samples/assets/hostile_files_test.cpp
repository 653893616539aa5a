// SPDX-License-Identifier: MIT
// Files that ask for more than they may, or for what is not theirs; and sound ones that look unusual.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <assets/data_uri.hpp>
#include <assets/file.hpp>
#include <assets/gltf_document.hpp>
#include <assets/scene_source.hpp>
#include <filesystem>
#include <fstream>

#include "gltf_asset.hpp"
#include "messages.hpp"

using namespace crofton;
using test_files::Asset;
using test_files::Json;
using test_files::says;
using test_files::TemporaryFile;

namespace {

// A folder with a folder "asset" in it, and a secret beside that.
struct Place {
    Place() {
        root = (std::filesystem::temp_directory_path() / "crofton-place-XXXXXX").string();
        REQUIRE(mkdtemp(root.data()) != nullptr);
        std::filesystem::create_directories(root + "/asset/parts");
        write("secret.bin", test_files::gltf_buffer());
    }
    ~Place() { std::filesystem::remove_all(root); }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    void write(const std::string& name, const std::string& contents) const {
        std::ofstream(root + "/" + name, std::ios::binary) << contents;
    }
    // A triangle whose only buffer is `uri`.
    [[nodiscard]] std::string triangle(const std::string& uri) const {
        write("asset/a.gltf", test_files::gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":3",
                                                    "\"byteLength\":44,\"uri\":" + Json(uri).dump()));
        return test_files::message(assets::load_scene(root + "/asset/a.gltf"));
    }
    std::string root;
};

std::string load(const Asset& asset, const assets::LoadOptions& options = {}) {
    const TemporaryFile file("hostile.glb", asset.glb());
    return test_files::message(assets::load_scene(file.path(), options));
}

// Two triangles in two meshes, one node each.
Asset two_triangles() {
    Asset asset;
    const auto positions = asset.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const auto indices = asset.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
    asset.mesh(positions, indices);
    asset.mesh(positions, indices);
    asset.root["nodes"] = {{{"mesh", 0}, {"name", "good"}}, {{"mesh", 1}, {"name", "other"}}};
    asset.root["scenes"][0]["nodes"] = {0, 1};
    return asset;
}

// An uncompressed PNG's header for `side` × `side` pixels: enough to learn what it would take.
std::string huge_png(std::uint32_t side) {
    const auto big = [](std::uint32_t v) {
        return std::string{static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
                           static_cast<char>(v)};
    };
    return std::string("\x89PNG\r\n\x1a\n", 8) + big(13) + "IHDR" + big(side) + big(side) +
           std::string("\x08\x06\x00\x00\x00", 5) + big(0) + big(0) + "IDAT" + big(0);
}

}  // namespace

TEST_SUITE("assets/hostile_files") {
    TEST_CASE("URIs that leave the asset's folder are refused, whatever they are written as") {
        const Place place;
        const std::string absolute = place.root + "/secret.bin";
        std::filesystem::create_symlink("../secret.bin", place.root + "/asset/link.bin");
        std::filesystem::create_directory_symlink("..", place.root + "/asset/up");
        for (const std::string& uri :
             {std::string("../secret.bin"), std::string("parts/../../secret.bin"), std::string("%2e%2e/secret.bin"),
              std::string("%2E%2E%2Fsecret.bin"), std::string("..%5csecret.bin"), std::string("..\\secret.bin"),
              absolute, "%2F" + absolute.substr(1), "file://" + absolute, std::string("link.bin"),
              std::string("up/secret.bin"), std::string("C:/secret.bin"), std::string("secret.bin%00.png"),
              std::string(""), std::string(".")}) {
            CAPTURE(uri);
            const std::string said = place.triangle(uri);
            CHECK(says(said, "a.gltf"));
            CHECK(says(said, "buffer 0"));
            CHECK(said.find('\0') == said.npos);  // it would end the message
        }
        CHECK(says(place.triangle("../secret.bin"), "leads out of its folder"));
        CHECK(says(place.triangle(absolute), "absolute path"));
        CHECK(says(place.triangle("link.bin"), "link that leads out"));
    }

    TEST_CASE("URIs of files below the asset's folder are read, with blanks and dots in their names, through links") {
        const Place place;
        place.write("asset/parts/a b..bin", test_files::gltf_buffer());
        std::filesystem::create_symlink("parts/a b..bin", place.root + "/asset/link.bin");
        CHECK(place.triangle("parts/a%20b..bin") == "loaded");
        CHECK(place.triangle("./parts/./a b..bin") == "loaded");
        CHECK(place.triangle("link.bin") == "loaded");
        // The folder itself may be reached by a link, and the current folder has no name.
        std::filesystem::create_directory_symlink("asset", place.root + "/alias");
        CHECK(assets::load_scene(place.root + "/alias/a.gltf").has_value());
        const auto here = std::filesystem::current_path();
        std::filesystem::current_path(place.root + "/asset");
        CHECK(assets::load_scene("a.gltf").has_value());
        std::filesystem::current_path(here);
    }

    TEST_CASE("pipes and devices are refused at once: as buffers, images and material libraries") {
        const Place place;
        REQUIRE(mkfifo((place.root + "/asset/pipe").c_str(), 0600) == 0);
        CHECK(says(place.triangle("pipe"), "no regular file"));
        std::filesystem::create_symlink("/dev/zero", place.root + "/asset/zero");
        CHECK(says(place.triangle("zero"), "leads out"));
        place.write("asset/a.obj", "mtllib pipe\nmtllib ../secret.bin\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        const auto obj = assets::load_scene(place.root + "/asset/a.obj").value();
        REQUIRE(obj.warnings.size() == 2);
        CHECK(says(obj.warnings[0], "no regular file"));
        CHECK(says(obj.warnings[1], "leads out"));
    }

    TEST_CASE("a document embeds only files of its own folder") {
        const Place place;
        Asset asset = two_triangles();
        asset.root["images"] = {
            {{"uri", "../secret.png"}}, {{"uri", place.root + "/secret.png"}}, {{"uri", "own.png"}}};
        for (const char* name : {"secret.png", "asset/own.png"}) place.write(name, "\x89PNG and more");
        place.write("asset/a.glb", asset.glb());
        const auto document = assets::read_gltf_document(place.root + "/asset/a.glb").value();
        CHECK(document.warnings.size() == 2);
        CHECK(document.root["images"][0].contains("uri"));
        CHECK(document.root["images"][1].contains("uri"));
        CHECK_FALSE(document.root["images"][2].contains("uri"));
    }

    TEST_CASE("each limit is an error, or for an image a warning, that names it and its option") {
        Asset asset = two_triangles();
        assets::LoadOptions options;
        options.limits.triangles = 1;
        CHECK(says(load(asset, options), "more than 1 triangles, the limit: --max-triangles raises it"));
        options.limits.triangles = 2;
        CHECK(load(asset, options) == "loaded");
        options.limits = {};
        options.limits.nodes = 1;
        CHECK(says(load(asset, options), "--max-nodes"));
        options.limits = {};
        options.limits.bytes = asset.glb().size() - 1;
        CHECK(says(load(asset, options), "--max-bytes"));
        options.limits = {};
        options.limits.nesting = 3;
        CHECK(says(load(asset, options), "nested deeper than 3"));
        options.limits = {};
        options.limits.seconds = -1.0;
        CHECK(says(load(asset, options), "--max-seconds"));
        const TemporaryFile obj("large.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
        options.limits = {};
        options.limits.triangles = 1;
        CHECK(says(test_files::message(assets::load_scene(obj.path(), options)), "--max-triangles"));
        options.limits = {};
        options.limits.bytes = 30;
        CHECK(says(test_files::message(assets::load_scene(obj.path(), options)), "--max-bytes"));
        const TemporaryFile wad("small.wad", test_files::Wad().file());
        CHECK(says(test_files::message(assets::load_scene(wad.path(), options)), "--max-bytes"));
        options.limits = {};
        options.limits.nodes = 3;
        CHECK(says(test_files::message(assets::load_scene(wad.path(), options)), "--max-nodes"));
    }

    TEST_CASE("the limit of bytes holds for a file and all that it refers to together") {
        Place place;
        place.write("asset/a.bin", test_files::gltf_buffer());
        const std::string text = test_files::gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":3",
                                                       "\"byteLength\":44,\"uri\":\"a.bin\"");
        place.write("asset/a.gltf", text);
        assets::LoadOptions options;
        options.limits.bytes = text.size() + 44;
        CHECK(test_files::message(assets::load_scene(place.root + "/asset/a.gltf", options)) == "loaded");
        --options.limits.bytes;
        CHECK(says(test_files::message(assets::load_scene(place.root + "/asset/a.gltf", options)),
                   "more than " + std::to_string(text.size() + 43) + " bytes, the limit: --max-bytes raises it"));

        const std::string library(50, '#'), shape = "mtllib a.mtl\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
        place.write("asset/a.mtl", library);
        place.write("asset/a.obj", shape);
        options.limits.bytes = shape.size() + 2 * library.size();
        CHECK(test_files::message(assets::load_scene(place.root + "/asset/a.obj", options)) == "loaded");
        --options.limits.bytes;
        CHECK(says(test_files::message(assets::load_scene(place.root + "/asset/a.obj", options)), "--max-bytes"));
    }

    TEST_CASE("images in other files count towards the limit of bytes, and are left out beyond it") {
        Place place;
        // 1 x 1 pixel, in the Netpbm format.
        const std::string image = std::string("P6 1 1 255\n") + "abc";
        place.write("asset/a.ppm", image);
        Asset asset = two_triangles();
        const auto uv = asset.accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
        asset.root["images"] = {{{"uri", "a.ppm"}}, {{"uri", "./a.ppm"}}};
        asset.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
        for (std::size_t m = 0; m < 2; ++m) {
            asset.root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", m}}}}}});
            asset.root["meshes"][m]["primitives"][0]["material"] = m;
            asset.root["meshes"][m]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
        }
        place.write("asset/a.glb", asset.glb());
        assets::LoadOptions options;
        for (const std::size_t missing : {0u, 1u}) {
            options.limits.bytes = asset.glb().size() + 2 * image.size() - missing;
            const auto source = assets::load_scene(place.root + "/asset/a.glb", options).value();
            REQUIRE(source.warnings.size() == missing);
            if (missing == 1) CHECK(says(source.warnings[0], "--max-bytes"));
        }
    }

    TEST_CASE("a small file that demands much memory is refused before it is allocated") {
        // Primitives that share one accessor: each would be a mesh of its own.
        Asset shared;
        const auto positions = shared.accessor(std::vector<float>(9000, 1.0f), "VEC3");
        std::vector<std::uint16_t> numbers(3000);
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::uint16_t>(i);
        const auto indices = shared.accessor(numbers, "SCALAR");
        shared.mesh(positions, indices);
        Json& primitives = shared.root["meshes"][0]["primitives"];
        const Json one = primitives[0];
        for (int i = 1; i < 10'000; ++i) primitives.push_back(one);
        CHECK(says(load(shared), "--max-triangles"));
        // One mesh shown by nodes with many primitives each.
        Asset many = two_triangles();
        Json& parts = many.root["meshes"][0]["primitives"];
        const Json part = parts[0];
        for (int i = 1; i < 1100; ++i) parts.push_back(part);
        many.root["nodes"] = Json::array();
        many.root["scenes"][0]["nodes"] = Json::array();
        for (int i = 0; i < 1000; ++i) {
            many.root["nodes"].push_back({{"mesh", 0}});
            many.root["scenes"][0]["nodes"].push_back(i);
        }
        CHECK(says(load(many), "--max-nodes"));
        // Zeros that no bytes of the file stand for.
        Asset zeros = two_triangles();
        zeros.root["accessors"].push_back({{"componentType", 5126}, {"count", 4'000'000'000u}, {"type", "VEC3"}});
        zeros.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
        CHECK(load(zeros) == "loaded");  // without its colours
        zeros.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2;
        const TemporaryFile endless("zeros.glb", zeros.glb());
        const auto rest = assets::load_scene(endless.path()).value();
        CHECK(rest.scene.instance_count() == 1);
        REQUIRE(rest.warnings.size() == 1);
        CHECK(says(rest.warnings[0], "--max-triangles"));
        // An image whose pixels would take gigabytes.
        Asset painted = two_triangles();
        painted.accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
        painted.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
        painted.root["meshes"][0]["primitives"][0]["material"] = 0;
        painted.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        painted.root["textures"] = {{{"source", 0}}};
        painted.root["images"] = {{{"uri", assets::make_data_uri("image/png", huge_png(16384))}}};
        const TemporaryFile file("painted.glb", painted.glb());
        const auto source = assets::load_scene(file.path()).value();
        REQUIRE(source.warnings.size() == 1);
        CHECK(says(source.warnings[0], "image 0: 16384 x 16384 is more than 67108864 pixels"));
    }

    TEST_CASE("one bad node, mesh or image is named and left out, with strict the file is refused") {
        const auto spoil = [](const char* what, const auto& change) {
            CAPTURE(what);
            Asset asset = two_triangles();
            change(asset.root);
            const TemporaryFile file("spoiled.glb", asset.glb());
            const auto source = assets::load_scene(file.path());
            REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
            CHECK(source->scene.instance_count() >= 1);
            REQUIRE(source->warnings.size() >= 1);
            CHECK_MESSAGE(says(source->warnings[0], what), source->warnings[0]);
            const std::string strict = test_files::message(assets::load_scene(file.path(), {.strict = true}));
            CHECK(says(strict, what));
            CHECK((says(strict, "--strict") || says(strict, "buffer 1: ")));
        };
        spoil("node 7", [](Json& root) { root["scenes"][0]["nodes"].push_back(7); });
        spoil("scene: left out: one of its nodes is no index",
              [](Json& root) { root["scenes"][0]["nodes"].push_back("x"); });
        spoil("node 1 'other'", [](Json& root) { root["nodes"][0]["children"] = {1}; });
        spoil("node 0 'good'", [](Json& root) { root["nodes"][1]["children"] = {0, 0}; });
        spoil("node 1 'other': mesh 9", [](Json& root) { root["nodes"][1]["mesh"] = 9; });
        spoil("node 1 'other': mesh \"x\"", [](Json& root) { root["nodes"][1]["mesh"] = "x"; });
        spoil("node 1 'other' and all below it", [](Json& root) { root["nodes"][1]["matrix"] = {1, 2, 3}; });
        spoil("node 1 'other' and all below it", [](Json& root) { root["nodes"][1]["scale"] = "big"; });
        spoil("mesh 1: primitive 0", [](Json& root) { root["meshes"][1]["primitives"][0]["indices"] = 9; });
        spoil("mesh 1: primitive 0", [](Json& root) { root["meshes"][1]["primitives"][0]["mode"] = 1; });
        spoil("mesh 1: primitive 0", [](Json& root) { root["meshes"][1]["primitives"][0] = "none"; });
        spoil("default scene", [](Json& root) { root["scene"] = 3; });
        spoil("buffer 1", [](Json& root) { root["buffers"].push_back({{"byteLength", 4}, {"uri", "missing.bin"}}); });
        spoil("image 0: ", [](Json& root) {
            root["images"] = {{{"uri", "missing.png"}}};
            root["textures"] = {{{"source", 0}}};
            root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
            root["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
            root["meshes"][1]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
            root["meshes"][1]["primitives"][0]["material"] = 0;
        });
    }

    TEST_CASE("legal glTF that looks unusual is read") {
        // A buffer's file longer than its byteLength.
        const Place place;
        place.write("asset/long.bin", test_files::gltf_buffer() + std::string(100, '\7'));
        CHECK(place.triangle("long.bin") == "loaded");
        // Broken or unknown lights, images, cameras, animations and skins beside sound geometry.
        Asset asset = two_triangles();
        asset.root["cameras"] = {{{"type", "perspective"}, {"perspective", "?"}}, 5};
        asset.root["nodes"][0]["camera"] = 17;
        asset.root["images"] = {{{"bufferView", 99}}, nullptr};
        asset.root["animations"] = {{{"channels", 5}}};
        asset.root["skins"] = {{{"joints", "x"}}};
        asset.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "sun?"}}}}}}};
        asset.root["nodes"][1]["extensions"] = {{"KHR_lights_punctual", {{"light", 42}}}};
        const TemporaryFile file("odd.glb", asset.glb());
        const auto odd = assets::load_scene(file.path(), {.strict = true});
        REQUIRE_MESSAGE(odd.has_value(), test_files::message(odd));
        CHECK(odd->scene.instance_count() == 2);
    }

    TEST_CASE("an accessor without a buffer view is zeros, which sparse may fill") {
        Asset asset;
        const auto indices = asset.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
        const std::string replaced("\1\0\2\0", 4);
        std::string values(24, '\0');
        const float one = 1.0f;
        std::memcpy(values.data(), &one, 4);
        std::memcpy(values.data() + 16, &one, 4);
        const auto where = asset.view(replaced), what = asset.view(values);
        asset.root["accessors"].push_back({{"componentType", 5126},
                                           {"count", 3},
                                           {"type", "VEC3"},
                                           {"sparse",
                                            {{"count", 2},
                                             {"indices", {{"bufferView", where}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", what}}}}}});
        asset.mesh(1, indices);
        const TemporaryFile file("sparse.glb", asset.glb());
        const auto source = assets::load_scene(file.path());
        REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
        const TriangleMesh& mesh = source->scene.mesh(0);
        REQUIRE(mesh.positions.size() == 3);
        CHECK(mesh.positions[0] == glm::vec3(0.0f));
        CHECK(mesh.positions[1] == glm::vec3(1.0f, 0.0f, 0.0f));
        CHECK(mesh.positions[2] == glm::vec3(0.0f, 1.0f, 0.0f));
        // All zeros: one point, three times.
        asset.root["accessors"][1].erase("sparse");
        const TemporaryFile zeros("zeros.glb", asset.glb());
        const auto point = assets::load_scene(zeros.path());
        REQUIRE_MESSAGE(point.has_value(), test_files::message(point));
        CHECK(point->scene.mesh(0).positions[2] == glm::vec3(0.0f));
    }

    TEST_CASE("glTF 1.0 is called by its name") {
        const TemporaryFile text("old.gltf", "{\"asset\":{\"version\":\"1.0\"},\"meshes\":{\"m\":{}}}");
        CHECK(says(test_files::message(assets::load_scene(text.path())), "is glTF version 1.0"));
        const TemporaryFile nameless("older.gltf", "{\"meshes\":{\"m\":{}}}");
        CHECK(says(test_files::message(assets::load_scene(nameless.path())), "is glTF version 1.0"));
        std::string binary = two_triangles().glb();
        binary[4] = 1;
        const TemporaryFile old("old.glb", binary);
        CHECK(says(test_files::message(assets::load_scene(old.path())), "is glTF version 1.0"));
    }
}
