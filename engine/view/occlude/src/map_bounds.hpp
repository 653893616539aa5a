// SPDX-License-Identifier: MIT
// Bounds the rounding of lines and planes through mapped points (derived in docs/notes/occlude.md).
#pragma once
#include "prepared.hpp"

namespace crofton::occlude {

struct Vec3 {
    double x, y, w;
};

[[nodiscard]] inline Vec3 cross(const MappedPoint& a, const MappedPoint& b) {
    return {a.form[1] * b.form[2] - a.form[2] * b.form[1], a.form[2] * b.form[0] - a.form[0] * b.form[2],
            a.form[0] * b.form[1] - a.form[1] * b.form[0]};
}
[[nodiscard]] inline double dot(const Vec3& v, const MappedPoint& p) {
    return v.x * p.form[0] + v.y * p.form[1] + v.w * p.form[2];
}

// The bounds of docs/notes/occlude.md, all for one body.
struct Bounds {
    double determinant;  // of three points
    double line;         // of a line through two points, at a point of the window
    double plane;        // of a plane of depth times its determinant, at a point of the window
    double nearness;     // ≥ |z / w| in the window

    Bounds(const PixelMap& map, const MapSizes& sizes) {
        const double x = sizes.form[0], y = sizes.form[1], w = sizes.form[2], z = sizes.form[3];
        // Each of a determinant's six products is off by 3 kMapError and its rounding: 4 kMapError.
        determinant = 40.0 * kMapError * x * y * w;
        const double window = y * w * map.half_width + x * w * map.half_height + x * y;
        line = 10.0 * kMapError * window;
        plane = 100.0 * kMapError * z * window;
    }
};

// An unnormalised half-plane: x · column + y · row + w ≥ 0 in pixels from the middle.
struct Line {
    double x, y, w;
};

// The plane of a face: nearness = line at a point of the picture, within `error` in the window.
struct FacePlane {
    Line nearness;
    double error;
    double determinant;  // twice the area in the picture, times w of all three corners; off by half at most
};

// False unless a, b, c are certainly counter-clockwise in the picture.
[[nodiscard]] inline bool find_plane(const MappedPoint& a, const MappedPoint& b, const MappedPoint& c,
                                     const Bounds& bounds, FacePlane& plane) {
    const Vec3 bc = cross(b, c);
    const double determinant = dot(bc, a);
    if (!(determinant > 2.0 * bounds.determinant)) return false;
    plane.determinant = determinant;
    const Vec3 ca = cross(c, a), ab = cross(a, b);
    const double inverse = 1.0 / determinant;
    const double za = a.form[3] * inverse, zb = b.form[3] * inverse, zc = c.form[3] * inverse;
    plane.nearness = {za * bc.x + zb * ca.x + zc * ab.x, za * bc.y + zb * ca.y + zc * ab.y,
                      za * bc.w + zb * ca.w + zc * ab.w};
    plane.error = (bounds.plane + bounds.nearness * bounds.determinant) * inverse;
    return true;
}

}  // namespace crofton::occlude
