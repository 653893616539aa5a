// SPDX-License-Identifier: MIT
// Everything that can be switched, with its key.
#pragma once
#include "panels.hpp"

namespace crofton::viewer {

void switches_panel(const PanelInput& input, PanelWish& wish);

}  // namespace crofton::viewer
