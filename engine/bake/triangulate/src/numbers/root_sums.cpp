// SPDX-License-Identifier: MIT
#include "numbers/root_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "numbers/double_double.hpp"

namespace crofton::triangulate {
namespace {

auto exact_square(std::span<const glm::dvec2> points, const Segment& s) {
    const auto x = exact_difference(points[s.from].x, points[s.to].x);
    const auto y = exact_difference(points[s.from].y, points[s.to].y);
    return x * x + y * y;
}

// √S to about 200 bits: with Q the sum of the parts so far, √S − Q = (S − Q²) / (√S + Q), of which double gives each
// time 50 bits more. What is left after the fourth part is less than 2^-202 of the first.
std::array<double, 4> root_parts(const Expansion<16>& square) {
    const double first = std::sqrt(square.estimate()), twice = 2.0 * first;
    const auto rest1 = square - exact_product(first, first);
    const double second = rest1.estimate() / twice;
    const auto rest2 = rest1 - exact_product(twice, second) - exact_product(second, second);
    const double third = rest2.estimate() / twice;
    const auto rest3 =
        rest2 - exact_product(twice, third) - exact_product(2.0 * second, third) - exact_product(third, third);
    return {first, second, third, rest3.estimate() / twice};
}

// Adds to an exact sum of doubles, smallest first (Shewchuk's grow-expansion).
void add_exactly(Vector<double>& sum, double x) {
    std::size_t kept = 0;
    for (const double term : sum) {
        const auto [high, low] = detail::two_sum(x, term);
        if (low != 0.0) sum[kept++] = low;
        x = high;
    }
    sum.resize(kept);
    if (x != 0.0) sum.push_back(x);
}

}  // namespace

int RootSums::compare(std::span<const glm::dvec2> points, std::span<const Segment> a, std::span<const Segment> b) {
    terms_.clear();
    append(points, a, 1);
    append(points, b, -1);
    cancel(points);
    if (terms_.empty()) return 0;
    if (const int sign = sum_to_100_bits(); sign != 0) return sign;
    if (const int sign = sum_to_200_bits(points); sign != 0) return sign;
    widen(points);
    if (classes_cancel()) return 0;
    for (std::size_t bits = 128;; bits *= 2) {
        if (const int sign = sum_to(bits); sign != 0) return sign;
    }
}

void RootSums::append(std::span<const glm::dvec2> points, std::span<const Segment> segments, int sign) {
    for (const Segment& s : segments) {
        const SquaredLength square = squared_length(points[s.from], points[s.to]);
        terms_.push_back({s, square.high, square.rest, sign, square.exact});
    }
}

// Sums the coefficients of equal lengths and drops those that vanish.
void RootSums::cancel(std::span<const glm::dvec2> points) {
    const auto less = [](const Term& a, const Term& b) { return a.square < b.square; };
    std::sort(terms_.begin(), terms_.end(), less);
    const auto equal = [&](const Term& a, const Term& b) {
        if (a.exact && b.exact) return a.square == b.square && a.rest == b.rest;
        if (a.segment.from == b.segment.from && a.segment.to == b.segment.to) return true;
        // Each square errs by less than 2^-104 of it.
        const double difference = (a.square - b.square) + (a.rest - b.rest);
        if (std::fabs(difference) > b.square * 0x1p-98) return false;
        return (exact_square(points, a.segment) - exact_square(points, b.segment)).sign() == 0;
    };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < terms_.size(); ++i) {
        const Term term = terms_[i];
        bool merged = false;
        for (std::size_t j = kept; j-- > 0 && !merged && terms_[j].square >= term.square * (1.0 - 0x1p-49);) {
            if (equal(terms_[j], term)) {
                terms_[j].coefficient += term.coefficient;
                merged = true;
            }
        }
        if (!merged) terms_[kept++] = term;
    }
    terms_.resize(kept);
    terms_.erase(std::remove_if(terms_.begin(), terms_.end(), [](const Term& t) { return t.coefficient == 0; }),
                 terms_.end());
}

// Each root errs by less than 2^-101 of it, each addition by at most 2^-104 of the running sum.
int RootSums::sum_to_100_bits() const {
    DoubleDouble sum;
    double magnitude = 0.0;
    for (const Term& t : terms_) {
        const DoubleDouble length = root({t.square, t.rest, t.exact});
        const double c = t.coefficient;
        const auto high = detail::two_product(length.high, c);
        sum.add(high.high, high.low + length.low * c);
        magnitude += length.high * std::fabs(c);
    }
    const double bound = magnitude * (static_cast<double>(terms_.size()) + 8.0) * 0x1p-101;
    return std::fabs(sum.high) > bound ? (sum.high > 0.0 ? 1 : -1) : 0;
}

// The parts of a root miss it by less than 2^-200; they are summed without rounding.
int RootSums::sum_to_200_bits(std::span<const glm::dvec2> points) {
    exact_sum_.clear();
    double magnitude = 0.0;
    for (const Term& t : terms_) {
        const auto parts = root_parts(exact_square(points, t.segment));
        const double c = t.coefficient;
        for (const double part : parts) {
            const auto product = detail::two_product(part, c);
            add_exactly(exact_sum_, product.low);
            add_exactly(exact_sum_, product.high);
        }
        magnitude += parts[0] * std::fabs(c);
    }
    if (exact_sum_.empty() || std::fabs(exact_sum_.back()) <= magnitude * 0x1p-198) return 0;
    return exact_sum_.back() > 0.0 ? 1 : -1;
}

// The squared lengths as integers: every coordinate is an integer multiple of the smallest unit in the last place.
void RootSums::widen(std::span<const glm::dvec2> points) {
    int unit = std::numeric_limits<int>::max();
    const auto split = [](double x, int& exponent) {
        const double mantissa = std::frexp(x, &exponent);
        exponent -= 53;
        return static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    };
    const auto difference_unit = [&](double a, double b) {
        for (const double x : {a, b}) {
            int exponent = 0;
            if (split(x, exponent) != 0) unit = std::min(unit, exponent);
        }
    };
    for (const Term& t : terms_) {
        difference_unit(points[t.segment.from].x, points[t.segment.to].x);
        difference_unit(points[t.segment.from].y, points[t.segment.to].y);
    }
    const auto magnitude = [&](double x) {
        int exponent = 0;
        const auto mantissa = static_cast<std::uint64_t>(std::abs(split(x, exponent)));
        return mantissa == 0 ? WideInteger() : WideInteger(mantissa) << static_cast<std::size_t>(exponent - unit);
    };
    const auto squared_difference = [&](double a, double b) {
        WideInteger wide_a = magnitude(a);
        const WideInteger wide_b = magnitude(b);
        if ((a < 0.0) != (b < 0.0)) return (wide_a += wide_b) * wide_a;
        if (wide_a.compare(wide_b) < 0) {
            WideInteger d = wide_b;
            d -= wide_a;
            return d * d;
        }
        wide_a -= wide_b;
        return wide_a * wide_a;
    };
    squares_.clear();
    for (const Term& t : terms_) {
        WideInteger square = squared_difference(points[t.segment.from].x, points[t.segment.to].x);
        square += squared_difference(points[t.segment.from].y, points[t.segment.to].y);
        squares_.push_back(std::move(square));
    }
}

// With r the class's first member, √N = √(N·r) / r · √r where √(N·r) is an integer: so the integers' sum must vanish.
bool RootSums::classes_cancel() const {
    Vector<std::uint8_t> done(terms_.size(), 0);
    for (std::size_t i = 0; i < terms_.size(); ++i) {
        if (done[i]) continue;
        WideInteger positive, negative;
        for (std::size_t j = i; j < terms_.size(); ++j) {
            if (done[j]) continue;
            bool square = false;
            const WideInteger root = WideInteger::square_root(squares_[i] * squares_[j], square);
            if (!square) continue;
            done[j] = 1;
            const int c = terms_[j].coefficient;
            (c > 0 ? positive : negative) += root * WideInteger(static_cast<std::uint64_t>(std::abs(c)));
        }
        if (positive.compare(negative) != 0) return false;
    }
    return true;
}

// Each root is cut off after so many bits behind the point, which errs by less than 1 in its last place.
int RootSums::sum_to(std::size_t bits) const {
    WideInteger positive, negative;
    std::uint64_t positive_error = 0, negative_error = 0;
    for (std::size_t i = 0; i < terms_.size(); ++i) {
        bool exact = false;
        const WideInteger root = WideInteger::square_root(squares_[i] << (2 * bits), exact);
        const auto c = static_cast<std::uint64_t>(std::abs(terms_[i].coefficient));
        const bool plus = terms_[i].coefficient > 0;
        (plus ? positive : negative) += root * WideInteger(c);
        if (!exact) (plus ? positive_error : negative_error) += c;
    }
    // The true sums lie in [positive, positive + positive_error] and so on.
    WideInteger negative_top = negative, positive_top = positive;
    negative_top += WideInteger(negative_error);
    positive_top += WideInteger(positive_error);
    if (positive.compare(negative_top) > 0) return 1;
    if (negative.compare(positive_top) > 0) return -1;
    return 0;
}

}  // namespace crofton::triangulate
