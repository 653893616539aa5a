// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/plane_filter.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>

#include <crofton/mesh/ray_box.hpp>
#include "posed_mesh.hpp"
#include "ray_mesh.hpp"

namespace crofton::mesh {
namespace {

// Sign of det(direction, a − origin, b − origin), exactly.
int side_of_edge(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b) {
    std::array<Expansion<2>, 3> u, v;
    for (int i = 0; i < 3; ++i) {
        u[static_cast<std::size_t>(i)] = exact_difference(a[i], ray.origin[i]);
        v[static_cast<std::size_t>(i)] = exact_difference(b[i], ray.origin[i]);
    }
    const auto term = [&](std::size_t i, std::size_t j, double d) { return (u[i] * v[j] - u[j] * v[i]) * d; };
    return (term(1, 2, ray.direction.x) + term(2, 0, ray.direction.y) + term(0, 1, ray.direction.z)).sign();
}

// The same through a filter first: the differences and products are those of PlaneFilter, one difference fewer.
int filtered_side_of_edge(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b) {
    const PlaneFilter plane(ray.origin, a, b);
    const double determinant = glm::dot(plane.normal, ray.direction);
    const double error = PlaneFilter::kErrorBound * glm::dot(plane.magnitude, glm::abs(ray.direction)) + 1e-280;
    if (std::abs(determinant) > error) return determinant > 0.0 ? 1 : -1;
    return side_of_edge(ray, a, b);
}

bool line_meets(const Ray& ray, const Triangle& t) {
    int low = 1, high = -1;
    for (std::size_t k = 0; k < 3 && !(low < 0 && high > 0); ++k) {
        const int side = filtered_side_of_edge(ray, t[k], t[(k + 1) % 3]);
        low = std::min(low, side);
        high = std::max(high, side);
    }
    return (low >= 0 && high > 0) || (high <= 0 && low < 0);  // all zero: in the plane
}

// Where the line meets the plane, kept between the nearest and the farthest vertex along it, as the traversal does.
double parameter(const Ray& ray, const Triangle& t) {
    const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double by_plane = glm::dot(n, t[0] - ray.origin) / glm::dot(n, ray.direction);
    const double squared = glm::dot(ray.direction, ray.direction);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec3& vertex : t) {
        const double at = glm::dot(vertex - ray.origin, ray.direction) / squared;
        low = std::min(low, at);
        high = std::max(high, at);
    }
    const double margin = 1e-12 * std::max(std::abs(low), std::abs(high));
    return by_plane >= low - margin ? std::min(by_plane, high + margin) : low - margin;
}

// The largest one that is not above x, but at most 2^1000, so that its reciprocal is a normal number. x is a valid
// ray's largest component, whose square is not 0: above 2^-540.
double power_of_two(double x) {
    constexpr std::uint64_t kExponent = 0x7ff0000000000000u;
    const double power = std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & kExponent);
    return std::min(power, 0x1p1000);
}

// validate(ray) without the words.
bool is_valid(const Ray& ray) {
    const glm::dvec3 sum = ray.origin + ray.direction;
    return std::isfinite(sum.x + sum.y + sum.z) && glm::dot(ray.direction, ray.direction) > 0.0 && ray.max_t >= 0.0;
}

RayAnswer trace(const Ray& ray, const mesh::MeshTree& mesh, bool any) {
    if (mesh.triangle_count() == 0) return {};
    const RayQuery query = query_of(ray, mesh, any);
    return trace(query, [&](std::uint32_t leaf, std::uint32_t lane) { return line_meets(ray, mesh, leaf, lane); });
}

}  // namespace

// Without a branch: what rays are like cannot be predicted.
RayQuery query_of(const Ray& ray, const MeshTree& mesh, bool any) {
    RayQuery query;
    const glm::dvec3 size = glm::abs(ray.direction);
    query.scale = power_of_two(std::max({size.x, size.y, size.z}));
    const double per_scale = 1.0 / query.scale;
    float along[3], magnitude[3];
    double far = 0.0;
    for (int i = 0; i < 3; ++i) {
        query.origin[i] = ray.origin[i];
        query.direction[i] = ray.direction[i];
        query.start[i] = static_cast<float>(ray.origin[i]);
        // A component of 0 would make 0 · infinity; this one bends the ray by less than its rounding.
        const auto exact = static_cast<float>(ray.direction[i] * per_scale);
        magnitude[i] = std::max(std::abs(exact), 1e-18f);
        query.direction_f[i] = along[i] = std::copysign(magnitude[i], exact);
        query.inverse[i] = 1.0f / along[i];
        far = std::max(far, std::abs(ray.origin[i]));
    }
    const auto y_above_x = static_cast<std::uint32_t>(magnitude[1] > magnitude[0]);
    const auto z_above_both = static_cast<std::uint32_t>(magnitude[2] > std::max(magnitude[0], magnitude[1]));
    const std::uint32_t z = z_above_both * 2u + (1u - z_above_both) * y_above_x;
    constexpr std::uint32_t kAfter[] = {0, 1, 2, 0, 1};
    query.axis[2] = z;
    for (std::uint32_t k = 0; k < 2; ++k) {
        query.axis[k] = kAfter[z + 1 + k];
        query.shear[k] = along[query.axis[k]] * query.inverse[z];
    }
    query.max_t = ray.max_t;
    // Rounding of origin, direction, axes and projections, each at most 2^-24 relative, at any point the mesh can
    // reach.
    query.error_bound = static_cast<float>(4e-6 * (static_cast<double>(mesh.extent()) + far));
    const MeshParts& parts = mesh.parts();
    query.nodes = parts.ray_nodes.data();
    query.mesh_nodes = parts.nodes.data();
    query.leaves = parts.leaves.data();
    query.any = any;
    return query;
}

bool line_meets(const Ray& ray, const MeshTree& mesh, std::uint32_t leaf, std::uint32_t lane) {
    return line_meets(ray, triangle_of(mesh.parts().leaves[leaf], lane));
}

std::optional<double> entry_of(const Ray& ray, const Obb& box) {
    const glm::dvec3 offset = ray.origin - box.center;
    double first = 0.0, last = ray.max_t;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 n = glm::cross(glm::dvec3(box.axes[(k + 1) % 3]), glm::dvec3(box.axes[(k + 2) % 3]));
        const double projected_radius =
            static_cast<double>(box.half_extents[k]) * std::abs(glm::dot(n, glm::dvec3(box.axes[k])));
        const double at = glm::dot(n, offset), speed = glm::dot(n, ray.direction);
        if (speed == 0.0) {
            if (std::abs(at) > projected_radius) return std::nullopt;
            continue;
        }
        const double t0 = (-projected_radius - at) / speed, t1 = (projected_radius - at) / speed;
        first = std::max(first, std::min(t0, t1));
        last = std::min(last, std::max(t0, t1));
    }
    if (!(first <= last)) return std::nullopt;
    return first;
}

std::optional<double> raycast(const Ray& ray, const Obb& box) {
    if (!validate(ray) || !validate(box)) return std::nullopt;
    return entry_of(ray, box);
}

std::optional<double> raycast(const Ray& ray, const Triangle& triangle) {
    if (!validate(ray)) return std::nullopt;
    for (const glm::dvec3& vertex : triangle)
        if (!std::isfinite(vertex.x + vertex.y + vertex.z)) return std::nullopt;
    if (!line_meets(ray, triangle)) return std::nullopt;
    const double t = parameter(ray, triangle);
    if (!(t >= 0.0 && t <= ray.max_t)) return std::nullopt;
    return t;
}

std::optional<RayHit> raycast(const Ray& ray, const mesh::MeshTree& mesh) {
    if (!is_valid(ray)) return std::nullopt;
    const RayAnswer answer = trace(ray, mesh, false);
    if (!answer.hit) return std::nullopt;
    return RayHit{answer.t, answer.triangle};
}

bool hits_any(const Ray& ray, const mesh::MeshTree& mesh) {
    return is_valid(ray) && trace(ray, mesh, true).hit;
}

}  // namespace crofton::mesh
