// SPDX-License-Identifier: MIT
// Support functions in the plane, in closed form by pieces. They make the measures of docs/theory.md, section 4, exact.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::study {

// A function h of the angle φ in [0, 2π], with pieces dot(point, (cos φ, sin φ)) + radius. The support functions of
// figures bounded by arcs and segments have this form, and their minima and maxima. The largest coordinate or radius
// must lie in [1e-100, 1e100] or be 0, because differences of pieces are squared.
class PlanarSupport {
  public:
    struct Piece {
        double begin;  // ascending, the first is 0; a piece ends where the next begins, the last at 2π
        glm::dvec2 point;
        double radius;
    };

    explicit PlanarSupport(const Disc& disc);
    explicit PlanarSupport(const Rectangle& rectangle);
    // Makes the support function of the convex hull of the points. Errors: as convex_hull.
    [[nodiscard]] static Result<PlanarSupport> of_hull(std::span<const glm::dvec2> points);
    // Makes it of `corners` as convex_hull returns them; at least one.
    [[nodiscard]] static PlanarSupport of_convex_polygon(std::span<const glm::dvec2> corners);

    [[nodiscard]] std::span<const Piece> pieces() const { return pieces_; }
    [[nodiscard]] double operator()(double phi) const;
    // Returns the extent along direction φ: h(φ) + h(φ + π).
    [[nodiscard]] double breadth(double phi) const;
    // Returns ∫ h over the circle: a convex figure's perimeter (Cauchy).
    [[nodiscard]] double integral() const;

    friend PlanarSupport min(const PlanarSupport& a, const PlanarSupport& b);
    friend PlanarSupport max(const PlanarSupport& a, const PlanarSupport& b);

  private:
    PlanarSupport() = default;
    static PlanarSupport envelope(const PlanarSupport& a, const PlanarSupport& b, double sign);
    void append(double begin, const Piece& piece);

    Vector<Piece> pieces_;
};

// Return the support function of the hull of both figures (max), and the smaller of both (min; in general not that of a
// figure). Exact up to rounding: crossings of two pieces are solved for.
[[nodiscard]] PlanarSupport min(const PlanarSupport& a, const PlanarSupport& b);
[[nodiscard]] PlanarSupport max(const PlanarSupport& a, const PlanarSupport& b);

// Returns the minimum over all, by recursive halving: O(n log n) for n discs, whose support functions cross at most
// twice each. At least one.
[[nodiscard]] PlanarSupport lower_envelope(std::span<const PlanarSupport> figures);

// Returns ∫ min(a, b) over the circle, without forming the minimum.
[[nodiscard]] double integral_of_min(const PlanarSupport& a, const PlanarSupport& b);
[[nodiscard]] double integral_of_min(const PlanarSupport& a, const Disc& b);

}  // namespace crofton::study
