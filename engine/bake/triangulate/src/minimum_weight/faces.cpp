// SPDX-License-Identifier: MIT
#include "minimum_weight/faces.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>

namespace crofton::triangulate {

namespace {

void find_walks(const CandidateGraph& graph, std::uint8_t certain_mask, Faces& faces) {
    const auto count = static_cast<Index>(graph.half_edge_count());
    faces.half_edges.clear();
    faces.begin.assign(1, 0);
    faces.walk_of.assign(count, kNone);
    for (Index start = 0; start < count; ++start) {
        if ((graph.flags[start] & certain_mask) == 0 || (graph.flags[start] & CandidateGraph::kLeftOutside) != 0 ||
            faces.walk_of[start] != kNone) {
            continue;
        }
        const auto walk = static_cast<Index>(faces.walk_count());
        Index h = start;
        do {
            faces.half_edges.push_back(h);
            faces.walk_of[h] = walk;
            // Clockwise from the way back, past candidates, to the next certain edge.
            const Index v = graph.destination[h], begin = graph.first[v], end = graph.first[v + 1];
            h = graph.twin[h];
            while (true) {
                h = h == begin ? end - 1 : h - 1;
                if ((graph.flags[h] & certain_mask) != 0) break;
                faces.walk_of[h] = walk;
            }
        } while (h != start);
        faces.begin.push_back(static_cast<Index>(faces.half_edges.size()));
    }
}

void find_isolated(const CandidateGraph& graph, std::uint8_t certain_mask, Faces& faces) {
    faces.isolated.clear();
    for (Index v = 0; v < graph.vertex_count(); ++v) {
        const Index begin = graph.first[v], end = graph.first[v + 1];
        if (begin == end || faces.walk_of[begin] != kNone || faces.walk_of[end - 1] != kNone) continue;
        bool certain = false;
        for (Index h = begin; h < end; ++h) certain = certain || (graph.flags[h] & certain_mask) != 0;
        if (certain) continue;
        for (Index h = begin; h < end; ++h)
            faces.walk_of[h] = static_cast<Index>(faces.walk_count() + faces.isolated.size());
        faces.isolated.push_back(v);
    }
}

Index find_root(Vector<Index>& parent, Index w) {
    while (parent[w] != w) w = parent[w] = parent[parent[w]];
    return w;
}

void find_components(const CandidateGraph& graph, std::uint8_t certain_mask, Faces& faces) {
    const auto count = static_cast<Index>(faces.walk_count() + faces.isolated.size());
    faces.component.resize(count);
    for (Index w = 0; w < count; ++w) faces.component[w] = w;
    for (Index h = 0; h < graph.half_edge_count(); ++h) {
        if ((graph.flags[h] & (CandidateGraph::kDead | certain_mask)) != 0) continue;
        const Index a = faces.walk_of[h], b = faces.walk_of[graph.twin[h]];
        if (a != b) faces.component[find_root(faces.component, a)] = find_root(faces.component, b);
    }
    faces.component_size.assign(count, 0);
    for (Index w = 0; w < count; ++w) ++faces.component_size[faces.component[w] = find_root(faces.component, w)];
}

}  // namespace

void find_faces(const CandidateGraph& graph, std::uint8_t certain_mask, Faces& faces) {
    find_walks(graph, certain_mask, faces);
    find_isolated(graph, certain_mask, faces);
    find_components(graph, certain_mask, faces);
}

bool is_outer(std::span<const glm::dvec2> points, const CandidateGraph& graph, std::span<const Index> walk) {
    const auto precedes = [&](Index a, Index b) {
        const auto &p = points[a], &q = points[b];
        return p.x < q.x || (p.x == q.x && p.y < q.y);
    };
    Index lowest = graph.destination[walk[0]];
    for (const Index h : walk) {
        if (precedes(graph.destination[h], lowest)) lowest = graph.destination[h];
    }
    for (std::size_t i = 0; i < walk.size(); ++i) {
        if (graph.destination[walk[i]] != lowest) continue;
        const Index before = graph.destination[graph.twin[walk[i]]];
        const Index after = graph.destination[walk[i + 1 == walk.size() ? 0 : i + 1]];
        if (orientation(points[before], points[lowest], points[after]) <= 0) return false;
    }
    return true;
}

}  // namespace crofton::triangulate
