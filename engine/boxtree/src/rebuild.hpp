// SPDX-License-Identifier: MIT
// A rebuild under way: what BoxTree::rebuild_step carries from call to call.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <optional>

#include "builder.hpp"

namespace crofton::boxtree {

struct BoxTree::Rebuild {
    // One after the other; in `apply_changes` what has changed meanwhile is brought into `structure`.
    enum class Stage : std::uint8_t { add, divide, clear_slots, link, fill, bound, apply_changes, done };

    std::optional<Builder> builder;
    Stage stage = Stage::add;
    std::size_t next = 0;  // item, slot, leaf, node or word of `changed`
    Structure structure;
    Vector<std::uint64_t>
        changed;  // one bit an item: moved, inserted, removed or with new layers since the rebuild began
    std::size_t changed_count = 0;  // of them
    std::size_t new_changes = 0;    // since the last call
};

}  // namespace crofton::boxtree
