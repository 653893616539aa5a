// SPDX-License-Identifier: MIT
// Ear clipping: quick to understand, and what most engines do today.
#pragma once
#include <array>
#include <bit>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <span>

#include "domain/domain.hpp"
#include "ear/reflex_tree.hpp"

namespace crofton::triangulate {

// A tree of bits, 64 to a node: a bit is set if any bit below it is. The next number is found in O(log64 n).
class CornerSet {
  public:
    static constexpr std::uint32_t kNothing = ~std::uint32_t{0};

    void reset(std::size_t count) {
        level_count_ = 0;
        std::size_t words = 0;
        do {
            begin_[level_count_++] = words;
            count = (count + 63) / 64;
            words += count;
        } while (count > 1);
        bits_.assign(words, 0);
    }
    void insert(std::uint32_t i) {
        for (int level = 0; level < level_count_; ++level, i /= 64)
            bits_[begin_[level] + i / 64] |= std::uint64_t{1} << (i % 64);
    }
    void erase(std::uint32_t i) {
        for (int level = 0; level < level_count_; ++level, i /= 64)
            if ((bits_[begin_[level] + i / 64] &= ~(std::uint64_t{1} << (i % 64))) != 0) return;
    }
    // The first at or after i, or else the first of all; kNothing if the set is empty.
    [[nodiscard]] std::uint32_t next_cyclic(std::uint32_t i) const {
        const std::uint32_t found = next(i);
        return found != kNothing || i == 0 ? found : next(0);
    }

  private:
    static constexpr int kMostLevels = 6;

    [[nodiscard]] std::uint32_t next(std::uint32_t i) const {
        for (int level = 0; level < level_count_; ++level, i = i / 64 + 1) {
            const std::size_t word = begin_[level] + i / 64;
            if (word >= (level + 1 == level_count_ ? bits_.size() : begin_[level + 1])) return kNothing;
            const std::uint64_t rest = bits_[word] & (~std::uint64_t{0} << (i % 64));
            if (rest == 0) continue;
            i = i / 64 * 64 + static_cast<std::uint32_t>(std::countr_zero(rest));
            while (level-- > 0) i = i * 64 + static_cast<std::uint32_t>(std::countr_zero(bits_[begin_[level] + i]));
            return i;
        }
        return kNothing;
    }

    Vector<std::uint64_t> bits_;
    std::size_t begin_[kMostLevels] = {};
    int level_count_ = 0;
};

// Joins the pieces of the boundary by the shortest Delaunay edges that do so and cuts ears off the walks that result.
// A corner that is no ear is asked again only when its neighbours change or the vertex that it was found to hold is no
// longer in the way. That makes bands, whose corners are nearly all flat, linear.
class EarClipping {
  public:
    // Appends triangles of the caller's indices; returns the diagonals' length.
    [[nodiscard]] double run(const Domain& domain, Vector<std::array<std::uint32_t, 3>>& triangles);
    // The same triangles, of one ring that touches itself nowhere: no domain is needed.
    [[nodiscard]] double run(std::span<const glm::dvec2> ring, bool counter_clockwise,
                             Vector<std::array<std::uint32_t, 3>>& triangles);

  private:
    struct Corner {
        Index vertex;
        Index previous, next;
        Index input;  // the caller's index
        bool reflex;
    };
    // A corner that waits for a vertex to get out of its way.
    struct Waiting {
        Index corner, next;
    };

    // An edge that may join two pieces.
    struct Bridge {
        double square;  // of its length
        Index half_edge;
    };

    void join_pieces();
    [[nodiscard]] bool is_wall(Index half_edge) const {
        return simple_ ? mesh_->mark[half_edge] != 0 : wall_[half_edge] != 0;
    }
    void find_pieces();
    [[nodiscard]] Index find(Index piece);
    bool join(Index a, Index b);  // pieces; false where they are one already
    void begin(std::span<const glm::dvec2> points);
    [[nodiscard]] bool is_ascending(Index half_edge) const;
    template <class VertexOf>
    void collect_ring(std::size_t size, bool ascending, VertexOf vertex_of);
    void collect_walk(Index start);
    void link_corners();
    void clip(Vector<std::array<std::uint32_t, 3>>& triangles);
    [[nodiscard]] bool is_reflex(const Corner& corner) const;
    [[nodiscard]] bool is_ear(Index corner);
    [[nodiscard]] bool opens_towards(const Corner& corner, Index vertex) const;
    void update(Index corner);
    void wake(Index corner);

    const Domain* domain_ = nullptr;
    const HalfEdgeMesh* mesh_ = nullptr;
    std::span<const glm::dvec2> points_;
    // One ring that touches nothing: every vertex has one corner.
    bool simple_ = false;
    Vector<std::uint8_t> wall_, walked_;
    Vector<Index> piece_;   // of each vertex
    Vector<Index> parent_;  // of each piece, until it leads to itself
    Vector<Bridge> bridges_;
    Vector<Index> reflex_count_, reflex_;
    ReflexTree tree_;
    Vector<Corner> corners_;
    CornerSet awake_;
    Vector<Index> waiting_for_;  // vertex → the first of waiting_
    Vector<Waiting> waiting_;
    double weight_ = 0.0;
};

}  // namespace crofton::triangulate
