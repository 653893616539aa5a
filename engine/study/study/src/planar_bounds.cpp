// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <queue>
#include <span>

#include "exact_cross.hpp"
#include "sinusoid.hpp"

namespace crofton::study {
namespace {

using std::numbers::pi;

// Centres of circles through corners p and q that contain all corners: middle + t·normal for t in [begin, end], radius
// √(half² + t²), with `half` half the distance of p and q. An end may be infinite.
struct VoronoiEdge {
    glm::dvec2 middle{0.0};
    glm::dvec2 normal{0.0};
    double half = 0.0;
    double begin = 0.0;
    double end = 0.0;
};

// (b − a) × (c − a) within a few roundings of itself. Corners nearly on a line have circles all the same; the sign says
// on which side their centres lie.
double twice_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
    if (std::abs(left - right) > 0.5 * (std::abs(left) + std::abs(right))) return left - right;
    return exact_cross(a, b, a, c).estimate();
}

// Where the circle through a, b and c has its centre on the bisector of a and b, along the left normal of a → b.
double place_of_center(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double height = twice_area(a, b, c) / glm::length(b - a);
    return glm::dot(c - a, c - b) / (2.0 * height);
}

struct Candidate {
    double radius, angle;
    std::uint32_t corner, version;
    // The corner whose circle with its neighbours is the largest goes first; ties by the wider angle, then by number.
    bool operator<(const Candidate& other) const {
        if (radius != other.radius) return radius < other.radius;
        if (angle != other.angle) return angle < other.angle;
        return corner > other.corner;
    }
};

// Corners left, in a ring; each owns the growing edge to its successor.
class Ring {
  public:
    explicit Ring(std::span<const glm::dvec2> corners)
        : corners_(corners),
          before_(corners.size()),
          after_(corners.size()),
          version_(corners.size(), 0),
          known_(corners.size(), kInfinity) {
        const auto n = static_cast<std::uint32_t>(corners.size());
        for (std::uint32_t i = 0; i < n; ++i) before_[i] = (i + n - 1) % n, after_[i] = (i + 1) % n;
        for (std::uint32_t i = 0; i < n && n > 2; ++i) push(i);
    }

    Vector<VoronoiEdge> diagram() {
        Vector<VoronoiEdge> edges;
        edges.reserve(2 * corners_.size());
        for (std::size_t left = corners_.size(); left > 2; --left) {
            const std::uint32_t p = pop(), q = before_[p], s = after_[p];
            // The centre of q, p, s ends the edges of q–p and p–s and begins that of q–s.
            edges.push_back(edge(q, p, known_[q], place_of_center(corners_[q], corners_[p], corners_[s])));
            edges.push_back(edge(p, s, known_[p], place_of_center(corners_[p], corners_[s], corners_[q])));
            known_[q] = place_of_center(corners_[q], corners_[s], corners_[p]);
            after_[q] = s;
            before_[s] = q;
            root_ = q;
            if (left > 3) push(q), push(s);
        }
        const std::uint32_t other = after_[root_];
        edges.push_back(edge(root_, other, known_[root_], -known_[other]));
        return edges;
    }

  private:
    void push(std::uint32_t i) {
        const glm::dvec2 a = corners_[before_[i]], b = corners_[i], c = corners_[after_[i]];
        const glm::dvec2 ab = b - a, bc = c - b, ac = c - a;
        const double doubled = std::abs(twice_area(a, b, c));
        const double radius = glm::length(ab) * glm::length(bc) * glm::length(ac) / (2.0 * doubled);
        heap_.push({radius, arc_tangent(doubled, -glm::dot(ab, bc)), i, ++version_[i]});
    }
    std::uint32_t pop() {
        for (;;) {
            const Candidate top = heap_.top();
            heap_.pop();
            if (top.version != version_[top.corner]) continue;
            version_[top.corner] = 0;
            return top.corner;
        }
    }
    VoronoiEdge edge(std::uint32_t p, std::uint32_t q, double s, double t) const {
        const glm::dvec2 side = corners_[q] - corners_[p];
        const double length = glm::length(side);
        return {0.5 * (corners_[p] + corners_[q]), glm::dvec2(-side.y, side.x) / length, 0.5 * length, std::min(s, t),
                std::max(s, t)};
    }

    std::span<const glm::dvec2> corners_;
    Vector<std::uint32_t> before_, after_, version_;
    Vector<double> known_;  // where the edge of corner i and its successor comes from; hull edges from infinity
    std::priority_queue<Candidate, Vector<Candidate>> heap_;
    std::uint32_t root_ = 0;
};

// `corners` strictly convex and counter-clockwise, at least two. 2n − 3 edges, in O(n log n) (Skyum, "A simple
// algorithm for computing the smallest enclosing circle", 1991). Rounding may misplace the ends of edges where four
// corners are concyclic up to rounding; every circle an edge names then misses a corner by rounding at most.
Vector<VoronoiEdge> farthest_voronoi(std::span<const glm::dvec2> corners) {
    return Ring(corners).diagram();
}

// Sizes whose cubes are finite and not 0. What is smaller than the least distance is below the rounding of all
// measures.
constexpr double kLeastSize = 1e-80, kLargestSize = 1e100, kLeastDistance = 1e-100;

struct Problem {
    Vector<glm::dvec2> corners;  // of the object's hull
    Vector<glm::dvec2> hull;     // the same, but of those too near to one another only one
    double scale = 0.0;          // the measure of the ancestors alone
    double own = 0.0;            // the measure of the object itself, a lower bound for all bounds
    double tolerance = 0.0;      // absolute
};

// Bounds the error of both integrals: about 1e-15 of the largest coordinate in each piece (planar_lines.hpp). A piece
// of the minimum begins where one of theirs does, or at one of two crossings within such a stretch.
double rounding_of_integrals(const PlanarSupport& a, const PlanarSupport& b) {
    double largest = 0.0;
    for (const PlanarSupport* each : {&a, &b})
        for (const PlanarSupport::Piece& p : each->pieces())
            largest = std::max({largest, std::abs(p.point.x), std::abs(p.point.y)});
    return 4e-15 * largest * static_cast<double>(a.pieces().size() + b.pieces().size());
}

Result<Problem> prepare(std::span<const glm::dvec2> object, const PlanarSupport& ancestors,
                        const BoundOptions& options) {
    auto hull = measure::convex_hull(object);
    if (!hull) return hull.error();
    Problem problem;
    problem.corners = std::move(*hull);
    for (const glm::dvec2& p : problem.corners) {
        const auto apart = [&](const glm::dvec2& q) {
            return std::max(std::abs(p.x - q.x), std::abs(p.y - q.y)) >= kLeastDistance;
        };
        if (problem.hull.empty() || (apart(problem.hull.back()) && apart(problem.hull.front())))
            problem.hull.push_back(p);
    }
    problem.scale = ancestors.integral();
    const PlanarSupport own = PlanarSupport::of_convex_polygon(problem.hull);
    problem.own = own.integral();
    double largest = 0.0;
    for (const PlanarSupport::Piece& p : ancestors.pieces())
        largest = std::max({largest, std::abs(p.point.x), std::abs(p.point.y), std::abs(p.radius)});
    if (!(largest <= kLargestSize) || (problem.corners.size() > 1 && largest < kLeastSize))
        return fail(ErrorCode::out_of_range, kNoItem,
                    "optimal bound: the size of the ancestors' bounds must lie in [1e-80, 1e100]");
    const double rounding = rounding_of_integrals(ancestors, own);
    problem.tolerance = std::max(std::max(1e-12, options.tolerance) * problem.scale, rounding);
    // ∫ max(0, h_object − h_ancestors): rounding only, where an ancestor touches the object.
    const double outside = problem.own - integral_of_min(ancestors, own);
    if (!(outside <= 1e-9 * problem.scale + rounding + 1e-300))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "optimal bound: the object is not inside its ancestors' bounds");
    return problem;
}

// --- discs ---

Disc disc_at(const VoronoiEdge& edge, double t) {
    return {edge.middle + t * edge.normal, std::sqrt(edge.half * edge.half + t * t)};
}

// An interval of one edge, with the measures at its ends.
struct Stretch {
    std::uint32_t edge;
    double begin, end;
    double at_begin, at_end;
};

class DiscSearch {
  public:
    DiscSearch(const Problem& problem, const PlanarSupport& ancestors)
        : problem_(problem), ancestors_(ancestors), edges_(farthest_voronoi(problem.hull)) {}

    OptimalBound<Disc> run() {
        // The smallest enclosing disc first: it is usually close to the best, so that many intervals are dropped.
        for (std::uint32_t e = 0; e < edges_.size(); ++e) add_edge(e);
        for (std::size_t i = 0; i < open_.size(); ++i) examine(Stretch(open_[i]));
        result_.lower_bound = std::max(std::min(dropped_, result_.measure), std::min(problem_.own, result_.measure));
        return result_;
    }

  private:
    double measured(std::uint32_t e, double t) {
        const Disc disc = disc_at(edges_[e], t);
        const double value = integral_of_min(ancestors_, disc);
        ++result_.evaluations;
        if (value < result_.measure) result_.measure = value, result_.bound = disc;
        return value;
    }

    // A finite edge is one interval. An infinite end is cut by doubling, from where the disc is as large as the object.
    void add_edge(std::uint32_t e) {
        const VoronoiEdge& edge = edges_[e];
        const double half = edge.half;
        double begin = edge.begin, end = edge.end;
        if (begin == -kInfinity && end == kInfinity) begin = -half, end = half;
        if (begin == -kInfinity) begin = std::min(-half, end - half);
        if (end == kInfinity) end = std::max(half, begin + half);
        const double at_begin = measured(e, begin), at_end = measured(e, end);
        open_.push_back({e, begin, end, at_begin, at_end});
        if (edge.begin == -kInfinity) open_.push_back({e, -kInfinity, begin, kInfinity, at_begin});
        if (edge.end == kInfinity) open_.push_back({e, end, kInfinity, at_end, kInfinity});
    }

    // max r″·Δt² on an interval, r = √(half² + t²), r″ = half²/r³.
    double bend(const Stretch& s) const {
        const double half = edges_[s.edge].half, length = s.end - s.begin;
        const double nearest = s.begin <= 0.0 && s.end >= 0.0 ? 0.0 : std::min(std::abs(s.begin), std::abs(s.end));
        const double r = std::sqrt(half * half + nearest * nearest);
        return (half / r) * (half / r) * length * (length / r);
    }

    void examine(const Stretch& s) {
        const double half = edges_[s.edge].half;
        if (s.begin == -kInfinity || s.end == kInfinity) {
            // Beyond t the discs contain this one's part on the centre's side of the two corners. Its support is less
            // within an angle of atan(half/t) to either side of the outward normal there, by at most r − t.
            const bool forward = s.end == kInfinity;
            const double t = std::abs(forward ? s.begin : s.end), value = forward ? s.at_begin : s.at_end;
            const double bound = value - 2.0 * half * (half / t) * (half / (std::sqrt(half * half + t * t) + t));
            // That is 1e-12 of the object where the disc is a million times as large.
            if (bound >= target() || t > 1e6 * half) return drop(bound);
            const double further = forward ? 2.0 * s.begin : 2.0 * s.end, at_further = measured(s.edge, further);
            open_.push_back(forward ? Stretch{s.edge, s.begin, further, value, at_further}
                                    : Stretch{s.edge, further, s.end, at_further, value});
            open_.push_back(forward ? Stretch{s.edge, further, kInfinity, at_further, kInfinity}
                                    : Stretch{s.edge, -kInfinity, further, kInfinity, at_further});
            return;
        }
        const double bound = std::min(s.at_begin, s.at_end) - 0.25 * pi * bend(s);
        const double middle = 0.5 * (s.begin + s.end);
        if (bound >= target() || !(s.begin < middle && middle < s.end)) return drop(bound);
        const double value = measured(s.edge, middle);
        open_.push_back({s.edge, s.begin, middle, s.at_begin, value});
        open_.push_back({s.edge, middle, s.end, value, s.at_end});
    }

    double target() const { return result_.measure - problem_.tolerance; }
    void drop(double bound) { dropped_ = std::min(dropped_, bound); }

    const Problem& problem_;
    const PlanarSupport& ancestors_;
    Vector<VoronoiEdge> edges_;
    Vector<Stretch> open_;
    double dropped_ = kInfinity;
    OptimalBound<Disc> result_{{}, kInfinity, 0.0, 0};
};

// --- rectangles ---

Rectangle rectangle_at(std::span<const glm::dvec2> hull, double theta, const std::array<std::size_t, 4>& support) {
    const glm::dvec2 axis = cosine_sine(theta), across(-axis.y, axis.x);
    const double right = glm::dot(hull[support[0]], axis), top = glm::dot(hull[support[1]], across);
    const double left = glm::dot(hull[support[2]], axis), bottom = glm::dot(hull[support[3]], across);
    return {0.5 * (right + left) * axis + 0.5 * (top + bottom) * across, axis,
            0.5 * glm::dvec2(right - left, top - bottom)};
}

// Corners that support directions θ, θ + 90°, …, searched anew for each angle, so that earlier angles change nothing.
std::array<std::size_t, 4> support_corners(std::span<const glm::dvec2> hull, double theta) {
    const glm::dvec2 axis = cosine_sine(theta), across(-axis.y, axis.x);
    const glm::dvec2 directions[4] = {axis, across, -axis, -across};
    std::array<std::size_t, 4> support{};
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t i = 1; i < hull.size(); ++i)
            if (glm::dot(hull[i] - hull[support[k]], directions[k]) > 0.0) support[k] = i;
    return support;
}

// Corners that support a little larger angle. From corner to corner: rounded angles of sides nearly parallel may come
// in another order than the sides.
void move_on(std::span<const glm::dvec2> hull, double theta, std::array<std::size_t, 4>& support) {
    const glm::dvec2 axis = cosine_sine(theta), across(-axis.y, axis.x);
    const glm::dvec2 directions[4] = {axis, across, -axis, -across};
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t steps = 0; steps < hull.size(); ++steps) {
            const std::size_t next = (support[k] + 1) % hull.size();
            if (!(glm::dot(hull[next] - hull[support[k]], directions[k]) > 0.0)) break;
            support[k] = next;
        }
}

struct Turn {
    double begin, end;
    double at_begin, at_end;
    std::array<std::size_t, 4> support;
};

class RectangleSearch {
  public:
    RectangleSearch(const Problem& problem, const PlanarSupport& ancestors) : problem_(problem), ancestors_(ancestors) {
        for (const glm::dvec2& p : problem.hull)
            diameter_ = std::max(diameter_, 2.0 * glm::length(p - problem.hull[0]));
    }

    OptimalBound<Rectangle> run() {
        const std::span<const glm::dvec2> hull = problem_.hull;
        // Where a side's normal, turned into the first quarter, changes one of the four support corners.
        Vector<double> events;
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const glm::dvec2 side = hull[(i + 1) % hull.size()] - hull[i];
            const double angle = arc_tangent(-side.x, side.y);
            events.push_back(std::min(angle - 0.5 * pi * std::floor(angle / (0.5 * pi)), 0.5 * pi));
        }
        events.push_back(0.5 * pi);
        std::sort(events.begin(), events.end());
        auto support = support_corners(hull, 0.0);
        double begin = 0.0;
        for (const double end : events) {
            if (!(begin < end)) continue;
            move_on(hull, 0.5 * (begin + end), support);
            open_.push_back({begin, end, measured(begin, support), measured(end, support), support});
            begin = end;
        }
        for (std::size_t i = 0; i < open_.size(); ++i) examine(Turn(open_[i]));
        result_.lower_bound = std::max(std::min(dropped_, result_.measure), std::min(problem_.own, result_.measure));
        return result_;
    }

  private:
    double measured(double theta, const std::array<std::size_t, 4>& support) {
        const Rectangle rectangle = rectangle_at(problem_.hull, theta, support);
        const double value = integral_of_min(ancestors_, PlanarSupport(rectangle));
        ++result_.evaluations;
        if (value < result_.measure) result_.measure = value, result_.bound = rectangle;
        return value;
    }

    void examine(const Turn& s) {
        const double length = s.end - s.begin, middle = 0.5 * (s.begin + s.end);
        const double bound = std::min(s.at_begin, s.at_end) - 8.0 * diameter_ * length * length;
        if (bound >= result_.measure - problem_.tolerance || !(s.begin < middle && middle < s.end)) {
            dropped_ = std::min(dropped_, bound);
            return;
        }
        const double value = measured(middle, s.support);
        open_.push_back({s.begin, middle, s.at_begin, value, s.support});
        open_.push_back({middle, s.end, value, s.at_end, s.support});
    }

    const Problem& problem_;
    const PlanarSupport& ancestors_;
    double diameter_ = 0.0;  // an upper bound: twice the farthest corner from the first
    Vector<Turn> open_;
    double dropped_ = kInfinity;
    OptimalBound<Rectangle> result_{{}, kInfinity, 0.0, 0};
};

// Grown by the rounding of its own numbers, so that every corner is inside.
void enclose(std::span<const glm::dvec2> hull, Disc& disc) {
    for (const glm::dvec2& p : hull) disc.radius = std::max(disc.radius, glm::length(p - disc.center));
    const double size = std::abs(disc.center.x) + std::abs(disc.center.y) + disc.radius;
    disc.radius += 4.0 * std::numeric_limits<double>::epsilon() * size;
    if (hull.size() > 1) disc.radius += kLeastDistance;  // lengths whose squares vanish
}
void enclose(std::span<const glm::dvec2> hull, Rectangle& rectangle) {
    const glm::dvec2 across(-rectangle.axis.y, rectangle.axis.x);
    double size = std::abs(rectangle.center.x) + std::abs(rectangle.center.y);
    for (const glm::dvec2& p : hull) {
        const glm::dvec2 d = p - rectangle.center;
        rectangle.half_extents.x = std::max(rectangle.half_extents.x, std::abs(glm::dot(d, rectangle.axis)));
        rectangle.half_extents.y = std::max(rectangle.half_extents.y, std::abs(glm::dot(d, across)));
    }
    size += rectangle.half_extents.x + rectangle.half_extents.y;
    rectangle.half_extents += 4.0 * std::numeric_limits<double>::epsilon() * size;
}

}  // namespace

Result<OptimalBound<Disc>> optimal_disc(std::span<const glm::dvec2> object, const PlanarSupport& ancestors,
                                        const BoundOptions& options) {
    const auto problem = prepare(object, ancestors, options);
    if (!problem) return problem.error();
    OptimalBound<Disc> result;
    if (problem->hull.size() == 1)
        result = {{problem->hull[0], 0.0}, 0.0, 0.0, 0};
    else
        result = DiscSearch(*problem, ancestors).run();
    enclose(problem->corners, result.bound);
    return result;
}

Result<OptimalBound<Rectangle>> optimal_box(std::span<const glm::dvec2> object, const PlanarSupport& ancestors) {
    const auto problem = prepare(object, ancestors, {});
    if (!problem) return problem.error();
    OptimalBound<Rectangle> result;
    result.bound = rectangle_at(problem->hull, 0.0, support_corners(problem->hull, 0.0));
    result.measure = result.lower_bound = integral_of_min(ancestors, PlanarSupport(result.bound));
    result.evaluations = 1;
    enclose(problem->corners, result.bound);
    return result;
}

Result<OptimalBound<Rectangle>> optimal_rectangle(std::span<const glm::dvec2> object, const PlanarSupport& ancestors,
                                                  const BoundOptions& options) {
    const auto problem = prepare(object, ancestors, options);
    if (!problem) return problem.error();
    auto result = RectangleSearch(*problem, ancestors).run();
    enclose(problem->corners, result.bound);
    return result;
}

}  // namespace crofton::study
