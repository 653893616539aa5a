// SPDX-License-Identifier: MIT
// A rebuild under way: what BoxTree::rebuild_step carries from call to call.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <optional>

#include "builder.hpp"

namespace crofton::boxtree {

// What bringing the new structure up to date costs, in items' worth.
inline constexpr std::size_t kItemMoved = 2, kItemPlaced = 64;

struct BoxTree::Rebuild {
    // One after the other; in `apply_changes` what has changed meanwhile is brought into `structure`.
    enum class Stage : std::uint8_t { add, divide, clear_slots, link, fill, bound, apply_changes, done };

    std::optional<Builder> builder;
    Stage stage = Stage::add;
    std::size_t next = 0;  // item, slot, leaf, node or word of `changed`
    Structure structure;
    // One bit an item. Since the rebuild began it was moved, inserted, removed or given other layers; it was inserted
    // or attached, so that it may be far from where the new structure has it.
    Vector<std::uint64_t> changed, placed;
    std::size_t changed_count = 0;  // of them
    std::size_t new_work = 0;       // what the changes since the last call are worth
};

}  // namespace crofton::boxtree
