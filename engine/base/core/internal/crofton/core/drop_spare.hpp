// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/memory.hpp>
#include <iterator>

namespace crofton::detail {

// Releases the unused capacity of a list. Unlike shrink_to_fit, it fails as other allocations do.
template <class T>
void drop_spare(Vector<T>& list) {
    if (list.size() != list.capacity())
        list = Vector<T>(std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
}

}  // namespace crofton::detail
