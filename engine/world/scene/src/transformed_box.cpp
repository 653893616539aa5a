// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/scene/transformed_box.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "box_image.hpp"

namespace crofton::scene {
namespace {

glm::dvec3 absolute(const glm::dvec3& v) {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
double sum(const glm::dvec3& v) {
    return v.x + v.y + v.z;
}

float float_at_least(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                                : rounded;
}

// The image of a box, and how far rounding may have put it off: box_image.hpp.
struct Image {
    glm::dvec3 center;
    std::array<glm::dvec3, 3> half_edges;
    double error_bound;
};

Image image_of(const Transform& transform, const Obb& box) {
    Image image;
    image.center = transform * box.center;
    for (int k = 0; k < 3; ++k)
        image.half_edges[static_cast<std::size_t>(k)] =
            (transform.linear * glm::dvec3(box.axes[k])) * static_cast<double>(box.half_extents[k]);
    const double linear =
        sum(absolute(transform.linear[0])) + sum(absolute(transform.linear[1])) + sum(absolute(transform.linear[2]));
    const double edges = linear * sum(glm::dvec3(box.half_extents));
    const double center = linear * sum(absolute(box.center)) + sum(absolute(transform.translation));
    image.error_bound = kEdgeError * edges + kCenterError * center + kUnderflow;
    return image;
}

// The box with the float nearest to x, y and x × y as its axes.
Obb box_with_axes(const Image& image, const glm::dvec3& x, const glm::dvec3& y) {
    Obb box;
    box.center = image.center;
    box.axes = glm::mat3(glm::vec3(x), glm::vec3(y), glm::vec3(glm::cross(x, y)));
    const glm::dmat3 axes(box.axes);
    const glm::dmat3 normals(glm::cross(axes[1], axes[2]), glm::cross(axes[2], axes[0]), glm::cross(axes[0], axes[1]));
    const double determinant = glm::dot(axes[0], normals[0]);
    for (int k = 0; k < 3; ++k) {
        const auto along = [&](std::size_t edge) { return std::abs(glm::dot(normals[k], image.half_edges[edge])); };
        const double half_extent = (along(0) + along(1) + along(2)) / determinant + image.error_bound;
        box.half_extents[k] = float_at_least(half_extent * kRoundUp);
    }
    return box;
}

glm::dvec3 perpendicular_part(const glm::dvec3& v, const glm::dvec3& unit) {
    return v - glm::dot(v, unit) * unit;
}

using Edges = std::array<glm::dvec3, 3>;

// Where the box's edges point, as unit vectors; zero where the transform shortens one to nothing beside the longest.
// A transform out of range for squares is scaled by a power of two first, which turns nothing.
Edges edge_directions(const Transform& transform, const Obb& box) {
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, sum(absolute(transform.linear[k])));
    Edges edges{};
    if (!(largest > 0.0) || !std::isfinite(largest)) return edges;
    const double scale = largest >= 1e-100 && largest <= 1e100 ? 1.0 : std::exp2(-std::logb(largest));
    if (!std::isfinite(scale)) return edges;
    std::array<double, 3> squared{};
    for (std::size_t k = 0; k < 3; ++k) {
        edges[k] = (scale * transform.linear) * glm::dvec3(box.axes[static_cast<int>(k)]);
        squared[k] = glm::dot(edges[k], edges[k]);
    }
    const double longest = std::max({squared[0], squared[1], squared[2]});
    for (std::size_t k = 0; k < 3; ++k)
        edges[k] = squared[k] > kNothing * kNothing * longest ? glm::normalize(edges[k]) : glm::dvec3(0.0);
    return edges;
}

glm::dvec3 any_perpendicular(const glm::dvec3& unit) {
    const glm::dvec3 axis = std::abs(unit.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    return glm::normalize(perpendicular_part(axis, unit));
}

// visit(x, y) for the axes of each box to be tried: the normal of each pair of edges with either edge. Where all edges
// lie along a line, that line; where there are none, any.
template <class Visit>
void for_each_frame(const Edges& edges, Visit visit) {
    bool any = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 normal = glm::cross(edges[(k + 1) % 3], edges[(k + 2) % 3]);
        if (!(glm::dot(normal, normal) > kNothing * kNothing)) continue;
        any = true;
        const glm::dvec3 unit = glm::normalize(normal);
        for (std::size_t e = 1; e <= 2; ++e) visit(unit, glm::normalize(perpendicular_part(edges[(k + e) % 3], unit)));
    }
    if (any) return;
    for (const glm::dvec3& edge : edges)
        if (edge != glm::dvec3(0.0)) return visit(edge, any_perpendicular(edge));
    visit(glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0));
}

}  // namespace

Result<Obb> transformed_box(const Transform& transform, const Obb& box, const measure::Criterion& criterion) {
    const Image image = image_of(transform, box);
    const Edges edges = edge_directions(transform, box);
    const auto perpendicular = [&](std::size_t i, std::size_t j) {
        return std::abs(glm::dot(edges[i], edges[j])) < kPerpendicular;
    };
    const bool all_present = edges[0] != glm::dvec3(0.0) && edges[1] != glm::dvec3(0.0) && edges[2] != glm::dvec3(0.0);
    Obb best;
    if (all_present && perpendicular(0, 1) && perpendicular(1, 2) && perpendicular(0, 2)) {
        best = box_with_axes(image, edges[0], glm::normalize(perpendicular_part(edges[1], edges[0])));
    } else {
        double least = std::numeric_limits<double>::infinity();
        for_each_frame(edges, [&](const glm::dvec3& x, const glm::dvec3& y) {
            const Obb candidate = box_with_axes(image, x, y);
            const double cost = criterion(measure::intrinsic_volumes_of_box(candidate));
            if (!(cost < least)) return;
            least = cost;
            best = candidate;
        });
        if (!std::isfinite(least)) best = box_with_axes(image, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
    }
    if (auto valid = crofton::validate(best); !valid) return valid.error();
    return best;
}

}  // namespace crofton::scene
