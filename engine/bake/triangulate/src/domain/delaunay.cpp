// SPDX-License-Identifier: MIT
#include <bit>
#include <crofton/geometry/predicates.hpp>

#include "domain/half_edge_mesh.hpp"

// Guibas and Stolfi's divide and conquer ("Primitives for the manipulation of general subdivisions", 1985) with
// alternating cuts (Dwyer 1987), on triangles with ghosts (Shewchuk 1996): the outside of a triangulation is covered
// by one ghost triangle for each side of the hull, whose third corner, kNone, lies at infinity. n points, collinear or
// not, then have 2n − 2 triangles. So each part of the points has its own place in memory, and a merge adds two.

namespace crofton::triangulate {
namespace {

// A hull vertex by the half-edge that arrives there in the ghost on the hull's side leaving it counter-clockwise; kNone
// while it is alone.
struct HullVertex {
    Index vertex, ghost;
};

// The first and last vertices along x (then y) and along y (then x).
struct Hull {
    HullVertex low_x, high_x, low_y, high_y;
};

class DivideAndConquer {
  public:
    DivideAndConquer(HalfEdgeMesh& mesh, std::span<const std::uint32_t> codes) : mesh_(mesh), codes_(codes) {}

    // Returns a ghost.
    Index run() {
        const auto count = static_cast<Index>(mesh_.points.size());
        return triangulate(0, count).low_x.ghost;
    }

  private:
    [[nodiscard]] const glm::dvec2& at(Index vertex) const { return mesh_.points[vertex]; }
    [[nodiscard]] bool before_in_x(Index a, Index b) const {
        const auto &p = at(a), &q = at(b);
        return p.x < q.x || (p.x == q.x && p.y < q.y);
    }
    [[nodiscard]] bool before_in_y(Index a, Index b) const {
        const auto &p = at(a), &q = at(b);
        return p.y < q.y || (p.y == q.y && p.x < q.x);
    }
    // The ghosts on the next and the previous side of the hull, counter-clockwise.
    [[nodiscard]] Index next_ghost(Index ghost) const { return previous(mesh_.twin[previous(ghost)]); }
    [[nodiscard]] Index previous_ghost(Index ghost) const { return next(mesh_.twin[next(ghost)]); }

    // The points [begin, end), in triangles [2 begin, 2 end − 2). The depth is at most 32 for the bits of a code and 29
    // for the halves of a cell.
    Hull triangulate(Index begin, Index end) {
        if (end - begin == 1) {
            const HullVertex v{begin, kNone};
            return {v, v, v, v};
        }
        if (end - begin == 2) return join_two(begin);
        if (end - begin == 3) {
            const int side = orientation(at(begin), at(begin + 1), at(begin + 2));
            if (side != 0)
                return side > 0 ? join_three(begin, begin + 1, begin + 2) : join_three(begin, begin + 2, begin + 1);
        }
        const std::uint32_t differing = codes_[begin] ^ codes_[end - 1];
        const Index cut =
            differing == 0 ? begin + (end - begin) / 2 : first_beyond(begin, end, std::bit_floor(differing));
        Hull low = triangulate(begin, cut), high = triangulate(cut, end);
        const bool across = differing == 0 || (std::bit_width(differing) & 1) == 0;
        return across ? merge_in_x(low, high, cut) : merge_in_y(low, high, cut);
    }

    // The first point whose code has this bit; all have the same higher ones.
    [[nodiscard]] Index first_beyond(Index begin, Index end, std::uint32_t bit) const {
        while (begin < end) {
            const Index middle = begin + (end - begin) / 2;
            if ((codes_[middle] & bit) != 0)
                end = middle;
            else
                begin = middle + 1;
        }
        return begin;
    }

    void set_triangle(Index e, Index a, Index b, Index c) {
        mesh_.origin[e] = a;
        mesh_.origin[e + 1] = b;
        mesh_.origin[e + 2] = c;
        mesh_.origin[e + 3] = kNone;
    }

    Hull join_two(Index a) {
        const Index b = a + 1, e = 8 * a, f = e + 4;
        set_triangle(e, b, a, kNone);
        set_triangle(f, a, b, kNone);
        mesh_.link(e, f);
        mesh_.link(e + 1, f + 2);
        mesh_.link(e + 2, f + 1);
        const HullVertex at_a{a, e}, at_b{b, f};
        const bool in_x = before_in_x(a, b), in_y = before_in_y(a, b);
        return {in_x ? at_a : at_b, in_x ? at_b : at_a, in_y ? at_a : at_b, in_y ? at_b : at_a};
    }

    // Counter-clockwise; a is the first of the three.
    Hull join_three(Index a, Index b, Index c) {
        const Index e = 8 * a, ab = e + 4, bc = e + 8, ca = e + 12;
        set_triangle(e, a, b, c);
        set_triangle(ab, b, a, kNone);
        set_triangle(bc, c, b, kNone);
        set_triangle(ca, a, c, kNone);
        mesh_.link(e, ab);
        mesh_.link(e + 1, bc);
        mesh_.link(e + 2, ca);
        mesh_.link(next(ab), previous(ca));
        mesh_.link(next(bc), previous(ab));
        mesh_.link(next(ca), previous(bc));
        Hull hull{{a, ab}, {a, ab}, {a, ab}, {a, ab}};
        for (const HullVertex v : {HullVertex{b, bc}, HullVertex{c, ca}}) {
            hull.low_x = before_in_x(v.vertex, hull.low_x.vertex) ? v : hull.low_x;
            hull.high_x = before_in_x(v.vertex, hull.high_x.vertex) ? hull.high_x : v;
            hull.low_y = before_in_y(v.vertex, hull.low_y.vertex) ? v : hull.low_y;
            hull.high_y = before_in_y(v.vertex, hull.high_y.vertex) ? hull.high_y : v;
        }
        return hull;
    }

    Hull merge_in_x(const Hull& left, const Hull& right, Index cut) {
        Hull hull{left.low_x, right.high_x,
                  before_in_y(left.low_y.vertex, right.low_y.vertex) ? left.low_y : right.low_y,
                  before_in_y(left.high_y.vertex, right.high_y.vertex) ? right.high_y : left.high_y};
        update(hull, merge(left.high_x, right.low_x, cut));
        return hull;
    }

    // As seen with the head on the right shoulder.
    Hull merge_in_y(const Hull& low, const Hull& high, Index cut) {
        Hull hull{before_in_x(low.low_x.vertex, high.low_x.vertex) ? low.low_x : high.low_x,
                  before_in_x(low.high_x.vertex, high.high_x.vertex) ? high.high_x : low.high_x, low.low_y,
                  high.high_y};
        update(hull, merge(low.high_y, high.low_y, cut));
        return hull;
    }

    // The ends of the hull's two new sides that these sides leave.
    struct Seam {
        HullVertex bottom, top;
    };

    static void update(Hull& hull, const Seam& seam) {
        for (HullVertex* v : {&hull.low_x, &hull.high_x, &hull.low_y, &hull.high_y}) {
            if (v->vertex == seam.bottom.vertex) v->ghost = seam.bottom.ghost;
            if (v->vertex == seam.top.vertex) v->ghost = seam.top.ghost;
        }
    }

    // Joins two triangulations that a line separates, from their lower common tangent up to the upper one, "up" being
    // left of the way from the first to the second. `left` and `right` must be extreme towards each other.
    Seam merge(HullVertex left, HullVertex right, Index cut) {
        find_lower_tangent(left, right);
        const Index bottom = 8 * cut - 8, top = bottom + 4;
        set_triangle(bottom, right.vertex, left.vertex, kNone);
        // The ghosts next to the seam: on the sides that leave the left end and arrive at the right end of the base.
        Index l = bottom, r = bottom;
        if (left.ghost != kNone) {
            l = left.ghost;
            mesh_.link(bottom + 1, previous(previous_ghost(l)));
        }
        if (right.ghost != kNone) {
            r = previous_ghost(right.ghost);
            mesh_.link(bottom + 2, next(right.ghost));
        }
        Index u = left.vertex, v = right.vertex;
        const Index base = raise(bottom, l, r, u, v);
        set_triangle(top, u, v, kNone);
        mesh_.link(top, base);
        mesh_.link(top + 1, previous(r));
        mesh_.link(top + 2, next(l));
        return {{left.vertex, bottom}, {v, top}};
    }

    void find_lower_tangent(HullVertex& left, HullVertex& right) const {
        for (bool moved = true; moved;) {
            moved = false;
            while (left.ghost != kNone) {
                const Index e = previous_ghost(left.ghost);
                const Index v = mesh_.destination(e);
                if (orientation(at(left.vertex), at(right.vertex), at(v)) >= 0) break;
                left = {v, e};
                moved = true;
            }
            while (right.ghost != kNone) {
                const Index v = mesh_.origin[right.ghost];
                if (orientation(at(left.vertex), at(right.vertex), at(v)) >= 0) break;
                right = {v, next_ghost(right.ghost)};
                moved = true;
            }
        }
    }

    // From base to base until none is above; `base` runs from right end v to left end u, the free side on its right.
    // The next triangle's apex is the neighbour of u or v along the seam whose circle through u and v holds no other
    // vertex. Sides of the old hulls that hide it are flipped away with infinity.
    Index raise(Index base, Index& l, Index& r, Index& u, Index& v) {
        while (true) {
            // With u last, its differences are shared.
            const bool left = orientation(at(v), at(mesh_.origin[l]), at(u)) > 0;
            const bool right = orientation(at(v), at(mesh_.destination(r)), at(u)) > 0;
            if (!left && !right) return base;
            if (left) open_left(l, u, v);
            if (right) open_right(r, u, v);
            const bool take_right =
                !left || (right && in_circle(at(u), at(v), at(mesh_.origin[l]), at(mesh_.destination(r))) > 0);
            if (take_right) {
                const Index e = r, w = mesh_.destination(e);
                r = previous_ghost(e);
                mesh_.origin[previous(e)] = u;
                mesh_.link(previous(e), base);
                base = next(e);
                v = w;
            } else {
                const Index e = l, w = mesh_.origin[e];
                l = next_ghost(e);
                mesh_.origin[previous(e)] = v;
                mesh_.link(next(e), base);
                base = previous(e);
                u = w;
            }
        }
    }

    // While the circle through u, v and the end of l's side holds the apex behind that side, the side goes. Its
    // triangle becomes a ghost, and l lies on the side from u to the apex.
    void open_left(Index l, Index u, Index v) {
        while (true) {
            const Index t = mesh_.twin[l], x = mesh_.apex(t);
            if (x == kNone || in_circle(at(u), at(v), at(mesh_.origin[l]), at(x)) <= 0) return;
            const Index beyond = mesh_.twin[previous(l)];
            mesh_.origin[l] = x;
            mesh_.link(l, mesh_.twin[previous(t)]);
            mesh_.origin[t] = kNone;
            mesh_.link(t, beyond);
            mesh_.link(previous(t), previous(l));
        }
    }

    void open_right(Index r, Index u, Index v) {
        while (true) {
            const Index t = mesh_.twin[r], x = mesh_.apex(t);
            if (x == kNone || in_circle(at(u), at(v), at(mesh_.destination(r)), at(x)) <= 0) return;
            const Index beyond = mesh_.twin[next(r)];
            mesh_.origin[next(r)] = x;
            mesh_.link(r, mesh_.twin[next(t)]);
            mesh_.origin[next(t)] = kNone;
            mesh_.link(t, beyond);
            mesh_.link(next(t), next(r));
        }
    }

    HalfEdgeMesh& mesh_;
    std::span<const std::uint32_t> codes_;
};

// Moves triangle e (its first half-edge) to place f.
void move_triangle(HalfEdgeMesh& mesh, Index e, Index f) {
    for (Index k = 0; k < 3; ++k) {
        mesh.origin[f + k] = mesh.origin[e + k];
        mesh.link(f + k, mesh.twin[e + k]);
    }
}

// Fills the places of the ghosts with triangles from the end.
void remove_ghosts(HalfEdgeMesh& mesh, Index ghost, Vector<Index>& ghosts) {
    ghosts.clear();
    const Index start = ghost;
    do {
        ghosts.push_back(ghost & ~3u);
        ghost = previous(mesh.twin[previous(ghost)]);
    } while (ghost != start);
    for (const Index g : ghosts) mesh.origin[g | 3u] = 0;  // a ghost
    for (const Index g : ghosts) {
        for (Index e = g; e < g + 3; ++e) {
            if ((mesh.origin[mesh.twin[e] | 3u]) == kNone) mesh.twin[mesh.twin[e]] = kNone;
        }
    }
    Index end = static_cast<Index>(mesh.origin.size());
    const Index kept = end - 4 * static_cast<Index>(ghosts.size());
    for (const Index g : ghosts) {
        if (g >= kept) continue;
        do {
            end -= 4;
        } while (mesh.origin[end | 3u] != kNone);
        move_triangle(mesh, end, g);
        mesh.origin[g | 3u] = kNone;
    }
    mesh.origin.resize(kept);
    mesh.twin.resize(kept);
}

}  // namespace

void delaunay(HalfEdgeMesh& mesh, std::span<const std::uint32_t> codes, DelaunayScratch& scratch) {
    const std::size_t count = mesh.points.size(), slots = count < 3 ? 0 : 8 * count - 8;
    mesh.origin.resize(slots);
    mesh.twin.resize(slots);
    if (slots != 0) remove_ghosts(mesh, DivideAndConquer(mesh, codes).run(), scratch.cavity);
}

}  // namespace crofton::triangulate
