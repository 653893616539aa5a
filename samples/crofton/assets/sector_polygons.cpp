// SPDX-License-Identifier: MIT
#include "assets/sector_polygons.hpp"

#include <algorithm>
#include <unordered_map>

namespace crofton::assets {
namespace {

using Vertex = WadLevel::Vertex;
using Ring = std::vector<std::uint32_t>;  // vertices

struct Edge {
    std::uint32_t from, to;
    bool used = false;
};

// All exact: coordinates are integers below 2^30, so differences are below 2^31.
using Wide = std::int64_t;

Wide difference(int a, int b) {
    return Wide{a} - b;
}
Wide cross(const Vertex& o, const Vertex& a, const Vertex& b) {
    return difference(a.x, o.x) * difference(b.y, o.y) - difference(a.y, o.y) * difference(b.x, o.x);
}
Wide dot(const Vertex& o, const Vertex& a, const Vertex& b) {
    return difference(a.x, o.x) * difference(b.x, o.x) + difference(a.y, o.y) * difference(b.y, o.y);
}

class SectorTracer {
  public:
    SectorTracer(const WadLevel& level, std::vector<Edge> edges) : level_(level), edges_(std::move(edges)) {
        for (std::size_t e = 0; e < edges_.size(); ++e) outgoing_[edges_[e].from].push_back(e);
    }

    SectorPolygons trace() {
        std::vector<Ring> rings;
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            if (edges_[e].used) continue;
            Ring ring;
            if (!walk(e, ring)) return {{}, "its lines do not close around vertex " + std::to_string(ring.back())};
            split(ring, rings);
        }
        return assemble(turned_outward(rings));
    }

  private:
    // Lines that all face away from a sector would leave it the rest of the world: they are taken to bound it.
    std::vector<Ring> turned_outward(std::vector<Ring> rings) const {
        const auto is_outline = [&](const Ring& ring) { return doubled_area(ring) > 0.0; };
        if (rings.size() == 1 && !is_outline(rings[0])) std::reverse(rings[0].begin(), rings[0].end());
        return rings;
    }

    const Vertex& at(std::uint32_t v) const { return level_.vertices[v]; }

    // Follows edges from `first` until back at its start; false at a dead end.
    bool walk(std::size_t first, Ring& ring) {
        const std::uint32_t start = edges_[first].from;
        for (std::size_t e = first;;) {
            edges_[e].used = true;
            ring.push_back(edges_[e].from);
            const std::uint32_t here = edges_[e].to;
            if (here == start) return true;
            const std::size_t next = sharpest_left(edges_[e].from, here);
            if (next == kNoEdge) {
                ring.push_back(here);
                return false;
            }
            e = next;
        }
    }

    // The unused edge out of `here` that comes first when turning clockwise from the way back to `from`.
    std::size_t sharpest_left(std::uint32_t from, std::uint32_t here) {
        const auto found = outgoing_.find(here);
        if (found == outgoing_.end()) return kNoEdge;
        std::size_t best = kNoEdge;
        for (const std::size_t e : found->second) {
            if (edges_[e].used) continue;
            if (best == kNoEdge || clockwise_before(at(here), at(from), at(edges_[e].to), at(edges_[best].to)))
                best = e;
        }
        return best;
    }

    // Whether turning clockwise about o from the direction of `back`, that of `a` comes before that of `b`.
    static bool clockwise_before(const Vertex& o, const Vertex& back, const Vertex& a, const Vertex& b) {
        const auto half = [&](const Vertex& p) {  // 0: less than half a turn clockwise, 1: the rest, the way back last
            const Wide side = cross(o, back, p);
            if (side != 0) return side < 0 ? 0 : 2;
            return dot(o, back, p) < 0 ? 1 : 3;
        };
        const int ha = half(a), hb = half(b);
        return ha != hb ? ha < hb : cross(o, a, b) < 0;
    }

    // Cuts a closed walk into rings that visit each vertex once; rings of two vertices enclose nothing.
    static void split(const Ring& walk, std::vector<Ring>& rings) {
        std::unordered_map<std::uint32_t, std::size_t> position;
        Ring open;
        for (const std::uint32_t v : walk) {
            const auto seen = position.find(v);
            if (seen != position.end()) {
                Ring ring(open.begin() + static_cast<std::ptrdiff_t>(seen->second), open.end());
                for (const std::uint32_t w : ring) position.erase(w);
                open.resize(open.size() - ring.size());
                if (ring.size() >= 3) rings.push_back(std::move(ring));
            }
            position[v] = open.size();
            open.push_back(v);
        }
        if (open.size() >= 3) rings.push_back(std::move(open));
    }

    // Exact for whole map units.
    double doubled_area(const Ring& ring) const {
        double area = 0.0;
        for (std::size_t i = 2; i < ring.size(); ++i)
            area += static_cast<double>(cross(at(ring[0]), at(ring[i - 1]), at(ring[i])));
        return area;
    }

    // −1 outside, 0 on the boundary, 1 inside.
    int side_of(const Vertex& p, const Ring& ring) const {
        bool inside = false;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vertex &a = at(ring[i]), &b = at(ring[(i + 1) % ring.size()]);
            const Wide turn = cross(a, b, p);
            if (turn == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
                p.y <= std::max(a.y, b.y))
                return 0;
            if ((a.y > p.y) != (b.y > p.y) && (turn > 0) == (b.y > a.y)) inside = !inside;
        }
        return inside ? 1 : -1;
    }

    bool encloses(const Ring& outer, const Ring& hole) const {
        for (const std::uint32_t v : hole)
            if (const int side = side_of(at(v), outer); side != 0) return side > 0;
        return true;
    }

    SectorPolygons assemble(const std::vector<Ring>& rings) const {
        struct Outer {
            const Ring* ring;
            double area;
            std::vector<const Ring*> holes;
        };
        std::vector<Outer> outers;
        SectorPolygons result;
        for (const Ring& ring : rings)
            if (const double area = doubled_area(ring); area > 0.0) outers.push_back({&ring, area, {}});
        for (const Ring& ring : rings) {
            if (doubled_area(ring) >= 0.0) continue;
            Outer* home = nullptr;
            for (Outer& outer : outers)
                if ((!home || outer.area < home->area) && encloses(*outer.ring, ring)) home = &outer;
            if (home)
                home->holes.push_back(&ring);
            else
                result.problem = "a hole lies in no outline";
        }
        if (outers.empty()) result.problem = "its lines enclose nothing";
        for (const Outer& outer : outers) {
            Polygon polygon;
            const auto add = [&](const Ring& ring) {
                for (const std::uint32_t v : ring) polygon.points.push_back(level_.position(v));
                polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
            };
            add(*outer.ring);
            for (const Ring* hole : outer.holes) add(*hole);
            result.polygons.push_back(std::move(polygon));
        }
        return result;
    }

    static constexpr std::size_t kNoEdge = ~std::size_t{0};
    const WadLevel& level_;
    std::vector<Edge> edges_;
    std::unordered_map<std::uint32_t, std::vector<std::size_t>> outgoing_;
};

}  // namespace

std::vector<SectorPolygons> sector_polygons(const WadLevel& level) {
    std::vector<std::vector<Edge>> edges(level.sectors.size());
    constexpr std::uint32_t kNoSector = ~std::uint32_t{0};
    const auto sector_of = [&](std::uint32_t side) { return side == kNoSide ? kNoSector : level.sides[side].sector; };
    // Two vertices at one place are one: editors leave such pairs.
    std::unordered_map<std::uint64_t, std::uint32_t> first_at;
    std::vector<std::uint32_t> merged(level.vertices.size());
    for (std::uint32_t v = 0; v < merged.size(); ++v) {
        const std::uint64_t key = static_cast<std::uint32_t>(level.vertices[v].x) |
                                  std::uint64_t{static_cast<std::uint32_t>(level.vertices[v].y)} << 32;
        merged[v] = first_at.try_emplace(key, v).first->second;
    }
    for (const WadLevel::Line& line : level.lines) {
        const std::uint32_t right = sector_of(line.right), left = sector_of(line.left);
        const std::uint32_t from = merged[line.from], to = merged[line.to];
        if (right == left || from == to) continue;
        if (left != kNoSector) edges[left].push_back({from, to});
        if (right != kNoSector) edges[right].push_back({to, from});
    }
    std::vector<SectorPolygons> result;
    result.reserve(edges.size());
    for (auto& around : edges) {
        if (around.empty())
            result.push_back({{}, "no line bounds it"});
        else
            result.push_back(SectorTracer(level, std::move(around)).trace());
    }
    return result;
}

}  // namespace crofton::assets
