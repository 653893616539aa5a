// SPDX-License-Identifier: MIT
// Code that calls with many handles share.
#pragma once
#include <crofton/world/inputs.hpp>

namespace crofton {

[[nodiscard]] inline Result<void> fail_sizes() {
    return fail(ErrorCode::invalid_argument, kNoItem, "world: there must be as many values as handles");
}

// Calls change(handle, value, i) for all; returns the first error.
template <class T, class Value, class Change>
Result<void> for_each_pair(const Strided<T>& handles, const Strided<Value>& values, Change change) {
    if (handles.size() != values.size()) return fail_sizes();
    Result<void> first;
    for (std::size_t i = 0; i < handles.size(); ++i)
        if (auto changed = change(handles[i], values[i], i); !changed && first) first = std::move(changed);
    return first;
}

}  // namespace crofton
