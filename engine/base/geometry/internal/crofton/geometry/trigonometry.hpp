// SPDX-License-Identifier: MIT
// Sines and angles from + − × ÷ and square roots alone: the same bits on every machine. The C library's differ between
// libraries, and one library's between processors with and without fused multiply-add.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>

namespace crofton {

// Angles in radians. Within 6e-16 of the truth: of the circle's point for |angle| ≤ 1e5; relative to the result for the
// sine of |angle| < 3/4 π, the tangent of |angle| < π/2 − 1e-4, and all others here.
[[nodiscard]] glm::dvec2 cosine_sine(double angle);  // (cos, sin): the point of the unit circle
[[nodiscard]] inline double cosine(double angle) {
    return cosine_sine(angle).x;
}
[[nodiscard]] inline double sine(double angle) {
    return cosine_sine(angle).y;
}
[[nodiscard]] double tangent(double angle);

// The angle of (x, y) in [−π, π], signed zeros as std::atan2 has them; NaN for NaN and for two infinities.
[[nodiscard]] double arc_tangent(double y, double x);
[[nodiscard]] double arc_cosine(double x);  // in [0, π]; NaN outside [−1, 1]

[[nodiscard]] double cube_root(double x);  // of x ≥ 0, finite

namespace detail {
// cosine_sine(quarters · π/2 + rest) for |rest| ≤ π/4 (1 + 1e-9).
[[nodiscard]] glm::dvec2 cosine_sine_beyond(std::int64_t quarters, double rest);
// Taylor's series in x² for |x| ≤ π/4: cos x = 1 + x² Σ, sin x = x + x³ Σ. What is cut off is below 2e-18.
inline constexpr double kSineTerms[8] = {
    -1.0 / 6.0,        1.0 / 120.0,        -1.0 / 5040.0,          1.0 / 362880.0,
    -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
inline constexpr double kCosineTerms[8] = {
    -1.0 / 2.0,       1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,
    -1.0 / 3628800.0, 1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
}  // namespace detail

}  // namespace crofton
