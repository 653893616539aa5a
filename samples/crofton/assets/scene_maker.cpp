// SPDX-License-Identifier: MIT
#include "assets/scene_maker.hpp"

namespace crofton::assets {

Transform standing(const glm::dvec3& at, double turn, double scale) {
    return *from_trs(at, glm::angleAxis(turn, glm::dvec3(0, 1, 0)), glm::dvec3(scale));
}

SceneMaker::SceneMaker(const std::string& name, const LoadOptions& options)
    : source_{name, scene::Scene({options.criterion}), {}, {}, {}, {}}, library(source_.scene, options.seed) {
    const auto root = source_.scene.add_node(scene::kNone, Transform{}, ~0u, name);
    if (root)
        root_ = *root;
    else
        status_ = root.error();
}

void SceneMaker::scale(double factor) {
    if (!status_) return;
    if (auto set = source_.scene.set_local(root_, standing({}, 0.0, factor)); !set) status_ = std::move(set);
}

scene::MeshId SceneMaker::add(TriangleMesh mesh, const std::string& name) {
    if (!status_) return scene::kNone;
    auto id = source_.scene.add_mesh(std::move(mesh), name);
    if (id) return *id;
    status_ = id.error();
    return scene::kNone;
}

void SceneMaker::place(scene::MeshId mesh, const glm::dvec3& at, double turn, double scale) {
    place(mesh, standing(at, turn, scale));
}

void SceneMaker::place(scene::MeshId mesh, const Transform& transform) {
    if (!status_ || !library.status()) return;
    const auto node = source_.scene.add_node(root_, transform);
    if (!node) {
        status_ = node.error();
        return;
    }
    if (auto added = source_.scene.add_instance(*node, mesh); !added) status_ = added.error();
}

void SceneMaker::place(MeshBuilder& builder, const std::string& name) {
    const scene::MeshId mesh = library.add(builder, name);
    place(mesh, Transform{});
}

Result<SceneSource> SceneMaker::take(const std::vector<glm::dvec3>& walk) {
    if (!status_) return status_.error();
    if (!library.status()) return library.status().error();
    source_.one_sided.assign(source_.scene.mesh_count(), 1);
    for (const scene::MeshId mesh : two_sided_)
        if (mesh < source_.one_sided.size()) source_.one_sided[mesh] = 0;
    for (const glm::dvec3& place : walk) source_.walk.push_back(source_.scene.local(root_) * place);
    source_.emission = std::move(library.emission);
    return std::move(source_);
}

}  // namespace crofton::assets
