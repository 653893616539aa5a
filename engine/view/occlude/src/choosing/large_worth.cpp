// SPDX-License-Identifier: MIT
#include "choosing/large_worth.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace crofton::occlude {
namespace {

constexpr int kRaysASide = 5;

glm::dvec3 row_direction(const std::array<double, 4>& row) {
    return {row[0], row[1], row[2]};
}

// The part of a ray within a box, in multiples of the ray's direction.
struct Interval {
    double begin, end;
};

Interval interval_in(const Aabb& box, const glm::dvec3& start, const glm::dvec3& along) {
    Interval result{-1e300, 1e300};
    for (int k = 0; k < 3; ++k) {
        const double step = std::fabs(along[k]) > 1e-200 ? along[k] : 1e-200;
        const double a = (box.min[k] - start[k]) / step, b = (box.max[k] - start[k]) / step;
        result.begin = std::max(result.begin, std::min(a, b));
        result.end = std::min(result.end, std::max(a, b));
    }
    return result;
}

// Σ |dot(along, areas)|: the visible areas of the occluder and of its bounds.
double faced_of(const CandidatePage& page, std::size_t i, const glm::dvec3& along) {
    double faced = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
        double dot = 0.0;
        for (std::size_t k = 0; k < 3; ++k)
            dot += along[static_cast<int>(k)] * static_cast<double>(page.columns[4 + 3 * a + k][i]);
        faced += std::fabs(dot);
    }
    return faced;
}
double faced_of(const glm::dvec3& half, const glm::dvec3& along) {
    return 4.0 * (half.y * half.z * std::fabs(along.x) + half.z * half.x * std::fabs(along.y) +
                  half.x * half.y * std::fabs(along.z));
}

// The normal of the largest of the areas: across it the occluder is thinnest.
glm::dvec3 thin_axis(const CandidatePage& page, std::size_t i) {
    glm::dvec3 largest(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
        const glm::dvec3 area(page.columns[4 + 3 * a][i], page.columns[5 + 3 * a][i], page.columns[6 + 3 * a][i]);
        if (glm::dot(area, area) > glm::dot(largest, largest)) largest = area;
    }
    return largest;
}

}  // namespace

void LargeWorth::Rectangle::include(const glm::dvec2& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
}

LargeWorth::LargeWorth(const OcclusionView& view, const Aabb& objects, const glm::dvec3& candidates_origin)
    : view_(view),
      origin_(candidates_origin - view.origin),
      objects_{objects.min - view.origin, objects.max - view.origin} {
    // In a parallel view the third row is constant; depth takes its place.
    const glm::dvec3 third = view.perspective ? row_direction(view.rows[2]) : -row_direction(view.rows[3]);
    inverse_ =
        glm::inverse(glm::transpose(glm::dmat3(row_direction(view.rows[0]), row_direction(view.rows[1]), third)));
    share_ = view.perspective ? std::fabs(glm::determinant(inverse_)) / (4.0 * std::numbers::pi) : 0.25;
    window_ = rectangle_of(objects_);
}

glm::dvec3 LargeWorth::project(const glm::dvec3& point) const {
    const auto row = [&](std::size_t r) { return glm::dot(row_direction(view_.rows[r]), point) + view_.rows[r][3]; };
    return {row(0), row(1), row(2)};
}

// Returns the rectangle of the part beyond the least w, within the window.
LargeWorth::Rectangle LargeWorth::rectangle_of(const Aabb& box) const {
    glm::dvec3 corners[8];
    for (unsigned i = 0; i < 8; ++i)
        corners[i] = project(
            {(i & 1u) ? box.max.x : box.min.x, (i & 2u) ? box.max.y : box.min.y, (i & 4u) ? box.max.z : box.min.z});
    Rectangle result;
    const double least = view_.least_w;
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec3& a = corners[i];
        if (a.z >= least) result.include(glm::dvec2(a) / a.z);
        for (unsigned k = 0; k < 3; ++k) {
            const glm::dvec3& b = corners[i ^ (1u << k)];
            if (!(a.z < least && b.z >= least)) continue;
            const glm::dvec3 crossing = a + (b - a) * ((least - a.z) / (b.z - a.z));
            result.include(glm::dvec2(crossing) / least);
        }
    }
    result.min = glm::max(result.min, glm::dvec2(-1.0));
    result.max = glm::min(result.max, glm::dvec2(1.0));
    return result;
}

LargeWorth::Ray LargeWorth::ray_through(const glm::dvec2& pixel) const {
    if (view_.perspective) return {glm::dvec3(0.0), inverse_ * glm::dvec3(pixel, 1.0)};
    return {inverse_ * glm::dvec3(pixel.x - view_.rows[0][3], pixel.y - view_.rows[1][3], 0.0),
            -row_direction(view_.rows[3])};
}

float LargeWorth::of(const CandidatePage& page, std::size_t i, float cover, float least) const {
    const glm::dvec3 center = origin_ + glm::dvec3(page.columns[0][i], page.columns[1][i], page.columns[2][i]);
    const glm::dvec3 half(page.half_sizes[i]);
    const Aabb bounds{center - half, center + half};
    Rectangle common = rectangle_of(bounds);
    common.min = glm::max(common.min, window_.min);
    common.max = glm::min(common.max, window_.max);
    if (common.is_empty()) return 0.0f;
    const glm::dvec2 step = (common.max - common.min) / static_cast<double>(kRaysASide);
    const glm::dvec3 thin = thin_axis(page, i);
    double covered = 0.0, worth = 0.0;
    for (int y = 0; y < kRaysASide; ++y)
        for (int x = 0; x < kRaysASide; ++x) {
            const Ray ray = ray_through(common.min + step * glm::dvec2(x + 0.5, y + 0.5));
            const Interval own = interval_in(bounds, ray.start, ray.along);
            const double nearest = view_.perspective ? std::max(own.begin, 0.0) : own.begin;
            if (!(nearest <= own.end)) continue;
            const double length = glm::length(ray.along);
            const double seen = faced_of(page, i, ray.along), around = faced_of(half, ray.along);
            double share = share_ * std::min(1.0, around > 0.0 ? seen / around : 0.0);
            if (view_.perspective) share /= length * length * length;
            covered += share;
            // Where the ray meets the middle of the occluder.
            const double across = glm::dot(thin, ray.along);
            const double middle = across != 0.0 ? glm::dot(thin, center - ray.start) / across : nearest;
            const double met = std::clamp(middle, nearest, own.end);
            const Interval behind = interval_in(objects_, ray.start, ray.along);
            worth += share * length * std::max(0.0, behind.end - std::max(behind.begin, met));
        }
    const double cell = step.x * step.y;
    if (std::max(static_cast<double>(cover), covered * cell) < static_cast<double>(least)) return 0.0f;
    return static_cast<float>(worth * cell);
}

}  // namespace crofton::occlude
