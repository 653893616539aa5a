// SPDX-License-Identifier: MIT
#include "mesh_file.hpp"

#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "assets/file.hpp"
#include "assets/flat_scene.hpp"
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

Result<TriangleMesh> with_triangles(TriangleMesh mesh, const std::string& path, const std::string& why = {}) {
    if (mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, path + ": no triangles" + why);
    return mesh;
}

Result<TriangleMesh> load_obj_mesh(const std::string& path, const ReadOptions& options) {
    const auto file = assets::read_obj(path, {.limits = options.limits});
    if (!file) return file.error();
    if (auto whole = refuse_if_strict(path, file->odd_faces, options); !whole) return whole.error();
    print_warnings(file->odd_faces);
    TriangleMesh mesh;
    mesh.positions.assign(file->positions.begin(), file->positions.end());
    for (const assets::ObjFile::Part& part : file->parts)
        mesh.indices.insert(mesh.indices.end(), part.indices.begin(), part.indices.end());
    return with_triangles(std::move(mesh), path, file->unknown_line);
}

}  // namespace

Result<TriangleMesh> load_mesh(const std::string& path, const ReadOptions& options) {
    if (assets::extension(path) == "obj") return load_obj_mesh(path, options);
    TriangleMesh all;
    const auto loaded = for_each_instance(path, options, [&](const TriangleMesh& mesh, const Transform& world) {
        const auto base = static_cast<std::uint32_t>(all.positions.size());
        for (const glm::vec3& p : mesh.positions) all.positions.push_back(glm::vec3(world * glm::dvec3(p)));
        const std::size_t first = all.indices.size();
        for (const std::uint32_t index : mesh.indices) all.indices.push_back(base + index);
        // Mirrored, what was outside would be inside.
        if (glm::dot(world.linear[0], glm::cross(world.linear[1], world.linear[2])) >= 0.0) return;
        for (std::size_t i = first; i < all.indices.size(); i += 3) std::swap(all.indices[i + 1], all.indices[i + 2]);
    });
    if (!loaded) return loaded.error();
    return with_triangles(std::move(all), path);
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
