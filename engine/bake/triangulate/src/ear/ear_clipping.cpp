// SPDX-License-Identifier: MIT
#include "ear/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/predicates.hpp>

namespace crofton::triangulate {

void EarClipping::begin(std::span<const glm::dvec2> points) {
    points_ = points;
    weight_ = 0.0;
    reflex_count_.assign(points.size(), 0);
    waiting_for_.assign(points.size(), kNone);
}

double EarClipping::run(std::span<const glm::dvec2> ring, bool counter_clockwise,
                        Vector<std::array<std::uint32_t, 3>>& triangles) {
    begin(ring);
    simple_ = true;
    collect_ring(ring.size(), counter_clockwise, [](Index input) { return input; });
    clip(triangles);
    return weight_;
}

double EarClipping::run(const Domain& domain, Vector<std::array<std::uint32_t, 3>>& triangles) {
    domain_ = &domain;
    mesh_ = &domain.mesh();
    begin(mesh_->points);
    simple_ = domain.ring_count() == 1 && !domain.has_touching_rings();
    if (!simple_) join_pieces();
    for (Index e = 0; e < mesh_->origin.size(); ++e) {
        if ((e & 3u) == 3u || !is_wall(e) || !domain.inside(e / 4)) continue;
        if (simple_) {
            collect_ring(points_.size(), is_ascending(e), [&](Index input) { return domain_->vertex_of(input); });
            clip(triangles);
            break;
        }
        if (walked_[e]) continue;
        collect_walk(e);
        clip(triangles);
    }
    return weight_;
}

Index EarClipping::find(Index piece) {
    while (parent_[piece] != piece) piece = parent_[piece] = parent_[parent_[piece]];
    return piece;
}

// Rings that touch nothing are the pieces of the boundary; otherwise edges connect vertices to pieces.
void EarClipping::find_pieces() {
    const auto& mesh = *mesh_;
    piece_.resize(points_.size());
    if (domain_->has_touching_rings()) {
        parent_.resize(points_.size());
        for (Index v = 0; v < parent_.size(); ++v) parent_[v] = v;
        for (Index e = 0; e < mesh.origin.size(); ++e)
            if ((e & 3u) != 3u && mesh.mark[e] != 0) join(mesh.origin[e], mesh.destination(e));
        for (Index v = 0; v < parent_.size(); ++v) piece_[v] = find(v);
        return;
    }
    const auto ends = domain_->ring_ends();
    parent_.resize(ends.size());
    Index input = 0;
    for (Index r = 0; r < parent_.size(); ++r) {
        parent_[r] = r;
        for (; input < ends[r]; ++input) piece_[domain_->vertex_of(input)] = r;
    }
}

bool EarClipping::join(Index a, Index b) {
    a = find(a), b = find(b);
    parent_[a] = b;
    return a != b;
}

void EarClipping::join_pieces() {
    const auto& mesh = *mesh_;
    const auto square = [&](Index e) {
        const glm::dvec2 d = mesh.points[mesh.origin[e]] - mesh.points[mesh.destination(e)];
        return d.x * d.x + d.y * d.y;
    };
    find_pieces();
    wall_.assign(mesh.origin.size(), 0);
    walked_.assign(mesh.origin.size(), 0);
    bridges_.clear();
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        const Index twin = mesh.twin[e];
        if ((e & 3u) == 3u) continue;
        wall_[e] = mesh.mark[e] != 0;
        if (twin == kNone || e > twin || !domain_->inside(e / 4)) continue;
        if (mesh.mark[e] == 0) {
            if (piece_[mesh.origin[e]] != piece_[mesh.destination(e)]) bridges_.push_back({square(e), e});
        } else if (domain_->inside(twin / 4)) {
            weight_ += std::sqrt(square(e));
        }
    }
    std::sort(bridges_.begin(), bridges_.end(), [](const Bridge& a, const Bridge& b) {
        return a.square != b.square ? a.square < b.square : a.half_edge < b.half_edge;
    });
    for (const Bridge& bridge : bridges_) {
        const Index e = bridge.half_edge;
        if (!join(piece_[mesh.origin[e]], piece_[mesh.destination(e)])) continue;
        wall_[e] = wall_[mesh.twin[e]] = 1;
        weight_ += std::sqrt(bridge.square);
    }
}

// Whether the ring's points follow each other as its edges do that have the inside on their left, as this one has.
bool EarClipping::is_ascending(Index half_edge) const {
    const Index from = domain_->input_of(mesh_->origin[half_edge]),
                to = domain_->input_of(mesh_->destination(half_edge));
    return to == (from + 1 == points_.size() ? 0 : from + 1);
}

// The ring's corners with the inside on their left, from the first point.
template <class VertexOf>
void EarClipping::collect_ring(std::size_t size, bool ascending, VertexOf vertex_of) {
    const auto count = static_cast<Index>(size);
    corners_.resize(count);
    for (Index i = 0; i < count; ++i) {
        const Index input = ascending || i == 0 ? i : count - i;
        corners_[i].vertex = vertex_of(input);
        corners_[i].input = input;
    }
    link_corners();
}

void EarClipping::collect_walk(Index start) {
    corners_.clear();
    Index e = start;
    do {
        corners_.push_back({mesh_->origin[e], 0, 0, domain_->input_index(e), false});
        walked_[e] = 1;
        e = next(e);
        while (!wall_[e]) e = next(mesh_->twin[e]);
    } while (e != start);
    link_corners();
}

void EarClipping::link_corners() {
    const auto count = static_cast<Index>(corners_.size());
    for (Index i = 0; i < count; ++i) {
        corners_[i].previous = (i == 0 ? count : i) - 1;
        corners_[i].next = i + 1 == count ? 0 : i + 1;
    }
    awake_.reset(count);
    waiting_.clear();
    reflex_.clear();
    for (Index i = 0; i < count; ++i) {
        Corner& c = corners_[i];
        c.reflex = is_reflex(c);
        if (!c.reflex)
            awake_.insert(i);
        else if (reflex_count_[c.vertex]++ == 0)
            reflex_.push_back(c.vertex);
    }
    tree_.build(points_, reflex_);
}

bool EarClipping::is_reflex(const Corner& c) const {
    const auto& points = points_;
    return orientation(points[corners_[c.previous].vertex], points[c.vertex], points[corners_[c.next].vertex]) <= 0;
}

void EarClipping::wake(Index corner) {
    if (!corners_[corner].reflex) awake_.insert(corner);
}

// Clipping narrows corners: what is convex stays so.
void EarClipping::update(Index corner) {
    Corner& c = corners_[corner];
    if (c.reflex && !is_reflex(c)) {
        c.reflex = false;
        if (--reflex_count_[c.vertex] == 0) {
            tree_.remove(c.vertex);
            for (Index i = waiting_for_[c.vertex]; i != kNone; i = waiting_[i].next)
                if (corners_[waiting_[i].corner].next != kNone) wake(waiting_[i].corner);
            waiting_for_[c.vertex] = kNone;
        }
    }
    wake(corner);
}

// Whether the segment to the vertex starts inside the corner.
bool EarClipping::opens_towards(const Corner& c, Index vertex) const {
    const auto& points = points_;
    const auto& at = points[c.vertex];
    const auto &before = points[corners_[c.previous].vertex], &after = points[corners_[c.next].vertex],
               &to = points[vertex];
    const bool left_of_after = orientation(at, after, to) > 0, right_of_before = orientation(at, before, to) < 0;
    return c.reflex ? left_of_after || right_of_before : left_of_after && right_of_before;
}

// Only reflex vertices can lie in an ear; those at a corner's position count by the direction in which the corners
// open. In a ring that touches nothing an ear that holds no vertex opens the right way.
bool EarClipping::is_ear(Index corner) {
    const Corner& c = corners_[corner];
    const Corner &before = corners_[c.previous], &after = corners_[c.next];
    const auto& points = points_;
    const auto &p = points[before.vertex], &q = points[c.vertex], &r = points[after.vertex];
    if (!simple_) {
        if (before.vertex == after.vertex) return false;
        if (after.next != c.previous && (!opens_towards(before, after.vertex) || !opens_towards(after, before.vertex)))
            return false;
    }
    const Index inside = tree_.find({p, q, r}, [&](Index v, const glm::dvec2& x) {
        if (v == before.vertex || v == c.vertex || v == after.vertex) return false;
        return orientation(p, q, x) >= 0 && orientation(q, r, x) >= 0 && orientation(r, p, x) >= 0;
    });
    if (inside == kNone) return true;
    waiting_.push_back({corner, waiting_for_[inside]});
    waiting_for_[inside] = static_cast<Index>(waiting_.size() - 1);
    return false;
}

void EarClipping::clip(Vector<std::array<std::uint32_t, 3>>& triangles) {
    const auto& points = points_;
    Index at = 0;
    for (std::size_t left = corners_.size(); left >= 3;) {
        at = awake_.next_cyclic(at);
        if (at == CornerSet::kNothing) break;
        awake_.erase(at);
        if (!is_ear(at)) continue;
        Corner& c = corners_[at];
        const Index before = c.previous, after = c.next;
        triangles.push_back({corners_[before].input, c.input, corners_[after].input});
        corners_[before].next = after;
        corners_[after].previous = before;
        c.next = kNone;
        if (--left > 2) {
            const glm::dvec2 d = points[corners_[before].vertex] - points[corners_[after].vertex];
            weight_ += std::sqrt(d.x * d.x + d.y * d.y);
            update(before);
            update(after);
            wake(corners_[before].previous);
            wake(corners_[after].next);
        }
        // The neighbour but one: fans from a single corner are long and thin.
        at = corners_[after].next;
    }
    for (const Corner& c : corners_) {
        reflex_count_[c.vertex] = 0;
        waiting_for_[c.vertex] = kNone;
    }
}

}  // namespace crofton::triangulate
