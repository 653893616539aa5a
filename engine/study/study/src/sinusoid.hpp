// SPDX-License-Identifier: MIT
// x·cos φ + y·sin φ + r: values, integrals and zeros, and walks over functions made of such pieces.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/study/planar_support.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

namespace crofton::study {

struct Sinusoid {
    double x, y, r;

    Sinusoid(double x_, double y_, double r_) : x(x_), y(y_), r(r_) {}
    explicit Sinusoid(const PlanarSupport::Piece& piece) : x(piece.point.x), y(piece.point.y), r(piece.radius) {}

    [[nodiscard]] double operator()(double phi) const { return glm::dot(glm::dvec2(x, y), cosine_sine(phi)) + r; }

    // From a to b; written with half the difference, so that short intervals lose nothing to cancellation.
    [[nodiscard]] double integral(double a, double b) const {
        const double middle = 0.5 * (a + b);
        return 2.0 * sine(0.5 * (b - a)) * glm::dot(glm::dvec2(x, y), cosine_sine(middle)) + r * (b - a);
    }

    [[nodiscard]] friend Sinusoid operator-(const Sinusoid& a, const Sinusoid& b) {
        return {a.x - b.x, a.y - b.y, a.r - b.r};
    }
};

// Calls visit(from, to, value) for the parts of [begin, end], 0 ≤ begin ≤ end ≤ 2π, between the zeros of f; `value` has
// the sign of f on that part. It is f in the part's middle, or, where that is 0 up to rounding, f's integral. f may
// touch 0 just there, as a disc's support does that of a point on its circle. Parts that rounding misplaces are those
// where f is 0 up to rounding everywhere: an integral of max(0, f) does not see them.
template <class Visit>
void for_signs(const Sinusoid& f, double begin, double end, Visit visit) {
    std::array<double, 8> cuts;
    std::size_t count = 0;
    cuts[count++] = begin;
    const double amplitude = std::sqrt(f.x * f.x + f.y * f.y);
    if (amplitude > std::abs(f.r)) {
        const double phase = arc_tangent(f.y, f.x), offset = arc_cosine(-f.r / amplitude);
        for (const double root : {phase - offset, phase + offset}) {
            const double turns = std::floor(root / (2.0 * std::numbers::pi));
            const double angle = root - turns * 2.0 * std::numbers::pi;
            if (angle > begin && angle < end) cuts[count++] = angle;
        }
        if (count == 3 && cuts[1] > cuts[2]) std::swap(cuts[1], cuts[2]);
    }
    cuts[count++] = end;
    for (std::size_t i = 0; i + 1 < count; ++i)
        if (cuts[i] < cuts[i + 1]) {
            const double middle = f(0.5 * (cuts[i] + cuts[i + 1]));
            const bool clear = std::abs(middle) > 1e-12 * (amplitude + std::abs(f.r));
            visit(cuts[i], cuts[i + 1], clear ? middle : f.integral(cuts[i], cuts[i + 1]));
        }
}

// Calls visit(p, q, begin, end) for the intervals on which both functions are one piece each: p of a, q of b.
template <class Visit>
void for_common_pieces(std::span<const PlanarSupport::Piece> a, std::span<const PlanarSupport::Piece> b, Visit visit) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    std::size_t i = 0, j = 0;
    for (double begin = 0.0; i < a.size() && j < b.size();) {
        const double a_end = i + 1 < a.size() ? a[i + 1].begin : full_turn;
        const double b_end = j + 1 < b.size() ? b[j + 1].begin : full_turn;
        const double end = std::min(a_end, b_end);
        if (begin < end) visit(a[i], b[j], begin, end);
        begin = std::max(begin, end);
        i += a_end <= end;
        j += b_end <= end;
    }
}

}  // namespace crofton::study
