// SPDX-License-Identifier: MIT
#include "assets/face_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace crofton::assets {
namespace {

// Beyond this a Delaunay triangulation takes the place of the lightest one: an outline that long is a map, not a face.
constexpr std::size_t kMostCornersOfLightest = 256;
// Some 10 ms at most a face.
constexpr std::uint64_t kWorkPerFace = 1'000'000;
// Turns above this are certain, whatever the projection has rounded. Relative to the squared size.
constexpr double kLeastTurn = 1e-12;
// Places nearer than this share of the face's size may be one, as of coordinates with seven digits; and of how many
// corners at most that is looked at, since it takes the square of their number.
constexpr double kSamePlace = 1e-6;
constexpr std::size_t kMostWelded = 2000;

// Twice the area times the unit normal of the outline (Newell; Sutherland, Sproull and Schumacker 1974).
glm::dvec3 newell_normal(std::span<const glm::dvec3> corners) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        sum += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    return sum;
}

int largest_axis(const glm::dvec3& v) {
    const glm::dvec3 a(std::abs(v.x), std::abs(v.y), std::abs(v.z));
    return a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

// Leaves out the axis that `normal` is closest to: coordinates keep their bits. Counter-clockwise seen along it.
void drop_axis(std::span<const glm::dvec3> corners, const glm::dvec3& normal, Vector<glm::dvec2>& points) {
    const int k = largest_axis(normal);
    const int x = (k + (normal[k] > 0.0 ? 1 : 2)) % 3, y = 3 - k - x;
    points.clear();
    for (const glm::dvec3& p : corners) points.emplace_back(p[x], p[y]);
}

void project(std::span<const glm::dvec3> corners, const glm::dvec3& normal, Vector<glm::dvec2>& points) {
    const int k = largest_axis(normal);
    if (normal[(k + 1) % 3] == 0.0 && normal[(k + 2) % 3] == 0.0) return drop_axis(corners, normal, points);
    const glm::dvec3 n = glm::normalize(normal);
    glm::dvec3 axis(0.0);
    axis[(k + 1) % 3] = 1.0;
    const glm::dvec3 u = glm::normalize(glm::cross(axis, n)), v = glm::cross(n, u);
    points.clear();
    for (const glm::dvec3& p : corners) points.emplace_back(glm::dot(p - corners[0], u), glm::dot(p - corners[0], v));
}

}  // namespace

FaceCut FaceTriangulator::cut(std::span<const glm::dvec3> corners) {
    if (corners.size() == 3) {
        fan(3);
        return FaceCut::convex;
    }
    // By a power of two, so that products neither overflow nor vanish.
    double largest = 0.0;
    for (const glm::dvec3& p : corners) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const int exponent = largest > 0.0 ? std::ilogb(largest) : 0;
    scaled_.clear();
    for (const glm::dvec3& p : corners)
        scaled_.emplace_back(std::scalbn(p.x, -exponent), std::scalbn(p.y, -exponent), std::scalbn(p.z, -exponent));
    polygon_.ring_ends.assign(1, static_cast<std::uint32_t>(corners.size()));
    const glm::dvec3 normal = newell_normal(scaled_);
    if (normal == glm::dvec3(0.0)) {
        fan(corners.size());
        return FaceCut::no_polygon;
    }
    project(scaled_, normal, polygon_.points);
    if (is_convex()) {
        fan(corners.size());
        return FaceCut::convex;
    }
    if (triangulate()) return FaceCut::triangulated;
    // Rounding may have made edges cross that touch.
    drop_axis(scaled_, normal, polygon_.points);
    if (triangulate() || weld_and_triangulate()) return FaceCut::triangulated;
    fan(corners.size());
    return FaceCut::no_polygon;
}

void FaceTriangulator::fan(std::size_t corners) {
    result_.triangles.clear();
    for (std::uint32_t i = 2; i < corners; ++i) result_.triangles.push_back({0, i - 1, i});
}

// Left turns alone, once around.
bool FaceTriangulator::is_convex() const {
    const auto& p = polygon_.points;
    const std::size_t n = p.size();
    double size = 0.0;
    for (const glm::dvec2& q : p) size = std::max({size, std::abs(q.x - p[0].x), std::abs(q.y - p[0].y)});
    const auto points_down = [&](std::size_t i) {
        const glm::dvec2 d = p[(i + 1) % n] - p[i];
        return d.y < 0.0 || (d.y == 0.0 && d.x < 0.0);
    };
    std::size_t rounds = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) > kLeastTurn * size * size)) return false;
        rounds += points_down(i) && !points_down((i + 1) % n);
    }
    return rounds == 1;
}

bool FaceTriangulator::triangulate() {
    triangulate::TriangulateOptions options;
    options.work = kWorkPerFace;
    if (polygon_.points.size() > kMostCornersOfLightest) options.method = triangulate::Method::delaunay;
    return triangulator_.triangulate(polygon_, options, result_).has_value();
}

bool FaceTriangulator::weld_and_triangulate() {
    Vector<glm::dvec2> p = polygon_.points;
    const std::size_t n = p.size();
    if (n > kMostWelded) return false;
    double size = 0.0;
    for (const glm::dvec2& q : p) size = std::max({size, std::abs(q.x - p[0].x), std::abs(q.y - p[0].y)});
    const double near = kSamePlace * size;
    for (std::size_t i = 1; i < n; ++i)
        for (std::size_t j = 0; j < i && p[i] != p[j]; ++j)
            if (glm::distance(p[i], p[j]) <= near) p[i] = p[j];
    polygon_.points.clear();
    corner_of_.clear();
    std::vector<std::pair<double, std::uint32_t>> on_side;  // how far along it, and which corner
    for (std::uint32_t i = 0; i < n; ++i) {
        const glm::dvec2 a = p[i], b = p[(i + 1) % n], along = b - a;
        const double squared = glm::dot(along, along);
        on_side.assign(1, {0.0, i});
        for (std::uint32_t k = 0; k < n; ++k) {
            const double t = glm::dot(p[k] - a, along) / squared;  // NaN where a is b
            if (t > 0.0 && t < 1.0 && p[k] != a && p[k] != b && glm::distance(p[k], a + t * along) <= near)
                on_side.emplace_back(t, k);
        }
        std::sort(on_side.begin(), on_side.end());
        for (const auto& [t, k] : on_side) {
            if (t > 0.0 && p[k] == polygon_.points.back()) continue;
            polygon_.points.push_back(p[k]);
            corner_of_.push_back(k);
        }
    }
    polygon_.ring_ends.assign(1, static_cast<std::uint32_t>(polygon_.points.size()));
    if (!triangulate()) return false;
    for (auto& triangle : result_.triangles)
        for (std::uint32_t& corner : triangle) corner = corner_of_[corner];
    return true;
}

}  // namespace crofton::assets
