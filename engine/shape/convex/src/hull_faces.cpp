// SPDX-License-Identifier: MIT
// Joins the triangles of a hull to faces, and finds the edges between faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "features.hpp"
#include "support.hpp"

namespace crofton::convex {
namespace {

struct Surface {
    std::span<const glm::vec3> vertices;
    std::span<const std::uint16_t> triangles;
    Vector<std::array<int, 3>> neighbor;  // across the edge from corner k to the next

    [[nodiscard]] int count() const { return static_cast<int>(triangles.size() / 3); }
    [[nodiscard]] int corner(int t, int k) const { return triangles[static_cast<std::size_t>(3 * t + k % 3)]; }
    [[nodiscard]] glm::dvec3 at(int v) const { return glm::dvec3(vertices[static_cast<std::size_t>(v)]); }
    [[nodiscard]] glm::dvec3 area(int t) const {
        const glm::dvec3 a = at(corner(t, 0));
        return glm::cross(at(corner(t, 1)) - a, at(corner(t, 2)) - a);
    }
};

void find_neighbors(Surface& surface) {
    struct Side {
        int low, high, triangle, k;
    };
    Vector<Side> sides;
    surface.neighbor.resize(static_cast<std::size_t>(surface.count()));
    for (int t = 0; t < surface.count(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = surface.corner(t, k), b = surface.corner(t, k + 1);
            sides.push_back({std::min(a, b), std::max(a, b), t, k});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        if (a.low != b.low) return a.low < b.low;
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
        const Side &a = sides[i], &b = sides[i + 1];
        surface.neighbor[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.k)] = b.triangle;
        surface.neighbor[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.k)] = a.triangle;
    }
}

// The rim of the triangles of one group, as one loop; empty where it is several.
Vector<std::uint16_t> rim_of(const Surface& surface, const Vector<int>& members, const Vector<int>& group, int mine) {
    struct Step {
        int from, to;
    };
    Vector<Step> steps;
    for (const int t : members)
        for (int k = 0; k < 3; ++k) {
            const int beyond = surface.neighbor[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)];
            if (group[static_cast<std::size_t>(beyond)] != mine)
                steps.push_back({surface.corner(t, k), surface.corner(t, k + 1)});
        }
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.from < b.from; });
    for (std::size_t i = 1; i < steps.size(); ++i)
        if (steps[i].from == steps[i - 1].from) return {};
    Vector<std::uint16_t> loop;
    for (int at = steps.empty() ? -1 : steps[0].from; at >= 0;) {
        loop.push_back(static_cast<std::uint16_t>(at));
        const auto next = std::lower_bound(steps.begin(), steps.end(), at,
                                           [](const Step& step, int from) { return step.from < from; });
        at = next == steps.end() || next->to == steps[0].from || loop.size() > steps.size() ? -1 : next->to;
    }
    return loop.size() == steps.size() ? loop : Vector<std::uint16_t>{};
}

}  // namespace

void Hull::find_faces(double tolerance) {
    Surface surface{vertices_, triangles_, {}};
    find_neighbors(surface);
    glm::dvec3 low = surface.at(0), high = low;
    for (const glm::vec3& v : vertices_) low = glm::min(low, glm::dvec3(v)), high = glm::max(high, glm::dvec3(v));
    const double most = tolerance * glm::length(high - low);
    // Largest triangle first: its plane is the best known.
    const int count = surface.count();
    Vector<int> order(static_cast<std::size_t>(count)), group(static_cast<std::size_t>(count), -1);
    Vector<double> size(static_cast<std::size_t>(count));
    for (int t = 0; t < count; ++t) {
        order[static_cast<std::size_t>(t)] = t;
        size[static_cast<std::size_t>(t)] = glm::length(surface.area(t));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return size[static_cast<std::size_t>(a)] > size[static_cast<std::size_t>(b)];
    });
    face_first_.push_back(0);
    for (const int seed : order) {
        if (group[static_cast<std::size_t>(seed)] >= 0) continue;
        const int mine = face_count();
        const double length = size[static_cast<std::size_t>(seed)];
        const glm::dvec3 normal = length > 0.0 ? surface.area(seed) / length : glm::dvec3(0.0);
        const glm::dvec3 origin = surface.at(surface.corner(seed, 0));
        Vector<int> members{seed};
        group[static_cast<std::size_t>(seed)] = mine;
        for (std::size_t m = 0; m < members.size(); ++m)
            for (const int t : surface.neighbor[static_cast<std::size_t>(members[m])]) {
                if (group[static_cast<std::size_t>(t)] >= 0) continue;
                bool fits = glm::dot(surface.area(t), normal) >= 0.99 * size[static_cast<std::size_t>(t)];
                for (int k = 0; k < 3; ++k)
                    fits = fits && std::abs(glm::dot(normal, surface.at(surface.corner(t, k)) - origin)) <= most;
                if (!fits) continue;
                group[static_cast<std::size_t>(t)] = mine;
                members.push_back(t);
            }
        Vector<std::uint16_t> loop = rim_of(surface, members, group, mine);
        if (loop.empty()) {  // not a disc: the seed stands alone, the others are asked again
            for (std::size_t m = 1; m < members.size(); ++m) group[static_cast<std::size_t>(members[m])] = -1;
            loop.assign({triangles_[static_cast<std::size_t>(3 * seed)],
                         triangles_[static_cast<std::size_t>(3 * seed + 1)],
                         triangles_[static_cast<std::size_t>(3 * seed + 2)]});
        }
        face_vertices_.insert(face_vertices_.end(), loop.begin(), loop.end());
        face_first_.push_back(static_cast<std::uint16_t>(face_vertices_.size()));
        normals_.push_back(normal);
    }
}

void Hull::describe_faces() {
    for (int f = 0; f < face_count(); ++f) {
        Vector<glm::dvec3> points;
        for (const std::uint16_t v : face_vertices(f)) points.emplace_back(vertices_[v]);
        face_is_narrow_.push_back(is_narrow(points.data(), static_cast<int>(points.size())) ? 1 : 0);
        double along = 0.0;
        const int farthest = farthest_of(column(0), column(1), column(2), padded_count(), face_normal(f), along);
        face_support_.push_back(static_cast<std::uint16_t>(farthest));
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const glm::dvec3& p : points) {
            low = std::min(low, glm::dot(face_normal(f), p));
            high = std::max(high, glm::dot(face_normal(f), p));
        }
        face_unevenness_.push_back(high - low);
    }
}

// Each edge is in two triangles, which have it in opposite directions.
void Hull::find_spokes() {
    spoke_first_.assign(vertices_.size() + 1, 0);
    for (const std::uint16_t v : triangles_) ++spoke_first_[v + 1U];
    std::partial_sum(spoke_first_.begin(), spoke_first_.end(), spoke_first_.begin());
    Vector<std::uint16_t> next(spoke_first_.begin(), spoke_first_.end() - 1);
    spokes_.resize(triangles_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const std::uint16_t from = triangles_[i], to = triangles_[i % 3 == 2 ? i - 2 : i + 1];
        const double length = glm::distance(glm::dvec3(vertices_[from]), glm::dvec3(vertices_[to]));
        spokes_[next[from]++] = {std::nextafter(static_cast<float>(length), HUGE_VALF), to};
    }
}

void Hull::index_edges() {
    struct Side {
        std::uint16_t low, high, face, position, from;
    };
    Vector<Side> sides;
    for (int f = 0; f < face_count(); ++f) {
        const auto corners = face_vertices(f);
        const std::size_t first = face_first_[static_cast<std::size_t>(f)];
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const std::uint16_t a = corners[k], b = corners[(k + 1) % corners.size()];
            sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint16_t>(f),
                             static_cast<std::uint16_t>(first + k), a});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        if (a.low != b.low) return a.low < b.low;
        return a.high != b.high ? a.high < b.high : a.position < b.position;
    });
    face_edges_.resize(face_vertices_.size());
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
        const Side &a = sides[i], &b = sides[i + 1];
        const auto id = static_cast<std::uint16_t>(edges_.size());
        edges_.push_back({{a.from, static_cast<std::uint16_t>(a.low + a.high - a.from)}, {a.face, b.face}});
        face_edges_[a.position] = face_edges_[b.position] = id;
    }
}

}  // namespace crofton::convex
