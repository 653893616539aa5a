// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/near_triangles.hpp>

#include "exact_signs.hpp"
#include "posed_mesh.hpp"

namespace crofton::mesh {
namespace {

// A point off every triangle is never nearer.
constexpr double kLeastSquaredToPoint = 1e-300;
// Coordinates beyond this are out of the range of the tree's search in float.
constexpr double kMostForTree = 1e14;

// A triangle seen from a point. The normal is off by 2^-50 |e| |f|.
struct Seen {
    Seen(const glm::dvec3& point, const Triangle& t)
        : e(t[1] - t[0]), f(t[2] - t[0]), way(point - t[0]), normal(glm::cross(e, f)) {
        along = glm::dot(normal, way);
        squared_normal = glm::dot(normal, normal);
        squared_edges = glm::dot(e, e) * glm::dot(f, f);
    }
    // Whether its plane is surely farther from the point than the root of `squared`. Where the normal's error matters
    // by more than a ten-thousandth, the plane tells nothing.
    [[nodiscard]] bool is_beyond(double squared) const {
        const double along2 = along * along;
        return along2 * 0.999 > squared * squared_normal && along2 > 1e-20 * (squared_edges * glm::dot(way, way));
    }

    glm::dvec3 e, f, way, normal;
    double along, squared_normal, squared_edges;
};

// As closest_on_triangle. Of a triangle that is no sliver the nearest point lies on an edge beyond which the point is,
// else it is the foot of the perpendicular.
glm::dvec3 nearest_on(const glm::dvec3& point, const Triangle& t, const Seen& seen) {
    if (!(seen.squared_normal > 1e-6 * seen.squared_edges)) return closest_on_triangle(point, t);
    ClosestPoints best;
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], &q = t[k == 2 ? 0 : k + 1];
        if (glm::dot(glm::cross(seen.normal, q - p), point - p) >= 0.0) continue;
        inside = false;
        best.offer(point, closest_on_segment(point, p, q));
    }
    return inside ? point - seen.along / seen.squared_normal * seen.normal : best.on_b;
}

}  // namespace

MeshDistance distance_to_point(const MeshTree& mesh, const glm::dvec3& point) {
    MeshDistance result;
    const double reach = std::abs(point.x) + std::abs(point.y) + std::abs(point.z);
    if (mesh.triangle_count() == 0 || !(reach < std::numeric_limits<double>::infinity())) return result;
    const double size = reach + static_cast<double>(mesh.extent());
    // Nearer than rounding tells, each triangle is asked exactly.
    const double doubtful = 1e-12 * size, least = doubtful * doubtful;
    double squared = std::numeric_limits<double>::infinity();  // of what is worth a visit
    double best = squared;
    const auto visit = [&](const MeshLeaf& leaf, std::uint32_t lane) {
        const Triangle triangle = triangle_of(leaf, lane);
        const Seen seen(point, triangle);
        if (seen.is_beyond(squared)) return false;
        const glm::dvec3 nearest = nearest_on(point, triangle, seen), way = point - nearest;
        const double distance = std::max(glm::dot(way, way), kLeastSquaredToPoint);
        const TrianglePair indices{leaf.triangle[lane], 0};
        const bool meets = distance <= least && segment_meets_triangle(point, point, triangle);
        const double now = meets ? 0.0 : distance;
        if (now < best || (now == best && indices.first < result.triangles.first)) {
            best = now;
            squared = std::max(best, least);
            result = {std::sqrt(best), meets ? point : nearest, point, indices};
        }
        return false;
    };
    if (size > kMostForTree) {
        for (const MeshLeaf& leaf : mesh.parts().leaves)
            for (std::uint32_t lane = 0; lane < leaf.count; ++lane) (void)visit(leaf, lane);
        return result;
    }
    // A coordinate in float is off by 2^-24 of itself.
    const glm::vec3 at(point);
    const float rounding = static_cast<float>(0x1p-22 * reach) + std::numeric_limits<float>::min();
    visit_nearest_triangles(mesh.parts().nodes.data(), mesh.parts().leaves, NearPoint{{at.x, at.y, at.z}, rounding},
                            squared, visit);
    return result;
}

}  // namespace crofton::mesh
