// SPDX-License-Identifier: MIT
// What the standard library of Emscripten 3.1.6 (Debian 12) lacks of C++20. Included before every source of this build.
#pragma once
#ifdef __cplusplus
#include <version>
#ifndef __cpp_lib_bit_cast
namespace std {
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    static_assert(sizeof(To) == sizeof(From));
    return __builtin_bit_cast(To, from);
}
}  // namespace std
#endif
#endif
