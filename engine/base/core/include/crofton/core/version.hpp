// SPDX-License-Identifier: MIT
// What Crofton asks of the compiler and of GLM. Every public header includes this one, itself or through another, so
// that a build that lacks something says so first.
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

// 32-bit x86 computes in its old unit with 64 bits of mantissa unless told otherwise: answers would differ, and exact
// ones be wrong.
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ < 0)
#error "Crofton needs float and double computed as such: compile with -msse2 -mfpmath=sse"
#endif

// The library is compiled with quaternions stored as x, y, z, w: with another order objects turn the wrong way.
// Macros of GLM that pad its types are caught in geometry/box.hpp. All others change nothing that crosses the API.
#if defined(GLM_FORCE_QUAT_DATA_WXYZ)
#error "Crofton is compiled without GLM_FORCE_QUAT_DATA_WXYZ, which changes the layout of quaternions: undefine it"
#endif

// Which Crofton the headers are of (macros), and which is linked (functions).
#define CROFTON_VERSION_MAJOR 0
#define CROFTON_VERSION_MINOR 3
#define CROFTON_VERSION_PATCH 0
// One number to compare: #if CROFTON_VERSION >= CROFTON_MAKE_VERSION(0, 3, 0)
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

#endif
