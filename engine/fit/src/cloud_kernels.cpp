#include "cloud_kernels.hpp"

#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cloud_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Minima and maxima of fewer than a vector's worth of points, or of all where vectors hold one lane.
template <class T>
bool bounds_of_few(const T* points, std::size_t count, T limit, T* low, T* high) {
    bool good = true;
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) {
            const T value = points[3 * i + static_cast<std::size_t>(k)];
            good = good && std::abs(value) <= limit;
            low[k] = value < low[k] ? value : low[k];
            high[k] = value > high[k] ? value : high[k];
        }
    return good;
}

template <class T>
bool bounds(const T* points, std::size_t count, T limit, const ChunkBounds<T>& out) {
    const hn::CappedTag<T, 16> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto bound = hn::Set(d, limit);
    bool good = true;
    for (std::size_t begin = 0, chunk = 0; begin < count; begin += kChunk, ++chunk) {
        const std::size_t end = begin + kChunk < count ? begin + kChunk : count;
        constexpr T kInfinity = std::numeric_limits<T>::infinity();
        T low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};
        std::size_t i = begin;
        if (end - begin >= lanes) {
            auto lx = hn::Set(d, kInfinity), ly = lx, lz = lx;
            auto hx = hn::Set(d, -kInfinity), hy = hx, hz = hx;
            auto all = hn::Eq(bound, bound);
            for (; i + lanes <= end; i += lanes) {
                auto x = hn::Undefined(d), y = x, z = x;
                hn::LoadInterleaved3(d, points + 3 * i, x, y, z);
                const auto ok =
                    hn::And(hn::Le(hn::Abs(x), bound), hn::And(hn::Le(hn::Abs(y), bound), hn::Le(hn::Abs(z), bound)));
                all = hn::And(all, ok);
                lx = hn::Min(lx, x);
                ly = hn::Min(ly, y);
                lz = hn::Min(lz, z);
                hx = hn::Max(hx, x);
                hy = hn::Max(hy, y);
                hz = hn::Max(hz, z);
            }
            good = good && hn::AllTrue(d, all);
            low[0] = hn::GetLane(hn::MinOfLanes(d, lx));
            low[1] = hn::GetLane(hn::MinOfLanes(d, ly));
            low[2] = hn::GetLane(hn::MinOfLanes(d, lz));
            high[0] = hn::GetLane(hn::MaxOfLanes(d, hx));
            high[1] = hn::GetLane(hn::MaxOfLanes(d, hy));
            high[2] = hn::GetLane(hn::MaxOfLanes(d, hz));
        }
        good = bounds_of_few(points + 3 * i, end - i, limit, low, high) && good;
        for (int k = 0; k < 3; ++k) {
            out.low[k][chunk] = low[k];
            out.high[k][chunk] = high[k];
        }
    }
    return good;
}

bool bounds_float(const float* points, std::size_t count, float limit, const ChunkBounds<float>& out) {
    return bounds(points, count, limit, out);
}
bool bounds_double(const double* points, std::size_t count, double limit, const ChunkBounds<double>& out) {
    return bounds(points, count, limit, out);
}

void project(const Boxes& boxes, std::size_t count, const double direction[3], double* middle, double* reach) {
    const hn::CappedTag<double, 8> d;
    const hn::CappedTag<double, 1> one;
    const auto run = [&](auto tag, std::size_t begin, std::size_t end) {
        const auto x = hn::Set(tag, direction[0]), y = hn::Set(tag, direction[1]), z = hn::Set(tag, direction[2]);
        const auto ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
        for (std::size_t i = begin; i < end; i += hn::Lanes(tag)) {
            const auto m = hn::Add(hn::Add(hn::Mul(x, hn::LoadU(tag, boxes.center[0] + i)),
                                           hn::Mul(y, hn::LoadU(tag, boxes.center[1] + i))),
                                   hn::Mul(z, hn::LoadU(tag, boxes.center[2] + i)));
            const auto r = hn::Add(
                hn::Add(hn::Mul(ax, hn::LoadU(tag, boxes.half[0] + i)), hn::Mul(ay, hn::LoadU(tag, boxes.half[1] + i))),
                hn::Mul(az, hn::LoadU(tag, boxes.half[2] + i)));
            hn::StoreU(m, tag, middle + i);
            hn::StoreU(r, tag, reach + i);
        }
    };
    const std::size_t whole = count - count % hn::Lanes(d);
    run(d, 0, whole);
    run(one, whole, count);
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::fit::kernels {

HWY_EXPORT(bounds_float);
HWY_EXPORT(bounds_double);
HWY_EXPORT(project);

bool chunk_bounds(const float* points, std::size_t count, float limit, const ChunkBounds<float>& out) {
    return HWY_DYNAMIC_DISPATCH(bounds_float)(points, count, limit, out);
}
bool chunk_bounds(const double* points, std::size_t count, double limit, const ChunkBounds<double>& out) {
    return HWY_DYNAMIC_DISPATCH(bounds_double)(points, count, limit, out);
}
void project_boxes(const Boxes& boxes, std::size_t count, const double direction[3], double* middle, double* reach) {
    HWY_DYNAMIC_DISPATCH(project)(boxes, count, direction, middle, reach);
}

}  // namespace crofton::fit::kernels
#endif
