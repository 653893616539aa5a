// SPDX-License-Identifier: MIT
#include "assets/gltf_extensions.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "assets/gltf_compression.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 5> kRead = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
                                                   "KHR_node_visibility", "KHR_materials_unlit",
                                                   "KHR_materials_emissive_strength"};

// The parts of names, after the vendor's prefix, that stand for appearance only.
constexpr std::array<std::string_view, 10> kAnyAppearance = {"texture_",        "materials_", "lights_",    "image_",
                                                             "lightmap",        "audio",      "animation_", "media",
                                                             "temporal_light_", "xmp"};
// Beginnings of names.
constexpr std::array<std::string_view, 24> kAppearance = {
    "KHR_technique", "KHR_environment_map",
    // what vertices, faces and instances mean, and which edges are drawn as lines
    "EXT_mesh_features", "EXT_instance_features", "EXT_feature_metadata", "EXT_structural_metadata",
    "EXT_mesh_manifold", "EXT_mesh_primitive_edge_visibility", "CESIUM_primitive_outline", "FB_",
    // metadata and behaviour; coarser levels of detail (MSFT_lod) are no children of the node that is shown
    "KHR_interactivity", "KHR_physics_", "KHR_implicit_shapes", "KHR_collision_shapes", "KHR_node_hoverability",
    "KHR_node_selectability", "AGI_", "VRM", "OMI_", "MSFT_", "MOZ_hubs_", "GODOT_", "GRIFFEL_", "NEEDLE_components"};

bool begins_with(std::string_view text, std::string_view with) {
    return text.substr(0, with.size()) == with;
}

class ExtensionCheck {
  public:
    explicit ExtensionCheck(const GltfDocument& document) : root_(document.root) {}

    Result<std::vector<std::string>> run() {
        for (std::size_t i = 0; const Json* name = entry(root_, "extensionsRequired", i); ++i)
            if (name->is_string())
                if (auto done = check_required(name->get_ref<const std::string&>()); !done) return done.error();
        for (const auto& [list, what] : {std::pair("scenes", "scene"),
                                         {"nodes", "node"},
                                         {"meshes", "mesh"},
                                         {"skins", "skin"},
                                         {"accessors", "accessor"},
                                         {"bufferViews", "buffer view"}})
            for (std::size_t i = 0; const Json* object = entry(root_, list, i); ++i) check_list_entry(what, i, *object);
        // It moves the whole asset.
        if (const Json* extensions = member(root_, "extensions"); extensions && member(*extensions, "CESIUM_RTC"))
            note("CESIUM_RTC", "the asset");
        for (auto& [name, warning] : warnings_) result_.push_back(std::move(warning));
        return std::move(result_);
    }

  private:
    Result<void> check_required(const std::string& name) {
        switch (use_of(name)) {
            case ExtensionUse::read:
            case ExtensionUse::decoded:
                return {};
            case ExtensionUse::no_decoder:
                return fail(ErrorCode::unsupported, kNoItem, why_compressed(name));
            case ExtensionUse::appearance:
                warnings_.try_emplace(
                    name, "needs the extension " + name + ", which is not read; its triangles are shown without it");
                return {};
            case ExtensionUse::unknown:
                break;
        }
        return fail(ErrorCode::unsupported, kNoItem, "needs the extension " + name + ", which is not supported");
    }

    void check_list_entry(const char* what, std::size_t index, const Json& object) {
        check_object(object, what, index);
        for (std::size_t p = 0; const Json* primitive = entry(object, "primitives", p); ++p)
            check_object(*primitive, what, index);
    }

    void check_object(const Json& object, const char* what, std::size_t index) {
        const Json* extensions = member(object, "extensions");
        if (!extensions || !extensions->is_object()) return;
        for (const auto& item : extensions->items())
            if (use_of(item.key()) == ExtensionUse::unknown)
                note(item.key(), std::string(what) + " " + std::to_string(index));
    }

    // Compressions say for themselves what they leave out.
    void note(const std::string& name, const std::string& where) {
        if (name.find("compression") != std::string::npos) return;
        warnings_.try_emplace(
            name, "has the extension " + name + " (first on " + where + "), which is not read; shown without it");
    }

    const Json& root_;
    std::map<std::string, std::string> warnings_;
    std::vector<std::string> result_;
};

}  // namespace

ExtensionUse use_of(std::string_view extension) {
    if (std::find(kRead.begin(), kRead.end(), extension) != kRead.end()) return ExtensionUse::read;
    if (decodes(extension)) return ExtensionUse::decoded;
    if (decoder_package(extension)) return ExtensionUse::no_decoder;
    const auto known = [&](std::string_view name) { return begins_with(extension, name); };
    const auto after_vendor = [&](std::string_view name) {
        const std::size_t end = extension.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789");
        return end != std::string_view::npos && extension[end] == '_' && begins_with(extension.substr(end + 1), name);
    };
    return std::any_of(kAppearance.begin(), kAppearance.end(), known) ||
                   std::any_of(kAnyAppearance.begin(), kAnyAppearance.end(), after_vendor)
               ? ExtensionUse::appearance
               : ExtensionUse::unknown;
}

Result<std::vector<std::string>> check_extensions(const GltfDocument& document) {
    return ExtensionCheck(document).run();
}

}  // namespace crofton::assets
