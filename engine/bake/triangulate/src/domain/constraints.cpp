// SPDX-License-Identifier: MIT
// Inserts a polygon's edges into a Delaunay triangulation by edge flips.
#include <algorithm>
#include <crofton/core/error.hpp>
#include <crofton/geometry/predicates.hpp>

#include "domain/half_edge_mesh.hpp"

namespace crofton::triangulate {

Index ConstraintInserter::advance(Index a, Index b, Crossing& crossing) {
    if (const Index e = existing(a, b); e != kNone) return e;
    Index through = kNone;
    const Index crossed = first_crossed(a, b, through);
    if (through != kNone) return through;
    return carve(a, b, crossed, crossing);
}

// The half-edge from a to b, when there is one; behind the hull its twin's twin is missing, so both ends are tried.
Index ConstraintInserter::existing(Index a, Index b) const {
    const Index start = mesh_.vertex_edge[a];
    Index e = start;
    do {
        if (mesh_.destination(e) == b) return e;
        const Index back = previous(e);
        e = mesh_.twin[back];
        if (e == kNone && mesh_.origin[back] == b) return back;
    } while (e != start && e != kNone);
    return kNone;
}

// The edge opposite a that the segment to b crosses, or in `through` the half-edge to a vertex in its interior.
Index ConstraintInserter::first_crossed(Index a, Index b, Index& through) const {
    const auto& points = mesh_.points;
    const auto& from = points[a];
    const auto& to = points[b];
    // Of the two neighbours that are collinear with a and b, only the one towards b counts.
    const auto ahead = [&](Index v) {
        return from.x != to.x ? (points[v].x > from.x) == (to.x > from.x) : (points[v].y > from.y) == (to.y > from.y);
    };
    Index e = mesh_.vertex_edge[a];
    int right = orientation(from, to, points[mesh_.destination(e)]);
    if (right == 0 && ahead(mesh_.destination(e))) {
        through = e;
        return kNone;
    }
    while (true) {
        const Index left_vertex = mesh_.apex(e);
        const int left = orientation(from, to, points[left_vertex]);
        if (left == 0 && ahead(left_vertex)) {
            through = previous(e);
            return kNone;
        }
        if (right < 0 && left > 0) return next(e);
        right = left;
        e = mesh_.rotate(e);
        CROFTON_ASSERT(e != kNone, "the segment leaves its end through a triangle");
    }
}

// Walks over the triangles that the segment from a enters through `crossed`, which runs from its right side to its
// left, up to b or the first vertex on the segment, and replaces them. Returns the half-edge from a to there.
Index ConstraintInserter::carve(Index a, Index b, Index crossed, Crossing& crossing) {
    CavityChain &upper = scratch_.upper, &lower = scratch_.lower;
    const auto start = [&](CavityChain& chain) {
        chain.vertices.assign(1, a);
        chain.edges.clear();
    };
    const auto extend = [&](CavityChain& chain, Index e, Index v) {
        chain.edges.push_back({e, mesh_.twin[e], mesh_.mark[e], kNone});
        chain.vertices.push_back(v);
    };
    start(upper);
    start(lower);
    extend(upper, next(crossed), mesh_.destination(crossed));
    extend(lower, previous(crossed), mesh_.origin[crossed]);
    scratch_.cavity.assign(1, crossed & ~3u);
    for (bool arrived = false; !arrived;) {
        if (mesh_.mark[crossed] != 0) {
            crossing = {true, mesh_.mark[crossed]};
            return kNone;
        }
        const Index e = mesh_.twin[crossed];
        const Index v = mesh_.apex(e);
        scratch_.cavity.push_back(e & ~3u);
        const int side = v == b ? 0 : orientation(mesh_.points[a], mesh_.points[b], mesh_.points[v]);
        if (side >= 0) extend(upper, previous(e), v);
        if (side <= 0) extend(lower, next(e), v);
        crossed = side > 0 ? next(e) : previous(e);
        arrived = side == 0;
    }
    // So that both cavities lie on the left of their bases, from the first vertex to the last.
    std::reverse(lower.vertices.begin(), lower.vertices.end());
    std::reverse(lower.edges.begin(), lower.edges.end());
    for (auto* chain : {&upper, &lower}) {
        for (const auto& edge : chain->edges) mesh_.origin[edge.inner | 3u] = 0;  // the triangle is inside the cavity
    }
    const Index above = fill(upper, scratch_.cavity.data());
    const Index below = fill(lower, scratch_.cavity.data() + (upper.vertices.size() - 2));
    mesh_.link(above, below);
    reconnect(upper);
    reconnect(lower);
    repair_vertex_edges();
    return above;
}

// Triangulates the polygon on the left of first → last vertex of the chain and returns that half-edge. Every vertex
// sees its base, for a crossed edge of the old triangulation joined it to the other side. So the apex whose circle with
// the base holds no other vertex gives a constrained Delaunay triangle.
Index ConstraintInserter::fill(CavityChain& chain, Index* triangles) {
    const auto& points = mesh_.points;
    const auto& vertices = chain.vertices;
    auto& bases = scratch_.bases;
    Index outermost = kNone;
    bases.assign(1, {0, static_cast<Index>(vertices.size() - 1), kNone});
    while (!bases.empty()) {
        const auto [low, high, half_edge] = bases.back();
        bases.pop_back();
        if (high == low + 1) {
            chain.edges[low].fresh = half_edge;
            continue;
        }
        Index middle = low + 1;
        for (Index k = low + 2; k < high; ++k) {
            const auto& candidate = points[vertices[k]];
            if (in_circle(points[vertices[low]], points[vertices[high]], points[vertices[middle]], candidate) > 0)
                middle = k;
        }
        const Index e = *triangles++;
        mesh_.origin[e] = vertices[low];
        mesh_.origin[e + 1] = vertices[high];
        mesh_.origin[e + 2] = vertices[middle];
        for (Index k = 0; k < 3; ++k) mesh_.mark[e + k] = 0;
        if (half_edge == kNone)
            outermost = e;
        else
            mesh_.link(e, half_edge);
        bases.push_back({low, middle, e + 2});
        bases.push_back({middle, high, e + 1});
    }
    return outermost;
}

// Joins the new triangles to what lies outside. An edge that hangs inside the cavity occurs twice in the chain.
void ConstraintInserter::reconnect(CavityChain& chain) {
    auto& edges = chain.edges;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& edge = edges[i];
        mesh_.mark[edge.fresh] = edge.mark;
        if (edge.outside == kNone) {
            mesh_.twin[edge.fresh] = kNone;
        } else if (mesh_.origin[edge.outside | 3u] == kNone) {
            mesh_.link(edge.fresh, edge.outside);
        } else {
            for (std::size_t j = i + 1; j < edges.size(); ++j) {
                if (edges[j].inner == edge.outside) {
                    mesh_.link(edge.fresh, edges[j].fresh);
                    break;
                }
            }
        }
    }
}

// A vertex keeps an edge along the hull; any other one is replaced, since it may have been removed.
void ConstraintInserter::repair_vertex_edges() {
    for (const Index triangle : scratch_.cavity) {
        mesh_.origin[triangle | 3u] = kNone;
        for (Index e = triangle; e < triangle + 3; ++e) {
            Index& edge = mesh_.vertex_edge[mesh_.origin[e]];
            const bool along_hull = mesh_.origin[edge] == mesh_.origin[e] && mesh_.twin[edge] == kNone;
            if (!along_hull || mesh_.twin[e] == kNone) edge = e;
        }
    }
}

}  // namespace crofton::triangulate
