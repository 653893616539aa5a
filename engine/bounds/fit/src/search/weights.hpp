// SPDX-License-Identifier: MIT
// A criterion's weights for boxes in normalised coordinates.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <numbers>

namespace crofton::fit {

// value(a, b, c) = product · abc + pairs · (ab + bc + ca) + sum · (a + b + c): α, 2β and πγ.
struct Weights {
    double product = 0.0, pairs = 0.0, sum = 0.0;

    [[nodiscard]] double operator()(double a, double b, double c) const {
        return product * (a * b * c) + pairs * (a * b + b * c + c * a) + sum * (a + b + c);
    }
    // The derivative by one edge, at the other two.
    [[nodiscard]] double slope(double b, double c) const { return product * b * c + pairs * (b + c) + sum; }
};

struct NormalisedWeights {
    Weights weights;
    double scale;  // criterion of a box = scale · value of its edges in units
};

// The weights for lengths in units of `unit`: V scales with its cube, F with its square. They are divided by the
// largest, which changes no minimiser and keeps later products from overflow.
[[nodiscard]] inline NormalisedWeights normalised_weights(const measure::Criterion& criterion, double unit) {
    // Times a power of two first, which rounds nothing: weights of 1e300 are weights, too.
    int exponent = 0;
    std::frexp(std::max({criterion.volume_weight, criterion.area_weight, criterion.mean_curvature_weight}), &exponent);
    const Weights w{std::ldexp(criterion.volume_weight, -exponent) * unit * unit,
                    2.0 * std::ldexp(criterion.area_weight, -exponent) * unit,
                    std::numbers::pi * std::ldexp(criterion.mean_curvature_weight, -exponent)};
    double largest = w.product > w.pairs ? w.product : w.pairs;
    if (w.sum > largest) largest = w.sum;
    if (largest > 0.0)
        return {{w.product / largest, w.pairs / largest, w.sum / largest}, std::ldexp(largest * unit, exponent)};
    // Every weight underflowed: search by the first measure that the criterion asks for.
    return {{criterion.volume_weight > 0.0 ? 1.0 : 0.0, criterion.area_weight > 0.0 ? 1.0 : 0.0, 0.0}, 0.0};
}

}  // namespace crofton::fit
