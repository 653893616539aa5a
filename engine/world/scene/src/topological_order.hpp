// SPDX-License-Identifier: MIT
// Keeps nodes in an order in which parents come before their children, while the graph changes.
#pragma once
#include <algorithm>
#include <crofton/scene/scene.hpp>

namespace crofton::scene {

// A new node goes to the end. A removed one leaves a gap. When gaps outnumber nodes, they are closed.
class TopologicalOrder {
  public:
    // Positions are below this.
    [[nodiscard]] std::size_t size() const { return nodes_.size(); }
    // kNone in a gap.
    [[nodiscard]] NodeId node_at(std::size_t position) const { return nodes_[position]; }
    [[nodiscard]] bool wants_compaction() const { return nodes_.size() > 64 && nodes_.size() / 2 > live_; }

    // So that the next append needs no memory.
    void reserve_one() {
        if (nodes_.size() == nodes_.capacity()) nodes_.reserve(std::max<std::size_t>(8, 2 * nodes_.size()));
    }

    // Returns the node's position.
    std::uint32_t append(NodeId node) {
        nodes_.push_back(node);
        ++live_;
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }

    void remove_at(std::size_t position) {
        nodes_[position] = kNone;
        --live_;
    }

    // Closes the gaps; moved(node, old position, new position) for every node, ascending.
    template <class Moved>
    void compact(Moved moved) {
        std::size_t end = 0;
        for (std::size_t p = 0; p < nodes_.size(); ++p)
            if (const NodeId node = nodes_[p]; node != kNone) {
                moved(node, p, end);
                nodes_[end++] = node;
            }
        nodes_.resize(end);
    }

  private:
    Vector<NodeId> nodes_;
    std::size_t live_ = 0;
};

}  // namespace crofton::scene
