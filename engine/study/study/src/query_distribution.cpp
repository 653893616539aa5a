// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/moderate_length.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/query_distribution.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

namespace crofton::study {
namespace {

using std::numbers::pi;
constexpr std::uint64_t kBandDirections = 4096;

// The unit vector along a direction of any length; nothing for one that is zero or not finite.
std::optional<glm::dvec3> unit_along(const glm::dvec3& direction) {
    if (!is_finite(direction) || direction == glm::dvec3(0.0)) return std::nullopt;
    return glm::normalize(of_moderate_length(direction));
}

// Number i of a band: even heights, and longitudes by the golden angle.
glm::dvec3 even_direction(std::uint64_t i, double highest) {
    const double z = highest * (2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(kBandDirections) - 1.0);
    const double turns = static_cast<double>(i) * 0.6180339887498949;
    const glm::dvec2 circle = cosine_sine(2.0 * pi * (turns - std::floor(turns)));
    const double r = std::sqrt(1.0 - z * z);
    return {r * circle.x, r * circle.y, z};
}

}  // namespace

Result<QueryDistribution> QueryDistribution::band(const glm::dvec3& up, double half_width) {
    const auto axis = unit_along(up);
    if (!axis) return fail(ErrorCode::invalid_argument, kNoItem, "query distribution: `up` is zero or not finite");
    if (!(half_width > 0.0 && half_width <= 0.5 * pi))
        return fail(ErrorCode::invalid_argument, kNoItem, "query distribution: half_width must lie in (0, pi/2]");
    const auto [x, y] = sampling::orthonormal_frame(*axis);
    QueryDistribution result;
    for (std::uint64_t i = 0; i < kBandDirections; ++i) {
        const glm::dvec3 d = even_direction(i, sine(half_width));
        result.directions_.push_back(d.x * x + d.y * y + d.z * *axis);
    }
    result.weights_.assign(result.directions_.size(), 1.0 / static_cast<double>(kBandDirections));
    return result;
}

Result<QueryDistribution> QueryDistribution::samples(std::span<const glm::dvec3> directions,
                                                     std::span<const double> weights) {
    if (directions.empty()) return fail(ErrorCode::empty, kNoItem, "query distribution: no directions");
    if (!weights.empty() && weights.size() != directions.size())
        return fail(ErrorCode::invalid_argument, kNoItem,
                    {"query distribution: ", weights.size(), " weights for ", directions.size(), " directions"});
    QueryDistribution result;
    double sum = 0.0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const auto unit = unit_along(directions[i]);
        if (!unit)
            return fail(ErrorCode::invalid_argument, i,
                        {"query distribution: direction ", i, " is zero or not finite"});
        const double weight = weights.empty() ? 1.0 : weights[i];
        if (!(weight >= 0.0) || !std::isfinite(weight))
            return fail(ErrorCode::invalid_argument, i,
                        {"query distribution: weight ", i, " is negative or not finite"});
        result.directions_.push_back(*unit);
        result.weights_.push_back(weight);
        sum += weight;
    }
    if (!(sum > 0.0) || !std::isfinite(sum))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "query distribution: the weights add up to 0, or to more than a double holds");
    for (double& weight : result.weights_) weight /= sum;
    return result;
}

Result<QueryDistribution> QueryDistribution::of_views(std::span<const Camera> cameras) {
    // Faces as quads of corner numbers (see frustum_corners), in the order of the frustum's planes.
    constexpr unsigned faces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                      {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
    Vector<glm::dvec3> normals;
    Vector<double> areas;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (!std::isfinite(cameras[i].far_distance))
            return fail(ErrorCode::invalid_argument, i, "query distribution: a view needs a finite far distance");
        const auto frustum = frustum_of(cameras[i]);
        if (!frustum) return fail(frustum.error().code, i, frustum.error().message);
        const auto corners = frustum_corners(*frustum);
        if (!corners) return fail(corners.error().code, i, corners.error().message);
        for (std::size_t f = 0; f < 6; ++f) {
            const auto& q = faces[f];
            normals.push_back(frustum->planes[f].normal);
            areas.push_back(0.5 * glm::length(glm::cross((*corners)[q[2]] - (*corners)[q[0]],
                                                         (*corners)[q[3]] - (*corners)[q[1]])));
        }
    }
    if (normals.empty()) return fail(ErrorCode::empty, kNoItem, "query distribution: no cameras");
    return samples(normals, areas);
}

double QueryDistribution::mean_cosine(const glm::dvec3& u) const {
    if (directions_.empty()) return 0.5;
    double sum = 0.0;
    for (std::size_t i = 0; i < directions_.size(); ++i) sum += weights_[i] * std::abs(glm::dot(directions_[i], u));
    return sum;
}

double QueryDistribution::measure_of_planes(const Obb& box) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
        sum += 2.0 * static_cast<double>(box.half_extents[k]) * mean_cosine(glm::dvec3(box.axes[k]));
    return 2.0 * pi * sum;
}

double QueryDistribution::measure_of_planes(const ConvexBody& body) const {
    if (directions_.empty()) {
        const auto core = measure::intrinsic_volumes_of_hull(body.points);
        return core ? core->mean_curvature + 4.0 * pi * body.radius : std::numeric_limits<double>::quiet_NaN();
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < directions_.size(); ++i) sum += weights_[i] * breadth(body, directions_[i]);
    return 2.0 * pi * sum;
}

double QueryDistribution::measure_of_lines(const Obb& box) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
        sum += 4.0 * static_cast<double>(box.half_extents[(k + 1) % 3]) *
               static_cast<double>(box.half_extents[(k + 2) % 3]) * mean_cosine(glm::dvec3(box.axes[k]));
    return 2.0 * pi * sum;
}

Result<DirectedFit> fit_box_for(std::span<const glm::dvec3> points, const QueryDistribution& distribution,
                                QueryKind kind) {
    const auto criterion = kind == QueryKind::planes ? measure::minimal_perimeter() : measure::minimal_area();
    const auto plain = fit::fit_obb(points, {.criterion = criterion});
    if (!plain) return plain.error();
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    ConvexBody body;
    for (const std::uint32_t v : hull->vertices) body.points.push_back(points[v]);
    const auto value_of = [&](const Obb& box) {
        return kind == QueryKind::planes ? distribution.measure_of_planes(box) : distribution.measure_of_lines(box);
    };
    DirectedFit best{*plain, *plain, value_of(*plain), value_of(*plain), 0.0};
    // A sum of |dot| over the same directions is no more for the hull than for any box around it.
    if (kind == QueryKind::planes) best.lower_bound = std::min(best.value, distribution.measure_of_planes(body));
    constexpr int kStarts = 10;
    for (int start = 0; start < kStarts; ++start) {
        sampling::Random random(19, static_cast<std::uint64_t>(start));
        glm::mat3 at = start == 0   ? plain->axes
                       : start == 1 ? glm::mat3(1.0f)
                                    : glm::mat3(sampling::rotation(random.point<3>()));
        double here = HUGE_VAL;
        const auto consider = [&](const glm::mat3& axes) {
            const auto box = fit::fit_oriented(std::span<const glm::dvec3>(body.points), axes);
            if (!box) return;
            const double value = value_of(*box);
            if (value < here) here = value, at = axes;
            if (value < best.value) best.value = value, best.box = *box;
        };
        consider(at);
        for (double step = 0.4; step > 1e-3; step *= 0.7)
            for (int tries = 0; tries < 8; ++tries) {
                const glm::dvec3 by = step * sampling::ball_point(random.point<3>());
                glm::dmat3 turned(at);
                for (int k = 0; k < 3; ++k) turned[k] += glm::cross(by, turned[k]);
                turned[0] = glm::normalize(turned[0]);
                turned[1] = glm::normalize(turned[1] - glm::dot(turned[0], turned[1]) * turned[0]);
                turned[2] = glm::cross(turned[0], turned[1]);
                consider(glm::mat3(turned));
            }
    }
    // The hull's corners are some of the points; the rest lie in their hull up to rounding.
    if (const auto box = fit::fit_oriented(points, best.box.axes)) best.box = *box, best.value = value_of(*box);
    return best;
}

}  // namespace crofton::study
