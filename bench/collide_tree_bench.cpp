// SPDX-License-Identifier: MIT
// Rays and spheres against the boxes of a tree, and of Bullet's dynamic tree where it is installed; the exact test of a
// box is the same for both.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <random>

#include "cull_crowd.hpp"

#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#endif

namespace crofton::bench {
namespace {

constexpr std::size_t kQueries = 4096;

std::vector<Ray> rays_through(std::size_t count) {
    std::mt19937_64 random(count);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    const double side = std::cbrt(static_cast<double>(count));
    std::vector<Ray> rays(kQueries);
    for (Ray& ray : rays) {
        ray.origin = side * glm::dvec3(unit(random), unit(random), unit(random));
        ray.direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        ray.max_t = side;
    }
    return rays;
}

void report(benchmark::State& state, std::size_t found) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kQueries));
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(kQueries);
}

void tree_rays(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const auto tree = boxtree::BoxTree::build(crowd(count));
    const auto rays = rays_through(count);
    std::size_t hits = 0;
    for (auto _ : state) {
        hits = 0;
        for (const Ray& ray : rays) hits += collide::raycast(ray, *tree).has_value();
        benchmark::DoNotOptimize(hits);
    }
    report(state, hits);
}

void tree_spheres(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const auto tree = boxtree::BoxTree::build(crowd(count));
    const auto rays = rays_through(count);
    Vector<boxtree::ItemId> items;
    std::size_t found = 0;
    for (auto _ : state) {
        found = 0;
        for (const Ray& ray : rays) {
            collide::overlapping(*tree, Sphere{ray.origin, 1.5}, items);
            found += items.size();
        }
        benchmark::DoNotOptimize(found);
    }
    report(state, found);
}

#if defined(CROFTON_HAVE_BULLET)
btVector3 vector(const glm::dvec3& v) {
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

struct BulletTree {
    btDbvt tree;
    std::vector<Obb> boxes;

    explicit BulletTree(std::size_t count) : boxes(crowd(count)) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Aabb bounds = aabb_of(boxes[i]);
            tree.insert(btDbvtVolume::FromMM(vector(bounds.min), vector(bounds.max)), nullptr)->dataAsInt =
                static_cast<int>(i);
        }
        tree.optimizeTopDown();
    }
};

// Bullet's rayTestInternal does not shorten the ray at a hit, so that all boxes on it are visited; nor does rayTest.
struct NearestOfBullet : btDbvt::ICollide {
    const std::vector<Obb>* boxes = nullptr;
    Ray ray;
    bool hit = false;
    void Process(const btDbvtNode* leaf) {
        if (const auto t = mesh::raycast(ray, (*boxes)[static_cast<std::size_t>(leaf->dataAsInt)]))
            ray.max_t = *t, hit = true;
    }
};

void bullet_rays(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const BulletTree bullet(count);
    const auto rays = rays_through(count);
    std::size_t hits = 0;
    for (auto _ : state) {
        hits = 0;
        for (const Ray& ray : rays) {
            NearestOfBullet nearest;
            nearest.boxes = &bullet.boxes;
            nearest.ray = ray;
            btDbvt::rayTest(bullet.tree.m_root, vector(ray.origin), vector(ray.origin + ray.max_t * ray.direction),
                            nearest);
            hits += nearest.hit;
        }
        benchmark::DoNotOptimize(hits);
    }
    report(state, hits);
}

struct BallOfBullet : btDbvt::ICollide {
    const std::vector<Obb>* boxes = nullptr;
    Sphere sphere;
    std::vector<std::uint32_t> items;
    void Process(const btDbvtNode* leaf) {
        if (collide::intersects((*boxes)[static_cast<std::size_t>(leaf->dataAsInt)], sphere))
            items.push_back(static_cast<std::uint32_t>(leaf->dataAsInt));
    }
};

void bullet_spheres(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    BulletTree bullet(count);
    const auto rays = rays_through(count);
    BallOfBullet query;
    query.boxes = &bullet.boxes;
    std::size_t found = 0;
    for (auto _ : state) {
        found = 0;
        for (const Ray& ray : rays) {
            query.items.clear();
            query.sphere = {ray.origin, 1.5};
            const btDbvtVolume volume = btDbvtVolume::FromCR(vector(ray.origin), btScalar(1.5));
            bullet.tree.collideTV(bullet.tree.m_root, volume, query);
            found += query.items.size();
        }
        benchmark::DoNotOptimize(found);
    }
    report(state, found);
}
BENCHMARK(bullet_rays)
    ->Name("tree/rays/bullet")
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bullet_spheres)
    ->Name("tree/spheres/bullet")
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Unit(benchmark::kMillisecond);
#endif

BENCHMARK(tree_rays)
    ->Name("tree/rays/crofton")
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(tree_spheres)
    ->Name("tree/spheres/crofton")
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crofton::bench
