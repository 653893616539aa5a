// SPDX-License-Identifier: MIT
// The libraries that Debian has.
#include "convex_peers.hpp"

#include <memory>
#include <vector>

#if defined(CROFTON_HAVE_FCL)
#include <fcl/fcl.h>
#endif
#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletCollisionCommon.h>
#endif
#if defined(CROFTON_HAVE_ODE)
#include <ode/ode.h>
#endif

namespace crofton::bench {

using convex::Shape;
using convex::ShapeAtPose;

#if defined(CROFTON_HAVE_FCL)
namespace {

std::unique_ptr<fcl::CollisionGeometryd> fcl_shape(const Shape& shape) {
    if (shape.kind() == convex::Kind::box) {
        const glm::dvec3 h = shape.half_extents();
        return std::make_unique<fcl::Boxd>(2 * h.x, 2 * h.y, 2 * h.z);
    }
    auto vertices = std::make_shared<std::vector<fcl::Vector3d>>();
    for (const glm::vec3& v : shape.hull()->vertices()) vertices->emplace_back(v.x, v.y, v.z);
    auto faces = std::make_shared<std::vector<int>>();
    const auto t = shape.hull()->triangles();
    for (std::size_t k = 0; k < t.size(); k += 3)
        faces->insert(faces->end(), {3, int(t[k]), int(t[k + 1]), int(t[k + 2])});
    return std::make_unique<fcl::Convexd>(vertices, int(t.size() / 3), faces);
}
fcl::Transform3d fcl_pose(const RigidTransform& pose) {
    fcl::Transform3d t = fcl::Transform3d::Identity();
    for (int r = 0; r < 3; ++r) {
        t.translation()[r] = pose.translation[r];
        for (int c = 0; c < 3; ++c) t.linear()(r, c) = pose.rotation[c][r];
    }
    return t;
}
}  // namespace

bool fcl_meets(const ShapeAtPose& a, const ShapeAtPose& b) {
    fcl::CollisionRequestd request(1, false);
    request.gjk_solver_type = fcl::GST_LIBCCD;
    fcl::CollisionResultd result;
    const auto shape_a = fcl_shape(a.shape), shape_b = fcl_shape(b.shape);
    return fcl::collide(shape_a.get(), fcl_pose(a.pose), shape_b.get(), fcl_pose(b.pose), request, result) > 0;
}
#endif

#if defined(CROFTON_HAVE_BULLET)
namespace {

std::unique_ptr<btConvexShape> bullet_shape(const Shape& shape) {
    if (shape.kind() == convex::Kind::box) {
        const glm::dvec3 h = shape.half_extents();
        auto box = std::make_unique<btBoxShape>(btVector3(btScalar(h.x), btScalar(h.y), btScalar(h.z)));
        box->setMargin(0);  // else its corners are round
        return box;
    }
    auto hull = std::make_unique<btConvexHullShape>();
    for (const glm::vec3& v : shape.hull()->vertices()) hull->addPoint(btVector3(v.x, v.y, v.z), false);
    hull->recalcLocalAabb();
    hull->setMargin(0);
    return hull;
}
btTransform bullet_pose(const RigidTransform& pose) {
    btTransform t = btTransform::getIdentity();
    for (int r = 0; r < 3; ++r) {
        t.getOrigin()[r] = btScalar(pose.translation[r]);
        for (int c = 0; c < 3; ++c) t.getBasis()[r][c] = btScalar(pose.rotation[c][r]);
    }
    return t;
}
}  // namespace

bool bullet_meets(const ShapeAtPose& a, const ShapeAtPose& b) {
    const auto shape_a = bullet_shape(a.shape), shape_b = bullet_shape(b.shape);
    btVoronoiSimplexSolver solver;
    btGjkEpaPenetrationDepthSolver epa;
    btGjkPairDetector detector(shape_a.get(), shape_b.get(), &solver, &epa);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = bullet_pose(a.pose);
    input.m_transformB = bullet_pose(b.pose);
    btPointCollector result;
    detector.getClosestPoints(input, result, nullptr);
    return result.m_hasResult && result.m_distance <= 0;
}
#endif

#if defined(CROFTON_HAVE_ODE)
namespace {

class OdeGeom {
  public:
    explicit OdeGeom(const ShapeAtPose& placed) {
        glm::dvec3 middle(0.0);
        if (placed.shape.kind() == convex::Kind::box) {
            const glm::dvec3 h = placed.shape.half_extents();
            geom_ = dCreateBox(nullptr, dReal(2 * h.x), dReal(2 * h.y), dReal(2 * h.z));
        } else {
            // ODE asks for a body around its frame's origin.
            const convex::Hull& hull = *placed.shape.hull();
            middle = hull.mass().center;
            for (const glm::vec3& v : hull.vertices()) {
                const glm::dvec3 p = glm::dvec3(v) - middle;
                points_.insert(points_.end(), {dReal(p.x), dReal(p.y), dReal(p.z)});
            }
            for (int f = 0; f < hull.face_count(); ++f) {
                const glm::dvec3 n = hull.face_normal(f),
                                 p = glm::dvec3(hull.vertices()[hull.face_vertices(f)[0]]) - middle;
                planes_.insert(planes_.end(), {dReal(n.x), dReal(n.y), dReal(n.z), dReal(glm::dot(n, p))});
                polygons_.push_back(static_cast<unsigned>(hull.face_vertices(f).size()));
                for (const auto v : hull.face_vertices(f)) polygons_.push_back(v);
            }
            geom_ = dCreateConvex(nullptr, planes_.data(), unsigned(hull.face_count()), points_.data(),
                                  unsigned(hull.vertices().size()), polygons_.data());
        }
        dMatrix3 r{};
        for (int row = 0; row < 3; ++row)
            for (int c = 0; c < 3; ++c) r[4 * row + c] = dReal(placed.pose.rotation[c][row]);
        dGeomSetRotation(geom_, r);
        const glm::dvec3 t = placed.pose.translation + placed.pose.rotation * middle;
        dGeomSetPosition(geom_, dReal(t.x), dReal(t.y), dReal(t.z));
    }
    ~OdeGeom() { dGeomDestroy(geom_); }
    OdeGeom(const OdeGeom&) = delete;
    OdeGeom& operator=(const OdeGeom&) = delete;
    [[nodiscard]] dGeomID id() const { return geom_; }

  private:
    std::vector<dReal> points_, planes_;
    std::vector<unsigned> polygons_;
    dGeomID geom_ = nullptr;
};
}  // namespace

bool ode_meets(const ShapeAtPose& a, const ShapeAtPose& b) {
    const OdeGeom geom_a(a), geom_b(b);
    dContactGeom contact[8];
    return dCollide(geom_a.id(), geom_b.id(), 8, contact, sizeof(dContactGeom)) > 0;
}
#endif

}  // namespace crofton::bench
