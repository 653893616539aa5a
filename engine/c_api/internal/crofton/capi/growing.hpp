// SPDX-License-Identifier: MIT
// Structs of callers that were compiled against an older header, in which they were smaller.
#pragma once
#include <cstring>

#include <crofton/capi/crofton.h>
#include <crofton/capi/call.hpp>

namespace crofton::capi {

// A struct has never ended within its alignment, so other sizes are mistakes. A larger one may hold what this library
// does not know: ignoring it would be a guess.
template <class Struct>
[[nodiscard]] crofton_status check_growing(const Struct* argument, const char* function) {
    if (!argument) return report(CROFTON_INVALID_ARGUMENT, function, "a struct is NULL");
    if (argument->size < sizeof argument->size || argument->size > sizeof(Struct) ||
        argument->size % alignof(Struct) != 0)
        return report(
            CROFTON_WRONG_SIZE, function,
            "a struct's `size` is larger than this library knows, or no size: begin with its crofton_default_...()");
    return CROFTON_OK;
}

// The defaults of a struct: what its crofton_default_...() returns, and 0 for structs that have none.
template <class Struct>
[[nodiscard]] Struct default_of() {
    Struct result{};
    result.size = sizeof result;
    return result;
}
template <>
[[nodiscard]] inline crofton_world_options default_of<crofton_world_options>() {
    return crofton_default_world_options();
}
template <>
[[nodiscard]] inline crofton_mesh_data default_of<crofton_mesh_data>() {
    return crofton_default_mesh_data();
}
template <>
[[nodiscard]] inline crofton_object_description default_of<crofton_object_description>() {
    return crofton_default_object_description();
}
template <>
[[nodiscard]] inline crofton_region_options default_of<crofton_region_options>() {
    return crofton_default_region_options();
}
template <>
[[nodiscard]] inline crofton_query_filter default_of<crofton_query_filter>() {
    return crofton_default_query_filter();
}
template <>
[[nodiscard]] inline crofton_view_request default_of<crofton_view_request>() {
    return crofton_default_view_request();
}
template <>
[[nodiscard]] inline crofton_depth_object default_of<crofton_depth_object>() {
    return crofton_default_depth_object();
}
template <>
[[nodiscard]] inline crofton_picture_view default_of<crofton_picture_view>() {
    return crofton_default_picture_view();
}

template <>
[[nodiscard]] inline crofton_shadow_receivers default_of<crofton_shadow_receivers>() {
    return crofton_default_shadow_receivers();
}
template <>
[[nodiscard]] inline crofton_depth_receivers default_of<crofton_depth_receivers>() {
    return crofton_default_depth_receivers();
}

// Copies what the caller's struct has; the other members of `copy` have their defaults.
template <class Struct>
[[nodiscard]] crofton_status read_growing(const Struct* argument, const char* function, Struct& copy) {
    CROFTON_CHECK(check_growing(argument, function));
    copy = default_of<Struct>();
    std::memcpy(&copy, argument, argument->size);
    return CROFTON_OK;
}

// Item i of an array of such structs, each as far from the next as the first one says its size is.
template <class Struct>
[[nodiscard]] crofton_status read_growing_at(const Struct* first, std::size_t i, const char* function, Struct& copy) {
    CROFTON_CHECK(check_growing(first, function));
    const auto* item = reinterpret_cast<const Struct*>(reinterpret_cast<const unsigned char*>(first) + i * first->size);
    CROFTON_CHECK(read_growing(item, function, copy));
    return copy.size == first->size ? CROFTON_OK
                                    : report(CROFTON_WRONG_SIZE, function, "structs of an array differ in `size`", i);
}

// Writes as much of `source` as the caller's struct, which has been checked, has room for. Its size stays.
template <class Struct>
void write_growing(Struct source, Struct* result) {
    source.size = result->size;
    std::memcpy(static_cast<void*>(result), &source, source.size);
}

}  // namespace crofton::capi
