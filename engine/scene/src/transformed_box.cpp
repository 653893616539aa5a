#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/scene/transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace crofton::scene {
namespace {

// Directions whose cosine stays below this are perpendicular as far as a box's float axes can tell.
constexpr double kPerpendicular = 1e-7;
// Lengths below this, beside 1, give no direction.
constexpr double kNothing = 1e-12;

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

// The image of a box, and how far rounding may have put it off: by `error_bound` along each axis of a box around it.
struct Image {
    glm::dvec3 center;
    std::array<glm::dvec3, 3> half_edges;
    double error_bound;
};

// With u = 2^-53. A box's half edge h·a is exact (a product of two floats); L·(h·a) is off by at most
// 3u(1+3u)·|L||h·a| per component, so in the 1-norm by 4u·M, M the sum of |L||h·a|'s components. Likewise the centre
// L·c + t by 4u·C, C the sum of |L||c| + |t|. For axes Q, float and orthonormal within 1e-6, let N = Q⁻¹: entries of N
// are below 1.001 and the computed ones off by at most 32u (cofactors and their sum of three near 1). A point of the
// image needs |u_j| ≤ Σ_k |N_j·e_k| + |N_j·(exact − computed centre)|, whose computed value is off by at most Σ_k
// (1.001·4 + 32 + 4)u·M_k + 1.001·4u·C < 2^-47·Σ M_k + 2^-50·C. Products that underflow are off by 2^-1075 each, which
// 2^-1000 covers. Sums of the bound round up by the factor at the end of box_with_axes.
Image image_of(const Transform& transform, const Obb& box) {
    const glm::dmat3 size(absolute(transform.linear[0]), absolute(transform.linear[1]), absolute(transform.linear[2]));
    Image image;
    image.center = transform * box.center;
    double edges = 0.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = glm::dvec3(box.axes[k]) * static_cast<double>(box.half_extents[k]);
        image.half_edges[static_cast<std::size_t>(k)] = transform.linear * edge;
        edges += sum(size * absolute(edge));
    }
    const double center = sum(size * absolute(box.center)) + sum(absolute(transform.translation));
    image.error_bound = 0x1p-47 * edges + 0x1p-50 * center + 0x1p-1000;
    return image;
}

Obb box_with_axes(const Image& image, const glm::dvec3& x, const glm::dvec3& y) {
    Obb box;
    box.center = image.center;
    box.axes = glm::mat3(glm::vec3(x), glm::vec3(y), glm::vec3(glm::cross(x, y)));
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(box.axes));
    glm::dvec3 half_extents(image.error_bound);
    for (const glm::dvec3& edge : image.half_edges) half_extents += absolute(inverse * edge);
    for (int k = 0; k < 3; ++k) box.half_extents[k] = float_at_least(half_extents[k] * (1.0 + 0x1p-50));
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
    const double scale = largest >= 1e-100 && largest <= 1e100 ? 1.0 : std::exp2(-std::ilogb(largest));
    Edges edges{};
    if (!(largest > 0.0) || !std::isfinite(scale)) return edges;
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
            const double cost = criterion(measure::of_box(candidate));
            if (!(cost < least)) return;
            least = cost;
            best = candidate;
        });
        if (!std::isfinite(least)) best = box_with_axes(image, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
    }
    if (auto valid = crofton::validate(best); !valid) return tl::unexpected(valid.error());
    return best;
}

}  // namespace crofton::scene
