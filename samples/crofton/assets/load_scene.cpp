// SPDX-License-Identifier: MIT
#include <crofton/bake/region_files.hpp>
#include <filesystem>

#include "assets/file.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

Result<SceneSource> checked(Result<SceneSource> source, const std::string& path, const LoadOptions& options) {
    if (options.strict && source && !source->warnings.empty())
        return fail(ErrorCode::parse, kNoItem, path + ": " + source->warnings.front() + " (refused: --strict)");
    return source;
}

}  // namespace

bool is_made(const std::string& source) {
    for (const char* name : {"town", "room", "office", "valley", "hall"})
        if (source == name) return true;
    return holds_city_parts(source);
}

Result<void> refuse_regions(const std::string& path) {
    const std::string holder = folder(path).empty() ? "." : folder(path);
    if (file_name(path) == bake::kRegionIndexName && bake::open_region_index(holder))
        return fail(ErrorCode::unsupported, kNoItem, path + ": is the index of a folder of regions; name the folder");
    std::error_code ignored;
    if (!std::filesystem::exists(path + "/" + bake::kRegionIndexName, ignored)) return {};
    return fail(ErrorCode::unsupported, kNoItem,
                path + ": is a folder of regions, which frames, view, bake and pvs take; name one of its files");
}

namespace {

Result<SceneSource> load_by_kind(const std::string& source, const LoadOptions& options) {
    const std::string kind = extension(source);
    if (kind != "wad" && !options.map.empty())
        return fail(ErrorCode::invalid_argument, kNoItem, source + ": a map can be chosen in a .wad file only");
    if (options.instances != 0 && source != "town")
        return fail(ErrorCode::invalid_argument, kNoItem, source + ": a number of instances goes with the town only");
    if (options.unit > 0.0 && is_made(source))
        return fail(ErrorCode::invalid_argument, kNoItem, source + ": is in metres; a unit goes with files only");
    if (source == "town") return make_town(options);
    if (source == "room") return make_room(options);
    if (source == "office") return make_office(options);
    if (source == "valley") return make_valley(options);
    if (source == "hall") return make_hall(options);
    if (auto scene = refuse_regions(source); !scene) return scene.error();
    std::error_code ignored;
    if (std::filesystem::is_directory(source, ignored)) {
        if (holds_city_parts(source)) return make_city(source, options);
        return fail(ErrorCode::io, kNoItem, source + ": is a folder; name a file in it");
    }
    if (std::filesystem::is_regular_file(source, ignored) && std::filesystem::is_empty(source, ignored))
        return fail(ErrorCode::empty, kNoItem, source + ": the file is empty");
    if (kind == "crofton") return load_baked(source, options);
    if (kind == "glb" || kind == "gltf") return checked(load_gltf(source, options), source, options);
    if (kind == "obj") {
        auto loaded = checked(load_obj(source, options), source, options);
        if (loaded) loaded->unit = 0.0;
        return loaded;
    }
    if (kind == "wad") return checked(load_wad(source, options), source, options);
    return fail(ErrorCode::unsupported, kNoItem,
                source +
                    ": unknown kind of scene; known are town, room, office, valley, hall, folders of city parts, and "
                    "files .glb, .gltf, .obj, .wad and .crofton");
}

}  // namespace

Result<SceneSource> load_scene(const std::string& source, const LoadOptions& options) {
    auto loaded = load_by_kind(source, options);
    if (loaded && options.unit > 0.0) loaded->unit = options.unit;
    return loaded;
}

}  // namespace crofton::assets
