// SPDX-License-Identifier: MIT
// The faces of a Wavefront OBJ file as a scene.
#include <crofton/geometry/box.hpp>

#include "assets/file.hpp"
#include "assets/obj_file.hpp"
#include "assets/scene_source.hpp"
#include "assets/split_mesh.hpp"

namespace crofton::assets {
namespace {

// A file is one frozen mesh as often as not; pieces of this size make it a scene that culling can work on.
constexpr std::size_t kTrianglesPerPiece = 512;

// The part's own vertices only, in order of first use.
TriangleMesh mesh_of(const ObjFile& file, const ObjFile::Part& part, std::vector<std::uint32_t>& new_index) {
    constexpr std::uint32_t kUnused = ~std::uint32_t{0};
    TriangleMesh mesh;
    for (const std::uint32_t old : part.indices) {
        if (new_index[old] == kUnused) {
            new_index[old] = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(glm::vec3(file.positions[old] - file.origin));
            mesh.colors.push_back(file.colors[old].x < 0.0f ? part.color : file.colors[old]);
        }
        mesh.indices.push_back(new_index[old]);
    }
    for (const std::uint32_t old : part.indices) new_index[old] = kUnused;
    return mesh;
}

}  // namespace

Result<SceneSource> load_obj(const std::string& path, const LoadOptions& options) {
    auto read = read_obj(path, {.largest = kMaxCoordinate, .limits = options.limits, .leave_out = !options.strict});
    if (!read) return read.error();
    ObjFile& file = *read;
    file.warnings.insert(file.warnings.end(), file.odd_lines.begin(), file.odd_lines.end());
    SceneSource source{file_name(path), scene::Scene({options.criterion}), {}, {}, std::move(file.warnings), {}};
    const auto root = source.scene.add_node(scene::kNone, {glm::dmat3(1.0), file.origin}, ~0u, source.name);
    if (!root) return in_file(path, "", root.error());
    std::vector<std::uint32_t> new_index(file.positions.size(), ~std::uint32_t{0});
    for (const ObjFile::Part& part : file.parts) {
        if (part.indices.empty()) continue;
        for (TriangleMesh& piece : split_mesh(mesh_of(file, part, new_index), kTrianglesPerPiece)) {
            const auto mesh = source.scene.add_mesh(std::move(piece), part.name);
            if (!mesh) return in_file(path, "object '" + part.name + "'", mesh.error());
            if (part.emission != glm::vec3(0.0f)) {
                source.emission.resize(*mesh + 1);
                source.emission[*mesh].assign(source.scene.mesh(*mesh).triangle_count(), part.emission);
            }
            if (auto added = source.scene.add_instance(*root, *mesh); !added) return in_file(path, "", added.error());
        }
    }
    if (source.scene.instance_count() == 0)
        return fail(ErrorCode::empty, kNoItem,
                    path + ": holds no faces, so there is nothing to draw" + file.unknown_line +
                        (source.warnings.empty() || !file.unknown_line.empty() ? "" : ": " + source.warnings.front()));
    return source;
}

}  // namespace crofton::assets
