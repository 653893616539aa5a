// SPDX-License-Identifier: MIT
#include "oriented_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::depth {
namespace {

using Axes = std::array<glm::dvec3, 3>;

struct Extents {
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] double area() const {
        const glm::dvec3 size = max - min;
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

Extents along(const Axes& axes, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    Extents result;
    for (const std::uint32_t i : indices) {
        const glm::dvec3 p(positions[i]);
        const glm::dvec3 t(glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2]));
        result.min = (glm::min)(result.min, t);
        result.max = (glm::max)(result.max, t);
    }
    return result;
}

constexpr Axes kAligned = {glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.0, 0.0, 1.0)};

// Along the mean normal and the longest edge across it; false where there is none.
bool find_axes(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, Axes& axes) {
    glm::dvec3 normal(0.0), longest(0.0);
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const std::array<glm::dvec3, 3> p = {glm::dvec3(positions[indices[t]]), glm::dvec3(positions[indices[t + 1]]),
                                             glm::dvec3(positions[indices[t + 2]])};
        normal += glm::cross(p[1] - p[0], p[2] - p[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 edge = p[(k + 1) % 3] - p[k];
            if (glm::dot(edge, edge) > glm::dot(longest, longest)) longest = edge;
        }
    }
    const double height = glm::length(normal);
    if (!(height > 0.0) || !std::isfinite(height)) return false;
    axes[0] = normal / height;
    const glm::dvec3 across = longest - glm::dot(longest, axes[0]) * axes[0];
    const double length = glm::length(across);
    if (!(length > 1e-6 * glm::length(longest))) return false;
    axes[1] = across / length;
    axes[2] = glm::cross(axes[0], axes[1]);
    return true;
}

using Integers = std::array<std::array<std::int32_t, 3>, 3>;

// The largest of a box's half edges has a coordinate of 2^13 to 2^14 units, so that edges may still grow.
constexpr int kBits = 14, kLeastExponent = -126;
constexpr std::int32_t kLargest = 32'767;

int exponent_for(double largest) {
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    return std::max(exponent - kBits, kLeastExponent);
}

double away_from_zero(double x) {
    return x < 0.0 ? std::floor(x) : std::ceil(x);
}

// Bounds how many half edges a point is away from the middle, along each. Cross products of integers below 2^15 are
// exact. A distance is rounded by 2^-53 of itself, the three products and their sum by less than 4 · 2^-53 of the
// terms.
class Shares {
  public:
    Shares(const Integers& edges, int exponent) : unit_(std::ldexp(1.0, -exponent)) {
        std::array<glm::dvec3, 3> doubles;
        for (std::size_t k = 0; k < 3; ++k) doubles[k] = {edges[k][0], edges[k][1], edges[k][2]};
        for (std::size_t k = 0; k < 3; ++k) normals_[k] = glm::cross(doubles[(k + 1) % 3], doubles[(k + 2) % 3]);
        volume_ = std::abs(glm::dot(doubles[0], normals_[0]));
    }
    [[nodiscard]] bool is_flat() const { return volume_ == 0.0; }
    [[nodiscard]] glm::dvec3 of(const glm::dvec3& from_center) const {
        const glm::dvec3 d = unit_ * from_center;
        glm::dvec3 share;
        for (std::size_t k = 0; k < 3; ++k) {
            const double sum = std::abs(glm::dot(d, normals_[k]));
            const double terms = glm::dot(glm::abs(d), glm::abs(normals_[k]));
            share[static_cast<glm::length_t>(k)] = (sum + 0x1p-50 * terms) / volume_ * (1.0 + 0x1p-50);
        }
        return share;
    }

  private:
    std::array<glm::dvec3, 3> normals_;
    double volume_ = 0.0, unit_;
};

// The box, aligned or not, by what it is made of.
class BoxPacker {
  public:
    BoxPacker(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, const glm::dvec3& center)
        : positions_(positions), indices_(indices), center_(center) {}

    // |p − center| along each axis, rounded up.
    void set_aligned() {
        glm::dvec3 most(0.0);
        // A difference is rounded once, by 2^-53.
        for (const std::uint32_t i : indices_) most = (glm::max)(most, glm::abs(from_center(i)) * (1.0 + 0x1p-50));
        exponent_ = exponent_for(std::max({most.x, most.y, most.z}));
        edges_ = {};
        for (std::size_t k = 0; k < 3; ++k) {
            const double units = std::ldexp(most[static_cast<glm::length_t>(k)], -exponent_);
            edges_[k][k] = static_cast<std::int32_t>(std::ceil(units));
        }
    }

    // Along the axes; false if rounding leaves something outside.
    bool set_turned(const Axes& axes, const glm::dvec3& half) {
        double largest = 0.0;
        for (std::size_t k = 0; k < 3; ++k)
            for (glm::length_t i = 0; i < 3; ++i)
                largest = std::max(largest, std::abs(half[static_cast<glm::length_t>(k)] * axes[k][i]));
        exponent_ = exponent_for(largest);
        for (std::size_t k = 0; k < 3; ++k) {
            const double units = std::ldexp(half[static_cast<glm::length_t>(k)], -exponent_);
            // Half a unit at least, rounded away from zero: no edge is nothing.
            for (std::size_t i = 0; i < 3; ++i)
                edges_[k][i] = static_cast<std::int32_t>(
                    std::round(std::max(units, 1.0) * axes[k][static_cast<glm::length_t>(i)]));
        }
        constexpr int kAttempts = 4;
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
            glm::dvec3 share;
            if (!find_shares(share)) return false;
            if (share.x <= 1.0 && share.y <= 1.0 && share.z <= 1.0) return true;
            for (std::size_t k = 0; k < 3; ++k) {
                const double growth = std::max(share[static_cast<glm::length_t>(k)], 1.0);
                for (std::int32_t& edge : edges_[k]) {
                    const double grown = growth > 1.0 ? away_from_zero(growth * edge) : edge;
                    if (!(std::abs(grown) <= kLargest)) return false;
                    edge = static_cast<std::int32_t>(grown);
                }
            }
        }
        return false;
    }

    [[nodiscard]] ClusteredMesh::PackedBox packed() const {
        ClusteredMesh::PackedBox box{};
        const auto low_half = [](std::int32_t x) { return static_cast<std::uint32_t>(x) & 0xffff; };
        for (std::size_t i = 0; i < 3; ++i) box.center[i] = static_cast<float>(center_[static_cast<glm::length_t>(i)]);
        for (std::size_t i = 0; i < 9; ++i) box.words[i / 2] |= low_half(edges_[i / 3][i % 3]) << 16 * (i % 2);
        box.words[4] |= static_cast<std::uint32_t>(exponent_ + 127) << 16;
        return box;
    }

  private:
    [[nodiscard]] glm::dvec3 from_center(std::uint32_t index) const { return glm::dvec3(positions_[index]) - center_; }

    // As Shares, of all points; false if edges lie in a plane.
    bool find_shares(glm::dvec3& share) const {
        const Shares shares(edges_, exponent_);
        if (shares.is_flat()) return false;
        share = glm::dvec3(0.0);
        for (const std::uint32_t i : indices_) share = (glm::max)(share, shares.of(from_center(i)));
        return true;
    }

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    glm::dvec3 center_;  // of floats
    Integers edges_{};
    int exponent_ = 0;
};

glm::dvec3 rounded_center(const Axes& axes, const Extents& extents) {
    const glm::dvec3 middle = 0.5 * (extents.min + extents.max);
    return glm::dvec3(glm::vec3(middle.x * axes[0] + middle.y * axes[1] + middle.z * axes[2]));
}

// Whether |p − center| ≤ half, exactly.
bool is_within(double p, double center, double half) {
    const auto [high, low] = detail::two_sum(p, -center);
    const double size = std::abs(high);
    if (size != half) return size < half;
    return high < 0.0 ? low >= 0.0 : low <= 0.0;
}

bool is_within(const glm::vec3& p, const glm::dvec3& center, const glm::dvec3& half) {
    return is_within(p.x, center.x, half.x) && is_within(p.y, center.y, half.y) && is_within(p.z, center.z, half.z);
}

}  // namespace

ClusteredMesh::PackedBox bound_of(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    const Extents extents = along(kAligned, positions, indices);
    if (Axes turned; find_axes(positions, indices, turned))
        if (const Extents other = along(turned, positions, indices); other.area() < 0.9 * extents.area()) {
            BoxPacker box(positions, indices, rounded_center(turned, other));
            if (box.set_turned(turned, 0.5 * (other.max - other.min))) return box.packed();
        }
    BoxPacker box(positions, indices, rounded_center(kAligned, extents));
    box.set_aligned();
    return box.packed();
}

bool contains(const ClusteredMesh::PackedBox& box, std::span<const glm::vec3> vertices) {
    Integers edges;
    for (std::size_t i = 0; i < 9; ++i)
        edges[i / 3][i % 3] = static_cast<std::int16_t>(box.words[i / 2] >> 16 * (i % 2) & 0xffff);
    const glm::dvec3 center(box.center[0], box.center[1], box.center[2]);
    const std::uint32_t exponent = box.words[4] >> 16 & 0xff;
    bool aligned = true;
    for (std::size_t i = 0; i < 9; ++i) aligned = aligned && (i % 4 == 0 || edges[i / 3][i % 3] == 0);
    if (aligned) {
        const double unit = exponent == 0 ? 0.0 : std::ldexp(1.0, static_cast<int>(exponent) - 127);
        const glm::dvec3 half = unit * glm::abs(glm::dvec3(edges[0][0], edges[1][1], edges[2][2]));
        return std::all_of(vertices.begin(), vertices.end(),
                           [&](const glm::vec3& p) { return is_within(p, center, half); });
    }
    const Shares shares(edges, static_cast<int>(exponent) - 127);
    if (exponent == 0 || shares.is_flat()) return false;
    return std::all_of(vertices.begin(), vertices.end(), [&](const glm::vec3& p) {
        const glm::dvec3 share = shares.of(glm::dvec3(p) - center);
        return share.x <= 1.0 && share.y <= 1.0 && share.z <= 1.0;
    });
}

bool contains(const ClusterBox& aligned, std::span<const glm::vec3> vertices) {
    const glm::dvec3 half(aligned.half_edges[0].x, aligned.half_edges[1].y, aligned.half_edges[2].z);
    return std::all_of(vertices.begin(), vertices.end(),
                       [&](const glm::vec3& p) { return is_within(p, glm::dvec3(aligned.center), half); });
}

// Rounding moves a corner by less than 2^-22 of the coordinates' size.
void set_bound(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, glm::vec3& center,
               glm::vec3& half) {
    const Extents extents = along(kAligned, positions, indices);
    const glm::dvec3 size = (glm::max)(glm::abs(extents.min), glm::abs(extents.max));
    const double rounding = 0x1p-21 * (size.x + size.y + size.z);
    center = glm::vec3(0.5 * (extents.min + extents.max));
    half = glm::vec3(0.5 * (extents.max - extents.min) + rounding);
}

}  // namespace crofton::depth
