// SPDX-License-Identifier: MIT
// Replaces the triangles of a mesh's flat patches by triangulations of minimum weight.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::triangulate {
namespace {

constexpr std::uint32_t kNoPatch = ~std::uint32_t{0};

// The values of a patch, continued from its first triangle.
class ValueField {
  public:
    ValueField(const TriangleMesh& mesh, std::span<const VertexValues> values, std::size_t triangle)
        : mesh_(mesh), values_(values), corner_(&mesh.indices[3 * triangle]) {
        const glm::dvec3 a(mesh.positions[corner_[0]]);
        u_ = glm::dvec3(mesh.positions[corner_[1]]) - a;
        v_ = glm::dvec3(mesh.positions[corner_[2]]) - a;
        normal_ = glm::cross(u_, v_);
    }

    // Of the three corners, only attributes that must be constant can differ.
    [[nodiscard]] bool agrees(std::uint32_t vertex) const {
        if (values_.empty()) return true;
        const glm::dvec3 d = glm::dvec3(mesh_.positions[vertex]) - glm::dvec3(mesh_.positions[corner_[0]]);
        const double square = glm::dot(normal_, normal_);
        const double s = glm::dot(glm::cross(d, v_), normal_) / square;
        const double t = glm::dot(glm::cross(u_, d), normal_) / square;
        for (const VertexValues& field : values_) {
            const auto at = [&](std::uint32_t v, std::size_t k) {
                return static_cast<double>(field.values[v * field.components + k]);
            };
            for (std::size_t k = 0; k < field.components; ++k) {
                const double a = at(corner_[0], k), own = at(vertex, k);
                const double expected =
                    field.constant ? a : a + s * (at(corner_[1], k) - a) + t * (at(corner_[2], k) - a);
                const bool corner = vertex == corner_[0] || vertex == corner_[1] || vertex == corner_[2];
                // Rounding of s and t is no difference at the corners themselves.
                if (corner && !field.constant ? !std::isfinite(own) : !(std::fabs(own - expected) <= field.tolerance))
                    return false;
            }
        }
        return true;
    }

  private:
    const TriangleMesh& mesh_;
    std::span<const VertexValues> values_;
    const std::uint32_t* corner_;
    glm::dvec3 u_, v_, normal_;
};

class PatchFinder {
  public:
    PatchFinder(const TriangleMesh& mesh, double tolerance, std::span<const VertexValues> values)
        : mesh_(mesh), tolerance_(tolerance), values_(values) {}

    Vector<PlanarPatch> find() {
        find_partners();
        const auto count = static_cast<std::uint32_t>(mesh_.triangle_count());
        patch_of_.assign(count, kNoPatch);
        start_.assign(mesh_.positions.size(), kNoPatch);
        local_.assign(mesh_.positions.size(), kNoPatch);
        Vector<PlanarPatch> patches;
        for (std::uint32_t seed = 0; seed < count; ++seed) {
            if (patch_of_[seed] != kNoPatch || normal(seed) == glm::dvec3(0.0)) continue;
            grow(seed);
            if (members_.size() > 1) patches.push_back(make_patch(seed));
        }
        return patches;
    }

  private:
    [[nodiscard]] std::uint32_t corner(std::size_t side) const { return mesh_.indices[side]; }
    [[nodiscard]] static std::size_t next(std::size_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
    [[nodiscard]] glm::dvec3 position(std::uint32_t v) const { return glm::dvec3(mesh_.positions[v]); }
    [[nodiscard]] glm::dvec3 normal(std::size_t triangle) const {
        const glm::dvec3 a = position(corner(3 * triangle)), b = position(corner(3 * triangle + 1));
        return glm::cross(b - a, position(corner(3 * triangle + 2)) - a);
    }

    // partner_[side] is the one side that runs the other way, if neither has any other.
    void find_partners() {
        struct Side {
            std::uint32_t low, high, side;
        };
        Vector<Side> sides(mesh_.indices.size());
        for (std::uint32_t s = 0; s < sides.size(); ++s) {
            const std::uint32_t a = corner(s), b = corner(next(s));
            sides[s] = {std::min(a, b), std::max(a, b), s};
        }
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return std::tie(a.low, a.high, a.side) < std::tie(b.low, b.high, b.side);
        });
        partner_.assign(sides.size(), kNoPatch);
        for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
            for (j = i; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
            if (j != i + 2 || corner(sides[i].side) == corner(sides[i + 1].side)) continue;
            partner_[sides[i].side] = sides[i + 1].side;
            partner_[sides[i + 1].side] = sides[i].side;
        }
    }

    void grow(std::uint32_t seed) {
        const glm::dvec3 a = position(corner(3 * seed)), b = position(corner(3 * seed + 1)),
                         c = position(corner(3 * seed + 2));
        const glm::dvec3 n = normal(seed);
        const glm::dvec3 unit = n / glm::length(n);
        const auto in_plane = [&](const glm::dvec3& p) {
            return tolerance_ > 0.0 ? std::fabs(glm::dot(unit, p - a)) <= tolerance_ : orientation(a, b, c, p) == 0;
        };
        const ValueField field(mesh_, values_, seed);
        members_.assign(1, seed);
        patch_of_[seed] = seed;
        for (std::size_t k = 0; k < 3; ++k)
            if (!field.agrees(corner(3 * std::size_t{seed} + k))) return;
        for (std::size_t i = 0; i < members_.size(); ++i) {
            for (std::size_t side = 3 * members_[i]; side < 3 * members_[i] + 3; ++side) {
                if (partner_[side] == kNoPatch) continue;
                const std::uint32_t other = partner_[side] / 3;
                if (patch_of_[other] != kNoPatch || glm::dot(normal(other), n) <= 0.0) continue;
                const std::uint32_t apex = corner(next(next(partner_[side])));
                if (!in_plane(position(apex)) || !field.agrees(apex)) continue;
                patch_of_[other] = seed;
                members_.push_back(other);
            }
        }
        std::sort(members_.begin(), members_.end());
    }

    PlanarPatch make_patch(std::uint32_t seed) {
        PlanarPatch patch;
        patch.triangles.assign(members_.begin(), members_.end());
        const glm::dvec3 n = glm::normalize(normal(seed));
        // An axis-parallel plane drops its axis, which is exact; any other gets an orthonormal frame.
        const glm::dvec3 helper = std::fabs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        glm::dvec3 u = glm::normalize(glm::cross(helper, n)), v = glm::cross(n, u);
        for (int axis = 0; axis < 3; ++axis) {
            if (std::fabs(n[axis]) < 1.0) continue;
            u = v = glm::dvec3(0.0);
            u[(axis + 1) % 3] = 1.0;
            v[(axis + 2) % 3] = n[axis];
        }
        const glm::dvec3 origin = position(corner(3 * seed));
        for (const std::uint32_t t : members_) {
            for (std::size_t side = 3 * t; side < 3 * t + 3; ++side) {
                const std::uint32_t p = partner_[side];
                const bool inner = p != kNoPatch && patch_of_[p / 3] == seed;
                if (inner && side < p)
                    patch.weight += glm::distance(position(corner(side)), position(corner(next(side))));
                if (!inner) boundary_.push_back({static_cast<std::uint32_t>(side), start_[corner(side)]});
                if (!inner) start_[corner(side)] = static_cast<std::uint32_t>(boundary_.size() - 1);
            }
        }
        const auto add = [&](std::uint32_t vertex) {
            const glm::dvec3 d = position(vertex) - origin;
            patch.polygon.points.emplace_back(glm::dot(d, u), glm::dot(d, v));
            patch.vertices.push_back(vertex);
            local_[vertex] = seed;
        };
        collect_rings(patch, add);
        put_outer_ring_first(patch);
        for (const std::uint32_t t : members_) {
            for (std::size_t side = 3 * t; side < 3 * t + 3; ++side) {
                if (local_[corner(side)] == seed) continue;
                add(corner(side));
                patch.polygon.ring_ends.push_back(static_cast<std::uint32_t>(patch.polygon.points.size()));
            }
        }
        boundary_.clear();
        return patch;
    }

    // Follows boundary sides from vertex to vertex; where rings touch, any way on leaves closed rings.
    template <class Add>
    void collect_rings(PlanarPatch& patch, Add add) {
        for (std::size_t i = 0; i < boundary_.size(); ++i) {
            const std::uint32_t first = corner(boundary_[i].side);
            if (start_[first] == kNoPatch) continue;
            std::uint32_t vertex = first;
            while (start_[vertex] != kNoPatch) {
                add(vertex);
                const Boundary& side = boundary_[start_[vertex]];
                start_[vertex] = side.next;
                vertex = corner(next(side.side));
            }
            patch.polygon.ring_ends.push_back(static_cast<std::uint32_t>(patch.polygon.points.size()));
        }
    }

    static void put_outer_ring_first(PlanarPatch& patch) {
        auto& polygon = patch.polygon;
        std::size_t outer = 0;
        double largest = 0.0;
        for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
            const auto ring = polygon.ring(r);
            double area = 0.0;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const auto &p = ring[i], &q = ring[i + 1 == ring.size() ? 0 : i + 1];
                area += p.x * q.y - p.y * q.x;
            }
            if (std::fabs(area) > largest) largest = std::fabs(area), outer = r;
        }
        if (outer == 0) return;
        const auto begin = polygon.ring_ends[outer - 1], end = polygon.ring_ends[outer];
        std::rotate(polygon.points.begin(), polygon.points.begin() + begin, polygon.points.begin() + end);
        std::rotate(patch.vertices.begin(), patch.vertices.begin() + begin, patch.vertices.begin() + end);
        for (std::size_t r = outer; r > 0; --r) polygon.ring_ends[r] = polygon.ring_ends[r - 1] + (end - begin);
        polygon.ring_ends[0] = end - begin;
    }

    struct Boundary {
        std::uint32_t side, next;  // the next one that starts at the same vertex
    };

    const TriangleMesh& mesh_;
    double tolerance_;
    std::span<const VertexValues> values_;
    Vector<std::uint32_t> partner_, patch_of_, members_, start_, local_;
    Vector<Boundary> boundary_;
};

glm::dvec3 normal_of(const TriangleMesh& mesh, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const glm::dvec3 a(mesh.positions[i]);
    return glm::cross(glm::dvec3(mesh.positions[j]) - a, glm::dvec3(mesh.positions[k]) - a);
}

// Why the triangles of `result` cannot stand for those of the patch; empty where they can.
std::string mismatch(const TriangleMesh& mesh, const PlanarPatch& patch, const Triangulation& result) {
    if (result.triangles.size() != patch.triangles.size())
        return "it overlaps itself: its rings enclose something else";
    glm::dvec3 facing(0.0);
    double area_before = 0.0, area_after = 0.0;
    for (const std::size_t t : patch.triangles) {
        const glm::dvec3 m = normal_of(mesh, mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
        if (facing == glm::dvec3(0.0)) facing = glm::normalize(m);
        area_before += glm::dot(m, facing);
    }
    for (const auto& t : result.triangles) {
        const std::uint32_t i = patch.vertices[t[0]], j = patch.vertices[t[1]], k = patch.vertices[t[2]];
        const glm::dvec3 a(mesh.positions[i]), b(mesh.positions[j]), c(mesh.positions[k]);
        const glm::dvec3 m = normal_of(mesh, i, j, k);
        const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)});
        // At least a millionth as high as long: what rounding makes of three collinear vertices is not.
        if (glm::dot(m, facing) <= 1e-6 * longest)
            return "vertices " + std::to_string(i) + ", " + std::to_string(j) + " and " + std::to_string(k) +
                   " are collinear up to rounding, and would make a triangle without area";
        area_after += glm::dot(m, facing);
    }
    if (!(std::fabs(area_after - area_before) <= 1e-9 * area_before))
        return "it overlaps itself: its rings enclose another area";
    return {};
}

PatchResult describe(const PlanarPatch& patch, std::string refused, bool lighter, const Triangulation& result) {
    const bool usable = refused.empty();
    PatchResult r;
    r.refused = std::move(refused);
    r.triangles = patch.triangles;
    r.vertices = patch.polygon.points.size();
    r.holes = patch.polygon.ring_count() - 1;
    r.weight_before = patch.weight;
    r.weight_after = lighter ? result.weight : patch.weight;
    r.optimal = usable && result.optimal;
    // A patch that stays unchanged is as near to the minimum as its weight is to the bound of the new triangulation.
    const double factor = usable && result.weight > 0.0 ? r.weight_after / result.weight : 1.0;
    r.gap = usable ? (r.optimal ? 0.0 : std::max(0.0, (1.0 + result.gap) * factor - 1.0))
                   : std::numeric_limits<double>::infinity();
    return r;
}

}  // namespace

Result<Vector<PlanarPatch>> find_planar_patches(const TriangleMesh& mesh, double tolerance,
                                                std::span<const VertexValues> values) {
    return detail::recover([&]() -> Result<Vector<PlanarPatch>> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        for (std::size_t i = 0; i < values.size(); ++i)
            if (values[i].values.size() != values[i].components * mesh.positions.size())
                return fail(ErrorCode::invalid_argument, i,
                            {"vertex values ", i, ": not `components` for each vertex"});
        return PatchFinder(mesh, tolerance, values).find();
    });
}

Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options) {
    return detail::recover([&]() -> Result<PatchReport> {
        auto patches = find_planar_patches(mesh, options.tolerance, options.values);
        if (!patches) return patches.error();
        PatchReport report;
        Triangulator triangulator;
        Triangulation result;
        Vector<std::uint32_t> indices = mesh.indices;  // the mesh changes when nothing can fail any more
        for (const PlanarPatch& patch : *patches) {
            ++report.patches;
            report.triangles += patch.triangles.size();
            report.weight_before += patch.weight;
            const auto begin = std::chrono::steady_clock::now();
            const auto done = triangulator.triangulate(patch.polygon, options.triangulation, result);
            if (!done && (done.error().code == ErrorCode::cancelled || done.error().code == ErrorCode::out_of_memory))
                return done.error();
            std::string refused = done ? mismatch(mesh, patch, result) : done.error().message;
            const bool usable = refused.empty();
            report.refused += !usable;
            if (!usable || (options.triangulation.method == Method::minimum_weight && !result.optimal))
                ++report.unproven;
            // Ignores differences below the rounding of the projection.
            const bool lighter = usable && result.weight < patch.weight * (1.0 - 1e-12);
            report.weight_after += lighter ? result.weight : patch.weight;
            report.results.push_back(describe(patch, std::move(refused), lighter, result));
            const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
            report.results.back().microseconds = time.count();
            if (!lighter) continue;
            ++report.improved;
            for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    indices[3 * std::size_t{patch.triangles[i]} + k] = patch.vertices[result.triangles[i][k]];
                }
            }
        }
        mesh.indices.swap(indices);
        return report;
    });
}

}  // namespace crofton::triangulate
