// SPDX-License-Identifier: MIT
// Compares manifolds of shapes that rest on surfaces with Bullet's and ODE's: boxes and capsules on the bunny, boxes on
// a height field of 1025 x 1025 corners. The poses tremble from frame to frame. `depth` is the mean of the deepest
// point, in sizes of the shape. ODE stops at as many contacts as its caller has room for: 64, or `all`.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>

#include "collide_inputs.hpp"

#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <btBulletCollisionCommon.h>
#endif
#if defined(CROFTON_HAVE_ODE)
#include <ode/ode.h>
#endif

namespace crofton::bench {
namespace {

using namespace crofton::convex;

constexpr int kFrames = 8, kShapes = 1000;
constexpr std::uint32_t kSide = 1025, kTerrainSide = 257;

// The surfaces: a mesh, a height field, and the same heights as a mesh of 131,072 triangles.
enum class Ground { bunny, heights, terrain };

// Where a shape stands on a surface, sunk in by 1 % of its size.
struct SurfaceScene {
    TriangleMesh mesh;  // empty: the field
    std::vector<float> heights;
    Shape shape = Shape::sphere(1).value();
    float size = 0.0f;
    bool capsule = false;
    std::vector<RigidTransform> poses[kFrames];
};

float height(double x, double z) {
    return static_cast<float>(4.0 * std::sin(0.031 * x) * std::cos(0.027 * z) + 0.4 * std::sin(0.5 * x + 0.3 * z));
}

// Small boxes sunk a little into single raised corners of a flat field, below the middle of their lower faces.
SurfaceScene make_crests() {
    SurfaceScene scene;
    scene.size = 0.4f;
    scene.shape = Shape::box(glm::vec3(scene.size)).value();
    scene.heights.assign(std::size_t{kSide} * kSide, -1.0f);
    for (int i = 0; i < kShapes; ++i) {
        const std::size_t x = 10 + 30 * static_cast<std::size_t>(i % 33),
                          z = 10 + 30 * static_cast<std::size_t>(i / 33);
        scene.heights[z * kSide + x] = 0.0f;
        for (int f = 0; f < kFrames; ++f)
            scene.poses[f].push_back(
                {glm::dmat3(1.0), glm::dvec3(x, 0.4 - 0.005 * (f + 1), z) + glm::dvec3(0.02, 0, 0.03)});
    }
    return scene;
}

TriangleMesh make_terrain() {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j < kTerrainSide; ++j)
        for (std::uint32_t i = 0; i < kTerrainSide; ++i) mesh.positions.emplace_back(i, height(i, j), j);
    for (std::uint32_t j = 0; j + 1 < kTerrainSide; ++j)
        for (std::uint32_t i = 0; i + 1 < kTerrainSide; ++i) {
            const std::uint32_t at = j * kTerrainSide + i, beyond = at + kTerrainSide;
            mesh.indices.insert(mesh.indices.end(), {at, beyond, at + 1, at + 1, beyond, beyond + 1});
        }
    return mesh;
}

SurfaceScene make_scene(Ground ground, bool capsule, bool crests = false) {
    if (crests) return make_crests();
    SurfaceScene scene;
    std::mt19937_64 random(3);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto direction = [&] { return glm::normalize(glm::dvec3(number(-1, 1), number(-1, 1), number(-1, 1.1))); };
    scene.capsule = capsule;
    const double far = ground == Ground::heights ? 1000.0 : kTerrainSide - 20.0;  // from the corner of the heights
    if (ground == Ground::heights) {
        for (std::uint32_t j = 0; j < kSide; ++j)
            for (std::uint32_t i = 0; i < kSide; ++i) scene.heights.push_back(height(i, j));
    } else if (ground == Ground::terrain) {
        scene.mesh = make_terrain();
    }
    scene.size = 0.5f;
    if (ground == Ground::bunny) {
        scene.mesh = shared_mesh("bunny");
        glm::vec3 low(1e9f), high(-1e9f);
        for (const glm::vec3& p : scene.mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
        scene.size = 0.03f * glm::length(high - low);
    }
    const float s = scene.size;
    scene.shape = capsule ? Shape::capsule(0.6f * s, 0.5f * s).value() : Shape::box({s, s, s}).value();
    for (int i = 0; i < kShapes; ++i) {
        glm::dvec3 on, n;
        if (ground != Ground::bunny) {
            on = {number(20, far), 0, number(20, far)};
            on.y = height(on.x, on.z);
            n = glm::normalize(glm::dvec3(on.y - height(on.x + 1, on.z), 1.0, on.y - height(on.x, on.z + 1)));
        } else {
            const std::size_t t = 3 * (random() % (scene.mesh.indices.size() / 3));
            const auto corner = [&](std::size_t k) {
                return glm::dvec3(scene.mesh.positions[scene.mesh.indices[t + k]]);
            };
            n = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
            on = (corner(0) + corner(1) + corner(2)) / 3.0;
        }
        const glm::dvec3 side = glm::normalize(glm::cross(n, direction()));
        const glm::dmat3 frame(side, n, glm::cross(side, n));
        const double lift = (capsule ? 1.1 : 1.0) * s - 0.01 * s;
        for (int f = 0; f < kFrames; ++f)
            scene.poses[f].push_back({frame, on + lift * n + 1e-4 * double(s) * direction()});
    }
    return scene;
}

struct Told {
    int points = 0;
    double depth = 0.0;
};

template <class Run>
void frames(benchmark::State& state, double size, Run run) {
    int f = 0;
    std::uint64_t points = 0, touching = 0;
    double depth = 0.0;
    for (auto _ : state) {
        for (int i = 0; i < kShapes; ++i) {
            const Told told = run(f, i);
            points += static_cast<std::uint64_t>(told.points);
            touching += told.points > 0 ? 1 : 0;
            depth += told.points > 0 ? told.depth : 0.0;
        }
        f = (f + 1) % kFrames;
    }
    const double all = static_cast<double>(state.iterations()) * kShapes;
    state.counters["points"] = static_cast<double>(points) / all;
    state.counters["depth"] = touching > 0 ? depth / (size * static_cast<double>(touching)) : 0.0;
    state.counters["touching"] = static_cast<double>(touching) / all;
    state.counters["ns"] = benchmark::Counter(all * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// The surface as this library has it.
class OwnSurface {
  public:
    explicit OwnSurface(const SurfaceScene& scene) : is_field_(!scene.heights.empty()) {
        if (is_field_)
            heights_ = HeightField::build({kSide, kSide, scene.heights}).value();
        else
            tree_ = mesh::MeshTree::build(scene.mesh).value();
    }
    // Of a mesh these sides; a field is asked for its front.
    [[nodiscard]] Shape shape(Sides sides) const {
        return is_field_ ? Shape::height_field(heights_) : Shape::mesh(tree_, sides).value();
    }

  private:
    bool is_field_;
    HeightField heights_;
    mesh::MeshTree tree_;
};

bool is_missing(const SurfaceScene& scene, benchmark::State& state) {
    const bool missing = scene.heights.empty() && scene.mesh.indices.empty();
    if (missing) state.SkipWithError("no shared meshes");
    return missing;
}

void crofton_rest(benchmark::State& state, Ground ground, bool capsule, bool crests = false) {
    const SurfaceScene scene = make_scene(ground, capsule, crests);
    if (is_missing(scene, state)) return;
    const OwnSurface own(scene);
    const Shape surface = own.shape(Sides::front);
    const RigidTransform still;
    Manifolds found;
    frames(state, scene.size, [&](int f, int i) {
        contact_manifolds({surface, still}, {scene.shape, scene.poses[f][i]}, {.margin = 0.02 * scene.size}, found);
        Told told{0, -HUGE_VAL};
        for (const Manifold& m : found.all()) {
            told.points += m.count;
            told.depth = std::max(told.depth, m.depth);
        }
        return told;
    });
}
// A ball of the box's width, sunk in by as much.
void crofton_ball(benchmark::State& state) {
    const SurfaceScene scene = make_scene(Ground::bunny, false);
    if (is_missing(scene, state)) return;
    const OwnSurface own(scene);
    const Shape surface = own.shape(Sides::front), ball = Shape::sphere(scene.size).value();
    const RigidTransform still;
    Manifolds found;
    frames(state, scene.size, [&](int f, int i) {
        contact_manifolds({surface, still}, {ball, scene.poses[f][i]}, {.margin = 0.02 * scene.size}, found);
        Told told{0, -HUGE_VAL};
        for (const Manifold& m : found.all()) {
            told.points += m.count;
            told.depth = std::max(told.depth, m.depth);
        }
        return told;
    });
}
BENCHMARK(crofton_ball)->Name("ball on bunny/crofton");
BENCHMARK_CAPTURE(crofton_rest, a, Ground::bunny, false)->Name("box on bunny/crofton");
BENCHMARK_CAPTURE(crofton_rest, b, Ground::bunny, true)->Name("capsule on bunny/crofton");
BENCHMARK_CAPTURE(crofton_rest, c, Ground::heights, false)->Name("box on heights 1025^2/crofton");
BENCHMARK_CAPTURE(crofton_rest, f, Ground::heights, false, true)->Name("box on a crest/crofton");
BENCHMARK_CAPTURE(crofton_rest, d, Ground::heights, true)->Name("capsule on heights 1025^2/crofton");

// The shape that is asked about: the scene's box, or a capsule or sphere of about its size.
enum class Probe { box, capsule, sphere };

Shape probe_shape(Probe kind, float s) {
    if (kind == Probe::capsule) return Shape::capsule(0.6f * s, 0.5f * s).value();
    return kind == Probe::sphere ? Shape::sphere(s).value() : Shape::box({s, s, s}).value();
}

// Down onto the surface from twice the size above it.
void crofton_drop(benchmark::State& state, Ground ground, Probe kind) {
    const SurfaceScene scene = make_scene(ground, false);
    if (is_missing(scene, state)) return;
    const OwnSurface own(scene);
    const Shape surface = own.shape(Sides::both), shape = probe_shape(kind, scene.size);
    const RigidTransform still;
    frames(state, scene.size, [&](int f, int i) {
        RigidTransform from = scene.poses[f][i];
        const glm::dvec3 n = from.rotation[1];
        from.translation += 2.0 * scene.size * n;
        const auto impact =
            cast({shape, from}, {-4.0 * scene.size * n, {}, {}}, {surface, still}, {}, {.tolerance = 1e-4});
        return Told{impact->result == CastResult::hit ? 1 : 0};
    });
}
#define DROP(ground, name)                                                                                         \
    BENCHMARK_CAPTURE(crofton_drop, box, ground, Probe::box)->Name("cast of a box, " name "/crofton");             \
    BENCHMARK_CAPTURE(crofton_drop, capsule, ground, Probe::capsule)->Name("cast of a capsule, " name "/crofton"); \
    BENCHMARK_CAPTURE(crofton_drop, sphere, ground, Probe::sphere)->Name("cast of a sphere, " name "/crofton")
DROP(Ground::bunny, "bunny");
DROP(Ground::heights, "heights 1025^2");
DROP(Ground::terrain, "terrain");
#undef DROP

// Where the shapes rest, sunk in by 1 % of their size, or as far above the surface as they are large.
enum class Question { meet, distance, depth };

void crofton_ask(benchmark::State& state, Ground ground, Question question, Probe kind) {
    const SurfaceScene scene = make_scene(ground, false);
    if (is_missing(scene, state)) return;
    const OwnSurface own(scene);
    const Shape surface = own.shape(Sides::both), shape = probe_shape(kind, scene.size);
    const RigidTransform still;
    frames(state, scene.size, [&](int f, int i) {
        RigidTransform pose = scene.poses[f][i];
        if (question == Question::distance) pose.translation += 1.0 * scene.size * pose.rotation[1];
        const ShapeAtPose probe{shape, pose}, mesh{surface, still};
        switch (question) {
            case Question::meet:
                return Told{intersects(probe, mesh) ? 1 : 0};
            case Question::distance:
                return Told{distance(probe, mesh).distance == 0.0 ? 1 : 0};
            default: {
                const Penetration p = penetration(probe, mesh);
                return Told{p.overlapping ? 1 : 0, p.depth};
            }
        }
    });
}
#define ASK(ground, question, name, where)                                                                        \
    BENCHMARK_CAPTURE(crofton_ask, box, ground, question, Probe::box)->Name(name " of a box, " where "/crofton"); \
    BENCHMARK_CAPTURE(crofton_ask, capsule, ground, question, Probe::capsule)                                     \
        ->Name(name " of a capsule, " where "/crofton");                                                          \
    BENCHMARK_CAPTURE(crofton_ask, sphere, ground, question, Probe::sphere)                                       \
        ->Name(name " of a sphere, " where "/crofton")
ASK(Ground::bunny, Question::meet, "overlap", "bunny");
ASK(Ground::bunny, Question::distance, "distance", "bunny");
ASK(Ground::bunny, Question::depth, "depth", "bunny");
ASK(Ground::terrain, Question::meet, "overlap", "terrain");
ASK(Ground::heights, Question::meet, "overlap", "heights 1025^2");
#undef ASK

#if defined(CROFTON_HAVE_BULLET)
struct BulletSurface {
    BulletSurface(const SurfaceScene& scene, bool field) : dispatcher(&configuration) {
        const btScalar s = scene.size;
        if (field) {
            const auto [low, high] = std::minmax_element(scene.heights.begin(), scene.heights.end());
            surface = std::make_unique<btHeightfieldTerrainShape>(int(kSide), int(kSide), scene.heights.data(), 1.0f,
                                                                  *low, *high, 1, PHY_FLOAT, false);
            place.setOrigin(btVector3(0.5f * (kSide - 1), 0.5f * (*low + *high), 0.5f * (kSide - 1)));
        } else {
            btIndexedMesh mesh;
            mesh.m_numTriangles = int(scene.mesh.indices.size() / 3);
            mesh.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(scene.mesh.indices.data());
            mesh.m_triangleIndexStride = 12;
            mesh.m_numVertices = int(scene.mesh.positions.size());
            mesh.m_vertexBase = reinterpret_cast<const unsigned char*>(scene.mesh.positions.data());
            mesh.m_vertexStride = 12;
            triangles.addIndexedMesh(mesh, PHY_INTEGER);
            surface = std::make_unique<btBvhTriangleMeshShape>(&triangles, true);
            surface->setMargin(0);
        }
        object.setCollisionShape(surface.get());
        object.setWorldTransform(place);
        if (scene.capsule)
            probe = std::make_unique<btCapsuleShape>(0.5f * s, 1.2f * s);
        else
            probe = std::make_unique<btBoxShape>(btVector3(s, s, s));
        for (int i = 0; i < kShapes; ++i) {
            objects.push_back(std::make_unique<btCollisionObject>());
            objects.back()->setCollisionShape(probe.get());
        }
        algorithms.resize(kShapes);
    }
    static btTransform transform_of(const RigidTransform& pose) {
        btTransform t = btTransform::getIdentity();
        for (int r = 0; r < 3; ++r) {
            t.getOrigin()[r] = btScalar(pose.translation[r]);
            for (int c = 0; c < 3; ++c) t.getBasis()[r][c] = btScalar(pose.rotation[c][r]);
        }
        return t;
    }
    Told manifold(const SurfaceScene& scene, int f, int i) {
        const btTransform t = transform_of(scene.poses[f][i]);
        objects[i]->setWorldTransform(t);
        btCollisionObjectWrapper a(nullptr, probe.get(), objects[i].get(), t, -1, -1);
        btCollisionObjectWrapper b(nullptr, surface.get(), &object, place, -1, -1);
        if (!algorithms[i]) algorithms[i] = dispatcher.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        btManifoldResult result(&a, &b);
        algorithms[i]->processCollision(&a, &b, info, &result);
        btManifoldArray manifolds;
        algorithms[i]->getAllContactManifolds(manifolds);
        if (manifolds.size() == 0) return {};
        Told told{manifolds[0]->getNumContacts(), -HUGE_VAL};
        for (int k = 0; k < told.points; ++k)
            told.depth = std::max(told.depth, -double(manifolds[0]->getContactPoint(k).getDistance()));
        return told;
    }
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher;
    btDispatcherInfo info;
    btTriangleIndexVertexArray triangles;
    btTransform place = btTransform::getIdentity();
    std::unique_ptr<btCollisionShape> surface;
    std::unique_ptr<btConvexShape> probe;
    btCollisionObject object;
    std::vector<std::unique_ptr<btCollisionObject>> objects;
    std::vector<btCollisionAlgorithm*> algorithms;
};
void bullet_rest(benchmark::State& state, bool field, bool capsule, bool crests = false) {
    const SurfaceScene scene = make_scene(field ? Ground::heights : Ground::bunny, capsule, crests);
    if (!field && scene.mesh.indices.empty()) return state.SkipWithError("no shared meshes");
    const auto peer = std::make_unique<BulletSurface>(scene, field);
    frames(state, scene.size, [&](int f, int i) { return peer->manifold(scene, f, i); });
}
BENCHMARK_CAPTURE(bullet_rest, a, false, false)->Name("box on bunny/bullet");
BENCHMARK_CAPTURE(bullet_rest, b, false, true)->Name("capsule on bunny/bullet");
BENCHMARK_CAPTURE(bullet_rest, c, true, false)->Name("box on heights 1025^2/bullet");
BENCHMARK_CAPTURE(bullet_rest, f, true, false, true)->Name("box on a crest/bullet");
BENCHMARK_CAPTURE(bullet_rest, d, true, true)->Name("capsule on heights 1025^2/bullet");
#endif

#if defined(CROFTON_HAVE_ODE)
float ode_height(void* user, int i, int j) {
    return static_cast<const float*>(user)[static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i)];
}
void ode_rest(benchmark::State& state, bool field, bool capsule, int room = 64, bool crests = false) {
    SurfaceScene scene = make_scene(field ? Ground::heights : Ground::bunny, capsule, crests);
    if (!field && scene.mesh.indices.empty()) return state.SkipWithError("no shared meshes");
    dInitODE();
    dTriMeshDataID data = nullptr;
    dHeightfieldDataID heights = nullptr;
    dGeomID surface;
    if (field) {
        heights = dGeomHeightfieldDataCreate();
        dGeomHeightfieldDataBuildSingle(heights, scene.heights.data(), 0, kSide - 1, kSide - 1, kSide, kSide, 1, 0, 0,
                                        0);
        dGeomHeightfieldDataSetBounds(heights, -5, 5);
        surface = dCreateHeightfield(nullptr, heights, 1);
        dGeomSetPosition(surface, 0.5f * (kSide - 1), 0, 0.5f * (kSide - 1));
    } else {
        data = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildSingle(data, scene.mesh.positions.data(), 12, int(scene.mesh.positions.size()),
                                    scene.mesh.indices.data(), int(scene.mesh.indices.size()), 12);
        surface = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
    }
    const dReal s = scene.size;
    const dGeomID geom =
        capsule ? dCreateCapsule(nullptr, dReal(0.5) * s, dReal(1.2) * s) : dCreateBox(nullptr, 2 * s, 2 * s, 2 * s);
    std::vector<dContactGeom> contact(static_cast<std::size_t>(room));
    frames(state, scene.size, [&](int f, int i) {
        const RigidTransform& pose = scene.poses[f][i];
        dMatrix3 r{};
        for (int row = 0; row < 3; ++row)
            for (int c = 0; c < 3; ++c)
                // ODE's capsules lie along z.
                r[4 * row + c] = dReal(capsule ? pose.rotation[c == 2   ? 1
                                                               : c == 1 ? 2
                                                                        : 0][row] *
                                                     (c == 2 ? -1 : 1)
                                               : pose.rotation[c][row]);
        dGeomSetRotation(geom, r);
        dGeomSetPosition(geom, dReal(pose.translation.x), dReal(pose.translation.y), dReal(pose.translation.z));
        Told told{dCollide(geom, surface, room, contact.data(), sizeof(dContactGeom)), -HUGE_VAL};
        for (int k = 0; k < told.points; ++k)
            told.depth = std::max(told.depth, double(contact[static_cast<std::size_t>(k)].depth));
        return told;
    });
    dGeomDestroy(geom);
    dGeomDestroy(surface);
    if (data != nullptr) dGeomTriMeshDataDestroy(data);
    if (heights != nullptr) dGeomHeightfieldDataDestroy(heights);
    dCloseODE();
}
BENCHMARK_CAPTURE(ode_rest, a, false, false)->Name("box on bunny/ode");
BENCHMARK_CAPTURE(ode_rest, e, false, false, 4096)->Name("box on bunny/ode all");
BENCHMARK_CAPTURE(ode_rest, b, false, true)->Name("capsule on bunny/ode");
BENCHMARK_CAPTURE(ode_rest, c, true, false)->Name("box on heights 1025^2/ode");
BENCHMARK_CAPTURE(ode_rest, f, true, false, 64, true)->Name("box on a crest/ode");
BENCHMARK_CAPTURE(ode_rest, d, true, true)->Name("capsule on heights 1025^2/ode");
#endif

}  // namespace
}  // namespace crofton::bench
