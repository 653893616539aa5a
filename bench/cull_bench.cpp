// Culling beside Bullet's dynamic AABB tree and beside the plainest loop over AABBs. Compare within one run.
#include <benchmark/benchmark.h>

#include <crofton/core/thread_pool.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/many_views.hpp>
#include <crofton/tree/box_tree.hpp>
#include <map>

#include "cull_crowd.hpp"
#if defined(CROFTON_HAVE_BULLET)
#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#endif

namespace {

using namespace crofton;

const std::vector<Obb>& boxes_of(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty()) boxes = bench::crowd(static_cast<std::size_t>(count));
    return boxes;
}

const tree::BoxTree& tree_of(std::int64_t count) {
    static std::map<std::int64_t, tree::BoxTree> made;
    auto found = made.find(count);
    if (found == made.end()) found = made.emplace(count, *tree::BoxTree::build(boxes_of(count))).first;
    return found->second;
}

void report(benchmark::State& state, std::size_t visible) {
    state.counters["visible"] = static_cast<double>(visible);
    state.counters["ns_per_box"] =
        benchmark::Counter(static_cast<double>(state.range(0)) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void tree_cull(benchmark::State& state, cull::Mode mode, cull::Order order, double share) {
    const tree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), share);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::cull(tree, view, visible, {mode, order});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
    state.counters["nodes_tested"] = static_cast<double>(visible.statistics().nodes_tested);
    state.counters["exact_tests"] = static_cast<double>(visible.statistics().exact_tests);
    state.counters["straddling"] = static_cast<double>(visible.statistics().straddling);
}
BENCHMARK_CAPTURE(tree_cull, conservative, cull::Mode::conservative, cull::Order::tree, 0.2)
    ->RangeMultiplier(10)
    ->Range(10000, 1000000);
BENCHMARK_CAPTURE(tree_cull, exact, cull::Mode::exact, cull::Order::tree, 0.2)
    ->RangeMultiplier(10)
    ->Range(10000, 1000000);
BENCHMARK_CAPTURE(tree_cull, exact_ascending, cull::Mode::exact, cull::Order::ascending, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull, exact_1_percent, cull::Mode::exact, cull::Order::tree, 0.01)->Arg(1000000);

// Boxes numbered in the tree's order, as a renderer would lay its instances out.
const std::vector<Obb>& boxes_in_tree_order(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty())
        for (const tree::ItemId item : tree_of(count).slot_items())
            if (item != tree::kNone) boxes.push_back(boxes_of(count)[item]);
    return boxes;
}

void tree_cull_numbered(benchmark::State& state, cull::Order order) {
    const auto& boxes = boxes_in_tree_order(state.range(0));
    const tree::BoxTree tree = *tree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::cull(tree, view, visible, {cull::Mode::exact, order});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
}
BENCHMARK_CAPTURE(tree_cull_numbered, in_tree_order, cull::Order::tree)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_numbered, ascending, cull::Order::ascending)->Arg(1000000);

// After ten thousand frames of random motion, a hundredth of the boxes a frame by up to a tenth of the spacing, with
// bounded rebuilding in the background: a query beside one in a tree built afresh from the same boxes.
void aged_cull(benchmark::State& state, bool fresh) {
    static std::map<std::int64_t, std::pair<std::vector<Obb>, tree::BoxTree>> aged;
    const std::int64_t count = state.range(0);
    if (!aged.contains(count)) {
        std::vector<Obb> boxes = boxes_of(count);
        tree::BoxTree tree = *tree::BoxTree::build(boxes);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> step(-0.1, 0.1);
        for (int frame = 0; frame < 10000; ++frame) {
            for (std::int64_t i = 0; i < count / 100; ++i) {
                const auto item = static_cast<tree::ItemId>(random() % boxes.size());
                boxes[item].center += glm::dvec3(step(random), step(random), step(random));
                if (!tree.move(item, boxes[item])) state.SkipWithError("move failed");
            }
            tree.refit();
            tree.maintain(boxes.size() / 50);
        }
        aged.emplace(count, std::pair(std::move(boxes), std::move(tree)));
    }
    const auto& [boxes, old] = aged.at(count);
    const tree::BoxTree fresh_tree = *tree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes_of(count), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::cull(fresh ? fresh_tree : old, view, visible, {cull::Mode::exact, cull::Order::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
}
BENCHMARK_CAPTURE(aged_cull, aged, false)->Arg(100000);
BENCHMARK_CAPTURE(aged_cull, fresh, true)->Arg(100000);

// Every box against the view; `ids` lists the visible ones besides.
void flat_cull(benchmark::State& state, cull::Mode mode, bool ids) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits verdicts;
    std::vector<cull::ItemId> list(boxes.size() + 16);
    std::size_t visible = 0;
    for (auto _ : state) {
        cull::cull(set, boxes, view, verdicts, mode);
        if (ids) visible = cull::list_bits(verdicts.visible, list);
        benchmark::DoNotOptimize(verdicts.visible.data());
        benchmark::DoNotOptimize(list.data());
    }
    report(state, visible);
    state.counters["exact_tests"] = static_cast<double>(verdicts.statistics.exact_tests);
}
BENCHMARK_CAPTURE(flat_cull, conservative, cull::Mode::conservative, false)->Arg(10000)->Arg(1000000);
BENCHMARK_CAPTURE(flat_cull, exact, cull::Mode::exact, false)->Arg(10000)->Arg(1000000);
BENCHMARK_CAPTURE(flat_cull, exact_ids, cull::Mode::exact, true)->Arg(10000)->Arg(1000000);

// The same for axis-aligned boxes and for balls around the boxes.
template <class Bound>
void flat_bounds(benchmark::State& state, const std::vector<Bound>& bounds) {
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        cull::cull(set, bounds, view, verdicts);
        benchmark::DoNotOptimize(verdicts.visible.data());
    }
    report(state, 0);
    state.counters["exact_tests"] = static_cast<double>(verdicts.statistics.exact_tests);
}
void flat_cull_aabbs(benchmark::State& state) {
    std::vector<Aabb> bounds;
    for (const Obb& box : boxes_of(state.range(0))) bounds.push_back(aabb_of(box));
    flat_bounds(state, bounds);
}
void flat_cull_spheres(benchmark::State& state) {
    std::vector<Sphere> bounds;
    for (const Obb& box : boxes_of(state.range(0)))
        bounds.push_back({box.center, glm::length(glm::dvec3(box.half_extents))});
    flat_bounds(state, bounds);
}
BENCHMARK(flat_cull_aabbs)->Arg(10000)->Arg(1000000);
BENCHMARK(flat_cull_spheres)->Arg(10000)->Arg(1000000);

void tree_build(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(tree::BoxTree::build(boxes_of(state.range(0)))->item_count());
    report(state, 0);
}
BENCHMARK(tree_build)->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// Two threads beside one, the same query.
void threads(benchmark::State& state) {
    ThreadPool pool(static_cast<unsigned>(state.range(1)));
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        cull::cull(set, boxes, view, verdicts, cull::Mode::exact, pool);
        benchmark::DoNotOptimize(verdicts.visible.data());
    }
}
BENCHMARK(threads)->Args({1000000, 1})->Args({1000000, 2})->UseRealTime();

void tree_threads(benchmark::State& state) {
    ThreadPool pool(static_cast<unsigned>(state.range(1)));
    const tree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::cull(tree, view, visible, {cull::Mode::exact, cull::Order::tree}, pool);
        benchmark::DoNotOptimize(visible.ids().data());
    }
}
BENCHMARK(tree_threads)->Args({1000000, 1})->Args({1000000, 2})->UseRealTime();

// 300 cameras on a way through the crowd, each seeing about 1 % of it.
void flight(benchmark::State& state, cull::Mode mode) {
    const tree::BoxTree& tree = tree_of(state.range(0));
    const double side = std::cbrt(static_cast<double>(state.range(0)));
    std::vector<cull::View> views;
    for (int f = 0; f < 300; ++f) {
        Camera camera;
        const double angle = 0.02 * f;
        camera.position = side * glm::dvec3(0.5 + 0.3 * std::cos(angle), 0.5 + 0.1 * std::sin(3.0 * angle),
                                            0.5 + 0.3 * std::sin(angle));
        camera.forward = {-std::sin(angle), 0.1, std::cos(angle)};
        camera.aspect = 1.0;
        camera.far = 0.31 * side;
        views.push_back({*frustum_of(camera)});
    }
    cull::VisibleSet visible;
    std::size_t frame = 0, seen = 0;
    for (auto _ : state) {
        cull::cull(tree, views[frame++ % views.size()], visible, {mode, cull::Order::tree});
        seen += visible.size();
    }
    report(state, frame ? seen / frame : 0);
}
BENCHMARK_CAPTURE(flight, conservative, cull::Mode::conservative)->Arg(1000000);
BENCHMARK_CAPTURE(flight, exact, cull::Mode::exact)->Arg(1000000);

// A tenth of the boxes moves by a tenth of their spacing, chosen at random or neighbours in the tree, numbered at random
// or in the tree's order; then the tree is refitted and asked.
void move_and_cull(benchmark::State& state, bool scattered, bool numbered) {
    std::vector<Obb> boxes = numbered ? boxes_in_tree_order(state.range(0)) : boxes_of(state.range(0));
    tree::BoxTree tree = *tree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    std::mt19937 random(1);
    std::vector<tree::ItemId> items;
    for (std::size_t i = 0; i < boxes.size() / 10; ++i)
        items.push_back(scattered ? static_cast<tree::ItemId>(random() % boxes.size()) : tree.slot_items()[i]);
    std::vector<Obb> moved(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) moved[i] = boxes[items[i]];
    cull::VisibleSet visible;
    double step = 0.1;
    for (auto _ : state) {
        for (Obb& box : moved) box.center.x += step;
        step = -step;
        if (!tree.move(items, moved)) state.SkipWithError("move failed");
        tree.refit();
        cull::cull(tree, view, visible, {cull::Mode::conservative, cull::Order::tree});
    }
    report(state, visible.size());
}
BENCHMARK_CAPTURE(move_and_cull, scattered, true, false)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours, false, false)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours_numbered, false, true)->Arg(1000000)->Unit(benchmark::kMillisecond);

// Views all around the middle of the crowd, four to a round like a cube's sides, rounds turned against each other.
std::vector<cull::View> views_around(std::int64_t boxes, std::int64_t count) {
    std::vector<cull::View> views;
    for (std::int64_t v = 0; v < count; ++v) {
        Camera camera;
        const double angle = 1.5707963 * static_cast<double>(v % 4) + 0.15 * static_cast<double>(v / 4);
        camera.position = std::cbrt(static_cast<double>(boxes)) * glm::dvec3(0.5);
        camera.forward = {std::cos(angle), 0.05, std::sin(angle)};
        camera.fov_y = 1.5708;
        camera.aspect = 1.0;
        views.push_back({*frustum_of(camera)});
    }
    return views;
}

// Many views of a list in one pass beside one query each.
void flat_views(benchmark::State& state, bool one_pass) {
    const auto& boxes = boxes_of(state.range(0));
    const std::vector<cull::View> views = views_around(state.range(0), state.range(1));
    cull::BoxSet set;
    set.assign(boxes);
    std::vector<std::uint32_t> masks(boxes.size());
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        if (one_pass)
            cull::cull(set, boxes, {}, views, masks);
        else
            for (const cull::View& view : views) cull::cull(set, boxes, view, verdicts);
        benchmark::DoNotOptimize(masks.data());
    }
}
BENCHMARK_CAPTURE(flat_views, one_pass, true)->Args({1000000, 4})->Args({1000000, 32})->Args({10000000, 4});
BENCHMARK_CAPTURE(flat_views, one_by_one, false)->Args({1000000, 4})->Args({1000000, 32})->Args({10000000, 4});

// Four cascades or cube faces: one pass beside one query each.
void many_views(benchmark::State& state, bool one_pass) {
    const tree::BoxTree& tree = tree_of(state.range(0));
    const std::vector<cull::View> views = views_around(state.range(0), 4);
    cull::ManyVisible many;
    cull::VisibleSet one;
    for (auto _ : state) {
        if (one_pass)
            cull::cull(tree, views, many);
        else
            for (const cull::View& view : views) cull::cull(tree, view, one, {cull::Mode::exact, cull::Order::tree});
    }
}
BENCHMARK_CAPTURE(many_views, one_pass, true)->Arg(100000)->Arg(1000000);
BENCHMARK_CAPTURE(many_views, one_by_one, false)->Arg(100000)->Arg(1000000);

// Axis-aligned boxes around ours, in float arrays, each against the six planes by its nearest corner: what a compiler
// makes of the plainest loop. Writes one byte per box.
void aabb_loop(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    const std::size_t n = boxes.size();
    std::vector<float> center[3], half[3];
    for (int j = 0; j < 3; ++j) center[j].resize(n), half[j].resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Aabb box = aabb_of(boxes[i]);
        for (int j = 0; j < 3; ++j) {
            center[j][i] = static_cast<float>(box.center()[j] - view.frustum.origin[j]);
            half[j][i] = static_cast<float>(box.half_extents()[j]);
        }
    }
    std::vector<unsigned char> seen(n);
    for (auto _ : state) {
        float p[6][7];
        for (unsigned k = 0; k < 6; ++k) {
            const Plane& plane = view.frustum.planes[k];
            for (int j = 0; j < 3; ++j) {
                p[k][j] = static_cast<float>(plane.normal[j]);
                p[k][4 + j] = std::fabs(p[k][j]);
            }
            p[k][3] = static_cast<float>(plane.offset);
        }
        const float *cx = center[0].data(), *cy = center[1].data(), *cz = center[2].data();
        const float *hx = half[0].data(), *hy = half[1].data(), *hz = half[2].data();
        unsigned char* out = seen.data();
        for (std::size_t i = 0; i < n; ++i) {
            float least = 1e30f;
            for (unsigned k = 0; k < 6; ++k) {
                const float top = p[k][0] * cx[i] + p[k][1] * cy[i] + p[k][2] * cz[i] + p[k][3] + p[k][4] * hx[i] +
                                  p[k][5] * hy[i] + p[k][6] * hz[i];
                least = top < least ? top : least;
            }
            out[i] = least >= 0.0f;
        }
        benchmark::DoNotOptimize(seen.data());
        benchmark::ClobberMemory();
    }
    std::size_t visible = 0;
    for (const unsigned char s : seen) visible += s;
    report(state, visible);
}
BENCHMARK(aabb_loop)->Arg(10000)->Arg(1000000);

#if defined(CROFTON_HAVE_BULLET)
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
#endif

}  // namespace
