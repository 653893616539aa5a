// SPDX-License-Identifier: MIT
// Bounds of a structure after its items have moved: right again, and tight.
#pragma once
#include <crofton/boxtree/structure.hpp>
#include <span>

namespace crofton::boxtree {

class Refit {
  public:
    explicit Refit(Structure& structure)
        : structure_(structure), nodes_(structure.nodes_), leaves_(structure.leaves_), work_(structure.scratch_) {}

    void run();

  private:
    void write_dirty_leaves(std::span<const LeafId> leaves);
    void refit_leaves();
    void refit_node(NodeId n);
    void set_child(NodeId n, unsigned lane, const Aabb& bounds, Vector<NodeId>& dirty);

    Structure& structure_;
    GrowingVector<Node>& nodes_;
    GrowingVector<Leaf>& leaves_;
    Structure::Scratch& work_;
};

}  // namespace crofton::boxtree
