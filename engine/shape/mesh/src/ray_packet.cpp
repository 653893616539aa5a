// SPDX-License-Identifier: MIT
// Traces neighbouring rays together: each node is first tested for all of them at once. Compiled for each instruction
// set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray_packet.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include <algorithm>

#include "ray_boxes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Parameters are those of the first ray's scale; powers of two lie between it and the others, so nothing is rounded by
// that. Unused lanes repeat the first ray.
class PacketBoxes {
  public:
    HWY_INLINE explicit PacketBoxes(std::span<const RayQuery> queries) {
        const RayQuery& first = queries[0];
        float error_bound = 0.0f;
        for (const RayQuery& q : queries) error_bound = std::max(error_bound, q.error_bound);
        for (int i = 0; i < 3; ++i) {
            float least_start = first.start[i], most_start = least_start;
            for (const RayQuery& q : queries) {
                least_start = std::min(least_start, q.start[i]);
                most_start = std::max(most_start, q.start[i]);
            }
            const bool backward = first.direction_f[i] < 0.0f;
            const float outwards = backward ? -error_bound : error_bound;
            for (std::size_t r = 0; r < kRayPacketWidth; ++r) {
                const RayQuery& q = queries[r < queries.size() ? r : 0];
                const float inverse = q.inverse[i] * static_cast<float>(first.scale / q.scale);
                inverse_[i][r] = inverse;
                near_start_[i][r] = (q.start[i] + outwards) * inverse;
                far_start_[i][r] = (q.start[i] - outwards) * inverse;
            }
            least_[i] = *std::min_element(inverse_[i], inverse_[i] + kRayPacketWidth);
            most_[i] = *std::max_element(inverse_[i], inverse_[i] + kRayPacketWidth);
            near_[i] = static_cast<std::size_t>(i) + (backward ? 3 : 0);
            far_[i] = static_cast<std::size_t>(i) + (backward ? 0 : 3);
            near_shift_[i] = backward ? least_start - error_bound : most_start + error_bound;
            far_shift_[i] = backward ? most_start + error_bound : least_start - error_bound;
        }
    }

    // The lanes that some ray may meet before `limit`, of rays that lie together. The reciprocals of an axis have one
    // sign, so a product is least or greatest at one of their ends. In the u of AlignedBoxes, 1 is for the start, 3 for
    // the shifted face, 6 for a product with a reciprocal.
    HWY_INLINE std::uint32_t lanes(const BoxNode& node, float limit) const {
        const hn::CappedTag<float, kBoxNodeWidth> d;
        std::uint32_t found = 0;
        for (std::size_t l = 0; l < kBoxNodeWidth; l += hn::Lanes(d)) {
            auto first = hn::Zero(d), last = hn::Set(d, limit);
            for (int i = 0; i < 3; ++i) {
                const auto least = hn::Set(d, least_[i]), most = hn::Set(d, most_[i]);
                const auto near = hn::Sub(hn::Load(d, node.bounds[near_[i]] + l), hn::Set(d, near_shift_[i]));
                const auto far = hn::Sub(hn::Load(d, node.bounds[far_[i]] + l), hn::Set(d, far_shift_[i]));
                first = hn::Max(first, hn::Min(hn::Mul(near, least), hn::Mul(near, most)));
                last = hn::Min(last, hn::Max(hn::Mul(far, least), hn::Mul(far, most)));
            }
            found |= simd::mask_bits(d, hn::Le(first, last)) << l;
        }
        return found;
    }

    // The rays that meet one lane's box before their limits, as AlignedBoxes says, and where the first of them does.
    HWY_INLINE std::uint32_t rays(const BoxNode& node, std::uint32_t lane, const float* limits, float& entry) const {
        const hn::CappedTag<float, kRayPacketWidth> d;
        std::uint32_t found = 0;
        auto least = hn::Set(d, 3e38f);
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
            auto first = hn::Zero(d), last = hn::Load(d, limits + l);
            for (int i = 0; i < 3; ++i) {
                const auto inverse = hn::Load(d, inverse_[i] + l);
                const auto near = hn::Set(d, node.bounds[near_[i]][lane]), far = hn::Set(d, node.bounds[far_[i]][lane]);
                first = hn::Max(first, hn::MulSub(near, inverse, hn::Load(d, near_start_[i] + l)));
                last = hn::Min(last, hn::MulSub(far, inverse, hn::Load(d, far_start_[i] + l)));
            }
            const auto met = hn::Le(first, last);
            least = hn::IfThenElse(met, hn::Min(least, first), least);
            found |= simd::mask_bits(d, met) << l;
        }
        entry = hn::GetLane(hn::MinOfLanes(d, least));
        return found;
    }

  private:
    HWY_ALIGN float inverse_[3][kRayPacketWidth], near_start_[3][kRayPacketWidth], far_start_[3][kRayPacketWidth];
    float least_[3], most_[3], near_shift_[3], far_shift_[3];
    std::size_t near_[3], far_[3];  // rows of BoxNode::bounds
};

// A child, the rays that come to it, and where the first of them does.
struct PacketStep {
    std::uint32_t child, rays;
    float entry;
};

class Packet {
  public:
    HWY_INLINE Packet(std::span<const RayQuery> queries, PacketExactTest meets, std::span<RayAnswer> answers)
        : queries_(queries), meets_(meets), answers_(answers), boxes_(queries) {
        std::fill(limits_, limits_ + kRayPacketWidth, -1.0f);  // unused lanes meet nothing
        for (std::size_t r = 0; r < queries.size(); ++r) {
            answers[r] = {queries[r].max_t, 0, false};
            set_limit(r);
        }
    }

    HWY_INLINE void run() {
        PacketStep step{0, (1u << queries_.size()) - 1u, 0.0f};
        PacketStep stack[8 * 64];  // as one ray's
        PacketStep* top = stack;
        for (;;) {
            if (step.child & kMeshLeaf) {
                leaf(step);
            } else if (hwy::PopCount(step.rays) <= kFew) {
                one_by_one(step);
            } else if (PacketStep* const nearest = node(step, top); nearest != nullptr) {
                top = nearest;
                step = *nearest;
                continue;
            }
            do {
                if (top == stack) return;
                step = *--top;
                step.rays &= before_limits(step.entry);
            } while (step.rays == 0);
        }
    }

  private:
    // So few rays gain nothing from being together.
    static constexpr std::size_t kFew = 2;

    HWY_INLINE void set_limit(std::size_t ray) {
        limits_[ray] = limit_of(queries_[0], answers_[ray].t);
        far_ = 0.0f;
        for (const float limit : limits_) far_ = std::max(far_, limit);
    }

    HWY_INLINE std::uint32_t before_limits(float entry) const {
        const hn::CappedTag<float, kRayPacketWidth> d;
        std::uint32_t rays = 0;
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d))
            rays |= simd::mask_bits(d, hn::Le(hn::Set(d, entry), hn::Load(d, limits_ + l))) << l;
        return rays;
    }

    // Nearly every leaf that several rays come to is read; of a single ray's too few are.
    static HWY_INLINE void fetch(const MeshLeaf& leaf) {
        constexpr std::size_t kLine = 64;
        const auto* const at = reinterpret_cast<const char*>(&leaf);
        for (std::size_t byte = 0; byte < sizeof leaf.vertex; byte += kLine) hwy::Prefetch(at + byte);
    }

    // Puts the children on the stack, the farthest first. Returns the place of the nearest, or null.
    HWY_INLINE PacketStep* node(const PacketStep& step, PacketStep* const base) {
        const BoxNode& node = queries_[0].nodes[step.child];
        PacketStep* top = base;
        for (std::uint32_t lanes = boxes_.lanes(node, far_); lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            float entry;
            const std::uint32_t rays = boxes_.rays(node, lane, limits_, entry) & step.rays;
            if (rays == 0) continue;
            if (node.child[lane] & kMeshLeaf) fetch(queries_[0].leaves[node.child[lane] & ~kMeshLeaf]);
            PacketStep* place = top++;
            for (; place > base && place[-1].entry < entry; --place) *place = place[-1];
            *place = {node.child[lane], rays, entry};
        }
        return top == base ? nullptr : top - 1;
    }

    HWY_INLINE void leaf(const PacketStep& step) {
        for (std::uint32_t rays = step.rays; rays != 0; rays &= rays - 1) {
            const auto r = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rays));
            const RayQuery& q = queries_[r];
            const auto exact = [&](std::uint32_t l, std::uint32_t lane) { return meets_(r, l, lane); };
            const std::uint32_t index = step.child & ~kMeshLeaf, z = q.axis[2];
            // The entry is the least of all rays: a vertex tells where this one is beside the leaf.
            const float along = (q.leaves[index].vertex[0][z][0] - q.start[z]) * q.inverse[z];
            if (trace_leaf(q, index, along, limit_of(q, answers_[r].t), exact, answers_[r])) set_limit(r);
        }
    }

    HWY_INLINE void one_by_one(const PacketStep& step) {
        for (std::uint32_t rays = step.rays; rays != 0; rays &= rays - 1) {
            const auto r = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rays));
            const auto exact = [&](std::uint32_t l, std::uint32_t lane) { return meets_(r, l, lane); };
            answers_[r] = trace_below<AlignedBoxes>(queries_[r], step.child, answers_[r], exact);
            set_limit(r);
        }
    }

    std::span<const RayQuery> queries_;
    PacketExactTest meets_;
    std::span<RayAnswer> answers_;
    PacketBoxes boxes_;
    HWY_ALIGN float limits_[kRayPacketWidth];
    float far_ = 0.0f;  // the largest limit
};

void TracePacket(std::span<const RayQuery> queries, PacketExactTest meets, std::span<RayAnswer> answers) {
    Packet(queries, meets, answers).run();
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(TracePacket);

void trace_packet(std::span<const RayQuery> queries, PacketExactTest meets, std::span<RayAnswer> answers) {
    HWY_DYNAMIC_DISPATCH(TracePacket)(queries, meets, answers);
}

}  // namespace crofton::mesh
#endif
