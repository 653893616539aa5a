// SPDX-License-Identifier: MIT
// The reflex corners that may still lie in an ear, by place.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "domain/half_edge_mesh.hpp"

namespace crofton::triangulate {

// A k-d tree. Ears may be as long as the polygon and as thin as a hair, so nodes are tested against the triangle, not
// against its box. One between two dense sides then visits O(log n) of them.
class ReflexTree {
  public:
    // Each vertex is listed once.
    void build(std::span<const glm::dvec2> points, std::span<const Index> vertices);
    // The vertex must be in the tree.
    void remove(Index vertex);

    // A vertex for which admit(vertex, position) holds, or kNone. All in the closed triangle, counter-clockwise, are
    // asked, and some near it.
    template <class Admit>
    [[nodiscard]] Index find(const std::array<glm::dvec2, 3>& triangle, Admit admit) const {
        if (nodes_.empty()) return kNone;
        const Box box = box_of(triangle);
        std::array<Index, kMostDepth> stack;
        std::size_t depth = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[stack[--depth]];
            if (node.count == 0 || misses(node.box, box)) continue;
            if (node.right != kNone) {
                if (nodes_.size() > kFew && misses(node.box, triangle)) continue;
                stack[depth++] = node.right;
                stack[depth++] = static_cast<Index>(&node - nodes_.data()) + 1;
                continue;
            }
            for (Index i = node.begin; i < node.end; ++i) {
                const glm::dvec2& p = positions_[i];
                const bool in_box = (p.x >= box.low.x) & (p.x <= box.high.x) & (p.y >= box.low.y) & (p.y <= box.high.y);
                if (in_box && vertices_[i] != kNone && admit(vertices_[i], p)) return vertices_[i];
            }
        }
        return kNone;
    }

  private:
    static constexpr std::size_t kMostDepth = 40, kFew = 8;
    struct Box {
        glm::dvec2 low, high;
    };
    // An inner node's left child follows it; a leaf has no right one.
    struct Node {
        Box box;
        Index begin, end, right, parent;
        Index count;  // of vertices still there
    };

    void split(Index begin, Index end, Index parent);
    [[nodiscard]] static Box box_of(std::span<const glm::dvec2> points);
    [[nodiscard]] static bool misses(const Box& a, const Box& b) {
        return a.low.x > b.high.x || a.high.x < b.low.x || a.low.y > b.high.y || a.high.y < b.low.y;
    }
    [[nodiscard]] static bool misses(const Box& box, const std::array<glm::dvec2, 3>& triangle);

    std::span<const glm::dvec2> points_;
    Vector<Node> nodes_;
    Vector<Index> vertices_;        // by leaf; kNone where one has gone
    Vector<glm::dvec2> positions_;  // of vertices_
    std::size_t leaf_size_ = 0;
    Vector<Index> place_, leaf_;  // vertex → its place in vertices_, and its leaf
};

}  // namespace crofton::triangulate
