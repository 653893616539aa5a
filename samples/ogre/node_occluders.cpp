// SPDX-License-Identifier: MIT
#include "node_occluders.hpp"

#include <OgreSubEntity.h>
#include <OgreTechnique.h>

#include <algorithm>

#include "mesh_triangles.hpp"

namespace crofton::ogre {
namespace {

bool is_solid(const Ogre::Pass& pass) {
    bool red, green, blue, alpha;
    pass.getColourWriteEnabled(red, green, blue, alpha);
    return !pass.isTransparent() && pass.getAlphaRejectFunction() == Ogre::CMPF_ALWAYS_PASS && red && green && blue &&
           pass.getDepthWriteEnabled() && pass.getDepthCheckEnabled() &&
           pass.getCullingMode() != Ogre::CULL_ANTICLOCKWISE && pass.getPolygonMode() == Ogre::PM_SOLID;
}

// By its first pass: further passes only add to what that has drawn.
bool is_solid(const Ogre::SubEntity& part) {
    const Ogre::MaterialPtr& material = part.getMaterial();
    const Ogre::Technique* technique = material ? material->getBestTechnique() : nullptr;
    return part.isVisible() && technique && technique->getNumPasses() > 0 && is_solid(*technique->getPass(0));
}

}  // namespace

bool is_solid(const Ogre::Entity& entity) {
    if (entity.hasSkeleton() || entity.hasVertexAnimation() || entity.getRenderingDistance() > 0.0f) return false;
    if (entity.getMesh()->getNumLodLevels() > 1) return false;
    const auto& parts = entity.getSubEntities();
    return std::all_of(parts.begin(), parts.end(), [](const Ogre::SubEntity* part) { return is_solid(*part); });
}

std::uint32_t layers_of(const Ogre::Entity& entity) {
    return entity.getVisible() ? entity.getVisibilityFlags() : 0;
}

MeshHandle OccluderMeshes::of(const Ogre::Mesh& mesh) {
    const auto [entry, is_new] = meshes_.try_emplace({mesh.getHandle(), mesh.getStateCount()});
    if (!is_new) return entry->second;
    std::vector<glm::vec3> corners;
    for (const Ogre::Vector3& corner : read_triangles(mesh)) corners.emplace_back(corner.x, corner.y, corner.z);
    const auto added = world_.add_mesh({.positions = corners, .triangles = false, .occluders = true});
    if (added && !world_.occluders_of(*added).empty()) entry->second = *added;
    return entry->second;
}

}  // namespace crofton::ogre
