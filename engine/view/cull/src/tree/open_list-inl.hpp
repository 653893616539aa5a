// SPDX-License-Identifier: MIT
// A list of nodes or leaves that planes of the view cross. Included once per instruction set.
#if defined(CROFTON_CULL_OPEN_LIST) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_OPEN_LIST
#undef CROFTON_CULL_OPEN_LIST
#else
#define CROFTON_CULL_OPEN_LIST
#endif

#include <hwy/highway.h>

#include "tree/leaf_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// How many entries pad() writes after the last one.
constexpr std::size_t kOpenPadding = 8;

// Children and the planes that they straddle.
struct OpenList {
    std::uint32_t* children;
    std::uint32_t* planes;
    std::size_t count = 0;

    HWY_INLINE void append(VU which, VU their_planes, hn::Mask<DU> mask) {
        const DU du;
        simd::compress_store(du, which, mask, children + count);
        count += simd::compress_store(du, their_planes, mask, planes + count);
    }
    // The same planes for all.
    HWY_INLINE void append(VU which, std::uint32_t their_planes, hn::Mask<DU> mask) {
        const DU du;
        hn::StoreU(hn::Set(du, their_planes), du, planes + count);
        count += simd::compress_store(du, which, mask, children + count);
    }
    HWY_INLINE void append(std::uint32_t child, std::uint32_t child_planes) { set(count++, child, child_planes); }
    HWY_INLINE void set(std::size_t i, std::uint32_t child, std::uint32_t child_planes) {
        children[i] = child;
        planes[i] = child_planes;
    }
    // Pads the list with its last entry, so that prefetching past the end stays in range.
    HWY_INLINE void pad() {
        const std::uint32_t last = count > 0 ? children[count - 1] : 0, its_planes = count > 0 ? planes[count - 1] : 0;
        for (std::size_t i = 0; i < kOpenPadding; ++i) set(count + i, last, its_planes);
    }
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
