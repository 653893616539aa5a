// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::measure {

using std::numbers::pi;

IntrinsicVolumes intrinsic_volumes_of_box(double a, double b, double c) {
    return {a * b * c, 2.0 * (a * b + b * c + c * a), pi * (a + b + c)};
}

IntrinsicVolumes intrinsic_volumes_of_box(const Obb& box) {
    return {volume(box), surface_area(box), pi * edge_sum(box)};
}

IntrinsicVolumes intrinsic_volumes_of_sphere(double radius) {
    return {4.0 / 3.0 * pi * radius * radius * radius, 4.0 * pi * radius * radius, 4.0 * pi * radius};
}

IntrinsicVolumes intrinsic_volumes_of_segment(double length) {
    return {0.0, 0.0, pi * length};
}

IntrinsicVolumes intrinsic_volumes_of_flat_polygon(double area, double perimeter) {
    return {0.0, 2.0 * area, 0.5 * pi * perimeter};
}

Result<IntrinsicVolumes> intrinsic_volumes_of_frustum(const Camera& camera) {
    if (!std::isfinite(camera.far_distance))
        return fail(ErrorCode::invalid_argument, kNoItem, "frustum: its measures need a finite far distance");
    auto frustum = frustum_of(camera);
    if (!frustum) return frustum.error();
    const auto corners = frustum_corners(*frustum);
    if (!corners) return corners.error();
    // Faces as quads of corner numbers (see frustum_corners), in the order of the frustum's planes.
    constexpr std::array<std::array<unsigned, 4>, 6> faces = {
        {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    const auto& p = *corners;
    IntrinsicVolumes result;
    for (std::size_t f = 0; f < 6; ++f) {
        const auto& q = faces[f];
        const double face_area = 0.5 * glm::length(glm::cross(p[q[2]] - p[q[0]], p[q[3]] - p[q[1]]));
        result.area += face_area;
        // Pyramids from corner 0 over the faces not through it; normals point inward, so the height is dot(n, c0) +
        // offset.
        const Plane& plane = frustum->planes[f];
        result.volume += face_area * (glm::dot(plane.normal, p[0]) + plane.offset) / 3.0;
    }
    // Edges: where two faces that are not opposite meet. Exterior dihedral angle = angle between outward normals.
    for (std::size_t f = 0; f < 6; ++f)
        for (std::size_t g = f + 1; g < 6; ++g) {
            if (f / 2 == g / 2) continue;
            glm::dvec3 ends[2];
            int found = 0;
            for (const unsigned a : faces[f])
                for (const unsigned b : faces[g])
                    if (a == b && found < 2) ends[found++] = p[a];
            const glm::dvec3& m = frustum->planes[f].normal;
            const glm::dvec3& n = frustum->planes[g].normal;
            const double angle = arc_tangent(glm::length(glm::cross(m, n)), glm::dot(m, n));
            result.mean_curvature += 0.5 * glm::length(ends[1] - ends[0]) * angle;
        }
    return result;
}

double kinematic_measure(const IntrinsicVolumes& b, const IntrinsicVolumes& k) {
    return b.volume + k.volume + (b.area * k.mean_curvature + k.area * b.mean_curvature) / (4.0 * pi);
}

double triangles_met(const IntrinsicVolumes& b, const TriangulationMeasures& t) {
    return t.triangles * b.volume + t.area * b.mean_curvature / (2.0 * pi) +
           b.area / 8.0 * (t.boundary + 2.0 * t.weight);
}

}  // namespace crofton::measure
