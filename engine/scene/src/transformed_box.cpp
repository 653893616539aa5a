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

// The image of a box: centre, half edges (axis · half extent), and how far rounding may have put both off.
struct Image {
    glm::dvec3 center;
    std::array<glm::dvec3, 3> half_edges;
    double slack;
};

// Rounding, with u = 2^-53. A box's half edge h·a is exact (a product of two floats); L·(h·a) is off by at most
// 3u(1+3u)·|L||h·a| per component, so in the 1-norm by 4u·M, M the sum of |L||h·a|'s components. Likewise the centre
// L·c + t by 4u·C, C the sum of |L||c| + |t|. For axes Q, float and orthonormal within 1e-6, let N = Q⁻¹: entries of N
// are below 1.001 and the computed ones off by at most 32u (cofactors and their sum of three near 1). A point of the
// image needs |u_j| ≤ Σ_k |N_j·e_k| + |N_j·(exact − computed centre)|, whose computed value is off by at most Σ_k
// (1.001·4 + 32 + 4)u·M_k + 1.001·4u·C < 2^-47·Σ M_k + 2^-50·C: the slack. Sums of it round up by the factor at the
// end.
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
    image.slack = 0x1p-47 * edges + 0x1p-50 * center;
    return image;
}

Obb box_with_axes(const Image& image, const glm::dvec3& x, const glm::dvec3& y) {
    Obb box;
    box.center = image.center;
    box.axes = glm::mat3(glm::vec3(x), glm::vec3(y), glm::vec3(glm::cross(x, y)));
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(box.axes));
    glm::dvec3 reach(image.slack);
    for (const glm::dvec3& edge : image.half_edges) reach += absolute(inverse * edge);
    for (int k = 0; k < 3; ++k) box.half_extents[k] = float_at_least(reach[k] * (1.0 + 0x1p-50));
    return box;
}

glm::dvec3 perpendicular_part(const glm::dvec3& v, const glm::dvec3& unit) {
    return v - glm::dot(v, unit) * unit;
}

}  // namespace

Result<Obb> transformed_box(const Transform& transform, const Obb& box, const measure::Criterion& criterion) {
    const Image image = image_of(transform, box);
    std::array<glm::dvec3, 3> edges;
    for (int k = 0; k < 3; ++k)
        edges[static_cast<std::size_t>(k)] = glm::normalize(transform.linear * glm::dvec3(box.axes[k]));
    const auto perpendicular = [&](std::size_t i, std::size_t j) {
        return std::abs(glm::dot(edges[i], edges[j])) < kPerpendicular;
    };
    Obb best;
    if (perpendicular(0, 1) && perpendicular(1, 2) && perpendicular(0, 2)) {
        best = box_with_axes(image, edges[0], glm::normalize(perpendicular_part(edges[1], edges[0])));
    } else {
        // Each of three face normals with each of the face's two edges.
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 normal = glm::normalize(glm::cross(edges[(k + 1) % 3], edges[(k + 2) % 3]));
            for (std::size_t e = 1; e <= 2; ++e) {
                const glm::dvec3 along = glm::normalize(perpendicular_part(edges[(k + e) % 3], normal));
                const Obb candidate = box_with_axes(image, normal, along);
                const double cost = criterion(measure::intrinsic_volumes_of_box(candidate));
                if (!(cost < least)) continue;
                least = cost;
                best = candidate;
            }
        }
    }
    if (auto valid = crofton::validate(best); !valid) return tl::unexpected(valid.error());
    return best;
}

}  // namespace crofton::scene
