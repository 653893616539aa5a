// SPDX-License-Identifier: MIT
// Traces a ray through a mesh tree, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "ray_boxes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The hierarchy for pairs of meshes, where there is no other: the slabs of an oriented box are a long chain of
// dependent operations.
class OrientedBoxes {
  public:
    using Node = MeshNode;
    static constexpr std::uint32_t kWidth = kMeshNodeWidth;

    HWY_INLINE explicit OrientedBoxes(const RayQuery& q) : query_(q) {}
    HWY_INLINE const Node& node(std::uint32_t index) const { return query_.mesh.mesh_nodes[index]; }

    HWY_INLINE std::uint32_t entries(const Node& node, float limit, float* entry) const {
        const D d;
        std::uint32_t lanes = 0;
        for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
            V offset[3], first = hn::Zero(d), last = hn::Set(d, limit);
            for (int i = 0; i < 3; ++i)
                offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, query_.start[i]));
            for (int k = 0; k < 3; ++k) {
                V along = hn::Zero(d), speed = hn::Zero(d);
                for (int i = 0; i < 3; ++i) {
                    const V axis = hn::Load(d, node.axes[k][i] + l);
                    along = hn::MulAdd(axis, offset[i], along);
                    speed = hn::MulAdd(axis, hn::Set(d, query_.direction[i]), speed);
                }
                const V half = hn::Add(hn::Load(d, node.half[k] + l), hn::Set(d, query_.error_bound));
                // Parallel to the slab: a tiny speed keeps the bounds finite and on the right sides.
                const V least = hn::Set(d, 1e-18f);
                speed = hn::IfThenElse(hn::Lt(hn::Abs(speed), least), least, speed);
                const V inverse = hn::Div(hn::Set(d, 1.0f), speed);
                const V t0 = hn::Mul(hn::Sub(along, half), inverse), t1 = hn::Mul(hn::Add(along, half), inverse);
                first = hn::Max(first, hn::Min(t0, t1));
                last = hn::Min(last, hn::Max(t0, t1));
            }
            // 2^-20 covers the divisions.
            first = hn::Mul(first, hn::Set(d, 1.0f - 0x1p-20f));
            last = hn::Mul(last, hn::Set(d, 1.0f + 0x1p-20f));
            hn::Store(first, d, entry + l);
            lanes |= simd::mask_bits(d, hn::Le(first, last)) << l;
        }
        return lanes & ((1u << node.count) - 1u);
    }

  private:
    using D = hn::CappedTag<float, kWidth>;
    using V = hn::Vec<D>;
    const RayQuery& query_;
};

RayAnswer Trace(const double* ray, const RayMesh& mesh, bool any, ExactTest meets) {
    const RayQuery q = query_of(ray, mesh, any);
    const RayAnswer none{ray[6], 0, false};
    return mesh.nodes != nullptr ? trace_below<AlignedBoxes>(q, 0, none, meets)
                                 : trace_below<OrientedBoxes>(q, 0, none, meets);
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(Trace);

RayAnswer trace(const double* ray, const RayMesh& mesh, bool any, ExactTest meets) {
    return HWY_DYNAMIC_DISPATCH(Trace)(ray, mesh, any, meets);
}

}  // namespace crofton::mesh
#endif
