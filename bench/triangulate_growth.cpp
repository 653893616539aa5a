// How time grows with vertices and holes: triangulate_growth FILE.svg measures contours of noise of doubling size and
// draws microseconds a vertex over vertices; the numbers go to stdout.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "triangulate_inputs.hpp"

using namespace crofton;
using triangulate::Method;

namespace {

struct Point {
    double vertices, microseconds;  // microseconds a vertex
};

struct Line {
    std::string name;
    const char* color;
    Method method;
    bench::Contours contours;
    std::vector<std::uint32_t> sides;
    std::vector<Point> points = {};
};

void measure(Line& line) {
    for (const std::uint32_t side : line.sides) {
        bench::Contours contours = line.contours;
        contours.side = side;
        const Polygon polygon = bench::noise_contours(contours);
        const auto vertices = static_cast<double>(polygon.points.size());
        triangulate::Triangulator triangulator;
        triangulate::Triangulation result;
        double best = 1e300;
        for (int run = 0; run < (vertices < 50'000 ? 3 : 1); ++run) {
            const auto start = std::chrono::steady_clock::now();
            if (!triangulator.triangulate(polygon, {.method = line.method, .seconds = 60.0}, result)) return;
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        std::printf("%-46s n %7.0f holes %5zu: %9.3f ms, %8.3f us/vertex%s\n", line.name.c_str(), vertices,
                    polygon.ring_count() - 1, 1e3 * best, 1e6 * best / vertices,
                    line.method != Method::minimum_weight ? ""
                    : result.optimal                      ? ", proven"
                                                          : ", NOT PROVEN");
        line.points.push_back({vertices, 1e6 * best / vertices});
    }
}

constexpr double kWidth = 820, kHeight = 460, kLeft = 60, kRight = 330, kTop = 40, kBottom = 50;

double x_of(double vertices) {
    return kLeft + (kWidth - kLeft - kRight) * (std::log10(vertices) - 2.0) / (std::log10(2e5) - 2.0);
}
double y_of(double microseconds) {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * (std::log10(microseconds) + 1.0) / 4.0;
}

std::string text(double x, double y, const char* anchor, const std::string& content) {
    char head[160];
    std::snprintf(head, sizeof head, "<text x='%.1f' y='%.1f' text-anchor='%s'>", x, y, anchor);
    return head + content + "</text>\n";
}

std::string stroke(double x1, double y1, double x2, double y2, const char* style) {
    char line[200];
    std::snprintf(line, sizeof line, "<line x1='%.1f' y1='%.1f' x2='%.1f' y2='%.1f' %s/>\n", x1, y1, x2, y2, style);
    return line;
}

std::string draw(const std::vector<Line>& lines) {
    char head[300];
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' font-family='sans-serif' "
                  "font-size='12' fill='#333'>\n<rect width='100%%' height='100%%' fill='#fff'/>\n",
                  kWidth, kHeight);
    std::string svg = head;
    svg += text(kLeft, 22, "start", "Triangulation time, contours of noise: microseconds a vertex over vertices");
    for (const double n : {1e2, 1e3, 1e4, 1e5}) {
        svg += stroke(x_of(n), kTop, x_of(n), kHeight - kBottom, "stroke='#ddd'");
        svg += text(x_of(n), kHeight - kBottom + 18, "middle", std::to_string(static_cast<int>(n)));
    }
    for (const double t : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
        char label[16];
        std::snprintf(label, sizeof label, "%g", t);
        svg += stroke(kLeft, y_of(t), kWidth - kRight, y_of(t), "stroke='#ddd'");
        svg += text(kLeft - 8, y_of(t) + 4, "end", label);
    }
    svg += text((kLeft + kWidth - kRight) / 2, kHeight - 10, "middle", "vertices");
    double label_y = kTop + 20;
    for (const Line& line : lines) {
        if (line.points.empty()) continue;
        std::string path;
        for (const Point& p : line.points) {
            char at[48];
            std::snprintf(at, sizeof at, "%.1f,%.1f ", x_of(p.vertices), y_of(p.microseconds));
            path += at;
            char dot[120];
            std::snprintf(dot, sizeof dot, "<circle cx='%.1f' cy='%.1f' r='3' fill='%s'/>\n", x_of(p.vertices),
                          y_of(p.microseconds), line.color);
            svg += dot;
        }
        svg +=
            "<polyline fill='none' stroke-width='2' stroke='" + std::string(line.color) + "' points='" + path + "'/>\n";
        const std::string style = "stroke-width='3' stroke='" + std::string(line.color) + "'";
        svg += stroke(kWidth - kRight + 15, label_y - 4, kWidth - kRight + 40, label_y - 4, style.c_str());
        svg += text(kWidth - kRight + 48, label_y, "start", line.name);
        label_y += 24;
    }
    return svg + "</svg>\n";
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return std::fprintf(stderr, "usage: triangulate_growth FILE.svg\n"), 2;
    const bench::Contours short_waves{.wavelength = 4.0, .level = -0.2};
    const bench::Contours long_waves{.wavelength = 12.0, .level = -0.5};
    const bench::Contours no_holes{.wavelength = 12.0, .level = -0.1, .holes = false};
    const std::vector<std::uint32_t> up_to_677 = {24, 60, 120, 240, 480, 677}, up_to_500 = {60, 120, 240, 360, 500};
    std::vector<Line> lines = {
        {"delaunay, holes of 4 cells", "#2a9d5c", Method::delaunay, short_waves, up_to_677},
        {"ear, holes of 4 cells", "#b8860b", Method::ear, short_waves, up_to_677},
        {"minimum weight, holes of 4 cells", "#1f6fd0", Method::minimum_weight, short_waves, up_to_677},
        {"minimum weight, holes of 12 cells", "#8a3ffc", Method::minimum_weight, long_waves, up_to_500},
        {"minimum weight, bends of 12 cells, no holes",
         "#d0342c",
         Method::minimum_weight,
         no_holes,
         {60, 120, 240, 360}},
    };
    for (Line& line : lines) measure(line);
    std::ofstream file(arguments[1]);
    file << draw(lines);
    return file.good() ? 0 : 1;
}
