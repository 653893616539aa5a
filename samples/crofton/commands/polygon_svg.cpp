// SPDX-License-Identifier: MIT
#include "polygon_svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace crofton::cli {
namespace {

constexpr double kSize = 1600.0, kMargin = 0.04;

struct Frame {
    glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    glm::dvec2 corner{0.0};
    double cell = kSize;

    void include(const Polygon& polygon) {
        for (const auto& p : polygon.points) {
            low = glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y));
            high = glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y));
        }
    }
    // y upwards; halves first, so that the largest doubles do not overflow.
    [[nodiscard]] glm::dvec2 place(const glm::dvec2& p) const {
        const double extent = std::max({high.x / 2 - low.x / 2, high.y / 2 - low.y / 2, 1e-300});
        const double scale = cell * (1.0 - 2.0 * kMargin);
        const glm::dvec2 unit((p.x / 2 - low.x / 2) / extent, (high.y / 2 - p.y / 2) / extent);
        const glm::dvec2 rest((1.0 - (high.x / 2 - low.x / 2) / extent) / 2,
                              (1.0 - (high.y / 2 - low.y / 2) / extent) / 2);
        return corner + cell * kMargin + scale * (unit + rest);
    }
};

void move_to(std::string& path, const glm::dvec2& p, char command) {
    char text[64];
    std::snprintf(text, sizeof text, "%c%.2f %.2f", command, p.x, p.y);
    path += text;
}

void draw(const Polygon& polygon, const triangulate::Triangulation& result, const Frame& frame, double width,
          std::string& svg) {
    std::string rings, diagonals;
    std::set<std::pair<std::uint32_t, std::uint32_t>> boundary, drawn;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const auto ring = polygon.ring(r);
        const std::uint32_t begin = r == 0 ? 0 : polygon.ring_ends[r - 1];
        for (std::uint32_t i = 0; i < ring.size(); ++i) {
            move_to(rings, frame.place(ring[i]), i == 0 ? 'M' : 'L');
            const std::uint32_t a = begin + i, b = i + 1 == ring.size() ? begin : a + 1;
            boundary.insert({std::min(a, b), std::max(a, b)});
        }
        if (!ring.empty()) rings += 'Z';
    }
    for (const auto& t : result.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            const std::pair side(std::min(a, b), std::max(a, b));
            if (boundary.count(side) || !drawn.insert(side).second) continue;
            move_to(diagonals, frame.place(polygon.points[a]), 'M');
            move_to(diagonals, frame.place(polygon.points[b]), 'L');
        }
    }
    char style[128];
    std::snprintf(style, sizeof style, "<path fill='#e8eef7' stroke='#1b2a41' stroke-width='%.3g' d='", 1.5 * width);
    svg += style + rings + "'/>\n";
    std::snprintf(style, sizeof style, "<path fill='none' stroke='#c8553d' stroke-width='%.3g' d='", 0.8 * width);
    if (!diagonals.empty()) svg += style + diagonals + "'/>\n";
}

}  // namespace

std::string draw_svg(std::span<const NamedPolygon> polygons, std::span<const triangulate::Triangulation> results,
                     bool one_plane, std::size_t most) {
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < polygons.size() && shown.size() < most; ++i) {
        if (!results[i].triangles.empty()) shown.push_back(i);
    }
    const auto columns = one_plane ? 1.0 : std::max(1.0, std::ceil(std::sqrt(static_cast<double>(shown.size()))));
    const double width = std::clamp(1.6 / columns, 0.25, 1.2);
    char head[512];
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' width='%g' height='%g'>\n"
                  "<rect width='%g' height='%g' fill='white'/>\n<g stroke-linejoin='round' fill-rule='evenodd'>\n",
                  kSize, kSize, kSize, kSize, kSize, kSize);
    std::string svg = head;
    Frame frame;
    if (one_plane) {
        for (const std::size_t i : shown) frame.include(polygons[i].polygon);
    }
    for (std::size_t n = 0; n < shown.size(); ++n) {
        const auto& polygon = polygons[shown[n]].polygon;
        if (!one_plane) {
            frame = Frame{};
            frame.include(polygon);
            frame.cell = kSize / columns;
            frame.corner = frame.cell * glm::dvec2(std::fmod(static_cast<double>(n), columns),
                                                   std::floor(static_cast<double>(n) / columns));
        }
        draw(polygon, results[shown[n]], frame, width, svg);
    }
    return svg + "</g>\n</svg>\n";
}

}  // namespace crofton::cli
