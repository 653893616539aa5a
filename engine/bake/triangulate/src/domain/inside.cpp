// SPDX-License-Identifier: MIT
// Finds the triangles inside a polygon, and rings that overlap.
#include <algorithm>
#include <crofton/geometry/predicates.hpp>

#include "domain/domain.hpp"

// Finds the triangles that lie inside.

namespace crofton::triangulate {
namespace {
constexpr int kPasses = 4;
}

Result<Domain::State> Domain::cross(State state, Index mark) {
    crossed_rings_.clear();
    for (Index id = mark - 1; id != kNone; id = record(id).next) {
        const Index ring = ring_of(record(id).input);
        if (!is_slit(ring)) crossed_rings_.push_back(ring);
    }
    std::sort(crossed_rings_.begin(), crossed_rings_.end());
    Index entered = 0;
    for (std::size_t i = 0; i < crossed_rings_.size(); ++i) {
        const Index ring = crossed_rings_[i];
        if (i + 1 < crossed_rings_.size() && crossed_rings_[i + 1] == ring) {
            ++i;  // there and back: no boundary
        } else if (ring == 0) {
            state.outer ^= 1u;
        } else if (ring == state.hole) {
            state.hole = 0;
        } else if (entered != 0) {
            return overlap(mark, entered, ring);
        } else {
            entered = ring;
        }
    }
    if (entered != 0) {
        if (state.hole != 0) return overlap(mark, entered, state.hole);
        state.hole = entered;
    }
    return state;
}

Error Domain::overlap(Index mark, Index a, Index b) const {
    const Index input = record(mark - 1).input;
    return fail(ErrorCode::degenerate, input,
                {name_of(input).text, ": holes ", std::min(a, b), " and ", std::max(a, b),
                 " overlap or lie inside one another"});
}

// Decides whether the inside is on the left of a ring, if the polygon is valid. Requires a ring that touches neither
// itself nor others. Exact: the first vertex in lexicographic order is convex.
void Domain::find_side(Index begin, Index end) {
    const auto before = [&](Index i, Index j) {
        const auto &p = points_[vertex_of_[i]], &q = points_[vertex_of_[j]];
        return p.x < q.x || (p.x == q.x && p.y < q.y);
    };
    if (begin == end) return;
    Index first = begin;
    for (Index i = begin + 1; i < end; ++i) {
        if (before(i, first)) first = i;
    }
    const Index last = first == begin ? end - 1 : first - 1, after = first + 1 == end ? begin : first + 1;
    const bool turns_left =
        orientation(points_[vertex_of_[last]], points_[vertex_of_[first]], points_[vertex_of_[after]]) > 0;
    const bool left = turns_left == (begin == 0);
    for (Index i = begin; i < end; ++i) left_inside_[vertex_of_[i]] = left;
}

// If all rings are simple and disjoint, each determines on which side of its edges the inside lies. Labels that differ
// across every edge and nowhere else, and leave the outside out, are the parity of the rings around a triangle. If
// every ring also finds next to it what it determines, holes lie inside an odd number of rings, and the outer ring
// inside an even one. So the outer ring is around all others, and no hole around another. Holes of one point determine
// nothing. Returns false if it does not fit, or if too many triangles lie far from the rings.
bool Domain::label_triangles() {
    queue_.clear();
    for (Index t = 0; t < inside_.size(); ++t) {
        if (inside_[t] == kUnreached) queue_.push_back(t);
    }
    for (int pass = 0; pass < kPasses && !queue_.empty(); ++pass) {
        std::size_t kept = 0;
        for (const Index t : queue_) {
            std::uint8_t label = kUnreached;
            for (Index e = 4 * t; e < 4 * t + 3; ++e) {
                const std::uint8_t beyond = mesh_.twin[e] == kNone ? 0 : inside_[mesh_.twin[e] / 4];
                label = beyond == kUnreached ? label : beyond ^ static_cast<std::uint8_t>(mesh_.mark[e] != 0);
            }
            inside_[t] = label;
            queue_[kept] = t;
            kept += label == kUnreached;
        }
        queue_.resize(kept);
    }
    return queue_.empty() && labels_fit() && sides_fit();
}

bool Domain::labels_fit() {
    std::size_t wrong = 0, inside = 0;
    for (Index t = 0; t < inside_.size(); ++t) {
        inside += inside_[t];
        for (Index e = 4 * t; e < 4 * t + 3; ++e) {
            const std::uint8_t beyond = mesh_.twin[e] == kNone ? 0 : inside_[mesh_.twin[e] / 4];
            wrong += (inside_[t] != beyond) != (mesh_.mark[e] != 0);
        }
    }
    inside_count_ = inside;
    return wrong == 0 && inside != 0;
}

// Whether each ring finds the inside where find_side() says, by its first edge. Where triangles were replaced, labels
// come from other rings.
bool Domain::sides_fit() const {
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        if (end - begin > 2 && !side_fits(begin)) return false;
        begin = end;
    }
    return true;
}

bool Domain::side_fits(Index input) const {
    const Index v = vertex_of_[input], mark = input + 1;
    for (Index e = mesh_.vertex_edge[v];; e = mesh_.rotate(e)) {
        if (mesh_.mark[e] == mark) return inside_[e / 4] == left_inside_[v];
        // The edge from its other side, as behind one on the hull there is no triangle.
        if (mesh_.mark[previous(e)] == mark) return inside_[e / 4] != left_inside_[v];
    }
}

Result<void> Domain::find_inside() {
    const std::size_t count = mesh_.triangle_count();
    if (!has_touching_rings() && label_triangles()) return check_holes();
    inside_.assign(count, kUnreached);
    inside_count_ = 0;
    regions_.clear();
    border_count_ = 0;
    if (queue_.size() < count + 1) queue_.resize(count + 1);
    if (borders_.size() < 3 * count + 1) borders_.resize(3 * count + 1);
    // The convex hull is connected: one triangle on it reaches all others.
    Index start = 0;
    while (mesh_.twin[start] != kNone) start = (start & 3u) == 2u ? start + 2 : start + 1;
    if (auto result = enter(start, State{}); !result) return result;
    while (border_count_ > 0) {
        const Border border = borders_[--border_count_];
        if (inside_[border.half_edge / 4] != kUnreached) continue;
        if (auto result = enter(border.half_edge, regions_[border.region]); !result) return result;
    }
    if (inside_count_ == 0)
        return fail(ErrorCode::degenerate, 0, {name_of(0).text, ": zero area: nothing lies inside"});
    return check_holes();
}

// Enters a region from one of this state.
Result<void> Domain::enter(Index half_edge, State state) {
    const Index mark = mesh_.mark[half_edge];
    if (mark != 0) {
        const auto crossed = cross(state, mark);
        if (!crossed) return crossed.error();
        state = *crossed;
        if (state.outer == 0 && state.hole != 0) {
            const Index input = record(mark - 1).input;
            return fail(ErrorCode::degenerate, input,
                        {name_of(input).text, ": hole ", state.hole, " reaches outside the outer ring"});
        }
    }
    regions_.push_back(state);
    flood(half_edge / 4);
    return {};
}

// Gives the triangle's whole region the last state, breadth first, so that the processor knows the triangles to come.
// Which neighbours are new and which edges are marked is hard to predict: all are written, and few are kept.
void Domain::flood(Index triangle) {
    const auto region = static_cast<Index>(regions_.size() - 1);
    const std::uint8_t value = regions_[region].outer != 0 && regions_[region].hole == 0;
    const Index *const twin = mesh_.twin.data(), *const mark = mesh_.mark.data();
    Index* const queue = queue_.data();
    Border* const borders = borders_.data();
    std::uint8_t* const inside = inside_.data();
    std::size_t queue_end = 1, borders_end = border_count_;
    inside[triangle] = value;
    queue[0] = 4 * triangle;
    for (std::size_t i = 0; i < queue_end; ++i) {
        const Index first = queue[i];
        for (Index e = first; e < first + 3; ++e) {
            const Index f = twin[e] == kNone ? e : twin[e];
            const bool fresh = inside[f / 4] == kUnreached, open = mark[e] == 0;
            inside[f / 4] = fresh && open ? value : inside[f / 4];
            queue[queue_end] = f & ~3u;
            queue_end += fresh & open;
            borders[borders_end] = {f, region};
            borders_end += fresh & !open;
        }
    }
    border_count_ = borders_end;
    inside_count_ += value * queue_end;
}

// A hole of which no vertex touches the inside lies outside, within another hole, or is a spike there.
Result<void> Domain::check_holes() const {
    bool slits = false;
    for (std::size_t r = 1; r < polygon_->ring_count(); ++r) {
        const Index begin = polygon_->ring_ends[r - 1], end = polygon_->ring_ends[r];
        slits |= is_slit(static_cast<Index>(r));
        bool touches = begin == end;
        for (Index i = begin; i < end && !touches; ++i) touches = touches_inside(vertex_of_[i]);
        if (!touches)
            return fail(ErrorCode::degenerate, begin, {name_of(begin).text, ": hole ", r, " lies outside the polygon"});
    }
    return slits ? check_slits() : Result<void>{};
}

// Each part of a hole of two points has the inside next to it.
Result<void> Domain::check_slits() const {
    for (Index e = 0; e < mesh_.origin.size(); ++e) {
        const Index twin = mesh_.twin[e];
        if ((e & 3u) == 3u || mesh_.mark[e] == 0 || inside(e / 4) || (twin != kNone && inside(twin / 4))) continue;
        for (Index id = mesh_.mark[e] - 1; id != kNone; id = record(id).next) {
            const Index input = record(id).input, ring = ring_of(input);
            if (is_slit(ring))
                return fail(ErrorCode::degenerate, input,
                            {name_of(input).text, ": hole ", ring, " reaches outside the polygon"});
        }
    }
    return {};
}

bool Domain::touches_inside(Index vertex) const {
    const Index start = mesh_.vertex_edge[vertex];
    Index e = start;
    do {
        if (inside(e / 4)) return true;
        e = mesh_.rotate(e);
    } while (e != start && e != kNone);
    return false;
}

}  // namespace crofton::triangulate
