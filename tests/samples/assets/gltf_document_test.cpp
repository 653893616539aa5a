// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/gltf_document.hpp>
#include <error_of.hpp>
#include <filesystem>

#include "gltf_asset.hpp"
#include "messages.hpp"

using namespace crofton;
using assets::GltfDocument;
using test_files::Asset;
using test_files::Json;
using test_files::says;
using test_files::TemporaryFile;

namespace {

Asset strip_asset() {
    Asset asset;
    const std::size_t positions = asset.accessor(test_files::strip_positions(4), "VEC3");
    asset.mesh(positions, asset.accessor(test_files::strip_indices<std::uint16_t>(4), "SCALAR"));
    return asset;
}

std::string message(const std::string& name, const std::string& contents) {
    const TemporaryFile file(name, contents);
    const auto document = assets::read_gltf_document(file.path());
    if (document) return "read";
    CHECK(error_of(document).message.find(name) != std::string::npos);
    return document.error().message;
}

std::string with_u32(std::string bytes, std::size_t at, std::uint32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
}

const std::string kPng("\x89PNG\r\n\x1A\n not much of a picture", 30);

}  // namespace

TEST_SUITE("assets/gltf_document") {
    TEST_CASE("a binary file cut off anywhere is refused") {
        const std::string whole = strip_asset().glb();
        for (std::size_t length = 0; length < whole.size(); ++length)
            CHECK(message("cut.glb", whole.substr(0, length)) != "read");
    }

    TEST_CASE("wrong lengths, versions and orders of chunks are named") {
        const std::string whole = strip_asset().glb();
        CHECK(says(message("long.glb", with_u32(whole, 8, 0xFFFFFFF0u)), "its header speaks of"));
        CHECK(says(message("none.glb", with_u32(whole, 8, 10)), "fewer bytes than it needs"));
        CHECK(message("more.glb", whole + "more") == "read");
        CHECK(says(message("version.glb", with_u32(whole, 4, 1)), "version 1"));
        CHECK(says(message("json.glb", with_u32(whole, 12, 0xFFFFFFF0u)), "chunk 0"));
        CHECK(says(message("short.glb", with_u32(whole, 12, 8)), "chunk 1"));
        CHECK(says(message("kind.glb", with_u32(whole, 16, 0x004E4942u)), "not JSON"));
        CHECK(says(message("text.glb", strip_asset().root.dump()), "no binary glTF"));
    }

    TEST_CASE("JSON that is damaged, too deep or of another version is named") {
        const std::string whole = strip_asset().root.dump();
        for (std::size_t length = 1; length < whole.size(); ++length)
            CHECK(says(message("a.gltf", whole.substr(0, length)), "damaged or cut off: it ends too early"));
        CHECK(says(message("a.gltf", "{\"asset\": {\"version\": 2.x}}"), "damaged at byte 24"));
        CHECK(says(message("a.gltf", R"({"asset": {"version": "2.0"}, "extras": -1e309})"),
                   "a number beyond the range of double, at byte 45"));
        CHECK(says(message("a.gltf", "[]"), "asset.version"));
        CHECK(says(message("a.gltf", R"({"asset": {"version": "1.0"}})"), "version 1.0"));
        CHECK(says(message("a.gltf", R"({"asset": {"version": "2.1", "minVersion": "2.1"}})"),
                   "reader of glTF version 2.1"));
        CHECK(says(message("a.gltf", R"({"asset": {"version": "2.0"}, "extras": )" + std::string(1'000'000, '[')),
                   "deeper"));
    }

    TEST_CASE("buffers that are missing, too short, or no files are named") {
        Asset asset = strip_asset();
        const auto with_uri = [&](const std::string& uri) {
            asset.root["buffers"][0]["uri"] = uri;
            return message("a.gltf", asset.root.dump());
        };
        CHECK(says(with_uri("no such file.bin"), "buffer 0"));
        CHECK(says(with_uri("/dev/zero"), "buffer 0"));
        CHECK(says(with_uri("https://example.org/a.bin"), "is not a file"));
        CHECK(says(with_uri("data:application/octet-stream;base64,AAAA"), "3 bytes"));
        CHECK(says(with_uri("data:application/octet-stream;base64,A*AA"), "base64"));
        CHECK(says(with_uri("data:,AAAA"), "base64"));
        asset.root["buffers"][0] = 7;
        CHECK(says(message("a.gltf", asset.root.dump()), "no object"));
    }

    TEST_CASE("a written file is the one that was read: members in order, numbers, chunks of other kinds") {
        Asset asset = strip_asset();
        asset.root["extras"] =
            Json::parse(R"({"z": 1, "a": [0.1, 1e-7, -0.0, 12345678901234567], "text": "ä\u0000\"" })");
        const std::string other = test_files::bytes_of(std::uint32_t{4}) + "TEST" + "data";
        const TemporaryFile file("a.glb", asset.glb(other));
        const auto document = assets::read_gltf_document(file.path()).value();
        CHECK(document.root.dump() == asset.root.dump());
        CHECK(*assets::write_glb(document) == asset.glb(other));
    }

    TEST_CASE("other files' buffers are taken in, whatever their number") {
        Asset asset = strip_asset();
        const TemporaryFile first("first part.bin", asset.binary), second("second.bin", "12345678");
        const auto name = [](const TemporaryFile& f) { return std::filesystem::path(f.path()).filename().string(); };
        std::string escaped = name(first);
        escaped.replace(escaped.find(' '), 1, "%20");
        asset.root["buffers"] = {{{"byteLength", asset.binary.size()}, {"uri", escaped}, {"name", "kept"}},
                                 {{"byteLength", 7}, {"uri", name(second)}}};
        const TemporaryFile text("a.gltf", asset.root.dump());
        const auto document = assets::read_gltf_document(text.path()).value();
        const TemporaryFile binary("b.glb", *assets::write_glb(document));
        const auto again = assets::read_gltf_document(binary.path()).value();
        REQUIRE(again.buffers.size() == 2);
        CHECK(again.buffers[0] == asset.binary);
        CHECK(again.buffers[1] == "1234567");
        CHECK(again.root["buffers"][0]["name"] == "kept");
        CHECK_FALSE(again.root["buffers"][0].contains("uri"));
    }

    TEST_CASE("images in other files are embedded once, unreadable ones keep their URI, with a warning") {
        Asset asset = strip_asset();
        const TemporaryFile picture("picture.png", kPng), text("notes.txt", "hello");
        const auto name = [](const TemporaryFile& f) { return std::filesystem::path(f.path()).filename().string(); };
        asset.root["images"] = {{{"uri", name(picture)}, {"name", "a"}},
                                {{"uri", name(picture)}},
                                {{"uri", "missing.png"}},
                                {{"uri", name(text)}},
                                {{"uri", "https://example.org/a.png"}},
                                {{"uri", "data:image/png;base64,AAAA"}}};
        const Json before = asset.root["images"];
        const TemporaryFile file("a.glb", asset.glb());
        const auto document = assets::read_gltf_document(file.path()).value();
        const Json& images = document.root["images"];
        CHECK(images[0]["mimeType"] == "image/png");
        CHECK(images[0]["name"] == "a");
        CHECK_FALSE(images[0].contains("uri"));
        CHECK(images[1]["bufferView"] == images[0]["bufferView"]);
        const Json& view = document.root["bufferViews"][images[0]["bufferView"].get<std::size_t>()];
        CHECK(document.buffers[0].substr(view["byteOffset"], view["byteLength"]) == kPng);
        for (std::size_t i = 2; i < 6; ++i) CHECK(images[i] == before[i]);
        REQUIRE(document.warnings.size() == 2);
        CHECK(says(document.warnings[0], "image 2"));
        CHECK(says(document.warnings[1], "image 3"));
    }

    TEST_CASE("an accessor's elements: sparse ones, made-up ones, and all that can be wrong with them") {
        Asset asset = strip_asset();
        const std::size_t which = asset.view(test_files::bytes_of(std::uint16_t{1}));
        const std::size_t values = asset.view(test_files::bytes_of(5.0f) + test_files::bytes_of(6.0f));
        const Json sparse = {{"count", 1},
                             {"indices", {{"bufferView", which}, {"componentType", 5123}}},
                             {"values", {{"bufferView", values}}}};
        asset.root["accessors"].push_back(
            {{"componentType", 5126}, {"type", "VEC2"}, {"count", 3}, {"sparse", sparse}});
        const auto read = [&](const Json& change, std::optional<std::size_t> count = 3) -> std::string {
            Asset changed = asset;
            changed.root["accessors"][2].merge_patch(change);
            const TemporaryFile file("a.glb", changed.glb());
            const auto document = assets::read_gltf_document(file.path()).value();
            std::string storage;
            const auto elements = assets::accessor_elements(document, 2, count, storage);
            if (!elements) return elements.error().message;
            std::string text;
            for (const float f : assets::to_floats(*elements, 2)) text += std::to_string(static_cast<int>(f)) + " ";
            return text;
        };
        CHECK(read({{"name", "as it is"}}) == "0 0 5 6 0 0 ");
        CHECK(read({{"name", "x"}}, std::nullopt) == "0 0 5 6 0 0 ");
        CHECK(says(read({{"count", 4'000'000'000u}}, std::nullopt),
                   "without a buffer view: more than 8388608 triangles"));
        CHECK(says(read({{"count", 4'000'000'000u}}), "4000000000 elements for 3"));
        CHECK(says(read({{"count", -1}}), "whole number"));
        CHECK(says(read({{"count", "3"}}), "whole number"));
        CHECK(says(read({{"componentType", 5199}}), "unknown type"));
        CHECK(says(read({{"type", "VEC9"}}), "unknown type"));
        CHECK(says(read({{"bufferView", 99}}), "does not exist"));
        CHECK(says(read({{"bufferView", 1}, {"byteOffset", 1'000'000}}), "do not fit"));
        CHECK(says(read({{"sparse", {{"count", 2}}}}), "do not fit"));
        CHECK(says(read({{"sparse", {{"indices", nullptr}}}}), "damaged"));
        Asset far = asset;
        far.binary[far.root["bufferViews"][which]["byteOffset"].get<std::size_t>()] = 3;
        const TemporaryFile file("far.glb", far.glb());
        std::string storage;
        const auto elements = assets::accessor_elements(*assets::read_gltf_document(file.path()), 2, 3, storage);
        REQUIRE_FALSE(elements.has_value());
        CHECK(says(error_of(elements).message, "replaces element 3 of 3"));
    }
}
