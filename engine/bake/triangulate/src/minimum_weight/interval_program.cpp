// SPDX-License-Identifier: MIT
#include "minimum_weight/interval_program.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>

#include "minimum_weight/least_sum.hpp"

namespace crofton::triangulate {
namespace {

// Combinations of two sub-polygons tried in one of the watch's steps.
constexpr std::size_t kCombinationsPerStep = 8;

}  // namespace

void IntervalProgram::start(std::span<const glm::dvec2> points, const CandidateGraph& graph) {
    points_ = points;
    graph_ = &graph;
    table_.points = points;
    slot_of_.resize(graph.half_edge_count());
}

void IntervalProgram::collect_slots(std::span<const Index> walk) {
    const auto& g = *graph_;
    const auto count = static_cast<Index>(walk.size());
    walk_ = walk;
    table_.target.clear();
    slot_edge_.clear();
    table_.first.resize(count + 1);
    table_.vertices.resize(count);
    Index origin = g.destination[walk[count - 1]];
    for (Index i = 0; i < count; ++i) {
        table_.vertices[i] = origin;
        table_.first[i] = static_cast<Index>(slot_edge_.size());
        const Index begin = g.first[origin], end = g.first[origin + 1];
        const Index incoming = g.twin[walk[i == 0 ? count - 1 : i - 1]];
        table_.target.push_back(i + 1 == count ? 0 : i + 1);
        slot_edge_.push_back(walk[i]);
        for (Index h = walk[i] + 1 == end ? begin : walk[i] + 1; h != incoming; h = h + 1 == end ? begin : h + 1) {
            if ((g.flags[h] & CandidateGraph::kDead) != 0) continue;
            slot_of_[h] = static_cast<Index>(slot_edge_.size());
            table_.target.push_back(i);  // its own corner, until match_targets()
            slot_edge_.push_back(h);
        }
        table_.target.push_back(i == 0 ? count - 1 : i - 1);
        slot_edge_.push_back(incoming);
        origin = g.destination[walk[i]];
    }
    table_.first[count] = static_cast<Index>(slot_edge_.size());
    match_targets();
}

// Joins the two slots of every edge and gives each the other's corner.
void IntervalProgram::match_targets() {
    const auto& g = *graph_;
    const Index count = table_.corner_count();
    table_.twin.resize(slot_edge_.size());
    for (Index i = 0; i < count; ++i) {
        const Index out = table_.first[i], in = table_.first[i + 1 == count ? 1 : i + 2] - 1;
        table_.twin[out] = in;
        table_.twin[in] = out;
        for (Index s = table_.first[i] + 1; s + 1 < table_.first[i + 1]; ++s) {
            const Index t = slot_of_[g.twin[slot_edge_[s]]];
            table_.twin[s] = t;
            if (t < s) std::swap(table_.target[s], table_.target[t]);
        }
    }
}

double IntervalProgram::solve(std::span<const Index> walk, Watch& watch, double fraction) {
    collect_slots(walk);
    return run(watch, fraction);
}

// Slot k of corner i leads to corner i + 1 + k.
double IntervalProgram::solve_convex(std::span<const glm::dvec2> points, std::span<const Index> ring, Watch& watch,
                                     double fraction) {
    const auto count = static_cast<Index>(ring.size()), degree = count - 1;
    table_.points = points;
    table_.vertices.assign(ring.begin(), ring.end());
    table_.first.resize(count + 1);
    table_.target.resize(std::size_t{count} * degree);
    table_.twin.resize(table_.target.size());
    for (Index i = 0; i <= count; ++i) table_.first[i] = i * degree;
    for (Index i = 0; i < count; ++i) {
        for (Index k = 0; k < degree; ++k) {
            const Index j = i + 1 + k < count ? i + 1 + k : i + 1 + k - count;
            table_.target[i * degree + k] = j;
            table_.twin[i * degree + k] = j * degree + (degree - 1 - k);
        }
    }
    return run(watch, fraction);
}

std::size_t IntervalProgram::convex_bytes(std::size_t count) {
    return count * count * (3 * sizeof(Index) + sizeof(double) + 8);
}

double IntervalProgram::run(Watch& watch, double fraction) {
    const Index count = table_.corner_count();
    auto& [points, vertices, first, target, twin, value, error_bound] = table_;
    // A length has a relative error below 4u (two differences, squares, sum, root; u = 2^-53), a sum of m such terms in
    // any order below (m + 4)u; two of them and the rounding of this product: 2(m + 8)u.
    error_bound = (count + 8.0) * 0x1p-52;
    value.assign(target.size(), kInfinity);
    for (Index i = 0; i < count; ++i) value[first[i]] = value[first[i + 1] - 1] = 0.0;
    row_.assign(count, kInfinity);
    for (Index low = count - 1; low-- > 0;) {
        row_[low + 1] = 0.0;
        const Index end = first[low + 1] - 1;
        std::size_t combinations = 0;
        Index s = first[low] + 1;
        // Targets ascend from low + 1 and then wrap.
        for (; s < end && target[s] > low; ++s) {
            const Index high = target[s], begin = twin[s] + 1;
            const glm::dvec2 d = points[vertices[low]] - points[vertices[high]];
            const double least = least_sum(begin, first[high + 1]);
            value[s] = value[twin[s]] = row_[high] = least + std::sqrt(d.x * d.x + d.y * d.y);
            combinations += first[high + 1] - begin;
        }
        if (watch.stopped(fraction, combinations / kCombinationsPerStep + 1)) return kInfinity;
        if (low == 0) break;
        for (Index k = first[low]; k < s; ++k) row_[target[k]] = kInfinity;
    }
    const double least = least_sum(first[count - 1] + 1, first[count]);
    if (!(least < kInfinity) || !choice_.run(table_, watch, fraction)) return kInfinity;
    return least;
}

// The least sum of the row and the values of slots [begin, end), which are one corner's, ascending.
double IntervalProgram::least_sum(Index begin, Index end) const {
    const Index* const target = table_.target.data();
    const double *const value = table_.value.data(), *const row = row_.data();
    if (begin == end) return kInfinity;
    if (target[end - 1] - target[begin] == end - 1 - begin)
        return least_of_sums(row + target[begin], value + begin, end - begin);
    double even = kInfinity, odd = kInfinity;
    Index i = begin;
    for (; i + 2 <= end; i += 2) {
        even = std::min(even, row[target[i]] + value[i]);
        odd = std::min(odd, row[target[i + 1]] + value[i + 1]);
    }
    if (i < end) even = std::min(even, row[target[i]] + value[i]);
    return std::min(even, odd);
}

void IntervalProgram::append(Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const {
    choice_.for_each_triangle([&](Index low, Index middle, Index high) {
        triangles.push_back({walk_[low], walk_[middle], walk_[high]});
        for (const auto& [from, to] : {std::array{low, middle}, std::array{middle, high}})
            if (to != from + 1) diagonals.push_back({table_.vertices[from], table_.vertices[to]});
    });
}

}  // namespace crofton::triangulate
