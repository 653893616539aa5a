#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <crofton/triangulate/planar_patches.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::triangulate {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

class PatchFinder {
  public:
    PatchFinder(const TriangleMesh& mesh, double tolerance) : mesh_(mesh), tolerance_(tolerance) {}

    Vector<PlanarPatch> find() {
        find_partners();
        const auto count = static_cast<std::uint32_t>(mesh_.triangle_count());
        patch_of_.assign(count, kNone);
        start_.assign(mesh_.positions.size(), kNone);
        local_.assign(mesh_.positions.size(), kNone);
        Vector<PlanarPatch> patches;
        for (std::uint32_t seed = 0; seed < count; ++seed) {
            if (patch_of_[seed] != kNone || normal(seed) == glm::dvec3(0.0)) continue;
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
        partner_.assign(sides.size(), kNone);
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
        members_.assign(1, seed);
        patch_of_[seed] = seed;
        for (std::size_t i = 0; i < members_.size(); ++i) {
            for (std::size_t side = 3 * members_[i]; side < 3 * members_[i] + 3; ++side) {
                if (partner_[side] == kNone) continue;
                const std::uint32_t other = partner_[side] / 3;
                if (patch_of_[other] != kNone || glm::dot(normal(other), n) <= 0.0) continue;
                if (!in_plane(position(corner(next(next(partner_[side])))))) continue;
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
                const bool inner = p != kNone && patch_of_[p / 3] == seed;
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
            if (start_[first] == kNone) continue;
            std::uint32_t vertex = first;
            while (start_[vertex] != kNone) {
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
    Vector<std::uint32_t> partner_, patch_of_, members_, start_, local_;
    Vector<Boundary> boundary_;
};

bool faces_alike(const TriangleMesh& mesh, const PlanarPatch& patch, const Triangulation& result, const glm::dvec3& n) {
    for (const auto& t : result.triangles) {
        const glm::dvec3 a(mesh.positions[patch.vertices[t[0]]]), b(mesh.positions[patch.vertices[t[1]]]);
        const glm::dvec3 c(mesh.positions[patch.vertices[t[2]]]);
        const glm::dvec3 m = glm::cross(b - a, c - a);
        const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)});
        // At least a millionth as high as long: what rounding makes of three collinear vertices is not.
        if (glm::dot(m, n) <= 1e-6 * longest) return false;
    }
    return true;
}

PatchResult describe(const PlanarPatch& patch, bool usable, bool lighter, const Triangulation& result) {
    PatchResult r;
    r.triangles = patch.triangles;
    r.vertices = patch.polygon.points.size();
    r.holes = patch.polygon.ring_count() - 1;
    r.weight_before = patch.weight;
    r.weight_after = lighter ? result.weight : patch.weight;
    r.optimal = usable && result.optimal;
    // What stays as it was is as near to the minimum as its weight is to the bound that the new one gave.
    const double factor = usable && result.weight > 0.0 ? r.weight_after / result.weight : 1.0;
    r.gap = usable ? (r.optimal ? 0.0 : std::max(0.0, (1.0 + result.gap) * factor - 1.0))
                   : std::numeric_limits<double>::infinity();
    return r;
}

}  // namespace

Result<Vector<PlanarPatch>> find_planar_patches(const TriangleMesh& mesh, double tolerance) {
    if (auto valid = validate(mesh); !valid) return tl::unexpected<Error>(valid.error());
    return PatchFinder(mesh, tolerance).find();
}

Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options) {
    auto patches = find_planar_patches(mesh, options.tolerance);
    if (!patches) return tl::unexpected<Error>(patches.error());
    PatchReport report;
    Triangulator triangulator;
    Triangulation result;
    for (const PlanarPatch& patch : *patches) {
        ++report.patches;
        report.triangles += patch.triangles.size();
        report.weight_before += patch.weight;
        const auto begin = std::chrono::steady_clock::now();
        const auto done = triangulator.triangulate(patch.polygon, options.triangulation, result);
        if (!done && done.error().code == ErrorCode::cancelled) return tl::unexpected<Error>(done.error());
        const auto first = 3 * static_cast<std::size_t>(patch.triangles[0]);
        const glm::dvec3 a(mesh.positions[mesh.indices[first]]), b(mesh.positions[mesh.indices[first + 1]]);
        const glm::dvec3 n = glm::normalize(glm::cross(b - a, glm::dvec3(mesh.positions[mesh.indices[first + 2]]) - a));
        const bool usable =
            done && result.triangles.size() == patch.triangles.size() && faces_alike(mesh, patch, result, n);
        if (!usable || (options.triangulation.method == Method::minimum_weight && !result.optimal)) ++report.unproven;
        // Differences below the rounding of the projection are none.
        const bool lighter = usable && result.weight < patch.weight * (1.0 - 1e-12);
        report.weight_after += lighter ? result.weight : patch.weight;
        report.results.push_back(describe(patch, usable, lighter, result));
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
        report.results.back().microseconds = time.count();
        if (!lighter) continue;
        ++report.improved;
        for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                mesh.indices[3 * std::size_t{patch.triangles[i]} + k] = patch.vertices[result.triangles[i][k]];
            }
        }
    }
    return report;
}

}  // namespace crofton::triangulate
