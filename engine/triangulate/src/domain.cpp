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
constexpr std::uint8_t kUnreached = 2;

}  // namespace

Result<void> Domain::build(const Polygon& polygon) {
    polygon_ = &polygon;
    if (auto result = check(polygon); !result) return result;
    merge_vertices(polygon);
    delaunay(mesh_, codes_, scratch_);
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
    std::span<const glm::dvec2> positions = polygon.points;
    if (scale_ != 1.0) {
        scaled_.assign(positions.begin(), positions.end());
        for (auto& p : scaled_) p /= scale_;
        positions = scaled_;
    }
    points_.clear();
    codes_.clear();
    input_of_.clear();
    vertex_of_.resize(positions.size());
    for (const auto& entry : order_.sort(positions)) {
        if (points_.empty() || points_.back() != positions[entry.index]) {
            points_.push_back(positions[entry.index]);
            codes_.push_back(entry.code);
            input_of_.push_back(entry.index);
        }
        vertex_of_[entry.index] = static_cast<Index>(points_.size() - 1);
    }
    mesh_.points = points_;
}

// A ring of two points is one edge, not one edge there and back.
Index Domain::edge_count(Index begin, Index end) const {
    return end - begin == 2 ? 1 : end - begin;
}

void Domain::find_next_vertices() {
    next_vertex_.assign(points_.size(), kNone);
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        for (Index i = begin; i < begin + edge_count(begin, end); ++i) {
            const Index v = vertex_of_[i];
            if (input_of_[v] == i) next_vertex_[v] = vertex_of_[i + 1 == end ? begin : i + 1];
        }
        begin = end;
    }
    for (Index v = 0; v < next_vertex_.size(); ++v) {
        const Index w = next_vertex_[v];
        if (w != kNone && next_vertex_[w] == v) next_vertex_[v] = next_vertex_[w] = kNone;
    }
}

// In one pass over the mesh, without a branch that depends on it: most edges of most rings are Delaunay.
void Domain::mark_present_edges() {
    find_next_vertices();
    present_.assign(points_.size(), 0);
    mesh_.mark.resize(mesh_.origin.size());
    mesh_.vertex_edge.resize(points_.size());
    stack_.clear();
    for (Index e = 0; e < mesh_.origin.size(); e += 4) {
        for (Index k = e; k < e + 3; ++k) {
            const Index u = mesh_.origin[k], w = mesh_.destination(k);
            const bool forth = next_vertex_[u] == w, back = next_vertex_[w] == u;
            present_[u] |= static_cast<std::uint8_t>(forth);
            mesh_.mark[k] = (forth ? input_of_[u] + 1 : 0) | (back ? input_of_[w] + 1 : 0);
            mesh_.vertex_edge[u] = k;
            if (mesh_.twin[k] == kNone) {
                present_[w] |= static_cast<std::uint8_t>(back);
                stack_.push_back(k);
            }
        }
        mesh_.mark[e + 3] = 0;
    }
    for (const Index e : stack_) mesh_.vertex_edge[mesh_.origin[e]] = e;
}

Result<void> Domain::insert_rings() {
    mark_present_edges();
    records_.clear();
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        for (Index i = begin; i < begin + edge_count(begin, end); ++i) {
            const Index v = vertex_of_[i];
            if (present_[v] != 0 && input_of_[v] == i) continue;
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
    const std::size_t count = mesh_.triangle_count();
    inside_.assign(count, kUnreached);
    inside_count_ = 0;
    regions_.clear();
    border_count_ = 0;
    if (stack_.size() < count + 1) stack_.resize(count + 1);
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
    if (inside_count_ == 0) return fail_at(ErrorCode::degenerate, 0, "zero area: nothing lies inside");
    return check_holes();
}

// Enters a region from one of this state.
Result<void> Domain::enter(Index half_edge, State state) {
    const Index mark = mesh_.mark[half_edge];
    if (mark != 0) {
        const auto crossed = cross(state, mark);
        if (!crossed) return tl::unexpected<Error>(crossed.error());
        state = *crossed;
        if (state.outer == 0 && state.hole != 0) {
            return fail_at(ErrorCode::degenerate, record(mark - 1).input,
                           "hole " + std::to_string(state.hole) + " reaches outside the outer ring");
        }
    }
    regions_.push_back(state);
    flood(half_edge / 4);
    return {};
}

// Gives the triangle's whole region the last state. Which neighbours are new and which edges are marked is hard to
// predict: all are written, and few are kept.
void Domain::flood(Index triangle) {
    const auto region = static_cast<Index>(regions_.size() - 1);
    const std::uint8_t value = regions_[region].outer != 0 && regions_[region].hole == 0;
    const Index *const twin = mesh_.twin.data(), *const mark = mesh_.mark.data();
    Index* const stack = stack_.data();
    Border* const borders = borders_.data();
    std::uint8_t* const inside = inside_.data();
    std::size_t waiting = 1, borders_end = border_count_, reached = 0;
    inside[triangle] = value;
    stack[0] = 4 * triangle;
    while (waiting > 0) {
        const Index first = stack[--waiting];
        ++reached;
        for (Index e = first; e < first + 3; ++e) {
            const Index f = twin[e] == kNone ? e : twin[e];
            const bool fresh = inside[f / 4] == kUnreached, open = mark[e] == 0;
            inside[f / 4] = fresh && open ? value : inside[f / 4];
            stack[waiting] = f & ~3u;
            waiting += fresh & open;
            borders[borders_end] = {f, region};
            borders_end += fresh & !open;
        }
    }
    border_count_ = borders_end;
    inside_count_ += value * reached;
}

// A hole of which no vertex touches the inside lies outside, within another hole, or is a spike there.
Result<void> Domain::check_holes() const {
    for (std::size_t r = 1; r < polygon_->ring_count(); ++r) {
        const Index begin = polygon_->ring_ends[r - 1], end = polygon_->ring_ends[r];
        bool touches = begin == end;
        for (Index i = begin; i < end && !touches; ++i) touches = touches_inside(vertex_of_[i]);
        if (!touches)
            return fail_at(ErrorCode::degenerate, begin, "hole " + std::to_string(r) + " lies outside the polygon");
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
