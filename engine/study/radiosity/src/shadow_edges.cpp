// SPDX-License-Identifier: MIT
// Where shadows of the sun end, and cutting there.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <tuple>
#include <unordered_set>

#include "refine.hpp"

namespace crofton::radiosity {
namespace {

// Rays start so far off the surface, as a share of the scene's half diagonal: above the tracer's rounding.
constexpr double kOffSurface = 4e-6;
constexpr std::size_t kTogether = 4096;  // triangles

// Weights of a triangle's corners. A little inside, so that what stands on its sides does not count.
constexpr double kIn = 0.02, kMost = 1.0 - 2.0 * kIn, kHalf = 0.5 * (1.0 - kIn);
constexpr std::array<glm::dvec3, 7> kPoints = {{{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0},
                                                {kMost, kIn, kIn},
                                                {kIn, kMost, kIn},
                                                {kIn, kIn, kMost},
                                                {kHalf, kHalf, kIn},
                                                {kIn, kHalf, kHalf},
                                                {kHalf, kIn, kHalf}}};

class SunRays {
  public:
    // `scene` must live as long.
    static Result<SunRays> create(const lines::LineTracer& scene, const TriangleMesh& mesh, const glm::dvec3& to_sun) {
        if (auto valid = validate(mesh); !valid) return valid.error();
        const double length = glm::length(to_sun);
        if (!(length > 0.0) || !std::isfinite(length))
            return fail(ErrorCode::out_of_range, kNoItem, "the direction to the sun is zero, too long or not finite");
        return SunRays(scene, to_sun / length);
    }

    // Calls visit(triangle, how many of the first `points` of kPoints see the sun) for those of `triangles` that face
    // it.
    template <class Visit>
    void look(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, std::size_t points,
              Visit&& visit) const {
        Vector<lines::FirstHitQuery> rays;
        Vector<lines::Hit> hits;
        Vector<std::uint32_t> facing;
        for (std::size_t begin = 0; begin < triangles.size(); begin += kTogether) {
            rays.clear(), facing.clear();
            for (std::size_t i = begin; i < std::min(begin + kTogether, triangles.size()); ++i) {
                const auto at = [&](std::size_t k) {
                    return glm::dvec3(mesh.positions[mesh.indices[std::size_t{3} * triangles[i] + k]]);
                };
                const glm::dvec3 a = at(0), b = at(1), c = at(2);
                if (!(glm::dot(glm::cross(b - a, c - a), to_sun_) > 0.0)) continue;
                facing.push_back(triangles[i]);
                for (std::size_t k = 0; k < points; ++k) {
                    const glm::dvec3 p = kPoints[k].x * a + kPoints[k].y * b + kPoints[k].z * c;
                    rays.push_back({{p + off_surface_ * to_sun_, to_sun_}});
                }
            }
            hits.resize(rays.size());
            tracer_.first_hits(rays, hits);
            for (std::size_t i = 0; i < facing.size(); ++i) {
                std::size_t seen = 0;
                for (std::size_t k = 0; k < points; ++k)
                    seen += hits[points * i + k].triangle == lines::Hit::kNothing ? 1 : 0;
                visit(facing[i], seen);
            }
        }
    }

  private:
    SunRays(const lines::LineTracer& scene, const glm::dvec3& to_sun)
        : tracer_(scene),
          to_sun_(to_sun),
          off_surface_(kOffSurface * 0.5 * glm::length(tracer_.bounds().max - tracer_.bounds().min)) {}

    const lines::LineTracer& tracer_;
    glm::dvec3 to_sun_;
    double off_surface_;
};

// Edges by where their ends are, whichever vertices these are of.
class Edges {
  public:
    void add(const glm::vec3& a, const glm::vec3& b) { keys_.insert(key(a, b)); }
    [[nodiscard]] bool contains(const glm::vec3& a, const glm::vec3& b) const { return keys_.contains(key(a, b)); }
    [[nodiscard]] bool empty() const { return keys_.empty(); }

  private:
    using Key = std::array<float, 6>;
    struct Hash {
        std::size_t operator()(const Key& key) const {
            std::uint64_t sum = 0;
            for (const float x : key) {
                std::uint32_t bits = 0;
                std::memcpy(&bits, &x, sizeof bits);
                sum = (sum ^ bits) * 0x9e3779b97f4a7c15u;
                sum ^= sum >> 32;
            }
            return static_cast<std::size_t>(sum);
        }
    };
    // + 0.0f: no negative zeros.
    static Key key(glm::vec3 a, glm::vec3 b) {
        if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z)) std::swap(a, b);
        return {a.x + 0.0f, a.y + 0.0f, a.z + 0.0f, b.x + 0.0f, b.y + 0.0f, b.z + 0.0f};
    }
    std::unordered_set<Key, Hash, std::equal_to<>, Allocator<Key>> keys_;
};

}  // namespace

Result<RefinedMesh> refine_at_shadows(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                      const glm::dvec3& to_sun, std::uint32_t halvings, std::size_t most_triangles) {
    return crofton::detail::recover([&]() -> Result<RefinedMesh> {
        const auto rays = SunRays::create(scene, mesh, to_sun);
        if (!rays) return rays.error();
        RefinedMesh result{mesh, {}};
        Vector<std::uint32_t> newest;  // triangles that were not looked at as they are
        for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
            result.source.push_back(t);
            newest.push_back(t);
        }
        for (std::uint32_t round = 0; round < halvings; ++round) {
            Edges edges;
            rays->look(result.mesh, newest, kPoints.size(), [&](std::uint32_t t, std::size_t seen) {
                if (seen == 0 || seen == kPoints.size()) return;
                const auto at = [&](std::size_t k) {
                    return result.mesh.positions[result.mesh.indices[std::size_t{3} * t + k % 3]];
                };
                for (std::size_t k = 0; k < 3; ++k) edges.add(at(k), at(k + 1));
            });
            if (edges.empty()) break;
            const auto is_cut = [&](const glm::vec3& a, const glm::vec3& b) { return edges.contains(a, b); };
            RefinedMesh cut = detail::cut_edges(result.mesh, is_cut);
            if (cut.source.size() > most_triangles)
                return fail(ErrorCode::budget_exceeded, cut.source.size(),
                            {"refine_at_shadows: more than ", most_triangles, " triangles; halve less often"});
            newest.clear();
            for (std::uint32_t t = 0; t < cut.source.size(); ++t) {
                const bool whole = (t == 0 || cut.source[t - 1] != cut.source[t]) &&
                                   (t + 1 == cut.source.size() || cut.source[t + 1] != cut.source[t]);
                if (!whole) newest.push_back(t);
            }
            for (std::uint32_t& source : cut.source) source = result.source[source];
            result = std::move(cut);
        }
        return result;
    });
}

Result<RefinedMesh> refine_at_shadows(const TriangleMesh& mesh, const glm::dvec3& to_sun, std::uint32_t halvings,
                                      std::size_t most_triangles) {
    const auto scene = lines::LineTracer::build(mesh);
    if (!scene) return scene.error();
    return refine_at_shadows(*scene, mesh, to_sun, halvings, most_triangles);
}

Result<Vector<std::uint32_t>> sunlit_triangles(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                               const glm::dvec3& to_sun) {
    return crofton::detail::recover([&]() -> Result<Vector<std::uint32_t>> {
        const auto rays = SunRays::create(scene, mesh, to_sun);
        if (!rays) return rays.error();
        Vector<std::uint32_t> lit(mesh.triangle_count(), 0), all;
        for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) all.push_back(t);
        rays->look(mesh, all, 1, [&](std::uint32_t t, std::size_t seen) { lit[t] = static_cast<std::uint32_t>(seen); });
        return lit;
    });
}

Result<Vector<std::uint32_t>> sunlit_triangles(const TriangleMesh& mesh, const glm::dvec3& to_sun) {
    const auto scene = lines::LineTracer::build(mesh);
    if (!scene) return scene.error();
    return sunlit_triangles(*scene, mesh, to_sun);
}

}  // namespace crofton::radiosity
