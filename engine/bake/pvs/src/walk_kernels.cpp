// SPDX-License-Identifier: MIT
// Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing" (1987), without branches on a line's way.
#include "walk_kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::pvs::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kWalkLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

// Treats NaN as std::min and std::max do.
HWY_INLINE V lesser(V a, V b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}
HWY_INLINE V greater(V a, V b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}

struct LineVectors {
    V point[3], direction[3];
};

HWY_INLINE LineVectors load(D d, const double* lines) {
    static constexpr std::int64_t kSixes[kWalkLanes] = {0, 6, 12, 18, 24, 30, 36, 42};  // a line has six numbers
    const hn::RebindToSigned<D> di;
    const auto sixes = hn::LoadU(di, kSixes);
    LineVectors loaded;
    for (int k = 0; k < 3; ++k) {
        loaded.point[k] = hn::GatherIndex(d, lines + k, sixes);
        loaded.direction[k] = hn::GatherIndex(d, lines + 3 + k, sixes);
    }
    return loaded;
}

// Finds the lines that meet the grid's bounds, and where.
HWY_INLINE M clip(D d, const VoxelGrid& grid, const LineVectors& line, V& begin, V& end) {
    begin = hn::Neg(hn::Inf(d)), end = hn::Inf(d);
    M meets = hn::Eq(end, end);
    for (int k = 0; k < 3; ++k) {
        const V low = hn::Set(d, grid.min[k]), high = hn::Set(d, grid.max[k]), p = line.point[k];
        const M still = hn::Eq(line.direction[k], hn::Zero(d));
        meets = hn::AndNot(hn::And(still, hn::Or(hn::Lt(p, low), hn::Gt(p, high))), meets);
        const V a = hn::Div(hn::Sub(low, p), line.direction[k]), b = hn::Div(hn::Sub(high, p), line.direction[k]);
        begin = hn::IfThenElse(still, begin, greater(begin, lesser(a, b)));
        end = hn::IfThenElse(still, end, lesser(end, greater(a, b)));
    }
    return hn::And(meets, hn::Le(begin, end));
}

// Where lines are on their way.
struct Walker {
    V next[3], pace[3];  // where the next border is crossed; from border to border
    V left[3];           // voxels before the grid's last on the way
    V stride[3];
    V voxel;
};

HWY_INLINE Walker start_at(D d, const VoxelGrid& grid, const LineVectors& line, V begin) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    Walker walker;
    walker.voxel = zero;
    for (int k = 0; k < 3; ++k) {
        const V slope = line.direction[k], inverse = hn::Div(one, slope), low = hn::Set(d, grid.min[k]);
        const V width = hn::Set(d, grid.width[k]), last = hn::Set(d, grid.counts[k] - 1.0);
        const V from =
            hn::Mul(hn::Sub(hn::Add(line.point[k], hn::Mul(begin, slope)), low), hn::Set(d, grid.per_length[k]));
        const V at = hn::IfThenElseZero(hn::Gt(from, zero), hn::Floor(lesser(from, last)));
        const M forward = hn::Gt(slope, zero), still = hn::Eq(slope, zero);
        const V border = hn::Add(low, hn::Mul(hn::Add(at, hn::IfThenElseZero(forward, one)), width));
        walker.next[k] = hn::IfThenElse(still, hn::Inf(d), hn::Mul(hn::Sub(border, line.point[k]), inverse));
        walker.pace[k] = hn::IfThenElse(still, hn::Inf(d), hn::Mul(width, hn::Abs(inverse)));
        walker.left[k] = hn::IfThenElse(forward, hn::Sub(last, at), at);
        const V stride = hn::Set(d, grid.strides[k]);
        walker.stride[k] = hn::IfThenElse(forward, stride, hn::Neg(stride));
        walker.voxel = hn::Add(walker.voxel, hn::Mul(stride, at));
    }
    return walker;
}

HWY_INLINE bool walk_some(D d, const VoxelGrid& grid, const double* lines, double* begins, double* counts,
                          WalkStep* steps, std::size_t lane, std::size_t most) {
    const hn::Rebind<std::int32_t, D> d32;
    const LineVectors line = load(d, lines);
    V begin, end;
    M active = clip(d, grid, line, begin, end);
    Walker walker = start_at(d, grid, line, begin);
    const V one = hn::Set(d, 1.0), zero = hn::Zero(d);
    V at = begin, count = zero;
    V *const next = walker.next, *const left = walker.left;
    hn::StoreU(begin, d, begins);
    for (std::size_t row = 0; !hn::AllFalse(d, active); ++row) {
        if (row == most) return false;
        const M first = hn::Le(next[0], next[1]);
        const M is_0 = hn::And(first, hn::Le(next[0], next[2])), is_1 = hn::AndNot(first, hn::Le(next[1], next[2]));
        const M is_2 = hn::Not(hn::Or(is_0, is_1));
        const V nearest = hn::IfThenElse(is_0, next[0], hn::IfThenElse(is_1, next[1], next[2]));
        at = greater(at, lesser(nearest, end));
        hn::StoreU(at, d, steps[row].end + lane);
        hn::StoreU(hn::DemoteTo(d32, walker.voxel), d32, reinterpret_cast<std::int32_t*>(steps[row].voxel + lane));
        count = hn::Add(count, hn::IfThenElseZero(active, one));
        const V remain = hn::IfThenElse(is_0, left[0], hn::IfThenElse(is_1, left[1], left[2]));
        active = hn::And(active, hn::And(hn::Not(hn::Ge(nearest, end)), hn::Gt(remain, zero)));
        walker.voxel = hn::Add(walker.voxel, hn::IfThenElse(is_0, walker.stride[0],
                                                            hn::IfThenElse(is_1, walker.stride[1], walker.stride[2])));
        const M is[3] = {is_0, is_1, is_2};
        for (int k = 0; k < 3; ++k) {
            next[k] = hn::IfThenElse(is[k], hn::Add(next[k], walker.pace[k]), next[k]);
            left[k] = hn::IfThenElse(is[k], hn::Sub(left[k], one), left[k]);
        }
    }
    hn::StoreU(count, d, counts);
    return true;
}

bool walk(const VoxelGrid& grid, const double* lines, WalkStart& start, WalkStep* steps, std::size_t most) {
    const D d;
    for (std::size_t lane = 0; lane < kWalkLanes; lane += hn::Lanes(d))
        if (!walk_some(d, grid, lines + 6 * lane, start.begin + lane, start.steps + lane, steps, lane, most))
            return false;
    return true;
}

}  // namespace crofton::pvs::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::pvs::kernels {

HWY_EXPORT(walk);

bool walk(const VoxelGrid& grid, const double* lines, WalkStart& start, WalkStep* steps, std::size_t most) {
    return HWY_DYNAMIC_DISPATCH(walk)(grid, lines, start, steps, most);
}

}  // namespace crofton::pvs::kernels
#endif
