#include <crofton/geometry/predicates.hpp>

#include "half_edge_mesh.hpp"

namespace crofton::triangulate {

Index HalfEdgeMesh::add_triangle(Index a, Index b, Index c) {
    const auto e = static_cast<Index>(origin.size());
    origin.insert(origin.end(), {a, b, c, kNone});
    twin.insert(twin.end(), {kNone, kNone, kNone, kNone});
    return e;
}

// With a: u→w in (u, w, x) and b: w→u in (w, u, y), the slots become a: y→w, next: w→x, previous: x→y and
// b: x→u, next: u→y, previous: y→x.
void HalfEdgeMesh::flip(Index a) {
    const Index b = twin[a];
    const Index a_previous = previous(a), b_previous = previous(b);
    const Index u = origin[a], w = origin[b], x = origin[a_previous], y = origin[b_previous];
    if (vertex_edge[u] == a) vertex_edge[u] = next(b);
    if (vertex_edge[w] == b) vertex_edge[w] = next(a);
    origin[a] = y;
    origin[b] = x;
    const Index yw = twin[b_previous], xu = twin[a_previous];
    link(a, yw);
    link(b, xu);
    link(a_previous, b_previous);
    // Keeps a hull vertex's edge the one along the hull.
    if (yw == kNone) vertex_edge[y] = a;
    if (xu == kNone) vertex_edge[x] = b;
    if (!mark.empty()) {
        mark[a] = mark[b_previous];
        mark[b] = mark[a_previous];
        mark[a_previous] = mark[b_previous] = 0;
    }
}

namespace {

class Sweep {
  public:
    Sweep(HalfEdgeMesh& mesh, DelaunayScratch& scratch) : mesh_(mesh), points_(mesh.points), scratch_(scratch) {}

    void run() {
        const auto count = static_cast<Index>(points_.size());
        mesh_.origin.clear();
        mesh_.twin.clear();
        mesh_.mark.clear();
        scratch_.stack.clear();
        mesh_.vertex_edge.assign(count, kNone);
        scratch_.hull_next.resize(count);
        scratch_.hull_previous.resize(count);
        mesh_.origin.reserve(8 * points_.size());
        mesh_.twin.reserve(8 * points_.size());
        Index first = 2;
        int side = 0;
        while (first < count && (side = orientation(points_[0], points_[1], points_[first])) == 0) ++first;
        if (first >= count) return;
        start_fan(first, side);
        for (Index p = first + 1; p < count; ++p) add_point(p);
        mesh_.mark.assign(mesh_.origin.size(), 0);
    }

  private:
    void join(Index from, Index to) {
        scratch_.hull_next[from] = to;
        scratch_.hull_previous[to] = from;
    }

    // Points 0 … first − 1 are collinear; each consecutive pair spans a triangle with `first`, and that is Delaunay.
    void start_fan(Index first, int side) {
        Index inner = kNone;
        for (Index i = 0; i + 1 < first; ++i) {
            const Index e = side > 0 ? mesh_.add_triangle(i, i + 1, first) : mesh_.add_triangle(i + 1, i, first);
            const Index entry = side > 0 ? next(next(e)) : next(e), exit = side > 0 ? next(e) : next(next(e));
            mesh_.link(entry, inner);
            inner = exit;
            mesh_.vertex_edge[side > 0 ? i : i + 1] = e;
            side > 0 ? join(i, i + 1) : join(i + 1, i);
            if (i == 0) mesh_.vertex_edge[side > 0 ? first : 0] = entry;
            if (i + 2 == first) mesh_.vertex_edge[side > 0 ? i + 1 : first] = exit;
        }
        join(side > 0 ? first - 1 : 0, first);
        join(first, side > 0 ? 0 : first - 1);
    }

    [[nodiscard]] bool sees(Index p, Index from, Index to) const {
        return orientation(points_[from], points_[to], points_[p]) < 0;
    }

    // p lies right of everything so far, so it sees the last point, and the hull edges it sees are contiguous there.
    void add_point(Index p) {
        Index begin = p - 1;
        while (sees(p, scratch_.hull_previous[begin], begin)) begin = scratch_.hull_previous[begin];
        Index v = begin, inner = kNone;
        bool known = begin != p - 1;
        while (true) {
            if (v == p - 1) known = false;
            const Index w = scratch_.hull_next[v];
            if (!known && !sees(p, v, w)) break;
            const Index hull = mesh_.vertex_edge[v];
            const Index e = mesh_.add_triangle(w, v, p);
            mesh_.link(e, hull);
            mesh_.link(e + 1, inner);
            if (inner == kNone) first_edge_ = e + 1;
            inner = e + 2;
            scratch_.stack.push_back(e);
            v = w;
        }
        mesh_.vertex_edge[begin] = first_edge_;
        mesh_.vertex_edge[p] = inner;
        join(begin, p);
        join(p, v);
        legalize();
    }

    // Every edge on the stack lies opposite the newest point.
    void legalize() {
        while (!scratch_.stack.empty()) {
            const Index e = scratch_.stack.back();
            scratch_.stack.pop_back();
            const Index f = mesh_.twin[e];
            if (f == kNone) continue;
            const auto& u = points_[mesh_.origin[e]];
            const auto& w = points_[mesh_.origin[f]];
            if (in_circle(u, w, points_[mesh_.apex(e)], points_[mesh_.apex(f)]) <= 0) continue;
            mesh_.flip(e);
            scratch_.stack.push_back(e);
            scratch_.stack.push_back(next(f));
        }
    }

    HalfEdgeMesh& mesh_;
    std::span<const glm::dvec2> points_;
    DelaunayScratch& scratch_;
    Index first_edge_ = kNone;
};

}  // namespace

void delaunay(HalfEdgeMesh& mesh, DelaunayScratch& scratch) {
    Sweep(mesh, scratch).run();
}

}  // namespace crofton::triangulate
