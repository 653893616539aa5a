// SPDX-License-Identifier: MIT
#include "pvs_svg.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

namespace crofton::cli {
namespace {

constexpr double kMapWidth = 1200.0;

class Map {
  public:
    Map(const pvs::Pvs& pvs, const pvs::BakeGeometry& geometry, std::uint32_t cell)
        : pvs_(pvs), geometry_(geometry), cell_(cell), bounds_(pvs.cells().bounds()) {
        const glm::dvec3 room = 0.1 * (bounds_.max - bounds_.min);
        bounds_.min -= room, bounds_.max += room;
        scale_ = kMapWidth / (bounds_.max.x - bounds_.min.x);
    }

    std::string draw() {
        const double height = scale_ * (bounds_.max.z - bounds_.min.z);
        print("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' width='%.0f' height='%.0f'>\n",
              kMapWidth, height, kMapWidth, height);
        svg_ += "<rect width='100%' height='100%' fill='#ffffff'/>\n";
        objects();
        cells();
        legend();
        svg_ += "</svg>\n";
        return std::move(svg_);
    }

  private:
    template <class... Numbers>
    void print(const char* format, Numbers... numbers) {
        char text[256];
        std::snprintf(text, sizeof text, format, numbers...);
        svg_ += text;
    }

    static const char* color_of(pvs::PairState state) {
        if (state == pvs::PairState::hidden) return "#d4d8dd";
        return state == pvs::PairState::unseen ? "#f0d48a" : "#4caf78";
    }

    // An object from above: the ring of its box around that axis which is nearest to the vertical.
    static std::array<glm::dvec3, 4> ring_of(const Obb& box) {
        int up = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(box.axes[k].y) > std::abs(box.axes[up].y)) up = k;
        const glm::dvec3 a = glm::dvec3(box.axes[(up + 1) % 3]) * double(box.half_extents[(up + 1) % 3]);
        const glm::dvec3 b = glm::dvec3(box.axes[(up + 2) % 3]) * double(box.half_extents[(up + 2) % 3]);
        return {box.center - a - b, box.center + a - b, box.center + a + b, box.center - a + b};
    }

    // The largest first: the ground must not cover what stands on it.
    void objects() {
        std::vector<std::pair<double, std::uint32_t>> order;
        for (std::uint32_t o = 0; o < geometry_.boxes.size(); ++o) {
            if (!pvs_.is_baked(o)) continue;
            const auto ring = ring_of(geometry_.boxes[o]);
            order.emplace_back(-glm::length(glm::cross(ring[1] - ring[0], ring[3] - ring[0])), o);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [size, o] : order) {
            const auto ring = ring_of(geometry_.boxes[o]);
            svg_ += "<path d='";
            for (std::size_t i = 0; i < 4; ++i) print(i ? "L%.1f %.1f" : "M%.1f %.1f", x(ring[i]), z(ring[i]));
            print("Z' fill='%s' stroke='#00000055' stroke-width='0.5'/>\n", color_of(pvs_.state(cell_, o)));
        }
    }

    void legend() {
        constexpr pvs::PairState states[] = {pvs::PairState::seen, pvs::PairState::unseen, pvs::PairState::hidden};
        constexpr const char* names[] = {"seen from the red cell", "unseen, so far", "proved hidden"};
        svg_ += "<rect x='8' y='8' width='190' height='74' fill='#ffffffdd' stroke='#888888' stroke-width='0.5'/>\n";
        for (int i = 0; i < 3; ++i) {
            print("<rect x='16' y='%d' width='16' height='14' fill='%s' stroke='#00000055'/>", 16 + 22 * i,
                  color_of(states[i]));
            print("<text x='40' y='%d' font-family='sans-serif' font-size='14'>%s</text>\n", 28 + 22 * i, names[i]);
        }
    }

    void cells() {
        const Aabb own = pvs_.cells().box(cell_);
        for (std::size_t c = 0; c < pvs_.cells().size(); ++c) {
            const Aabb box = pvs_.cells().box(c);
            if (box.max.y <= own.min.y || box.min.y >= own.max.y || c == cell_) continue;
            outline(c, pvs_.kind(c) == pvs::CellKind::solid ? "#00000066" : "none", "#5577aa55", 0.4);
        }
        outline(cell_, "#d0202088", "#d02020", 2.0);
    }

    // A cell from above: the hull of its corners.
    void outline(std::size_t cell, const char* fill, const char* stroke, double width) {
        svg_ += "<path d='";
        const auto ring = ring_of(pvs_.cells().corners(cell));
        for (std::size_t i = 0; i < ring.size(); ++i) print(i ? "L%.1f %.1f" : "M%.1f %.1f", x(ring[i]), z(ring[i]));
        print("Z' fill='%s' stroke='%s' stroke-width='%.1f'/>\n", fill, stroke, width);
    }

    // Andrew's monotone chain, from above.
    static std::vector<glm::dvec3> ring_of(const pvs::ConvexCell& cell) {
        auto corners = cell.corners;
        std::sort(corners.begin(), corners.end(),
                  [](const auto& p, const auto& q) { return p.x != q.x ? p.x < q.x : p.z < q.z; });
        std::vector<glm::dvec3> ring;
        for (const bool back : {false, true}) {
            const std::size_t first = ring.size();
            for (const glm::dvec3& p : corners) {
                while (ring.size() >= first + 2) {
                    const glm::dvec3 &a = ring[ring.size() - 2], &b = ring.back();
                    if ((b.x - a.x) * (p.z - a.z) - (b.z - a.z) * (p.x - a.x) > 0.0) break;
                    ring.pop_back();
                }
                ring.push_back(p);
            }
            if (!back) std::reverse(corners.begin(), corners.end());
            ring.pop_back();
        }
        return ring;
    }

    [[nodiscard]] double x(const glm::dvec3& p) const { return scale_ * (p.x - bounds_.min.x); }
    [[nodiscard]] double z(const glm::dvec3& p) const { return scale_ * (p.z - bounds_.min.z); }

    const pvs::Pvs& pvs_;
    const pvs::BakeGeometry& geometry_;
    std::uint32_t cell_;
    Aabb bounds_;
    double scale_ = 1.0;
    std::string svg_;
};

}  // namespace

std::string pvs_svg(const pvs::Pvs& pvs, const pvs::BakeGeometry& geometry, std::uint32_t cell) {
    return Map(pvs, geometry, cell).draw();
}

}  // namespace crofton::cli
