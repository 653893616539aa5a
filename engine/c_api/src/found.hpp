// SPDX-License-Identifier: MIT
// Holds what the last query of a World has found, and gives lists to callers in C.
#pragma once
#include <crofton/capi/crofton.h>
#include <crofton/world/object_manifold.hpp>
#include <crofton/world/world.hpp>

#include <cstddef>

#include <crofton/capi/call.hpp>

namespace crofton::capi {

// Sets *elements and *count to a list of the same bytes.
template <class Element, class List>
[[nodiscard]] crofton_status give_list(const List& list, const Element** elements, std::size_t* count,
                                       const char* function) {
    static_assert(sizeof(Element) == sizeof(list[0]));
    CROFTON_CHECK(check_pointer(elements, function));
    CROFTON_CHECK(check_pointer(count, function));
    *elements = reinterpret_cast<const Element*>(list.data());
    *count = list.size();
    return CROFTON_OK;
}

}  // namespace crofton::capi

// One of the lists has elements.
struct crofton_found {
    static constexpr std::uint32_t kKind = 0x43724f0a;
    crofton::capi::Header header;
    crofton::Vector<crofton::ObjectRef> objects{};
    crofton::Vector<crofton::ObjectHit> hits{};
    crofton::Vector<crofton_shape_hit> shape_hits{};
    crofton::Vector<crofton::ObjectManifold> manifolds{};

    void clear() {
        objects.clear();
        hits.clear();
        shape_hits.clear();
        manifolds.clear();
    }
};
