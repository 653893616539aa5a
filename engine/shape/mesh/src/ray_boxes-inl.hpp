// SPDX-License-Identifier: MIT
// One ray through a hierarchy of boxes. Included once per instruction set.
#if defined(CROFTON_MESH_RAY_BOXES) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_MESH_RAY_BOXES
#undef CROFTON_MESH_RAY_BOXES
#else
#define CROFTON_MESH_RAY_BOXES
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "ray_leaf-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Of a valid ray. Without a branch: what rays are like cannot be predicted.
HWY_INLINE RayQuery query_of(const double* ray, const RayMesh& mesh, bool any) {
    RayQuery q;
    q.mesh = mesh;
    q.ray = ray;
    q.any = any;
    const double size[3] = {std::fabs(ray[3]), std::fabs(ray[4]), std::fabs(ray[5])},
                 far[3] = {std::fabs(ray[0]), std::fabs(ray[1]), std::fabs(ray[2])};
    // The largest power of two that is not above the largest component, but at most 2^1000, so that its reciprocal is a
    // normal number. A valid ray's direction has a square that is not 0: the component is above 2^-540.
    constexpr std::uint64_t kExponent = 0x7ff0000000000000u, kOne = std::bit_cast<std::uint64_t>(1.0);
    const std::uint64_t largest = std::bit_cast<std::uint64_t>(std::max(std::max(size[0], size[1]), size[2]));
    const std::uint64_t power = std::min(largest & kExponent, std::bit_cast<std::uint64_t>(0x1p1000));
    q.scale = std::bit_cast<double>(power);
    // Of oriented boxes: the rounding of origin, direction, axes and projections, each at most 2^-24 relative, at any
    // point the mesh can reach. The derivations of the others are with AlignedBoxes and candidates().
    const double relative_error = mesh.nodes == nullptr ? 4e-6 : kRayError;
    q.error_bound = static_cast<float>(relative_error * (mesh.extent + std::max(std::max(far[0], far[1]), far[2])));
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> df;
    // The reciprocal of a power of two: the exponents are those of 1, twice, less its own.
    const auto per_scale = hn::Set(d, std::bit_cast<double>(2u * kOne - power));
    for (std::size_t l = 0; l < 4; l += hn::Lanes(d)) {  // the fourth is the next of the seven numbers
        const auto start = hn::DemoteTo(df, hn::LoadU(d, ray + l));
        const auto exact = hn::DemoteTo(df, hn::Mul(hn::LoadU(d, ray + 3 + l), per_scale));
        // A component of 0 would make 0 · infinity; this one bends the ray by less than its rounding.
        const auto along = hn::CopySign(hn::Max(hn::Abs(exact), hn::Set(df, 1e-18f)), exact);
        const auto inverse = hn::Div(hn::Set(df, 1.0f), along);
        const auto outwards = hn::CopySign(hn::Set(df, q.error_bound), along);
        hn::Store(start, df, q.start + l);
        hn::Store(along, df, q.direction + l);
        hn::Store(inverse, df, q.inverse + l);
        hn::Store(hn::Mul(hn::Add(start, outwards), inverse), df, q.near_start + l);
        hn::Store(hn::Mul(hn::Sub(start, outwards), inverse), df, q.far_start + l);
    }
    const float x = std::fabs(q.direction[0]), y = std::fabs(q.direction[1]), z = std::fabs(q.direction[2]);
    const auto y_above_x = static_cast<std::uint32_t>(y > x),
               z_above_both = static_cast<std::uint32_t>((z > x) & (z > y));
    const std::uint32_t last = z_above_both * 2u + (1u - z_above_both) * y_above_x;
    constexpr std::uint32_t kAfter[] = {0, 1, 2, 0, 1};
    q.axis[2] = last;
    for (std::uint32_t k = 0; k < 2; ++k) {
        q.axis[k] = kAfter[last + 1 + k];
        q.shear[k] = q.direction[q.axis[k]] * q.inverse[last];
    }
    return q;
}

// The hierarchy of aligned boxes, grown by `error_bound`. Of each axis: where the ray meets the nearer face and the
// farther one, seen from its start. The parameter is a fused or plain product less one made beforehand. Let u be
// 2^-24 of the start's and the mesh's largest coordinates together. The roundings of the start, the reciprocals and the
// products move a face by less than 8 u. `error_bound` is 12.5 u.
class AlignedBoxes {
  public:
    using Node = BoxNode;
    static constexpr std::uint32_t kWidth = kBoxNodeWidth;

    HWY_INLINE explicit AlignedBoxes(const RayQuery& q) : nodes_(q.mesh.nodes) {
        const D d;
        for (int i = 0; i < 3; ++i) {
            const bool backward = q.direction[i] < 0.0f;
            near_start_[i] = hn::Set(d, q.near_start[i]);
            far_start_[i] = hn::Set(d, q.far_start[i]);
            inverse_[i] = hn::Set(d, q.inverse[i]);
            near_[i] = (static_cast<std::size_t>(i) + (backward ? 3 : 0)) * kWidth;
            far_[i] = (static_cast<std::size_t>(i) + (backward ? 0 : 3)) * kWidth;
        }
    }
    HWY_INLINE const Node& node(std::uint32_t index) const { return nodes_[index]; }

    // The lanes that are met before `limit`, and where.
    HWY_INLINE std::uint32_t entries(const Node& node, float limit, float* entry) const {
        const D d;
        const float* const bounds = node.bounds[0];
        std::uint32_t lanes = 0;
        for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
            V first = hn::Zero(d), last = hn::Set(d, limit);
            for (int i = 0; i < 3; ++i) {
                const V near = hn::Load(d, bounds + near_[i] + l), far = hn::Load(d, bounds + far_[i] + l);
                first = hn::Max(first, hn::MulSub(near, inverse_[i], near_start_[i]));
                last = hn::Min(last, hn::MulSub(far, inverse_[i], far_start_[i]));
            }
            hn::Store(first, d, entry + l);
            lanes |= simd::mask_bits(d, hn::Le(first, last)) << l;
        }
        return lanes;
    }

  private:
    using D = hn::CappedTag<float, kWidth>;
    using V = hn::Vec<D>;
    const Node* nodes_;
    V near_start_[3], far_start_[3], inverse_[3];
    std::size_t near_[3], far_[3];  // where rows of BoxNode::bounds begin
};

// Asks the memory for all that a ray needs of a child, while its siblings are looked at: rays wait for memory most.
template <class Node>
HWY_INLINE void prefetch_child(const RayQuery& q, const Node* nodes, std::uint32_t child) {
    const bool leaf = (child & mesh::kMeshLeaf) != 0;
    const char* const base = leaf ? reinterpret_cast<const char*>(q.mesh.leaves) : reinterpret_cast<const char*>(nodes);
    const char* const at = base + std::size_t{child & ~mesh::kMeshLeaf} * (leaf ? sizeof(MeshLeaf) : sizeof(Node));
    // Without a branch, which could not be predicted: the last line of a leaf is another than that of a node.
    constexpr std::size_t kLine = 64, kNode = (sizeof(Node) - 1) / kLine,
                          kLeaf = (sizeof(MeshLeaf::vertex) - 1) / kLine;
    for (std::size_t line = 0; line < std::min(kNode, kLeaf); ++line) hwy::Prefetch(at + line * kLine);
    if constexpr (kNode <= kLeaf)
        hwy::Prefetch(at + (leaf ? kLeaf : kNode) * kLine);
    else
        for (std::size_t line = kLeaf; line <= kNode; ++line) hwy::Prefetch(at + line * kLine);
}

// A child, and where the ray comes to it, or kFirst.
constexpr float kFirst = -1.0f;
struct Step {
    std::uint32_t child;
    float entry;
};

// The nearest of the children that are met; the others go to the stack, the nearest of them on top. Most nodes have one
// or two: these take no loop, whose number of rounds could not be predicted.
template <class Boxes>
HWY_INLINE Step descend(const RayQuery& q, const Boxes& boxes, const typename Boxes::Node& node, std::uint32_t lanes,
                        const float* entry, Step*& top) {
    const auto next = [&]() HWY_ATTR {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
        lanes &= lanes - 1;
        const std::uint32_t child = node.child[lane];
        prefetch_child(q, &boxes.node(0), child);
        // Where any hit will do, leaves come first: large triangles are in those near the root.
        return Step{child, q.any && (child & mesh::kMeshLeaf) != 0 ? kFirst : entry[lane]};
    };
    const Step one = next();
    if (lanes == 0) return one;
    const Step two = next();
    const bool ordered = one.entry <= two.entry;
    Step nearest = ordered ? one : two;
    Step* const base = top;
    *top++ = ordered ? two : one;
    while (lanes != 0) {
        Step step = next();
        if (step.entry < nearest.entry) std::swap(step, nearest);
        Step* place = top++;
        for (; place > base && place[-1].entry < step.entry; --place) *place = place[-1];
        *place = step;
    }
    return nearest;
}

// The nearest hit below `child`, if it comes before `answer`; else that.
template <class Boxes>
HWY_INLINE RayAnswer trace_below(const RayQuery& q, std::uint32_t child, RayAnswer answer, ExactTest meets) {
    Step stack[8 * 64];  // BoxHierarchy::kWidth · kMaxDepth; a mesh tree's own needs 15 · 7
    Step* top = stack;
    Step step{child, 0.0f};
    const Boxes boxes(q);
    float limit = limit_of(q, answer.t);
    for (;;) {
        if (!(step.child & mesh::kMeshLeaf)) {
            HWY_ALIGN float entry[Boxes::kWidth];
            const auto& node = boxes.node(step.child);
            const std::uint32_t lanes = boxes.entries(node, limit, entry);
            if (lanes != 0) {
                step = descend(q, boxes, node, lanes, entry, top);
                continue;
            }
        } else if (trace_leaf(q, step.child & ~mesh::kMeshLeaf, std::max(step.entry, 0.0f), limit, meets, answer)) {
            if (q.any) return answer;
            limit = limit_of(q, answer.t);
        }
        do {
            if (top == stack) return answer;
            --top;
        } while (top->entry > limit);
        step = *top;
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
