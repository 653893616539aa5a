// SPDX-License-Identifier: MIT
// Rays against one box, one triangle or a mesh: exact tests, and the public functions. ray_traversal.cpp walks the
// tree.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/plane_filter.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstddef>
#include <glm/geometric.hpp>

#include <crofton/mesh/ray_box.hpp>
#include "exact_vectors.hpp"
#include "posed_mesh.hpp"
#include "ray_mesh.hpp"

namespace crofton::mesh {
namespace {

// Sign of det(direction, a − origin, b − origin), exactly.
int side_of_edge(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b) {
    const auto n = cross(differences(a, ray.origin), differences(b, ray.origin));
    return (n[0] * ray.direction.x + n[1] * ray.direction.y + n[2] * ray.direction.z).sign();
}

// The same through a filter first: the differences and products are those of PlaneFilter, one difference fewer.
int filtered_side_of_edge(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b) {
    const PlaneFilter plane(ray.origin, a, b);
    const double determinant = glm::dot(plane.normal, ray.direction);
    const double error = PlaneFilter::kErrorBound * glm::dot(plane.magnitude, glm::abs(ray.direction)) + 1e-280;
    if (std::abs(determinant) > error) return determinant > 0.0 ? 1 : -1;
    return side_of_edge(ray, a, b);
}

// 0 where the ray's line does not pass through the triangle, or lies in its plane. Else the sign of dot(n, direction),
// with n = cross(t[1] − t[0], t[2] − t[0]): the sum of the three determinants.
int line_meets(const Ray& ray, const Triangle& t) {
    int low = 1, high = -1;
    for (std::size_t k = 0; k < 3 && !(low < 0 && high > 0); ++k) {
        const int side = filtered_side_of_edge(ray, t[k], t[(k + 1) % 3]);
        low = std::min(low, side);
        high = std::max(high, side);
    }
    if (low >= 0) return high;
    return high <= 0 ? low : 0;
}

// Sign of dot(n, t[0] − origin − max_t · direction), exactly.
int side_of_end(const Ray& ray, const Triangle& t) {
    const Differences offset = differences(t[0], ray.origin);
    const auto n = cross(differences(t[1], t[0]), differences(t[2], t[0]));
    const auto term = [&](std::size_t i, double d) { return n[i] * (offset[i] - exact_product(ray.max_t, d)); };
    return (term(0, ray.direction.x) + term(1, ray.direction.y) + term(2, ray.direction.z)).sign();
}

// The same through a filter. Beside the roundings of PlaneFilter there are a product's and a difference's, for which
// its bound is doubled.
int filtered_side_of_end(const Ray& ray, const Triangle& t) {
    const PlaneFilter plane(t);
    const glm::dvec3 offset = t[0] - ray.origin, reach = ray.max_t * ray.direction;
    const double above = glm::dot(plane.normal, offset - reach);
    const double error =
        2.0 * PlaneFilter::kErrorBound * glm::dot(plane.magnitude, glm::abs(offset) + glm::abs(reach)) + 1e-280;
    if (std::abs(above) > error) return above > 0.0 ? 1 : -1;
    return side_of_end(ray, t);
}

// Whether the ray's end is certainly beyond all of the triangle: no vertex is as far from its start. So the products
// that are left to side_of_end() do not overflow.
bool ends_beyond(const Ray& ray, const Triangle& t) {
    if (std::isinf(ray.max_t)) return true;
    double farthest = 0.0;
    for (const glm::dvec3& vertex : t) {
        const glm::dvec3 offset = glm::abs(vertex - ray.origin);
        farthest = std::max(farthest, offset.x + offset.y + offset.z);
    }
    const glm::dvec3 size = glm::abs(ray.direction);
    return ray.max_t * std::max({size.x, size.y, size.z}) > 1.0001 * farthest;
}

// Whether the ray meets the triangle, from its start to its end, both included. Exact.
bool meets(const Ray& ray, const Triangle& t) {
    const int speed = line_meets(ray, t);
    // The triangle's plane is where dot(n, t[0] − origin) / dot(n, direction) along the ray.
    return speed != 0 && orientation(t[0], t[1], t[2], ray.origin) * speed >= 0 &&
           (ends_beyond(ray, t) || filtered_side_of_end(ray, t) * speed <= 0);
}

// Where the line meets the plane, kept between the nearest and the farthest vertex along it, and on the ray. The same
// operations as in the kernel's parameters(), and so the same bits.
double parameter(const Ray& ray, const Triangle& t) {
    const Triangle p{t[0] - ray.origin, t[1] - ray.origin, t[2] - ray.origin};
    const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double by_plane = glm::dot(n, p[0]) / glm::dot(n, ray.direction);
    const double per_length = 1.0 / glm::dot(ray.direction, ray.direction);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec3& vertex : p) {
        const double at = glm::dot(vertex, ray.direction) * per_length;
        low = std::min(low, at);
        high = std::max(high, at);
    }
    const double margin = 1e-12 * std::max(std::abs(low), std::abs(high));
    const double least = low - margin, most = high + margin;
    const double kept = by_plane < least ? least : by_plane <= most ? by_plane : most;
    return std::min(std::max(kept, 0.0), ray.max_t) + 0.0;  // never −0
}

// validate(ray) without the words.
bool is_valid(const Ray& ray) {
    const glm::dvec3 sum = ray.origin + ray.direction;
    return std::isfinite(sum.x + sum.y + sum.z) && glm::dot(ray.direction, ray.direction) > 0.0 && ray.max_t >= 0.0;
}

RayAnswer trace(const Ray& ray, const mesh::MeshTree& mesh, bool any) {
    if (mesh.triangle_count() == 0) return {};
    return trace(numbers_of(ray), ray_mesh_of(mesh), any,
                 [&](std::uint32_t leaf, std::uint32_t lane) { return meets(ray, mesh, leaf, lane); });
}

}  // namespace

static_assert(sizeof(Ray) == kRayNumbers * sizeof(double) && offsetof(Ray, direction) == 3 * sizeof(double) &&
              offsetof(Ray, max_t) == 6 * sizeof(double));

const double* numbers_of(const Ray& ray) {
    return reinterpret_cast<const double*>(&ray);
}

RayMesh ray_mesh_of(const MeshTree& mesh) {
    const MeshParts& parts = mesh.parts();
    return {parts.ray_nodes.data(), parts.nodes.data(), parts.leaves.data(), static_cast<double>(mesh.extent())};
}

bool meets(const Ray& ray, const MeshTree& mesh, std::uint32_t leaf, std::uint32_t lane) {
    return meets(ray, triangle_of(mesh.parts().leaves[leaf], lane));
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
    if (!meets(ray, triangle)) return std::nullopt;
    const double t = parameter(ray, triangle);
    if (!(t <= ray.max_t)) return std::nullopt;  // NaN, where coordinates overflow
    return t;
}

std::optional<TriangleHit> raycast(const Ray& ray, const mesh::MeshTree& mesh) {
    if (!is_valid(ray)) return std::nullopt;
    const RayAnswer answer = trace(ray, mesh, false);
    if (!answer.hit) return std::nullopt;
    return TriangleHit{answer.t + 0.0, answer.triangle};
}

bool hits_any(const Ray& ray, const mesh::MeshTree& mesh) {
    return is_valid(ray) && trace(ray, mesh, true).hit;
}

}  // namespace crofton::mesh
