// SPDX-License-Identifier: MIT
// The volume from which shadows fall into a view.
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/moderate_length.hpp>
#include <glm/geometric.hpp>

namespace crofton::cull {
namespace {

// `at_light[i]` is plane i's value at the light, a point or a direction: the sign says on which side it is.
Result<Frustum> toward(const Frustum& view, const double (&at_light)[Frustum::kMaxPlanes]) {
    Frustum volume;
    volume.origin = view.origin;
    const auto add = [&](const glm::dvec3& normal, double offset) {
        const double length = glm::length(normal);
        // Opposite planes cancel: what is left of their sum holds everywhere.
        if (length > 1e-12) volume.planes[volume.plane_count++] = {normal / length, offset / length};
    };
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        if (at_light[i] < 0.0) continue;
        const Plane& kept = view.planes[i];
        add(kept.normal, kept.offset);
        for (std::uint32_t j = 0; j < view.plane_count; ++j) {
            if (at_light[j] >= 0.0 || at_light[i] == 0.0) continue;
            const double sum = at_light[i] - at_light[j];
            const double a = -at_light[j] / sum, b = at_light[i] / sum;
            add(a * kept.normal + b * view.planes[j].normal, a * kept.offset + b * view.planes[j].offset);
        }
    }
    if (volume.plane_count == 0)
        return fail(ErrorCode::degenerate, kNoItem, "shadow volume: the light sees into the view from everywhere");
    return volume;
}

Result<void> check(const Frustum& view, const glm::dvec3& light) {
    if (!is_finite(light)) return fail(ErrorCode::non_finite, kNoItem, "shadow volume: the light is NaN or infinite");
    if (view.plane_count > 6)
        return fail(ErrorCode::invalid_argument, kNoItem, "shadow volume: a view of at most 6 planes is needed");
    return {};
}

}  // namespace

Result<Frustum> shadow_volume(const Frustum& view, const glm::dvec3& toward_light) {
    if (auto valid = check(view, toward_light); !valid) return valid.error();
    const glm::dvec3 direction = of_moderate_length(toward_light);
    const double length = glm::length(direction);
    if (!(length > 0.0))
        return fail(ErrorCode::degenerate, kNoItem, "shadow volume: the direction of the light is zero");
    double at_light[Frustum::kMaxPlanes] = {};
    for (std::uint32_t i = 0; i < view.plane_count; ++i)
        at_light[i] = glm::dot(view.planes[i].normal, direction / length);
    return toward(view, at_light);
}

Result<Frustum> shadow_volume_of_point(const Frustum& view, const glm::dvec3& light_position) {
    if (auto valid = check(view, light_position); !valid) return valid.error();
    double at_light[Frustum::kMaxPlanes] = {};
    for (std::uint32_t i = 0; i < view.plane_count; ++i)
        at_light[i] = glm::dot(view.planes[i].normal, light_position - view.origin) + view.planes[i].offset;
    return toward(view, at_light);
}

}  // namespace crofton::cull
