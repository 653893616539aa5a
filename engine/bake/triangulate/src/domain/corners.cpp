// SPDX-License-Identifier: MIT
// Tells input points at one position apart: finds which of them a triangle uses.
#include <algorithm>

#include "domain/domain.hpp"

// Finds which of the points at one position a triangle's corner is.

namespace crofton::triangulate {

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

Index Domain::predecessor(Index input) const {
    const Index r = ring_of(input), begin = r == 0 ? 0 : polygon_->ring_ends[r - 1];
    return (input == begin ? polygon_->ring_ends[r] : input) - 1;
}

// Returns the first of consecutive points at one position; the ring's last point precedes its first.
Index Domain::first_of_equals(Index input) const {
    const Index r = ring_of(input), begin = r == 0 ? 0 : polygon_->ring_ends[r - 1], v = vertex_of_[input];
    Index last = input;
    while (last + 1 < polygon_->ring_ends[r] && vertex_of_[last + 1] == v) ++last;
    if (last + 1 == polygon_->ring_ends[r] && vertex_of_[begin] == v) return begin;
    while (input > begin && vertex_of_[input - 1] == v) --input;
    return input;
}

bool Domain::holds(Index mark, Index input) const {
    for (Index id = mark - 1; id != kNone; id = record(id).next)
        if (record(id).input == input) return true;
    return false;
}

// A point at v of a ring that made the constraint `mark`; kNone if there is none. One is preferred at which the ring
// turns into the constraint `left_mark`, or comes from there.
Index Domain::point_at(Index v, Index mark, Index left_mark) const {
    Index found = kNone;
    for (Index id = mark - 1; id != kNone; id = record(id).next) {
        const Index input = record(id).input, end = successor(input);
        if (vertex_of_[input] == v) {
            Index before = predecessor(input);
            while (vertex_of_[before] == v) before = predecessor(before);
            if (holds(left_mark, before)) return input;
            if (found == kNone) found = input;
        }
        if (vertex_of_[end] == v) {
            Index after = end;
            while (vertex_of_[successor(after)] == v) after = successor(after);
            if (holds(left_mark, after)) return end;
            if (found == kNone) found = end;
        }
    }
    return found;
}

// Two constraints bound the corner's sector. Turning clockwise from the corner, the first one with a point here
// decides. The one on the left decides on which side of a slit that is.
Index Domain::input_index(Index e) const {
    const Index v = mesh_.origin[e];
    if (shared_[v] == 0) return input_of_[v];
    Index left_mark = 0;
    for (Index edge = e; edge != kNone && left_mark == 0;) {
        left_mark = mesh_.mark[previous(edge)];
        edge = mesh_.rotate(edge);
        if (edge == e) break;
    }
    for (Index edge = e;;) {
        if (mesh_.mark[edge] != 0)
            if (const Index point = point_at(v, mesh_.mark[edge], left_mark); point != kNone)
                return first_of_equals(point);
        const Index twin = mesh_.twin[edge];
        if (twin == kNone) return input_of_[v];
        edge = next(twin);
        if (edge == e) return input_of_[v];
    }
}

}  // namespace crofton::triangulate
