// SPDX-License-Identifier: MIT
// The box behind a mesh's largest axis-aligned walls: of houses that are no closed surface, with windows set back.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "finding/candidates.hpp"
#include "finding/inscribed_box.hpp"
#include "finding/wall.hpp"

namespace crofton::occlude {
namespace {

constexpr std::uint32_t kLeastWalls = 4;
constexpr float kDeepest = 0.15f;                // how far walls may reach into the box, of its extent
constexpr std::size_t kMostTriangles = 100'000;  // each face is tried several times
constexpr std::size_t kMostDepths = 64;          // that are searched
constexpr double kLeastWallShare = 0.01;         // of the squared size of the mesh

// Triangles in one plane across an axis that face the same way.
struct Wall {
    double area = 0.0;
    glm::vec3 low{0.0f}, high{0.0f};
};

// By face, as face_of: the largest wall that faces outward there.
std::array<Wall, 6> largest_walls(const PieceMesh& mesh) {
    struct Flat {
        float at;
        std::uint32_t triangle;
        double area;
    };
    std::array<Vector<Flat>, 6> flats;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::vec3 &a = mesh.positions[mesh.triangles[t][0]], &b = mesh.positions[mesh.triangles[t][1]],
                        &c = mesh.positions[mesh.triangles[t][2]];
        for (int axis = 0; axis < 3; ++axis) {
            if (a[axis] != b[axis] || a[axis] != c[axis]) continue;
            const double twice = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a))[axis];
            if (twice == 0.0) continue;
            flats[static_cast<std::size_t>(2 * axis + (twice > 0.0 ? 0 : 1))].push_back(
                {a[axis], t, 0.5 * std::abs(twice)});
        }
    }
    std::array<Wall, 6> walls;
    for (std::size_t face = 0; face < 6; ++face) {
        std::stable_sort(flats[face].begin(), flats[face].end(),
                         [](const Flat& a, const Flat& b) { return a.at < b.at; });
        for (std::size_t i = 0, next = 0; i < flats[face].size(); i = next) {
            Wall wall;
            wall.low = wall.high = mesh.positions[mesh.triangles[flats[face][i].triangle][0]];
            for (next = i; next < flats[face].size() && flats[face][next].at == flats[face][i].at; ++next) {
                wall.area += flats[face][next].area;
                for (const std::uint32_t v : mesh.triangles[flats[face][next].triangle]) {
                    wall.low = glm::min(wall.low, mesh.positions[v]);
                    wall.high = glm::max(wall.high, mesh.positions[v]);
                }
            }
            if (wall.area > walls[face].area) walls[face] = wall;
        }
    }
    return walls;
}

// Bounded by the walls across all axes but `open_axis` (3: none), and along that axis as far as all these walls reach.
std::optional<WallBox> box_between(const std::array<Wall, 6>& walls, int open_axis, double least_area) {
    WallBox box;
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    float open_low = -kEndless, open_high = kEndless;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis == open_axis) continue;
        const Wall &high = walls[static_cast<std::size_t>(2 * axis)],
                   &low = walls[static_cast<std::size_t>(2 * axis + 1)];
        if (high.area < least_area || low.area < least_area) return std::nullopt;
        box.high[axis] = high.low[axis];
        box.low[axis] = low.low[axis];
        if (open_axis == 3) continue;
        open_low = std::max({open_low, low.low[open_axis], high.low[open_axis]});
        open_high = std::min({open_high, low.high[open_axis], high.high[open_axis]});
    }
    if (open_axis < 3) {
        box.low[open_axis] = open_low;
        box.high[open_axis] = open_high;
    }
    if (!(box.low.x < box.high.x && box.low.y < box.high.y && box.low.z < box.high.z)) return std::nullopt;
    return box;
}

// How far behind the face its wall lies as a whole: the least depth found for which it is proven, as a coordinate.
std::optional<float> inner_side(const Search& search, const WallBox& box, std::size_t face) {
    const int axis = static_cast<int>(face / 2);
    const float outer = face_of(box, face), sign = face % 2 == 0 ? 1.0f : -1.0f;
    const float deepest = outer - sign * kDeepest * (box.high[axis] - box.low[axis]);
    Vector<float> depths{outer};
    for (const glm::vec3& p : search.mesh.positions)
        if (sign * p[axis] < sign * outer && sign * p[axis] >= sign * deepest) depths.push_back(p[axis]);
    std::sort(depths.begin(), depths.end(), [&](float a, float b) { return sign * a > sign * b; });
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    if (depths.size() > kMostDepths) depths.resize(kMostDepths);
    const auto holds = [&](std::size_t k) {
        return is_walled(search.mesh, search.options.sides, box, face, depths[k]);
    };
    if (holds(0)) return outer;
    std::size_t fails = 0, succeeds = depths.size() - 1;
    if (succeeds == 0 || !holds(succeeds)) return std::nullopt;
    while (succeeds - fails > 1) {
        const std::size_t middle = (fails + succeeds) / 2;
        (holds(middle) ? succeeds : fails) = middle;
    }
    return depths[succeeds];
}

struct WalledBox {
    WallBox outer, inner;
    std::array<bool, 6> walled{};
    std::uint32_t walls = 0;

    [[nodiscard]] double mean_shadow() const {
        const glm::dvec3 e = glm::dvec3(inner.high) - glm::dvec3(inner.low);
        return 0.5 * (e.x * e.y + e.y * e.z + e.z * e.x);
    }
    // Eyes beyond an open side cannot use the body, so open sides make it worth less.
    [[nodiscard]] double worth() const { return walls < kLeastWalls ? 0.0 : mean_shadow() * (walls - 3.0); }
};

WalledBox walled_box(const Search& search, const WallBox& outer) {
    WalledBox result{outer, outer, {}, 0};
    for (std::size_t face = 0; face < 6; ++face) {
        const auto inner = inner_side(search, outer, face);
        result.walled[face] = inner.has_value();
        if (!inner) continue;
        ++result.walls;
        (face % 2 == 0 ? result.inner.high : result.inner.low)[static_cast<int>(face / 2)] = *inner;
    }
    return result;
}

// Within the floats low to high: the center is rounded to double, and the halves down, so that no side comes to lie
// beyond.
Obb box_within(const WallBox& box) {
    Obb result;
    for (int k = 0; k < 3; ++k) {
        const double low = static_cast<double>(box.low[k]), high = static_cast<double>(box.high[k]);
        result.center[k] = 0.5 * (low + high);
        const double half = std::min(high - result.center[k], result.center[k] - low) * (1.0 - 0x1p-50);
        const float rounded = static_cast<float>(half);
        result.half_extents[k] = static_cast<double>(rounded) > half ? std::nextafter(rounded, 0.0f) : rounded;
    }
    return result;
}

}  // namespace

void add_walled_box(const Search& search, Vector<FoundOccluder>& found) {
    if (search.mesh.triangles.size() > kMostTriangles) return;
    const std::array<Wall, 6> walls = largest_walls(search.mesh);
    WalledBox best;
    for (int open_axis = 0; open_axis <= 3; ++open_axis) {
        const auto outer = box_between(walls, open_axis, kLeastWallShare * search.size * search.size);
        if (!outer) continue;
        const WalledBox box = walled_box(search, *outer);
        if (box.worth() > best.worth()) best = box;
    }
    if (best.walls < kLeastWalls || best.mean_shadow() < search.least_shadow) return;
    FoundOccluder occluder;
    occluder.kind = OccluderKind::walled;
    occluder.box = box_within(best.inner);
    StoredBox stored{occluder.box, {}};
    for (std::size_t i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) stored.corners[i][k] = (i >> k & 1u) != 0 ? best.inner.high[k] : best.inner.low[k];
    occluder.surface = surface_of(stored);
    occluder.piece_bounds = {glm::dvec3(best.outer.low), glm::dvec3(best.outer.high)};
    for (std::size_t face = 0; face < 6; ++face) {
        if (best.walled[face]) continue;
        const int axis = static_cast<int>(face / 2);
        (face % 2 == 0 ? occluder.eyes_within.max : occluder.eyes_within.min)[axis] =
            static_cast<double>(face_of(best.outer, face));
    }
    occluder.mean_shadow = best.mean_shadow();
    occluder.edges = 12;
    found.push_back(std::move(occluder));
}

}  // namespace crofton::occlude
