// A criterion in the normalised coordinates that the searches work in.
#pragma once
#include <crofton/measure/criterion.hpp>
#include <numbers>

namespace crofton::fit {

// value(a, b, c) = product · abc + pairs · (ab + bc + ca) + sum · (a + b + c): α, 2β and πγ.
struct Weights {
    double product = 0.0, pairs = 0.0, sum = 0.0;

    [[nodiscard]] double operator()(double a, double b, double c) const {
        return product * (a * b * c) + pairs * (a * b + b * c + c * a) + sum * (a + b + c);
    }
};

// For lengths measured in `unit`s: V scales with its cube, F with its square. Normalised so that the largest weight is
// 1: the minimiser does not change, and nothing over- or underflows later.
[[nodiscard]] inline Weights normalised_weights(const measure::Criterion& criterion, double unit) {
    // Divided by unit: α unit², 2β unit, πγ.
    Weights w{criterion.volume_weight * unit * unit, 2.0 * criterion.area_weight * unit,
              std::numbers::pi * criterion.mean_curvature_weight};
    double largest = w.product > w.pairs ? w.product : w.pairs;
    if (w.sum > largest) largest = w.sum;
    if (!(largest > 0.0))
        return {criterion.volume_weight > 0.0 ? 1.0 : 0.0, criterion.area_weight > 0.0 ? 1.0 : 0.0, w.sum};
    return {w.product / largest, w.pairs / largest, w.sum / largest};
}

}  // namespace crofton::fit
