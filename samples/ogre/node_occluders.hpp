// SPDX-License-Identifier: MIT
// What OGRE's entities hide other things with: objects of a World that only occlude.
#pragma once
#include <OgreEntity.h>

#include <crofton/crofton.hpp>
#include <map>
#include <utility>

namespace crofton::ogre {

// The mesh of an entity that is drawn as it is and opaque: no blending or alpha test, both colour and depth written, no
// animation, no levels of detail, at every distance. False for all else.
[[nodiscard]] bool is_solid(const Ogre::Entity& entity);

// OGRE's visibility flags are the layers: what a view's mask leaves out hides nothing in it.
[[nodiscard]] std::uint32_t layers_of(const Ogre::Entity& entity);

// Meshes of a World by OGRE's, read back once each.
class OccluderMeshes {
  public:
    explicit OccluderMeshes(World& world) : world_(world) {}
    // Null for a mesh in which no occluder is found, or that cannot be read.
    [[nodiscard]] MeshHandle of(const Ogre::Mesh& mesh);

  private:
    World& world_;
    // By handle and count of loads: neither comes back for another mesh.
    std::map<std::pair<Ogre::ResourceHandle, std::size_t>, MeshHandle> meshes_;
};

}  // namespace crofton::ogre
