// SPDX-License-Identifier: MIT
// The pairwise descent through two mesh trees, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "leaf_kernels-inl.hpp"
#include "mesh_kernels-inl.hpp"
#include "mesh_pair.hpp"
#include "triangle_box.hpp"
#include "triangle_distance-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {

// Lane `lane` of node `node`, the root having no lane, or one triangle of the leaf that is its child. Beside it lies
// what the descent asks of it at once.
struct Reference {
    std::uint32_t node, lane;
    std::uint32_t child;
    float size;  // sum of the half extents
    std::uint32_t triangle;
};
constexpr std::uint32_t kRoot = ~std::uint32_t{0}, kAllTriangles = ~std::uint32_t{0};

struct PairStep {
    Reference a, b;
    float bound;
};

HWY_INLINE Reference root_of(const MeshPair& pair, int side) {
    return {kRoot, 0, 0, half_sum(box_of(*pair.root[side])), kAllTriangles};
}
HWY_INLINE Reference lane_of(const mesh::MeshNode& node, std::uint32_t index, std::uint32_t lane) {
    return {index, lane, node.child[lane], node.half[0][lane] + node.half[1][lane] + node.half[2][lane], kAllTriangles};
}
HWY_INLINE const mesh::MeshLeaf& leaf_of(const MeshPair& pair, int side, const Reference& r) {
    return pair.leaves[side][r.child & ~mesh::kMeshLeaf];
}
HWY_INLINE QueryBox box_at(const MeshPair& pair, int side, const Reference& r) {
    if (r.triangle != kAllTriangles) return box_of(triangle_box(leaf_of(pair, side, r), r.triangle));
    return r.node == kRoot ? box_of(*pair.root[side]) : box_of(pair.nodes[side][r.node], r.lane);
}
// The box of one mesh as the other's nodes see it.
HWY_INLINE QueryBox query_box(const MeshPair& pair, const Reference& a, const Reference& b, bool into_a) {
    return into_a ? carried(pair.to_a, box_at(pair, 1, b)) : carried(pair.to_b, box_at(pair, 0, a));
}
// The pair of boxes one level down in the mesh that is descended, whose node is number `index`.
HWY_INLINE PairStep below(const PairStep& step, bool into_a, const mesh::MeshNode& node, std::uint32_t index,
                          std::uint32_t lane, float bound) {
    if (into_a) return {lane_of(node, index, lane), step.b, bound};
    return {step.a, lane_of(node, index, lane), bound};
}

HWY_INLINE std::uint32_t all_lanes(const mesh::MeshLeaf& leaf) {
    return (1u << leaf.count) - 1u;
}
HWY_INLINE std::uint32_t lanes_of(const mesh::MeshLeaf& leaf, const Reference& r) {
    return r.triangle == kAllTriangles ? all_lanes(leaf) : 1u << r.triangle;
}

// One leaf of each mesh, kept while the next pair shares it.
struct LeafPair {
    LeafLanes a, b;
};

HWY_INLINE void load_pair(const MeshPair& pair, std::uint32_t a, std::uint32_t b, LeafPair& leaves) {
    if (leaves.a.leaf != a) load_lanes(pair, pair.leaves[0][a], false, leaves.a);
    if (leaves.b.leaf != b) load_lanes(pair, pair.leaves[1][b], true, leaves.b);
    leaves.a.leaf = a;
    leaves.b.leaf = b;
}

// Hands on what the gathered pairs come to, and empties them.
HWY_INLINE bool flush(TrianglePairs& gathered, PairVisitor visit) {
    if (gathered.count == 0) return false;
    const LaneVerdict verdict = judge(gathered);
    gathered.count = 0;
    for (std::uint32_t lanes = verdict.hits | verdict.open; lanes != 0; lanes &= lanes - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (visit(gathered.of_a[lane], gathered.of_b[lane], verdict.edges(static_cast<std::uint32_t>(lane))))
            return true;
    }
    return false;
}

HWY_INLINE bool visit_leaves(const MeshPair& pair, std::uint32_t a, std::uint32_t b, LeafPair& leaves,
                             TrianglePairs& gathered, PairVisitor visit, TraversalCounts& counts) {
    load_pair(pair, a, b, leaves);
    const mesh::MeshLeaf &leaf_a = pair.leaves[0][a], &leaf_b = pair.leaves[1][b];
    counts.triangle_tests += std::uint64_t{leaf_a.count} * leaf_b.count;
    const double l1_extent = l1_extent_of(leaves.a, leaves.b);
    for (std::uint32_t mask = candidates(leaves.a, leaves.b) & all_lanes(leaf_a); mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask));
        std::uint32_t near = partners(leaves.a, lane, leaves.b, l1_extent) & all_lanes(leaf_b);
        for (; near != 0; near &= near - 1) {
            gather(leaves.a, lane, leaves.b, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near)),
                   gathered);
            if (gathered.count == mesh::kMeshLeafWidth && flush(gathered, visit)) return true;
        }
    }
    return false;
}

HWY_INLINE void prefetch_leaf(const mesh::MeshLeaf* leaf) {
    const char* const address = reinterpret_cast<const char*>(leaf);
    for (std::size_t byte = 0; byte < sizeof(mesh::MeshLeaf); byte += 64) hwy::Prefetch(address + byte);
}

// Pairs of leaves wait here, in order, until what they need has come from memory.
struct LeafQueue {
    static constexpr std::size_t kCapacity = 8;
    std::uint32_t a[kCapacity], b[kCapacity];
    std::size_t begin = 0, count = 0;
};

// Descends the larger box: the other's box is carried into its frame and tested against all its children at once.
HWY_INLINE bool descends_a(const PairStep& step) {
    if (step.a.child & mesh::kMeshLeaf) return false;
    return (step.b.child & mesh::kMeshLeaf) || step.a.size >= step.b.size;
}

void VisitOverlaps(const MeshPair& pair, bool at_once, PairVisitor visit, TraversalCounts& counts) {
    PairStep stack[kMeshStackSize];
    std::uint32_t height = 0;
    stack[height++] = {root_of(pair, 0), root_of(pair, 1), 0.0f};
    const float margin = pair.error_bound + pair.tolerance;
    LeafPair leaves;
    TrianglePairs gathered;
    LeafQueue queue;
    const auto visit_first = [&]() HWY_ATTR {
        const std::size_t place = queue.begin;
        queue.begin = (place + 1) % LeafQueue::kCapacity;
        --queue.count;
        return visit_leaves(pair, queue.a[place], queue.b[place], leaves, gathered, visit, counts);
    };
    while (height > 0) {
        const PairStep step = stack[--height];
        const std::uint32_t a = step.a.child, b = step.b.child;
        if (a & b & mesh::kMeshLeaf) {
            if (queue.count == LeafQueue::kCapacity && visit_first()) return;
            const std::size_t place = (queue.begin + queue.count++) % LeafQueue::kCapacity;
            queue.a[place] = a & ~mesh::kMeshLeaf;
            queue.b[place] = b & ~mesh::kMeshLeaf;
            if (at_once && (visit_first() || flush(gathered, visit))) return;
            continue;
        }
        const bool into_a = descends_a(step);
        const std::uint32_t index = into_a ? a : b;
        const mesh::MeshNode& node = pair.nodes[into_a ? 0 : 1][index];
        const QueryBox box = query_box(pair, step.a, step.b, into_a);
        counts.box_tests += node.count;
        for (std::uint32_t mask = overlap_mask(node, box, margin); mask != 0; mask &= mask - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask));
            stack[height++] = below(step, into_a, node, index, lane, 0.0f);
            if (node.child[lane] & mesh::kMeshLeaf)
                prefetch_leaf(pair.leaves[into_a ? 0 : 1] + (node.child[lane] & ~mesh::kMeshLeaf));
        }
    }
    while (queue.count > 0)
        if (visit_first()) return;
    flush(gathered, visit);
}

HWY_INLINE bool flush_nearest(TrianglePairs& gathered, const Nearest& nearest, PairVisitor visit) {
    const LaneVerdict verdict = judge(gathered);
    std::uint32_t lanes = verdict.hits | verdict.open | closer_lanes(gathered, nearest.squared);
    gathered.count = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (visit(gathered.of_a[lane], gathered.of_b[lane], verdict.edges(static_cast<std::uint32_t>(lane))))
            return true;
    }
    return false;
}

bool visit_near_leaves(const MeshPair& pair, const PairStep& step, LeafPair& leaves, TrianglePairs& gathered,
                       const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    load_pair(pair, step.a.child & ~mesh::kMeshLeaf, step.b.child & ~mesh::kMeshLeaf, leaves);
    const std::uint32_t of_a = lanes_of(leaf_of(pair, 0, step.a), step.a),
                        of_b = lanes_of(leaf_of(pair, 1, step.b), step.b);
    counts.triangle_tests += std::uint64_t{hwy::PopCount(of_a)} * hwy::PopCount(of_b);
    alignas(64) double end_of_a[mesh::kMeshLeafWidth], begin_of_b[mesh::kMeshLeafWidth];
    extents_along(leaves.a, leaves.b, nearest.direction, end_of_a, begin_of_b);
    const double error_bound = 0x1p-48 * magnitude_of(leaves.a, leaves.b);
    for (std::uint32_t mask = of_a; mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask));
        std::uint32_t near = lanes_before(begin_of_b, end_of_a[lane], error_bound, nearest.squared) & of_b;
        if (near == 0) continue;
        near &= near_mask(leaves.a, lane, leaves.b, nearest.squared);
        for (; near != 0; near &= near - 1) {
            gather(leaves.a, lane, leaves.b, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near)),
                   gathered);
            if (gathered.count == mesh::kMeshLeafWidth && flush_nearest(gathered, nearest, visit)) return true;
        }
    }
    return gathered.count > 0 && flush_nearest(gathered, nearest, visit);
}

// A leaf's box that is larger than what it is compared with says little of where its triangles are.
HWY_INLINE bool is_coarse(const Reference& leaf, const Reference& node) {
    return (leaf.child & mesh::kMeshLeaf) && leaf.triangle == kAllTriangles && leaf.size > node.size;
}

HWY_INLINE std::uint32_t push_triangles(const MeshPair& pair, const PairStep& step, int side, PairStep* stack,
                                        std::uint32_t height) {
    const Reference& whole = side == 0 ? step.a : step.b;
    for (std::uint32_t lane = 0; lane < leaf_of(pair, side, whole).count; ++lane) {
        PairStep& one = stack[height++] = step;
        (side == 0 ? one.a : one.b).triangle = lane;
    }
    return height;
}

// In the frame of the mesh that is descended: the direction between the nearest points so far. Where one triangle is
// compared: from it to the middle of what is descended.
HWY_INLINE void choose_directions(const MeshPair& pair, const PairStep& step, bool into_a, const QueryBox& box,
                                  const Nearest& nearest, Direction& global, Direction& own) {
    for (int i = 0; i < 3; ++i) global.way[i] = nearest.direction[i];
    global.way[3] = 0.0f;
    if (!into_a) turn(pair.to_b, nearest.direction, global.way);
    const int side = into_a ? 1 : 0;
    const Reference &moved = into_a ? step.b : step.a, &still = into_a ? step.a : step.b;
    if (moved.triangle == kAllTriangles) {
        direction_between(box.center, box_at(pair, 1 - side, still).center, own.way);
        measure(box, global);
        measure(box, own);
        return;
    }
    const mesh::MeshLeaf& leaf = leaf_of(pair, side, moved);
    alignas(16) float corner[3][4];
    for (int v = 0; v < 3; ++v) {
        const float from[3] = {leaf.vertex[v][0][moved.triangle], leaf.vertex[v][1][moved.triangle],
                               leaf.vertex[v][2][moved.triangle]};
        carry_point(into_a ? pair.to_a : pair.to_b, from, corner[v]);
    }
    direction_from_triangle(corner, box_at(pair, 1 - side, still).center, own.way);
    measure(box, corner, global);
    measure(box, corner, own);
}

void VisitNearest(const MeshPair& pair, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    PairStep stack[kMeshStackSize];
    std::uint32_t height = 0;
    LeafPair leaves;
    TrianglePairs gathered;
    stack[height++] = {root_of(pair, 0), root_of(pair, 1), 0.0f};
    while (height > 0) {
        const PairStep step = stack[--height];
        if (static_cast<double>(step.bound) > nearest.squared) continue;
        const std::uint32_t a = step.a.child, b = step.b.child;
        if (a & b & mesh::kMeshLeaf) {
            if (visit_near_leaves(pair, step, leaves, gathered, nearest, visit, counts)) return;
            continue;
        }
        const bool into_a = descends_a(step);
        if (is_coarse(into_a ? step.b : step.a, into_a ? step.a : step.b)) {
            height = push_triangles(pair, step, into_a ? 1 : 0, stack, height);
            continue;
        }
        const std::uint32_t index = into_a ? a : b;
        const mesh::MeshNode& node = pair.nodes[into_a ? 0 : 1][index];
        const QueryBox box = query_box(pair, step.a, step.b, into_a);
        counts.box_tests += node.count;
        HWY_ALIGN float bounds[mesh::kMeshNodeWidth];
        Direction global, own;
        choose_directions(pair, step, into_a, box, nearest, global, own);
        distance_bounds(node, box, pair.error_bound, global, own, bounds);
        // The nearest child goes on top; insertion keeps equal ones in lane order.
        const std::uint32_t base = height;
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            if (static_cast<double>(bounds[lane]) > nearest.squared) continue;
            std::uint32_t place = height++;
            for (; place > base && stack[place - 1].bound < bounds[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = below(step, into_a, node, index, lane, bounds[lane]);
        }
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(VisitOverlaps);
HWY_EXPORT(VisitNearest);

void visit_overlaps(const MeshPair& pair, bool at_once, PairVisitor visit, TraversalCounts& counts) {
    HWY_DYNAMIC_DISPATCH(VisitOverlaps)(pair, at_once, visit, counts);
}
void visit_nearest(const MeshPair& pair, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    HWY_DYNAMIC_DISPATCH(VisitNearest)(pair, nearest, visit, counts);
}

}  // namespace crofton::mesh
#endif
