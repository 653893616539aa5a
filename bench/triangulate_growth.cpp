// SPDX-License-Identifier: MIT
// How time grows with vertices and holes: triangulate_growth SIZES.svg HOLES.svg measures contours of noise, of
// doubling size and with more and more of one region's holes hanging free, and draws microseconds a vertex; the numbers
// go to stdout.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "growth_chart.hpp"
#include "triangulate_inputs.hpp"

using namespace crofton;
using triangulate::Method;

namespace {

// Seconds, the best of a few runs; negative if the polygon is refused.
double measure(const Polygon& polygon, Method method, const std::string& name, std::size_t holes) {
    triangulate::Triangulator triangulator;
    triangulate::Triangulation result;
    const auto vertices = static_cast<double>(polygon.points.size());
    double best = 1e300;
    const int runs = method != Method::minimum_weight ? 9 : vertices < 15'000 ? 3 : 2;
    for (int run = 0; run < runs; ++run) {
        const auto start = std::chrono::steady_clock::now();
        if (!triangulator.triangulate(polygon, {.method = method, .work = 6'000'000'000}, result)) return -1.0;
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf("%-24s n %7.0f holes %5zu: %9.3f ms, %8.3f us/vertex%s\n", name.c_str(), vertices, holes, 1e3 * best,
                1e6 * best / vertices,
                method != Method::minimum_weight ? ""
                : result.optimal                 ? ", proven"
                                                 : ", NOT PROVEN");
    return best;
}

bench::GrowthLine over_sizes(const char* name, const char* color, Method method, bench::Contours contours,
                             const std::vector<std::uint32_t>& sides) {
    bench::GrowthLine line{name, color, {}};
    for (const std::uint32_t side : sides) {
        contours.side = side;
        const Polygon polygon = bench::noise_contours(contours);
        const auto vertices = static_cast<double>(polygon.points.size());
        const double seconds = measure(polygon, method, name, polygon.ring_count() - 1);
        if (seconds > 0.0) line.points.emplace_back(vertices, 1e6 * seconds / vertices);
    }
    return line;
}

using Slit = std::array<std::uint32_t, 2>;

// The shortest Delaunay edges that join all rings, shortest first: one less than there are rings.
std::vector<Slit> joining_edges(const Polygon& polygon) {
    const auto delaunay = triangulate::triangulate(polygon, {.method = Method::delaunay});
    std::vector<std::uint32_t> ring(polygon.points.size()), parent(polygon.ring_count());
    for (std::uint32_t r = 0, i = 0; r < polygon.ring_count(); ++r)
        while (i < polygon.ring_ends[r]) ring[i++] = r;
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t r) {
        while (parent[r] != r) r = parent[r] = parent[parent[r]];
        return r;
    };
    std::vector<Slit> edges, result;
    if (!delaunay) return result;
    for (const auto& t : delaunay->triangles) {
        for (const auto& e : {Slit{t[0], t[1]}, Slit{t[1], t[2]}, Slit{t[2], t[0]}})
            if (ring[e[0]] != ring[e[1]]) edges.push_back(e);
    }
    const auto square = [&](const Slit& e) {
        const glm::dvec2 d = polygon.points[e[0]] - polygon.points[e[1]];
        return d.x * d.x + d.y * d.y;
    };
    std::sort(edges.begin(), edges.end(), [&](const Slit& e, const Slit& f) {
        const double a = square(e), b = square(f);
        return a != b ? a < b : e < f;
    });
    for (const Slit& e : edges) {
        const std::uint32_t a = root(ring[e[0]]), b = root(ring[e[1]]);
        if (a != b) result.push_back(e);
        parent[a] = b;
    }
    return result;
}

// One region throughout: slits tie all holes but so many to each other and to the outer ring.
bench::GrowthLine over_free_holes(const char* name, const char* color, const bench::Contours& contours,
                                  const std::vector<std::size_t>& counts) {
    bench::GrowthLine line{name, color, {}};
    const Polygon region = bench::noise_contours(contours);
    const auto slits = joining_edges(region);
    for (const std::size_t free : counts) {
        if (free > slits.size()) continue;
        Polygon polygon = region;
        for (std::size_t s = 0; s < slits.size() - free; ++s) {
            for (const std::uint32_t end : slits[s]) polygon.points.push_back(region.points[end]);
            polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
        }
        const double seconds = measure(polygon, Method::minimum_weight, std::string(name) + ", hanging free", free);
        const auto vertices = static_cast<double>(region.points.size());
        if (seconds > 0.0 && free > 0) line.points.emplace_back(static_cast<double>(free), 1e6 * seconds / vertices);
    }
    return line;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) return std::fprintf(stderr, "usage: triangulate_growth SIZES.svg HOLES.svg\n"), 2;
    const bench::Contours short_waves{.wavelength = 4.0, .level = -0.2};
    const bench::Contours long_waves{.wavelength = 12.0, .level = -0.5};
    const bench::Contours no_holes{.wavelength = 12.0, .level = -0.1, .holes = false};
    const std::vector<std::uint32_t> up_to_677 = {24, 60, 120, 240, 480, 677}, up_to_500 = {60, 120, 240, 360, 500};
    const std::vector<bench::GrowthLine> lines = {
        over_sizes("Delaunay, 4 cells", "#2a9d5c", Method::delaunay, short_waves, up_to_677),
        over_sizes("ear clipping, 4 cells", "#b8860b", Method::ear, short_waves, up_to_677),
        over_sizes("min. weight, 4 cells", "#1f6fd0", Method::minimum_weight, short_waves, up_to_677),
        over_sizes("min. weight, 12 cells", "#8a3ffc", Method::minimum_weight, long_waves, up_to_500),
        over_sizes("the same, no holes", "#d0342c", Method::minimum_weight, no_holes, {60, 120, 240, 360}),
    };
    bench::Contours short_large = short_waves, long_large = long_waves;
    short_large.side = 677;
    long_large.side = 500;
    const std::vector<bench::GrowthLine> holes = {
        over_free_holes("4 cells, n = 124,400", "#1f6fd0", short_large, {0, 1, 10, 100, 500, 1000, 2000, 2442}),
        over_free_holes("12 cells, n = 18,880", "#8a3ffc", long_large, {0, 1, 10, 100, 295}),
    };
    const std::string sizes_chart =
        bench::growth_chart("microseconds a vertex", "vertices of contours of noise", lines);
    const std::string holes_chart =
        bench::growth_chart("microseconds a vertex, minimum weight", "holes that hang free in one region", holes);
    const bool written =
        bench::write_growth_chart(arguments[1], sizes_chart) && bench::write_growth_chart(arguments[2], holes_chart);
    return written ? 0 : 1;
}
