// SPDX-License-Identifier: MIT
// A view as the vector kernels read it: plain numbers, no GLM.
#pragma once
#include <cmath>
#include <crofton/boxtree/layout.hpp>
#include <cstdint>
#include <cstdlib>

namespace crofton::cull {

struct KernelPlane {
    double normal[3];
    double offset;
    float normal_f[3];  // normal, rounded
    float length_f;     // of normal, within 2^-23; for queries of spheres
};

// A normal in units of 2^-14, rounded to the nearest, as pairs of 16-bit integers.
struct PairPlane {
    std::uint32_t xy, z;            // the upper half of z is 0
    std::uint32_t size_xy, size_z;  // the absolute values; the lower half of size_z is 0
};

// Rounds to the nearest integer, without a call of the C library.
inline PairPlane pair_plane_of(const double* normal) {
    int n[3];
    for (int j = 0; j < 3; ++j) {
        const double scaled = normal[j] * 0x1p14;
        n[j] = std::fabs(scaled) < 0x1p16 ? static_cast<int>(scaled + std::copysign(0.5, scaled)) : 0;
    }
    return {boxtree::pair_of(n[0], n[1]), boxtree::pair_of(n[2], 0), boxtree::pair_of(std::abs(n[0]), std::abs(n[1])),
            boxtree::pair_of(0, std::abs(n[2]))};
}

// Where a view is, in the coordinates of the boxes. Moved trees share a view's planes, and have a place each.
struct ViewPlace {
    static constexpr unsigned kMaxPlanes = 12;
    double origin[3];
    double far[kMaxPlanes];  // what a plane's value at a block's origin may be off by (block_planes.hpp)
};

struct KernelView : ViewPlace {
    KernelPlane planes[kMaxPlanes];
    PairPlane pair_planes[kMaxPlanes];  // for queries of a tree
    std::uint32_t plane_count;
    std::uint32_t layer_mask;
};

// The origin of a block of boxes relative to the view's.
struct LocalOrigin {
    double d[3];
    double size;       // Σ|d|
    double l1_radius;  // ≥ |x| + extent, summed over the axes, of all that lies in the block
};

inline LocalOrigin local_origin(const ViewPlace& view, const double* origin, float l1_radius) {
    LocalOrigin result;
    for (int j = 0; j < 3; ++j) result.d[j] = origin[j] - view.origin[j];
    result.size = std::fabs(result.d[0]) + std::fabs(result.d[1]) + std::fabs(result.d[2]);
    result.l1_radius = static_cast<double>(l1_radius);
    return result;
}

// A plane as seen from the block's origin: value(x) = normal_f · x + offset, for x relative to it. `error_bound` bounds
// how far that, with a box's projected radius added or taken away, is from the exact value. With u = 2^-24, the
// roundings of the normal, of the offset, of the products and of at most seven additions cost u each, of l1_radius +
// |offset|. That is 10u in all, doubled here. The offset itself is computed in double: seven roundings of 2^-53 of size
// + |plane offset| each, |normal| ≤ 1.001 per component; 2^-49.
struct LocalPlane {
    float offset;
    float error_bound;
};

inline LocalPlane local_plane(const KernelPlane& plane, const LocalOrigin& at) {
    const double offset =
        plane.normal[0] * at.d[0] + plane.normal[1] * at.d[1] + plane.normal[2] * at.d[2] + plane.offset;
    const double error_bound =
        0x1p-49 * (at.size + std::fabs(plane.offset)) + 0x1.4p-20 * (at.l1_radius + std::fabs(offset)) + 1e-37;
    return {static_cast<float>(offset), static_cast<float>(error_bound)};
}

}  // namespace crofton::cull
