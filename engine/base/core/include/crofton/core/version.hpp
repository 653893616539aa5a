// SPDX-License-Identifier: MIT
// Crofton's requirements on the compiler and on GLM, and its version. Every public header includes this one, directly
// or indirectly, so that a build that lacks something reports it first.
#ifndef CROFTON_CORE_VERSION_HPP
#define CROFTON_CORE_VERSION_HPP

#if defined(_MSVC_LANG)
#define CROFTON_CPLUSPLUS _MSVC_LANG  // __cplusplus says 1997 there, unless /Zc:__cplusplus
#else
#define CROFTON_CPLUSPLUS __cplusplus
#endif

#if CROFTON_CPLUSPLUS < 202002L
#error "Crofton needs C++20: compile with -std=c++20 (g++ 12, clang 14 or newer) or /std:c++20"
#include <stop_after_the_error_above>  // fatal, so that no errors of C++17 bury the one that matters
#endif
#undef CROFTON_CPLUSPLUS

// 32-bit x86 computes in the x87 unit with 64 bits of mantissa by default. Answers would differ, and exact ones would
// be wrong.
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ < 0)
#error "Crofton needs float and double computed as such: compile with -msse2 -mfpmath=sse"
#endif

// The library is compiled with quaternions stored as x, y, z, w; with another order objects would turn the wrong way.
// geometry/box.hpp detects GLM macros that pad its types. No other macro changes anything that crosses the API.
#if defined(GLM_FORCE_QUAT_DATA_WXYZ)
#error "Crofton is compiled without GLM_FORCE_QUAT_DATA_WXYZ, which changes the layout of quaternions: undefine it"
#endif

// The version of the headers (macros) and of the linked library (functions).
#define CROFTON_VERSION_MAJOR 0
#define CROFTON_VERSION_MINOR 3
#define CROFTON_VERSION_PATCH 0
// One number for comparisons: #if CROFTON_VERSION >= CROFTON_MAKE_VERSION(0, 3, 0)
#define CROFTON_MAKE_VERSION(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define CROFTON_VERSION CROFTON_MAKE_VERSION(CROFTON_VERSION_MAJOR, CROFTON_VERSION_MINOR, CROFTON_VERSION_PATCH)

namespace crofton {

struct Version {
    int major, minor, patch;
};

// Returns the version of the linked library. Before 1.0 it works only with headers of the same major and minor version.
[[nodiscard]] Version version();
[[nodiscard]] const char* version_string();  // "major.minor.patch"

}  // namespace crofton

#endif
