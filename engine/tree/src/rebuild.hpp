// A rebuild under way: what BoxTree::maintain carries from call to call.
#pragma once
#include <crofton/tree/box_tree.hpp>
#include <optional>

#include "builder.hpp"

namespace crofton::tree {

struct BoxTree::Rebuild {
    std::optional<Builder> builder;
    std::size_t next = 0;  // item to add, then leaf to fill
    bool adding = true;
    bool filling = false;  // the topology is known; leaves are being written into `structure`
    Structure structure;
    Vector<std::uint64_t>
        changed;  // one bit an item: moved, inserted, removed or with new layers since the rebuild began
};

}  // namespace crofton::tree
