// SPDX-License-Identifier: MIT
// Draw limits as queries use them.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/box.hpp>

#include "limits/kernel_limits.hpp"

namespace crofton::cull {

// The limits as a kernel needs them, without the tree's radii.
[[nodiscard]] KernelLimits kernel_limits_of(const DrawLimits& limits);

// Whether a number limits anything.
[[nodiscard]] inline bool counts(double limit) {
    return std::fabs(limit) <= kMaxCoordinate;
}

// The farthest distance among the layers, or none.
[[nodiscard]] double limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers);

// The nearest distance among the layers, or none. No item with some of these layers is dropped before it.
[[nodiscard]] double least_limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers);

// limit_in_layers() with a memory of the last layers.
class LayerLimit {
  public:
    [[nodiscard]] double of(const DrawLimits& limits, std::uint32_t common_layers) {
        if (common_layers != layers_ || !is_known_) {
            layers_ = common_layers;
            is_known_ = true;
            limit_ = limit_in_layers(limits, common_layers);
        }
        return limit_;
    }

  private:
    std::uint32_t layers_ = 0;
    bool is_known_ = false;
    double limit_ = 0.0;
};

// As is_worth_drawing(), given the limit of the item's layers.
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Obb& box, boxtree::ItemId item, double layer_limit);
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item,
                                    double layer_limit);
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item,
                                    double layer_limit);

// The factor of this item's limits: above 1 if it was drawn before.
[[nodiscard]] inline double factor_of(const DrawLimits& limits, boxtree::ItemId item) {
    const bool drawn =
        item / 64 < limits.drawn_before.size() && (limits.drawn_before[item / 64] >> (item % 64) & 1) != 0;
    return drawn ? std::min(std::max(1.0, limits.hysteresis), kMaxCoordinate) : 1.0;
}

}  // namespace crofton::cull
