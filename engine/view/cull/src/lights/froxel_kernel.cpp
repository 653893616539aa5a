// SPDX-License-Identifier: MIT
#include "lights/froxel_kernel.hpp"

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <crofton/simd/mask_bits-inl.hpp>

#include "lights/spot_filter.hpp"
#include "lights/spot_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

using FroxelTag = hn::CappedTag<float, 16>;
using IndexTag = hn::RebindToSigned<FroxelTag>;
using SingleTag = hn::CappedTag<double, 1>;
constexpr int kRounds = 16;  // of a portal

// Indices from `first` to before `last`.
struct Range {
    std::uint32_t first, last;
};

// How far the light reaches in a direction whose product with its axis is `t`.
double support(const KernelLight& light, double t) {
    if (!light.is_spot || t >= light.cosine) return light.radius;
    const double side = light.cosine * t + light.sine * std::sqrt(std::max(0.0, 1.0 - t * t));
    return light.radius * std::max(0.0, side);
}

// Decides in doubles the pairs that vectors leave open, and by exact arithmetic those that are open even then.
class OpenPairs {
  public:
    OpenPairs(const FroxelKernelInput& input, std::uint32_t light)
        : in_(input), grid_(*input.grid), light_(input.lights[light]), number_(light), filter_(grid_, light_) {}

    HWY_NOINLINE bool is_lit(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        const double w = light_.at[2], eta = filter_.eta + 0x1p-24 * light_.radius;
        const double low = std::max(grid_.doubles.depth[k], w - support(light_, -light_.axis[2]) - eta),
                     high = std::min(grid_.doubles.depth[k + 1], w + support(light_, light_.axis[2]) + eta);
        if (low > high) return false;
        const Answer answer = light_.is_spot ? ask_spot(i, j, low, high) : ask_sphere(i, j, low, high);
        if (answer != Answer::unknown) return answer == Answer::yes;
        return in_.decide(in_.context, number_, (k * grid_.size[1] + j) * grid_.size[0] + i);
    }

  private:
    [[nodiscard]] Answer ask_sphere(std::uint32_t i, std::uint32_t j, double low, double high) const {
        const SingleTag d;
        const Lit<SingleTag> lit =
            test_sphere(FroxelLanes<SingleTag>(grid_.doubles, i, j, low, high), LightLanes<SingleTag>::all(filter_));
        return !hn::AllFalse(d, lit.yes) ? Answer::yes : !hn::AllFalse(d, lit.no) ? Answer::no : Answer::unknown;
    }
    [[nodiscard]] Answer ask_spot(std::uint32_t i, std::uint32_t j, double low, double high) const {
        FroxelCell cell{{}, {}, low, high};
        const std::uint32_t at[2] = {i, j};
        for (unsigned axis = 0; axis < 2; ++axis)
            for (unsigned side = 0; side < 2; ++side) {
                cell.slope[axis][side] = grid_.doubles.slope[axis][at[axis] + side];
                cell.start[axis][side] = grid_.doubles.start[axis][at[axis] + side];
            }
        return filter_spot(light_, cell, filter_.eta);
    }

    const FroxelKernelInput& in_;
    const FroxelKernelGrid& grid_;
    const KernelLight& light_;
    std::uint32_t number_;
    FilterLight<double> filter_;
};

constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(hn::MaxLanes(FroxelTag()));
constexpr std::uint32_t kAllLanes = (1u << kLanes) - 1;

HWY_INLINE std::uint32_t lanes_of(hn::Mask<FroxelTag> mask) {
    return crofton::simd::HWY_NAMESPACE::mask_bits(FroxelTag(), mask) & kAllLanes;
}

// Pairs of spots and froxels, as many at a time as a vector has lanes.
class SpotPass {
  public:
    SpotPass(const FroxelKernelInput& input, SpotBatch& batch) : in_(input), grid_(*input.grid), batch_(batch) {}

    std::size_t run(LitRun* runs) {
        std::int32_t index[SpotBatch::kPairs + kLanes], open[SpotBatch::kPairs + kLanes];
        const std::uint32_t count = batch_.count;
        for (std::uint32_t p = 0; p < count; ++p) index[p] = static_cast<std::int32_t>(p);
        std::uint32_t left = decide(index, count, open, [](const auto& froxels, const auto& light) HWY_ATTR {
            return test_spot(froxels, light);
        });
        left = decide(open, left, index, [](const auto& froxels, const auto& light) HWY_ATTR {
            return Portal<FroxelTag>(froxels, light).run(kRounds);
        });
        for (std::uint32_t n = 0; n < left; ++n) resolve(static_cast<std::uint32_t>(index[n]));
        std::size_t written = 0;
        for (std::uint32_t p = 0; p < count; ++p) {
            runs[written] = {static_cast<std::uint32_t>(batch_.froxel[p]),
                             in_.first + static_cast<std::uint32_t>(batch_.light[p]), 1};
            written += batch_.is_lit[p];
        }
        batch_.count = 0;
        return written;
    }

  private:
    // Tests the pairs of `index`, which has room for a vector more, and lists those that stay open.
    template <class Test>
    HWY_INLINE std::uint32_t decide(std::int32_t* index, std::uint32_t count, std::int32_t* open, const Test& test) {
        const FroxelTag d;
        const IndexTag d_index;
        std::uint32_t left = 0;
        for (std::uint32_t l = 0; l < kLanes; ++l) index[count + l] = count > 0 ? index[0] : 0;
        for (std::uint32_t n = 0; n < count; n += kLanes) {
            const auto pair = hn::LoadU(d_index, index + n);
            const FroxelLanes<FroxelTag> froxels(
                grid_.floats, hn::GatherIndex(d_index, batch_.column, pair), hn::GatherIndex(d_index, batch_.row, pair),
                hn::GatherIndex(d, batch_.low, pair), hn::GatherIndex(d, batch_.high, pair));
            const auto light =
                LightLanes<FroxelTag>::gather(batch_.lights, hn::GatherIndex(d_index, batch_.light, pair));
            const Lit<FroxelTag> lit = test(froxels, light);
            const std::uint32_t yes = lanes_of(lit.yes), known = yes | lanes_of(lit.no);
            for (std::uint32_t l = 0; l < kLanes && n + l < count; ++l) {
                batch_.is_lit[index[n + l]] = yes >> l & 1;
                open[left] = index[n + l];
                left += (known >> l & 1) == 0;
            }
        }
        return left;
    }

    void resolve(std::uint32_t p) {
        const std::uint32_t slice = static_cast<std::uint32_t>(batch_.froxel[p]) / (grid_.size[0] * grid_.size[1]);
        batch_.is_lit[p] =
            OpenPairs(in_, static_cast<std::uint32_t>(batch_.light[p]))
                .is_lit(static_cast<std::uint32_t>(batch_.column[p]), static_cast<std::uint32_t>(batch_.row[p]), slice);
    }

    const FroxelKernelInput& in_;
    const FroxelKernelGrid& grid_;
    SpotBatch& batch_;
};

// One light's way through the grid: slices, rows and columns that it may reach, then froxel by froxel.
class LightWalk {
  public:
    LightWalk(const FroxelKernelInput& input, std::uint32_t light, SpotBatch& batch, LitRun* runs)
        : in_(input),
          grid_(*input.grid),
          light_(input.lights[light]),
          number_(light),
          filter_(grid_, light_),
          batch_(batch),
          runs_(runs) {}

    std::size_t run() {
        // Spots reach as far along `forward` as their support says; 2^-24 covers its rounding.
        const double w = light_.at[2], eta = static_cast<double>(filter_.eta) + 0x1p-24 * light_.radius;
        const double low = w - support(light_, -light_.axis[2]) - eta, high = w + support(light_, light_.axis[2]) + eta;
        const double* depth = grid_.doubles.depth;
        const std::uint32_t slices = grid_.size[2];
        if (high < depth[0] || low > depth[slices]) return 0;
        Range across[2];
        for (unsigned axis = 0; axis < 2; ++axis) {
            across[axis] = reached(axis);
            if (across[axis].first >= across[axis].last) return 0;
        }
        if (filter_.is_spot) batch_.lights[number_] = filter_;
        std::uint32_t k = 0;
        while (k + 1 < slices && depth[k + 1] < low) ++k;
        for (; k < slices && depth[k] <= high; ++k) {
            from_ = static_cast<float>(depth[k] > low ? depth[k] : low);
            to_ = static_cast<float>(depth[k + 1] < high ? depth[k + 1] : high);
            if (filter_.is_spot) add_slice(k, across[0], across[1]);
            if (!filter_.is_spot) visit_slice(k, narrowed(0, across[0]), narrowed(1, across[1]));
        }
        return count_;
    }

  private:
    // Columns or rows that the light may reach: those not beyond a boundary that it lies wholly before. A unit normal's
    // product with the axis t is off by 2^-21; 1 − t² + 2^-19 makes it too long rather than too short.
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
                const auto support_along = [&](auto along) HWY_ATTR {
                    const auto share = hn::Max(zero, hn::MulAdd(along, cosine, side));
                    const auto whole = hn::Ge(hn::Add(along, hn::Set(d, 0x1p-20f)), cosine);
                    return hn::IfThenElse(whole, radius, hn::Mul(radius, share));
                };
                up = support_along(t);
                down = support_along(hn::Neg(t));
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

    // Returns the columns or rows that the sphere's part in the slab may reach.
    HWY_INLINE Range narrowed(unsigned axis, Range range) const {
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

    // Spheres, a row's froxels at a time.
    HWY_INLINE void visit_slice(std::uint32_t k, Range columns, Range rows) {
        const auto light = LightLanes<FroxelTag>::all(filter_);
        for (std::uint32_t j = rows.first; j < rows.last; ++j)
            for (std::uint32_t i = columns.first; i < columns.last; i += kLanes) {
                const FroxelLanes<FroxelTag> froxels(grid_.floats, i, j, from_, to_);
                const Lit<FroxelTag> lit = test_sphere(froxels, light);
                const std::uint32_t present =
                    columns.last - i < 32 ? (1u << (columns.last - i)) - 1 : ~std::uint32_t{0};
                std::uint32_t mask = lanes_of(lit.yes) & present;
                std::uint32_t open = ~(mask | lanes_of(lit.no)) & present & kAllLanes;
                for (; HWY_UNLIKELY(open != 0); open &= open - 1) {
                    const auto l = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(open));
                    if (OpenPairs(in_, number_).is_lit(i + l, j, k)) mask |= 1u << l;
                }
                runs_[count_] = {(k * grid_.size[1] + j) * grid_.size[0] + i, in_.first + number_, mask};
                count_ += mask != 0;
            }
    }

    // Spots are tested when there are enough of them.
    HWY_INLINE void add_slice(std::uint32_t k, Range columns, Range rows) {
        for (std::uint32_t j = rows.first; j < rows.last; ++j)
            for (std::uint32_t i = columns.first; i < columns.last; ++i) {
                if (batch_.count == SpotBatch::kPairs) count_ += SpotPass(in_, batch_).run(runs_ + count_);
                const std::uint32_t p = batch_.count++;
                batch_.light[p] = static_cast<std::int32_t>(number_);
                batch_.column[p] = static_cast<std::int32_t>(i);
                batch_.row[p] = static_cast<std::int32_t>(j);
                batch_.froxel[p] = static_cast<std::int32_t>((k * grid_.size[1] + j) * grid_.size[0] + i);
                batch_.low[p] = from_;
                batch_.high[p] = to_;
            }
    }

    const FroxelKernelInput& in_;
    const FroxelKernelGrid& grid_;
    const KernelLight& light_;
    std::uint32_t number_;
    FilterLight<float> filter_;
    SpotBatch& batch_;
    LitRun* runs_;
    std::size_t count_ = 0;
    float from_ = 0.0f, to_ = 0.0f;
};

std::size_t run_froxels(const FroxelKernelInput& input, std::uint32_t light, SpotBatch& batch, LitRun* runs) {
    return LightWalk(input, light, batch, runs).run();
}

std::size_t run_spots(const FroxelKernelInput& input, SpotBatch& batch, LitRun* runs) {
    return SpotPass(input, batch).run(runs);
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_froxels);
HWY_EXPORT(run_spots);

std::size_t run_froxel_kernel(const FroxelKernelInput& input, std::uint32_t light, SpotBatch& batch, LitRun* runs) {
    return HWY_DYNAMIC_DISPATCH(run_froxels)(input, light, batch, runs);
}

std::size_t finish_spots(const FroxelKernelInput& input, SpotBatch& batch, LitRun* runs) {
    return HWY_DYNAMIC_DISPATCH(run_spots)(input, batch, runs);
}

}  // namespace crofton::cull
#endif
