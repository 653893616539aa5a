// SPDX-License-Identifier: MIT
// The list of keys, and messages that come and go.
#pragma once
#include "panels.hpp"

namespace crofton::viewer {

void help_panel(Settings& settings, PanelWish& wish);
void notices_panel(const std::deque<Notice>& notices);

}  // namespace crofton::viewer
