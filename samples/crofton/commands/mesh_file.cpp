// SPDX-License-Identifier: MIT
#include "mesh_file.hpp"

#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "assets/file.hpp"
#include "assets/flat_scene.hpp"
#include "assets/float_origin.hpp"
#include "assets/obj_file.hpp"
#include "assets/scene_source.hpp"

namespace crofton::cli {
namespace {

// Calls visit(mesh, world) for each instance.
template <class Visit>
Result<void> for_each_instance(const std::string& path, const ReadOptions& options, Visit visit) {
    const auto source = load_updated_scene(path, options);
    if (!source) return source.error();
    if (assets::instanced_triangles(source->scene) > options.limits.triangles)
        return assets::in_file(path, "its instances have", assets::over_limit("triangles", options.limits.triangles));
    for (scene::InstanceId i = 0; i < source->scene.instance_count(); ++i)
        visit(source->scene.mesh(source->scene.mesh_of(i)), source->scene.world(source->scene.node_of(i)));
    return {};
}

// Moves the vertices to an origin near them.
Result<PlacedMesh> placed(std::span<const glm::dvec3> positions, const glm::dvec3& origin,
                          Vector<std::uint32_t> indices, const std::string& path, const std::string& why = {}) {
    if (indices.empty()) return fail(ErrorCode::empty, kNoItem, path + ": no triangles" + why);
    PlacedMesh result{{}, origin};
    result.mesh.indices = std::move(indices);
    for (const glm::dvec3& p : positions) result.mesh.positions.push_back(glm::vec3(p - origin));
    return result;
}

Result<PlacedMesh> load_obj_mesh(const std::string& path, const ReadOptions& options) {
    const auto file = assets::read_obj(path, {.limits = options.limits});
    if (!file) return file.error();
    if (auto whole = refuse_if_strict(path, file->odd_lines, options); !whole) return whole.error();
    print_warnings(file->odd_lines);
    Vector<std::uint32_t> indices;
    for (const assets::ObjFile::Part& part : file->parts)
        indices.insert(indices.end(), part.indices.begin(), part.indices.end());
    return placed(file->positions, file->origin, std::move(indices), path, file->unknown_line);
}

}  // namespace

Result<PlacedMesh> load_mesh(const std::string& path, const ReadOptions& options) {
    if (assets::extension(path) == "obj") return load_obj_mesh(path, options);
    std::vector<glm::dvec3> positions;
    Vector<std::uint32_t> indices;
    glm::dvec3 low(std::numeric_limits<double>::max()), high = -low;
    const auto loaded = for_each_instance(path, options, [&](const TriangleMesh& mesh, const Transform& world) {
        const auto base = static_cast<std::uint32_t>(positions.size());
        for (const glm::vec3& p : mesh.positions) {
            positions.push_back(world * glm::dvec3(p));
            low = glm::min(low, positions.back());
            high = glm::max(high, positions.back());
        }
        const std::size_t first = indices.size();
        for (const std::uint32_t index : mesh.indices) indices.push_back(base + index);
        // Mirrored, what was outside would be inside.
        if (glm::dot(world.linear[0], glm::cross(world.linear[1], world.linear[2])) >= 0.0) return;
        for (std::size_t i = first; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
    });
    if (!loaded) return loaded.error();
    return placed(positions, assets::float_origin(low, high), std::move(indices), path);
}

Result<std::vector<glm::dvec3>> load_points(const std::string& path, const ReadOptions& options) {
    std::vector<glm::dvec3> points;
    if (assets::extension(path) == "obj") {
        auto file = assets::read_obj(path, {.largest = std::numeric_limits<double>::max(), .limits = options.limits});
        if (!file) return file.error();
        points = std::move(file->positions);
    } else if (const auto loaded = for_each_instance(path, options,
                                                     [&](const TriangleMesh& mesh, const Transform& world) {
                                                         for (const glm::vec3& p : mesh.positions)
                                                             points.push_back(world * glm::dvec3(p));
                                                     });
               !loaded)
        return loaded.error();
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, path + ": no vertices");
    return points;
}

}  // namespace crofton::cli
