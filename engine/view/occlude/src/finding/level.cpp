// SPDX-License-Identifier: MIT
// Levels are many small pieces that meet along walls. Cuts their sides to each other, then joins neighbours to one
// surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/cut_at_vertices.hpp>
#include <crofton/occlude/occluder.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "finding/candidates.hpp"

namespace crofton::occlude {
namespace {

using Corners = std::array<std::uint32_t, 3>;

class LevelDivision {
  public:
    LevelDivision(const PieceMesh& mesh, const FindOptions& options)
        : mesh_(mesh), options_(options), triangles_(cut_at_vertices(mesh.positions, mesh.triangles)) {}

    void run(Vector<FoundOccluder>& found) {
        Vector<std::uint32_t> all(triangles_.size());
        for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
        divide(all, found);
    }

  private:
    [[nodiscard]] double along(std::uint32_t t, int axis) const {
        double sum = 0.0;
        for (const std::uint32_t v : triangles_[t]) sum += static_cast<double>(mesh_.positions[v][axis]);
        return sum;
    }

    // Splits recursively in halves across the longest axis of the centres.
    void divide(std::span<std::uint32_t> triangles, Vector<FoundOccluder>& found) const {
        if (triangles.empty()) return;
        if (triangles.size() <= options_.level_triangles) return add(triangles, found);
        int axis = 0;
        double longest = -1.0;
        for (int k = 0; k < 3; ++k) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (const std::uint32_t t : triangles) {
                low = std::min(low, along(t, k));
                high = std::max(high, along(t, k));
            }
            if (high - low > longest) {
                longest = high - low;
                axis = k;
            }
        }
        const std::size_t half = triangles.size() / 2;
        std::sort(triangles.begin(), triangles.end(), [&](std::uint32_t i, std::uint32_t j) {
            const double a = along(i, axis), b = along(j, axis);
            return a != b ? a < b : i < j;
        });
        divide(triangles.first(half), found);
        divide(triangles.subspan(half), found);
    }

    void add(std::span<std::uint32_t> triangles, Vector<FoundOccluder>& found) const {
        std::sort(triangles.begin(), triangles.end());
        FoundOccluder occluder;
        occluder.kind = OccluderKind::patch;
        occluder.sides = options_.sides;
        Vector<std::uint32_t> used;
        Vector<std::pair<std::uint32_t, std::uint32_t>> sides;
        double area = 0.0;
        for (const std::uint32_t t : triangles) {
            const Corners& c = triangles_[t];
            for (std::size_t s = 0; s < 3; ++s) {
                used.push_back(c[s]);
                sides.emplace_back(std::minmax(c[s], c[(s + 1) % 3]));
            }
            const glm::dvec3 a(mesh_.positions[c[0]]);
            area += 0.5 * glm::length(
                              glm::cross(glm::dvec3(mesh_.positions[c[1]]) - a, glm::dvec3(mesh_.positions[c[2]]) - a));
        }
        if (!(area > 0.0)) return;
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        for (const std::uint32_t v : used) occluder.surface.positions.push_back(mesh_.positions[v]);
        for (const std::uint32_t t : triangles)
            for (const std::uint32_t v : triangles_[t])
                occluder.surface.indices.push_back(
                    static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin()));
        std::sort(sides.begin(), sides.end());
        for (std::size_t i = 0; i < sides.size();) {
            std::size_t end = i + 1;
            while (end < sides.size() && sides[end] == sides[i]) ++end;
            if (end - i != 2) occluder.edges += static_cast<std::uint32_t>(end - i);  // two triangles share it
            i = end;
        }
        occluder.mean_shadow = area * (options_.sides == Sides::front ? 0.25 : 0.5);
        occluder.gain = occluder.mean_shadow;
        found.push_back(std::move(occluder));
    }

    const PieceMesh& mesh_;
    const FindOptions& options_;
    Vector<Corners> triangles_;
};

}  // namespace

void add_level_surfaces(const Search& search, Vector<FoundOccluder>& found) {
    LevelDivision(search.mesh, search.options).run(found);
}

}  // namespace crofton::occlude
