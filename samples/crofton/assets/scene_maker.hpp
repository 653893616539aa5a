// SPDX-License-Identifier: MIT
// Helper of the built-in scenes: one root, objects placed under it, and the first error.
#pragma once
#include <string>

#include "assets/scene_source.hpp"
#include "assets/town_library.hpp"

namespace crofton::assets {

class SceneMaker {
    SceneSource source_;

  public:
    SceneMaker(const std::string& name, const LoadOptions& options);

    town::Library library;

    // Scales everything that is placed.
    void scale(double factor);
    scene::MeshId add(TriangleMesh mesh, const std::string& name);

    void place(scene::MeshId mesh, const glm::dvec3& at, double turn = 0.0, double scale = 1.0);
    void place(scene::MeshId mesh, const Transform& transform);
    // The builder's shapes as a mesh that stands once, where they were built.
    void place(MeshBuilder& builder, const std::string& name);
    // Shows the mesh's back faces too.
    void show_both_sides(scene::MeshId mesh) { two_sided_.push_back(mesh); }

    // `walk`: in the places of the caller, before the scale. Errors: the first of those before.
    [[nodiscard]] Result<SceneSource> take(const std::vector<glm::dvec3>& walk);

  private:
    Result<void> status_;
    scene::NodeId root_ = scene::kNone;
    std::vector<scene::MeshId> two_sided_;
};

// Turned about y, and placed.
[[nodiscard]] Transform standing(const glm::dvec3& at, double turn, double scale = 1.0);

}  // namespace crofton::assets
