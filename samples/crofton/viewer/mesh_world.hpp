// SPDX-License-Identifier: MIT
// The scene's meshes in a World: what a ray hits, and where bodies touch.
#pragma once
#include <crofton/crofton.hpp>
#include <crofton/scene/scene.hpp>
#include <span>
#include <vector>

namespace crofton::viewer {

// Objects have their instance's number as user data. The scene must outlive it, with the instances it has now.
class MeshWorld {
  public:
    // Errors: as World::add_mesh and World::add, with the mesh or the instance as item.
    [[nodiscard]] static Result<MeshWorld> create(const scene::Scene& scene, std::vector<scene::InstanceId> movers);

    // Follows the movers. Contacts between them are found only where asked for: they cost more than all else.
    [[nodiscard]] Result<void> update(bool contacts);

    [[nodiscard]] const World& world() const { return world_; }

  private:
    MeshWorld(const scene::Scene& scene, std::vector<scene::InstanceId> movers);
    [[nodiscard]] Result<void> add_meshes();
    [[nodiscard]] Result<void> add_objects();

    const scene::Scene* scene_;
    std::vector<scene::InstanceId> movers_;
    World world_{{.containment = false}};
    std::vector<MeshHandle> meshes_;     // by mesh; null where it has no triangles
    std::vector<ObjectHandle> objects_;  // by instance; null where it is removed or has no triangles
    bool finds_contacts_ = false;
};

}  // namespace crofton::viewer
