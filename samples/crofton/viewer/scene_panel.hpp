// SPDX-License-Identifier: MIT
// The scene graph as a tree, and what is known of the instance picked.
#pragma once
#include "panels.hpp"

namespace crofton::viewer {

void scene_panel(const PanelInput& input, PanelWish& wish);

}  // namespace crofton::viewer
