// SPDX-License-Identifier: MIT
// Instances as drawing and counting ask about them: of a scene, or of a world's regions.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/scene/scene.hpp>
#include <glm/matrix.hpp>
#include <span>

namespace crofton::pipeline {

class Drawables {
  public:
    virtual ~Drawables() = default;
    [[nodiscard]] virtual std::size_t mesh_count() const = 0;
    [[nodiscard]] virtual const TriangleMesh& mesh(scene::MeshId mesh) const = 0;  // empty once removed
    [[nodiscard]] virtual scene::MeshId mesh_of(scene::InstanceId instance) const = 0;
    [[nodiscard]] virtual Transform world_of(scene::InstanceId instance) const = 0;
};

class SceneDrawables final : public Drawables {
  public:
    explicit SceneDrawables(const scene::Scene& scene) : scene_(scene) {}
    [[nodiscard]] std::size_t mesh_count() const override { return scene_.mesh_count(); }
    [[nodiscard]] const TriangleMesh& mesh(scene::MeshId mesh) const override { return scene_.mesh(mesh); }
    [[nodiscard]] scene::MeshId mesh_of(scene::InstanceId instance) const override { return scene_.mesh_of(instance); }
    [[nodiscard]] Transform world_of(scene::InstanceId instance) const override {
        return scene_.world(scene_.node_of(instance));
    }

  private:
    const scene::Scene& scene_;
};

// Back faces of the instance are not seen, by flags of its mesh: 0 beyond their end. Mirrored, fronts and backs change
// places: such instances show both.
[[nodiscard]] inline bool is_one_sided(const Drawables& drawables, std::span<const std::uint8_t> one_sided,
                                       scene::InstanceId instance) {
    const scene::MeshId mesh = drawables.mesh_of(instance);
    return mesh < one_sided.size() && one_sided[mesh] != 0 &&
           glm::determinant(drawables.world_of(instance).linear) > 0.0;
}

}  // namespace crofton::pipeline
