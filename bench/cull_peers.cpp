// SPDX-License-Identifier: MIT
// Bullet's dynamic AABB tree on the same crowd.
#include <benchmark/benchmark.h>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::report;

struct BulletIds : btDbvt::ICollide {
    std::vector<std::uint32_t> ids;
    void Process(const btDbvtNode* leaf) { ids.push_back(static_cast<std::uint32_t>(leaf->dataAsInt)); }
};

struct BulletTree {
    btDbvt tree;
    std::vector<btDbvtNode*> leaves;
    explicit BulletTree(const std::vector<Obb>& boxes) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            leaves.push_back(tree.insert(volume_of(boxes[i]), nullptr));
            leaves.back()->dataAsInt = static_cast<int>(i);
        }
        tree.optimizeTopDown();
    }
    static btDbvtVolume volume_of(const Obb& box) {
        const Aabb b = aabb_of(box);
        const auto vector = [](const glm::dvec3& v) { return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z)); };
        return btDbvtVolume::FromMM(vector(b.min), vector(b.max));
    }
};

void bullet_cull(benchmark::State& state, double share) {
    const BulletTree bullet(boxes_of(state.range(0)));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), share);
    btVector3 normals[6];
    btScalar offsets[6];
    for (unsigned k = 0; k < 6; ++k) {
        const Plane& plane = view.frustum.planes[k];
        normals[k] = btVector3(btScalar(plane.normal.x), btScalar(plane.normal.y), btScalar(plane.normal.z));
        offsets[k] = btScalar(plane.offset - glm::dot(plane.normal, view.frustum.origin));
    }
    BulletIds found;
    for (auto _ : state) {
        found.ids.clear();
        btDbvt::collideKDOP(bullet.tree.m_root, normals, offsets, 6, found);
        benchmark::DoNotOptimize(found.ids.data());
    }
    report(state, found.ids.size());
}
void bullet_move_and_cull(benchmark::State& state) {
    std::vector<Obb> boxes = boxes_of(state.range(0));
    BulletTree bullet(boxes);
    std::mt19937 random(1);
    std::vector<std::size_t> items;
    for (std::size_t i = 0; i < boxes.size() / 10; ++i) items.push_back(random() % boxes.size());
    double step = 0.1;
    for (auto _ : state) {
        for (const std::size_t i : items) {
            boxes[i].center.x += step;
            btDbvtVolume volume = BulletTree::volume_of(boxes[i]);
            bullet.tree.update(bullet.leaves[i], volume);
        }
        step = -step;
    }
}
BENCHMARK(bullet_move_and_cull)->Name("bullet_move")->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bullet_cull, 20_percent, 0.2)->RangeMultiplier(10)->Range(10000, 1000000);
BENCHMARK_CAPTURE(bullet_cull, 1_percent, 0.01)->Arg(1000000);

}  // namespace
