// SPDX-License-Identifier: MIT
// T-junctions mended: a vertex on the side of a triangle becomes a corner of the triangles it is cut into.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

namespace crofton::radiosity {
namespace {

// Where along a side points may lie, so that they are collinear in double without rounding.
constexpr double kSteps = 1 << 20;

using Cell = std::array<std::int64_t, 3>;

// The distinct positions of a mesh in cells of a grid, to find those near a segment.
class PointGrid {
  public:
    PointGrid(const TriangleMesh& mesh, double cell) : cell_(cell) {
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
            entries_.push_back({key(cell_of(mesh.positions[v])), v});
        const auto before = [&](const Entry& a, const Entry& b) {
            if (a.key != b.key) return a.key < b.key;
            const glm::vec3 &p = mesh.positions[a.vertex], &q = mesh.positions[b.vertex];
            if (p.x != q.x) return p.x < q.x;
            if (p.y != q.y) return p.y < q.y;
            if (p.z != q.z) return p.z < q.z;
            return a.vertex < b.vertex;
        };
        std::sort(entries_.begin(), entries_.end(), before);
        entries_.erase(std::unique(entries_.begin(), entries_.end(),
                                   [&](const Entry& a, const Entry& b) {
                                       return a.key == b.key && mesh.positions[a.vertex] == mesh.positions[b.vertex];
                                   }),
                       entries_.end());
        heads_.assign(std::bit_ceil(entries_.size() + 1) * 2, kNone);
        for (std::uint32_t e = 0; e < entries_.size(); ++e)
            if (e == 0 || entries_[e].key != entries_[e - 1].key) {
                std::size_t slot = slot_of(entries_[e].key);
                while (heads_[slot] != kNone) slot = (slot + 1) & (heads_.size() - 1);
                heads_[slot] = e;
            }
    }

    // Calls visit(vertex) for the positions in cells that the box touches.
    template <class Visit>
    void near(const glm::dvec3& low, const glm::dvec3& high, Visit&& visit) const {
        const Cell a = cell_of(low), b = cell_of(high);
        for (std::int64_t x = a[0]; x <= b[0]; ++x)
            for (std::int64_t y = a[1]; y <= b[1]; ++y)
                for (std::int64_t z = a[2]; z <= b[2]; ++z) {
                    const std::uint64_t wanted = key({x, y, z});
                    for (std::size_t slot = slot_of(wanted); heads_[slot] != kNone;
                         slot = (slot + 1) & (heads_.size() - 1)) {
                        std::uint32_t e = heads_[slot];
                        if (entries_[e].key != wanted) continue;
                        for (; e < entries_.size() && entries_[e].key == wanted; ++e) visit(entries_[e].vertex);
                        break;
                    }
                }
    }

  private:
    struct Entry {
        std::uint64_t key;
        std::uint32_t vertex;
    };
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    [[nodiscard]] Cell cell_of(const glm::dvec3& p) const {
        Cell c;
        for (int k = 0; k < 3; ++k)
            c[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(std::clamp(p[k] / cell_, -1e6, 1e6)));
        return c;
    }
    static std::uint64_t key(const Cell& c) {
        std::uint64_t result = 0;
        for (const std::int64_t x : c) result = result << 21 | (static_cast<std::uint64_t>(x) & 0x1fffffu);
        return result;
    }
    [[nodiscard]] std::size_t slot_of(std::uint64_t k) const {
        k = (k ^ k >> 31) * 0x9e3779b97f4a7c15u;
        return static_cast<std::size_t>(k >> 20) & (heads_.size() - 1);
    }

    double cell_;
    Vector<Entry> entries_;
    Vector<std::uint32_t> heads_;
};

struct OnSide {
    double at = 0.0;  // 0 … 1 along the side
    std::uint32_t vertex = 0;
};

// Vertices within `tolerance` of the side a–b, ends left out, in order along it.
void points_on_side(const TriangleMesh& mesh, const PointGrid& grid, double cell, double tolerance, std::uint32_t a,
                    std::uint32_t b, Vector<OnSide>& result) {
    const glm::dvec3 p(mesh.positions[a]), q(mesh.positions[b]), d = q - p;
    const double length = glm::length(d);
    result.clear();
    if (!(length > 2.0 * tolerance)) return;
    const auto pieces = static_cast<std::size_t>(std::ceil(std::min(length / cell, 1e6)));
    for (std::size_t k = 0; k < pieces; ++k) {
        const double n = static_cast<double>(pieces), s = static_cast<double>(k) / n,
                     t = static_cast<double>(k + 1) / n;
        const glm::dvec3 u = p + s * d, v = p + t * d;
        grid.near(glm::min(u, v) - tolerance, glm::max(u, v) + tolerance, [&](std::uint32_t vertex) {
            const glm::dvec3 x(mesh.positions[vertex]);
            const double along = glm::dot(x - p, d) / (length * length);
            if (along < s || along >= t) return;
            if (along * length <= tolerance || (1.0 - along) * length <= tolerance) return;
            if (glm::length(x - p - along * d) <= tolerance) result.push_back({along, vertex});
        });
    }
    std::sort(result.begin(), result.end(),
              [](const OnSide& x, const OnSide& y) { return x.at != y.at ? x.at < y.at : x.vertex < y.vertex; });
    // Keep the first of the points on one step.
    result.erase(std::unique(result.begin(), result.end(),
                             [](const OnSide& x, const OnSide& y) {
                                 return std::round(x.at * kSteps) == std::round(y.at * kSteps);
                             }),
                 result.end());
}

// The triangle's outline in its own plane, the points on its sides exactly on them.
struct Outline {
    Polygon polygon;
    Vector<std::uint32_t> vertices;
};

class Mender {
  public:
    Mender(const TriangleMesh& mesh, double tolerance) : mesh_(mesh), tolerance_(tolerance) {
        double sides = 0.0;
        for (std::size_t i = 0; i < mesh.indices.size(); ++i)
            sides += glm::length(position(mesh.indices[i]) - position(mesh.indices[i / 3 * 3 + (i + 1) % 3]));
        cell_ = std::max(sides / static_cast<double>(std::max<std::size_t>(1, mesh.indices.size())), 4.0 * tolerance);
    }

    RefinedMesh mend() {
        RefinedMesh result;
        result.mesh.positions = mesh_.positions;
        result.mesh.colors = mesh_.colors;
        const PointGrid grid(mesh_, cell_);
        Vector<OnSide> side;
        for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
            const std::uint32_t* v = &mesh_.indices[3 * t];
            begin_outline(v);
            for (std::size_t e = 0; e < 3; ++e) {
                points_on_side(mesh_, grid, cell_, tolerance_, v[e], v[(e + 1) % 3], side);
                add_side(v, e, side);
            }
            emit(t, result);
        }
        return result;
    }

  private:
    [[nodiscard]] glm::dvec3 position(std::uint32_t v) const { return glm::dvec3(mesh_.positions[v]); }

    // (0, 0), (1, 0) and (x, y) on a lattice of 2^-20: similar to the triangle up to that.
    void begin_outline(const std::uint32_t* v) {
        const glm::dvec3 side = position(v[1]) - position(v[0]), other = position(v[2]) - position(v[0]);
        const double square = glm::dot(side, side);
        const double x = glm::dot(other, side) / square, y = glm::length(glm::cross(side, other)) / square;
        const auto on_lattice = [](double u) { return std::round(u * kSteps) / kSteps; };
        corners_ = {
            glm::dvec2(0.0), glm::dvec2(1.0, 0.0),
            glm::dvec2(on_lattice(std::clamp(x, -1e6, 1e6)), std::max(1.0 / kSteps, on_lattice(std::min(y, 1e6))))};
        outline_.polygon.points.clear();
        outline_.vertices.clear();
    }

    void add_side(const std::uint32_t* v, std::size_t e, const Vector<OnSide>& side) {
        const glm::dvec2 a = corners_[e], b = corners_[(e + 1) % 3];
        outline_.polygon.points.push_back(a);
        outline_.vertices.push_back(v[e]);
        for (const OnSide& point : side) {
            const double at = std::clamp(std::round(point.at * kSteps), 1.0, kSteps - 1.0) / kSteps;
            outline_.polygon.points.push_back(a + at * (b - a));
            outline_.vertices.push_back(point.vertex);
        }
    }

    void emit(std::uint32_t t, RefinedMesh& result) {
        const std::uint32_t* v = &mesh_.indices[3 * t];
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            // New corners keep the triangle's own colours.
            const std::array<std::uint32_t, 3> corner = {own(v, a, result), own(v, b, result), own(v, c, result)};
            result.mesh.indices.insert(result.mesh.indices.end(), corner.begin(), corner.end());
            result.source.push_back(t);
        };
        if (outline_.vertices.size() > 3) {
            outline_.polygon.ring_ends.assign(1, static_cast<std::uint32_t>(outline_.vertices.size()));
            if (triangulator_.triangulate(outline_.polygon, {}, triangulation_)) {
                for (const auto& triangle : triangulation_.triangles)
                    if (has_area(triangle)) add(triangle[0], triangle[1], triangle[2]);
                return;
            }
        }
        result.mesh.indices.insert(result.mesh.indices.end(), {v[0], v[1], v[2]});
        result.source.push_back(t);
    }

    [[nodiscard]] bool has_area(const std::array<std::uint32_t, 3>& triangle) const {
        const auto at = [&](std::size_t k) { return position(outline_.vertices[triangle[k]]); };
        return glm::length(glm::cross(at(1) - at(0), at(2) - at(0))) > 0.0;
    }

    // The outline's vertex k as a vertex of the result: a corner is itself, a point on a side is new.
    std::uint32_t own(const std::uint32_t* v, std::uint32_t k, RefinedMesh& result) {
        const std::uint32_t vertex = outline_.vertices[k];
        for (int c = 0; c < 3; ++c)
            if (v[c] == vertex) return vertex;
        TriangleMesh& mesh = result.mesh;
        mesh.positions.push_back(mesh_.positions[vertex]);
        if (!mesh.colors.empty()) {
            const glm::dvec2 p = outline_.polygon.points[k];
            // Barycentric coordinates with respect to (0, 0), (1, 0), (x, y).
            const float c = static_cast<float>(p.y / corners_[2].y);
            const float b = static_cast<float>(p.x - p.y / corners_[2].y * corners_[2].x);
            mesh.colors.push_back((1.0f - b - c) * mesh.colors[v[0]] + b * mesh.colors[v[1]] + c * mesh.colors[v[2]]);
        }
        return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }

    const TriangleMesh& mesh_;
    double tolerance_, cell_ = 1.0;
    std::array<glm::dvec2, 3> corners_;
    Outline outline_;
    triangulate::Triangulator triangulator_;
    triangulate::Triangulation triangulation_;
};

}  // namespace

Result<RefinedMesh> mend_t_junctions(const TriangleMesh& mesh, double tolerance) {
    return crofton::detail::recover([&]() -> Result<RefinedMesh> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        if (!(tolerance >= 0.0))
            return fail(ErrorCode::out_of_range, kNoItem, "mending: the tolerance must not be negative");
        if (mesh.indices.empty()) return RefinedMesh{mesh, {}};
        return Mender(mesh, tolerance).mend();
    });
}

}  // namespace crofton::radiosity
