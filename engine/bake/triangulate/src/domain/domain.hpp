// SPDX-License-Identifier: MIT
// From the caller's rings to a checked subdivision: which vertices there are, which triangles lie inside.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

#include "domain/half_edge_mesh.hpp"
#include "numbers/root_sums.hpp"

namespace crofton::triangulate {

// Sorts points along the Z-order curve of a grid of some 16 cells a point, those of one cell lexicographically, then by
// index. Codes have the cell's bits interleaved, those of y in even places. Where codes first differ in bit b, a
// vertical (odd b) or horizontal line separates the points strictly; within a cell, a slightly tilted vertical one.
class SpatialOrder {
  public:
    struct Entry {
        std::uint32_t code, index;
    };
    // Valid until the next call. Positions must be finite.
    [[nodiscard]] std::span<const Entry> sort(std::span<const glm::dvec2> points);

  private:
    void encode(std::span<const glm::dvec2> points);
    void sort_by_code();

    Vector<Entry> entries_, buffer_;
};

// The constrained Delaunay triangulation of the polygon's convex hull with its inside marked.
// Meaning of what is not a simple polygon with simple holes inside it:
// - a point is inside a ring if an odd number of the ring's edges lie between it and infinity;
// - input points at one position are one vertex; a vertex on another edge splits that edge;
// - an edge traversed twice by one ring is no boundary: a spike that points inside becomes a slit, one outside
// vanishes;
// - a hole of one point is a Steiner point, of two a slit.
// Errors: fewer than three points, non-finite or too widely spread coordinates, edges that cross, holes outside, nested
// or overlapping, nothing inside; each names ring, point and position.
class Domain {
  public:
    [[nodiscard]] Result<void> build(const Polygon& polygon);
    // The part of build() that looks at counts and coordinates alone; scale() is known after it.
    [[nodiscard]] Result<void> check(const Polygon& polygon);

    // Makes segments between vertices edges of the mesh. They must lie inside, cross nothing and hold no vertex.
    void insert_diagonals(std::span<const Segment> segments);

    [[nodiscard]] const HalfEdgeMesh& mesh() const { return mesh_; }
    [[nodiscard]] bool inside(Index triangle) const { return inside_[triangle] != 0; }
    [[nodiscard]] std::size_t ring_count() const { return polygon_->ring_count(); }
    [[nodiscard]] std::span<const std::uint32_t> ring_ends() const { return polygon_->ring_ends; }
    [[nodiscard]] std::size_t inside_count() const { return inside_count_; }
    // Lengths in the caller's units are those of `mesh().points` times this power of two.
    [[nodiscard]] double scale() const { return scale_; }
    // The caller's index for the corner of triangle e / 4 at origin[e]; e's triangle must be inside.
    [[nodiscard]] Index input_index(Index e) const;
    [[nodiscard]] bool has_shared_positions() const { return points_.size() != vertex_of_.size(); }
    // Whether rings touch themselves or each other, at points or along edges.
    [[nodiscard]] bool has_touching_rings() const { return has_shared_positions() || has_split_edges_; }
    // The only index of a vertex where no positions are shared.
    [[nodiscard]] Index input_of(Index vertex) const { return input_of_[vertex]; }
    [[nodiscard]] Index vertex_of(Index input) const { return vertex_of_[input]; }
    [[nodiscard]] std::size_t vertex_count() const { return points_.size(); }

  private:
    static constexpr std::uint8_t kUnreached = 2;

    // A ring's edge from input point `input`; several may share one edge of the mesh. Records below the number of input
    // points are implicit: record i is {i, kNone}. An edge's mark is its first record + 1.
    struct Record {
        Index input, next;
    };
    // The state of a region that no constraint divides.
    struct State {
        Index outer = 0;  // parity of the outer ring
        Index hole = 0;   // the hole that contains it, or 0
    };
    // A marked half-edge of a region not yet entered, and the state of the region before it.
    struct Border {
        Index half_edge, region;
    };

    void merge_vertices(const Polygon& polygon);
    void find_next_vertices();
    void mark_present_edges();
    [[nodiscard]] Result<void> insert_rings();
    [[nodiscard]] Result<void> insert_edge(Index input, Index successor);
    [[nodiscard]] Result<void> find_inside();
    void find_side(Index begin, Index end);
    [[nodiscard]] bool label_triangles();
    [[nodiscard]] bool labels_fit();
    [[nodiscard]] bool sides_fit() const;
    [[nodiscard]] bool side_fits(Index input) const;
    [[nodiscard]] Result<void> enter(Index half_edge, State state);
    void flood(Index triangle);
    [[nodiscard]] Result<State> cross(State state, Index mark);
    [[nodiscard]] Error overlap(Index mark, Index a, Index b) const;
    [[nodiscard]] Result<void> check_holes() const;
    [[nodiscard]] Result<void> check_slits() const;
    [[nodiscard]] bool touches_inside(Index vertex) const;
    [[nodiscard]] Index edge_count(Index begin, Index end) const;
    void claim(Index half_edge, Index input);
    [[nodiscard]] Record record(Index id) const;
    [[nodiscard]] Index ring_of(Index input) const;
    // Whether a ring is a hole of two points: an edge that bounds nothing.
    [[nodiscard]] bool is_slit(Index ring) const {
        return ring != 0 && polygon_->ring_ends[ring] - polygon_->ring_ends[ring - 1] == 2;
    }
    [[nodiscard]] Index successor(Index input) const;
    [[nodiscard]] Index predecessor(Index input) const;
    [[nodiscard]] Index first_of_equals(Index input) const;
    [[nodiscard]] bool holds(Index mark, Index input) const;
    [[nodiscard]] Index point_at(Index v, Index mark, Index left_mark) const;
    // Ring, number and place of a point, for messages.
    struct Name {
        char text[128];
    };
    [[nodiscard]] Name name_of(Index input) const;

    const Polygon* polygon_ = nullptr;
    double scale_ = 1.0;
    HalfEdgeMesh mesh_;
    DelaunayScratch scratch_;
    SpatialOrder order_;
    Vector<glm::dvec2> scaled_;
    Vector<glm::dvec2> points_;
    Vector<std::uint32_t> codes_;
    Vector<Index> vertex_of_;       // input point → vertex
    Vector<Index> input_of_;        // vertex → its first input point
    Vector<std::uint8_t> shared_;   // vertex → whether several input points lie there
    Vector<Index> next_vertex_;     // vertex → the one after its first input point, where the other way is no edge
    Vector<std::uint8_t> present_;  // vertices whose edge to the next one is in the Delaunay triangulation
    Vector<Record> records_;        // the explicit ones
    bool has_split_edges_ = false;  // by a vertex of another edge
    Vector<std::uint8_t> left_inside_;  // vertices of rings with the inside on their left
    Vector<std::uint8_t> inside_;       // of every triangle: 0, 1 or kUnreached
    Vector<State> regions_;
    Vector<Index> queue_;
    Vector<Border> borders_;
    std::size_t border_count_ = 0;
    Vector<Index> crossed_rings_;
    std::size_t inside_count_ = 0;
};

}  // namespace crofton::triangulate
