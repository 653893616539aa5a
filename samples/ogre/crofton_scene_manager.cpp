// SPDX-License-Identifier: MIT
#include "crofton_scene_manager.hpp"

#include <OgreCamera.h>
#include <OgreEntity.h>
#include <OgreRenderQueue.h>
#include <OgreRenderQueueSortingGrouping.h>
#include <OgreRoot.h>

#include <chrono>
#include <crofton/scene/transformed_box.hpp>
#include <cstdint>
#include <glm/matrix.hpp>
#include <optional>

namespace crofton::ogre {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

glm::dvec3 to_glm(const Ogre::Vector3& v) {
    return {v.x, v.y, v.z};
}

Aabb to_aabb(const Ogre::AxisAlignedBox& box) {
    Aabb result;
    result.include(to_glm(box.getMinimum()));
    result.include(to_glm(box.getMaximum()));
    return result;
}

Transform transform_of(const SceneNode& node) {
    const Ogre::Affine3& matrix = node._getFullTransform();
    Transform transform;
    for (unsigned row = 0; row < 3; ++row) {
        const auto r = static_cast<int>(row);
        for (int column = 0; column < 3; ++column)
            transform.linear[column][r] = matrix[row][static_cast<unsigned>(column)];
        transform.translation[r] = matrix[row][3];
    }
    return transform;
}

glm::dmat4 to_glm(const Ogre::Matrix4& m) {
    glm::dmat4 result;
    for (unsigned row = 0; row < 4; ++row)
        for (unsigned column = 0; column < 4; ++column)
            result[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
    return result;
}

// Entities deform nothing outside their local box, which turns with the node; other objects (particles, billboards) may
// live in world space, where only their axis-aligned box is known. Empty if the objects have no extent at all.
std::optional<Obb> box_of(const SceneNode& node) {
    Aabb local, world;
    for (const Ogre::MovableObject* object : node.getAttachedObjects()) {
        const Ogre::AxisAlignedBox& box = object->getBoundingBox();
        if (box.isNull()) continue;
        if (object->getMovableType() == Ogre::EntityFactory::FACTORY_TYPE_NAME)
            local.include(to_aabb(box));
        else
            world.include(to_aabb(object->getWorldBoundingBox(true)));
    }
    if (local.is_empty() && world.is_empty()) return std::nullopt;
    if (local.is_empty()) return obb_of(world);
    const auto turned = scene::transformed_box(transform_of(node), obb_of(local), measure::minimal_perimeter());
    if (turned && world.is_empty()) return *turned;
    for (const Ogre::MovableObject* object : node.getAttachedObjects())
        if (!object->getBoundingBox().isNull()) world.include(to_aabb(object->getWorldBoundingBox(true)));
    return obb_of(world);
}

bool is_unbounded(const SceneNode& node) {
    for (const Ogre::MovableObject* object : node.getAttachedObjects())
        if (object->getBoundingBox().isInfinite()) return true;
    return false;
}

}  // namespace

SceneNode::SceneNode(SceneManager& manager) : Ogre::SceneNode(&manager), manager_(manager) {}
SceneNode::SceneNode(SceneManager& manager, const Ogre::String& name)
    : Ogre::SceneNode(&manager, name), manager_(manager) {}
SceneNode::~SceneNode() {
    manager_.forget(*this);
    manager_.forget_occluder(*this);
}

void SceneNode::_updateBounds() {
    Ogre::SceneNode::_updateBounds();
    manager_.bounds_changed(*this);
}

void SceneNode::setInSceneGraph(bool in_graph) {
    if (!in_graph) {
        manager_.forget(*this);
        manager_.forget_occluder(*this);
    }
    Ogre::SceneNode::setInSceneGraph(in_graph);
}

SceneManager::SceneManager(const Ogre::String& name) : Ogre::SceneManager(name) {}

// Nodes tell their manager when they go, so they must go while it is still whole.
SceneManager::~SceneManager() {
    clearScene();
    mSceneRoot.reset();
}

const Ogre::String& SceneManager::getTypeName() const {
    static const Ogre::String name = SceneManagerFactory::kTypeName;
    return name;
}

Ogre::SceneNode* SceneManager::createSceneNodeImpl() {
    return OGRE_NEW SceneNode(*this);
}
Ogre::SceneNode* SceneManager::createSceneNodeImpl(const Ogre::String& name) {
    return OGRE_NEW SceneNode(*this, name);
}

void SceneManager::bounds_changed(SceneNode& node) {
    if (node.getAttachedObjects().empty() && node.object_.is_null() && !node.unbounded_) return;
    if (follows_occluders_) follow_occluder(node);
    if (is_unbounded(node)) return make_unbounded(node);
    const std::optional<Obb> box = box_of(node);
    if (!box || node.unbounded_) forget(node);
    if (!box) return;
    world_changed_ = true;
    if (!node.object_.is_null()) {
        if (!world_.set_bound(node.object_, *box)) make_unbounded(node);
        return;
    }
    const auto added = world_.add({.bound = *box, .user = reinterpret_cast<std::uintptr_t>(&node)});
    // What the World refuses, such as infinity, every camera sees.
    if (!added) return make_unbounded(node);
    node.object_ = *added;
}

void SceneManager::make_unbounded(SceneNode& node) {
    if (node.unbounded_) return;
    forget(node);
    node.unbounded_ = true;
    unbounded_.push_back(&node);
}

// The entity of a node that has nothing else. A mirrored one shows its back faces in OGRE.
void SceneManager::follow_occluder(SceneNode& node) {
    const auto& attached = node.getAttachedObjects();
    const auto* entity = attached.size() == 1 ? dynamic_cast<const Ogre::Entity*>(attached[0]) : nullptr;
    const Transform transform = transform_of(node);
    const bool hides = entity && is_solid(*entity) && glm::determinant(transform.linear) > 0.0;
    const MeshHandle mesh = hides ? occluder_meshes_.of(*entity->getMesh()) : MeshHandle();
    if (mesh.is_null()) return forget_occluder(node);
    world_changed_ = true;
    if (node.occluder_.is_null()) {
        const auto added = world_.add({.mesh = mesh,
                                       .transform = transform,
                                       .user = reinterpret_cast<std::uintptr_t>(&node),
                                       .layers = layers_of(*entity),
                                       .only_occludes = true});
        if (added) node.occluder_ = *added;
        return;
    }
    const bool followed = world_.set_mesh(node.occluder_, mesh) && world_.set_transform(node.occluder_, transform) &&
                          world_.set_layers(node.occluder_, layers_of(*entity));
    if (!followed) forget_occluder(node);
}

void SceneManager::forget_occluder(SceneNode& node) {
    if (node.occluder_.is_null()) return;
    static_cast<void>(world_.remove(node.occluder_));
    node.occluder_ = {};
    world_changed_ = true;
}

// Visibility may change without the bounds, and nobody tells.
bool SceneManager::hides_as_drawn(SceneNode& node) {
    const ObjectHandle before = node.occluder_;
    const auto& attached = node.getAttachedObjects();
    const auto* entity = attached.size() == 1 ? dynamic_cast<const Ogre::Entity*>(attached[0]) : nullptr;
    const bool hides = entity && is_solid(*entity) && (layers_of(*entity) & _getCombinedVisibilityMask()) != 0;
    if (!hides) forget_occluder(node);
    return node.occluder_ == before;
}

void SceneManager::use_occlusion(bool use) {
    use_occlusion_ = use;
    if (!use || follows_occluders_) return;
    follows_occluders_ = true;
    if (mSceneRoot) mSceneRoot->_update(true, true);
}

void SceneManager::forget(SceneNode& node) {
    if (node.unbounded_) std::erase(unbounded_, &node);
    node.unbounded_ = false;
    if (node.object_.is_null()) return;
    static_cast<void>(world_.remove(node.object_));
    node.object_ = {};
    world_changed_ = true;
}

// Once a frame, whatever the number of cameras and shadow textures: a World counts updates to tell what moves.
void SceneManager::update_world() {
    const unsigned long frame = Ogre::Root::getSingleton().getNextFrameNumber();
    if (!world_changed_ && frame == updated_frame_) return;
    static_cast<void>(world_.update());  // can only run out of pairs, of which there are none
    world_changed_ = false;
    updated_frame_ = frame;
}

Frustum SceneManager::frustum_of(const Ogre::Camera& camera) {
    const Ogre::Frustum* custom = camera.getCullingFrustum();
    const Ogre::Frustum& source = custom ? *custom : camera;
    const Ogre::Plane* planes = source.getFrustumPlanes();
    Frustum frustum;
    for (int i = 0; i < 6; ++i) {
        if (i == Ogre::FRUSTUM_PLANE_FAR && source.getFarClipDistance() == 0) continue;
        frustum.planes[frustum.plane_count++] = {to_glm(planes[i].normal), planes[i].d};
    }
    return frustum;
}

// What RenderQueue::processVisibleObject does, with the world box that the object has kept since its node moved instead
// of one computed anew for every view.
void SceneManager::queue_object(Ogre::MovableObject& object, Ogre::Camera* camera,
                                Ogre::VisibleObjectsBoundsInfo* bounds, bool only_shadow_casters) {
    object._notifyCurrentCamera(camera);
    if (!object.isVisible()) return;
    Ogre::RenderQueue* queue = getRenderQueue();
    const bool receives =
        object.getReceivesShadows() && queue->getQueueGroup(object.getRenderQueueGroup())->getShadowsEnabled();
    const bool is_queued = !only_shadow_casters || object.getCastShadows();
    if (is_queued) object._updateRenderQueue(queue);
    if (!bounds || !(is_queued || receives)) return;
    const Ogre::AxisAlignedBox& box = object.getWorldBoundingBox(false);
    const Ogre::Sphere& sphere = object.getWorldBoundingSphere(true);
    if (is_queued)
        bounds->merge(box, sphere, camera, receives);
    else
        bounds->mergeNonRenderedButInFrustum(box, sphere, camera);
}

void SceneManager::queue_objects(SceneNode& node, Ogre::Camera* camera, Ogre::VisibleObjectsBoundsInfo* bounds,
                                 bool only_shadow_casters) {
    for (Ogre::MovableObject* object : node.getAttachedObjects())
        queue_object(*object, camera, bounds, only_shadow_casters);
    if (Ogre::DebugDrawer* drawer = getDebugDrawer()) drawer->drawSceneNode(&node);
}

// A depth buffer has the camera's own eye and planes: what looks through another frustum or a mirror goes without.
void SceneManager::find_visible(const Ogre::Camera& camera, bool only_shadow_casters) {
    const ViewRequest plain{.volume = frustum_of(camera)};
    const bool is_plain = !use_occlusion_ || only_shadow_casters || camera.getCullingFrustum() ||
                          camera.isReflected() || camera.isCustomNearClipPlaneEnabled();
    const glm::dmat4 to_clip = to_glm(camera.getProjectionMatrix()) * to_glm(camera.getViewMatrix(true));
    const ViewRequest occluding{.matrix = ViewMatrix{to_clip, DepthRange::minus_one_to_one},
                                .volume = plain.volume,
                                .layers = _getCombinedVisibilityMask(),
                                .occlusion = OcclusionOptions{}};
    for (;;) {
        if (is_plain || !world_.view(occluding, visible_)) return (void)world_.view(plain, visible_);
        (void)world_.drawn_occluders(visible_, drawn_occluders_);
        bool right = true;
        for (const OccluderRef& occluder : drawn_occluders_)
            right = hides_as_drawn(*reinterpret_cast<SceneNode*>(occluder.user)) && right;
        if (right) return;
        update_world();
    }
}

void SceneManager::_findVisibleObjects(Ogre::Camera* camera, Ogre::VisibleObjectsBoundsInfo* bounds,
                                       bool only_shadow_casters) {
    const auto start = Clock::now();
    if (use_ogre_culling_) {
        Ogre::SceneManager::_findVisibleObjects(camera, bounds, only_shadow_casters);
        find_times_ = {0.0, microseconds_since(start)};
        return;
    }
    update_world();
    const auto cull_start = Clock::now();
    find_visible(*camera, only_shadow_casters);
    const double cull_time = microseconds_since(cull_start);
    for (std::size_t i = 0; i < visible_.size(); ++i)
        queue_objects(*reinterpret_cast<SceneNode*>(visible_[i].user), camera, bounds, only_shadow_casters);
    for (SceneNode* node : unbounded_) queue_objects(*node, camera, bounds, only_shadow_casters);
    find_times_ = {cull_time, microseconds_since(start)};
}

void SceneManagerFactory::initMetaData() const {
    mMetaData.typeName = kTypeName;
    mMetaData.worldGeometrySupported = false;
}

}  // namespace crofton::ogre
