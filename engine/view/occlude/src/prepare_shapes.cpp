// SPDX-License-Identifier: MIT
// Boxes and convex shapes as bodies.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "map_bounds.hpp"
#include "prepared.hpp"

namespace crofton::occlude {
namespace {

// Corner i of a box has bit k set on the + side of axis k; faces go round counter-clockwise seen from outside.
constexpr std::uint32_t kFaceCorners[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                              {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};

constexpr std::array<ShapeFace, 6> box_faces() {
    std::array<ShapeFace, 6> faces{};
    for (std::size_t f = 0; f < 6; ++f) faces[f] = {kFaceCorners[f][0], kFaceCorners[f][1], kFaceCorners[f][2]};
    return faces;
}

constexpr std::array<ShapeEdge, 12> box_edges() {
    std::array<ShapeEdge, 12> edges{};
    std::size_t count = 0;
    for (std::uint32_t f = 0; f < 6; ++f)
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint32_t a = kFaceCorners[f][i], b = kFaceCorners[f][(i + 1) % 4];
            if (a > b) continue;
            for (std::uint32_t g = 0; g < 6; ++g)
                for (std::size_t j = 0; j < 4; ++j)
                    if (kFaceCorners[g][j] == b && kFaceCorners[g][(j + 1) % 4] == a) edges[count++] = {a, b, f, g};
        }
    return edges;
}

constexpr auto kBoxFaces = box_faces();
constexpr auto kBoxEdges = box_edges();

// One form at a box's corners: at its middle, and along its half edges.
struct BoxForm {
    double middle, edge[3], size;

    BoxForm(const double (&form)[4], const double (&d)[3], const double (&e)[3][3]) {
        middle = form[0] * d[0] + form[1] * d[1] + form[2] * d[2] + form[3];
        size = std::fabs(form[0] * d[0]) + std::fabs(form[1] * d[1]) + std::fabs(form[2] * d[2]) + std::fabs(form[3]);
        for (int k = 0; k < 3; ++k) {
            edge[k] = form[0] * e[k][0] + form[1] * e[k][1] + form[2] * e[k][2];
            size += std::fabs(form[0] * e[k][0]) + std::fabs(form[1] * e[k][1]) + std::fabs(form[2] * e[k][2]);
        }
    }
    [[nodiscard]] double at(std::size_t corner) const {
        return middle + ((corner & 1u ? edge[0] : -edge[0]) + (corner & 2u ? edge[1] : -edge[1])) +
               (corner & 4u ? edge[2] : -edge[2]);
    }
};

[[nodiscard]] bool is_beyond_cuts(const PixelMap& map, const MapSizes& sizes, const MappedPoint& p) {
    bool beyond = p.form[2] >= map.least_w;
    for (int c = 0; c < map.cut_count; ++c) beyond = beyond && p.cut[c] > kMapError * sizes.cut[c];
    return beyond;
}

// How far points are behind a plane at most, in nearness: the largest of line(column, row) − z / w, rounded up. Between
// the points it is no larger, as it is their mean then, weighted by w.
[[nodiscard]] double most_behind(const PlacedPoints& placed, const Line& line) {
    const auto& size = placed.sizes.form;
    // The forms are off by kMapError; four products and three sums round, of terms within the same sizes.
    const double error =
        2.0 * kMapError *
        (size[3] + std::fabs(line.x) * size[0] + std::fabs(line.y) * size[1] + std::fabs(line.w) * size[2]);
    double most = 0.0;
    for (const MappedPoint& p : placed.points) {
        const double behind = line.x * p.form[0] + line.y * p.form[1] + line.w * p.form[2] - p.form[3] + error;
        const double w = p.form[2] - 2.0 * kMapError * size[2];
        if (!(w > 0.0)) return HUGE_VAL;
        most = std::max(most, behind / w);
    }
    return most * (1.0 + 0x1p-50);
}

}  // namespace

void prepare_box(const PixelMap& map, const Obb& box, OccluderId occluder, PreparedBodies& out) {
    double d[3], e[3][3];
    for (int j = 0; j < 3; ++j) {
        d[j] = box.center[j] - map.origin[j];
        for (int k = 0; k < 3; ++k)
            e[k][j] = static_cast<double>(box.axes[k][j]) * static_cast<double>(box.half_extents[k]);
    }
    MappedPoint points[8];
    MapSizes sizes;
    for (std::size_t r = 0; r < 4; ++r) {
        const BoxForm form(map.form[r], d, e);
        sizes.form[r] = form.size;
        for (std::size_t i = 0; i < 8; ++i) points[i].form[r] = form.at(i);
    }
    for (int c = 0; c < map.cut_count; ++c) {
        const BoxForm form(map.cuts[c].form, d, e);
        sizes.cut[c] = form.size;
        for (std::size_t i = 0; i < 8; ++i) points[i].cut[c] = form.at(i);
    }
    const bool left_handed = glm::determinant(box.axes) < 0.0f;
    prepare(map, {points, kBoxFaces, kBoxEdges, sizes, left_handed != map.mirrored}, occluder, out);
}

PlacedPoints map_points(const PixelMap& map, const Shape& shape, const Transform& transform,
                        Vector<MappedPoint>& points) {
    PlacedPoints result{};
    points.resize(shape.points.size());
    const glm::dvec3 d = transform.translation - glm::dvec3(map.origin[0], map.origin[1], map.origin[2]);
    const auto max_abs = static_cast<double>(shape.max_abs);
    const auto map_all = [&](const double(&form)[4], const auto& number_of) {
        double row[4] = {0.0, 0.0, 0.0, form[3]}, size = std::fabs(form[3]);
        for (int j = 0; j < 3; ++j) {
            row[3] += form[j] * d[j];
            size += std::fabs(form[j] * d[j]);
            for (int k = 0; k < 3; ++k) {
                row[k] += form[j] * transform.linear[k][j];
                size += std::fabs(form[j] * transform.linear[k][j]) * max_abs;
            }
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec3 p(shape.points[i]);
            number_of(points[i]) = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
        }
        return size;
    };
    for (std::size_t r = 0; r < 4; ++r)
        result.sizes.form[r] = map_all(map.form[r], [r](MappedPoint& p) -> double& { return p.form[r]; });
    for (std::size_t c = 0; c < static_cast<std::size_t>(map.cut_count); ++c)
        result.sizes.cut[c] = map_all(map.cuts[c].form, [c](MappedPoint& p) -> double& { return p.cut[c]; });
    result.points = points;
    return result;
}

void prepare_convex(const PixelMap& map, const Shape& shape, const Transform& transform, bool mirrored,
                    OccluderId occluder, PreparedBodies& out) {
    const PlacedPoints placed = map_points(map, shape, transform, out.points);
    prepare(map, {placed.points, shape.faces, shape.edges, placed.sizes, mirrored != map.mirrored}, occluder, out);
}

bool prepare_polygon(const PixelMap& map, const Shape& shape, const PlacedPoints& placed, bool mirrored,
                     OccluderId occluder, PreparedBodies& out) {
    for (const MappedPoint& p : placed.points)
        if (!is_beyond_cuts(map, placed.sizes, p)) return false;
    Bounds bounds(map, placed.sizes);
    bounds.nearness = 0.0;  // of errors, which are not asked for
    std::size_t seen = 0;
    Line widest{};
    for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
        const auto corner = [&](std::size_t k) -> const MappedPoint& {
            return placed.points[shape.triangles[3 * t + (mirrored ? (3 - k) % 3 : k)]];
        };
        FacePlane plane;
        if (!find_plane(corner(0), corner(1), corner(2), bounds, plane)) continue;
        if (t == 0) widest = plane.nearness;
        ++seen;
    }
    if (seen == 0) return true;  // it shows its other side
    if (seen < shape.triangle_count()) return false;
    const std::uint32_t* const t = shape.triangles.data();
    const ShapeFace face{t[0], t[1], t[2]};
    Body body{placed.points, {&face, 1}, shape.outline, placed.sizes, mirrored};
    body.behind = most_behind(placed, widest);
    prepare(map, body, occluder, out);
    return true;
}

}  // namespace crofton::occlude
