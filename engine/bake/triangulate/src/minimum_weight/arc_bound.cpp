// SPDX-License-Identifier: MIT
#include "minimum_weight/arc_bound.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/predicates.hpp>

namespace crofton::triangulate {
namespace {

constexpr std::size_t kSides = 96;  // of an arc
constexpr int kFarthestCells = 48;
constexpr Index kMany = kNone - 1;  // of next_ and previous_: the vertex is on the boundary several times

double length(const glm::dvec2& d) {
    return std::sqrt(d.x * d.x + d.y * d.y);
}

}  // namespace

double ArcBound::weight(const Domain& domain, const CandidateGraph* candidates) {
    candidates_ = candidates;
    points_ = domain.mesh().points;
    sum_ = 0.0;
    place_.assign(points_.size(), 0);
    stamp_.assign(points_.size(), 0);
    stamp_of_arc_ = 0;
    done_.assign(points_.size(), 0);
    find_chains(domain);
    if (candidates_ == nullptr) fill_cells();
    const auto is_chain = [&](Index v) { return next_[v] < kMany && previous_[v] < kMany; };
    // First from the ends of chains, then from anywhere on rings.
    for (const bool rings : {false, true})
        for (Index v = 0; v < next_.size(); ++v)
            if (done_[v] == 0 && is_chain(v) && (rings || !is_chain(previous_[v]))) add_chain(v);
    return sum_;
}

// The boundary with the inside on its left. Slits, and vertices that several pieces of boundary meet, are on no chain.
void ArcBound::find_chains(const Domain& domain) {
    const auto& mesh = domain.mesh();
    next_.assign(points_.size(), kNone);
    previous_.assign(points_.size(), kNone);
    const auto set = [](Index& neighbour, Index to) { neighbour = neighbour == kNone ? to : kMany; };
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        if ((e & 3u) == 3u || mesh.mark[e] == 0 || !domain.inside(e / 4)) continue;
        const Index from = mesh.origin[e], to = mesh.destination(e), twin = mesh.twin[e];
        const bool is_slit = twin != kNone && domain.inside(twin / 4);
        set(next_[from], is_slit ? kMany : to);
        set(previous_[to], is_slit ? kMany : from);
    }
}

void ArcBound::add_chain(Index first) {
    chain_.assign(1, first);
    done_[first] = 1;
    bool is_ring = false;
    for (Index v = next_[first];; v = next_[v]) {
        chain_.push_back(v);
        is_ring = v == first;
        if (is_ring || next_[v] >= kMany || previous_[v] >= kMany || done_[v] != 0) break;
        done_[v] = 1;
    }
    const std::size_t sides = chain_.size() - 1;
    std::size_t most = kSides;
    if (is_ring) most = std::min(most, (sides + 1) / 2);  // two arcs at least: no vertex is on an arc twice
    for (std::size_t begin = 0; begin < sides; begin += most)
        bound_arc(std::span(chain_).subspan(begin, std::min(most, sides - begin) + 1));
}

void ArcBound::bound_arc(std::span<const Index> arc) {
    if (arc.size() < 3) return;
    ++stamp_of_arc_;
    for (std::size_t i = 0; i < arc.size(); ++i) {
        stamp_[arc[i]] = stamp_of_arc_;
        place_[arc[i]] = static_cast<Index>(i);
    }
    chord_.assign(arc.size() * arc.size(), kInfinity);
    leaving_.assign(arc.size(), kInfinity);
    candidates_ != nullptr ? measure_by_candidates(arc) : measure_by_distance(arc);
    sum_ += least_weight(arc.size() - 1);
}

void ArcBound::measure_by_candidates(std::span<const Index> arc) {
    const CandidateGraph& g = *candidates_;
    for (std::size_t i = 0; i < arc.size(); ++i)
        for (Index h = g.first[arc[i]]; h < g.first[arc[i] + 1]; ++h) {
            if ((g.flags[h] & (CandidateGraph::kDead | CandidateGraph::kConstraint)) != 0) continue;
            const Index to = g.destination[h];
            const double l = length(points_[to] - points_[arc[i]]);
            if (stamp_[to] != stamp_of_arc_)
                leaving_[i] = std::min(leaving_[i], l);
            else if (place_[to] > i)
                chord_[i * arc.size() + place_[to]] = l;
        }
}

void ArcBound::measure_by_distance(std::span<const Index> arc) {
    for (std::size_t i = 0; i < arc.size(); ++i) {
        for (std::size_t j = i + 2; j < arc.size(); ++j)
            if (looks_inside(arc[i], arc[j]) && looks_inside(arc[j], arc[i]))
                chord_[i * arc.size() + j] = length(points_[arc[j]] - points_[arc[i]]);
        leaving_[i] = distance_beyond(arc[i]);
    }
}

// Whether the way from a vertex to another begins inside, between the sides that meet at the first one.
bool ArcBound::looks_inside(Index vertex, Index other) const {
    const Index before = previous_[vertex], after = next_[vertex];
    if (before >= kMany || after >= kMany) return true;
    const glm::dvec2 &p = points_[vertex], &q = points_[other];
    const bool left_of_next = orientation(p, points_[after], q) > 0,
               left_of_last = orientation(points_[before], p, q) > 0;
    if (left_of_next == left_of_last) return left_of_next;
    return orientation(points_[before], p, points_[after]) <= 0;
}

// To the nearest vertex that is not on the arc, or less.
double ArcBound::distance_beyond(Index vertex) const {
    const glm::dvec2 eye = points_[vertex];
    const auto column = static_cast<int>((eye.x - corner_.x) / cell_),
               row = static_cast<int>((eye.y - corner_.y) / cell_);
    double best = kInfinity;
    const auto look = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= cells_.x || y >= cells_.y) return;
        const auto cell =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
        for (Index k = first_of_cell_[cell]; k < first_of_cell_[cell + 1]; ++k)
            if (stamp_[in_cell_[k]] != stamp_of_arc_) best = std::min(best, length(points_[in_cell_[k]] - eye));
    };
    // Nothing within `reach` cells is left unseen; a cell less is far beyond the rounding of their numbers.
    for (int reach = 0; reach < kFarthestCells; ++reach) {
        if (best < cell_ * (reach - 2)) return best;
        for (int x = column - reach; x <= column + reach; ++x) {
            look(x, row - reach);
            if (reach > 0) look(x, row + reach);
        }
        for (int y = row - reach + 1; y < row + reach; ++y) {
            look(column - reach, y);
            look(column + reach, y);
        }
    }
    return std::min(best, cell_ * (kFarthestCells - 2));
}

void ArcBound::fill_cells() {
    glm::dvec2 low(kInfinity), high(-kInfinity);
    for (const glm::dvec2& p : points_) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const glm::dvec2 size = high - low;
    corner_ = low;
    const double count = static_cast<double>(points_.size());
    cell_ = std::max(std::sqrt(size.x * size.y / count), std::max(size.x, size.y) / (count + 1.0));
    if (!(cell_ > 0.0)) cell_ = 1.0;
    cells_ = {static_cast<int>(size.x / cell_) + 1, static_cast<int>(size.y / cell_) + 1};
    first_of_cell_.assign(static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y) + 1, 0);
    const auto cell_of = [&](const glm::dvec2& p) {
        const int x = std::clamp(static_cast<int>((p.x - corner_.x) / cell_), 0, cells_.x - 1),
                  y = std::clamp(static_cast<int>((p.y - corner_.y) / cell_), 0, cells_.y - 1);
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
    };
    for (const glm::dvec2& p : points_) ++first_of_cell_[cell_of(p) + 1];
    for (std::size_t c = 1; c < first_of_cell_.size(); ++c) first_of_cell_[c] += first_of_cell_[c - 1];
    in_cell_.resize(points_.size());
    next_in_cell_.assign(first_of_cell_.begin(), first_of_cell_.end() - 1);
    for (Index v = 0; v < points_.size(); ++v) in_cell_[next_in_cell_[cell_of(points_[v])]++] = v;
}

// enclosed_: of an interval that a side or a diagonal closes, with that. bare_: the same, where nothing encloses it in
// turn. reached_: of any interval, in one bare piece or in several. The diagonal from end to end may be another arc's
// too: it is not counted. Nor is what leaves next to the ends, where one triangle may be beyond two arcs.
double ArcBound::least_weight(std::size_t sides) {
    const std::size_t n = sides + 1;
    enclosed_.assign(n * n, kInfinity);
    bare_.assign(n * n, kInfinity);
    reached_.assign(n * n, kInfinity);
    const auto leaving = [&](std::size_t a, std::size_t b) {
        return a > 0 && b < sides ? 0.5 * (leaving_[a] + leaving_[b]) : 0.0;
    };
    for (std::size_t a = 0; a < sides; ++a) {
        enclosed_[a * n + a + 1] = 0.0;
        bare_[a * n + a + 1] = reached_[a * n + a + 1] = leaving(a, a + 1);
    }
    for (std::size_t span = 2; span <= sides; ++span)
        for (std::size_t a = 0; a + span <= sides; ++a) {
            const std::size_t b = a + span;
            double within = kInfinity, apart = kInfinity;
            for (std::size_t q = a + 1; q < b; ++q) {
                if (enclosed_[q * n + b] == kInfinity) continue;
                within = std::min(within, enclosed_[a * n + q] + enclosed_[q * n + b]);
                apart = std::min(apart, reached_[a * n + q] + bare_[q * n + b]);
            }
            const double chord = span == sides ? 0.0 : chord_[a * n + b];
            enclosed_[a * n + b] = chord + std::min(within, apart);
            bare_[a * n + b] = enclosed_[a * n + b] + leaving(a, b);
            reached_[a * n + b] = std::min(bare_[a * n + b], apart);
        }
    return reached_[sides];
}

}  // namespace crofton::triangulate
