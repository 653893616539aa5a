// SPDX-License-Identifier: MIT
// The grid of froxels over a view.
#include <algorithm>
#include <cmath>
#include <crofton/cull/lights.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <numbers>

#include "lights/froxel_kernel.hpp"
#include "lights/power.hpp"

namespace crofton::cull {
namespace {

constexpr double kLargest = 1e12, kSmallest = 1e-9;
constexpr std::uint32_t kMostAlongAxis = 1024;

// Exact arithmetic has room for numbers down to 2^-60 (exact/spot.hpp).
double without_trifles(double value) {
    return std::fabs(value) < 0x1p-60 ? 0.0 : value;
}
Plane plane_of(const glm::dvec3& normal, double offset) {
    return {{without_trifles(normal.x), without_trifles(normal.y), without_trifles(normal.z)}, without_trifles(offset)};
}

Result<void> check_grid(const Camera& camera, const FroxelOptions& options) {
    if (auto valid = validate(camera); !valid) return valid;
    const auto bad = [](ErrorCode code, const char* why) { return fail(code, kNoItem, {"froxels: ", why}); };
    for (const std::uint32_t size : {options.columns, options.rows, options.slices})
        if (size == 0 || size > kMostAlongAxis)
            return bad(ErrorCode::out_of_range, "columns, rows and slices must be 1 to 1024");
    for (int j = 0; j < 3; ++j)
        if (!(std::fabs(camera.position[j]) <= kLargest))
            return bad(ErrorCode::out_of_range, "the camera's position must not be beyond 1e12");
    const bool perspective = camera.projection == Projection::perspective;
    if (!perspective && !(camera.height * std::max(1.0, camera.aspect) <= kLargest &&
                          camera.height * std::min(1.0, camera.aspect) >= kSmallest))
        return bad(ErrorCode::out_of_range, "the view's height and width must be 1e-9 to 1e12");
    const double widest = 88.0 / 180.0 * std::numbers::pi;
    if (perspective && !(0.5 * camera.fov_y <= widest &&
                         tangent(0.5 * camera.fov_y) * camera.aspect <= tangent(widest) && camera.aspect >= kSmallest))
        return bad(ErrorCode::out_of_range, "the view must not be wider or higher than 176 degrees");
    if (options.depths.empty() && !std::isfinite(camera.far_distance))
        return bad(ErrorCode::invalid_argument, "far is infinite; give the slices' depths");
    if (!options.depths.empty() && options.depths.size() != std::size_t{options.slices} + 1)
        return bad(ErrorCode::invalid_argument, "slices + 1 depths are needed, or none");
    return {};
}

Result<void> check_depths(std::span<const double> depths, bool perspective) {
    for (std::size_t k = 0; k < depths.size(); ++k) {
        const auto bad = [&](const char* why) { return fail(ErrorCode::out_of_range, k, {"froxels: depth ", k, why}); };
        if (!(std::fabs(depths[k]) <= kLargest)) return bad(" is not finite or beyond 1e12");
        if (perspective && !(depths[k] >= kSmallest)) return bad(" is below 1e-9; in perspective depths are positive");
        if (k > 0 && !(depths[k] - depths[k - 1] >= 0x1p-20 * std::fabs(depths[k]) && depths[k] > depths[k - 1]))
            return bad(" is not beyond the one before it; use fewer slices, or depths further apart");
    }
    return {};
}

}  // namespace

Result<FroxelGrid> FroxelGrid::build(const Camera& camera, const FroxelOptions& options) {
    if (auto valid = check_grid(camera, options); !valid) return valid.error();
    const bool perspective = camera.projection == Projection::perspective;
    FroxelGrid grid;
    const std::uint32_t size[3] = {options.columns, options.rows, options.slices};
    grid.origin_ = camera.position;
    const glm::dmat3 rotation = world_to_view_rotation(camera);
    for (int k = 0; k < 3; ++k)
        grid.axes_[k] = (k == 2 ? -1.0 : 1.0) * glm::dvec3(rotation[0][k], rotation[1][k], rotation[2][k]);
    grid.depths_.assign(options.depths.begin(), options.depths.end());
    const double near = camera.near_distance, far = camera.far_distance;
    for (std::uint32_t k = 0; options.depths.empty() && k <= size[2]; ++k) {
        const double share = static_cast<double>(k) / size[2];
        grid.depths_.push_back(k == size[2]  ? far
                               : perspective ? near * power(far / near, share)
                                             : near + share * (far - near));
    }
    if (auto valid = check_depths(grid.depths_, perspective); !valid) return valid.error();

    grid.doubles_.assign(FroxelArrays<double>::length(size), 0.0);
    double* to = grid.doubles_.data();
    const double half_y = perspective ? tangent(0.5 * camera.fov_y) : 0.5 * camera.height;
    for (unsigned axis = 0; axis < 2; ++axis) {
        const double half = axis == 0 ? half_y * camera.aspect : half_y;
        const std::size_t stride = size[axis] + 1 + kFroxelPadding;
        for (std::size_t i = 0; i < stride; ++i) {
            const double share = 2.0 * static_cast<double>(std::min<std::size_t>(i, size[axis])) / size[axis] - 1.0;
            const double slope = perspective ? half * share : 0.0, start = perspective ? 0.0 : half * share;
            const double across = 1.0 / std::sqrt(1.0 + slope * slope);
            const double entries[] = {slope, start, across, -slope * across, -start * across};
            for (std::size_t n = 0; n < 5; ++n) to[n * stride + i] = entries[n];
            if (i <= size[axis])
                grid.planes_[axis].push_back(
                    plane_of(across * grid.axes_[axis] - slope * across * grid.axes_[2], -start * across));
        }
        (perspective ? grid.spread_ : grid.start_) = perspective ? grid.spread_ + half : std::max(grid.start_, half);
        to += FroxelArrays<double>::kPerBoundary * stride;
    }
    for (std::uint32_t k = 0; k < size[2] + 1 + kFroxelPadding; ++k) to[k] = grid.depths_[std::min(k, size[2])];
    for (const double depth : grid.depths_) grid.planes_[2].push_back(plane_of(grid.axes_[2], -depth));
    grid.floats_.reserve(grid.doubles_.size());
    for (const double value : grid.doubles_) grid.floats_.push_back(static_cast<float>(value));
    return grid;
}

Frustum FroxelGrid::froxel(std::uint32_t index) const {
    Frustum result;
    result.origin = origin_;
    const std::uint32_t at[3] = {index % columns(), index / columns() % rows(), index / columns() / rows()};
    for (unsigned axis = 0; axis < 3; ++axis) {
        const Plane& beyond = planes_[axis][at[axis] + 1];
        result.planes[result.plane_count++] = planes_[axis][at[axis]];
        result.planes[result.plane_count++] = {-beyond.normal, -beyond.offset};
    }
    return result;
}

}  // namespace crofton::cull
