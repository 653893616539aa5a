// SPDX-License-Identifier: MIT
// The occluders' depth buffer as a picture, with its scale and the selected instance's place in it.
#pragma once
#include "panels.hpp"

namespace crofton::viewer {

void depth_panel(const PanelInput& input, PanelWish& wish);

}  // namespace crofton::viewer
