// SPDX-License-Identifier: MIT
// Finds the least triangle around points of the plane.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>
#include <span>

#include "golden_section.hpp"
#include "planar_points.hpp"

namespace crofton::fit {
namespace {

using Triangle2 = std::array<glm::dvec2, 3>;
using std::numbers::pi;

// How far `p` is from `origin` across the unit vector `along`, to 2^-50 of itself: the differences and products are
// taken with their roundings.
double across_of(const glm::dvec2& p, const glm::dvec2& origin, const glm::dvec2& along) {
    const detail::TwoTerms dx = detail::two_sum(p.x, -origin.x), dy = detail::two_sum(p.y, -origin.y);
    const detail::TwoTerms left = detail::two_product(along.x, dy.high), right = detail::two_product(along.y, dx.high);
    const detail::TwoTerms difference = detail::two_sum(left.high, -right.high);
    return difference.high + (difference.low + (left.low - right.low) + (along.x * dy.low - along.y * dx.low));
}

bool holds(const Triangle2& triangle, std::span<const glm::dvec2> points) {
    return std::all_of(points.begin(), points.end(), [&](const glm::dvec2& p) {
        return orientation(triangle[0], triangle[1], p) >= 0 && orientation(triangle[1], triangle[2], p) >= 0 &&
               orientation(triangle[2], triangle[0], p) >= 0;
    });
}

double perimeter_of(const Triangle2& triangle) {
    return glm::distance(triangle[0], triangle[1]) + glm::distance(triangle[1], triangle[2]) +
           glm::distance(triangle[2], triangle[0]);
}

// Slivers whose sharp corner is at one end of the hull or beyond it.
class SharpEnd {
  public:
    SharpEnd(std::span<const glm::dvec2> hull, const glm::dvec2& end, const glm::dvec2& other)
        : hull_(hull), end_(end), along_(glm::normalize(other - end)) {
        for (const glm::dvec2& p : hull) {
            places_.emplace_back(std::max(0.0, glm::dot(p - end, along_)), across_of(p, end, along_));
            length_ = std::max(length_, places_.back().x);
            low_ = std::min(low_, places_.back().y);
            high_ = std::max(high_, places_.back().y);
            for (int k = 0; k < 2; ++k) rounding_ = std::max(rounding_, 0x1p-53 * std::abs(p[k]));
        }
    }

    // Replaces `best` by what is shorter.
    void improve(std::optional<Triangle2>& best) const {
        try_corner(end_, best);
        // Beyond the end by e the perimeter is about 2 (L + e) and what the corner's opening makes of L + e. The best
        // power of two first, then the best between its neighbours; and multiples, since corners are rounded.
        const auto perimeter = [&](double beyond) {
            return (length_ + beyond) * (2.0 + opening(beyond, middle(beyond)));
        };
        double best_beyond = length_, least = kInfinity;
        for (double beyond = length_; beyond >= std::max(rounding_, 0x1p-60 * length_); beyond *= 0.5)
            if (const double value = perimeter(beyond); value < least) least = value, best_beyond = beyond;
        best_beyond = minimise(0.5 * best_beyond, 2.0 * best_beyond, 40, perimeter);
        for (int k = 0; k < 5; ++k, best_beyond *= 2.0)
            try_corner(end_ - best_beyond * along_ + middle(best_beyond) * glm::dvec2(-along_.y, along_.x), best);
    }

  private:
    // Between the steepest lines from the corner through the points.
    [[nodiscard]] double opening(double beyond, double aside) const {
        double lowest = kInfinity, highest = -kInfinity;
        for (const glm::dvec2& p : places_) {
            const double slope = (p.y - aside) / (p.x + beyond);
            lowest = std::min(lowest, slope);
            highest = std::max(highest, slope);
        }
        return highest - lowest;
    }
    // Where the corner opens least: the opening is convex.
    [[nodiscard]] double middle(double beyond) const {
        const double thickness = high_ - low_;
        return minimise(low_ - thickness, high_ + thickness, 40, [&](double y) { return opening(beyond, y); });
    }

    void try_corner(const glm::dvec2& corner, std::optional<Triangle2>& best) const {
        const glm::dvec2* lowest = nullptr;
        const glm::dvec2* highest = nullptr;
        for (const glm::dvec2& p : hull_) {
            if (p == corner) continue;
            if (!lowest || orientation(corner, *lowest, p) < 0) lowest = &p;
            if (!highest || orientation(corner, *highest, p) > 0) highest = &p;
        }
        const glm::dvec2 across(-along_.y, along_.x);
        double reach = 0.0;
        for (const glm::dvec2& p : hull_) reach = std::max(reach, glm::dot(p - corner, along_));
        // The side across from the corner, at first through the points themselves where they are there.
        const auto end_of = [&](const glm::dvec2& through, double margin, double up) {
            const double before = glm::dot(through - corner, along_);
            const glm::dvec2 rest = (reach - before + margin) / before * (through - corner);
            return through + rest + up * margin * across;
        };
        for (double margin = 0.0; margin <= length_; margin = std::max(2.0 * margin, rounding_)) {
            const Triangle2 triangle{corner, end_of(*lowest, margin, -1.0), end_of(*highest, margin, 1.0)};
            if (best && perimeter_of(triangle) >= perimeter_of(*best)) return;
            if (!holds(triangle, hull_)) continue;
            best = triangle;
            return;
        }
    }

    std::span<const glm::dvec2> hull_;
    glm::dvec2 end_, along_;
    Vector<glm::dvec2> places_;  // along and across, from the end
    double length_ = 0.0, low_ = 0.0, high_ = 0.0, rounding_ = 0.0;
};

// Around a hull, counter-clockwise and of three corners or more, of thickness t and length L ≫ t: the least of the
// triangles with one sharp corner, at or beyond an end of the hull, and the side across from it upright at the other
// end, within t of 2 L and more. Those with two sharp corners on one side are best_triangle()'s. Contains the hull,
// decided exactly. None where no rounding of the corners does.
std::optional<Triangle2> least_sliver(std::span<const glm::dvec2> hull) {
    const auto farthest_from = [&](const glm::dvec2& from) {
        return *std::max_element(hull.begin(), hull.end(), [&](const glm::dvec2& p, const glm::dvec2& q) {
            return glm::distance(from, p) < glm::distance(from, q);
        });
    };
    const glm::dvec2 end = farthest_from(hull[0]), other = farthest_from(end);
    std::optional<Triangle2> best;
    SharpEnd(hull, end, other).improve(best);
    SharpEnd(hull, other, end).improve(best);
    return best;
}

// A convex polygon with one side on the x axis from 0 to (length, 0) and the rest above. `corners` continue
// counter-clockwise and end with 0 again; `top` is the first of the highest. The right chain is [1, top], the left one
// [top, end].
struct Standing {
    Vector<glm::dvec2> corners;
    std::size_t top = 0;
    double nearly = 0.0;  // heights that differ by no more count as equal

    // The polygon's left and right ends at height y in (0, height], and the inverse slopes dx/dy there.
    struct Cut {
        double left, right;
        double left_below, left_above, right_below, right_above;  // slopes just below and above y; ±∞ at the top
        double corner_height;                                     // of a corner that lies nearly at y, or y
    };

    void stand(std::span<const glm::dvec2> hull, std::size_t side) {
        const std::size_t n = hull.size();
        const glm::dvec2 origin = hull[side], x = glm::normalize(hull[(side + 1) % n] - origin), y(-x.y, x.x);
        corners.resize(n + 1);
        top = 1;
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec2 d = hull[(side + k) % n] - origin;
            corners[k] = k < 2 ? glm::dvec2(glm::dot(d, x), 0.0) : glm::dvec2(glm::dot(d, x), glm::dot(d, y));
            if (corners[k].y > corners[top].y) top = k;
        }
        corners[n] = glm::dvec2(0.0);
        nearly = 1e-12 * height();
    }
    [[nodiscard]] double height() const { return corners[top].y; }
    [[nodiscard]] double width() const {
        double low = 0.0, high = 0.0;
        for (const glm::dvec2& c : corners) low = std::min(low, c.x), high = std::max(high, c.x);
        return high - low;
    }
    [[nodiscard]] bool is_thin() const {
        const double a = height(), b = width();
        return std::min(a, b) < 0.1 * std::max(a, b);
    }

    [[nodiscard]] Cut cut(double y) const {
        // The first right corner that is not below y, and the first left one that is not above it.
        const auto at = [&](std::size_t k) { return corners.begin() + static_cast<std::ptrdiff_t>(k); };
        const std::size_t end = corners.size() - 1;
        const auto right = static_cast<std::size_t>(
            std::lower_bound(at(2), at(top), y - nearly, [](const glm::dvec2& c, double h) { return c.y < h; }) -
            corners.begin());
        const auto left = static_cast<std::size_t>(
            std::lower_bound(at(top + 1), at(end), y + nearly, [](const glm::dvec2& c, double h) { return c.y > h; }) -
            corners.begin());
        Cut result{};
        result.right_below = result.right_above = slope(right - 1, right);
        result.left_below = result.left_above = slope(left, left - 1);
        result.corner_height = y;
        for (const std::size_t k : {left, right})
            if (std::abs(corners[k].y - y) <= nearly) result.corner_height = corners[k].y;
        if (corners[right].y <= y + nearly && right < top) result.right_above = slope(right, right + 1);
        if (corners[left].y >= y - nearly && left < end) result.left_below = slope(left + 1, left);
        result.right = corners[right].x - (corners[right].y - y) * result.right_below;
        result.left = corners[left].x + (y - corners[left].y) * result.left_below;
        if (corners[left].y < y - nearly) result.left = corners[left].x + (y - corners[left].y) * result.left_above;
        if (corners[top].y <= y + nearly) result.left_above = kInfinity, result.right_above = -kInfinity;
        return result;
    }

    // max of dot(corner, n): n points to the right (to the left), at any height.
    [[nodiscard]] double right_support(const glm::dvec2& n) const { return support(1, top, n); }
    [[nodiscard]] double left_support(const glm::dvec2& n) const { return support(top, corners.size() - 1, n); }

  private:
    [[nodiscard]] double slope(std::size_t lower, std::size_t upper) const {
        const glm::dvec2 d = corners[upper] - corners[lower];
        return d.y > 0.0 ? d.x / d.y : d.x > 0.0 ? kInfinity : d.x < 0.0 ? -kInfinity : 0.0;
    }
    // Along the chain the product rises, then falls.
    [[nodiscard]] double support(std::size_t first, std::size_t last, const glm::dvec2& n) const {
        while (first < last) {
            const std::size_t middle = first + (last - first) / 2;
            if (glm::dot(corners[middle + 1] - corners[middle], n) > 0.0)
                first = middle + 1;
            else
                last = middle;
        }
        return glm::dot(corners[first], n);
    }
};

struct Found {
    double value = kInfinity;
    Triangle2 corners{};  // of the standing polygon
};

// Let w be the polygon's width at height y. A triangle on the same base, of height H, is w wide at y at least, so its
// area is at least w·H²/(2(H − y)) ≥ 2·y·w. Equality holds for H = 2y and sides that touch at y. Where y·w is largest
// (it is log-concave) such sides exist: there w falls by w/y a unit of height, or could.
Found least_area(const Standing& polygon) {
    double low = 0.0, high = polygon.height();
    for (int i = 0; i < 64 && low < high; ++i) {
        const double y = 0.5 * (low + high);
        const auto c = polygon.cut(y);
        (c.right - c.left + y * (c.right_above - c.left_above) > 0.0 ? low : high) = y;
    }
    const double y = polygon.cut(high).corner_height;
    const auto c = polygon.cut(y);
    const double width = c.right - c.left, closing = width / y;  // what left slope − right slope must be
    const double below = c.left_below - c.right_below, above = c.left_above - c.right_above;
    double left = c.left_below, right = c.right_below;
    if (above == kInfinity) {  // on top: sides may lean in as far as they like
        left += std::max(0.0, closing - below);
    } else if (above > below) {
        const double part = std::clamp((closing - below) / (above - below), 0.0, 1.0);
        left += part * (c.left_above - c.left_below);
        right += part * (c.right_above - c.right_below);
    }
    // Both sides through the middle of them both, so that neither rounding nor a flat optimum opens the triangle.
    const double apex = 0.5 * (c.left + left * y + c.right + right * y);
    const glm::dvec2 tip(apex, 2.0 * y);
    return {2.0 * y * width, {glm::dvec2(2.0 * c.left - apex, 0.0), glm::dvec2(2.0 * c.right - apex, 0.0), tip}};
}

// The triangle whose angles at the base are A and B: with h the support values of its other sides and C = π − A − B,
// Σ sin(opposite angle)·h is the inradius times Σ sin, and the perimeter 2·inradius·Σ cot(angle/2). Their product is
//     (sin B · h_left + sin A · h_right) / (2 sin(A/2) sin(B/2) sin(C/2)).
struct Angle {
    double half_sine, sine, cosine;
    explicit Angle(double angle) {
        const glm::dvec2 h = cosine_sine(0.5 * angle);
        half_sine = h.y;
        sine = 2.0 * h.x * h.y;
        cosine = (h.x - h.y) * (h.x + h.y);
    }
};

// Narrows a range of angles to rounding.
constexpr int kSections = 72;

class LeastPerimeter {
  public:
    explicit LeastPerimeter(const Standing& polygon) : polygon_(polygon) {}

    // For fixed A the directions of a third side that make the perimeter at most 2t are those that separate the polygon
    // from a circle, an interval: the perimeter has one minimum in B. The minimum over B is searched for in A likewise,
    // from the best of a few places.
    Found run() {
        const Places& places = polygon_.is_thin() ? places_of_slivers() : even_places();
        std::size_t best = 1;
        double least = kInfinity;
        for (std::size_t i = 1; i + 1 < places.count; ++i)
            if (const double value = best_right(places.angles[i]); value < least) least = value, best = i;
        const double left = minimise(places.angles[best - 1], places.angles[best + 1], kSections,
                                     [&](double a) { return best_right(a); });
        const double value = best_right(left);
        return {value, triangle(left, right_)};
    }

  private:
    // Angles to begin from, between 0 and π.
    struct Places {
        std::array<double, 64> angles{};
        std::size_t count = 0;
        void add(double angle) { angles[count++] = angle; }
    };
    static const Places& even_places() {
        static const Places places = [] {
            Places result;
            for (int i = 0; i <= 12; ++i) result.add(pi * i / 12);
            return result;
        }();
        return places;
    }
    // The angles of slivers are near 0 and π as often as not: also π over powers of two.
    static const Places& places_of_slivers() {
        static const Places places = [] {
            constexpr int kLeast = 26;
            Places result;
            result.add(0.0);
            for (int k = kLeast; k >= 4; --k) result.add(std::ldexp(pi, -k));
            for (int i = 1; i < 12; ++i) result.add(pi * i / 12);
            for (int k = 4; k <= kLeast; ++k) result.add(pi - std::ldexp(pi, -k));
            result.add(pi);
            return result;
        }();
        return places;
    }

    double best_right(double left) {
        const Angle a(left);
        const double support = polygon_.left_support({-a.sine, a.cosine});
        const auto perimeter = [&](double right) {
            const Angle b(right);
            const Angle c(pi - left - right);
            const double h = b.sine * support + a.sine * polygon_.right_support({b.sine, b.cosine});
            const double divisor = 2.0 * a.half_sine * b.half_sine * c.half_sine;
            return divisor > 0.0 ? h / divisor : kInfinity;
        };
        right_ = minimise(0.0, pi - left, kSections, perimeter);
        return perimeter(right_);
    }

    [[nodiscard]] Triangle2 triangle(double left, double right) const {
        const Angle a(left), b(right), c(pi - left - right);
        // On the base the sides meet it at −h_left/sin A and h_right/sin B.
        const double begin = -polygon_.left_support({-a.sine, a.cosine}) / a.sine,
                     end = polygon_.right_support({b.sine, b.cosine}) / b.sine, side = (end - begin) * b.sine / c.sine;
        return {glm::dvec2(begin, 0.0), glm::dvec2(end, 0.0), glm::dvec2(begin + side * a.cosine, side * a.sine)};
    }

    const Standing& polygon_;
    double right_ = 0.0;
};

// Around points that are about as thin as their coordinates are rounded: twice as long and twice as thick.
Triangle2 around_flat(std::span<const glm::dvec2> hull) {
    const glm::dvec2 origin = hull[0];
    glm::dvec2 far(0.0);
    double rounding = 0.0;
    for (const glm::dvec2& p : hull) {
        if (glm::length(p - origin) > glm::length(far)) far = p - origin;
        rounding = std::max({rounding, 0x1p-52 * std::abs(p.x), 0x1p-52 * std::abs(p.y)});
    }
    const glm::dvec2 along = glm::normalize(far), across(-along.y, along.x);
    glm::dvec2 low(0.0), high(0.0);
    for (const glm::dvec2& p : hull) {
        const glm::dvec2 d(glm::dot(p - origin, along), glm::dot(p - origin, across));
        low = glm::min(low, d);
        high = glm::max(high, d);
    }
    const double length = high.x - low.x, middle = 0.5 * (low.y + high.y);
    for (double margin = 4.0 * rounding;; margin *= 2.0) {
        const double begin = low.x - margin, end = high.x + margin + length;
        const double half = (0.5 * (high.y - low.y) + margin) * (end - begin) / length;
        Triangle2 result{glm::dvec2(begin, middle - half), glm::dvec2(end, middle), glm::dvec2(begin, middle + half)};
        for (glm::dvec2& c : result) c = origin + c.x * along + c.y * across;
        if (holds(result, hull) || margin > length) return result;
    }
}

Result<Triangle2> best_triangle(std::span<const glm::dvec2> points, PlanarCriterion criterion) {
    if (auto valid = check_planar(points); !valid) return valid.error();
    const auto found_hull = measure::convex_hull(points);
    if (!found_hull) return found_hull.error();
    const Vector<glm::dvec2>& hull = *found_hull;
    if (hull.size() < 3) return Triangle2{hull[0], hull.back(), hull.back()};
    Standing polygon;
    Found best;
    std::size_t base = 0;
    bool is_thin = false;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        polygon.stand(hull, i);
        is_thin = is_thin || polygon.is_thin();
        if (!(polygon.height() > 0.0)) continue;
        const Found found = criterion == PlanarCriterion::area ? least_area(polygon) : LeastPerimeter(polygon).run();
        if (found.value < best.value) best = found, base = i;
    }
    const glm::dvec2 x = glm::normalize(hull[(base + 1) % hull.size()] - hull[base]), y(-x.y, x.x);
    const glm::dvec2 middle = (best.corners[0] + best.corners[1] + best.corners[2]) / 3.0;
    std::optional<Triangle2> found;
    for (double grown = 1.0, step = 0x1p-52; best.value < kInfinity && grown <= 2.0 && !found;
         grown = 1.0 + step, step *= 2.0) {
        Triangle2 result;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 c = middle + grown * (best.corners[k] - middle);
            result[k] = hull[base] + c.x * x + c.y * y;
        }
        if (holds(result, hull)) found = result;
    }
    if (criterion == PlanarCriterion::perimeter && is_thin) {
        const auto sliver = least_sliver(hull);
        if (sliver && !(found && perimeter_of(*found) <= perimeter_of(*sliver))) found = sliver;
    }
    return found ? *found : around_flat(hull);
}

}  // namespace

Result<std::array<glm::dvec2, 3>> minimal_triangle(std::span<const glm::dvec2> points, PlanarCriterion criterion) {
    return detail::recover([&] { return best_triangle(points, criterion); });
}

}  // namespace crofton::fit
