#include "bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::tree {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float float_at_least(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) < value ? std::nextafter(rounded, kInfinity) : rounded;
}

// To the nearest integer of at most 32767, for |value| ≤ 32769: adding 1.5 · 2^52 leaves no fraction.
std::int16_t rounded(double value) {
    const double integer = (value + 0x1.8p52) - 0x1.8p52;
    return static_cast<std::int16_t>(std::min(32767.0, std::max(-32767.0, integer)));
}

float norm1(float x, float y, float z) {
    return float_at_least((std::fabs(double{x}) + std::fabs(double{y}) + std::fabs(double{z})) * (1.0 + 0x1p-50));
}

}  // namespace

void clear(Node& node) {
    node = {};
    node.parent = kNone;
    for (unsigned lane = 0; lane < kWidth; ++lane) clear_lane(node, lane);
}

void clear(Leaf& leaf) {
    leaf = {};
    leaf.parent = kNone;
    for (unsigned lane = 0; lane < kWidth; ++lane) clear_lane(leaf, lane);
}

void clear_lane(Leaf& leaf, unsigned lane) {
    leaf.x[lane] = leaf.y[lane] = leaf.z[lane] = 0.0f;
    leaf.radius[lane] = -kInfinity;
    leaf.layers[lane] = 0;
    for (auto& row : leaf.edge) row[lane] = 0;
}

void clear_lane(Node& node, unsigned lane) {
    for (int j = 0; j < 3; ++j) {
        node.center[j][lane] = 0.0f;
        node.half[j][lane] = -kInfinity;
    }
    node.child[lane] = kNone;
    node.layers_any[lane] = node.layers_all[lane] = 0;
}

void write_lane(Leaf& leaf, unsigned lane, const Obb& box, std::uint32_t layers) {
    const double dx = box.center.x - leaf.origin[0], dy = box.center.y - leaf.origin[1],
                 dz = box.center.z - leaf.origin[2];
    leaf.x[lane] = static_cast<float>(dx);
    leaf.y[lane] = static_cast<float>(dy);
    leaf.z[lane] = static_cast<float>(dz);
    // The difference rounds by 2^-53, the float by 2^-24, relative to each component.
    const double shift = (std::fabs(dx) + std::fabs(dy) + std::fabs(dz)) * 0x1.01p-24 + 1e-44;
    double edge[3][3], square = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) edge[k][j] = double{box.axes[k][j]} * double{box.half_extents[k]};
    const auto dot = [&](int a, int b) {
        return edge[a][0] * edge[b][0] + edge[a][1] * edge[b][1] + edge[a][2] * edge[b][2];
    };
    // No corner is farther than |Σ ±edge|² ≤ Σ |edge_k|² + 2 Σ |edge_i · edge_k|.
    for (int k = 0; k < 3; ++k) square += dot(k, k) + 2.0 * std::fabs(dot(k, (k + 1) % 3));
    const float radius = std::max(kMinRadius, float_at_least(std::sqrt(square) * (1.0 + 0x1p-48) + shift));
    leaf.radius[lane] = radius;
    const double per_unit = 1.0 / (double{radius} * double{kEdgeUnit});
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) leaf.edge[3 * k + j][lane] = rounded(edge[k][j] * per_unit);
    leaf.layers[lane] = layers;
    leaf.reach = std::max(leaf.reach, norm1(leaf.x[lane], leaf.y[lane], leaf.z[lane]));
}

void write_layers(Node& node, unsigned lane, const std::uint32_t* any, const std::uint32_t* all, std::uint32_t count) {
    std::uint32_t some = 0, every = ~std::uint32_t{0};
    for (std::uint32_t i = 0; i < count; ++i) {
        some |= any[i];
        every &= all[i];
    }
    node.layers_any[lane] = some;
    node.layers_all[lane] = every;
}

void write_lane(Node& node, unsigned lane, const Aabb& bounds) {
    if (bounds.is_empty()) {
        for (int j = 0; j < 3; ++j) {
            node.center[j][lane] = 0.0f;
            node.half[j][lane] = -kInfinity;
        }
        return;
    }
    double reach = 0.0;
    for (int j = 0; j < 3; ++j) {
        const double low = bounds.min[j] - node.origin[j], high = bounds.max[j] - node.origin[j];
        const float center = static_cast<float>(0.5 * low + 0.5 * high);
        // The differences round by 2^-53 of the result each; 2^-50 of all magnitudes covers them and this line's own.
        const double slack = (std::fabs(low) + std::fabs(high)) * 0x1p-50;
        const float half = float_at_least(std::max(high - double{center}, double{center} - low) + slack);
        node.center[j][lane] = center;
        node.half[j][lane] = half;
        reach += std::fabs(double{center}) + double{half};
    }
    node.reach = std::max(node.reach, float_at_least(reach * (1.0 + 0x1p-50)));
}

Aabb bounds_of_lane(const Node& node, unsigned lane) {
    Aabb result;
    if (node.half[0][lane] < 0.0f) return result;
    for (int j = 0; j < 3; ++j) {
        const double center = double{node.center[j][lane]}, half = double{node.half[j][lane]};
        // Two roundings of at most 2^-53 of the largest magnitude each.
        const double slack = (std::fabs(node.origin[j]) + std::fabs(center) + half) * 0x1p-51;
        result.min[j] = node.origin[j] + (center - half) - slack;
        result.max[j] = node.origin[j] + (center + half) + slack;
    }
    return result;
}

Aabb bounds_of(const Node& node) {
    Aabb result;
    for (unsigned lane = 0; lane < node.count; ++lane) {
        const Aabb child = bounds_of_lane(node, lane);
        if (!child.is_empty()) result.include(child);
    }
    return result;
}

Aabb bounds_of(const Leaf& leaf) {
    Aabb result;
    if (leaf.count == 0) return result;
    for (int j = 0; j < 3; ++j) {
        const float* position = j == 0 ? leaf.x : j == 1 ? leaf.y : leaf.z;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (unsigned lane = 0; lane < leaf.count; ++lane) {
            const double unit = double{leaf.radius[lane]} * double{kEdgeUnit};
            int sum = 0;
            for (int k = 0; k < 3; ++k) sum += std::abs(int{leaf.edge[3 * k + j][lane]});
            // Each of the three components is within one unit of the truth, and none sticks out of the ball.
            const double extent = std::min((sum + 3.01) * unit, double{leaf.radius[lane]});
            low = std::min(low, double{position[lane]} - extent);
            high = std::max(high, double{position[lane]} + extent);
        }
        // The centres' own rounding (see write_lane), and that of the two additions here.
        const double slack = double{leaf.reach} * 0x1.1p-24 +
                             (std::fabs(leaf.origin[j]) + std::fabs(low) + std::fabs(high)) * 0x1p-51 + 1e-44;
        result.min[j] = leaf.origin[j] + low - slack;
        result.max[j] = leaf.origin[j] + high + slack;
    }
    return result;
}

}  // namespace crofton::tree
