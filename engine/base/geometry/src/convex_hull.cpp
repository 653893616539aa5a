// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <memory>
#include <string>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace crofton {
namespace {

constexpr std::uint32_t kNoPoint = ~std::uint32_t{0};
constexpr double kFlat = 1e-12;
constexpr double kStraight = 1e-15;  // distance from a line that rounding of the projection may feign

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

// Qhull writes its messages to a file; this library returns them in the Result.
std::FILE* null_file() {
#if defined(_WIN32)
    return std::fopen("NUL", "w");
#else
    return std::fopen("/dev/null", "w");
#endif
}

// Qhull's state for one hull, freed with it.
class Qhull {
  public:
    Qhull() { qh_zero(&state_, errors_.get()); }
    ~Qhull() {
        qh_freeqhull(&state_, !qh_ALL);
        int current = 0, total = 0;
        qh_memfreeshort(&state_, &current, &total);
    }
    Qhull(const Qhull&) = delete;
    Qhull& operator=(const Qhull&) = delete;

    [[nodiscard]] bool build(std::span<glm::dvec3> points) {
        char options[] = "qhull Qt Pp";
        return errors_ != nullptr && qh_new_qhull(&state_, 3, static_cast<int>(points.size()), &points[0].x, False,
                                                  options, nullptr, errors_.get()) == 0;
    }
    [[nodiscard]] qhT* state() { return &state_; }

  private:
    std::unique_ptr<std::FILE, CloseFile> errors_{null_file()};
    qhT state_;
};

// The input scaled to size about 1, with the original index of each point.
struct Prepared {
    Vector<glm::dvec3> points;
    Vector<std::uint32_t> index;
};

template <class Point>
Result<Prepared> prepare(std::span<const Point> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "convex_hull: no points");
    if (points.size() > (std::size_t{1} << 31))
        return fail(ErrorCode::out_of_range, kNoItem, "convex_hull: more than 2^31 points");
    Aabb bounds;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p(points[i]);
        for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(p[k]))
                return fail(ErrorCode::non_finite, i, {"convex_hull: point ", i, " is NaN or infinite"});
            if (std::abs(p[k]) > kMaxCoordinate)
                return fail(ErrorCode::out_of_range, i, {"convex_hull: point ", i, " exceeds 1e30"});
        }
        bounds.include(p);
    }
    const glm::dvec3 center = bounds.center(), half = bounds.half_extents();
    int exponent = 0;
    std::frexp(std::max({half.x, half.y, half.z}), &exponent);
    const double scale = std::ldexp(1.0, -std::max(exponent, -1000));
    Prepared result;
    result.points.reserve(points.size());
    result.index.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.points.push_back((glm::dvec3(points[i]) - center) * scale);
        result.index[i] = static_cast<std::uint32_t>(i);
    }
    return result;
}

// Returns the point with the greatest `measure`; the first of equals.
template <class Measure>
std::uint32_t argmax(const Vector<glm::dvec3>& points, const Measure& measure) {
    std::uint32_t best = 0;
    double greatest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const double value = measure(points[i]); value > greatest) {
            greatest = value;
            best = static_cast<std::uint32_t>(i);
        }
    return best;
}

// For each of these vertices the first point that is equal to it. Of equal points Qhull takes any, and so does the
// upper chain of a planar hull.
Vector<std::uint32_t> first_of_equal(const Vector<glm::dvec3>& points, Vector<std::uint32_t> vertices) {
    const auto comes_before = [](const glm::dvec3& p, const glm::dvec3& q) {
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    std::sort(vertices.begin(), vertices.end(),
              [&](std::uint32_t i, std::uint32_t j) { return comes_before(points[i], points[j]); });
    Vector<std::uint32_t> first(points.size(), kNoPoint);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto vertex =
            std::lower_bound(vertices.begin(), vertices.end(), points[i],
                             [&](std::uint32_t j, const glm::dvec3& p) { return comes_before(points[j], p); });
        if (vertex != vertices.end() && points[*vertex] == points[i] && first[*vertex] == kNoPoint) first[*vertex] = i;
    }
    return first;
}

// Andrew's monotone chain in the plane spanned by x and y.
void planar_hull(const Vector<glm::dvec3>& points, const glm::dvec3& x, const glm::dvec3& y, ConvexHull& hull) {
    struct Flat {
        glm::dvec2 at;
        std::uint32_t index;
    };
    Vector<Flat> flat;
    flat.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        flat.push_back({{glm::dot(points[i], x), glm::dot(points[i], y)}, static_cast<std::uint32_t>(i)});
    std::sort(flat.begin(), flat.end(), [](const Flat& a, const Flat& b) {
        if (a.at.x != b.at.x) return a.at.x < b.at.x;
        return a.at.y != b.at.y ? a.at.y < b.at.y : a.index < b.index;
    });
    Vector<Flat> chain(2 * flat.size());
    std::size_t size = 0;
    const auto push = [&](const Flat& p, std::size_t floor) {
        if (size > floor && chain[size - 1].at == p.at) return;
        while (size >= floor + 2) {
            const glm::dvec2 a = chain[size - 1].at - chain[size - 2].at, b = p.at - chain[size - 1].at;
            if (a.x * b.y - a.y * b.x > kStraight * (glm::length(a) + glm::length(b))) break;
            --size;
        }
        chain[size++] = p;
    };
    for (const Flat& p : flat) push(p, 0);
    const std::size_t lower = size - 1;
    for (std::size_t i = flat.size() - 1; i-- > 0;) push(flat[i], lower);
    while (size > 1 && chain[size - 1].at == chain[0].at) --size;
    for (std::size_t i = 0; i < size; ++i) hull.vertices.push_back(chain[i].index);
    const Vector<std::uint32_t> first = first_of_equal(points, hull.vertices);
    for (std::uint32_t& i : hull.vertices) i = first[i];
}

// Drops points well inside the polytope of the extreme points along 13 directions.
void drop_inner(Prepared& prepared) {
    constexpr glm::dvec3 kDirections[] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0},
                                          {1, 0, 1},  {1, 0, -1}, {0, 1, 1},  {0, 1, -1}, {1, 1, 1},
                                          {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    Vector<std::uint32_t> extreme;
    for (const glm::dvec3& direction : kDirections) {
        extreme.push_back(argmax(prepared.points, [&](const glm::dvec3& p) { return glm::dot(p, direction); }));
        extreme.push_back(argmax(prepared.points, [&](const glm::dvec3& p) { return -glm::dot(p, direction); }));
    }
    std::sort(extreme.begin(), extreme.end());
    extreme.erase(std::unique(extreme.begin(), extreme.end()), extreme.end());
    Vector<glm::dvec3> corners;
    for (const std::uint32_t i : extreme) corners.push_back(prepared.points[i]);
    Qhull inner;
    if (corners.size() < 4 || !inner.build(corners)) return;
    struct Side {
        glm::dvec3 normal;
        double offset;
    };
    Vector<Side> sides;
    qhT* qh = inner.state();
    facetT* facet;
    FORALLfacets sides.push_back({{facet->normal[0], facet->normal[1], facet->normal[2]}, facet->offset + 1e-9});
    std::size_t kept = 0;
    for (std::size_t i = 0; i < prepared.points.size(); ++i) {
        bool inside = true;
        for (const Side& side : sides)
            if (glm::dot(side.normal, prepared.points[i]) + side.offset >= 0.0) {
                inside = false;
                break;
            }
        if (inside) continue;
        prepared.points[kept] = prepared.points[i];
        prepared.index[kept++] = prepared.index[i];
    }
    prepared.points.resize(kept);
    prepared.index.resize(kept);
}

// Returns false if the points are too flat for Qhull's arithmetic.
bool solid_hull(Prepared& prepared, ConvexHull& hull) {
    if (prepared.points.size() > 1000) drop_inner(prepared);
    Qhull solid;
    if (!solid.build(prepared.points)) return false;
    qhT* qh = solid.state();
    vertexT *vertex, **vertexp;
    facetT* facet;
    Vector<std::array<std::uint32_t, 3>> faces;
    FORALLvertices hull.vertices.push_back(static_cast<std::uint32_t>(qh_pointid(qh, vertex->point)));
    const Vector<std::uint32_t> first = first_of_equal(prepared.points, hull.vertices);
    for (std::uint32_t& i : hull.vertices) i = first[i];
    FORALLfacets {
        std::uint32_t corner[3] = {0, 0, 0};
        int count = 0;
        FOREACHvertex_(facet->vertices) if (count < 3) corner[count++] =
            first[static_cast<std::uint32_t>(qh_pointid(qh, vertex->point))];
        // Qhull keeps the corners of a simplicial facet in the order of their ids; its normal points outward.
        const glm::dvec3 a = prepared.points[corner[0]], b = prepared.points[corner[1]], c = prepared.points[corner[2]];
        if (glm::dot(glm::cross(b - a, c - a), glm::dvec3(facet->normal[0], facet->normal[1], facet->normal[2])) < 0.0)
            std::swap(corner[1], corner[2]);
        std::rotate(corner, std::min_element(corner, corner + 3), corner + 3);
        faces.push_back({corner[0], corner[1], corner[2]});
    }
    // Qhull's order of faces follows roundings that are not ours.
    std::sort(faces.begin(), faces.end());
    for (const auto& face : faces) hull.triangles.insert(hull.triangles.end(), face.begin(), face.end());
    return true;
}

template <class Point>
Result<ConvexHull> hull_of(std::span<const Point> points) {
    Result<Prepared> prepared = prepare(points);
    if (!prepared) return prepared.error();
    const Vector<glm::dvec3>& p = prepared->points;
    ConvexHull hull;
    // A segment, a triangle, a tetrahedron, each as large as a greedy choice makes it: their sizes determine the rank.
    const std::uint32_t a = argmax(p, [](const glm::dvec3& q) { return -q.x - q.y * 1e-3 - q.z * 1e-6; });
    const std::uint32_t b = argmax(p, [&](const glm::dvec3& q) { return glm::distance(q, p[a]); });
    const double size = glm::distance(p[a], p[b]);
    if (!(size > 0.0)) {
        hull.vertices = {0};
        return hull;
    }
    const glm::dvec3 line = (p[b] - p[a]) / size;
    const auto from_line = [&](const glm::dvec3& q) { return glm::length(glm::cross(q - p[a], line)); };
    const std::uint32_t c = argmax(p, from_line);
    if (from_line(p[c]) <= kFlat * size) {
        const std::uint32_t first = argmax(p, [&](const glm::dvec3& q) { return -glm::dot(q, line); });
        const std::uint32_t last = argmax(p, [&](const glm::dvec3& q) { return glm::dot(q, line); });
        hull.rank = 1;
        hull.vertices = {std::min(first, last), std::max(first, last)};
        return hull;
    }
    const glm::dvec3 normal = glm::normalize(glm::cross(line, p[c] - p[a]));
    const auto from_plane = [&](const glm::dvec3& q) { return std::abs(glm::dot(q - p[a], normal)); };
    const std::uint32_t d = argmax(p, from_plane);
    hull.rank = 3;
    if (from_plane(p[d]) <= kFlat * size || !solid_hull(*prepared, hull)) {
        hull = ConvexHull();
        hull.rank = 2;
        planar_hull(p, line, glm::cross(normal, line), hull);
    }
    for (std::uint32_t& i : hull.vertices) i = prepared->index[i];
    for (std::uint32_t& i : hull.triangles) i = prepared->index[i];
    if (hull.rank == 3) std::sort(hull.vertices.begin(), hull.vertices.end());
    return hull;
}

}  // namespace

Result<ConvexHull> convex_hull(std::span<const glm::vec3> points) {
    return detail::recover([&]() -> Result<ConvexHull> { return hull_of(points); });
}
Result<ConvexHull> convex_hull(std::span<const glm::dvec3> points) {
    return detail::recover([&]() -> Result<ConvexHull> { return hull_of(points); });
}

}  // namespace crofton
