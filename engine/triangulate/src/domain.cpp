#include "domain.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/core/assert.hpp>
#include <cstdio>
#include <limits>

namespace crofton::triangulate {
namespace {

// Predicates are exact for magnitudes within 1e±70; the caller's may lie anywhere, so they are scaled by a power of two
// to at most 1, and must not be smaller than this unless 0.
constexpr double kSmallest = 0x1p-200;
constexpr double kLargest = std::numeric_limits<double>::max();

}  // namespace

Result<void> Domain::build(const Polygon& polygon) {
    polygon_ = &polygon;
    if (auto result = check(polygon); !result) return result;
    merge_vertices(polygon);
    delaunay(mesh_, scratch_);
    if (mesh_.triangle_count() == 0) return fail_at(ErrorCode::degenerate, 0, "zero area: all points are collinear");
    if (auto result = insert_rings(); !result) return result;
    return find_inside();
}

Result<void> Domain::check(const Polygon& polygon) {
    std::uint32_t begin = 0;
    for (std::size_t r = 0; r < polygon.ring_ends.size(); ++r) {
        if (polygon.ring_ends[r] < begin || polygon.ring_ends[r] > polygon.points.size()) {
            return fail(ErrorCode::invalid_argument, r, "ring_ends must ascend up to the number of points");
        }
        begin = polygon.ring_ends[r];
    }
    if (begin != polygon.points.size()) {
        return fail(ErrorCode::invalid_argument, polygon.ring_ends.size(),
                    "the last of ring_ends is not the number of points");
    }
    if (polygon.points.size() >= (1u << 29))
        return fail(ErrorCode::out_of_range, polygon.points.size(), "more than 2^29 points");
    if (polygon.ring_ends.empty() || polygon.ring_ends[0] < 3) {
        return fail(ErrorCode::empty, 0, "ring 0 has fewer than three points");
    }
    double largest = 0.0, smallest = kLargest;
    Index smallest_at = 0;
    for (Index i = 0; i < polygon.points.size(); ++i) {
        for (const double c : {polygon.points[i].x, polygon.points[i].y}) {
            const double magnitude = std::fabs(c);
            if (!(magnitude <= kLargest)) return fail_at(ErrorCode::non_finite, i, "not a finite position");
            largest = std::max(largest, magnitude);
            if (magnitude < smallest && magnitude != 0.0) smallest = magnitude, smallest_at = i;
        }
    }
    scale_ = 1.0;
    if (largest > 1e60 || (largest < 1e-20 && largest > 0.0) || smallest < kSmallest) {
        int exponent = 0;
        std::frexp(largest, &exponent);
        if (std::ldexp(smallest, -exponent) < kSmallest) {
            return fail_at(ErrorCode::out_of_range, smallest_at, "coordinates differ by more than 2^200 in size");
        }
        scale_ = std::ldexp(1.0, exponent);
    }
    return {};
}

void Domain::merge_vertices(const Polygon& polygon) {
    const auto count = static_cast<Index>(polygon.points.size());
    keys_.resize(count);
    for (Index i = 0; i < count; ++i) {
        // + 0.0 turns −0 into 0, so that equal positions have equal bits.
        keys_[i] = {polygon.points[i] / scale_ + 0.0, i};
    }
    std::sort(keys_.begin(), keys_.end(), [](const Keyed& a, const Keyed& b) {
        if (a.position.x != b.position.x) return a.position.x < b.position.x;
        if (a.position.y != b.position.y) return a.position.y < b.position.y;
        return a.input < b.input;
    });
    points_.clear();
    input_of_.clear();
    vertex_of_.resize(count);
    for (const auto& key : keys_) {
        if (points_.empty() || points_.back() != key.position) {
            points_.push_back(key.position);
            input_of_.push_back(key.input);
        }
        vertex_of_[key.input] = static_cast<Index>(points_.size() - 1);
    }
    mesh_.points = points_;
}

Result<void> Domain::insert_rings() {
    records_.clear();
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        // A ring of two points is one edge, not one edge there and back.
        const Index edges = end - begin == 2 ? 1 : end - begin;
        for (Index i = begin; i < begin + edges; ++i) {
            if (auto result = insert_edge(i, i + 1 == end ? begin : i + 1); !result) return result;
        }
        begin = end;
    }
    return {};
}

Result<void> Domain::insert_edge(Index input, Index successor) {
    ConstraintInserter inserter(mesh_, scratch_);
    const Index end = vertex_of_[successor];
    for (Index at = vertex_of_[input]; at != end;) {
        Crossing crossing;
        const Index e = inserter.advance(at, end, crossing);
        if (crossing.found) {
            return fail_at(ErrorCode::degenerate, input,
                           "the edge from here crosses the one from " + describe(record(crossing.mark - 1).input));
        }
        claim(e, input);
        at = mesh_.origin[e] == at ? mesh_.destination(e) : mesh_.origin[e];
    }
    return {};
}

void Domain::insert_diagonals(std::span<const Segment> segments) {
    ConstraintInserter inserter(mesh_, scratch_);
    for (const Segment& s : segments) {
        Crossing crossing;
        (void)inserter.advance(s.from, s.to, crossing);
        CROFTON_ASSERT(!crossing.found, "a diagonal crosses the boundary");
    }
}

void Domain::claim(Index half_edge, Index input) {
    Index mark = input + 1;
    if (mesh_.mark[half_edge] != 0) {
        records_.push_back({input, mesh_.mark[half_edge] - 1});
        mark = static_cast<Index>(vertex_of_.size() + records_.size());
    }
    mesh_.mark[half_edge] = mark;
    if (mesh_.twin[half_edge] != kNone) mesh_.mark[mesh_.twin[half_edge]] = mark;
}

Domain::Record Domain::record(Index id) const {
    return id < vertex_of_.size() ? Record{id, kNone} : records_[id - vertex_of_.size()];
}

Index Domain::ring_of(Index input) const {
    const auto& ends = polygon_->ring_ends;
    if (input < ends[0]) return 0;
    return static_cast<Index>(std::upper_bound(ends.begin(), ends.end(), input) - ends.begin());
}

Index Domain::successor(Index input) const {
    const Index r = ring_of(input);
    if (input + 1 != polygon_->ring_ends[r]) return input + 1;
    return r == 0 ? 0 : polygon_->ring_ends[r - 1];
}

Result<Domain::State> Domain::cross(State state, Index mark) {
    crossed_rings_.clear();
    for (Index id = mark - 1; id != kNone; id = record(id).next) crossed_rings_.push_back(ring_of(record(id).input));
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

tl::unexpected<Error> Domain::overlap(Index mark, Index a, Index b) const {
    return fail_at(ErrorCode::degenerate, record(mark - 1).input,
                   "holes " + std::to_string(std::min(a, b)) + " and " + std::to_string(std::max(a, b)) +
                       " overlap or lie inside one another");
}

Result<void> Domain::find_inside() {
    const auto count = static_cast<Index>(mesh_.triangle_count());
    inside_.assign(count, 2);  // 2 = not reached yet
    states_.resize(count);
    inside_count_ = 0;
    scratch_.stack.clear();
    const auto enter = [&](Index triangle, State state, Index mark) -> Result<void> {
        if (mark != 0) {
            const auto crossed = cross(state, mark);
            if (!crossed) return tl::unexpected<Error>(crossed.error());
            state = *crossed;
            if (state.outer == 0 && state.hole != 0) {
                return fail_at(ErrorCode::degenerate, record(mark - 1).input,
                               "hole " + std::to_string(state.hole) + " reaches outside the outer ring");
            }
        }
        states_[triangle] = state;
        inside_[triangle] = state.outer != 0 && state.hole == 0;
        inside_count_ += inside_[triangle];
        scratch_.stack.push_back(triangle);
        return {};
    };
    // The convex hull is connected: one triangle on it reaches all others.
    Index start = 0;
    while (mesh_.twin[start] != kNone) start = (start & 3u) == 2u ? start + 2 : start + 1;
    if (auto result = enter(start / 4, State{}, mesh_.mark[start]); !result) return result;
    while (!scratch_.stack.empty()) {
        const Index triangle = scratch_.stack.back();
        scratch_.stack.pop_back();
        for (Index e = 4 * triangle; e < 4 * triangle + 3; ++e) {
            const Index twin = mesh_.twin[e];
            if (twin == kNone || inside_[twin / 4] != 2) continue;
            if (auto result = enter(twin / 4, states_[triangle], mesh_.mark[e]); !result) return result;
        }
    }
    if (inside_count_ == 0) return fail_at(ErrorCode::degenerate, 0, "zero area: nothing lies inside");
    return check_holes();
}

// A hole of which no vertex touches the inside lies outside, within another hole, or is a spike there.
Result<void> Domain::check_holes() {
    if (polygon_->ring_count() == 1) return {};
    used_.assign(points_.size(), 0);
    for (Index e = 0; e < mesh_.origin.size(); ++e) {
        if ((e & 3u) != 3u && inside(e / 4)) used_[mesh_.origin[e]] = 1;
    }
    for (std::size_t r = 1; r < polygon_->ring_count(); ++r) {
        const Index begin = polygon_->ring_ends[r - 1], end = polygon_->ring_ends[r];
        bool touches = begin == end;
        for (Index i = begin; i < end && !touches; ++i) touches = used_[vertex_of_[i]] != 0;
        if (!touches)
            return fail_at(ErrorCode::degenerate, begin, "hole " + std::to_string(r) + " lies outside the polygon");
    }
    return {};
}

// Turning clockwise from the corner, the first constraint bounds its sector; the ring that made it has its point there.
Index Domain::input_index(Index e) const {
    const Index v = mesh_.origin[e];
    if (!has_shared_positions()) return input_of_[v];
    for (Index edge = e;;) {
        for (Index id = mesh_.mark[edge] - 1; id != kNone; id = record(id).next) {
            const Index input = record(id).input;
            if (vertex_of_[input] == v) return input;
            const Index end = successor(input);
            if (vertex_of_[end] == v) return end;
        }
        const Index twin = mesh_.twin[edge];
        if (twin == kNone) return input_of_[v];
        edge = next(twin);
        if (edge == e) return input_of_[v];
    }
}

std::string Domain::describe(Index input) const {
    const auto& p = polygon_->points[input];
    const Index r = ring_of(input);
    char text[128];
    std::snprintf(text, sizeof text, "ring %u, point %u (%.17g, %.17g)", r,
                  r == 0 ? input : input - polygon_->ring_ends[r - 1], p.x, p.y);
    return text;
}

tl::unexpected<Error> Domain::fail_at(ErrorCode code, Index input, const std::string& what) const {
    return fail(code, input, describe(input) + ": " + what);
}

}  // namespace crofton::triangulate
