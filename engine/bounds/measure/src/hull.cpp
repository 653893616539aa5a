// SPDX-License-Identifier: MIT
// Measures the convex hull of points.
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>

namespace crofton::measure {

Result<IntrinsicVolumes> intrinsic_volumes_of_hull(std::span<const glm::dvec3> points) {
    return detail::recover([&]() -> Result<IntrinsicVolumes> {
        const auto hull = crofton::convex_hull(points);
        if (!hull) return hull.error();
        const auto corner = [&](std::size_t i) { return points[hull->vertices[i]]; };
        switch (hull->rank) {
            case 0:
                return IntrinsicVolumes{};
            case 1:
                return intrinsic_volumes_of_segment(glm::length(corner(1) - corner(0)));
            case 2: {
                glm::dvec3 twice_area(0.0);
                double perimeter = 0.0;
                const std::size_t n = hull->vertices.size();
                for (std::size_t i = 0; i < n; ++i) {
                    twice_area += glm::cross(corner(i) - corner(0), corner((i + 1) % n) - corner(0));
                    perimeter += glm::length(corner((i + 1) % n) - corner(i));
                }
                return intrinsic_volumes_of_flat_polygon(0.5 * glm::length(twice_area), perimeter);
            }
            default:
                return intrinsic_volumes_of_polytope(points, hull->triangles);
        }
    });
}

}  // namespace crofton::measure
