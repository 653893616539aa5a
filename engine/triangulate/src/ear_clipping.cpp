#include "ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/predicates.hpp>

namespace crofton::triangulate {

double EarClipping::run(const Domain& domain, Vector<std::array<Index, 3>>& triangles) {
    domain_ = &domain;
    mesh_ = &domain.mesh();
    weight_ = 0.0;
    join_pieces();
    walked_.assign(mesh_->origin.size(), 0);
    reflex_count_.assign(mesh_->points.size(), 0);
    for (Index e = 0; e < mesh_->origin.size(); ++e) {
        if ((e & 3u) == 3u || !wall_[e] || walked_[e] || !domain.inside(e / 4)) continue;
        collect_walk(e);
        clip(triangles);
    }
    return weight_;
}

Index EarClipping::find(Index vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
}

void EarClipping::join_pieces() {
    const auto& mesh = *mesh_;
    const auto square = [&](Index e) {
        const glm::dvec2 d = mesh.points[mesh.origin[e]] - mesh.points[mesh.destination(e)];
        return d.x * d.x + d.y * d.y;
    };
    const auto join = [&](Index e) {
        const Index a = find(mesh.origin[e]), b = find(mesh.destination(e));
        parent_[a] = b;
        return a != b;
    };
    parent_.resize(mesh.points.size());
    for (Index v = 0; v < parent_.size(); ++v) parent_[v] = v;
    wall_.assign(mesh.origin.size(), 0);
    bridges_.clear();
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        if ((e & 3u) == 3u) continue;
        const Index twin = mesh.twin[e];
        if (mesh.mark[e] != 0) {
            wall_[e] = 1;
            join(e);
            if (twin != kNone && e < twin && domain_->inside(e / 4) && domain_->inside(twin / 4))
                weight_ += std::sqrt(square(e));
        }
    }
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        const bool open =
            (e & 3u) != 3u && mesh.mark[e] == 0 && mesh.twin[e] != kNone && e < mesh.twin[e] && domain_->inside(e / 4);
        if (open && find(mesh.origin[e]) != find(mesh.destination(e))) bridges_.push_back(e);
    }
    std::sort(bridges_.begin(), bridges_.end(), [&](Index e, Index f) {
        const double a = square(e), b = square(f);
        return a != b ? a < b : e < f;
    });
    for (const Index e : bridges_) {
        if (!join(e)) continue;
        wall_[e] = wall_[mesh.twin[e]] = 1;
        weight_ += std::sqrt(square(e));
    }
}

void EarClipping::collect_walk(Index start) {
    corners_.clear();
    Index e = start;
    do {
        const auto i = static_cast<Index>(corners_.size());
        corners_.push_back({e, mesh_->origin[e], i - 1, i + 1, false});
        walked_[e] = 1;
        e = next(e);
        while (!wall_[e]) e = next(mesh_->twin[e]);
    } while (e != start);
    corners_.front().previous = static_cast<Index>(corners_.size() - 1);
    corners_.back().next = 0;
    reflex_.clear();
    for (Corner& c : corners_) {
        c.reflex = is_reflex(c);
        if (!c.reflex) continue;
        ++reflex_count_[c.vertex];
        reflex_.push_back(c.vertex);
    }
    grid_.build(mesh_->points, reflex_);
}

bool EarClipping::is_reflex(const Corner& c) const {
    const auto& points = mesh_->points;
    return orientation(points[corners_[c.previous].vertex], points[c.vertex], points[corners_[c.next].vertex]) <= 0;
}

// Clipping narrows corners: what is convex stays so.
void EarClipping::update(Corner& c) {
    if (!c.reflex || is_reflex(c)) return;
    c.reflex = false;
    if (--reflex_count_[c.vertex] == 0) grid_.remove(c.vertex);
}

// Whether the segment to the vertex starts inside the corner.
bool EarClipping::opens_towards(const Corner& c, Index vertex) const {
    const auto& points = mesh_->points;
    const auto& at = points[c.vertex];
    const auto &before = points[corners_[c.previous].vertex], &after = points[corners_[c.next].vertex],
               &to = points[vertex];
    const bool left_of_after = orientation(at, after, to) > 0, right_of_before = orientation(at, before, to) < 0;
    return c.reflex ? left_of_after || right_of_before : left_of_after && right_of_before;
}

// Only reflex vertices can lie in an ear; those at a corner's position count by the direction in which the corners
// open.
bool EarClipping::is_ear(const Corner& c) const {
    if (c.reflex) return false;
    const Corner &before = corners_[c.previous], &after = corners_[c.next];
    const auto& points = mesh_->points;
    const auto &p = points[before.vertex], &q = points[c.vertex], &r = points[after.vertex];
    if (before.vertex == after.vertex) return false;
    if (after.next != c.previous && (!opens_towards(before, after.vertex) || !opens_towards(after, before.vertex)))
        return false;
    const glm::dvec2 low(std::min({p.x, q.x, r.x}), std::min({p.y, q.y, r.y}));
    const glm::dvec2 high(std::max({p.x, q.x, r.x}), std::max({p.y, q.y, r.y}));
    return !grid_.any(low, high, [&](Index v) {
        if (v == before.vertex || v == c.vertex || v == after.vertex) return false;
        const auto& x = points[v];
        return orientation(p, q, x) >= 0 && orientation(q, r, x) >= 0 && orientation(r, p, x) >= 0;
    });
}

void EarClipping::clip(Vector<std::array<Index, 3>>& triangles) {
    const auto& points = mesh_->points;
    Index at = 0;
    for (std::size_t left = corners_.size(), failures = 0; left >= 3 && failures <= left;) {
        Corner& c = corners_[at];
        if (!is_ear(c)) {
            at = c.next;
            ++failures;
            continue;
        }
        Corner &before = corners_[c.previous], &after = corners_[c.next];
        triangles.push_back({before.half_edge, c.half_edge, after.half_edge});
        before.next = c.next;
        after.previous = c.previous;
        if (--left > 2) {
            const glm::dvec2 d = points[before.vertex] - points[after.vertex];
            weight_ += std::sqrt(d.x * d.x + d.y * d.y);
            update(before);
            update(after);
        }
        failures = 0;
        // The neighbour but one: fans from a single corner are long and thin.
        at = after.next;
    }
    for (const Corner& c : corners_) reflex_count_[c.vertex] = 0;
}

}  // namespace crofton::triangulate
