// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::sampling {
namespace {

struct SurfacePoint {
    glm::dvec3 point;
    glm::dvec3 inward_normal;
};

// A uniform point on the boundary of { center + Σ t_k·edges[k], |t_k| ≤ 1 } with orthogonal half-edges.
SurfacePoint box_surface_point(const glm::dvec3& center, const std::array<glm::dvec3, 3>& axes, const glm::dvec3& half,
                               double choice, double s, double t) {
    const std::array<double, 3> areas = {half.y * half.z, half.z * half.x, half.x * half.y};
    double left = choice * 2.0 * (areas[0] + areas[1] + areas[2]);
    // The last pair also takes the remainder of rounding.
    int k = 0;
    while (k < 2 && left >= 2.0 * areas[static_cast<std::size_t>(k)])
        left -= 2.0 * areas[static_cast<std::size_t>(k++)];
    const double side = left < areas[static_cast<std::size_t>(k)] ? -1.0 : 1.0;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto axis = [&](int n) { return axes[static_cast<std::size_t>(n)]; };
    const glm::dvec3 point =
        center + side * half[k] * axis(k) + (2.0 * s - 1.0) * half[i] * axis(i) + (2.0 * t - 1.0) * half[j] * axis(j);
    return {point, -side * axis(k)};
}

constexpr std::array<glm::dvec3, 3> kWorldAxes = {glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0),
                                                  glm::dvec3(0.0, 0.0, 1.0)};

Line through(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = b - a;
    const double length = glm::length(d);
    return {a, length > 0.0 ? d / length : glm::dvec3(0.0, 0.0, 1.0)};
}

}  // namespace

double measure_of_lines(double surface_area) {
    return 0.5 * std::numbers::pi * surface_area;
}

Line line_through_two_sphere_points(const Sphere& ball, const std::array<double, 4>& u) {
    const glm::dvec3 a = direction({u[0], u[1]}), b = direction({u[2], u[3]});
    Line line = through(a, b);
    line.point = ball.center + ball.radius * a;
    return line;
}

Line line_through_disc(const Sphere& ball, const std::array<double, 4>& u) {
    const glm::dvec3 d = direction({u[0], u[1]});
    const glm::dvec2 p = ball.radius * disc_point({u[2], u[3]});
    const auto [x, y] = orthonormal_frame(d);
    return {ball.center + p.x * x + p.y * y, d};
}

void append_line_bundle(const Sphere& ball, double cell_area, Random& random, Vector<Line>& lines) {
    CROFTON_ASSERT(cell_area > 0.0, "a bundle's cells need an area");
    const glm::dvec3 d = direction(random.point<2>());
    const auto [x, y] = orthonormal_frame(d);
    const glm::dvec2 turn = circle_point(random.uniform());
    const glm::dvec3 right = turn.x * x + turn.y * y, up = turn.x * y - turn.y * x;
    const double cell = std::sqrt(cell_area), r = ball.radius;
    // In separate statements, because compilers evaluate arguments in any order.
    const double shift_up = random.uniform(), shift_right = random.uniform();
    const glm::dvec2 shift(shift_right, shift_up);
    // Cells that can hold a point of the disc: their numbers along one axis, the disc being centred at `shift`.
    const auto count = static_cast<std::int64_t>(std::ceil(r / cell)) + 1;
    CROFTON_ASSERT(count < (std::int64_t{1} << 30), "a bundle of too many cells");
    for (std::int64_t j = -count; j < count; ++j)
        for (std::int64_t i = -count; i < count; ++i) {
            const double s = (static_cast<double>(i) + shift.x + random.uniform()) * cell;
            const double t = (static_cast<double>(j) + shift.y + random.uniform()) * cell;
            if (s * s + t * t <= r * r) lines.push_back({ball.center + s * right + t * up, d});
        }
}

Line line_from_box(const Aabb& box, const std::array<double, 5>& u) {
    const SurfacePoint start = box_surface_point(box.center(), kWorldAxes, box.half_extents(), u[0], u[1], u[2]);
    return {start.point, cosine_direction(start.inward_normal, {u[3], u[4]})};
}

Line line_from_box(const Obb& box, const std::array<double, 5>& u) {
    std::array<glm::dvec3, 3> axes;
    for (int k = 0; k < 3; ++k) axes[static_cast<std::size_t>(k)] = glm::normalize(glm::dvec3(box.axes[k]));
    const SurfacePoint start = box_surface_point(box.center, axes, glm::dvec3(box.half_extents), u[0], u[1], u[2]);
    return {start.point, cosine_direction(start.inward_normal, {u[3], u[4]})};
}

Result<LinesFromHull> LinesFromHull::make(const TriangleMesh& hull) {
    if (auto valid = validate(hull); !valid) return valid.error();
    return detail::recover([&]() -> Result<LinesFromHull> {
        LinesFromHull result;
        double area = 0.0;
        for (std::size_t t = 0; t < hull.triangle_count(); ++t) {
            const auto corner = [&](std::size_t k) { return glm::dvec3(hull.positions[hull.indices[3 * t + k]]); };
            const glm::dvec3 first = corner(1) - corner(0), second = corner(2) - corner(0);
            const glm::dvec3 normal = glm::cross(first, second);
            const double twice_area = glm::length(normal);
            if (twice_area == 0.0) continue;
            result.faces_.push_back({corner(0), first, second, -normal / twice_area});
            result.cumulative_area_.push_back(area += 0.5 * twice_area);
        }
        if (result.faces_.empty())
            return fail(ErrorCode::empty, kNoItem, "lines from a hull: it has no face of positive area");
        return result;
    });
}

Line LinesFromHull::operator()(const std::array<double, 5>& u) const {
    const auto at = std::upper_bound(cumulative_area_.begin(), cumulative_area_.end() - 1, u[0] * area());
    const Face& face = faces_[static_cast<std::size_t>(at - cumulative_area_.begin())];
    double s = u[1], t = u[2];
    if (s + t > 1.0) s = 1.0 - s, t = 1.0 - t;  // fold the parallelogram onto the triangle
    return {face.corner + s * face.first_edge + t * face.second_edge,
            cosine_direction(face.inward_normal, {u[3], u[4]})};
}

}  // namespace crofton::sampling
