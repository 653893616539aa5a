// How time grows with vertices and holes: triangulate_growth FILE.svg measures contours of noise of doubling size and
// draws microseconds a vertex over vertices; the numbers go to stdout.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "growth_chart.hpp"
#include "triangulate_inputs.hpp"

using namespace crofton;
using triangulate::Method;

namespace {

struct Curve {
    bench::GrowthLine line;
    Method method;
    bench::Contours contours;
    std::vector<std::uint32_t> sides;
};

void measure(Curve& curve) {
    for (const std::uint32_t side : curve.sides) {
        bench::Contours contours = curve.contours;
        contours.side = side;
        const Polygon polygon = bench::noise_contours(contours);
        const auto vertices = static_cast<double>(polygon.points.size());
        triangulate::Triangulator triangulator;
        triangulate::Triangulation result;
        double best = 1e300;
        for (int run = 0; run < (vertices < 50'000 ? 3 : 1); ++run) {
            const auto start = std::chrono::steady_clock::now();
            if (!triangulator.triangulate(polygon, {.method = curve.method, .seconds = 60.0}, result)) return;
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        std::printf("%-46s n %7.0f holes %5zu: %9.3f ms, %8.3f us/vertex%s\n", curve.line.name.c_str(), vertices,
                    polygon.ring_count() - 1, 1e3 * best, 1e6 * best / vertices,
                    curve.method != Method::minimum_weight ? ""
                    : result.optimal                       ? ", proven"
                                                           : ", NOT PROVEN");
        curve.line.points.emplace_back(vertices, 1e6 * best / vertices);
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return std::fprintf(stderr, "usage: triangulate_growth FILE.svg\n"), 2;
    const bench::Contours short_waves{.wavelength = 4.0, .level = -0.2};
    const bench::Contours long_waves{.wavelength = 12.0, .level = -0.5};
    const bench::Contours no_holes{.wavelength = 12.0, .level = -0.1, .holes = false};
    const std::vector<std::uint32_t> up_to_677 = {24, 60, 120, 240, 480, 677}, up_to_500 = {60, 120, 240, 360, 500};
    std::vector<Curve> curves = {
        {{"delaunay, holes of 4 cells", "#2a9d5c", {}}, Method::delaunay, short_waves, up_to_677},
        {{"ear, holes of 4 cells", "#b8860b", {}}, Method::ear, short_waves, up_to_677},
        {{"minimum weight, holes of 4 cells", "#1f6fd0", {}}, Method::minimum_weight, short_waves, up_to_677},
        {{"minimum weight, holes of 12 cells", "#8a3ffc", {}}, Method::minimum_weight, long_waves, up_to_500},
        {{"minimum weight, bends of 12 cells, no holes", "#d0342c", {}},
         Method::minimum_weight,
         no_holes,
         {60, 120, 240, 360}},
    };
    std::vector<bench::GrowthLine> lines;
    for (Curve& curve : curves) {
        measure(curve);
        lines.push_back(curve.line);
    }
    const std::string svg = bench::growth_chart("microseconds a vertex", "vertices of contours of noise", lines);
    return bench::write_growth_chart(arguments[1], svg) ? 0 : 1;
}
