// SPDX-License-Identifier: MIT
#include "frame_check.hpp"

#include <OgreSubEntity.h>
#include <OgreViewport.h>

#include <algorithm>

#include "mesh_triangles.hpp"

namespace crofton::ogre {
namespace {

bool is_queued(const Ogre::Entity& entity, const QueueRecorder::Pass& pass) {
    const Ogre::Renderable* renderable = const_cast<Ogre::Entity&>(entity).getSubEntity(0);
    return std::binary_search(pass.queued.begin(), pass.queued.end(), renderable);
}

// A vertex that OGRE's own frustum sees, or else a triangle that meets the frustum.
bool can_be_seen(const Ogre::Entity& entity, const QueueRecorder::Pass& pass, MeshTriangles& meshes) {
    const Ogre::Affine3& matrix = entity.getParentNode()->_getFullTransform();
    std::vector<Ogre::Vector3> corners = meshes.of(*entity.getMesh());
    for (Ogre::Vector3& corner : corners) {
        corner = matrix * corner;
        if (pass.camera->isVisible(corner)) return true;
    }
    const auto to_glm = [](const Ogre::Vector3& v) { return glm::dvec3(v.x, v.y, v.z); };
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        if (intersects(pass.frustum, to_glm(corners[i]), to_glm(corners[i + 1]), to_glm(corners[i + 2]))) return true;
    return false;
}

}  // namespace

QueueRecorder::QueueRecorder(SceneManager& manager) : manager_(manager) {
    manager_.addListener(this);
    manager_.getRenderQueue()->setRenderableListener(this);
}

QueueRecorder::~QueueRecorder() {
    manager_.getRenderQueue()->setRenderableListener(nullptr);
    manager_.removeListener(this);
}

std::vector<QueueRecorder::Pass> QueueRecorder::take() {
    return std::move(passes_);
}

bool QueueRecorder::renderableQueued(Ogre::Renderable* renderable, Ogre::uint8, Ogre::ushort, Ogre::Technique**,
                                     Ogre::RenderQueue*) {
    if (!passes_.empty()) passes_.back().queued.push_back(renderable);
    return true;
}

void QueueRecorder::preFindVisibleObjects(Ogre::SceneManager*, Ogre::SceneManager::IlluminationRenderStage stage,
                                          Ogre::Viewport* viewport) {
    Pass pass;
    pass.camera = viewport->getCamera();
    pass.shadows = stage == Ogre::SceneManager::IRS_RENDER_TO_TEXTURE;
    pass.frustum = SceneManager::frustum_of(*pass.camera);
    passes_.push_back(std::move(pass));
}

void QueueRecorder::postFindVisibleObjects(Ogre::SceneManager*, Ogre::SceneManager::IlluminationRenderStage,
                                           Ogre::Viewport*) {
    std::sort(passes_.back().queued.begin(), passes_.back().queued.end());
    passes_.back().times = manager_.find_times();
}

const std::vector<Ogre::Vector3>& MeshTriangles::of(const Ogre::Mesh& mesh) {
    const auto [entry, is_new] = corners_.try_emplace(&mesh);
    if (is_new) entry->second = read_triangles(mesh);
    return entry->second;
}

FrameCheck check_pass(City& city, const QueueRecorder::Pass& ogre, const QueueRecorder::Pass& crofton,
                      MeshTriangles& meshes) {
    FrameCheck check;
    check.ogre = ogre.queued.size();
    check.crofton = crofton.queued.size();
    for (const Ogre::Renderable* renderable : crofton.queued)
        if (!std::binary_search(ogre.queued.begin(), ogre.queued.end(), renderable)) ++check.not_in_ogre;
    for (const Ogre::Entity* entity : city.entities()) {
        const bool expected =
            (entity->getVisibilityFlags() & kShown) != 0 && (!crofton.shadows || entity->getCastShadows());
        if (!expected && is_queued(*entity, crofton)) ++check.not_in_ogre;
        if (expected && !is_queued(*entity, crofton) && can_be_seen(*entity, crofton, meshes)) ++check.missing;
    }
    return check;
}

}  // namespace crofton::ogre
