// SPDX-License-Identifier: MIT
// Draw limits for one item, and as the vector kernels read them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/dyadic.hpp>
#include <crofton/geometry/trigonometry.hpp>

#include "exact/box_constraints.hpp"
#include "limits/limits.hpp"

namespace crofton::cull {
namespace {

// Is |to − from| > factor · limit · |sizes|? Of the squares, with u = 2^-53, either side has less than ten roundings of
// at most its own size each.
bool exceeds(const glm::dvec3& from, const glm::dvec3& to, double limit, double factor, const glm::dvec3& sizes) {
    const glm::dvec3 d = to - from;
    const double scale = limit * factor;
    const double left = d.x * d.x + d.y * d.y + d.z * d.z;
    const double right = scale * scale * (sizes.x * sizes.x + sizes.y * sizes.y + sizes.z * sizes.z);
    const double bound = 16.0 * kUnit * (left + right) + kTiny;
    if (left - right > bound) return true;
    if (left - right < -bound) return false;
    Dyadic exact_left, exact_right;
    for (int j = 0; j < 3; ++j) {
        const Dyadic step = Dyadic(to[j]) - Dyadic(from[j]), size(sizes[j]);
        exact_left = exact_left + step * step;
        exact_right = exact_right + size * size;
    }
    const Dyadic exact_scale = Dyadic(limit) * Dyadic(factor);
    return (exact_left - exact_scale * exact_scale * exact_right).sign() > 0;
}

constexpr glm::dvec3 kOne{1.0, 0.0, 0.0};

// A sphere around `center`, of the radius |half|.
bool is_sphere_within(const DrawLimits& limits, const glm::dvec3& center, const glm::dvec3& half, boxtree::ItemId item,
                      double layer_limit) {
    if (!is_usable(Sphere{limits.eye, 0.0})) return true;
    const double factor = factor_of(limits, item);
    const auto is_beyond = [&](double limit, const glm::dvec3& sizes) {
        return counts(limit) && exceeds(limits.eye, center, std::max(0.0, limit), factor, sizes);
    };
    // r < least as least > factor · r: the same test with the sides exchanged.
    if (counts(limits.least_radius) && limits.least_radius > 0.0 &&
        exceeds(glm::dvec3(0.0), glm::dvec3(limits.least_radius, 0.0, 0.0), 1.0, factor, half))
        return false;
    if (is_beyond(limits.max_distance_in_radii, half)) return false;
    if (item < limits.item_distances.size() && is_beyond(static_cast<double>(limits.item_distances[item]), kOne))
        return false;
    return !is_beyond(layer_limit, kOne);
}

// Whether the limit's square is safe from overflow and underflow in float.
bool is_moderate_limit(double value) {
    return value == 0.0 || (value >= 1e-18 && value <= 1e18);
}

}  // namespace

KernelLimits kernel_limits_of(const DrawLimits& limits) {
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    const double longer = std::min(std::max(1.0, limits.hysteresis), kMaxCoordinate),
                 radii = std::max(0.0, limits.max_distance_in_radii), least = limits.least_radius;
    KernelLimits result{};
    for (int j = 0; j < 3; ++j) result.eye[j] = limits.eye[j];
    // Radii are at least 1e-18 in floats: up to 1e9 of them are a length that is truly too long.
    const bool is_eye = is_usable(Sphere{limits.eye, 0.0});  // otherwise no limit counts
    const bool has_radii = is_eye && counts(limits.max_distance_in_radii), radii_fit = radii * longer <= 1e9;
    result.radii[0] = !has_radii ? kEndless : radii_fit ? static_cast<float>(radii * radii) : 0.0f;
    result.radii[1] = has_radii && radii_fit ? static_cast<float>(radii * longer * (radii * longer)) : kEndless;
    const bool has_least = is_eye && counts(least) && least > 0.0, least_fits = is_moderate_limit(least);
    result.least_radius[0] = !has_least ? 0.0f : least_fits ? static_cast<float>(least * least) : kEndless;
    result.least_radius[1] = has_least && least_fits ? static_cast<float>(least / longer * (least / longer)) : 0.0f;
    result.has_layers = is_eye && limits.layer_distances.size() >= 32;
    result.has_items = is_eye && !limits.item_distances.empty();
    result.layer_square = [](const void* of, std::uint32_t common_layers, bool least_of_all) {
        const auto& from = *static_cast<const DrawLimits*>(of);
        const double limit =
            least_of_all ? least_limit_in_layers(from, common_layers) : limit_in_layers(from, common_layers);
        if (counts(limit) && !is_moderate_limit(limit)) return std::numeric_limits<float>::quiet_NaN();
        return static_cast<float>(limit * limit);
    };
    result.limits = &limits;
    result.longer_square = static_cast<float>(longer * longer);
    return result;
}

double limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers) {
    if (limits.layer_distances.size() < 32) return DrawLimits::kNone;
    double result = 0.0;
    for (; common_layers; common_layers &= common_layers - 1) {
        const float distance = limits.layer_distances[static_cast<std::size_t>(std::countr_zero(common_layers))];
        if (!counts(static_cast<double>(distance))) return DrawLimits::kNone;
        result = std::max(result, static_cast<double>(distance));
    }
    return result;
}

double least_limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers) {
    if (limits.layer_distances.size() < 32) return DrawLimits::kNone;
    double result = DrawLimits::kNone;
    for (; common_layers; common_layers &= common_layers - 1) {
        const auto layer = static_cast<std::size_t>(std::countr_zero(common_layers));
        const auto distance = static_cast<double>(limits.layer_distances[layer]);
        if (counts(distance)) result = std::min(result, std::max(0.0, distance));
    }
    return result;
}

bool is_worth_drawing(const DrawLimits& limits, const Obb& box, boxtree::ItemId item, std::uint32_t common_layers) {
    return is_within_limits(limits, box, item, limit_in_layers(limits, common_layers));
}
bool is_worth_drawing(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item, std::uint32_t common_layers) {
    return is_within_limits(limits, box, item, limit_in_layers(limits, common_layers));
}
bool is_worth_drawing(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item,
                      std::uint32_t common_layers) {
    return is_within_limits(limits, sphere, item, limit_in_layers(limits, common_layers));
}

bool is_within_limits(const DrawLimits& limits, const Obb& box, boxtree::ItemId item, double layer_limit) {
    return !is_usable(box) || is_sphere_within(limits, box.center, glm::dvec3(box.half_extents), item, layer_limit);
}
bool is_within_limits(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item, double layer_limit) {
    const glm::dvec3 center = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
    return !is_usable(box) || is_sphere_within(limits, center, half, item, layer_limit);
}
bool is_within_limits(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item, double layer_limit) {
    const glm::dvec3 size(sphere.radius, 0.0, 0.0);
    return !is_usable(sphere) || is_sphere_within(limits, sphere.center, size, item, layer_limit);
}

Result<DrawLimits> limits_of(const Camera& camera, double picture_height, double pixels) {
    if (auto valid = validate(camera); !valid) return valid.error();
    const auto is_positive = [](double value) { return value > 0.0 && value <= kMaxCoordinate; };
    if (!is_positive(picture_height) || !is_positive(pixels))
        return fail(ErrorCode::out_of_range, kNoItem,
                    "draw limits: the picture's height and the least size must be positive, in pixels");
    DrawLimits result;
    result.eye = camera.position;
    if (camera.projection == Projection::orthographic) {
        result.least_radius = 0.5 * pixels * camera.height / picture_height;
        return result;
    }
    // A sphere's outline at distance d: 2 f r / √(d² − r²) pixels wide, f = height / (2 tan(fov / 2)).
    const double ratio = picture_height / (tangent(0.5 * camera.fov_y) * pixels);
    result.max_distance_in_radii = std::sqrt(1.0 + ratio * ratio);
    return result;
}

}  // namespace crofton::cull
