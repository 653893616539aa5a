// SPDX-License-Identifier: MIT
// Extensions of glTF that are not read: what is shown without them, with which warning, and what is refused.
#include <doctest/doctest.h>
#include <assets/gltf_compression.hpp>
#include <assets/gltf_extensions.hpp>
#include <assets/scene_source.hpp>

#include "gltf_asset.hpp"
#include "messages.hpp"

using namespace crofton;
using test_files::Asset;
using test_files::Json;
using test_files::says;
using test_files::TemporaryFile;

namespace {

Asset sail() {
    Asset asset;
    const auto positions = asset.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    asset.mesh(positions, asset.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR"));
    return asset;
}

std::string first_words(const Asset& asset, const assets::LoadOptions& options = {}) {
    const TemporaryFile file("extended.glb", asset.glb());
    const auto source = assets::load_scene(file.path(), options);
    if (!source) return "refused: " + source.error().message;
    CHECK(source->scene.instance_count() == 1);
    if (source->warnings.empty()) return "loaded";
    CHECK(source->warnings.size() == 1);
    return source->warnings[0];
}

}  // namespace

TEST_SUITE("assets/gltf_extensions") {
    TEST_CASE("required extensions that touch no geometry are shown without, with a warning") {
        for (const std::string name : {"KHR_texture_basisu",
                                       "EXT_texture_webp",
                                       "EXT_texture_avif",
                                       "KHR_texture_transform",
                                       "MSFT_texture_dds",
                                       "KHR_materials_transmission",
                                       "KHR_materials_variants",
                                       "KHR_materials_pbrSpecularGlossiness",
                                       "ADOBE_materials_clearcoat_tint",
                                       "BENTLEY_materials_line_style",
                                       "ACME_texture_squeezed",
                                       "ACME_lights_tube",
                                       "MPEG_texture_video",
                                       "KHR_collision_shapes",
                                       "KHR_lights_punctual",
                                       "EXT_lights_image_based",
                                       "EXT_lights_ies",
                                       "KHR_xmp_json_ld",
                                       "KHR_xmp",
                                       "KHR_animation_pointer",
                                       "MSFT_lod",
                                       "MSFT_packing_occlusionRoughnessMetallic",
                                       "EXT_mesh_features",
                                       "EXT_structural_metadata",
                                       "KHR_audio_emitter",
                                       "MPEG_audio_spatial",
                                       "MPEG_media",
                                       "MAXAR_image_ortho",
                                       "MAXAR_temporal_light_traits",
                                       "NEEDLE_lightmaps",
                                       "NEEDLE_components",
                                       "EXT_animation_map",
                                       "AGI_articulations",
                                       "VRM",
                                       "VRMC_vrm",
                                       "KHR_interactivity",
                                       "KHR_node_selectability"}) {
            CAPTURE(name);
            Asset asset = sail();
            asset.root["extensionsUsed"] = asset.root["extensionsRequired"] = {name};
            asset.root["nodes"][0]["extensions"][name] = Json::object();
            CHECK(first_words(asset) ==
                  "needs the extension " + name + ", which is not read; its triangles are shown without it");
            CHECK(says(first_words(asset, {.strict = true}), "refused: "));
            asset.root.erase("extensionsRequired");
            CHECK(first_words(asset, {.strict = true}) == "loaded");
        }
    }

    TEST_CASE("required extensions that are read say nothing, unknown ones are refused by name") {
        for (const std::string name : {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                                       "KHR_materials_unlit", "KHR_materials_emissive_strength"}) {
            Asset asset = sail();
            asset.root["extensionsRequired"] = {name};
            CHECK(first_words(asset, {.strict = true}) == "loaded");
        }
        for (const std::string name : {"ACME_tessellation", "CESIUM_RTC", "KHR_gaussian_splatting", "EXT_mesh_polygon",
                                       "khr_materials_unlit", "", "MSFT"}) {
            Asset asset = sail();
            asset.root["extensionsRequired"] = {"KHR_materials_unlit", name};
            CHECK(says(first_words(asset), "extended.glb: needs the extension " + name + ", which is not supported"));
        }
        Asset odd = sail();
        odd.root["extensionsRequired"] = {5, nullptr, Json::object()};
        odd.root["extensionsUsed"] = "x";
        CHECK(first_words(odd) == "loaded");
    }

    TEST_CASE("unknown extensions on what has to do with geometry get one warning each, listed as used or not") {
        const auto put = [](const char* list, bool on_primitive) {
            Asset asset = sail();
            Json& object = asset.root[list][0];
            (on_primitive ? object["primitives"][0] : object)["extensions"]["ACME_bend"] = {{"by", 90}};
            return first_words(asset);
        };
        const auto warning = [](const std::string& where) {
            return "has the extension ACME_bend (first on " + where + " 0), which is not read; shown without it";
        };
        CHECK(put("scenes", false) == warning("scene"));
        CHECK(put("nodes", false) == warning("node"));
        CHECK(put("meshes", false) == warning("mesh"));
        CHECK(put("meshes", true) == warning("mesh"));
        CHECK(put("accessors", false) == warning("accessor"));
        CHECK(put("bufferViews", false) == warning("buffer view"));
        Asset asset = sail();
        asset.root["materials"] = {{{"extensions", {{"ACME_paint", Json::object()}}}}};
        asset.root["extensions"]["ACME_notes"] = Json::object();
        asset.root["extensionsUsed"] = {"ACME_paint", "ACME_notes"};
        CHECK(first_words(asset) == "loaded");
        asset.root["extensions"]["CESIUM_RTC"] = {{"center", {1, 2, 3}}};
        CHECK(says(first_words(asset), "has the extension CESIUM_RTC (first on the asset)"));
    }

    TEST_CASE("if a build lacks a decoder, the message says which and what to install") {
        for (const auto& [name, package] :
             {std::pair<std::string, std::string>("KHR_draco_mesh_compression", "libdraco-dev"),
              {"EXT_meshopt_compression", "libmeshoptimizer-dev"},
              {"KHR_meshopt_compression", "libmeshoptimizer-dev"}}) {
            CHECK(assets::decoder_package(name) == package);
            if (assets::decodes(name)) {
                CHECK(assets::use_of(name) == assets::ExtensionUse::decoded);
                continue;
            }
            CHECK(assets::use_of(name) == assets::ExtensionUse::no_decoder);
            Asset asset = sail();
            asset.root["extensionsRequired"] = {name};
            const std::string why =
                "this build has no decoder for " + name + ": install " + package + " and configure again";
            CHECK(assets::why_compressed(name) == why);
            // Nothing of it is compressed, so that the name alone is no reason.
            CHECK(first_words(asset) == "loaded");
            asset.root["bufferViews"][0]["extensions"][name] =
                asset.root["meshes"][0]["primitives"][0]["extensions"][name] = Json::object();
            asset.root["buffers"].push_back({{"byteLength", 64}});
            asset.root["bufferViews"][0]["buffer"] = 1;
            asset.root["accessors"][0].erase("bufferView");
            CHECK(says(first_words(asset), why));
        }
        CHECK(assets::decoder_package("KHR_unknown_compression") == nullptr);
        CHECK(assets::why_compressed("KHR_unknown_compression") ==
              "compressed by KHR_unknown_compression, which is not supported");
    }

    TEST_CASE("an uncompressed copy is read where the compressed bytes cannot be") {
        // Garbage for the decoders; what views and accessors name is sound.
        Asset asset = sail();
        asset.root["extensionsUsed"] = {"EXT_meshopt_compression", "KHR_draco_mesh_compression"};
        const auto garbage = asset.view("garbage!");
        Json compressed = asset.root["bufferViews"][garbage];
        compressed["count"] = 3;
        compressed["byteStride"] = 12;
        compressed["mode"] = "ATTRIBUTES";
        asset.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = compressed;
        asset.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
            {"bufferView", garbage}, {"attributes", {{"POSITION", 0}}}};
        const TemporaryFile file("copy.glb", asset.glb());
        const auto untouched = assets::read_gltf_document(file.path()).value();
        CHECK(untouched.root["bufferViews"][0].contains("extensions"));
        const auto document = assets::read_gltf_document(file.path(), {.limits = {}, .plain_copies = true}).value();
        CHECK_FALSE(document.root["bufferViews"][0].contains("extensions"));
        CHECK_FALSE(document.root["meshes"][0]["primitives"][0].contains("extensions"));
        CHECK_FALSE(document.root.contains("extensionsUsed"));
        const auto source = assets::load_scene(file.path());
        REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
        CHECK(source->scene.mesh(0).positions[1] == glm::vec3(1.0f, 0.0f, 0.0f));
        CHECK(source->warnings.size() == std::size_t{assets::decodes("EXT_meshopt_compression")} +
                                             std::size_t{assets::decodes("KHR_draco_mesh_compression")});
        for (const std::string& warning : source->warnings)
            CHECK(says(warning, "is damaged; its uncompressed copy is read"));
    }
}
