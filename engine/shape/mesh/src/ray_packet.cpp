// SPDX-License-Identifier: MIT
// Traces neighbouring rays together: each node is first tested for all of them at once. Compiled for each instruction
// set and chosen at run time.
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "ray_boxes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A packet's rays in float, as RayQuery has one; all with the least of their scales: no component is above 4 in size,
// and the largest one of each ray is at least 1.
struct PacketRays {
    HWY_ALIGN float start[3][kRayPacketWidth], direction[3][kRayPacketWidth], inverse[3][kRayPacketWidth];
    double scale = 1.0;
    float error_bound = 0.0f;
    std::uint32_t axis[3] = {};  // the last is that of the first ray's largest component
    bool share_axis = false;     // and of every ray's
    bool backward[3] = {};       // the sign of all directions
    bool ends = false;           // some end before 1e300

    // False where the rays do not lie together.
    HWY_INLINE bool set(const RayPacket& rays, double extent) {
        const DD d;
        const hn::RebindToUnsigned<DD> du;
        const hn::Rebind<float, DD> df;
        double first[3], length = 0.0;
        for (int i = 0; i < 3; ++i) {
            first[i] = rays.direction[i][0];
            backward[i] = std::signbit(first[i]);
            if (std::fabs(first[i]) > length) {
                length = std::fabs(first[i]);
                axis[2] = static_cast<std::uint32_t>(i);
            }
        }
        if (!(length > 1e-100 && length < 1e100)) return false;
        const std::uint32_t z = axis[2];
        axis[0] = (z + 1) % 3;
        axis[1] = (z + 2) % 3;
        MD together = hn::Eq(hn::Zero(d), hn::Zero(d)), share = together, end = hn::Not(together);
        auto far = hn::Zero(d), least = hn::Set(d, 1e300);  // the largest component of each ray
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
            const auto max_t = hn::Load(d, rays.max_t + l), along = hn::Abs(hn::Load(d, rays.direction[z] + l));
            together = hn::And(together, hn::Ge(max_t, hn::Zero(d)));
            end = hn::Or(end, hn::Lt(max_t, hn::Set(d, 1e300)));
            auto largest = hn::Zero(d);
            for (int i = 0; i < 3; ++i) {
                const auto way = hn::Load(d, rays.direction[i] + l), origin = hn::Load(d, rays.origin[i] + l);
                const auto size = hn::Abs(way);
                // Of a direction of the other sign, or −0, the bits differ in the highest one.
                const auto turned = hn::Xor(hn::BitCast(du, way), hn::BitCast(du, hn::Set(d, first[i])));
                together = hn::And(together, hn::RebindMask(d, hn::Eq(hn::ShiftRight<63>(turned), hn::Zero(du))));
                const auto parted = hn::Abs(hn::Sub(way, hn::Set(d, first[i])));
                together = hn::And(together, hn::Le(parted, hn::Set(d, 0.1 * length)));
                const auto moved = hn::Abs(hn::Sub(origin, hn::Set(d, rays.origin[i][0])));
                together = hn::And(together, hn::Le(moved, hn::Set(d, 0.0625 * extent)));
                share = hn::And(share, hn::Ge(along, size));
                largest = hn::Max(largest, size);
                far = hn::Max(far, hn::Abs(origin));
            }
            least = hn::Min(least, largest);
        }
        if (!hn::AllTrue(d, together)) return false;
        share_axis = hn::AllTrue(d, share);
        ends = !hn::AllFalse(d, end);
        // The largest power of two that is not above the least of the largest components.
        constexpr std::uint64_t kExponent = 0x7ff0000000000000u;
        const auto bits = std::bit_cast<std::uint64_t>(hn::GetLane(hn::MinOfLanes(d, least))) & kExponent;
        scale = std::bit_cast<double>(bits);
        const double per_scale = std::bit_cast<double>(2u * std::bit_cast<std::uint64_t>(1.0) - bits);
        error_bound = static_cast<float>(kRayError * (extent + hn::GetLane(hn::MaxOfLanes(d, far))));
        for (int i = 0; i < 3; ++i)
            for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
                hn::Store(hn::DemoteTo(df, hn::Load(d, rays.origin[i] + l)), df, start[i] + l);
                const auto exact = hn::DemoteTo(df, hn::Mul(hn::Load(d, rays.direction[i] + l), hn::Set(d, per_scale)));
                const auto bent = hn::CopySign(hn::Max(hn::Abs(exact), hn::Set(df, 1e-18f)), exact);
                hn::Store(bent, df, direction[i] + l);
                hn::Store(hn::Div(hn::Set(df, 1.0f), bent), df, inverse[i] + l);
            }
        return true;
    }

    // In the parameters of this scale, as limit_of() of a query.
    HWY_INLINE float limit(double t) const {
        const double reached = t * scale;
        return reached < 1e37 ? static_cast<float>(reached) * (1.0f + 0x1p-20f) : 1e37f;
    }
};

class PacketBoxes {
  public:
    HWY_INLINE explicit PacketBoxes(const PacketRays& rays) : rays_(rays) {
        const hn::CappedTag<float, kRayPacketWidth> d;
        for (int i = 0; i < 3; ++i) {
            const bool backward = rays.backward[i];
            const auto outwards = hn::Set(d, backward ? -rays.error_bound : rays.error_bound);
            auto least_inverse = hn::Load(d, rays.inverse[i]), most_inverse = least_inverse;
            auto least_start = hn::Load(d, rays.start[i]), most_start = least_start;
            for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
                const auto inverse = hn::Load(d, rays.inverse[i] + l), start = hn::Load(d, rays.start[i] + l);
                hn::Store(hn::Mul(hn::Add(start, outwards), inverse), d, near_start_[i] + l);
                hn::Store(hn::Mul(hn::Sub(start, outwards), inverse), d, far_start_[i] + l);
                least_inverse = hn::Min(least_inverse, inverse);
                most_inverse = hn::Max(most_inverse, inverse);
                least_start = hn::Min(least_start, start);
                most_start = hn::Max(most_start, start);
            }
            least_[i] = hn::GetLane(hn::MinOfLanes(d, least_inverse));
            most_[i] = hn::GetLane(hn::MaxOfLanes(d, most_inverse));
            const float low = hn::GetLane(hn::MinOfLanes(d, least_start)) - rays.error_bound,
                        high = hn::GetLane(hn::MaxOfLanes(d, most_start)) + rays.error_bound;
            near_[i] = static_cast<std::size_t>(i) + (backward ? 3 : 0);
            far_[i] = static_cast<std::size_t>(i) + (backward ? 0 : 3);
            near_shift_[i] = backward ? low : high;
            far_shift_[i] = backward ? high : low;
        }
    }

    // The lanes that some ray may meet before `limit`, of rays that lie together. The reciprocals of an axis have one
    // sign, so a product is least or greatest at one of their ends. In the u of AlignedBoxes, 1 is for the start, 3 for
    // the shifted face, 6 for a product with a reciprocal.
    HWY_INLINE std::uint32_t lanes(const BoxNode& node, float limit) const {
        return lanes_of(
            [&](std::size_t row, std::size_t l) HWY_ATTR { return hn::Load(NodeTag(), node.bounds[row] + l); }, limit);
    }

    // The same of the boxes of a leaf's triangles.
    HWY_INLINE std::uint32_t lanes(const MeshLeaf& leaf, float limit) const {
        return lanes_of(
            [&](std::size_t row, std::size_t l) HWY_ATTR {
                const std::size_t i = row % 3;
                const auto a = hn::Load(NodeTag(), leaf.vertex[0][i] + l),
                           b = hn::Load(NodeTag(), leaf.vertex[1][i] + l),
                           c = hn::Load(NodeTag(), leaf.vertex[2][i] + l);
                return row < 3 ? hn::Min(a, hn::Min(b, c)) : hn::Max(a, hn::Max(b, c));
            },
            limit);
    }

    // The rays that meet one lane's box before their limits, as AlignedBoxes says, and where the first of them does.
    HWY_INLINE std::uint32_t rays(const BoxNode& node, std::uint32_t lane, const float* limits, float& entry) const {
        const hn::CappedTag<float, kRayPacketWidth> d;
        std::uint32_t found = 0;
        auto least = hn::Set(d, 3e38f);
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
            auto first = hn::Zero(d), last = hn::Load(d, limits + l);
            for (int i = 0; i < 3; ++i) {
                const auto inverse = hn::Load(d, rays_.inverse[i] + l);
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
    static_assert(kBoxNodeWidth == kMeshLeafWidth);
    using NodeTag = hn::CappedTag<float, kBoxNodeWidth>;

    // faces(row, l): lanes from l on of a row as BoxNode's.
    template <class Faces>
    HWY_INLINE std::uint32_t lanes_of(const Faces& faces, float limit) const {
        const NodeTag d;
        std::uint32_t found = 0;
        for (std::size_t l = 0; l < kBoxNodeWidth; l += hn::Lanes(d)) {
            auto first = hn::Zero(d), last = hn::Set(d, limit);
            for (int i = 0; i < 3; ++i) {
                const auto least = hn::Set(d, least_[i]), most = hn::Set(d, most_[i]);
                const auto near = hn::Sub(faces(near_[i], l), hn::Set(d, near_shift_[i]));
                const auto far = hn::Sub(faces(far_[i], l), hn::Set(d, far_shift_[i]));
                first = hn::Max(first, hn::Min(hn::Mul(near, least), hn::Mul(near, most)));
                last = hn::Min(last, hn::Max(hn::Mul(far, least), hn::Mul(far, most)));
            }
            found |= simd::mask_bits(d, hn::Le(first, last)) << l;
        }
        return found;
    }

    const PacketRays& rays_;
    HWY_ALIGN float near_start_[3][kRayPacketWidth], far_start_[3][kRayPacketWidth];
    float least_[3], most_[3], near_shift_[3], far_shift_[3];
    std::size_t near_[3], far_[3];  // rows of BoxNode::bounds
};

// A packet's rays, which share the axes of the plane coordinates, and one triangle that many of them come to.
class PacketTriangles {
  public:
    HWY_INLINE PacketTriangles(const RayPacket& exact, const PacketRays& rays) : exact_(exact), rays_(rays) {}

    // Of `rays` those that may meet the triangle before their limits.
    HWY_INLINE std::uint32_t candidates(const MeshLeaf& leaf, std::uint32_t lane, const float* limits,
                                        std::uint32_t rays) const {
        const hn::CappedTag<float, kRayPacketWidth> d;
        const std::uint32_t x = rays_.axis[0], y = rays_.axis[1], z = rays_.axis[2];
        std::uint32_t apart = 0;
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
            if ((rays >> l & ((1u << hn::Lanes(d)) - 1u)) == 0) continue;
            FloatLanes<hn::Vec<decltype(d)>> lanes;
            lanes.inverse = hn::Load(d, rays_.inverse[z] + l);
            const auto along =
                hn::Mul(hn::Sub(hn::Set(d, leaf.vertex[0][z][lane]), hn::Load(d, rays_.start[z] + l)), lanes.inverse);
            const auto beside = [&](std::uint32_t i) HWY_ATTR {
                return hn::MulAdd(along, hn::Load(d, rays_.direction[i] + l), hn::Load(d, rays_.start[i] + l));
            };
            const auto bx = beside(x), by = beside(y), bz = beside(z);
            for (int v = 0; v < 3; ++v) {
                lanes.x[v] = hn::Sub(hn::Set(d, leaf.vertex[v][x][lane]), bx);
                lanes.y[v] = hn::Sub(hn::Set(d, leaf.vertex[v][y][lane]), by);
                lanes.z[v] = hn::Sub(hn::Set(d, leaf.vertex[v][z][lane]), bz);
            }
            for (int k = 0; k < 2; ++k)
                lanes.shear[k] = hn::Mul(hn::Load(d, rays_.direction[rays_.axis[k]] + l), lanes.inverse);
            lanes.reach = hn::Add(hn::Sub(hn::Load(d, limits + l), along), hn::Set(d, rays_.error_bound));
            apart |= simd::mask_bits(d, certainly_apart(d, lanes, rays_.error_bound)) << l;
        }
        return rays & ~apart;
    }

    // The same in double, as triangle_hits() of one ray: `t` has the parameters of those that are asked about.
    HWY_INLINE HitBits hits(const MeshLeaf& leaf, std::uint32_t lane, std::uint32_t rays, double* t) const {
        const DD d;
        HitBits hits;
        for (std::size_t l = 0; l < kRayPacketWidth; l += hn::Lanes(d)) {
            if ((rays >> l & ((1u << hn::Lanes(d)) - 1u)) == 0) continue;
            RayLanes lanes;
            for (int i = 0; i < 3; ++i) {
                lanes.direction[i] = hn::Load(d, exact_.direction[i] + l);
                const auto origin = hn::Load(d, exact_.origin[i] + l);
                for (int v = 0; v < 3; ++v)
                    lanes.p[v][i] = hn::Sub(hn::Set(d, static_cast<double>(leaf.vertex[v][i][lane])), origin);
            }
            lanes.max_t = hn::Load(d, exact_.max_t + l);
            lanes.ends = rays_.ends;
            const HitBits found = hits_of(d, lanes, l, t + l);
            hits.met |= found.met;
            hits.open |= found.open;
        }
        return {hits.met & rays, hits.open & rays};
    }

  private:
    const RayPacket& exact_;
    const PacketRays& rays_;
};

// A child, the rays that come to it, and where the first of them does.
struct PacketStep {
    std::uint32_t child, rays;
    float entry;
};

class Packet {
  public:
    HWY_INLINE Packet(const RayPacket& exact, const PacketRays& rays, const PacketMesh& mesh, RayAnswer* answers)
        : count_(exact.count), rays_(rays), mesh_(mesh), answers_(answers), boxes_(rays), triangles_(exact, rays) {
        std::fill(limits_, limits_ + kRayPacketWidth, -1.0f);  // unused lanes meet nothing
        for (std::uint32_t r = 0; r < count_; ++r) {
            answers[r] = {exact.max_t[r], 0, false};
            set_limit(r);
        }
        find_far();
    }

    HWY_INLINE void run() {
        PacketStep step{0, (1u << count_) - 1u, 0.0f};
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

    // From so many rays on a leaf's triangles are tested one by one, each against all rays.
    static constexpr std::size_t kMany = 5;

    HWY_INLINE void set_limit(std::uint32_t ray) { limits_[ray] = rays_.limit(answers_[ray].t); }

    HWY_INLINE void find_far() {
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
        const BoxNode& node = mesh_.mesh.nodes[step.child];
        PacketStep* top = base;
        for (std::uint32_t lanes = boxes_.lanes(node, far_); lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            float entry;
            const std::uint32_t rays = boxes_.rays(node, lane, limits_, entry) & step.rays;
            if (rays == 0) continue;
            if (node.child[lane] & kMeshLeaf) fetch(mesh_.mesh.leaves[node.child[lane] & ~kMeshLeaf]);
            PacketStep* place = top++;
            for (; place > base && place[-1].entry < entry; --place) *place = place[-1];
            *place = {node.child[lane], rays, entry};
        }
        return top == base ? nullptr : top - 1;
    }

    HWY_INLINE void leaf(const PacketStep& step) {
        const std::uint32_t index = step.child & ~kMeshLeaf;
        if (hwy::PopCount(step.rays) >= kMany && rays_.share_axis)
            triangle_by_triangle(index, step.rays);
        else
            ray_by_ray(index, step.rays);
        find_far();
    }

    HWY_INLINE void ray_by_ray(std::uint32_t index, std::uint32_t rays) {
        for (; rays != 0; rays &= rays - 1) {
            const auto r = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rays));
            const RayQuery& q = query_of(r);
            const auto exact = [&](std::uint32_t l, std::uint32_t lane) { return mesh_.meets(r, l, lane); };
            const std::uint32_t z = q.axis[2];
            // The entry is the least of all rays: a vertex tells where this one is beside the leaf.
            const float along = (q.mesh.leaves[index].vertex[0][z][0] - q.start[z]) * q.inverse[z];
            if (trace_leaf(q, index, along, limit_of(q, answers_[r].t), exact, answers_[r])) set_limit(r);
        }
    }

    HWY_INLINE void triangle_by_triangle(std::uint32_t index, std::uint32_t rays) {
        const MeshLeaf& leaf = mesh_.mesh.leaves[index];
        const std::uint32_t present = (1u << leaf.count) - 1u;
        for (std::uint32_t lanes = boxes_.lanes(leaf, far_) & present; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            const std::uint32_t wanted = triangles_.candidates(leaf, lane, limits_, rays);
            if (wanted == 0) continue;
            HWY_ALIGN double t[kRayPacketWidth];
            const HitBits hits = triangles_.hits(leaf, lane, wanted, t);
            for (std::uint32_t found = hits.met | hits.open; found != 0; found &= found - 1) {
                const auto r = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(found));
                if (!is_before(t[r], leaf.triangle[lane], answers_[r])) continue;
                if ((hits.open >> r & 1u) && !mesh_.meets(r, index, lane)) continue;
                answers_[r] = {t[r], leaf.triangle[lane], true};
                set_limit(r);
            }
        }
    }

    // Made when first asked for: most packets need few.
    HWY_INLINE const RayQuery& query_of(std::uint32_t ray) {
        if ((made_ >> ray & 1u) == 0) {
            made_ |= 1u << ray;
            queries_[ray] = HWY_NAMESPACE::query_of(mesh_.rays + kRayNumbers * ray, mesh_.mesh, false);
        }
        return queries_[ray];
    }

    HWY_INLINE void one_by_one(const PacketStep& step) {
        for (std::uint32_t rays = step.rays; rays != 0; rays &= rays - 1) {
            const auto r = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rays));
            const auto exact = [&](std::uint32_t l, std::uint32_t lane) { return mesh_.meets(r, l, lane); };
            answers_[r] = trace_below<AlignedBoxes>(query_of(r), step.child, answers_[r], exact);
            set_limit(r);
        }
        find_far();
    }

    std::uint32_t count_, made_ = 0;
    const PacketRays& rays_;
    const PacketMesh& mesh_;
    RayAnswer* answers_;
    PacketBoxes boxes_;
    PacketTriangles triangles_;
    HWY_ALIGN float limits_[kRayPacketWidth];
    float far_ = 0.0f;  // the largest limit
    RayQuery queries_[kRayPacketWidth];
};

bool TracePacket(const RayPacket& packet, const PacketMesh& mesh, RayAnswer* answers) {
    PacketRays rays;
    if (!rays.set(packet, mesh.mesh.extent)) return false;
    Packet(packet, rays, mesh, answers).run();
    return true;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(TracePacket);

bool trace_packet(const RayPacket& rays, const PacketMesh& mesh, std::span<RayAnswer> answers) {
    return HWY_DYNAMIC_DISPATCH(TracePacket)(rays, mesh, answers.data());
}

}  // namespace crofton::mesh
#endif
