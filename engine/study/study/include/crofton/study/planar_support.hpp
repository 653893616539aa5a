// SPDX-License-Identifier: MIT
// Support functions in the plane, piece by piece in closed form: the measures of theory.md section 4 are exact by them.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::study {

// A function h of the angle φ in [0, 2π] made of pieces dot(point, (cos φ, sin φ)) + radius. Such are the support
// functions of figures bounded by arcs and segments, and their minima and maxima. The largest coordinate or radius must
// lie in [1e-100, 1e100] or be 0, since differences of pieces are squared.
class PlanarSupport {
  public:
    struct Piece {
        double begin;  // ascending, the first is 0; a piece ends where the next begins, the last at 2π
        glm::dvec2 point;
        double radius;
    };

    explicit PlanarSupport(const Disc& disc);
    explicit PlanarSupport(const Rectangle& rectangle);
    // The convex hull of the points. Errors: as convex_hull.
    [[nodiscard]] static Result<PlanarSupport> of_hull(std::span<const glm::dvec2> points);
    // `corners` as convex_hull returns them; at least one.
    [[nodiscard]] static PlanarSupport of_convex_polygon(std::span<const glm::dvec2> corners);

    [[nodiscard]] std::span<const Piece> pieces() const { return pieces_; }
    [[nodiscard]] double operator()(double phi) const;
    // The extent across direction φ: h(φ) + h(φ + π).
    [[nodiscard]] double breadth(double phi) const;
    // ∫ h over the circle: a convex figure's perimeter (Cauchy).
    [[nodiscard]] double integral() const;

    friend PlanarSupport min(const PlanarSupport& a, const PlanarSupport& b);
    friend PlanarSupport max(const PlanarSupport& a, const PlanarSupport& b);

  private:
    PlanarSupport() = default;
    static PlanarSupport envelope(const PlanarSupport& a, const PlanarSupport& b, double sign);
    void append(double begin, const Piece& piece);

    Vector<Piece> pieces_;
};

// The support function of the hull of both figures (max), and the smaller of both (min; in general no figure's). Exact
// up to rounding: crossings of two pieces are solved for.
[[nodiscard]] PlanarSupport min(const PlanarSupport& a, const PlanarSupport& b);
[[nodiscard]] PlanarSupport max(const PlanarSupport& a, const PlanarSupport& b);

// min over all, by halves: O(n log n) for n discs, whose support functions cross at most twice each. At least one.
[[nodiscard]] PlanarSupport lower_envelope(std::span<const PlanarSupport> figures);

// ∫ min(a, b) over the circle, without forming the minimum.
[[nodiscard]] double integral_of_min(const PlanarSupport& a, const PlanarSupport& b);
[[nodiscard]] double integral_of_min(const PlanarSupport& a, const Disc& b);

}  // namespace crofton::study
