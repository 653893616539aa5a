// SPDX-License-Identifier: MIT
// Jolt first: its other headers need it.
#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Physics/Collision/CollideShape.h>
#include <Jolt/Physics/Collision/CollisionCollectorImpl.h>
#include <Jolt/Physics/Collision/CollisionDispatch.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/ConvexHullShape.h>
#include <Jolt/RegisterTypes.h>

#include <stdexcept>

#include "convex_peers.hpp"

namespace crofton::bench {
namespace {

JPH::RefConst<JPH::Shape> jolt_shape(const convex::Shape& shape) {
    if (shape.kind() == convex::Kind::box) {
        const glm::vec3 h(shape.half_extents());
        return new JPH::BoxShape({h.x, h.y, h.z}, 0.0f);
    }
    JPH::Array<JPH::Vec3> points;
    for (const glm::vec3& v : shape.hull()->vertices()) points.push_back({v.x, v.y, v.z});
    JPH::ConvexHullShapeSettings settings(points, 0.0f);
    settings.mHullTolerance = 1e-6f;  // as far as corners may lie outside
    const JPH::ShapeSettings::ShapeResult shape = settings.Create();
    if (shape.HasError()) throw std::runtime_error(shape.GetError().c_str());
    return shape.Get();
}

// Of the shape's center of mass, relative to `origin`.
JPH::Mat44 jolt_pose(const RigidTransform& pose, const glm::dvec3& origin, const JPH::Shape& shape) {
    JPH::Mat44 m = JPH::Mat44::sIdentity();
    for (int c = 0; c < 3; ++c) {
        const glm::vec3 column(pose.rotation[c]);
        m.SetColumn3(JPH::uint(c), {column.x, column.y, column.z});
    }
    const JPH::Vec3 middle = shape.GetCenterOfMass();
    const glm::vec3 t(pose.translation - origin +
                      pose.rotation * glm::dvec3(middle.GetX(), middle.GetY(), middle.GetZ()));
    m.SetTranslation({t.x, t.y, t.z});
    return m;
}

void start_jolt() {
    static const bool started = [] {
        JPH::RegisterDefaultAllocator();
        JPH::Factory::sInstance = new JPH::Factory;
        JPH::RegisterTypes();
        return true;
    }();
    (void)started;
}

}  // namespace

bool jolt_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b) {
    start_jolt();
    const JPH::RefConst<JPH::Shape> shape_a = jolt_shape(a.shape), shape_b = jolt_shape(b.shape);
    const glm::dvec3 origin = a.pose.translation;
    JPH::AnyHitCollisionCollector<JPH::CollideShapeCollector> hit;
    JPH::CollisionDispatch::sCollideShapeVsShape(shape_a, shape_b, JPH::Vec3::sOne(), JPH::Vec3::sOne(),
                                                 jolt_pose(a.pose, origin, *shape_a),
                                                 jolt_pose(b.pose, origin, *shape_b), {}, {}, {}, hit);
    return hit.HadHit();
}

}  // namespace crofton::bench
