// SPDX-License-Identifier: MIT
// Triangles that are a closed surface whatever rounding does. Seen from a point that is below all their planes, a ray
// meets each triangle from inside, and it meets some. So the surface winds around the point, which therefore lies in
// the hull of the corners. Nothing rests on the surface being convex: if it is not, fewer points are below all planes.
#include "cloud/interior.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <glm/geometric.hpp>

namespace crofton::fit {
namespace {

// Normals come from differences of coordinates of at most 1: each component is off by less than 1e-14. Of a length of
// at least kLeastNormal, unit normals are off by less than 2e-8, and heights above a plane by less than 8e-8.
constexpr double kLeastNormal = 1e-6, kMargin = 1e-6;
constexpr double kOutside = 1e-9;  // a point this far above a face's plane becomes a corner

struct Face {
    std::array<std::size_t, 3> corners;
    glm::dvec3 normal;  // not of unit length
};

using Points = std::span<const glm::dvec3>;

Face face_of(const Points& points, std::size_t a, std::size_t b, std::size_t c) {
    return {{a, b, c}, glm::cross(points[b] - points[a], points[c] - points[a])};
}

double height_above(const Points& points, const Face& face, std::size_t i) {
    return glm::dot(face.normal, points[i] - points[face.corners[0]]);
}

template <class Measure>
std::size_t greatest(const Points& points, const Measure& measure) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
        if (measure(points[i]) > measure(points[best])) best = i;
    return best;
}

// A tetrahedron of corners far apart, all faces outward; none where the points are flat.
Vector<Face> first_faces(const Points& points) {
    const glm::dvec3 a = points[0];
    const std::size_t b = greatest(points, [&](const glm::dvec3& p) { return glm::dot(p - a, p - a); });
    const glm::dvec3 along = points[b] - a;
    const std::size_t c = greatest(points, [&](const glm::dvec3& p) {
        const glm::dvec3 across = glm::cross(along, p - a);
        return glm::dot(across, across);
    });
    const glm::dvec3 normal = glm::cross(along, points[c] - a);
    const std::size_t d = greatest(points, [&](const glm::dvec3& p) { return std::abs(glm::dot(normal, p - a)); });
    const double volume = glm::dot(normal, points[d] - a);
    if (std::abs(volume) < kLeastNormal * kLeastNormal) return {};
    const std::size_t low = volume < 0.0 ? c : b, high = volume < 0.0 ? b : c;
    return {face_of(points, 0, high, low), face_of(points, 0, low, d), face_of(points, low, high, d),
            face_of(points, high, 0, d)};
}

// Replaces the faces that point i is above by a fan from their border to it. What was closed stays closed.
void include(const Points& points, std::size_t i, Vector<Face>& faces, Vector<std::array<std::size_t, 2>>& border) {
    border.clear();
    std::size_t kept = 0;
    for (const Face& face : faces) {
        if (height_above(points, face, i) <= kOutside) {
            faces[kept++] = face;
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::array edge{face.corners[k], face.corners[(k + 1) % 3]};
            const auto back = std::find(border.begin(), border.end(), std::array{edge[1], edge[0]});
            if (back == border.end())
                border.push_back(edge);
            else
                border.erase(back);
        }
    }
    faces.resize(kept);
    for (const auto& [from, to] : border) faces.push_back(face_of(points, from, to, i));
}

}  // namespace

InteriorTest interior_test(std::span<const glm::dvec3> points) {
    InteriorTest test;
    if (points.size() < 4) return test;
    Vector<Face> faces = first_faces(points);
    Vector<std::array<std::size_t, 2>> border;
    for (std::size_t i = 0; i < points.size() && !faces.empty(); ++i) include(points, i, faces, border);
    if (faces.size() > InteriorTest::kMost) return test;
    for (const Face& face : faces) {
        const double length = glm::length(face.normal);
        if (length < kLeastNormal) return {};
        const glm::dvec3 normal = face.normal / length;
        test.planes[test.count++] = {normal.x, normal.y, normal.z, glm::dot(normal, points[face.corners[0]]) - kMargin};
    }
    return test;
}

}  // namespace crofton::fit
