// SPDX-License-Identifier: MIT
// The cascades of the sun's shadow: where the view is split, and a camera around each part.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/cull/lights.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/moderate_length.hpp>
#include <glm/geometric.hpp>

#include "lights/power.hpp"

namespace crofton::cull {
namespace {

// A rectangle in the plane of two axes; `side` is the direction of its first side in these axes.
struct TurnedRectangle {
    glm::dvec2 side{1.0, 0.0}, low{0.0}, high{0.0};
    [[nodiscard]] double area() const { return (high.x - low.x) * (high.y - low.y); }
};

TurnedRectangle rectangle_along(const std::array<glm::dvec2, 8>& points, const glm::dvec2& side) {
    TurnedRectangle result{side, glm::dvec2(1e300), glm::dvec2(-1e300)};
    for (const glm::dvec2& p : points) {
        const glm::dvec2 at(glm::dot(p, side), side.x * p.y - side.y * p.x);
        result.low = (glm::min)(result.low, at);
        result.high = (glm::max)(result.high, at);
    }
    return result;
}

// The smallest one has a side along an edge of the points' hull (Freeman, Shapira 1975): all pairs have it among them.
TurnedRectangle smallest_rectangle(const std::array<glm::dvec2, 8>& points) {
    TurnedRectangle best = rectangle_along(points, {1.0, 0.0});
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            const glm::dvec2 edge = points[j] - points[i];
            const double length = glm::length(edge);
            if (!(length > 0.0)) continue;
            const TurnedRectangle one = rectangle_along(points, edge / length);
            if (one.area() < best.area()) best = one;
        }
    return best;
}

}  // namespace

Result<void> split_depths(double near, double far, double share, std::span<double> splits) {
    const auto bad = [](const char* why) { return fail(ErrorCode::out_of_range, kNoItem, {"splits: ", why}); };
    if (splits.size() < 2) return bad("two places or more are needed, one more than there are cascades");
    if (!(near > 0.0) || !(far > near) || !std::isfinite(far) || !std::isfinite(far / near))
        return bad("0 < near < far, finite as their ratio, is needed");
    if (!(share >= 0.0 && share <= 1.0)) return bad("the share must be in [0, 1]");
    const std::size_t count = splits.size() - 1;
    for (std::size_t i = 0; i <= count; ++i) {
        const double at = static_cast<double>(i) / static_cast<double>(count);
        splits[i] = share * near * power(far / near, at) + (1.0 - share) * (near + at * (far - near));
    }
    splits.front() = near;
    splits.back() = far;
    return {};
}

Result<Camera> cascade_camera(const Camera& camera, double near, double far, const glm::dvec3& toward_light,
                              double caster_distance) {
    Camera part = camera;
    part.near_distance = near;
    part.far_distance = far;
    const Result<Frustum> frustum = frustum_of(part);
    if (!frustum) return frustum.error();
    const Result<std::array<glm::dvec3, 8>> corners = frustum_corners(*frustum);
    if (!corners) return corners.error();
    if (!is_finite(toward_light) || toward_light == glm::dvec3(0.0))
        return fail(ErrorCode::degenerate, kNoItem, "cascade: the direction of the light is zero or not finite");
    if (!(caster_distance >= 0.0) || !std::isfinite(caster_distance))
        return fail(ErrorCode::out_of_range, kNoItem, "cascade: the distance of casters must be at least 0 and finite");
    Camera light;
    light.projection = Projection::orthographic;
    light.forward = -glm::normalize(of_moderate_length(toward_light));
    const glm::dvec3 a = glm::abs(light.forward);
    const glm::dvec3 other = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                             : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                      : glm::dvec3(0, 0, 1);
    const glm::dvec3 across = glm::normalize(glm::cross(light.forward, other)), up = glm::cross(across, light.forward);
    std::array<glm::dvec2, 8> points;
    double first = 1e300, last = -1e300;
    for (std::size_t c = 0; c < 8; ++c) {
        points[c] = {glm::dot((*corners)[c], across), glm::dot((*corners)[c], up)};
        const double along = glm::dot((*corners)[c], light.forward);
        first = std::min(first, along);
        last = std::max(last, along);
    }
    const TurnedRectangle best = smallest_rectangle(points);
    const glm::dvec3 side = best.side.x * across + best.side.y * up, top = best.side.x * up - best.side.y * across;
    // Slightly larger than the visible part, so that its rounded planes contain it.
    const glm::dvec2 size = best.high - best.low, middle = best.low + 0.5 * size;
    const double trifle = 0x1p-30 * (glm::length((*corners)[7]) + size.x + size.y);
    light.up = top;
    light.height = size.y + 2.0 * trifle;
    light.aspect = (size.x + 2.0 * trifle) / light.height;
    light.position = frustum->origin + middle.x * side + middle.y * top + (first - caster_distance) * light.forward;
    light.near_distance = 0.0;
    light.far_distance = last - first + caster_distance + 2.0 * trifle;
    light.position -= trifle * light.forward;
    return light;
}

}  // namespace crofton::cull
