// SPDX-License-Identifier: MIT
#include "cloud/cloud_kernels.hpp"

#include <cmath>
#include <limits>
#include <type_traits>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Includes points one by one: the rest that fills no vector, or all points where vectors hold one lane.
template <class T>
bool bounds_of_rest(const T* points, std::size_t count, T limit, T* low, T* high) {
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
        good = bounds_of_rest(points + 3 * i, end - i, limit, low, high) && good;
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

void project_boxes(const Boxes& boxes, std::size_t count, const double direction[3], double* middle, double* radius) {
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
            hn::StoreU(r, tag, radius + i);
        }
    };
    const std::size_t whole = count - count % hn::Lanes(d);
    run(d, 0, whole);
    run(one, whole, count);
}

// Points as lanes of T, which are the points' own numbers or doubles.
template <class D, class Point>
HWY_INLINE void load_points(D d, const Point* points, hn::Vec<D>& x, hn::Vec<D>& y, hn::Vec<D>& z) {
    if constexpr (std::is_same_v<Point, hn::TFromD<D>>) {
        hn::LoadInterleaved3(d, points, x, y, z);
    } else {
        const hn::Rebind<Point, D> narrow;
        auto nx = hn::Zero(narrow), ny = nx, nz = nx;
        hn::LoadInterleaved3(narrow, points, nx, ny, nz);
        x = hn::PromoteTo(d, nx);
        y = hn::PromoteTo(d, ny);
        z = hn::PromoteTo(d, nz);
    }
}

// The extents of points, relative to the origin, along three directions.
template <class T, class Point>
void extents(const Point* points, std::size_t begin, std::size_t end, const T* directions, const T* origin, T low[3],
             T high[3]) {
    const hn::CappedTag<T, 16> d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr T kInfinity = std::numeric_limits<T>::infinity();
    for (int k = 0; k < 3; ++k) {
        low[k] = kInfinity;
        high[k] = -kInfinity;
    }
    std::size_t i = begin;
    if (end - begin >= lanes) {
        const auto ax = hn::Set(d, directions[0]), ay = hn::Set(d, directions[1]), az = hn::Set(d, directions[2]);
        const auto bx = hn::Set(d, directions[3]), by = hn::Set(d, directions[4]), bz = hn::Set(d, directions[5]);
        const auto cx = hn::Set(d, directions[6]), cy = hn::Set(d, directions[7]), cz = hn::Set(d, directions[8]);
        const auto ox = hn::Set(d, origin[0]), oy = hn::Set(d, origin[1]), oz = hn::Set(d, origin[2]);
        auto low_a = hn::Set(d, kInfinity), low_b = low_a, low_c = low_a;
        auto high_a = hn::Set(d, -kInfinity), high_b = high_a, high_c = high_a;
        const auto include = [&](std::size_t at) {
            auto x = hn::Undefined(d), y = x, z = x;
            load_points(d, points + 3 * at, x, y, z);
            x = hn::Sub(x, ox);
            y = hn::Sub(y, oy);
            z = hn::Sub(z, oz);
            const auto a = hn::Add(hn::Add(hn::Mul(ax, x), hn::Mul(ay, y)), hn::Mul(az, z));
            const auto b = hn::Add(hn::Add(hn::Mul(bx, x), hn::Mul(by, y)), hn::Mul(bz, z));
            const auto c = hn::Add(hn::Add(hn::Mul(cx, x), hn::Mul(cy, y)), hn::Mul(cz, z));
            low_a = hn::Min(low_a, a);
            low_b = hn::Min(low_b, b);
            low_c = hn::Min(low_c, c);
            high_a = hn::Max(high_a, a);
            high_b = hn::Max(high_b, b);
            high_c = hn::Max(high_c, c);
        };
        for (; i + lanes <= end; i += lanes) include(i);
        // The last vector may overlap the one before.
        if (i < end) include(end - lanes);
        i = end;
        const auto reduce = [&](auto least, auto greatest, int k) {
            low[k] = hn::GetLane(hn::MinOfLanes(d, least));
            high[k] = hn::GetLane(hn::MaxOfLanes(d, greatest));
        };
        reduce(low_a, high_a, 0);
        reduce(low_b, high_b, 1);
        reduce(low_c, high_c, 2);
    }
    for (; i < end; ++i) {
        T p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<T>(points[3 * i + k]) - origin[k];
        for (int k = 0; k < 3; ++k) {
            const T* n = directions + 3 * k;
            const T t = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
            low[k] = t < low[k] ? t : low[k];
            high[k] = t > high[k] ? t : high[k];
        }
    }
}

template <class T>
void extents_of_chunks(const T* points, std::size_t count, const unsigned char* wanted, const T* directions,
                       const T* origin, const ChunkBounds<T>& out) {
    for (std::size_t begin = 0, chunk = 0; begin < count; begin += kChunk, ++chunk) {
        if (wanted[chunk] == 0) continue;
        T low[3], high[3];
        extents(points, begin, begin + kChunk < count ? begin + kChunk : count, directions, origin, low, high);
        for (int k = 0; k < 3; ++k) {
            out.low[k][chunk] = low[k];
            out.high[k][chunk] = high[k];
        }
    }
}

void extents_float(const float* points, std::size_t count, const unsigned char* wanted, const float* directions,
                   const float* origin, const ChunkBounds<float>& out) {
    extents_of_chunks(points, count, wanted, directions, origin, out);
}
void extents_double(const double* points, std::size_t count, const unsigned char* wanted, const double* directions,
                    const double* origin, const ChunkBounds<double>& out) {
    extents_of_chunks(points, count, wanted, directions, origin, out);
}

void slabs_float(const float* points, std::size_t count, const double center[3], const double normals[9], double low[3],
                 double high[3]) {
    extents(points, 0, count, normals, center, low, high);
}
void slabs_double(const double* points, std::size_t count, const double center[3], const double normals[9],
                  double low[3], double high[3]) {
    extents(points, 0, count, normals, center, low, high);
}

template <class T>
T* copy_point(const T* point, T* kept) {
    for (int k = 0; k < 3; ++k) kept[k] = point[k];
    return kept + 3;
}

// The greatest height of a vector of points above the planes.
template <class D>
HWY_INLINE hn::Vec<D> highest(D d, const InteriorTest& test, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
    auto height = hn::Set(d, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < test.count; ++i) {
        const double* const plane = test.planes[i].data();
        const auto sum = hn::Add(hn::Add(hn::Mul(hn::Set(d, plane[0]), x), hn::Mul(hn::Set(d, plane[1]), y)),
                                 hn::Mul(hn::Set(d, plane[2]), z));
        height = hn::Max(height, hn::Sub(sum, hn::Set(d, plane[3])));
    }
    return height;
}

template <class T>
std::size_t copy_outer(const T* points, std::size_t count, const Normalisation& to, const InteriorTest& test, T* kept) {
    const hn::CappedTag<double, 8> d;
    const std::size_t lanes = hn::Lanes(d);
    T* end = kept;
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        auto x = hn::Zero(d), y = x, z = x;
        load_points(d, points + 3 * i, x, y, z);
        const auto scale = hn::Set(d, to.scale);
        x = hn::Mul(hn::Add(x, hn::Set(d, to.shift[0])), scale);
        y = hn::Mul(hn::Add(y, hn::Set(d, to.shift[1])), scale);
        z = hn::Mul(hn::Add(z, hn::Set(d, to.shift[2])), scale);
        const auto height = highest(d, test, x, y, z);
        if (hn::AllTrue(d, hn::Lt(height, hn::Zero(d)))) continue;
        HWY_ALIGN double heights[8];
        hn::Store(height, d, heights);
        for (std::size_t k = 0; k < lanes; ++k)
            if (!(heights[k] < 0.0)) end = copy_point(points + 3 * (i + k), end);
    }
    for (; i < count; ++i) end = copy_point(points + 3 * i, end);
    return static_cast<std::size_t>(end - kept) / 3;
}

std::size_t copy_outer_floats(const float* points, std::size_t count, const Normalisation& to, const InteriorTest& test,
                              float* kept) {
    return copy_outer(points, count, to, test, kept);
}
std::size_t copy_outer_doubles(const double* points, std::size_t count, const Normalisation& to,
                               const InteriorTest& test, double* kept) {
    return copy_outer(points, count, to, test, kept);
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::fit::kernels {

HWY_EXPORT(bounds_float);
HWY_EXPORT(bounds_double);
HWY_EXPORT(project_boxes);
HWY_EXPORT(extents_float);
HWY_EXPORT(extents_double);
HWY_EXPORT(slabs_float);
HWY_EXPORT(slabs_double);
HWY_EXPORT(copy_outer_floats);
HWY_EXPORT(copy_outer_doubles);

bool chunk_bounds(const float* points, std::size_t count, float limit, const ChunkBounds<float>& out) {
    return HWY_DYNAMIC_DISPATCH(bounds_float)(points, count, limit, out);
}
bool chunk_bounds(const double* points, std::size_t count, double limit, const ChunkBounds<double>& out) {
    return HWY_DYNAMIC_DISPATCH(bounds_double)(points, count, limit, out);
}
void project_boxes(const Boxes& boxes, std::size_t count, const double direction[3], double* middle, double* radius) {
    HWY_DYNAMIC_DISPATCH(project_boxes)(boxes, count, direction, middle, radius);
}

void chunk_extents(const float* points, std::size_t count, const unsigned char* wanted, const float* directions,
                   const float* origin, const ChunkBounds<float>& out) {
    HWY_DYNAMIC_DISPATCH(extents_float)(points, count, wanted, directions, origin, out);
}
void chunk_extents(const double* points, std::size_t count, const unsigned char* wanted, const double* directions,
                   const double* origin, const ChunkBounds<double>& out) {
    HWY_DYNAMIC_DISPATCH(extents_double)(points, count, wanted, directions, origin, out);
}

void slab_extents(const float* points, std::size_t count, const double center[3], const double normals[9],
                  double low[3], double high[3]) {
    HWY_DYNAMIC_DISPATCH(slabs_float)(points, count, center, normals, low, high);
}
void slab_extents(const double* points, std::size_t count, const double center[3], const double normals[9],
                  double low[3], double high[3]) {
    HWY_DYNAMIC_DISPATCH(slabs_double)(points, count, center, normals, low, high);
}

std::size_t copy_all_but_interior(const float* points, std::size_t count, const Normalisation& to,
                                  const InteriorTest& test, float* kept) {
    return HWY_DYNAMIC_DISPATCH(copy_outer_floats)(points, count, to, test, kept);
}
std::size_t copy_all_but_interior(const double* points, std::size_t count, const Normalisation& to,
                                  const InteriorTest& test, double* kept) {
    return HWY_DYNAMIC_DISPATCH(copy_outer_doubles)(points, count, to, test, kept);
}

}  // namespace crofton::fit::kernels
#endif
