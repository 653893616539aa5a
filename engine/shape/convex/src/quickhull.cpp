// SPDX-License-Identifier: MIT
#include "quickhull.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/plane_filter.hpp>
#include <crofton/geometry/predicates.hpp>
#include <glm/geometric.hpp>

namespace crofton::convex {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

// Whether d lies strictly above the plane of a counter-clockwise a, b, c.
bool above(const PlaneFilter& filter, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
           const glm::dvec3& d) {
    const int side = filter.side(d);
    return (side == kUnknownSign ? orientation(a, b, c, d) : side) < 0;
}

bool collinear(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return orientation(glm::dvec2(a.x, a.y), glm::dvec2(b.x, b.y), glm::dvec2(c.x, c.y)) == 0 &&
           orientation(glm::dvec2(a.y, a.z), glm::dvec2(b.y, b.z), glm::dvec2(c.y, c.z)) == 0 &&
           orientation(glm::dvec2(a.z, a.x), glm::dvec2(b.z, b.x), glm::dvec2(c.z, c.x)) == 0;
}

struct HullFace {
    std::array<std::uint32_t, 3> corner{};
    std::array<std::uint32_t, 3> neighbor{};  // across the edge from corner k to the next
    PlaneFilter plane{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0)};
    double depth = 0.0;  // of the center below the plane, times the length of its normal
    Vector<std::uint32_t> outside;
    std::uint32_t farthest = kNone;
    double height = 0.0;  // of the farthest point, relative to the center's depth
    bool alive = true, visible = false;
};

class Builder {
  public:
    explicit Builder(std::span<const glm::dvec3> points) : points_(points) {}

    // False: all points lie on one plane.
    bool start() {
        std::array<std::uint32_t, 4> first{};
        if (!find_tetrahedron(first)) return false;
        if (orientation(at(first[0]), at(first[1]), at(first[2]), at(first[3])) < 0) std::swap(first[1], first[2]);
        center = 0.25 * ((at(first[0]) + at(first[1])) + (at(first[2]) + at(first[3])));
        constexpr std::uint32_t kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
        for (const auto& f : kFaces) add_face(first[f[0]], first[f[1]], first[f[2]]);
        for (std::uint32_t f = 0; f < 4; ++f)
            for (std::uint32_t g = 0; g < 4; ++g)
                if (f != g) link_shared(f, g);
        Vector<std::uint32_t> all(points_.size());
        for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
        distribute(all, 0);
        vertices_ = 4;
        return true;
    }

    // Adds the point that is relatively farthest out; false if there is none.
    bool step() {
        std::uint32_t best = kNone;
        for (std::uint32_t f = 0; f < faces_.size(); ++f)
            if (faces_[f].alive && faces_[f].farthest != kNone &&
                (best == kNone || faces_[f].height > faces_[best].height))
                best = f;
        if (best == kNone) return false;
        insert(faces_[best].farthest, best);
        return true;
    }

    [[nodiscard]] std::size_t vertex_bound() const { return vertices_; }
    [[nodiscard]] ExactHull take() const {
        ExactHull hull;
        hull.center = center;
        Vector<std::uint32_t> left;
        for (const HullFace& face : faces_) {
            if (!face.alive) continue;
            hull.triangles.push_back(face.corner);
            left.insert(left.end(), face.outside.begin(), face.outside.end());
        }
        for (const HullFace& face : faces_) {
            if (!face.alive) continue;
            for (const std::uint32_t i : left) hull.missing = std::max(hull.missing, height_of(face, i));
        }
        return hull;
    }

    glm::dvec3 center{0.0};

  private:
    [[nodiscard]] const glm::dvec3& at(std::uint32_t i) const { return points_[i]; }

    template <class Measure, class Accept>
    std::uint32_t farthest(const Measure& measure, const Accept& accept) const {
        std::uint32_t best = 0;
        double most = -1.0;
        for (std::uint32_t i = 0; i < points_.size(); ++i)
            if (const double value = measure(at(i)); value > most) most = value, best = i;
        if (accept(at(best))) return best;
        for (std::uint32_t i = 0; i < points_.size(); ++i)  // rounding may have shown a bad one
            if (accept(at(i))) return i;
        return kNone;
    }

    bool find_tetrahedron(std::array<std::uint32_t, 4>& first) const {
        const auto before = [](const glm::dvec3& p, const glm::dvec3& q) {
            return p.x != q.x ? p.x < q.x : (p.y != q.y ? p.y < q.y : p.z < q.z);
        };
        first[0] = 0;
        for (std::uint32_t i = 1; i < points_.size(); ++i)
            if (before(at(i), at(first[0]))) first[0] = i;
        const glm::dvec3 a = at(first[0]);
        first[1] = farthest([&](const glm::dvec3& p) { return glm::dot(p - a, p - a); },
                            [&](const glm::dvec3& p) { return p != a; });
        if (first[1] == kNone) return false;
        const glm::dvec3 b = at(first[1]), line = b - a;
        first[2] = farthest(
            [&](const glm::dvec3& p) {
                const glm::dvec3 area = glm::cross(line, p - a);
                return glm::dot(area, area);
            },
            [&](const glm::dvec3& p) { return !collinear(a, b, p); });
        if (first[2] == kNone) return false;
        const glm::dvec3 c = at(first[2]), normal = glm::cross(line, c - a);
        first[3] = farthest([&](const glm::dvec3& p) { return std::abs(glm::dot(normal, p - a)); },
                            [&](const glm::dvec3& p) { return orientation(a, b, c, p) != 0; });
        return first[3] != kNone;
    }

    std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        HullFace face;
        face.corner = {a, b, c};
        face.plane = PlaneFilter(at(a), at(b), at(c));
        face.depth = glm::dot(face.plane.normal, at(a) - center);
        faces_.push_back(std::move(face));
        return static_cast<std::uint32_t>(faces_.size() - 1);
    }

    void link_shared(std::uint32_t f, std::uint32_t g) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                if (faces_[f].corner[i] == faces_[g].corner[(j + 1) % 3] &&
                    faces_[f].corner[(i + 1) % 3] == faces_[g].corner[j])
                    faces_[f].neighbor[i] = g;
    }

    [[nodiscard]] double height_of(const HullFace& face, std::uint32_t i) const {
        const double height = glm::dot(face.plane.normal, at(i) - face.plane.origin);
        return face.depth > 0.0 ? std::max(height, 0.0) / face.depth : 0.0;
    }

    // Gives each point to the first face from `first` on that it lies strictly above.
    void distribute(const Vector<std::uint32_t>& candidates, std::uint32_t first) {
        for (const std::uint32_t i : candidates)
            for (std::uint32_t f = first; f < faces_.size(); ++f) {
                HullFace& face = faces_[f];
                if (!above(face.plane, at(face.corner[0]), at(face.corner[1]), at(face.corner[2]), at(i))) continue;
                const double height = height_of(face, i);
                if (face.farthest == kNone || height > face.height) face.farthest = i, face.height = height;
                face.outside.push_back(i);
                break;
            }
    }

    void insert(std::uint32_t point, std::uint32_t seen_from) {
        // All triangles that the point sees: they are connected.
        Vector<std::uint32_t> visible{seen_from};
        faces_[seen_from].visible = true;
        for (std::size_t k = 0; k < visible.size(); ++k)
            for (const std::uint32_t g : faces_[visible[k]].neighbor) {
                HullFace& face = faces_[g];
                if (face.visible) continue;
                if (!above(face.plane, at(face.corner[0]), at(face.corner[1]), at(face.corner[2]), at(point))) continue;
                face.visible = true;
                visible.push_back(g);
            }
        Vector<std::uint32_t> orphans;
        struct Rim {
            std::uint32_t from, to, beyond;
        };
        Vector<Rim> rim;
        for (const std::uint32_t f : visible) {
            for (std::size_t k = 0; k < 3; ++k)
                if (!faces_[faces_[f].neighbor[k]].visible)
                    rim.push_back({faces_[f].corner[k], faces_[f].corner[(k + 1) % 3], faces_[f].neighbor[k]});
            for (const std::uint32_t i : faces_[f].outside)
                if (i != point) orphans.push_back(i);
            faces_[f].alive = false;
            faces_[f].outside = {};
            faces_[f].farthest = kNone;
        }
        const auto first = static_cast<std::uint32_t>(faces_.size());
        for (const Rim& edge : rim) {
            const std::uint32_t f = add_face(edge.from, edge.to, point);
            link_shared(f, edge.beyond);
            link_shared(edge.beyond, f);
        }
        for (std::uint32_t f = first; f < faces_.size(); ++f)
            for (std::uint32_t g = first; g < faces_.size(); ++g)
                if (faces_[f].corner[1] == faces_[g].corner[0]) faces_[f].neighbor[1] = g, faces_[g].neighbor[2] = f;
        distribute(orphans, first);
        ++vertices_;
    }

    std::span<const glm::dvec3> points_;
    Vector<HullFace> faces_;
    std::size_t vertices_ = 0;
};

}  // namespace

Result<ExactHull> quickhull(std::span<const glm::dvec3> points, std::size_t max_vertices) {
    Builder builder(points);
    if (points.size() < 4 || !builder.start())
        return fail(ErrorCode::degenerate, kNoItem,
                    "hull: the points lie on one plane, line or point; a hull shape needs a volume");
    while (builder.vertex_bound() < max_vertices && builder.step()) {
    }
    return builder.take();
}

Vector<std::uint32_t> corners_of(const ExactHull& hull, std::span<const glm::dvec3> points) {
    // A vertex is no corner iff the planes of its triangles are one or two.
    struct Use {
        std::uint32_t vertex, triangle;
    };
    Vector<Use> uses;
    for (std::uint32_t t = 0; t < hull.triangles.size(); ++t)
        for (const std::uint32_t v : hull.triangles[t]) uses.push_back({v, t});
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.triangle < b.triangle;
    });
    const auto coplanar = [&](std::uint32_t s, std::uint32_t t) {
        const auto& f = hull.triangles[s];
        for (const std::uint32_t v : hull.triangles[t])
            if (orientation(points[f[0]], points[f[1]], points[f[2]], points[v]) != 0) return false;
        return true;
    };
    Vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < uses.size();) {
        Vector<std::uint32_t> planes;
        const std::uint32_t vertex = uses[i].vertex;
        for (; i < uses.size() && uses[i].vertex == vertex; ++i) {
            const std::uint32_t triangle = uses[i].triangle;
            if (planes.size() < 3 &&
                std::none_of(planes.begin(), planes.end(), [&](std::uint32_t p) { return coplanar(p, triangle); }))
                planes.push_back(triangle);
        }
        if (planes.size() >= 3) corners.push_back(vertex);
    }
    return corners;
}

bool contains_all(const ExactHull& hull, std::span<const glm::dvec3> corners, std::span<const glm::dvec3> points) {
    for (const auto& t : hull.triangles) {
        const PlaneFilter plane(corners[t[0]], corners[t[1]], corners[t[2]]);
        for (const glm::dvec3& p : points)
            if (above(plane, corners[t[0]], corners[t[1]], corners[t[2]], p)) return false;
    }
    return true;
}

}  // namespace crofton::convex
