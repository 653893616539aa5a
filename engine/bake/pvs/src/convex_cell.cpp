// SPDX-License-Identifier: MIT
#include "convex_cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::pvs {
namespace {

constexpr double kOnPlane = 1e-12;  // of the size
constexpr std::size_t kCorners = 8;

// Corners around the first, and their size.
struct Around {
    std::array<glm::dvec3, kCorners> at;
    double size = 0.0;

    explicit Around(const ConvexCell& cell) {
        for (std::size_t i = 0; i < kCorners; ++i) {
            at[i] = cell.corners[i] - cell.corners[0];
            size = (std::max)(size, glm::length(at[i]));
        }
    }
};

// Returns twice the area of the hull of points in one plane, as the sum over its edges. An edge is a pair that has all
// other points on its left, and none on its line beyond its ends.
double doubled_area(std::span<const glm::dvec3> points, const glm::dvec3& normal, double tolerance) {
    double area = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < points.size(); ++j) {
            const glm::dvec3 edge = points[j] - points[i];
            const double length = glm::length(edge);
            if (!(length > tolerance)) continue;
            bool is_edge = true;
            for (const glm::dvec3& p : points) {
                const double left = glm::dot(normal, glm::cross(edge, p - points[i])) / length;
                const double along = glm::dot(edge, p - points[i]) / length;
                if (left < -tolerance) is_edge = false;
                if (left <= tolerance && (along < -tolerance || along > length + tolerance)) is_edge = false;
            }
            if (is_edge) area += glm::dot(normal, glm::cross(points[i] - points[0], points[j] - points[0]));
        }
    return area;
}

// Equal points once.
std::size_t distinct(std::array<glm::dvec3, kCorners>& points, std::size_t count, double tolerance) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        bool is_new = true;
        for (std::size_t j = 0; j < kept; ++j) is_new = is_new && glm::distance(points[i], points[j]) > tolerance;
        if (is_new) points[kept++] = points[i];
    }
    return kept;
}

}  // namespace

ConvexCellFaces faces_of(const ConvexCell& cell) {
    Around corners(cell);
    const double tolerance = kOnPlane * corners.size;
    const std::size_t count = distinct(corners.at, kCorners, tolerance);
    ConvexCellFaces faces;
    // By the corners that lie on a face: each face is found by several triples.
    Vector<std::uint32_t> found;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
            for (std::size_t k = j + 1; k < count; ++k) {
                const glm::dvec3 across = glm::cross(corners.at[j] - corners.at[i], corners.at[k] - corners.at[i]);
                const double length = glm::length(across);
                if (!(length > tolerance * corners.size)) continue;
                for (const glm::dvec3& normal : {across / length, -across / length}) {
                    std::uint32_t on = 0;
                    double least = 0.0, most_on = 0.0;
                    bool beyond = false;
                    std::array<glm::dvec3, kCorners> points{};
                    std::size_t points_on = 0;
                    for (std::size_t p = 0; p < count; ++p) {
                        const double height = glm::dot(normal, corners.at[p] - corners.at[i]);
                        least = (std::min)(least, height);
                        beyond = beyond || height > tolerance;
                        if (std::abs(height) > tolerance) continue;
                        most_on = (std::max)(most_on, height);
                        on |= 1u << p;
                        points[points_on++] = corners.at[p];
                    }
                    if (least < -tolerance || std::find(found.begin(), found.end(), on) != found.end()) continue;
                    if (!beyond) return {};  // all in one plane
                    found.push_back(on);
                    faces.planes.push_back({normal, -glm::dot(normal, corners.at[i]) - most_on});
                    faces.surface +=
                        0.5 * std::abs(doubled_area(std::span(points).first(points_on), normal, tolerance));
                }
            }
    return faces;
}

}  // namespace crofton::pvs
