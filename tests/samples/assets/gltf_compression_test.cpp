// SPDX-License-Identifier: MIT
// Compressed glTF, made by the libraries' own encoders.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <assets/gltf_compression.hpp>
#include <assets/scene_source.hpp>
#if defined(CROFTON_MESHOPT)
#include <meshoptimizer.h>
#endif
#if defined(CROFTON_DRACO)
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

#include "gltf_asset.hpp"
#include "messages.hpp"

using namespace crofton;
using test_files::Asset;
using test_files::Json;
using test_files::says;
using test_files::TemporaryFile;

namespace {

constexpr int kSquares = 40;

// Corners of all triangles, each turned so that its least corner is first, in order.
[[maybe_unused]] std::vector<std::array<float, 9>> triangles_of(const Asset& asset) {
    const TemporaryFile file("compressed.glb", asset.glb());
    const auto source = assets::load_scene(file.path(), {.strict = true});
    REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
    const TriangleMesh& mesh = source->scene.mesh(0);
    std::vector<std::array<float, 9>> result;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::array<std::array<float, 3>, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = mesh.positions[mesh.indices[t + k]];
            corners[k] = {p.x, p.y, p.z};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        result.emplace_back();
        for (std::size_t i = 0; i < 9; ++i) result.back()[i] = corners[i / 3][i % 3];
    }
    std::sort(result.begin(), result.end());
    return result;
}

[[maybe_unused]] Asset plain() {
    Asset asset;
    const auto positions = asset.accessor(test_files::strip_positions(kSquares), "VEC3");
    asset.mesh(positions, asset.accessor(test_files::strip_indices<std::uint16_t>(kSquares), "SCALAR"));
    return asset;
}

}  // namespace

TEST_SUITE("assets/gltf_compression") {
#if defined(CROFTON_MESHOPT)
    TEST_CASE("views compressed by meshoptimizer are what was compressed, a damaged one is named") {
        const auto positions = test_files::strip_positions(kSquares);
        const auto indices = test_files::strip_indices<std::uint32_t>(kSquares);
        const std::size_t vertices = positions.size() / 3;
        std::vector<unsigned char> packed_positions(meshopt_encodeVertexBufferBound(vertices, 12)),
            packed_indices(meshopt_encodeIndexBufferBound(indices.size(), vertices));
        packed_positions.resize(meshopt_encodeVertexBuffer(packed_positions.data(), packed_positions.size(),
                                                           positions.data(), vertices, 12));
        packed_indices.resize(
            meshopt_encodeIndexBuffer(packed_indices.data(), packed_indices.size(), indices.data(), indices.size()));
        Asset asset = plain();
        Json& views = asset.root["bufferViews"];
        const auto compress = [&](std::size_t view, const std::vector<unsigned char>& bytes, std::size_t count,
                                  std::size_t stride, const char* mode) {
            const std::size_t place = asset.view(std::string(bytes.begin(), bytes.end()));
            Json extension = views[place];
            views.erase(place);
            extension["count"] = count;
            extension["byteStride"] = stride;
            extension["mode"] = mode;
            views[view]["buffer"] = 1;
            views[view]["byteOffset"] = 0;
            views[view]["byteLength"] = count * stride;
            views[view]["extensions"]["EXT_meshopt_compression"] = extension;
        };
        compress(0, packed_positions, vertices, 12, "ATTRIBUTES");
        compress(1, packed_indices, indices.size(), 2, "TRIANGLES");
        asset.root["buffers"].push_back(
            {{"byteLength", 4096}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
        asset.root["extensionsUsed"] = asset.root["extensionsRequired"] = {"EXT_meshopt_compression"};
        CHECK(triangles_of(asset) == triangles_of(plain()));
        const TemporaryFile file("whole.glb", asset.glb());
        const auto document = assets::read_gltf_document(file.path()).value();
        CHECK_FALSE(document.root.contains("extensionsRequired"));
        for (const auto& [key, value] : {std::pair<const char*, Json>{"mode", "INDICES?"},
                                         {"count", 3},
                                         {"byteStride", 300},
                                         {"filter", "BLUR"},
                                         {"buffer", 7},
                                         {"byteLength", 5}}) {
            const std::string named = key;  // clang 14 captures no binding
            CAPTURE(named);
            Asset damaged = asset;
            damaged.root["bufferViews"][1]["extensions"]["EXT_meshopt_compression"][key] = value;
            const TemporaryFile bad("damaged.glb", damaged.glb());
            CHECK(says(test_files::message(assets::load_scene(bad.path())), "buffer view 1: EXT_meshopt_compression"));
        }
    }
#endif
#if defined(CROFTON_DRACO)
    TEST_CASE("primitives compressed by Draco are what was compressed, a damaged one is named") {
        const auto positions = test_files::strip_positions(kSquares);
        const auto indices = test_files::strip_indices<std::uint32_t>(kSquares);
        draco::TriangleSoupMeshBuilder builder;
        builder.Start(static_cast<int>(indices.size() / 3));
        const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        for (std::size_t t = 0; t < indices.size(); t += 3)
            builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<std::uint32_t>(t / 3)),
                                              &positions[3 * indices[t]], &positions[3 * indices[t + 1]],
                                              &positions[3 * indices[t + 2]]);
        const auto mesh = builder.Finalize();
        REQUIRE(mesh);
        const std::uint32_t unique = mesh->attribute(id)->unique_id();
        draco::Encoder encoder;
        encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
        draco::EncoderBuffer buffer;
        REQUIRE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
        Asset asset = plain();
        const std::size_t view = asset.view(std::string(buffer.data(), buffer.size()));
        for (Json& accessor : asset.root["accessors"]) accessor.erase("bufferView");
        asset.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
            {"bufferView", view}, {"attributes", {{"POSITION", unique}}}};
        asset.root["extensionsUsed"] = asset.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
        CHECK(triangles_of(asset) == triangles_of(plain()));
        Asset strip = asset;  // what is decoded are triangles all the same
        strip.root["meshes"][0]["primitives"][0]["mode"] = 5;
        CHECK(triangles_of(strip) == triangles_of(plain()));
        for (const auto& [key, value] : {std::pair<const char*, Json>{"bufferView", 99},
                                         {"bufferView", 0},
                                         {"attributes", {{"POSITION", 77}}},
                                         {"attributes", {{"NORMAL", 0}}},
                                         {"attributes", 5}}) {
            const std::string named = key;  // clang 14 captures no binding
            CAPTURE(named);
            Asset damaged = asset;
            damaged.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"][key] = value;
            const TemporaryFile bad("damaged.glb", damaged.glb());
            CHECK(says(test_files::message(assets::load_scene(bad.path())),
                       "mesh 0: primitive 0: KHR_draco_mesh_compression"));
        }
    }
#endif
    TEST_CASE("a file that requires an unknown extension is refused by its name") {
        CHECK_FALSE(assets::decodes("KHR_unknown_compression"));
        Asset asset = plain();
        asset.root["extensionsRequired"] = {"KHR_unknown_compression"};
        const TemporaryFile file("unknown.glb", asset.glb());
        CHECK(
            says(test_files::message(assets::load_scene(file.path())), "needs the extension KHR_unknown_compression"));
    }
}
