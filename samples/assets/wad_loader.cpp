#include "assets/scene_source.hpp"
namespace crofton::assets {
Result<SceneSource> load_wad(const std::string& path, const LoadOptions&) { return fail(ErrorCode::unsupported, kNoItem, path + ": later"); }
}
