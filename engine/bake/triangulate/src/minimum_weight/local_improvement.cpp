// SPDX-License-Identifier: MIT
#include "minimum_weight/local_improvement.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/predicates.hpp>

#include "minimum_weight/least_sum.hpp"
#include "minimum_weight/local_minimality.hpp"

namespace crofton::triangulate {
namespace {

// A window's programme takes about window³ / 6 steps of 1 ns for half as many triangles that are then done.
constexpr Index kWindow = 48;
constexpr int kMostSweeps = 6;
// A window must become lighter by more than rounding, so that sweeps end.
constexpr double kWorthwhile = 1.0 - 0x1p-40;

double length(const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 d = a - b;
    return std::sqrt(d.x * d.x + d.y * d.y);
}

}  // namespace

void LocalImprovement::clear(const Domain& domain, Index triangles) {
    domain_ = &domain;
    points_ = domain.mesh().points;
    origin_.assign(4 * std::size_t{triangles}, kNone);
    twin_.assign(origin_.size(), kNone);
    input_.assign(origin_.size(), kNone);
    fixed_.assign(origin_.size(), 0);
}

void LocalImprovement::link(Index e, Index f) {
    twin_[e] = f;
    if (f != kNone) twin_[f] = e;
}

void LocalImprovement::start_from_mesh(const Domain& domain) {
    const HalfEdgeMesh& mesh = domain.mesh();
    triangle_map_.assign(mesh.triangle_count(), kNone);
    Index count = 0;
    for (Index t = 0; t < mesh.triangle_count(); ++t)
        if (domain.inside(t)) triangle_map_[t] = count++;
    clear(domain, count);
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
        if (triangle_map_[t] == kNone) continue;
        for (Index k = 0; k < 3; ++k) {
            const Index from = 4 * t + k, to = 4 * triangle_map_[t] + k, twin = mesh.twin[from];
            origin_[to] = mesh.origin[from];
            input_[to] = domain.input_index(from);
            fixed_[to] = mesh.mark[from] != 0;
            if (twin != kNone && triangle_map_[twin / 4] != kNone)
                twin_[to] = 4 * triangle_map_[twin / 4] + (twin & 3u);
        }
    }
}

bool LocalImprovement::start_from_triangles(const Domain& domain,
                                            std::span<const std::array<std::uint32_t, 3>> triangles) {
    clear(domain, static_cast<Index>(triangles.size()));
    pairs_.clear();
    half_edge_of_.clear();
    for (Index t = 0; t < triangles.size(); ++t) {
        for (Index k = 0; k < 3; ++k) {
            input_[4 * t + k] = triangles[t][k];
            origin_[4 * t + k] = domain.vertex_of(triangles[t][k]);
        }
        for (Index e = 4 * t; e < 4 * t + 3; ++e) {
            if (pairs_.number(origin_[e], destination(e)) != half_edge_of_.size()) return false;
            half_edge_of_.push_back(e);
        }
    }
    for (const Index e : half_edge_of_) {
        const Index beyond = pairs_.find_number(destination(e), origin_[e]);
        if (beyond != PairTable::kNew) twin_[e] = half_edge_of_[beyond];
    }
    // Slits: constraints with the inside on both sides.
    const HalfEdgeMesh& mesh = domain.mesh();
    if (domain.ring_count() == 1 && !domain.has_touching_rings()) return true;
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        if ((e & 3u) == 3u || mesh.mark[e] == 0) continue;
        const Index here = pairs_.find_number(mesh.origin[e], mesh.destination(e));
        if (here != PairTable::kNew) fixed_[half_edge_of_[here]] = 1;
    }
    return true;
}

double LocalImprovement::weight() const {
    double sum = 0.0;
    for (Index e = 0; e < origin_.size(); ++e) {
        if ((e & 3u) != 3u && twin_[e] != kNone && e < twin_[e])
            sum += length(points_[origin_[e]], points_[destination(e)]);
    }
    return sum;
}

void LocalImprovement::write(Vector<std::array<std::uint32_t, 3>>& triangles) const {
    triangles.clear();
    triangles.reserve(triangle_count());
    for (Index t = 0; t < triangle_count(); ++t)
        triangles.push_back({input_[4 * t], input_[4 * t + 1], input_[4 * t + 2]});
}

void LocalImprovement::run(Watch& watch) {
    flip_all(watch);
    improve_windows(watch);
}

// Every flip makes the triangulation lighter, or as light with an edge of smaller rank: it ends.
void LocalImprovement::flip_all(Watch& watch) {
    stack_.clear();
    waiting_.assign(origin_.size(), 0);
    const auto ask = [&](Index e) {
        if (!is_diagonal(e)) return;
        const Index edge = std::min(e, twin_[e]);
        if (waiting_[edge] != 0) return;
        waiting_[edge] = 1;
        stack_.push_back(edge);
    };
    for (Index e = static_cast<Index>(origin_.size()); e-- > 0;)
        if ((e & 3u) != 3u && is_diagonal(e) && e < twin_[e]) ask(e);
    while (!stack_.empty() && !watch.cancelled_by_now()) {
        const Index e = stack_.back();
        stack_.pop_back();
        waiting_[e] = 0;
        if (!is_diagonal(e) || locally_minimal(points_, origin_[e], destination(e), apex(e), apex(twin_[e]))) continue;
        const Index f = twin_[e];
        // The edges around it change places, so that what waits there is another edge: all four are asked again.
        flip(e);
        for (const Index edge : {next(e), previous(e), next(f), previous(f)}) ask(edge);
    }
}

// Edge ab between triangles abc and bad becomes cd: e runs from d to c afterwards, its twin from c to d.
void LocalImprovement::flip(Index e) {
    const Index f = twin_[e];
    const Index bc = next(e), ca = previous(e), ad = next(f), db = previous(f);
    struct Outer {
        Index origin, input, twin;
        std::uint8_t fixed;
    };
    const auto take = [&](Index h) { return Outer{origin_[h], input_[h], twin_[h], fixed_[h]}; };
    const Outer b_c = take(bc), c_a = take(ca), a_d = take(ad), d_b = take(db);
    const auto put = [&](Index h, const Outer& o) {
        origin_[h] = o.origin;
        input_[h] = o.input;
        fixed_[h] = o.fixed;
        link(h, o.twin);
    };
    // Triangle of e: d → c, c → a, a → d. Triangle of f: c → d, d → b, b → c.
    origin_[e] = d_b.origin;
    input_[e] = d_b.input;
    put(next(e), c_a);
    put(previous(e), a_d);
    origin_[f] = c_a.origin;
    input_[f] = c_a.input;
    put(next(f), d_b);
    put(previous(f), b_c);
    link(e, f);
}

// In the first sweep every triangle is in a window's first half; later ones look again at where something changed.
void LocalImprovement::improve_windows(Watch& watch) {
    if (triangle_count() < 3) return;
    done_.assign(triangle_count(), 0);
    vertex_stamp_.assign(points_.size(), 0);
    triangle_stamp_.assign(triangle_count(), 0);
    stamp_ = 0;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        bool changed = false;
        for (Index t = 0; t < triangle_count(); ++t) {
            if (done_[t] != 0) continue;
            if (watch.cancelled_by_now()) return;
            const bool lighter = improve_window(t);
            changed |= lighter;
            const std::size_t half = (window_.size() + 1) / 2;
            for (std::size_t i = 0; i < window_.size(); ++i) {
                if (lighter)
                    done_[window_[i]] = 0;
                else if (i < half)
                    done_[window_[i]] = 1;
            }
        }
        if (!changed) return;
    }
}

bool LocalImprovement::improve_window(Index seed) {
    collect_window(seed);
    if (window_.size() < 2) return false;
    collect_boundary();
    const double least = solve_window();
    if (!(least < window_weight_ * kWorthwhile)) return false;
    replace_window();
    return true;
}

// Breadth first from the seed across diagonals. A triangle is taken only if its far vertex is new, so that the window
// is a simple polygon without a vertex inside.
void LocalImprovement::collect_window(Index seed) {
    ++stamp_;
    window_.assign(1, seed);
    triangle_stamp_[seed] = stamp_;
    for (Index k = 0; k < 3; ++k) vertex_stamp_[origin_[4 * seed + k]] = stamp_;
    window_weight_ = 0.0;
    for (std::size_t i = 0; i < window_.size() && window_.size() < kWindow; ++i) {
        for (Index e = 4 * window_[i]; e < 4 * window_[i] + 3 && window_.size() < kWindow; ++e) {
            if (!is_diagonal(e)) continue;
            const Index f = twin_[e];
            if (triangle_stamp_[f / 4] == stamp_ || vertex_stamp_[apex(f)] == stamp_) continue;
            triangle_stamp_[f / 4] = stamp_;
            vertex_stamp_[apex(f)] = stamp_;
            window_.push_back(f / 4);
            window_weight_ += length(points_[origin_[e]], points_[destination(e)]);
        }
    }
}

// Around the window: the sides of its triangles, and instead of a side that another one lies beyond that one's sides.
// No two of its triangles meet but where one was entered from the other: its far vertex was new.
void LocalImprovement::collect_boundary() {
    sides_.clear();
    corners_.clear();
    const Index first = 4 * window_[0];
    stack_.assign({first + 2, first + 1, first});
    while (!stack_.empty()) {
        const Index e = stack_.back(), f = twin_[e];
        stack_.pop_back();
        if (is_diagonal(e) && triangle_stamp_[f / 4] == stamp_) {
            stack_.push_back(previous(f));
            stack_.push_back(next(f));
        } else {
            sides_.push_back({f, fixed_[e], origin_[e], input_[e]});
            corners_.push_back(points_[origin_[e]]);
        }
    }
}

// The interval programme over all triples that turn left. Triangles that all turn left and are joined as the programme
// joins them cover each point as often as the boundary winds around it, which is once. So no diagonal need be tested.
double LocalImprovement::solve_window() {
    const Index count = static_cast<Index>(sides_.size());
    values_.assign(std::size_t{count} * count, 0.0);
    apex_.assign(values_.size(), 0);
    for (Index low = count - 1; low-- > 0;) {
        for (Index high = low + 2; high < count; ++high) {
            const double *const left = &values_[low * count], *const right = &values_[high * count];
            const auto turns_left = [&](Index k) {
                return orientation(corners_[low], corners_[k], corners_[high]) > 0;
            };
            double least = least_of_sums(left + low + 1, right + low + 1, high - low - 1);
            Index best = low + 1;
            while (best < high && left[best] + right[best] != least) ++best;
            if (least < kInfinity && !turns_left(best)) {
                least = kInfinity;
                for (Index k = low + 1; k < high; ++k) {
                    if (left[k] + right[k] < least && turns_left(k)) {
                        least = left[k] + right[k];
                        best = k;
                    }
                }
            }
            if (low != 0 || high + 1 != count) least += length(corners_[low], corners_[high]);
            values_[low * count + high] = values_[high * count + low] = least;
            apex_[low * count + high] = static_cast<std::uint16_t>(best);
        }
    }
    return values_[count - 1];
}

// Reuses the window's triangles for those of its minimum.
void LocalImprovement::replace_window() {
    const Index count = static_cast<Index>(sides_.size());
    std::size_t used = 0;
    open_.assign(1, {0, count - 1, kNone});
    const auto attach = [&](Index e, Index side) {
        fixed_[e] = sides_[side].fixed;
        twin_[e] = sides_[side].beyond;
        if (twin_[e] != kNone) twin_[twin_[e]] = e;
    };
    while (!open_.empty()) {
        const Open at = open_.back();
        open_.pop_back();
        const Index t = 4 * window_[used++], middle = apex_[at.low * count + at.high];
        const Index corners[] = {at.low, middle, at.high};
        for (Index k = 0; k < 3; ++k) {
            origin_[t + k] = sides_[corners[k]].vertex;
            input_[t + k] = sides_[corners[k]].input;
            fixed_[t + k] = 0;
        }
        if (at.beyond == kNone)
            attach(t + 2, count - 1);
        else
            link(t + 2, at.beyond);
        for (Index k = 0; k < 2; ++k) {
            if (corners[k + 1] == corners[k] + 1)
                attach(t + k, corners[k]);
            else
                open_.push_back({corners[k], corners[k + 1], t + k});
        }
    }
}

}  // namespace crofton::triangulate
