#include "assets/file.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {

Result<SceneSource> load_scene(const std::string& source, const LoadOptions& options) {
    if (source == "town") return make_town(options);
    if (source == "room") return make_room(options);
    const std::string kind = extension(source);
    if (kind != "wad" && !options.map.empty())
        return fail(ErrorCode::invalid_argument, kNoItem, source + ": a map can be chosen in a .wad file only");
    if (kind == "glb" || kind == "gltf") return load_gltf(source, options);
    if (kind == "obj") return load_obj(source, options);
    if (kind == "wad") return load_wad(source, options);
    return fail(ErrorCode::unsupported, kNoItem,
                source + ": unknown kind of scene; known are town, room and files .glb, .gltf, .obj and .wad");
}

}  // namespace crofton::assets
