// SPDX-License-Identifier: MIT
#include "draw_kernels.hpp"

#include "trace_kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <crofton/simd/compress-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::lines::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;
using D = hn::CappedTag<float, kDrawLanes>;
using V = hn::Vec<D>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;

void project(const DrawnTriangles* blocks, std::size_t count, const GridFrame& grid, Projected& out) {
    const D d;
    const DI di;
    const V zero = hn::Zero(d);
    const auto along = [&](const float* axis, const V* p, float shift) {
        return hn::Add(hn::Add(hn::Add(hn::Mul(hn::Set(d, axis[0]), p[0]), hn::Mul(hn::Set(d, axis[1]), p[1])),
                               hn::Mul(hn::Set(d, axis[2]), p[2])),
                       hn::Set(d, shift));
    };
    for (std::size_t b = 0; b < count; ++b)
        for (std::size_t lane = 0; lane < kDrawLanes; lane += hn::Lanes(d)) {
            const std::size_t at = b * kDrawLanes + lane;
            V x[3], y[3];
            for (int c = 0; c < 3; ++c) {
                V p[3];
                for (int k = 0; k < 3; ++k) p[k] = hn::Load(d, blocks[b].corner[c][k] + lane);
                x[c] = along(grid.right, p, grid.shift[0]);
                y[c] = along(grid.up, p, grid.shift[1]);
                hn::Store(x[c], d, out.x[c] + at);
                hn::Store(y[c], d, out.y[c] + at);
                hn::Store(along(grid.forward, p, grid.shift[2]), d, out.t[c] + at);
            }
            const auto range = [&](const V* v, float end, std::int32_t* low, std::int32_t* high) {
                const V least = hn::Max(zero, hn::Min(v[0], hn::Min(v[1], v[2])));
                const V most = hn::Min(hn::Set(d, end), hn::Add(hn::Max(v[0], hn::Max(v[1], v[2])), hn::Set(d, 1.0f)));
                hn::Store(hn::ConvertTo(di, least), di,
                          low + at);  // truncates: both are at least 0, or the range is empty
                hn::Store(hn::ConvertTo(di, most), di, high + at);
            };
            range(x, grid.columns, out.column_low, out.column_high);
            range(y, grid.rows, out.row_low, out.row_high);
        }
}

// Edge functions from the sample. Those of a shared edge seen from either side are each other's negatives to the last
// bit. So exactly one of two neighbours takes a sample between them, but where it is exactly 0.
std::size_t covered(const Projected& chunk, const std::uint32_t* triangles, const std::uint32_t* cells,
                    std::size_t count, const float* sample_x, const float* sample_y, std::uint32_t* out_cell,
                    std::uint32_t* out_triangle, float* out_t) {
    const D d;
    const DI di;
    const DU du;
    const V zero = hn::Zero(d);
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto triangle = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(triangles) + i);
        const auto cell = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(cells) + i);
        const V px = hn::GatherIndex(d, sample_x, cell), py = hn::GatherIndex(d, sample_y, cell);
        V x[3], y[3];
        for (int c = 0; c < 3; ++c) {
            x[c] = hn::Sub(hn::GatherIndex(d, chunk.x[c], triangle), px);
            y[c] = hn::Sub(hn::GatherIndex(d, chunk.y[c], triangle), py);
        }
        const auto edge = [&](int a, int b) { return hn::Sub(hn::Mul(x[a], y[b]), hn::Mul(y[a], x[b])); };
        const V e0 = edge(1, 2), e1 = edge(2, 0), e2 = edge(0, 1), area = hn::Add(hn::Add(e0, e1), e2);
        const auto left = hn::And(hn::And(hn::Ge(e0, zero), hn::Ge(e1, zero)), hn::Ge(e2, zero));
        const auto right = hn::And(hn::And(hn::Le(e0, zero), hn::Le(e1, zero)), hn::Le(e2, zero));
        auto inside = hn::And(hn::Or(left, right), hn::Ne(area, zero));
        if (i + hn::Lanes(d) > count) inside = hn::And(inside, hn::FirstN(d, count - i));
        if (hn::AllFalse(d, inside)) continue;
        const V t = hn::Div(hn::Add(hn::Add(hn::Mul(e0, hn::GatherIndex(d, chunk.t[0], triangle)),
                                            hn::Mul(e1, hn::GatherIndex(d, chunk.t[1], triangle))),
                                    hn::Mul(e2, hn::GatherIndex(d, chunk.t[2], triangle))),
                            area);
        // Counter-clockwise in a right-handed grid: the normal runs with the line, which so comes from the back.
        const auto front = hn::IfThenElseZero(hn::RebindMask(du, hn::Lt(area, zero)), hn::Set(du, kFront));
        const auto which = hn::RebindMask(du, inside);
        simd::compress_store(du, hn::BitCast(du, cell), which, out_cell + used);
        simd::compress_store(du, hn::Or(hn::BitCast(du, triangle), front), which, out_triangle + used);
        used += simd::compress_store(d, t, inside, out_t + used);
    }
    return used;
}

void jitter_row(std::uint32_t seed, std::uint32_t first_cell, std::uint32_t columns, std::uint32_t row, float* sample_x,
                float* sample_y) {
    const D d;
    const DU du;
    const DI di;
    const auto mix = [&](auto h) {  // MurmurHash3's finaliser
        h = hn::Mul(hn::Xor(h, hn::ShiftRight<16>(h)), hn::Set(du, 0x85ebca6bu));
        h = hn::Mul(hn::Xor(h, hn::ShiftRight<13>(h)), hn::Set(du, 0xc2b2ae35u));
        return hn::Xor(h, hn::ShiftRight<16>(h));
    };
    const V scale = hn::Set(d, 0x1p-16f), half = hn::Set(d, 0x1p-17f);
    for (std::uint32_t c = 0; c < columns; c += static_cast<std::uint32_t>(hn::Lanes(d))) {
        const auto h = mix(hn::Xor(mix(hn::Iota(du, first_cell + c)), hn::Set(du, seed)));
        const auto unit = [&](auto bits) {
            return hn::Add(hn::Mul(hn::ConvertTo(d, hn::BitCast(di, bits)), scale), half);
        };
        hn::StoreU(hn::Add(hn::Iota(d, static_cast<float>(c)), unit(hn::And(h, hn::Set(du, 0xffffu)))), d,
                   sample_x + c);
        hn::StoreU(hn::Add(hn::Set(d, static_cast<float>(row)), unit(hn::ShiftRight<16>(h))), d, sample_y + c);
    }
}

}  // namespace crofton::lines::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::lines::detail {

HWY_EXPORT(project);
HWY_EXPORT(covered);
HWY_EXPORT(jitter_row);

void project(const DrawnTriangles* blocks, std::size_t count, const GridFrame& grid, Projected& out) {
    HWY_DYNAMIC_DISPATCH(project)(blocks, count, grid, out);
}
std::size_t covered(const Projected& chunk, const std::uint32_t* triangles, const std::uint32_t* cells,
                    std::size_t count, const float* sample_x, const float* sample_y, std::uint32_t* out_cell,
                    std::uint32_t* out_triangle, float* out_t) {
    return HWY_DYNAMIC_DISPATCH(covered)(chunk, triangles, cells, count, sample_x, sample_y, out_cell, out_triangle,
                                         out_t);
}
void jitter_row(std::uint32_t seed, std::uint32_t first_cell, std::uint32_t columns, std::uint32_t row, float* sample_x,
                float* sample_y) {
    HWY_DYNAMIC_DISPATCH(jitter_row)(seed, first_cell, columns, row, sample_x, sample_y);
}

}  // namespace crofton::lines::detail
#endif
