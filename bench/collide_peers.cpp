// SPDX-License-Identifier: MIT
// FCL, Bullet, Embree and ODE on the inputs of collide_bench.cpp, each where it is installed.
#include <benchmark/benchmark.h>
#include <memory>

#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include "collide_inputs.hpp"

#if defined(CROFTON_HAVE_FCL)
#include <fcl/fcl.h>
#endif
#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#endif
#if defined(CROFTON_HAVE_EMBREE)
#include <embree3/rtcore.h>
#endif
#if defined(CROFTON_HAVE_ODE)
#include <ode/ode.h>
#endif

namespace crofton::bench {
namespace {

constexpr std::size_t kPairs = 4096;

// The share of answers that differ from the exact ones.
template <class Test>
void box_pairs(benchmark::State& state, const BoxPairs& pairs, Test test) {
    for (auto _ : state) {
        int hits = 0;
        for (std::size_t i = 0; i < pairs.a.size(); ++i) hits += test(i);
        benchmark::DoNotOptimize(hits);
    }
    int wrong = 0;
    for (std::size_t i = 0; i < pairs.a.size(); ++i) wrong += test(i) != collide::intersects(pairs.a[i], pairs.b[i]);
    state.counters["wrong"] = wrong;
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pairs.a.size()));
}

#if defined(CROFTON_HAVE_FCL)

fcl::OBBd fcl_box(const Obb& box) {
    fcl::OBBd result;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) result.axis(i, k) = box.axes[k][i];
        result.To[k] = box.center[k];
        result.extent[k] = box.half_extents[k];
    }
    return result;
}

void fcl_sat(benchmark::State& state, BoxPairs (*pairs_of)(std::size_t)) {
    const BoxPairs pairs = pairs_of(kPairs);
    std::vector<fcl::OBBd> a, b;
    for (std::size_t i = 0; i < kPairs; ++i) a.push_back(fcl_box(pairs.a[i])), b.push_back(fcl_box(pairs.b[i]));
    box_pairs(state, pairs, [&](std::size_t i) { return a[i].overlap(b[i]); });
}
BENCHMARK_CAPTURE(fcl_sat, random, random_pairs)->Name("sat/4096 pairs one by one/fcl")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fcl_sat, stacked, stacked_pairs)
    ->Name("sat/4096 stacked crates one by one/fcl")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fcl_sat, grid, grid_pairs)
    ->Name("sat/4096 crates on a grid one by one/fcl")
    ->Unit(benchmark::kMicrosecond);

using FclMesh = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<FclMesh> fcl_mesh(const TriangleMesh& mesh) {
    auto model = std::make_shared<FclMesh>();
    std::vector<fcl::Vector3d> points;
    std::vector<fcl::Triangle> triangles;
    for (const glm::vec3& p : mesh.positions) points.emplace_back(p.x, p.y, p.z);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        triangles.emplace_back(mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    model->beginModel();
    model->addSubModel(points, triangles);
    model->endModel();
    return model;
}

void fcl_meshes(benchmark::State& state, const char* name, bool all) {
    const TriangleMesh mesh = shared_mesh(name);
    const auto tree = mesh::MeshTree::build(mesh);
    if (!tree) return state.SkipWithError("shared data is absent");
    const auto poses = close_poses(*tree, 1000);
    const auto model = fcl_mesh(mesh);
    const fcl::CollisionRequestd request(all ? 1'000'000 : 1, false);
    std::size_t found = 0;
    for (auto _ : state) {
        found = 0;
        for (const RigidTransform& pose : poses) {
            fcl::Transform3d placed = fcl::Transform3d::Identity();
            for (int i = 0; i < 3; ++i) {
                placed.translation()[i] = pose.translation[i];
                for (int j = 0; j < 3; ++j) placed.linear()(i, j) = pose.rotation[j][i];
            }
            fcl::CollisionResultd result;
            found += fcl::collide(model.get(), fcl::Transform3d::Identity(), model.get(), placed, request, result);
        }
    }
    state.counters["found"] = static_cast<double>(found);
    state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK_CAPTURE(fcl_meshes, bunny_any, "bunny", false)->Name("mesh/bunny any/fcl")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fcl_meshes, bunny_all, "bunny", true)->Name("mesh/bunny all/fcl")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fcl_meshes, cow_any, "cow", false)->Name("mesh/cow any/fcl")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fcl_meshes, cow_all, "cow", true)->Name("mesh/cow all/fcl")->Unit(benchmark::kMillisecond);

void fcl_build(benchmark::State& state) {
    const TriangleMesh mesh = shared_mesh("bunny");
    for (auto _ : state) benchmark::DoNotOptimize(fcl_mesh(mesh));
}
BENCHMARK(fcl_build)->Name("mesh/bunny build/fcl")->Unit(benchmark::kMillisecond);

#endif

#if defined(CROFTON_HAVE_BULLET)

// Bullet's only pairwise descent through two meshes is GImpact's; what follows is its own order of tests on the pairs
// of boxes, without the contact points. It has no way to stop at the first.
void bullet_meshes(benchmark::State& state, const char* name) {
    const TriangleMesh mesh = shared_mesh(name);
    const auto tree = mesh::MeshTree::build(mesh);
    if (!tree) return state.SkipWithError("shared data is absent");
    const auto poses = close_poses(*tree, 1000);
    btTriangleMesh triangles(true, false);
    const auto point = [&](std::size_t corner) {
        const glm::vec3& p = mesh.positions[mesh.indices[corner]];
        return btVector3(p.x, p.y, p.z);
    };
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        triangles.addTriangle(point(3 * t), point(3 * t + 1), point(3 * t + 2));
    btGImpactMeshShape shape(&triangles);
    shape.setMargin(0.0f);
    shape.updateBound();
    btGImpactMeshShapePart* const part = shape.getMeshPart(0);
    part->lockChildShapes();
    std::size_t found = 0;
    for (auto _ : state) {
        found = 0;
        for (const RigidTransform& pose : poses) {
            btTransform placed = btTransform::getIdentity();
            for (int i = 0; i < 3; ++i) {
                placed.getOrigin()[i] = btScalar(pose.translation[i]);
                for (int j = 0; j < 3; ++j) placed.getBasis()[i][j] = btScalar(pose.rotation[j][i]);
            }
            btPairSet pairs;
            btGImpactBoxSet::find_collision(part->getBoxSet(), btTransform::getIdentity(), part->getBoxSet(), placed,
                                            pairs);
            for (int i = 0; i < pairs.size(); ++i) {
                btPrimitiveTriangle a, b;
                part->getPrimitiveTriangle(pairs[i].m_index1, a);
                part->getPrimitiveTriangle(pairs[i].m_index2, b);
                b.applyTransform(placed);
                a.m_margin = b.m_margin = 0.0f;
                a.buildTriPlane();
                b.buildTriPlane();
                GIM_TRIANGLE_CONTACT contact;
                found += a.overlap_test_conservative(b) && a.find_triangle_collision_clip_method(b, contact);
            }
        }
    }
    part->unlockChildShapes();
    state.counters["found"] = static_cast<double>(found);
    state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK_CAPTURE(bullet_meshes, bunny, "bunny")->Name("mesh/bunny all/bullet")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bullet_meshes, cow, "cow")->Name("mesh/cow all/bullet")->Unit(benchmark::kMillisecond);

void bullet_broadphase(benchmark::State& state) {
    std::vector<Obb> boxes = crowd(static_cast<std::size_t>(state.range(0)));
    btDbvtBroadphase broadphase;
    std::vector<btBroadphaseProxy*> proxies;
    const auto corner = [](const glm::dvec3& p) { return btVector3(btScalar(p.x), btScalar(p.y), btScalar(p.z)); };
    for (Obb& box : boxes) {
        const Aabb bound = aabb_of(box);
        proxies.push_back(broadphase.createProxy(corner(bound.min), corner(bound.max), 0, &box, 1, 1, nullptr));
    }
    int frame = 0;
    for (auto _ : state) {
        state.PauseTiming();
        move(boxes, frame++);
        state.ResumeTiming();
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Aabb bound = aabb_of(boxes[i]);
            broadphase.setAabb(proxies[i], corner(bound.min), corner(bound.max), nullptr);
        }
        broadphase.calculateOverlappingPairs(nullptr);
    }
    state.counters["pairs/box"] =
        double(broadphase.getOverlappingPairCache()->getNumOverlappingPairs()) / static_cast<double>(boxes.size());
}
BENCHMARK(bullet_broadphase)
    ->Name("broadphase/bounds/bullet")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Iterations(20)
    ->Unit(benchmark::kMicrosecond);

#endif

#if defined(CROFTON_HAVE_EMBREE)

void embree_bounds(const RTCBoundsFunctionArguments* arguments) {
    const Aabb bound = aabb_of(static_cast<const Obb*>(arguments->geometryUserPtr)[arguments->primID]);
    *arguments->bounds_o = {float(bound.min.x), float(bound.min.y), float(bound.min.z), 0.0f,
                            float(bound.max.x), float(bound.max.y), float(bound.max.z), 0.0f};
}

void count_collisions(void* count, RTCCollision* collisions, unsigned number) {
    for (unsigned i = 0; i < number; ++i)
        *static_cast<std::size_t*>(count) += collisions[i].primID0 < collisions[i].primID1;
}

void embree_broadphase(benchmark::State& state) {
    std::vector<Obb> boxes = crowd(static_cast<std::size_t>(state.range(0)));
    const RTCDevice device = rtcNewDevice("threads=1");
    const RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(boxes.size()));
    rtcSetGeometryUserData(geometry, boxes.data());
    rtcSetGeometryBoundsFunction(geometry, embree_bounds, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    std::size_t pairs = 0;
    int frame = 0;
    for (auto _ : state) {
        state.PauseTiming();
        move(boxes, frame++);
        state.ResumeTiming();
        rtcCommitGeometry(geometry);
        rtcCommitScene(scene);
        pairs = 0;
        rtcCollide(scene, scene, count_collisions, &pairs);
    }
    state.counters["pairs/box"] = static_cast<double>(pairs) / static_cast<double>(boxes.size());
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
BENCHMARK(embree_broadphase)
    ->Name("broadphase/bounds/embree")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMicrosecond);

#endif

#if defined(CROFTON_HAVE_ODE)

struct OdeBox {
    dVector3 center, side;
    dMatrix3 rotation;
};

OdeBox ode_box(const Obb& box) {
    OdeBox result{};
    for (int k = 0; k < 3; ++k) {
        result.center[k] = dReal(box.center[k]);
        result.side[k] = dReal(2.0f * box.half_extents[k]);
        for (int i = 0; i < 3; ++i) result.rotation[4 * i + k] = dReal(box.axes[k][i]);
    }
    return result;
}

void ode_sat(benchmark::State& state, BoxPairs (*pairs_of)(std::size_t)) {
    const BoxPairs pairs = pairs_of(kPairs);
    std::vector<OdeBox> a, b;
    for (std::size_t i = 0; i < kPairs; ++i) a.push_back(ode_box(pairs.a[i])), b.push_back(ode_box(pairs.b[i]));
    box_pairs(state, pairs, [&](std::size_t i) {
        return dBoxTouchesBox(a[i].center, a[i].rotation, a[i].side, b[i].center, b[i].rotation, b[i].side) != 0;
    });
}
BENCHMARK_CAPTURE(ode_sat, random, random_pairs)->Name("sat/4096 pairs one by one/ode")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ode_sat, stacked, stacked_pairs)
    ->Name("sat/4096 stacked crates one by one/ode")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ode_sat, grid, grid_pairs)
    ->Name("sat/4096 crates on a grid one by one/ode")
    ->Unit(benchmark::kMicrosecond);

#endif

}  // namespace
}  // namespace crofton::bench
