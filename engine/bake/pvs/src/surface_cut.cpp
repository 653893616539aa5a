// SPDX-License-Identifier: MIT
#include "surface_cut.hpp"

#include <algorithm>
#include <array>
#include <crofton/geometry/predicates.hpp>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "cell_walk.hpp"

namespace crofton::pvs {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kNoProgress = 1e-7;  // of the squared distance

struct DifferenceSimplex {
    std::array<glm::dvec3, 4> points{};
    std::size_t count = 0;
};

struct Nearest {
    double squared = std::numeric_limits<double>::infinity();
    glm::dvec3 point{0.0};
    DifferenceSimplex on;  // the corners it lies between

    void offer(const glm::dvec3& p, std::initializer_list<glm::dvec3> corners) {
        const double now = glm::dot(p, p);
        if (!(now < squared)) return;
        squared = now;
        point = p;
        on.count = 0;
        for (const glm::dvec3& corner : corners) on.points[on.count++] = corner;
    }
};

void offer_segment(const glm::dvec3& a, const glm::dvec3& b, Nearest& best) {
    const glm::dvec3 along = b - a;
    const double t = -glm::dot(a, along), length2 = glm::dot(along, along);
    if (t > 0.0 && t < length2) best.offer(a + t / length2 * along, {a, b});
}

void offer_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, Nearest& best) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length2 = glm::dot(n, n);
    if (!(length2 > 0.0) || glm::dot(glm::cross(n, b - a), a) > 0.0 || glm::dot(glm::cross(n, c - b), b) > 0.0 ||
        glm::dot(glm::cross(n, a - c), c) > 0.0)
        return;
    best.offer(glm::dot(n, a) / length2 * n, {a, b, c});
}

// True if the origin is on the same side of each face as the corner across from it.
bool holds_origin(const std::array<glm::dvec3, 4>& p) {
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 &a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
        const glm::dvec3 n = glm::cross(b - a, c - a);
        if (!(glm::dot(n, p[k] - a) * glm::dot(n, -a) > 0.0)) return false;
    }
    return true;
}

// The point of a simplex that is nearest to the origin. Plain: of all corners, sides and faces.
Nearest nearest_of(const DifferenceSimplex& simplex) {
    Nearest best;
    const auto& p = simplex.points;
    for (std::size_t i = 0; i < simplex.count; ++i) {
        best.offer(p[i], {p[i]});
        for (std::size_t j = i + 1; j < simplex.count; ++j) {
            offer_segment(p[i], p[j], best);
            for (std::size_t k = j + 1; k < simplex.count; ++k) offer_triangle(p[i], p[j], p[k], best);
        }
    }
    return best;
}

// True only if two parallel planes part the sets, more than `gap` from each other; gap ≥ 0. So the convex hulls are
// farther apart than that, but for the rounding of a difference of two dot products. False where they are not, and
// within 1e-6 of the distance where they are. Gilbert, Johnson, Keerthi 1988. `axis`: a direction to begin with, or 0;
// replaced by the one that was found. At least one point each.
bool are_apart(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b, double gap, glm::dvec3& axis) {
    DifferenceSimplex simplex;
    glm::dvec3 v = axis;  // from b to a
    if (!(glm::dot(v, v) > 0.0)) v = a[0] - b[0];
    if (!(glm::dot(v, v) > 0.0)) v = glm::dvec3(1.0, 0.0, 0.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMaxSteps; ++step) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        std::size_t of_a = 0, of_b = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (const double x = glm::dot(v, a[i]); x < low) low = x, of_a = i;
        for (std::size_t i = 0; i < b.size(); ++i)
            if (const double x = glm::dot(v, b[i]); x > high) high = x, of_b = i;
        const double room = low - high, length2 = glm::dot(v, v);
        if (room > 0.0 && room * room > gap * gap * length2) {
            axis = v;
            return true;
        }
        if (simplex.count > 0 && length2 - room <= kNoProgress * length2) return false;
        if (simplex.count == 4) return false;
        simplex.points[simplex.count++] = a[of_a] - b[of_b];
        if (simplex.count == 4 && holds_origin(simplex.points)) return false;
        const Nearest found = nearest_of(simplex);
        if (!(found.squared < nearest) || found.squared <= gap * gap) return false;
        nearest = found.squared;
        v = found.point;
        simplex = found.on;
    }
    return false;
}

// Places between the corners, of which segments hardly ever run through edges of regular scenes.
constexpr int kTries = 3;
constexpr double kWeights[kTries][8] = {{0.131, 0.117, 0.129, 0.121, 0.127, 0.119, 0.133, 0.123},
                                        {0.113, 0.137, 0.119, 0.131, 0.118, 0.134, 0.122, 0.126},
                                        {0.139, 0.111, 0.124, 0.122, 0.116, 0.132, 0.121, 0.135}};

glm::dvec3 middle_of(std::span<const glm::dvec3> corners, int attempt) {
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        // The object's are those of the eyes in another order.
        const double weight = kWeights[attempt][i];
        sum += weight * corners[i];
        weights += weight;
    }
    return sum / weights;
}

constexpr std::uint32_t kBetweenLooks = 16;

bool overlap(const Aabb& a, const Aabb& b, double room) {
    for (int k = 0; k < 3; ++k)
        if (a.min[k] > b.max[k] + room || a.max[k] < b.min[k] - room) return false;
    return true;
}

}  // namespace

SurfaceCut::SurfaceCut(const Surface& surface, const CutOptions& options) : surface_(surface), options_(options) {
    left_out_.assign(surface.faces.size(), 0);
    in_shaft_.assign(surface.edges.size(), 0);
    visited_.assign(2 * surface.faces.size(), 0);
}

SurfaceCut::Answer SurfaceCut::ask(const Corners& eyes, const Corners& object) {
    if (!surface_.tree) return Answer::open;
    ++question_;
    steps_ = 0;
    eyes_bounds_ = object_bounds_ = Aabb{};
    for (std::size_t i = 0; i < 8; ++i) {
        hull_[i] = eyes[i], hull_[8 + i] = object[i];
        eyes_bounds_.include(eyes[i]);
        object_bounds_.include(object[i]);
    }
    hull_bounds_ = eyes_bounds_;
    hull_bounds_.include(object_bounds_);
    bool clear = false;
    for (int attempt = 0; attempt < kTries && !clear; ++attempt)
        clear = find_crossings(middle_of(eyes, attempt), middle_of(object, kTries - 1 - attempt));
    if (!clear) return Answer::partly;
    if (crossings_.empty()) return Answer::open;
    support_hull();
    std::erase_if(crossings_, [&](const Crossing& c) { return is_left_out(c.face); });
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& a, const Crossing& b) { return a.t != b.t ? a.t < b.t : a.face < b.face; });
    const std::uint64_t before = flood_;
    for (const Crossing& c : crossings_) {
        const bool hides = options_.sides == occlude::Sides::both || c.near_side == Seen::front;
        const bool is_known = visited_[2 * c.face + static_cast<std::size_t>(c.near_side)] > before;
        if (hides && !is_known && cuts_from(c.face, c.near_side)) return Answer::cut;
        if (steps_ >= options_.steps) break;
    }
    return Answer::partly;
}

// Decided exactly: the segment's ends are on either side of the plane, and it passes all edges on the same side.
bool SurfaceCut::find_crossings(const glm::dvec3& p, const glm::dvec3& q) {
    crossings_.clear();
    const Line line{p, q - p};
    stack_.assign(1, BoxGroups::kRoot);
    while (!stack_.empty()) {
        const auto& node = (*surface_.tree)[stack_.back()];
        stack_.pop_back();
        double begin = 0.0, end = 0.0;
        const Aabb box{node.box.min - options_.gap, node.box.max + options_.gap};
        if (!clip(line, box, begin, end) || begin > 1.0 || end < 0.0) continue;
        if (node.count > 1) {
            stack_.push_back(node.child);
            stack_.push_back(node.child + 1);
            continue;
        }
        const std::uint32_t face = surface_.tree->items(node)[0];
        const auto [a, b, c] = surface_.triangle(face);
        const int from = orientation(a, b, c, p), to = orientation(a, b, c, q);
        if (from * to >= 0) continue;
        const int x = orientation(p, q, a, b), y = orientation(p, q, b, c), z = orientation(p, q, c, a);
        if ((x < 0 || y < 0 || z < 0) && (x > 0 || y > 0 || z > 0)) continue;
        if (x == 0 || y == 0 || z == 0) return false;
        const glm::dvec3 n = glm::cross(b - a, c - a);
        crossings_.push_back(
            {glm::dot(n, a - p) / glm::dot(n, line.direction), face, from < 0 ? Seen::front : Seen::back});
    }
    return true;
}

bool SurfaceCut::cuts_from(std::uint32_t face, Seen side) {
    ++flood_;
    open_.clear();
    visit(face, side);
    while (!open_.empty()) {
        if (++steps_ > options_.steps || (steps_ % kBetweenLooks == 0 && is_lost())) return false;
        const SideOf next = open_.back();
        open_.pop_back();
        pass_edges(next.face, next.side);
    }
    const int sum = sum_of_signs();
    return options_.sides == occlude::Sides::both ? sum != 0 : sum > 0;
}

void SurfaceCut::visit(std::uint32_t face, Seen side) {
    if (was_visited(face, side)) return;
    visited_[2 * face + static_cast<std::size_t>(side)] = flood_;
    open_.push_back({face, side});
    // A back face hides nothing there: the space behind it continues in front.
    if (options_.sides == occlude::Sides::front && side == Seen::back) visit(face, Seen::front);
}

void SurfaceCut::pass_edges(std::uint32_t face, Seen side) {
    const Surface::Face& from = surface_.faces[face];
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t e = from.edges[k];
        if (!is_in_shaft(e)) continue;
        const Surface::Edge& edge = surface_.edges[e];
        std::uint32_t at = from.spokes[k] - edge.first;
        const bool on = surface_.spokes[edge.first + at].along == (side == Seen::front);  // the way that the side looks
        std::uint32_t left = edge.count;
        do at = on ? (at + 1 < edge.count ? at + 1 : 0) : (at > 0 ? at - 1 : edge.count - 1);
        while (--left > 0 && is_left_out(surface_.spokes[edge.first + at].face));
        const Surface::Spoke& next = surface_.spokes[edge.first + at];
        visit(next.face, next.along == on ? Seen::back : Seen::front);
    }
}

bool SurfaceCut::is_lost() const {
    return std::all_of(crossings_.begin(), crossings_.end(), [&](const Crossing& c) {
        return was_visited(c.face, Seen::front) && was_visited(c.face, Seen::back);
    });
}

// Across each axis, the planes through four pairs of corners of the two boxes, moved out until they hold all (Haines
// and Wallace 1991).
void SurfaceCut::support_hull() {
    Support* next = supports_.data();
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const bool high_u : {false, true})
            for (const bool high_v : {false, true}) {
                const Aabb &e = eyes_bounds_, &o = object_bounds_;
                const double along_u = (high_u ? o.max[u] - e.max[u] : o.min[u] - e.min[u]);
                const double along_v = (high_v ? o.max[v] - e.max[v] : o.min[v] - e.min[v]);
                glm::dvec3 n(0.0);
                n[u] = -along_v, n[v] = along_u;
                if (n[u] * (high_u ? 1.0 : -1.0) + n[v] * (high_v ? 1.0 : -1.0) < 0.0) n = -n;
                const double length = glm::length(n);
                if (length > 0.0) n /= length;
                double most = -std::numeric_limits<double>::infinity();
                for (const glm::dvec3& p : hull_) most = (std::max)(most, glm::dot(n, p));
                *next++ = {n, most};
            }
    }
}

int SurfaceCut::sum_of_signs() const {
    int sum = 0;
    for (const Crossing& c : crossings_) {
        const Seen far_side = c.near_side == Seen::front ? Seen::back : Seen::front;
        sum += static_cast<int>(was_visited(c.face, c.near_side)) - static_cast<int>(was_visited(c.face, far_side));
    }
    return sum;
}

bool SurfaceCut::is_left_out(std::uint32_t face) {
    std::uint64_t& known = left_out_[face];
    if (known / 2 == question_) return known % 2 != 0;
    const auto triangle = surface_.triangle(face);
    const Aabb& box = surface_.bounds[face];
    const std::span<const glm::dvec3> all(hull_);
    const double near = options_.near_radius + options_.gap;
    const bool is_near =
        (overlap(box, eyes_bounds_, near) && !are_apart(all.first(8), triangle, near, eyes_axis_)) ||
        (overlap(box, object_bounds_, options_.gap) && !are_apart(all.last(8), triangle, options_.gap, object_axis_));
    known = 2 * question_ + static_cast<std::uint64_t>(is_near);
    return is_near;
}

bool SurfaceCut::is_in_shaft(std::uint32_t e) {
    std::uint64_t& known = in_shaft_[e];
    if (known / 2 == question_) return known % 2 != 0;
    const Surface::Edge& edge = surface_.edges[e];
    const std::array<glm::dvec3, 2> ends = {surface_.positions[edge.from], surface_.positions[edge.to]};
    Aabb box;
    for (const glm::dvec3& end : ends) box.include(end);
    bool is_in = overlap(box, hull_bounds_, options_.gap);
    for (std::size_t i = 0; i < supports_.size() && is_in; ++i) {
        const auto& [normal, most] = supports_[i];
        is_in = (std::min)(glm::dot(normal, ends[0]), glm::dot(normal, ends[1])) <= most + options_.gap;
    }
    is_in = is_in && !are_apart(hull_, ends, options_.gap, hull_axis_);
    known = 2 * question_ + static_cast<std::uint64_t>(is_in);
    return is_in;
}

}  // namespace crofton::pvs
