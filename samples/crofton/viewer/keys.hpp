// SPDX-License-Identifier: MIT
// Every key and what it does: for the help in the window, tooltips, `crofton view --help` and scripts.
#pragma once
#include <span>
#include <string>

namespace crofton::viewer {

struct KeyHelp {
    const char* shown;  // as a person reads it
    const char* names;  // as events name them, between blanks; empty for the mouse
    const char* does;
};
struct KeyGroup {
    const char* title;
    std::span<const KeyHelp> keys;
};

[[nodiscard]] std::span<const KeyGroup> key_groups();
// True for the name of a key that does something.
[[nodiscard]] bool is_key(const std::string& name);
// Requires is_key(name).
[[nodiscard]] const char* what_key_does(const std::string& name);
// All of it, a line for each.
[[nodiscard]] std::string key_help();

}  // namespace crofton::viewer
