// A view as the vector kernels read it: plain numbers, no GLM.
#pragma once
#include <cstdint>

namespace crofton::cull {

struct KernelPlane {
    double normal[3];
    double offset;
    float normal_f[3];  // normal, rounded
};

struct KernelView {
    static constexpr unsigned kMaxPlanes = 12;
    double origin[3];
    KernelPlane planes[kMaxPlanes];
    std::uint32_t plane_count;
    std::uint32_t layer_mask;
};

// A plane as seen from a block's origin o: value(x) = normal_f · x + offset for x relative to o, and the bound on what
// that, with the reach added or taken away, is off from the exact value for |x| + box ≤ reach (sums over the axes).
// Error, u = 2^-24: the normal's and the offset's rounding, the products' and at most seven additions' 1u each of reach
// + |offset|, 10u in all, doubled; the offset itself is computed in double, off by at most 8 · 2^-53 of the sizes of
// its terms.
struct LocalPlane {
    float normal[3];
    float offset;
    float slack;
};

inline LocalPlane local_plane(const KernelPlane& plane, const double* view_origin, const double* origin, float reach) {
    const double dx = origin[0] - view_origin[0], dy = origin[1] - view_origin[1], dz = origin[2] - view_origin[2];
    const double x = plane.normal[0] * dx, y = plane.normal[1] * dy, z = plane.normal[2] * dz;
    const double offset = x + y + z + plane.offset;
    const auto magnitude = [](double v) { return v < 0.0 ? -v : v; };
    const double size = magnitude(x) + magnitude(y) + magnitude(z) + magnitude(plane.offset);
    const double slack = 0x1p-49 * size + 20.0 * 0x1p-24 * (static_cast<double>(reach) + magnitude(offset)) + 1e-37;
    return {{plane.normal_f[0], plane.normal_f[1], plane.normal_f[2]},
            static_cast<float>(offset),
            static_cast<float>(slack * 1.000001)};
}

}  // namespace crofton::cull
