// SPDX-License-Identifier: MIT
#include "pixel_map.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace crofton::occlude {
namespace {

// Bounds from above the nearness of a point on the plane in the window, the view's rim included.
double most_nearness_on(const CutPlane& cut, const PixelMap& map) {
    const double most = std::fabs(cut.column) * map.half_width + std::fabs(cut.row) * map.half_height + cut.constant;
    return most / -cut.nearness;
}

CutPlane cut_of(const PixelMap& map, const double (&form)[4]) {
    // The plane as a combination of the four forms.
    glm::dmat4 forms(0.0);
    for (int r = 0; r < 4; ++r)
        for (int k = 0; k < 4; ++k) forms[r][k] = map.form[r][k];
    const glm::dvec4 parts = glm::inverse(forms) * glm::dvec4(form[0], form[1], form[2], form[3]);
    CutPlane cut{parts[0], parts[1], parts[2], parts[3], {}};
    std::copy_n(form, 4, cut.form);
    return cut;
}

}  // namespace

PixelMap pixel_map_of(const OcclusionView& view, std::uint32_t width, std::uint32_t height) {
    PixelMap map{};
    map.width = width;
    map.height = height;
    map.half_width = 0.5 * width;
    map.half_height = 0.5 * height;
    map.perspective = view.perspective;
    map.least_w = view.least_w;
    for (int k = 0; k < 3; ++k) map.origin[k] = view.origin[k];
    const double scales[4] = {map.half_width - PixelMap::kGuard, map.half_height - PixelMap::kGuard, 1.0, 1.0};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t k = 0; k < 4; ++k) map.form[r][k] = scales[r] * view.rows[r][k];
    const auto vector = [&](int r) { return glm::dvec3(map.form[r][0], map.form[r][1], map.form[r][2]); };
    const glm::dvec3 away = view.perspective ? vector(2) : -vector(3);
    map.mirrored = glm::dot(glm::cross(vector(0), vector(1)), away) > 0.0;

    const Plane& near_plane = view.frustum.planes[4];
    const double offset = near_plane.offset + glm::dot(near_plane.normal, view.origin - view.frustum.origin);
    map.cuts[map.cut_count++] = cut_of(map, {near_plane.normal.x, near_plane.normal.y, near_plane.normal.z, offset});
    // An oblique near plane may let points pass whose w is not positive.
    const CutPlane& first = map.cuts[0];
    const bool oblique = std::fabs(first.column) * map.half_width + std::fabs(first.row) * map.half_height >
                         1e-9 * std::fabs(first.constant);
    if (view.perspective && oblique)
        map.cuts[map.cut_count++] =
            cut_of(map, {map.form[2][0], map.form[2][1], map.form[2][2], map.form[2][3] - map.least_w});
    map.most_nearness = most_nearness_on(map.cuts[0], map);
    if (view.perspective) map.most_nearness = std::min(map.most_nearness, 1.0 / map.least_w);
    map.most_nearness += 1e-6 * std::fabs(map.most_nearness);
    return map;
}

}  // namespace crofton::occlude
