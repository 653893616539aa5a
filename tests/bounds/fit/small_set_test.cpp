// SPDX-License-Identifier: MIT
// A turn of a frame finds the rectangle that is flush with an edge, whichever of the four sides the edge comes to lie
// on.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "small_set/kernels.hpp"

using namespace crofton;
using fit::kernels::kLanes;

TEST_SUITE("fit/small_set") {
    TEST_CASE(
        "around a flat triangle a turn finds the rectangle on its longest edge, in whatever direction that lies") {
        // Only that rectangle has twice the area of an obtuse triangle: base times height.
        constexpr double kHeight = 0.2, kTwiceArea = 2.0 * kHeight;
        for (int direction = 0; direction < 64; ++direction) {
            const double angle = (direction + 0.37) * std::numbers::pi / 32.0;
            const double across[2] = {std::cos(angle), std::sin(angle)};  // from the apex to the edge, and beyond
            alignas(64) float x[kLanes], y[kLanes], z[kLanes] = {};
            const double edge[3][2] = {{-kHeight, 0.1}, {0.0, -1.0}, {0.0, 1.0}};  // apex, then the edge's ends
            for (std::size_t i = 0; i < kLanes; ++i) {
                const auto& at = edge[i < 3 ? i : 0];
                x[i] = static_cast<float>(at[0] * across[0] - at[1] * across[1]);
                y[i] = static_cast<float>(at[0] * across[1] + at[1] * across[0]);
            }
            fit::kernels::Turn turn{{0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 0.0f, 0.0f, 0.0f};
            alignas(64) float scratch[2 * kLanes];
            // For a flat box `pairs` weighs the rectangle's area.
            fit::kernels::turn_frame({x, y, z, 3}, {0.0f, 1.0f, 0.0f}, scratch, turn);
            CAPTURE(direction);
            CHECK(double(turn.value) == doctest::Approx(kTwiceArea).epsilon(1e-5));
            // The new `right` is along the edge or across it.
            const double along = double(turn.cosine) * across[0] + double(turn.sine) * across[1];
            CHECK(std::min(std::abs(along), 1.0 - std::abs(along)) < 1e-5);
        }
    }
}
