// SPDX-License-Identifier: MIT
#include "assets/convex_pieces.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace crofton::assets {
namespace {

// A side that two triangles share, seen from each of them.
struct Shared {
    double length = 0.0;
    std::uint32_t first = 0, second = 0;  // triangles
    std::array<std::uint32_t, 4> corners{};
};

bool is_strictly_convex(const Polygon& polygon, const std::array<std::uint32_t, 4>& corners) {
    for (std::size_t i = 0; i < 4; ++i)
        if (orientation(polygon.points[corners[i]], polygon.points[corners[(i + 1) % 4]],
                        polygon.points[corners[(i + 2) % 4]]) <= 0)
            return false;
    return true;
}

}  // namespace

std::vector<std::array<std::uint32_t, 4>> convex_pieces(const Polygon& polygon,
                                                        std::span<const std::array<std::uint32_t, 3>> triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> side_of;  // directed: the triangle to its left
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) side_of[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
    std::vector<Shared> shared;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
            const auto other = side_of.find({to, from});
            if (other == side_of.end() || other->second <= t) continue;
            for (const std::uint32_t beyond : triangles[other->second]) {
                if (beyond == from || beyond == to) continue;
                const std::array<std::uint32_t, 4> corners{from, beyond, to, triangles[t][(k + 2) % 3]};
                if (!is_strictly_convex(polygon, corners)) continue;
                shared.push_back({glm::distance(polygon.points[from], polygon.points[to]), t, other->second, corners});
            }
        }
    std::stable_sort(shared.begin(), shared.end(),
                     [](const Shared& a, const Shared& b) { return a.length > b.length; });
    std::vector<std::array<std::uint32_t, 4>> pieces;
    std::vector<bool> taken(triangles.size(), false);
    for (const Shared& both : shared) {
        if (taken[both.first] || taken[both.second]) continue;
        taken[both.first] = taken[both.second] = true;
        pieces.push_back(both.corners);
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (!taken[t]) pieces.push_back({triangles[t][0], triangles[t][1], triangles[t][2], triangles[t][2]});
    return pieces;
}

}  // namespace crofton::assets
