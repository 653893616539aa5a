// SPDX-License-Identifier: MIT
#include "crofton_cull_callback.hpp"

#include <chrono>
#include <crofton/scene/transformed_box.hpp>
#include <osg/ComputeBoundsVisitor>
#include <osg/MatrixTransform>
#include <osg/Notify>
#include <osgUtil/CullVisitor>

namespace crofton::osg_adapter {
namespace {

// The child's own box turned by its transform; around other kinds of nodes the axis-aligned box.
Obb box_of(osg::Node& node) {
    osg::ComputeBoundsVisitor bounds;
    Transform transform;
    if (osg::MatrixTransform* child = node.asTransform() ? node.asTransform()->asMatrixTransform() : nullptr) {
        child->traverse(bounds);
        const osg::Matrix& matrix = child->getMatrix();  // row vectors: v · M
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) transform.linear[column][row] = matrix(column, row);
            transform.translation[row] = matrix(3, row);
        }
    } else {
        node.accept(bounds);
    }
    const osg::BoundingBox& box = bounds.getBoundingBox();
    Aabb local;
    if (box.valid()) {
        local.include({box.xMin(), box.yMin(), box.zMin()});
        local.include({box.xMax(), box.yMax(), box.zMax()});
    } else {
        const osg::Vec3 center = node.getBound().center();  // nothing to draw: a point
        local.include({center.x(), center.y(), center.z()});
    }
    return scene::transformed_box(transform, obb_of(local), measure::minimal_perimeter()).value_or(obb_of(local));
}

// The planes that the cull traversal itself would test with, in the group's coordinates.
Frustum frustum_of(osg::CullingSet& culling) {
    Frustum frustum;
    const auto& planes = culling.getFrustum().getPlaneList();
    for (std::size_t i = 0; i < planes.size() && i < Frustum::kMaxPlanes; ++i)
        frustum.planes[frustum.plane_count++] = {{planes[i][0], planes[i][1], planes[i][2]}, planes[i][3]};
    return frustum;
}

}  // namespace

CullCallback::CullCallback(osg::Group& group) : group_(group) {
    for (unsigned child = 0; child < group.getNumChildren(); ++child)
        objects_.push_back(world_.add({.bound = box_of(*group.getChild(child)), .user = child}).value());
}

void CullCallback::child_moved(unsigned child) {
    const auto moved = world_.set_bound(objects_[child], box_of(*group_.getChild(child)));
    if (!moved) OSG_WARN << "child " << child << " stays where it was: " << moved.error().message << std::endl;
    world_changed_ = true;
}

// Once a frame, whatever the number of cameras: a World counts updates to tell what moves.
void CullCallback::update_world(unsigned frame) {
    if (!world_changed_ && frame == updated_frame_) return;
    static_cast<void>(world_.update());  // can only run out of pairs, of which there are none
    world_changed_ = false;
    updated_frame_ = frame;
}

void CullCallback::operator()(osg::Node* node, osg::NodeVisitor* visitor) {
    osgUtil::CullVisitor* culler = visitor->asCullVisitor();
    if (!culler) {
        traverse(node, visitor);
        return;
    }
    update_world(visitor->getTraversalNumber());
    const auto start = std::chrono::steady_clock::now();
    (void)world_.view({.volume = frustum_of(culler->getCurrentCullingSet())}, visible_);
    last_cull_microseconds_ =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    for (std::size_t i = 0; i < visible_.size(); ++i)
        group_.getChild(static_cast<unsigned>(visible_[i].user))->accept(*visitor);
}

}  // namespace crofton::osg_adapter
