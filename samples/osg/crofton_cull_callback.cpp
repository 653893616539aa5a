// SPDX-License-Identifier: MIT
#include "crofton_cull_callback.hpp"

#include <chrono>
#include <osg/ComputeBoundsVisitor>
#include <osg/MatrixTransform>
#include <osgUtil/CullVisitor>

#include <crofton/scene/transform.hpp>

namespace crofton::osg_adapter {
namespace {

// The child's own box turned by its transform; around other kinds of nodes the axis-aligned box.
Obb box_of(osg::Node& node) {
    osg::ComputeBoundsVisitor bounds;
    scene::Transform transform;
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
        static_cast<void>(index_.insert(box_of(*group.getChild(child))));  // item i is child i
}

void CullCallback::child_moved(unsigned child) {
    index_.move(child, box_of(*group_.getChild(child)));
}

void CullCallback::operator()(osg::Node* node, osg::NodeVisitor* visitor) {
    osgUtil::CullVisitor* culler = visitor->asCullVisitor();
    if (!culler) {
        traverse(node, visitor);
        return;
    }
    index_.update();
    const auto start = std::chrono::steady_clock::now();
    const cull::VisibleSet& visible = index_.cull({.frustum = frustum_of(culler->getCurrentCullingSet())});
    last_cull_microseconds_ =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    for (const cull::ItemId child : visible.ids()) group_.getChild(child)->accept(*visitor);
}

}  // namespace crofton::osg_adapter
