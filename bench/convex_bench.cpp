// SPDX-License-Identifier: MIT
// Pairs of hulls of 32 vertices beside FCL with libccd, Bullet and ODE: yes-no, distance, manifold, casts. `wrong`
// counts answers that differ from the exact ones; errors of distances and depths are given as the largest, in units of
// size. Peers run on the same poses, warm as their interfaces allow.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>

#if defined(CROFTON_HAVE_FCL)
#include <fcl/fcl.h>
#endif
#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
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
namespace {

using namespace crofton::convex;

constexpr int kFrames = 16, kPairs = 256;

// Pairs that move a little from frame to frame; `gap` along the direction in which they nearly touch.
struct Scene {
    std::vector<std::unique_ptr<Hull>> hulls;
    std::vector<std::vector<glm::vec3>> points;
    std::vector<Shape> shapes;                   // 2 a pair
    std::vector<RigidTransform> poses[kFrames];  // likewise
    std::vector<bool> meet[kFrames];
};

Scene make_scene(double gap, bool boxes, int points = 32) {
    std::mt19937_64 random(7);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto direction = [&] {
        for (;;) {
            const glm::dvec3 v(number(-1, 1), number(-1, 1), number(-1, 1));
            if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
        }
    };
    const auto turn = [&](double angle) {
        return glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * direction()));
    };
    Scene scene;
    for (int i = 0; i < 2 * kPairs; ++i) {
        std::vector<glm::vec3> p;
        for (int k = 0; k < points; ++k) p.emplace_back(direction());
        if (boxes) {
            p.clear();
            const glm::vec3 h(number(0.3, 1), number(0.3, 1), number(0.3, 1));
            for (int k = 0; k < 8; ++k) p.emplace_back(k & 1 ? h.x : -h.x, k & 2 ? h.y : -h.y, k & 4 ? h.z : -h.z);
            scene.shapes.push_back(Shape::box(h).value());
        } else {
            scene.hulls.push_back(std::make_unique<Hull>(Hull::build(p).value()));
            scene.shapes.push_back(Shape::hull(*scene.hulls.back()));
        }
        scene.points.push_back(p);
    }
    for (int i = 0; i < kPairs; ++i) {
        const Shape &a = scene.shapes[2 * i], &b = scene.shapes[2 * i + 1];
        const glm::dmat3 ra = turn(number(0, 6)), rb = boxes ? ra : turn(number(0, 6));
        // Resting: along a face's normal of a.
        const glm::dvec3 local = boxes ? glm::dvec3(0, 1, 0) : a.hull()->face_normal(0);
        const glm::dvec3 n = ra * local;
        const glm::dvec3 touch = ra * (boxes ? support_point(a, local) : [&] {
                                     glm::dvec3 sum(0.0);
                                     for (const auto v : a.hull()->face_vertices(0)) sum += a.vertex(v);
                                     return sum / double(a.hull()->face_vertices(0).size());
                                 }());
        glm::dvec3 at = touch - rb * support_point(b, glm::transpose(rb) * -n) + gap * n;
        if (boxes) at = ra * glm::dvec3(0.1, local.y * (a.half_extents().y + b.half_extents().y) + gap, 0.05);
        for (int f = 0; f < kFrames; ++f) {
            scene.poses[f].push_back({ra, glm::dvec3(0.0)});
            const glm::dvec3 jitter = 1e-4 * direction();
            const glm::dmat3 rock = boxes ? glm::dmat3(1.0) : turn(1e-4);
            scene.poses[f].push_back({rock * rb, at + jitter});
        }
    }
    for (int f = 0; f < kFrames; ++f)
        for (int i = 0; i < kPairs; ++i)
            scene.meet[f].push_back(intersects({scene.shapes[2 * i], scene.poses[f][2 * i]},
                                               {scene.shapes[2 * i + 1], scene.poses[f][2 * i + 1]}));
    return scene;
}

// Calls run(frame, pair) for all pairs of one frame after the other; counts what `answer` gets wrong afterwards.
template <class Run, class Answer>
void frames(benchmark::State& state, const Scene& scene, Run run, Answer answer) {
    int f = 0;
    for (auto _ : state) {
        for (int i = 0; i < kPairs; ++i) benchmark::DoNotOptimize(run(f, i));
        f = (f + 1) % kFrames;
    }
    int wrong = 0;
    for (int g = 0; g < kFrames; ++g)
        for (int i = 0; i < kPairs; ++i) wrong += answer(g, i) != scene.meet[g][static_cast<std::size_t>(i)];
    state.counters["wrong"] = wrong;
    state.counters["ns"] = benchmark::Counter(static_cast<double>(state.iterations()) * kPairs * 1e-9,
                                              benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

enum class Ask { meet, distance, penetration, manifold, cast };

double crofton_ask(Ask ask, const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache) {
    switch (ask) {
        case Ask::meet:
            return intersects(a, b, cache);
        case Ask::distance:
            return distance(a, b, cache).distance;
        case Ask::penetration:
            return penetration(a, b, cache).depth;
        default:
            return contact_manifold(a, b, {.margin = 0.02}, cache).depth;
    }
}

void crofton_pairs(benchmark::State& state, Ask ask, double gap, bool boxes, bool warm) {
    const Scene scene = make_scene(gap, boxes);
    std::vector<PairCache> cache(kPairs);
    const auto place = [&](int f, int i) { return ShapeAtPose{scene.shapes[i], scene.poses[f][i]}; };
    frames(
        state, scene,
        [&](int f, int i) {
            return crofton_ask(ask, place(f, 2 * i), place(f, 2 * i + 1), warm ? &cache[i] : nullptr);
        },
        [&](int f, int i) { return intersects(place(f, 2 * i), place(f, 2 * i + 1), warm ? &cache[i] : nullptr); });
}
#define CROFTON_PAIRS(name, ask, gap, boxes)                                              \
    BENCHMARK_CAPTURE(crofton_pairs, warm, ask, gap, boxes, true)->Name(name "/crofton"); \
    BENCHMARK_CAPTURE(crofton_pairs, cold, ask, gap, boxes, false)->Name(name "/crofton cold")
CROFTON_PAIRS("hull32 yes-no apart 0.1", Ask::meet, 0.1, false);
CROFTON_PAIRS("hull32 yes-no overlap 0.01", Ask::meet, -0.01, false);
CROFTON_PAIRS("hull32 distance 0.1", Ask::distance, 0.1, false);
CROFTON_PAIRS("hull32 penetration 0.01", Ask::penetration, -0.01, false);
CROFTON_PAIRS("hull32 manifold 0.01", Ask::manifold, -0.01, false);
CROFTON_PAIRS("hull32 manifold gap 0.01", Ask::manifold, 0.01, false);
CROFTON_PAIRS("box manifold 0.01", Ask::manifold, -0.01, true);
CROFTON_PAIRS("box penetration 0.01", Ask::penetration, -0.01, true);

// Hulls of fewer points, warm.
void few_points(benchmark::State& state) {
    const Scene scene = make_scene(-0.01, false, static_cast<int>(state.range(0)));
    std::vector<PairCache> cache(kPairs);
    const auto place = [&](int f, int i) { return ShapeAtPose{scene.shapes[i], scene.poses[f][i]}; };
    frames(
        state, scene,
        [&](int f, int i) { return crofton_ask(Ask::manifold, place(f, 2 * i), place(f, 2 * i + 1), &cache[i]); },
        [&](int f, int i) { return intersects(place(f, 2 * i), place(f, 2 * i + 1)); });
}
BENCHMARK(few_points)->Name("hull manifold 0.01, points/crofton")->Arg(8)->Arg(16)->Arg(32);

// Cubes whose faces touch exactly: in one frame, as stacked crates are, or each turned about the normal. A small one on
// top has all of its face on the other: nothing is clipped, and no points are chosen.
void touching_boxes(benchmark::State& state, Ask ask, bool turned, bool small = false) {
    const Shape cube = Shape::box(glm::vec3(0.5f)).value(), upper = Shape::box(glm::vec3(small ? 0.2f : 0.5f)).value();
    const auto yaw = [turned](double angle) {
        const double c = std::cos(angle), s = std::sin(angle);
        return turned ? glm::dmat3(c, 0, -s, 0, 1, 0, s, 0, c) : glm::dmat3(1.0);
    };
    const RigidTransform low{yaw(0.3), {}}, top{yaw(0.7), {0.1, 0.5 + (small ? double{0.2f} : 0.5), 0.2}};
    for (auto _ : state) benchmark::DoNotOptimize(crofton_ask(ask, {cube, low}, {upper, top}, nullptr));
}
BENCHMARK_CAPTURE(touching_boxes, a, Ask::meet, false)->Name("box touching yes-no/crofton");
BENCHMARK_CAPTURE(touching_boxes, b, Ask::manifold, false)->Name("box touching manifold/crofton");
BENCHMARK_CAPTURE(touching_boxes, c, Ask::meet, true)->Name("box touching, turned, yes-no/crofton");
BENCHMARK_CAPTURE(touching_boxes, d, Ask::manifold, true)->Name("box touching, turned, manifold/crofton");
BENCHMARK_CAPTURE(touching_boxes, e, Ask::manifold, true, true)->Name("box touching, turned, small, manifold/crofton");

// `spin` radians a second about an axis across the way.
void crofton_cast(benchmark::State& state, int points, double spin) {
    const Scene scene = make_scene(0.5, false, points);
    frames(
        state, scene,
        [&](int f, int i) {
            Motion motion;
            motion.velocity = -2.0 * scene.poses[f][2 * i + 1].translation;
            motion.spin = spin * glm::normalize(glm::cross(motion.velocity, glm::dvec3(0.3, 0.5, 0.7)));
            return cast({scene.shapes[2 * i], scene.poses[f][2 * i]}, {},
                        {scene.shapes[2 * i + 1], scene.poses[f][2 * i + 1]}, motion)
                ->time;
        },
        [](int, int) { return false; });
}
BENCHMARK_CAPTURE(crofton_cast, a, 32, 0.0)->Name("hull32 cast translation/crofton");
BENCHMARK_CAPTURE(crofton_cast, b, 16, 0.0)->Name("hull16 cast translation/crofton");
BENCHMARK_CAPTURE(crofton_cast, c, 16, 2.0)->Name("hull16 cast turning/crofton");

#if defined(CROFTON_HAVE_FCL)
struct FclScene {
    explicit FclScene(const Scene& scene) {
        for (int i = 0; i < 2 * kPairs; ++i) {
            if (scene.shapes[i].kind() == Kind::box) {
                const glm::dvec3 h = scene.shapes[i].half_extents();
                shapes.push_back(std::make_shared<fcl::Boxd>(2 * h.x, 2 * h.y, 2 * h.z));
                continue;
            }
            auto vertices = std::make_shared<std::vector<fcl::Vector3d>>();
            for (const glm::vec3& v : scene.hulls[i]->vertices()) vertices->emplace_back(v.x, v.y, v.z);
            auto faces = std::make_shared<std::vector<int>>();
            const auto t = scene.hulls[i]->triangles();
            for (std::size_t k = 0; k < t.size(); k += 3)
                faces->insert(faces->end(), {3, int(t[k]), int(t[k + 1]), int(t[k + 2])});
            shapes.push_back(std::make_shared<fcl::Convexd>(vertices, int(t.size() / 3), faces));
        }
        for (int f = 0; f < kFrames; ++f)
            for (int i = 0; i < 2 * kPairs; ++i) {
                fcl::Transform3d t = fcl::Transform3d::Identity();
                for (int r = 0; r < 3; ++r) {
                    t.translation()[r] = scene.poses[f][i].translation[r];
                    for (int c = 0; c < 3; ++c) t.linear()(r, c) = scene.poses[f][i].rotation[c][r];
                }
                poses[f].push_back(t);
            }
    }
    bool meet(int f, int i, bool contacts) const {
        fcl::CollisionRequestd request(contacts ? 4 : 1, contacts);
        request.gjk_solver_type = fcl::GST_LIBCCD;
        fcl::CollisionResultd result;
        return fcl::collide(shapes[2 * i].get(), poses[f][2 * i], shapes[2 * i + 1].get(), poses[f][2 * i + 1], request,
                            result) > 0;
    }
    double apart(int f, int i) const {
        fcl::DistanceRequestd request(true);
        request.gjk_solver_type = fcl::GST_LIBCCD;
        fcl::DistanceResultd result;
        return fcl::distance(shapes[2 * i].get(), poses[f][2 * i], shapes[2 * i + 1].get(), poses[f][2 * i + 1],
                             request, result);
    }
    std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;
    std::vector<fcl::Transform3d> poses[kFrames];
};
void fcl_pairs(benchmark::State& state, Ask ask, double gap, bool boxes) {
    const Scene scene = make_scene(gap, boxes);
    const FclScene peer(scene);
    const auto meet = [&](int f, int i) { return peer.meet(f, i, false); };
    if (ask == Ask::meet) return frames(state, scene, meet, meet);
    if (ask == Ask::distance)
        return frames(
            state, scene, [&](int f, int i) { return peer.apart(f, i); }, meet);
    frames(
        state, scene, [&](int f, int i) { return peer.meet(f, i, true); }, meet);
}
BENCHMARK_CAPTURE(fcl_pairs, a, Ask::meet, 0.1, false)->Name("hull32 yes-no apart 0.1/fcl");
BENCHMARK_CAPTURE(fcl_pairs, b, Ask::meet, -0.01, false)->Name("hull32 yes-no overlap 0.01/fcl");
BENCHMARK_CAPTURE(fcl_pairs, c, Ask::distance, 0.1, false)->Name("hull32 distance 0.1/fcl");
BENCHMARK_CAPTURE(fcl_pairs, d, Ask::manifold, -0.01, false)->Name("hull32 manifold 0.01/fcl");
BENCHMARK_CAPTURE(fcl_pairs, e, Ask::manifold, -0.01, true)->Name("box manifold 0.01/fcl");
#endif

#if defined(CROFTON_HAVE_BULLET)
struct BulletScene {
    explicit BulletScene(const Scene& scene) : dispatcher(&configuration) {
        for (int i = 0; i < 2 * kPairs; ++i) {
            if (scene.shapes[i].kind() == Kind::box) {
                const glm::dvec3 h = scene.shapes[i].half_extents();
                shapes.push_back(std::make_unique<btBoxShape>(btVector3(btScalar(h.x), btScalar(h.y), btScalar(h.z))));
            } else {
                auto hull = std::make_unique<btConvexHullShape>();
                for (const glm::vec3& v : scene.hulls[i]->vertices()) hull->addPoint(btVector3(v.x, v.y, v.z), false);
                hull->recalcLocalAabb();
                hull->setMargin(0);
                hull->initializePolyhedralFeatures();
                shapes.push_back(std::move(hull));
            }
            objects.push_back(std::make_unique<btCollisionObject>());
            objects.back()->setCollisionShape(shapes.back().get());
        }
        for (int f = 0; f < kFrames; ++f)
            for (int i = 0; i < 2 * kPairs; ++i) {
                btTransform t = btTransform::getIdentity();
                for (int r = 0; r < 3; ++r) {
                    t.getOrigin()[r] = btScalar(scene.poses[f][i].translation[r]);
                    for (int c = 0; c < 3; ++c) t.getBasis()[r][c] = btScalar(scene.poses[f][i].rotation[c][r]);
                }
                poses[f].push_back(t);
            }
        configuration.setConvexConvexMultipointIterations(0, 0);
    }
    // The signed distance of Bullet's pair detector, with its own warm start (the cached axis).
    double apart(int f, int i) {
        solver.reset();
        btGjkPairDetector detector(shapes[2 * i].get(), shapes[2 * i + 1].get(), &solver, &epa);
        detector.setCachedSeparatingAxis(axes[i]);
        btGjkPairDetector::ClosestPointInput input;
        input.m_transformA = poses[f][2 * i];
        input.m_transformB = poses[f][2 * i + 1];
        btPointCollector result;
        detector.getClosestPoints(input, result, nullptr);
        axes[i] = detector.getCachedSeparatingAxis();
        return double(result.m_distance);
    }
    // Its whole algorithm for a pair, whose manifold lives from frame to frame.
    int manifold(int f, int i) {
        objects[2 * i]->setWorldTransform(poses[f][2 * i]);
        objects[2 * i + 1]->setWorldTransform(poses[f][2 * i + 1]);
        btCollisionObjectWrapper a(nullptr, shapes[2 * i].get(), objects[2 * i].get(), poses[f][2 * i], -1, -1);
        btCollisionObjectWrapper b(nullptr, shapes[2 * i + 1].get(), objects[2 * i + 1].get(), poses[f][2 * i + 1], -1,
                                   -1);
        if (!algorithms[i]) algorithms[i] = dispatcher.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        btManifoldResult result(&a, &b);
        algorithms[i]->processCollision(&a, &b, info, &result);
        return result.getPersistentManifold() ? result.getPersistentManifold()->getNumContacts() : 0;
    }
    double cast(int f, int i) {
        solver.reset();
        btContinuousConvexCollision cast(static_cast<btConvexShape*>(shapes[2 * i].get()),
                                         static_cast<btConvexShape*>(shapes[2 * i + 1].get()), &solver, &epa);
        btTransform to = poses[f][2 * i + 1];
        to.setOrigin(-to.getOrigin());
        btConvexCast::CastResult result;
        return cast.calcTimeOfImpact(poses[f][2 * i], poses[f][2 * i], poses[f][2 * i + 1], to, result)
                   ? double(result.m_fraction)
                   : 1.0;
    }
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher;
    btDispatcherInfo info;
    btVoronoiSimplexSolver solver;
    btGjkEpaPenetrationDepthSolver epa;
    std::vector<std::unique_ptr<btConvexShape>> shapes;
    std::vector<std::unique_ptr<btCollisionObject>> objects;
    std::vector<btTransform> poses[kFrames];
    btVector3 axes[kPairs];
    btCollisionAlgorithm* algorithms[kPairs] = {};
};
void bullet_pairs(benchmark::State& state, Ask ask, double gap, bool boxes) {
    const Scene scene = make_scene(gap, boxes);
    const auto peer = std::make_unique<BulletScene>(scene);
    for (btVector3& axis : peer->axes) axis = btVector3(0, 1, 0);
    const auto meet = [&](int f, int i) { return peer->apart(f, i) <= 0; };
    if (ask == Ask::cast)
        return frames(
            state, scene, [&](int f, int i) { return peer->cast(f, i); }, meet);
    if (ask == Ask::manifold)
        return frames(
            state, scene, [&](int f, int i) { return peer->manifold(f, i); }, meet);
    frames(
        state, scene, [&](int f, int i) { return peer->apart(f, i); }, meet);
}
BENCHMARK_CAPTURE(bullet_pairs, a, Ask::meet, 0.1, false)->Name("hull32 yes-no apart 0.1/bullet");
BENCHMARK_CAPTURE(bullet_pairs, b, Ask::meet, -0.01, false)->Name("hull32 yes-no overlap 0.01/bullet");
BENCHMARK_CAPTURE(bullet_pairs, c, Ask::distance, 0.1, false)->Name("hull32 distance 0.1/bullet");
BENCHMARK_CAPTURE(bullet_pairs, d, Ask::penetration, -0.01, false)->Name("hull32 penetration 0.01/bullet");
BENCHMARK_CAPTURE(bullet_pairs, e, Ask::manifold, -0.01, false)->Name("hull32 manifold 0.01/bullet");
BENCHMARK_CAPTURE(bullet_pairs, g, Ask::manifold, 0.01, false)->Name("hull32 manifold gap 0.01/bullet");
BENCHMARK_CAPTURE(bullet_pairs, h, Ask::manifold, -0.01, true)->Name("box manifold 0.01/bullet");
BENCHMARK_CAPTURE(bullet_pairs, i, Ask::cast, 0.5, false)->Name("hull32 cast translation/bullet");
#endif

#if defined(CROFTON_HAVE_ODE)
// ODE's hulls are planes, points and polygons, which it does not copy.
struct OdeScene {
    explicit OdeScene(const Scene& scene) {
        dInitODE();
        data.resize(2 * kPairs);
        for (int i = 0; i < 2 * kPairs; ++i) {
            if (scene.shapes[i].kind() == Kind::box) {
                const glm::dvec3 h = scene.shapes[i].half_extents();
                geoms.push_back(dCreateBox(nullptr, dReal(2 * h.x), dReal(2 * h.y), dReal(2 * h.z)));
                continue;
            }
            NamedShape& shape = data[i];
            const Hull& hull = *scene.hulls[i];
            for (const glm::vec3& v : hull.vertices()) shape.points.insert(shape.points.end(), {v.x, v.y, v.z});
            for (int f = 0; f < hull.face_count(); ++f) {
                const glm::dvec3 n = hull.face_normal(f), p(hull.vertices()[hull.face_vertices(f)[0]]);
                shape.planes.insert(shape.planes.end(), {dReal(n.x), dReal(n.y), dReal(n.z), dReal(glm::dot(n, p))});
                shape.polygons.push_back(static_cast<unsigned>(hull.face_vertices(f).size()));
                for (const auto v : hull.face_vertices(f)) shape.polygons.push_back(v);
            }
            geoms.push_back(dCreateConvex(nullptr, shape.planes.data(), unsigned(hull.face_count()),
                                          shape.points.data(), unsigned(hull.vertices().size()),
                                          shape.polygons.data()));
        }
    }
    ~OdeScene() {
        for (const dGeomID geom : geoms) dGeomDestroy(geom);
        dCloseODE();
    }
    int contacts(const Scene& scene, int f, int i) const {
        for (int k = 2 * i; k < 2 * i + 2; ++k) {
            const RigidTransform& pose = scene.poses[f][k];
            dMatrix3 r{};
            for (int row = 0; row < 3; ++row)
                for (int c = 0; c < 3; ++c) r[4 * row + c] = dReal(pose.rotation[c][row]);
            dGeomSetRotation(geoms[k], r);
            dGeomSetPosition(geoms[k], dReal(pose.translation.x), dReal(pose.translation.y), dReal(pose.translation.z));
        }
        dContactGeom contact[8];
        return dCollide(geoms[2 * i], geoms[2 * i + 1], 8, contact, sizeof(dContactGeom));
    }
    struct NamedShape {
        std::vector<dReal> points, planes;
        std::vector<unsigned> polygons;
    };
    std::vector<NamedShape> data;
    std::vector<dGeomID> geoms;
};
void ode_pairs(benchmark::State& state, double gap, bool boxes) {
    const Scene scene = make_scene(gap, boxes);
    const OdeScene peer(scene);
    const auto contacts = [&](int f, int i) { return peer.contacts(scene, f, i); };
    frames(state, scene, contacts, [&](int f, int i) { return contacts(f, i) > 0; });
}
BENCHMARK_CAPTURE(ode_pairs, a, 0.1, false)->Name("hull32 yes-no apart 0.1/ode");
BENCHMARK_CAPTURE(ode_pairs, b, -0.01, false)->Name("hull32 manifold 0.01/ode");
BENCHMARK_CAPTURE(ode_pairs, c, -0.01, true)->Name("box manifold 0.01/ode");
#endif

}  // namespace
}  // namespace crofton::bench
