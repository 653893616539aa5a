// SPDX-License-Identifier: MIT
// Whether code may use vectors and 128-bit integers of the compiler. Each use has a portable twin that gives the same
// bits. Other compilers (MSVC) and targets of 32 bits take it, and CROFTON_NO_EXTENSIONS forces it for the tests.
#pragma once

#if defined(__has_builtin) && !defined(CROFTON_NO_EXTENSIONS)
#if __has_builtin(__builtin_shufflevector)
#define CROFTON_COMPILER_VECTORS 1
#endif
#endif

#if defined(__SIZEOF_INT128__) && !defined(CROFTON_NO_EXTENSIONS)
#define CROFTON_COMPILER_INT128 1
#endif
