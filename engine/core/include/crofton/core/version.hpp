// SPDX-License-Identifier: MIT
// Which Crofton the headers are of (macros), and which is linked (functions).
#pragma once
#include <crofton/core/requirements.hpp>

#define CROFTON_VERSION_MAJOR 0
#define CROFTON_VERSION_MINOR 2
#define CROFTON_VERSION_PATCH 0
// One number to compare: #if CROFTON_VERSION >= CROFTON_MAKE_VERSION(0, 2, 0)
#define CROFTON_MAKE_VERSION(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define CROFTON_VERSION CROFTON_MAKE_VERSION(CROFTON_VERSION_MAJOR, CROFTON_VERSION_MINOR, CROFTON_VERSION_PATCH)

namespace crofton {

struct Version {
    int major, minor, patch;
};

// Of the library that is linked; before 1.0 it fits headers of the same major and minor version only.
[[nodiscard]] Version version();
[[nodiscard]] const char* version_string();  // "major.minor.patch"

}  // namespace crofton
