// The pairwise descent through two mesh trees, compiled for each instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mesh_traversal.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "leaf_kernels-inl.hpp"
#include "mesh_kernels-inl.hpp"
#include "mesh_pair.hpp"
#include "triangle_distance-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {

// Lane `lane` of node `node`, the root having no lane; with what the descent asks of it at once.
struct Reference {
    std::uint32_t node, lane;
    std::uint32_t child;
    float size;  // sum of the half extents
};
constexpr std::uint32_t kRoot = ~std::uint32_t{0};

struct Step {
    Reference a, b;
    float bound;
};

HWY_INLINE Reference root_of(const MeshPair& pair, int side) {
    return {kRoot, 0, 0, half_sum(box_of(*pair.root[side]))};
}
HWY_INLINE Reference lane_of(const tree::MeshNode& node, std::uint32_t index, std::uint32_t lane) {
    return {index, lane, node.child[lane], node.half[0][lane] + node.half[1][lane] + node.half[2][lane]};
}
HWY_INLINE QueryBox box_at(const MeshPair& pair, int side, Reference r) {
    return r.node == kRoot ? box_of(*pair.root[side]) : box_of(pair.nodes[side][r.node], r.lane);
}
// The box of one mesh as the other's nodes see it.
HWY_INLINE QueryBox query_box(const MeshPair& pair, const Reference& a, const Reference& b, bool into_a) {
    return into_a ? carried(pair.to_a, box_at(pair, 1, b)) : carried(pair.to_b, box_at(pair, 0, a));
}
// The pair of boxes one level down in the mesh that is descended, whose node is number `index`.
HWY_INLINE Step below(const Step& step, bool into_a, const tree::MeshNode& node, std::uint32_t index,
                      std::uint32_t lane, float bound) {
    if (into_a) return {lane_of(node, index, lane), step.b, bound};
    return {step.a, lane_of(node, index, lane), bound};
}

HWY_INLINE std::uint32_t all_lanes(const tree::MeshLeaf& leaf) {
    return (1u << leaf.count) - 1u;
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
HWY_INLINE bool settle(TrianglePairs& gathered, PairVisitor visit) {
    if (gathered.count == 0) return false;
    const LaneVerdict verdict = judge(gathered);
    gathered.count = 0;
    for (std::uint32_t lanes = verdict.hits | verdict.open; lanes != 0; lanes &= lanes - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (visit(gathered.of_a[lane], gathered.of_b[lane], verdict.hits >> lane & 1u)) return true;
    }
    return false;
}

HWY_INLINE bool visit_leaves(const MeshPair& pair, std::uint32_t a, std::uint32_t b, LeafPair& leaves,
                             TrianglePairs& gathered, PairVisitor visit, TraversalCounts& counts) {
    load_pair(pair, a, b, leaves);
    const tree::MeshLeaf &leaf_a = pair.leaves[0][a], &leaf_b = pair.leaves[1][b];
    counts.triangle_tests += std::uint64_t{leaf_a.count} * leaf_b.count;
    const double reach = reach_of(leaves.a, leaves.b);
    for (std::uint32_t mask = candidates(leaves.a, leaves.b) & all_lanes(leaf_a); mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask));
        std::uint32_t near = partners(leaves.a, lane, leaves.b, reach) & all_lanes(leaf_b);
        for (; near != 0; near &= near - 1) {
            gather(leaves.a, lane, leaves.b, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near)),
                   gathered);
            if (gathered.count == tree::kMeshLeafWidth && settle(gathered, visit)) return true;
        }
    }
    return false;
}

HWY_INLINE void prefetch_leaf(const tree::MeshLeaf* leaf) {
    const char* const address = reinterpret_cast<const char*>(leaf);
    for (std::size_t byte = 0; byte < sizeof(tree::MeshLeaf); byte += 64) hwy::Prefetch(address + byte);
}

// Pairs of leaves wait here, in order, until what they need has come from memory.
struct LeafQueue {
    static constexpr std::size_t kCapacity = 8;
    std::uint32_t a[kCapacity], b[kCapacity];
    std::size_t begin = 0, count = 0;
};

// Descends the larger box: the other's box is carried into its frame and tested against all its children at once.
HWY_INLINE bool descends_a(const Step& step) {
    if (step.a.child & tree::kMeshLeaf) return false;
    return (step.b.child & tree::kMeshLeaf) || step.a.size >= step.b.size;
}

void VisitOverlaps(const MeshPair& pair, bool at_once, PairVisitor visit, TraversalCounts& counts) {
    Step stack[kMeshStackSize];
    std::uint32_t height = 0;
    stack[height++] = {root_of(pair, 0), root_of(pair, 1), 0.0f};
    const float slop = pair.slop + pair.tolerance;
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
        const Step step = stack[--height];
        const std::uint32_t a = step.a.child, b = step.b.child;
        if (a & b & tree::kMeshLeaf) {
            if (queue.count == LeafQueue::kCapacity && visit_first()) return;
            const std::size_t place = (queue.begin + queue.count++) % LeafQueue::kCapacity;
            queue.a[place] = a & ~tree::kMeshLeaf;
            queue.b[place] = b & ~tree::kMeshLeaf;
            if (at_once && (visit_first() || settle(gathered, visit))) return;
            continue;
        }
        const bool into_a = descends_a(step);
        const std::uint32_t index = into_a ? a : b;
        const tree::MeshNode& node = pair.nodes[into_a ? 0 : 1][index];
        const QueryBox box = query_box(pair, step.a, step.b, into_a);
        counts.box_tests += node.count;
        for (std::uint32_t mask = overlap_mask(node, box, slop); mask != 0; mask &= mask - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask));
            stack[height++] = below(step, into_a, node, index, lane, 0.0f);
            if (node.child[lane] & tree::kMeshLeaf)
                prefetch_leaf(pair.leaves[into_a ? 0 : 1] + (node.child[lane] & ~tree::kMeshLeaf));
        }
    }
    while (queue.count > 0)
        if (visit_first()) return;
    settle(gathered, visit);
}

HWY_INLINE bool settle_near(TrianglePairs& gathered, const Nearest& nearest, PairVisitor visit) {
    const LaneVerdict verdict = judge(gathered);
    std::uint32_t lanes = verdict.hits | verdict.open | closer_lanes(gathered, nearest.squared);
    gathered.count = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (visit(gathered.of_a[lane], gathered.of_b[lane], verdict.hits >> lane & 1u)) return true;
    }
    return false;
}

bool visit_near_leaves(const MeshPair& pair, std::uint32_t a, std::uint32_t b, LeafPair& leaves,
                       TrianglePairs& gathered, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    load_pair(pair, a, b, leaves);
    const tree::MeshLeaf &leaf_a = pair.leaves[0][a], &leaf_b = pair.leaves[1][b];
    counts.triangle_tests += std::uint64_t{leaf_a.count} * leaf_b.count;
    alignas(64) double end_of_a[tree::kMeshLeafWidth], begin_of_b[tree::kMeshLeafWidth];
    extents_along(leaves.a, leaves.b, nearest.direction, end_of_a, begin_of_b);
    const double doubt = 0x1p-48 * magnitude_of(leaves.a, leaves.b);
    for (std::uint32_t lane = 0; lane < leaf_a.count; ++lane) {
        std::uint32_t near = lanes_before(begin_of_b, end_of_a[lane], doubt, nearest.squared) & all_lanes(leaf_b);
        if (near == 0) continue;
        near &= near_mask(leaves.a, lane, leaves.b, nearest.squared);
        for (; near != 0; near &= near - 1) {
            gather(leaves.a, lane, leaves.b, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near)),
                   gathered);
            if (gathered.count == tree::kMeshLeafWidth && settle_near(gathered, nearest, visit)) return true;
        }
    }
    return gathered.count > 0 && settle_near(gathered, nearest, visit);
}

void VisitNearest(const MeshPair& pair, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    Step stack[kMeshStackSize];
    std::uint32_t height = 0;
    LeafPair leaves;
    TrianglePairs gathered;
    stack[height++] = {root_of(pair, 0), root_of(pair, 1), 0.0f};
    while (height > 0) {
        const Step step = stack[--height];
        if (static_cast<double>(step.bound) > nearest.squared) continue;
        const std::uint32_t a = step.a.child, b = step.b.child;
        if (a & b & tree::kMeshLeaf) {
            if (visit_near_leaves(pair, a & ~tree::kMeshLeaf, b & ~tree::kMeshLeaf, leaves, gathered, nearest, visit,
                                  counts))
                return;
            continue;
        }
        const bool into_a = descends_a(step);
        const std::uint32_t index = into_a ? a : b;
        const tree::MeshNode& node = pair.nodes[into_a ? 0 : 1][index];
        const QueryBox box = query_box(pair, step.a, step.b, into_a);
        counts.box_tests += node.count;
        HWY_ALIGN float bounds[tree::kMeshNodeWidth];
        alignas(16) float direction[4] = {nearest.direction[0], nearest.direction[1], nearest.direction[2]};
        if (!into_a) turn(pair.to_b, nearest.direction, direction);
        distance_bounds(node, box, pair.slop, direction, bounds);
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

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(VisitOverlaps);
HWY_EXPORT(VisitNearest);

void visit_overlaps(const MeshPair& pair, bool at_once, PairVisitor visit, TraversalCounts& counts) {
    HWY_DYNAMIC_DISPATCH(VisitOverlaps)(pair, at_once, visit, counts);
}
void visit_nearest(const MeshPair& pair, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts) {
    HWY_DYNAMIC_DISPATCH(VisitNearest)(pair, nearest, visit, counts);
}

}  // namespace crofton::collide
#endif
