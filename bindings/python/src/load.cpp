// SPDX-License-Identifier: MIT
// Files of scenes: the loaders of the command line.
#include <assets/scene_source.hpp>

#include "mesh.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

// A mesh of the file under its transform.
TriangleMesh placed(const TriangleMesh& mesh, const Transform& world) {
    TriangleMesh result = mesh;
    for (glm::vec3& p : result.positions) p = glm::vec3(world * glm::dvec3(p));
    if (glm::dot(world.linear[0], glm::cross(world.linear[1], world.linear[2])) < 0.0)
        for (std::size_t i = 0; i < result.indices.size(); i += 3) std::swap(result.indices[i], result.indices[i + 2]);
    return result;
}

// (meshes, warnings)
py::tuple load(const std::string& path) {
    auto source = value_of(unlocked([&]() -> Result<assets::SceneSource> {
        auto loaded = assets::load_scene(path);
        if (loaded) loaded->scene.update();
        return loaded;
    }));
    py::list meshes;
    const scene::Scene& scene = source.scene;
    std::uint64_t triangles = 0;
    const assets::ReadLimits limits;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        const scene::MeshId id = scene.mesh_of(i);
        triangles += scene.mesh(id).triangle_count();
        if (triangles > limits.triangles)
            raise({ErrorCode::budget_exceeded, kNoItem,
                   path + ": its instances have more than " + std::to_string(limits.triangles) + " triangles"});
        const scene::NodeId node = scene.node_of(i);
        std::string name(scene.node_name(node));
        if (name.empty()) name = scene.mesh_name(id);
        meshes.append(make_mesh(placed(scene.mesh(id), scene.world(node)), std::move(name)));
    }
    py::list warnings;
    for (const std::string& text : source.warnings) warnings.append(text);
    return py::make_tuple(meshes, warnings);
}

}  // namespace

void bind_load(py::module_& module) {
    module.def("_load", &load, py::arg("path"));
}

}  // namespace crofton::python
