// SPDX-License-Identifier: MIT
// The faces that the certain edges of a candidate graph leave to be triangulated.
#pragma once
#include "minimum_weight/candidate_graph.hpp"

namespace crofton::triangulate {

// Closed walks along certain half-edges with a face on the left: walk w is half_edges[begin[w] … begin[w + 1]).
// A face has one walk, or several if the certain edges do not connect its boundary.
struct Faces {
    Vector<Index> half_edges;
    Vector<Index> begin;
    Vector<Index> walk_of;    // of every half-edge: the walk it belongs to (certain) or runs from (candidate)
    Vector<Index> isolated;   // vertices without certain edges; their half-edges' walk_of is walk_count() + position
    Vector<Index> component;  // of every walk and isolated vertex: the face it bounds, named by one of them
    Vector<Index> component_size;  // of every walk and isolated vertex that names a face: how many bound it

    [[nodiscard]] std::size_t walk_count() const { return begin.size() - 1; }
    [[nodiscard]] std::span<const Index> walk(std::size_t w) const {
        return std::span<const Index>(half_edges).subspan(begin[w], begin[w + 1] - begin[w]);
    }
};

// Whether the face of this walk lies inside it, that is, whether the walk is its face's outer boundary. Exact: at the
// walk's first vertex in lexicographic order the corners of an outer boundary are convex, and a hole's boundary has one
// that is not.
[[nodiscard]] bool is_outer(std::span<const glm::dvec2> points, const CandidateGraph& graph,
                            std::span<const Index> walk);

// Edges are certain if they have a flag of `certain_mask`; dead ones do not count. Walks and isolated vertices
// that living candidates join bound the same face.
void find_faces(const CandidateGraph& graph, std::uint8_t certain_mask, Faces& faces);

}  // namespace crofton::triangulate
