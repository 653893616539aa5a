// SPDX-License-Identifier: MIT
// A criterion's weights for boxes in normalised coordinates.
#pragma once
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
    const Weights w{criterion.volume_weight * unit * unit, 2.0 * criterion.area_weight * unit,
                    std::numbers::pi * criterion.mean_curvature_weight};
    double largest = w.product > w.pairs ? w.product : w.pairs;
    if (w.sum > largest) largest = w.sum;
    if (largest > 0.0) return {{w.product / largest, w.pairs / largest, w.sum / largest}, largest * unit};
    // Every weight underflowed: search by the first measure that the criterion asks for.
    return {{criterion.volume_weight > 0.0 ? 1.0 : 0.0, criterion.area_weight > 0.0 ? 1.0 : 0.0, 0.0}, 0.0};
}

}  // namespace crofton::fit
