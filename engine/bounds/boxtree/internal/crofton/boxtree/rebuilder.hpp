// SPDX-License-Identifier: MIT
// Rebuilds a tree's structure in the background, a bounded step at a time, while the old one is in use and changes.
#pragma once
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/memory.hpp>

namespace crofton::boxtree {

// How much work a step of a rebuild has done.
struct RebuildStep {
    std::size_t items_added = 0, items_synced = 0;  // for the new structure; into it, as they have changed since
    std::size_t slots_cleared = 0, leaves_filled = 0, nodes_linked = 0, nodes_bounded = 0;
    std::size_t divisions = 0;  // steps of dividing items among leaves and nodes, each of the budget's size
    std::size_t visits = 0;     // of items, while they are copied, sorted and divided
};

// A rebuild that is under way, or none.
class Rebuilder {
  public:
    Rebuilder();
    ~Rebuilder();

    // Begins a rebuild where none is under way and there are items, and works on (see BoxTree::rebuild_step). Returns
    // the new structure when it is complete, otherwise nothing.
    [[nodiscard]] Owner<Structure> step(const Structure& current, Items& items, std::size_t budget);

    // The item was moved, inserted, removed or given other layers. `placed`: it was inserted or attached, so that it
    // may be far from where the new structure has it.
    void note_change(ItemId item, bool placed = false);
    void note_changes(std::span<const ItemId> items);

    // The work of the last step.
    [[nodiscard]] const RebuildStep& last_step() const { return last_step_; }

  private:
    struct Work;
    std::size_t run_stage(const Structure& current, std::size_t budget);
    std::size_t add_items(const Structure& current, std::size_t budget);
    std::size_t divide(const Structure& current, std::size_t budget);
    std::size_t clear_slots(std::size_t budget);
    std::size_t link_nodes(std::size_t budget);
    std::size_t fill_leaves(const Structure& current, std::size_t budget);
    std::size_t bound_nodes(std::size_t budget);
    std::size_t apply_changes(const Structure& current, std::size_t budget);
    void sync_item(ItemId item, bool present, bool placed);

    Owner<Work> work_;        // of the rebuild under way
    std::size_t placed_ = 0;  // items that were inserted or attached since the last rebuild began
    RebuildStep last_step_;
};

}  // namespace crofton::boxtree
