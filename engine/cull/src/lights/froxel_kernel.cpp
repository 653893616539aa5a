// SPDX-License-Identifier: MIT
#include "lights/froxel_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/froxel_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <crofton/simd/mask_bits-inl.hpp>

#include "lights/light_tests-inl.hpp"
#include "lights/spot_filter.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

using FroxelTag = hn::CappedTag<float, 16>;
using SingleTag = hn::CappedTag<double, 1>;
constexpr int kRounds = 6;  // of test_spot

// Indices from `first` to before `last`.
struct Range {
    std::uint32_t first, last;
};

// One light's way through the grid: slices, rows and columns that it may reach, then froxel by froxel.
class LightWalk {
  public:
    LightWalk(const FroxelKernelInput& input, std::uint32_t light, LitRun* runs)
        : in_(input),
          grid_(*input.grid),
          light_(input.lights[light]),
          number_(light),
          filter_(grid_, light_),
          runs_(runs) {}

    std::size_t run() {
        // Spots reach as far along `forward` as their support says; 2^-24 covers its rounding.
        const double w = light_.at[2], eta = static_cast<double>(filter_.eta) + 0x1p-24 * light_.radius;
        const double low = w - support(-light_.axis[2]) - eta, high = w + support(light_.axis[2]) + eta;
        const double* depth = grid_.doubles.depth;
        const std::uint32_t slices = grid_.size[2];
        if (high < depth[0] || low > depth[slices]) return 0;
        Range across[2];
        for (unsigned axis = 0; axis < 2; ++axis) {
            across[axis] = reached(axis);
            if (across[axis].first >= across[axis].last) return 0;
        }
        std::uint32_t k = 0;
        while (k + 1 < slices && depth[k + 1] < low) ++k;
        for (; k < slices && depth[k] <= high; ++k) {
            from_ = static_cast<float>(depth[k] > low ? depth[k] : low);
            to_ = static_cast<float>(depth[k + 1] < high ? depth[k + 1] : high);
            visit_slice(k, across[0], across[1]);
        }
        return count_;
    }

  private:
    // How far the light reaches in a direction whose product with the axis is `t`.
    [[nodiscard]] double support(double t) const {
        if (!light_.is_spot || t >= light_.cosine) return light_.radius;
        const double side = light_.cosine * t + light_.sine * std::sqrt(std::max(0.0, 1.0 - t * t));
        return light_.radius * std::max(0.0, side);
    }

    // Columns or rows that the light may reach: those not beyond a boundary that it lies wholly before. A unit normal's
    // product with the axis t is off by 2^-21; 1 − t² + 2^-19 makes a reach that is too long rather than too short.
    HWY_INLINE Range reached(unsigned axis) const {
        const FroxelTag d;
        const FroxelArrays<float>& grid = grid_.floats;
        const auto radius = hn::Set(d, filter_.radius), eta = hn::Set(d, filter_.eta), zero = hn::Zero(d);
        const std::size_t boundaries = grid_.size[axis] + 1;
        std::size_t before = 0, after = 0;  // boundaries that the light lies wholly after, and before
        for (std::size_t i = 0; i < boundaries; i += hn::Lanes(d)) {
            const auto normal = hn::LoadU(d, grid.across[axis] + i), forward = hn::LoadU(d, grid.forward[axis] + i);
            const auto value =
                hn::MulAdd(normal, hn::Set(d, filter_.at[axis]),
                           hn::MulAdd(forward, hn::Set(d, filter_.at[2]), hn::LoadU(d, grid.offset[axis] + i)));
            auto up = radius, down = radius;
            if (filter_.is_spot) {
                const auto t =
                    hn::MulAdd(normal, hn::Set(d, filter_.axis[axis]), hn::Mul(forward, hn::Set(d, filter_.axis[2])));
                const auto root = hn::Sqrt(hn::Max(zero, hn::NegMulAdd(t, t, hn::Set(d, 1.0f + 0x1p-19f))));
                const auto cosine = hn::Set(d, filter_.cosine), side = hn::Mul(root, hn::Set(d, filter_.sine));
                const auto reach = [&](auto along) HWY_ATTR {
                    const auto share = hn::Max(zero, hn::MulAdd(along, cosine, side));
                    const auto whole = hn::Ge(hn::Add(along, hn::Set(d, 0x1p-20f)), cosine);
                    return hn::IfThenElse(whole, radius, hn::Mul(radius, share));
                };
                up = reach(t);
                down = reach(hn::Neg(t));
            }
            const auto present = hn::FirstN(d, boundaries - i);
            const auto beyond = hn::Gt(hn::Sub(value, down), eta), short_of = hn::Lt(hn::Add(value, up), hn::Neg(eta));
            before += hn::CountTrue(d, hn::And(present, beyond));
            after += hn::CountTrue(d, hn::And(present, short_of));
        }
        // Boundary 0 does not count among the first, nor the last among the others.
        const std::size_t first = before > 0 ? before - 1 : 0, last = boundaries - 1 - (after > 0 ? after - 1 : 0);
        if (before == boundaries || after == boundaries) return {0, 0};
        return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
    }

    // What of columns or rows the ball's part in the slab may reach.
    HWY_INLINE Range narrowed(unsigned axis, Range range) const {
        if (filter_.is_spot) return range;
        const float gap = std::max(0.0f, std::max(from_ - filter_.at[2], filter_.at[2] - to_));
        const float square = filter_.radius * filter_.radius * (1.0f + 0x1p-18f) - gap * gap * (1.0f - 0x1p-18f);
        const float radius = std::sqrt(std::max(0.0f, square)) + 2.0f * filter_.eta;
        const float low = filter_.at[axis] - radius, high = filter_.at[axis] + radius;
        const float* slope = grid_.floats.slope[axis];
        const float* start = grid_.floats.start[axis];
        const auto end = [&](std::size_t i, float w) { return slope[i] * w + start[i]; };
        while (range.first + 1 < range.last && std::max(end(range.first + 1, from_), end(range.first + 1, to_)) < low)
            ++range.first;
        while (range.first + 1 < range.last && std::min(end(range.last - 1, from_), end(range.last - 1, to_)) > high)
            --range.last;
        return range;
    }

    HWY_INLINE void visit_slice(std::uint32_t k, Range columns, Range rows) {
        columns = narrowed(0, columns);
        rows = narrowed(1, rows);
        for (std::uint32_t j = rows.first; j < rows.last; ++j)
            for (std::uint32_t i = columns.first; i < columns.last;
                 i += static_cast<std::uint32_t>(hn::Lanes(FroxelTag()))) {
                const FroxelLanes<FroxelTag> froxels(grid_.floats, i, j, from_, to_);
                const Lit<FroxelTag> lit =
                    filter_.is_spot ? test_spot(froxels, filter_, kRounds) : test_ball(froxels, filter_);
                const std::uint32_t present =
                    columns.last - i < 32 ? (1u << (columns.last - i)) - 1 : ~std::uint32_t{0};
                std::uint32_t mask = bits(lit.yes) & present;
                const std::uint32_t froxel = (k * grid_.size[1] + j) * grid_.size[0] + i;
                const std::uint32_t open = ~(mask | bits(lit.no)) & present & kAllLanes;
                if (HWY_UNLIKELY(open != 0)) mask |= resolve(open, i, j, k, froxel);
                runs_[count_] = {froxel, in_.first + number_, mask};
                count_ += mask != 0;
            }
    }

    static HWY_INLINE std::uint32_t bits(hn::Mask<FroxelTag> mask) {
        return crofton::simd::HWY_NAMESPACE::mask_bits(FroxelTag(), mask) & kAllLanes;
    }

    // In doubles, and what these cannot tell either by exact arithmetic.
    HWY_NOINLINE std::uint32_t resolve(std::uint32_t open, std::uint32_t i, std::uint32_t j, std::uint32_t k,
                                       std::uint32_t froxel) {
        const FilterLight<double> light(grid_, light_);
        const double w = light_.at[2], eta = light.eta + 0x1p-24 * light_.radius;
        const double low = std::max(grid_.doubles.depth[k], w - support(-light_.axis[2]) - eta),
                     high = std::min(grid_.doubles.depth[k + 1], w + support(light_.axis[2]) + eta);
        std::uint32_t result = 0;
        for (; open; open &= open - 1) {
            const auto l = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(open));
            if (low > high) continue;
            const Answer answer =
                light.is_spot ? ask_spot(i + l, j, low, high, light.eta) : ask_ball(i + l, j, low, high, light);
            const bool is_lit =
                answer == Answer::yes || (answer == Answer::unknown && in_.decide(in_.context, number_, froxel + l));
            if (is_lit) result |= 1u << l;
        }
        return result;
    }

    [[nodiscard]] Answer ask_ball(std::uint32_t i, std::uint32_t j, double low, double high,
                                  const FilterLight<double>& light) const {
        const SingleTag d;
        const Lit<SingleTag> lit = test_ball(FroxelLanes<SingleTag>(grid_.doubles, i, j, low, high), light);
        return !hn::AllFalse(d, lit.yes) ? Answer::yes : !hn::AllFalse(d, lit.no) ? Answer::no : Answer::unknown;
    }
    [[nodiscard]] Answer ask_spot(std::uint32_t i, std::uint32_t j, double low, double high, double eta) const {
        FroxelCell cell{{}, {}, low, high};
        const std::uint32_t at[2] = {i, j};
        for (unsigned axis = 0; axis < 2; ++axis)
            for (unsigned side = 0; side < 2; ++side) {
                cell.slope[axis][side] = grid_.doubles.slope[axis][at[axis] + side];
                cell.start[axis][side] = grid_.doubles.start[axis][at[axis] + side];
            }
        return filter_spot(light_, cell, eta);
    }

    static constexpr std::uint32_t kAllLanes = (1u << hn::MaxLanes(FroxelTag())) - 1;

    const FroxelKernelInput& in_;
    const FroxelKernelGrid& grid_;
    const KernelLight& light_;
    std::uint32_t number_;
    FilterLight<float> filter_;
    LitRun* runs_;
    std::size_t count_ = 0;
    float from_ = 0.0f, to_ = 0.0f;
};

std::size_t run_froxels(const FroxelKernelInput& input, std::uint32_t light, LitRun* runs) {
    return LightWalk(input, light, runs).run();
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_froxels);

std::size_t run_froxel_kernel(const FroxelKernelInput& input, std::uint32_t light, LitRun* runs) {
    return HWY_DYNAMIC_DISPATCH(run_froxels)(input, light, runs);
}

}  // namespace crofton::cull
#endif
