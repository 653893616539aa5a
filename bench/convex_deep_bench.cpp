// SPDX-License-Identifier: MIT
// Balls whose centres are inside boxes, and inside houses of 12 triangles: 400 pairs of a World, and pairs of shapes.
// `ns a pair` is the least of all frames.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <random>
#include <vector>

namespace crofton::bench {
namespace {

constexpr int kHouses = 400;
constexpr double kRadius = 0.6;

enum class House { box, mesh, scaled };

TriangleMesh house_mesh(float half) {
    TriangleMesh mesh;
    for (unsigned corner = 0; corner < 8; ++corner)
        mesh.positions.push_back(half * glm::vec3(corner & 1 ? 1 : -1, corner & 2 ? 2 : 0, corner & 4 ? 1 : -1));
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

// Houses of 12 × 12 × 12 in rows, with a ball in nearly each that moves a little from frame to frame.
void update(benchmark::State& state, House kind) {
    World world;
    const TriangleMesh mesh = house_mesh(kind == House::scaled ? 1.0f : 6.0f);
    std::vector<std::uint16_t> indices(mesh.indices.begin(), mesh.indices.end());
    std::vector<float> numbers;
    for (const glm::vec3& p : mesh.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    const auto handle = world.add_mesh({.positions = {numbers.data(), 8}, .indices = indices}).value();
    Transform placed;
    if (kind == House::scaled) placed.linear = glm::dmat3(6.0);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-7, 7);
    std::vector<ObjectHandle> balls;
    std::vector<glm::dvec3> at;
    for (int i = 0; i < kHouses; ++i) {
        const glm::dvec3 corner(20.0 * (i % 20), 0, 20.0 * (i / 20));
        placed.translation = corner;
        if (kind == House::box)
            world.add({.bound = Obb{corner + glm::dvec3(0, 6, 0), glm::mat3(1.0f), {6, 6, 6}}}).value();
        else
            world.add({.mesh = handle, .transform = placed}).value();
        const double x = place(random), z = place(random);
        at.push_back(corner + glm::dvec3(x, 1, z));
        balls.push_back(world.add({.bound = Sphere{at.back(), kRadius}}).value());
    }
    double least = HUGE_VAL;
    int frame = 0;
    for (auto _ : state) {
        const double step = ++frame % 64 < 32 ? 0.01 : -0.01;
        for (std::size_t i = 0; i < balls.size(); ++i) {
            at[i].x += step;
            world.set_bound(balls[i], Sphere{at[i], kRadius}).value();
        }
        (void)world.update();
        if (frame > 8 && !world.pairs().empty())
            least = std::min(least, world.statistics().contacts_us / static_cast<double>(world.pairs().size()));
    }
    state.counters["ns a pair"] = 1e3 * least;
    state.counters["pairs"] = static_cast<double>(world.pairs().size());
    state.counters["contacts"] = static_cast<double>(world.contacts().size());
}
BENCHMARK_CAPTURE(update, box, House::box)->Name("balls in boxes, World/crofton");
BENCHMARK_CAPTURE(update, mesh, House::mesh)->Name("balls in houses, World/crofton");
BENCHMARK_CAPTURE(update, scaled, House::scaled)->Name("balls in scaled houses, World/crofton");

// Shapes: a ball or a capsule with its middle deep in a box, and within its radius of the wall of a house.
void manifold(benchmark::State& state, bool in_house, bool is_capsule) {
    const auto tree = mesh::MeshTree::build(house_mesh(6.0f)).value();
    const auto house =
        in_house ? convex::Shape::mesh(tree, convex::Sides::front).value() : convex::Shape::box({6, 6, 6}).value();
    const auto mover = is_capsule ? convex::Shape::capsule(0.5f, static_cast<float>(kRadius)).value()
                                  : convex::Shape::sphere(static_cast<float>(kRadius)).value();
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-5.9, 5.9), gap(0.0, kRadius);
    std::vector<RigidTransform> poses(1024);
    for (RigidTransform& pose : poses) {
        const double x = place(random), y = place(random), z = place(random), from_wall = gap(random);
        pose.translation = in_house ? glm::dvec3(6.0 - from_wall, y + 6.0, z) : glm::dvec3(x, y, z);
    }
    std::size_t i = 0, points = 0;
    convex::Manifolds found;
    for (auto _ : state) {
        convex::contact_manifolds({house, {}}, {mover, poses[i++ % poses.size()]}, {}, found);
        for (const convex::Manifold& m : found.all()) points += static_cast<std::size_t>(m.count);
    }
    state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}
BENCHMARK_CAPTURE(manifold, a, false, false)->Name("ball deep in a box, manifold/crofton");
BENCHMARK_CAPTURE(manifold, b, false, true)->Name("capsule deep in a box, manifold/crofton");
BENCHMARK_CAPTURE(manifold, c, true, false)->Name("ball in the wall of a house, manifold/crofton");
BENCHMARK_CAPTURE(manifold, d, true, true)->Name("capsule in the wall of a house, manifold/crofton");

}  // namespace
}  // namespace crofton::bench
