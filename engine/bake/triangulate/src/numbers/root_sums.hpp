// SPDX-License-Identifier: MIT
// Exact comparison of sums of Euclidean lengths.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

#include "numbers/wide_integer.hpp"

namespace crofton::triangulate {

struct Segment {
    std::uint32_t from, to;  // indices of points
};

// The sign of Σ|a| − Σ|b|, proven. Common segments and equal lengths cancel. What remains is summed to about 100 bits,
// then to 200. If that does not decide, the squared lengths are sorted into classes, N ~ M when N·M is a square. Roots
// of different classes are linearly independent over the rationals. So the difference is 0 if and only if every class's
// coefficient is. Otherwise the sum is evaluated with ever more bits until its sign shows, which it must.
class RootSums {
  public:
    [[nodiscard]] int compare(std::span<const glm::dvec2> points, std::span<const Segment> a,
                              std::span<const Segment> b);

  private:
    struct Term {
        Segment segment;
        double square, rest;  // the squared length is square + rest within 2^-104 of it, exactly if `exact`
        int coefficient;
        bool exact;
    };
    void append(std::span<const glm::dvec2> points, std::span<const Segment> segments, int sign);
    void cancel(std::span<const glm::dvec2> points);
    [[nodiscard]] int sum_to_100_bits() const;
    [[nodiscard]] int sum_to_200_bits(std::span<const glm::dvec2> points);
    void widen(std::span<const glm::dvec2> points);
    [[nodiscard]] bool classes_cancel() const;
    [[nodiscard]] int sum_to(std::size_t bits) const;

    Vector<Term> terms_;
    Vector<double> exact_sum_;
    Vector<WideInteger> squares_;  // of the terms, in a common unit
};

}  // namespace crofton::triangulate
