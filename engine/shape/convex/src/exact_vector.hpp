// SPDX-License-Identifier: MIT
// Vectors of exact numbers.
#pragma once
#include <algorithm>
#include <crofton/geometry/dyadic.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton::convex {

struct ExactVector {
    Dyadic x, y, z;
};

[[nodiscard]] inline ExactVector exact_vector(const glm::dvec3& v) {
    return {Dyadic(v.x), Dyadic(v.y), Dyadic(v.z)};
}
[[nodiscard]] inline ExactVector operator-(const ExactVector& v) {
    return {-v.x, -v.y, -v.z};
}
[[nodiscard]] inline ExactVector operator+(const ExactVector& a, const ExactVector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] inline ExactVector operator-(const ExactVector& a, const ExactVector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] inline ExactVector operator*(const ExactVector& a, const Dyadic& s) {
    return {a.x * s, a.y * s, a.z * s};
}
[[nodiscard]] inline Dyadic dot(const ExactVector& a, const ExactVector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline ExactVector cross(const ExactVector& a, const ExactVector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline bool is_zero(const ExactVector& v) {
    return v.x.sign() == 0 && v.y.sign() == 0 && v.z.sign() == 0;
}
// rotation · p + translation
[[nodiscard]] inline ExactVector exact_image(const glm::dmat3& rotation, const glm::dvec3& p) {
    return (exact_vector(rotation[0]) * Dyadic(p.x) + exact_vector(rotation[1]) * Dyadic(p.y)) +
           exact_vector(rotation[2]) * Dyadic(p.z);
}
// The direction of v, not 0, with its largest component in [2^-33, 1): each is off by less than 2^-51 of itself.
[[nodiscard]] inline glm::dvec3 rounded_direction(const ExactVector& v) {
    int exponent = -1'000'000;
    for (const Dyadic* c : {&v.x, &v.y, &v.z})
        if (c->sign() != 0) exponent = std::max(exponent, c->exponent());
    return {v.x.scaled(exponent), v.y.scaled(exponent), v.z.scaled(exponent)};
}

}  // namespace crofton::convex
