// SPDX-License-Identifier: MIT
#include "bodies.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace crofton::cli {
namespace {

using std::numbers::pi;

constexpr std::array<std::array<std::uint32_t, 4>, 6> kBoxFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// Faces of a body with a box's combinatorics, outward whatever the corners' handedness.
void add_box_faces(Body& body) {
    const glm::dvec3 center = center_of(body);
    for (const auto& f : kBoxFaces) {
        body.faces.emplace_back(f.begin(), f.end());
        const glm::dvec3 a = body.corners[f[0]];
        glm::dvec3 n = glm::normalize(glm::cross(body.corners[f[1]] - a, body.corners[f[2]] - a));
        if (glm::dot(n, a - center) < 0.0) n = -n;
        body.normals.push_back(n);
    }
}

template <class Points, class Direction>
std::array<double, 2> extent(const Points& points, const Direction& n) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& p : points) {
        const double h = glm::dot(p, n);
        low = std::min(low, h), high = std::max(high, h);
    }
    return {low, high};
}

bool apart(const Body& a, const Body& b, const glm::dvec3& n) {
    const auto s = extent(a.corners, n), t = extent(b.corners, n);
    return s[0] > t[1] || t[0] > s[1];
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = b - a;
    return glm::length(p - a - std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0) * d);
}

// 0 inside.
double distance(const glm::dvec3& p, const Body& body) {
    bool inside = true;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const auto& face = body.faces[f];
        const glm::dvec3& n = body.normals[f];
        const double height = glm::dot(n, p - body.corners[face[0]]);
        if (height <= 0.0) continue;
        inside = false;
        const glm::dvec3 foot = p - height * n;
        int left = 0, right = 0;
        for (std::size_t k = 0; k < face.size(); ++k) {
            const glm::dvec3 &a = body.corners[face[k]], &b = body.corners[face[(k + 1) % face.size()]];
            (glm::dot(glm::cross(b - a, foot - a), n) >= 0.0 ? left : right)++;
            least = std::min(least, distance_to_segment(p, a, b));
        }
        if (left == 0 || right == 0) least = std::min(least, height);
    }
    return inside ? 0.0 : least;
}

// The area of the triangle (0, a, b) within the disc of radius r around 0, signed: sectors where a side is outside.
double disc_area(const glm::dvec2& a, const glm::dvec2& b, double r) {
    const glm::dvec2 d = b - a;
    const auto sector = [&](const glm::dvec2& p, const glm::dvec2& q) {
        return 0.5 * r * r * std::atan2(cross(p, q), glm::dot(p, q));
    };
    const double dd = glm::dot(d, d), ad = glm::dot(a, d), q = ad * ad - dd * (glm::dot(a, a) - r * r);
    if (dd == 0.0) return 0.0;
    if (q <= 0.0) return sector(a, b);
    const double s = std::clamp((-ad - std::sqrt(q)) / dd, 0.0, 1.0),
                 t = std::clamp((-ad + std::sqrt(q)) / dd, 0.0, 1.0);
    const glm::dvec2 enter = a + s * d, leave = a + t * d;
    return s < t ? sector(a, enter) + 0.5 * cross(enter, leave) + sector(leave, b) : sector(a, b);
}

double length_inside(const glm::dvec3& a, const glm::dvec3& b, double r) {
    const glm::dvec3 d = b - a;
    const double dd = glm::dot(d, d), ad = glm::dot(a, d), q = ad * ad - dd * (glm::dot(a, a) - r * r);
    if (q <= 0.0) return 0.0;
    const double s = std::clamp((-ad - std::sqrt(q)) / dd, 0.0, 1.0),
                 t = std::clamp((-ad + std::sqrt(q)) / dd, 0.0, 1.0);
    return (t - s) * std::sqrt(dd);
}

double area_of(const Body& body, std::size_t f) {
    glm::dvec3 sum(0.0);
    const auto& face = body.faces[f];
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
        sum += glm::cross(body.corners[face[k]] - body.corners[face[0]],
                          body.corners[face[k + 1]] - body.corners[face[0]]);
    return 0.5 * glm::length(sum);
}

// The area of all faces within the sphere of radius r around the origin.
double area_inside(const Body& body, double r) {
    double sum = 0.0;
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const auto& face = body.faces[f];
        const double height = glm::dot(body.normals[f], body.corners[face[0]]);
        if (std::abs(height) >= r) continue;
        const auto [x, y] = sampling::orthonormal_frame(body.normals[f]);
        double area = 0.0;
        for (std::size_t k = 0; k < face.size(); ++k) {
            const glm::dvec3 &a = body.corners[face[k]], &b = body.corners[face[(k + 1) % face.size()]];
            area += disc_area({glm::dot(a, x), glm::dot(a, y)}, {glm::dot(b, x), glm::dot(b, y)},
                              std::sqrt(r * r - height * height));
        }
        sum += std::abs(area);
    }
    return sum;
}

}  // namespace

Body box_body(const glm::dvec3& half) {
    Body body;
    for (int i = 0; i < 8; ++i)
        body.corners.emplace_back(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
    add_box_faces(body);
    body.edges = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    return body;
}

Body sphere_body(double radius) {
    return {{glm::dvec3(0.0)}, {}, {}, {}, radius};
}

Body segment_body(double length) {
    return {{{-0.5 * length, 0.0, 0.0}, {0.5 * length, 0.0, 0.0}}, {}, {}, {{1.0, 0.0, 0.0}}, 0.0};
}

Body flat_body(std::vector<glm::dvec3> corners) {
    Body body;
    body.corners = std::move(corners);
    for (std::size_t i = 0; i < body.corners.size(); ++i)
        body.edges.push_back(body.corners[(i + 1) % body.corners.size()] - body.corners[i]);
    const glm::dvec3 n = glm::normalize(glm::cross(body.edges[0], body.edges[1]));
    body.normals = {n};
    return body;
}

Body frustum_body(double tan_x, double tan_y, double near, double far, bool perspective) {
    Body body;
    for (int i = 0; i < 8; ++i) {
        const double d = i & 4 ? far : near, scale = perspective ? d : 1.0;
        body.corners.emplace_back((i & 1 ? tan_x : -tan_x) * scale, (i & 2 ? tan_y : -tan_y) * scale, -d);
    }
    add_box_faces(body);
    body.edges = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    for (std::size_t i = 0; i < 4; ++i) body.edges.push_back(body.corners[i + 4] - body.corners[i]);
    return body;
}

measure::IntrinsicVolumes frustum_volumes(double tan_x, double tan_y, double near, double far, bool perspective) {
    Camera camera;
    camera.projection = perspective ? Projection::perspective : Projection::orthographic;
    camera.fov_y = 2.0 * std::atan(tan_y);
    camera.height = 2.0 * tan_y;
    camera.aspect = tan_x / tan_y;
    camera.near_distance = near, camera.far_distance = far;
    return *measure::intrinsic_volumes_of_frustum(camera);
}

Body moved(const Body& body, const RigidTransform& motion) {
    Body result = body;
    for (glm::dvec3& p : result.corners) p = transform(motion, p);
    for (glm::dvec3& n : result.normals) n = motion.rotation * n;
    for (glm::dvec3& e : result.edges) e = motion.rotation * e;
    return result;
}

glm::dvec3 center_of(const Body& body) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::dvec3& p : body.corners) low = glm::min(low, p), high = glm::max(high, p);
    return 0.5 * (low + high);
}

double radius_about_center(const Body& body) {
    const glm::dvec3 center = center_of(body);
    double r = 0.0;
    for (const glm::dvec3& p : body.corners) r = std::max(r, glm::length(p - center));
    return r + body.radius;
}

Placements::Placements(const Body& moving, const Body& fixed) : middle_(center_of(fixed)) {
    for (const glm::dvec3& p : moving.corners) range_.include(p);
    range_.min -= glm::dvec3(radius_about_center(fixed));
    range_.max += glm::dvec3(radius_about_center(fixed));
}

RigidTransform Placements::motion(const std::array<double, 6>& u) const {
    const RigidTransform uniform = sampling::motion(range_, u);
    return {uniform.rotation, middle_ - uniform.rotation * uniform.translation};
}

double Placements::measure() const {
    const glm::dvec3 size = range_.max - range_.min;
    return size.x * size.y * size.z;
}

bool meet(const Body& a, const Body& b) {
    if (a.radius > 0.0) return distance(a.corners[0], b) <= a.radius;
    if (b.radius > 0.0) return distance(b.corners[0], a) <= b.radius;
    for (const glm::dvec3& n : a.normals)
        if (apart(a, b, n)) return false;
    for (const glm::dvec3& n : b.normals)
        if (apart(a, b, n)) return false;
    for (const glm::dvec3& e : a.edges)
        for (const glm::dvec3& f : b.edges)
            if (apart(a, b, glm::cross(e, f))) return false;
    return true;
}

bool holds(const Body& outer, const Body& inner) {
    for (std::size_t f = 0; f < outer.faces.size(); ++f) {
        const double height = glm::dot(outer.normals[f], outer.corners[outer.faces[f][0]]);
        if (extent(inner.corners, outer.normals[f])[1] > height) return false;
    }
    return true;
}

bool meet(const Figure& a, const Figure& b) {
    for (const Figure* sides : {&a, &b})
        for (std::size_t i = 0; i < sides->size(); ++i) {
            const glm::dvec2 d = (*sides)[(i + 1) % sides->size()] - (*sides)[i];
            const glm::dvec2 n(d.y, -d.x);
            const auto s = extent(a, n), t = extent(b, n);
            if (s[0] > t[1] || t[0] > s[1]) return false;
        }
    return true;
}

bool holds(const Figure& outer, const Figure& inner) {
    for (std::size_t i = 0; i < outer.size(); ++i) {
        const glm::dvec2 &a = outer[i], d = outer[(i + 1) % outer.size()] - a;
        for (const glm::dvec2& p : inner)
            if (cross(d, p - a) < 0.0) return false;
    }
    return true;
}

Figure moved(const Figure& figure, const sampling::PlanarMotion& motion) {
    Figure result;
    for (const glm::dvec2& p : figure) result.push_back(motion(p));
    return result;
}

Anchored anchored(const Body& query, double radius, const std::array<double, 8>& u) {
    RigidTransform motion{sampling::rotation({u[0], u[1], u[2]}), glm::dvec3(0.0)};
    const glm::dvec3 target = radius * sampling::ball_point({u[3], u[4], u[5]});
    const double sphere = 4.0 / 3.0 * pi * radius * radius * radius;
    Anchored result;
    if (query.faces.empty()) {  // a segment
        const glm::dvec3 &a = query.corners[0], &b = query.corners[1];
        motion.translation = target - motion.rotation * (a + u[6] * (b - a));
        result.body = moved(query, motion);
        result.weight =
            sphere * glm::length(b - a) / length_inside(result.body.corners[0], result.body.corners[1], radius);
        return result;
    }
    double whole = 0.0;
    for (std::size_t f = 0; f < query.faces.size(); ++f) whole += area_of(query, f);
    double left = u[7] * whole;
    std::size_t f = 0;
    while (f + 1 < query.faces.size() && left >= area_of(query, f)) left -= area_of(query, f++);
    // A uniform point of a quadrilateral: of one of its two triangles, by area; what is left of u[7] says where along.
    const auto& face = query.faces[f];
    const glm::dvec3 &a = query.corners[face[0]], &b = query.corners[face[1]], &c = query.corners[face[2]],
                     &d = query.corners[face[3]];
    const double first = 0.5 * glm::length(glm::cross(b - a, c - a)), second = area_of(query, f) - first;
    const bool in_first = left < first;
    const double s = std::clamp(in_first ? left / first : (left - first) / second, 0.0, 1.0), r = std::sqrt(u[6]);
    const glm::dvec3 point = a + r * ((1.0 - s) * ((in_first ? b : c) - a) + s * ((in_first ? c : d) - a));
    motion.translation = target - motion.rotation * point;
    result.body = moved(query, motion);
    result.weight = sphere * whole / area_inside(result.body, radius);
    return result;
}

AnchoredFigure anchored(const Figure& query, double radius, const std::array<double, 4>& u) {
    // A segment's boundary is passed once.
    const std::size_t sides = query.size() == 2 ? 1 : query.size();
    const auto side = [&](const Figure& f, std::size_t i) { return f[(i + 1) % f.size()] - f[i]; };
    double whole = 0.0;
    for (std::size_t i = 0; i < sides; ++i) whole += glm::length(side(query, i));
    double left = u[3] * whole;
    std::size_t i = 0;
    while (i + 1 < sides && left >= glm::length(side(query, i))) left -= glm::length(side(query, i++));
    const glm::dvec2 point = query[i] + left / glm::length(side(query, i)) * side(query, i);
    sampling::PlanarMotion motion{sampling::planar_rotation(u[0]), glm::dvec2(0.0)};
    motion.translation = radius * sampling::disc_point({u[1], u[2]}) - motion.rotation * point;
    AnchoredFigure result{moved(query, motion), 0.0};
    double inside = 0.0;
    for (std::size_t k = 0; k < sides; ++k) {
        const glm::dvec2 a = result.figure[k], b = a + side(result.figure, k);
        inside += length_inside({a, 0.0}, {b, 0.0}, radius);
    }
    result.weight = pi * radius * radius * whole / inside;
    return result;
}

}  // namespace crofton::cli
