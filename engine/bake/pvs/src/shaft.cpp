// SPDX-License-Identifier: MIT
#include "shaft.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

namespace crofton::pvs {
namespace {

double at(const Plane& plane, const glm::dvec3& p) {
    return glm::dot(plane.normal, p) + plane.offset;
}

// Relative to coordinates: the inside of anything thinner is lost in their rounding.
constexpr double kFlat = 1e-12;

// The plane through p, its normal turned toward `inside`; both are points of the body. False where it has no direction.
// False too where the body is flat: the normal might be turned the wrong way.
bool add_plane(Blocker& body, glm::dvec3 normal, const glm::dvec3& p, const glm::dvec3& inside) {
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    normal /= length;
    const glm::dvec3 way = inside - p;
    const double height = glm::dot(normal, way);
    if (!(std::abs(height) > kFlat * (glm::length(p) + glm::length(inside)))) return false;
    if (height < 0.0) normal = -normal;
    const double offset = -glm::dot(normal, p);
    if (!std::isfinite(offset)) return false;
    for (const Plane& plane : body.planes)
        if (plane.normal == normal && plane.offset == offset) return true;
    body.planes.push_back({normal, offset});
    return true;
}

// Keeps of a segment what is on the kept side of a plane, from which its ends are a and b away. False: nothing is left.
bool cut(double a, double b, double& begin, double& end) {
    if (a < 0.0 && b < 0.0) return false;
    if (a < 0.0) begin = (std::max)(begin, a / (a - b));
    if (b < 0.0) end = (std::min)(end, a / (a - b));
    return begin <= end;
}

bool make_box(Blocker& body, const Corners& c) {
    glm::dvec3 inside(0.0);
    for (const glm::dvec3& p : c) inside += 0.125 * p;
    const glm::dvec3 edge[3] = {c[1] - c[0], c[2] - c[0], c[4] - c[0]};
    for (int k = 0; k < 3; ++k)
        for (const std::size_t corner : {std::size_t{0}, std::size_t{7}})
            if (!add_plane(body, glm::cross(edge[(k + 1) % 3], edge[(k + 2) % 3]), c[corner], inside)) return false;
    return true;
}

// Where all faces of a closed surface are seen from their backs lies within the solid that it bounds.
bool make_hull(Blocker& body, std::span<const glm::dvec3> points, std::span<const std::uint32_t> indices) {
    if (indices.empty()) return false;
    glm::dvec3 inside(0.0);
    for (const std::uint32_t i : indices) inside += points[i] / static_cast<double>(indices.size());
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        const glm::dvec3 a = points[indices[t]], b = points[indices[t + 1]], c = points[indices[t + 2]];
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        if (glm::length(normal) == 0.0) continue;  // a triangle without an area bounds nothing
        if (!add_plane(body, normal, a, inside)) return false;
    }
    return body.planes.size() >= 4;
}

}  // namespace

std::optional<Blocker> blocker_of(const PlacedOccluder& placed, const glm::dvec3& origin) {
    if (!placed.occluder || !validate(placed.to_world)) return std::nullopt;
    const occlude::FoundOccluder& found = *placed.occluder;
    const auto relative = [&](const glm::dvec3& p) {
        return placed.to_world.linear * p + (placed.to_world.translation - origin);
    };
    Blocker body;
    if (found.kind == occlude::OccluderKind::box || found.kind == occlude::OccluderKind::walled) {
        Corners c = corners(found.box);
        for (glm::dvec3& p : c) body.bounds.include(p = relative(p));
        if (!make_box(body, c)) return std::nullopt;
    } else if (found.kind == occlude::OccluderKind::convex) {
        Vector<glm::dvec3> points;
        for (const glm::vec3& p : found.surface.positions) {
            points.push_back(relative(glm::dvec3(p)));
            body.bounds.include(points.back());
        }
        for (const std::uint32_t i : found.surface.indices)
            if (i >= points.size()) return std::nullopt;
        if (found.surface.indices.size() % 3 != 0 || !make_hull(body, points, found.surface.indices))
            return std::nullopt;
    } else {
        return std::nullopt;
    }
    const occlude::EyeLimits limits = occlude::candidate_of(found, placed.to_world).limits;
    body.left_out_within = {limits.left_out_within.min - origin, limits.left_out_within.max - origin};
    for (std::uint32_t i = 0; i < limits.plane_count; ++i) {
        const Plane& plane = limits.planes[i];
        body.eyes.push_back({plane.normal, plane.offset + glm::dot(plane.normal, origin)});
    }
    return body;
}

Corners corners_of(const Aabb& box) {
    Corners c;
    for (unsigned i = 0; i < 8; ++i)
        for (unsigned k = 0; k < 3; ++k) {
            const auto axis = static_cast<int>(k);
            c[i][axis] = i >> k & 1 ? box.max[axis] : box.min[axis];
        }
    return c;
}

bool blocks_all(const Blocker& body, const Corners& eyes, const Corners& object, double margin) {
    constexpr std::size_t kFew = 16;  // planes whose distances are kept
    double from[kFew][8], to[kFew][8];
    const std::size_t count = body.planes.size(), kept = (std::min)(count, kFew);
    for (std::size_t k = 0; k < kept; ++k)
        for (std::size_t i = 0; i < 8; ++i) {
            from[k][i] = at(body.planes[k], eyes[i]) - margin;
            to[k][i] = at(body.planes[k], object[i]) - margin;
        }
    for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = 0; j < 8; ++j) {
            double begin = 0.0, end = 1.0;
            for (std::size_t k = 0; k < count; ++k) {
                const double a = k < kept ? from[k][i] : at(body.planes[k], eyes[i]) - margin;
                const double b = k < kept ? to[k][j] : at(body.planes[k], object[j]) - margin;
                if (!cut(a, b, begin, end)) return false;
            }
        }
    return true;
}

bool blocks(const Blocker& body, const glm::dvec3& p, const glm::dvec3& q, double margin) {
    double begin = 0.0, end = 1.0;
    for (const Plane& plane : body.planes)
        if (!cut(at(plane, p) - margin, at(plane, q) - margin, begin, end)) return false;
    return true;
}

bool may_prove_for(const Blocker& body, const Aabb& eyes, double near_radius, double margin) {
    const glm::dvec3 room(near_radius + margin);
    if (!body.left_out_within.is_empty() && intersects(body.left_out_within, Aabb{eyes.min - room, eyes.max + room}))
        return false;
    for (const Plane& plane : body.eyes) {
        double least = plane.offset - margin;
        for (int k = 0; k < 3; ++k) least += plane.normal[k] * (plane.normal[k] > 0.0 ? eyes.min[k] : eyes.max[k]);
        if (!(least >= 0.0)) return false;
    }
    return true;
}

}  // namespace crofton::pvs
