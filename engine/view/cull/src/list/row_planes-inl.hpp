// SPDX-License-Identifier: MIT
// A view's planes before a chunk's rows, a plane a lane. Compiled once per instruction set (Highway).
#include <algorithm>

#include "lanes-inl.hpp"
#include "list/row_planes.hpp"

#if defined(CROFTON_CULL_ROW_PLANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_ROW_PLANES_INL
#undef CROFTON_CULL_ROW_PLANES_INL
#else
#define CROFTON_CULL_ROW_PLANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// A view's planes in a chunk's units, before those that need no test are left out.
class ScaledRowPlanes {
  public:
    HWY_INLINE ScaledRowPlanes(const KernelView& view, const ListChunk& chunk) {
        const std::size_t count = hwy::RoundUpTo(view.plane_count, kLanes);
        for (std::size_t i = 0; i < count; ++i) {
            const bool is_plane = i < view.plane_count;
            for (unsigned j = 0; j < 3; ++j) normal_[j][i] = is_plane ? view.planes[i].normal[j] : 0.0;
            plane_offset_[i] = is_plane ? view.planes[i].offset : 0.0;
        }
        const LocalOrigin at = local_origin(view, chunk.origin, 0.0f);
        for (std::size_t i = 0; i < count; i += kLanes) {
            scale(chunk, at, i);
            // Not std::max, which would pass over NaN.
            for (std::size_t l = 0; l < kLanes; ++l)
                if (!(error_bound_[i + l] <= largest_error_bound_)) largest_error_bound_ = error_bound_[i + l];
        }
    }

    // Writes to the caller's struct, which is too large to be copied.
    HWY_INLINE void sort(const KernelView& view, const ListChunk& chunk, RowPlanes& result) const {
        result.count = result.planes = 0;
        result.error_bound = 0;
        result.outside = false;
        result.useless = !(largest_error_bound_ < kMaxErrorBound);
        if (result.useless) {
            result.planes = (1u << view.plane_count) - 1;
            return;
        }
        result.error_bound = static_cast<std::int32_t>(largest_error_bound_) + 1;
        const bool bounded = chunk.largest_radius != kUnboundedRadius;
        for (std::uint32_t i = 0; i < view.plane_count; ++i) {
            if (bounded && highest_[i] < -result.error_bound) result.outside = true;
            if (bounded && lowest_[i] >= result.error_bound) continue;
            const std::uint32_t n = result.count++;
            result.normal_xy[n] = boxtree::pair_of(whole_[0][i], whole_[1][i]);
            result.normal_z[n] = boxtree::pair_of(whole_[2][i], 0);
            result.offset[n] = offset_[i];
            result.planes |= 1u << i;
        }
    }

  private:
    using D = hn::CappedTag<double, 4>;
    using I = hn::Rebind<std::int32_t, D>;
    static constexpr std::size_t kLanes = hn::MaxLanes(D());
    static constexpr double kScale = 1 << kRowNormalBits;
    // |normal|₁ ≤ √3 · 1.0005 · 2^14 + 3/2 and coordinates up to 2^14 − 1: |normal · x| < 4.66e8 < kMaxOffset. Larger
    // offsets are clamped. At +kMaxOffset s is positive and at most the true value: it rejects nothing, and what it
    // accepts is inside. At −kMaxOffset it is negative and at least the true value: it accepts nothing, and what it
    // rejects is outside. s stays below 2^14 · kUnboundedRadius + error bound in magnitude, so that an unbounded radius
    // neither rejects nor accepts; the sums stay within 32 bits.
    static constexpr double kMaxOffset = 1 << 29;
    static constexpr double kMaxErrorBound = 1 << 26;

    // sum + a · b, rounded twice on every target: a fused product would move rows from one stage to the other, and the
    // statistics with them.
    using V = hn::Vec<D>;
    static HWY_INLINE V plus_product(V sum, V a, V b) { return hn::Add(hn::Mul(a, b), sum); }

    // Scales the planes from i on, as many as a vector holds.
    HWY_INLINE void scale(const ListChunk& chunk, const LocalOrigin& at, std::size_t i) {
        const D d;
        const I di;
        const double per_quantum = kScale / chunk.quantum;
        const auto own = hn::Load(d, plane_offset_ + i);
        auto value = own, span = hn::Zero(d);
        // The value's seven roundings (as in local_plane), and the offset's to an integer.
        V error_bound = plus_product(hn::Set(d, 1.0), hn::Add(hn::Abs(own), hn::Set(d, at.size)),
                                     hn::Set(d, 0x1p-49 * per_quantum));
        for (unsigned j = 0; j < 3; ++j) {
            const auto normal = hn::Load(d, normal_[j] + i), scaled = hn::Mul(normal, hn::Set(d, kScale)),
                       whole = hn::Round(scaled), extent = hn::Set(d, static_cast<double>(chunk.extent[j]));
            value = plus_product(value, normal, hn::Set(d, at.d[j]));
            // The normal's rounding, and that of the row: half a quantum, and 2^14 · 2^-24 for the centre's in float.
            error_bound = plus_product(error_bound, hn::Abs(hn::Sub(scaled, whole)), extent);
            error_bound = plus_product(error_bound, hn::Abs(scaled), hn::Set(d, 0.502));
            span = plus_product(span, hn::Abs(whole), extent);
            hn::Store(hn::DemoteTo(di, whole), di, whole_[j] + i);
        }
        const auto most = hn::Set(d, kMaxOffset);
        const auto offset = hn::Trunc(hn::Max(hn::Neg(most), hn::Min(most, hn::Mul(value, hn::Set(d, per_quantum)))));
        const auto outer_extent = hn::Add(span, hn::Set(d, kScale * chunk.largest_radius));
        hn::Store(hn::DemoteTo(di, offset), di, offset_ + i);
        hn::Store(hn::Sub(offset, outer_extent), d, lowest_ + i);
        hn::Store(hn::Add(offset, outer_extent), d, highest_ + i);
        hn::Store(plus_product(hn::Set(d, 1.0), error_bound, hn::Set(d, 1.0 + 0x1p-20)), d, error_bound_ + i);
    }

    static constexpr std::size_t kMost = KernelView::kMaxPlanes;
    alignas(64) double normal_[3][kMost], plane_offset_[kMost];
    alignas(64) double lowest_[kMost], highest_[kMost], error_bound_[kMost];
    alignas(64) std::int32_t whole_[3][kMost], offset_[kMost];
    double largest_error_bound_ = 0.0;
};

HWY_INLINE void set_row_planes(const KernelView& view, const ListChunk& chunk, RowPlanes& planes) {
    ScaledRowPlanes(view, chunk).sort(view, chunk, planes);
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
