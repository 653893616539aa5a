// SPDX-License-Identifier: MIT
#include "list/records.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "exact/box_constraints.hpp"

namespace crofton::cull {
namespace {

constexpr float kLeastUnit = 1e-30f;   // keeps units normal numbers
constexpr float kUndecidable = 1e37f;  // an error bound above all values of planes in a valid chunk

float float_at_least(double value) {
    const float rounded = static_cast<float>(value);
    return double{rounded} < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

// The upper half of the bits of the least float with zeros in the lower half that is not below `value`.
std::uint16_t upper_half_at_least(float value) {
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0xffffu) >> 16);
}

void set_center(float (&center)[3], const glm::dvec3& offset) {
    for (int j = 0; j < 3; ++j) center[j] = static_cast<float>(offset[j]);
}

}  // namespace

Sphere sphere_around(const Obb& box) {
    glm::dvec3 edge[3];
    for (int k = 0; k < 3; ++k) edge[k] = half_edge(box, k);
    const auto dot = [](const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
    // No corner is farther than |Σ ±edge|² ≤ Σ |edge_k|² + 2 Σ |edge_i · edge_k|.
    double square = 0.0;
    for (int k = 0; k < 3; ++k) square += dot(edge[k], edge[k]) + 2.0 * std::fabs(dot(edge[k], edge[(k + 1) % 3]));
    return {box.center, std::sqrt(square) * (1.0 + 0x1p-48) + 1e-150};
}

Sphere sphere_around(const Aabb& box) {
    const glm::dvec3 half = 0.5 * box.max - 0.5 * box.min, size = glm::abs(box.min) + glm::abs(box.max);
    const double radius = std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z);
    return {0.5 * box.min + 0.5 * box.max, radius * (1.0 + 0x1p-48) + (size.x + size.y + size.z) * 0x1p-52 + 1e-150};
}

Sphere sphere_around(const Sphere& sphere) {
    return sphere;
}

BoxRecord record_of(const Obb& box, const glm::dvec3& offset) {
    BoxRecord record;
    set_center(record.center, offset);
    const float radius = std::max(kLeastUnit, float_at_least(sphere_around(box).radius));
    record.radius = upper_half_at_least(radius);
    const float stored = std::bit_cast<float>(std::uint32_t{record.radius} << 16);
    const double per_unit = 0x1p15 / double{stored};
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = half_edge(box, k);
        for (int j = 0; j < 3; ++j)
            record.edge[3 * k + j] =
                static_cast<std::int16_t>(std::clamp(std::nearbyint(edge[j] * per_unit), -32767.0, 32767.0));
    }
    return record;
}

AabbRecord record_of(const Aabb& box, const glm::dvec3& offset) {
    AabbRecord record;
    set_center(record.center, offset);
    const glm::dvec3 half = 0.5 * box.max - 0.5 * box.min, size = glm::abs(box.min) + glm::abs(box.max);
    record.unit = std::max(kLeastUnit, float_at_least(std::max({half.x, half.y, half.z})));
    double error = 0.0;
    for (int j = 0; j < 3; ++j) {
        record.half[j] = static_cast<float>(half[j] / double{record.unit});
        // The share of the unit rounds by 2^-24 of at most 1, and so does each product and sum of the test, at most 6
        // in all. Centre and half extent in double round by 2^-53 of the corners each.
        error += double{record.unit} * 0x1p-21 + size[j] * 0x1p-51;
    }
    record.error = float_at_least(error * 1.01);
    return record;
}

SphereRecord record_of(const Sphere& sphere, const glm::dvec3& offset) {
    SphereRecord record;
    set_center(record.center, offset);
    record.radius = static_cast<float>(sphere.radius);
    return record;
}

template <>
BoxRecord undecidable_record() {
    BoxRecord record{};
    record.radius = upper_half_at_least(kUndecidable);
    return record;
}

template <>
AabbRecord undecidable_record() {
    AabbRecord record{};
    record.unit = kLeastUnit;
    record.error = kUndecidable;
    return record;
}

template <>
SphereRecord undecidable_record() {
    SphereRecord record{};
    record.radius = kUndecidable;
    return record;
}

}  // namespace crofton::cull
