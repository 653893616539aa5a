// SPDX-License-Identifier: MIT
// What queries ask of draw limits.
#pragma once
#include <algorithm>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/box.hpp>

#include "limits/kernel_limits.hpp"

namespace crofton::cull {

// What a kernel needs, but for the tree's radii.
[[nodiscard]] KernelLimits kernel_limits_of(const DrawLimits& limits);

// Whether a limit is one.
[[nodiscard]] inline bool counts(double limit) {
    return limit <= kMaxCoordinate;
}

// The farthest distance among the layers, or none.
[[nodiscard]] double limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers);

// The nearest distance among the layers, or none: of items that have some of them, none is dropped before.
[[nodiscard]] double least_limit_in_layers(const DrawLimits& limits, std::uint32_t common_layers);

// limit_in_layers of the layers last asked for is kept.
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

// is_worth_drawing, where the layers' limit is known.
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Obb& box, boxtree::ItemId item, double layer_limit);
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item,
                                    double layer_limit);
[[nodiscard]] bool is_within_limits(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item,
                                    double layer_limit);

// What limits are multiplied by for this item.
[[nodiscard]] inline double factor_of(const DrawLimits& limits, boxtree::ItemId item) {
    const bool drawn =
        item / 64 < limits.drawn_before.size() && (limits.drawn_before[item / 64] >> (item % 64) & 1) != 0;
    return drawn ? std::min(std::max(1.0, limits.longer), kMaxCoordinate) : 1.0;
}

}  // namespace crofton::cull
