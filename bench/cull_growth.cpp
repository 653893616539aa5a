// How the cost of culling grows with the number of boxes: bench_cull_growth [SVG [LARGEST]] measures a list and a tree
// from 1,000 boxes up, a fifth of them visible, prints a table and draws it, time against number, both logarithmic.
#include <algorithm>
#include <chrono>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/tree/box_tree.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "cull_crowd.hpp"

namespace {

using namespace crofton;

struct Line {
    const char* name;
    const char* color;
    std::vector<double> microseconds;
};

// The least of repetitions that last a tenth of a second together, at least five of them.
double least_time(const std::function<void()>& work) {
    using Clock = std::chrono::steady_clock;
    double least = 1e30, total = 0.0;
    for (int n = 0; n < 5 || total < 1e5; ++n) {
        const auto start = Clock::now();
        work();
        const double time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
        least = std::min(least, time);
        total += time;
    }
    return least;
}

constexpr double kWidth = 640.0, kHeight = 400.0, kLeft = 64.0, kRight = 110.0, kTop = 16.0, kBottom = 44.0;

class Chart {
  public:
    Chart(double least_count, double largest_count, double least, double largest)
        : x0_(std::log10(least_count)),
          x1_(std::log10(largest_count)),
          y0_(std::floor(std::log10(least))),
          y1_(std::ceil(std::log10(largest))) {}

    std::string draw(const std::vector<double>& counts, const std::vector<Line>& lines) {
        out_ =
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 400\" font-family=\"sans-serif\" "
            "font-size=\"12\"><rect width=\"640\" height=\"400\" fill=\"#fff\"/>\n";
        for (double p = y0_; p <= y1_; p += 1.0) {
            line(kLeft, y(p), kWidth - kRight, y(p), "#ddd");
            text(kLeft - 6.0, y(p) + 4.0, "end", p < 3.0 ? power(p) + " µs" : power(p - 3.0) + " ms");
        }
        for (double p = std::ceil(x0_); p <= x1_ + 0.01; p += 1.0) {
            line(x(p), kTop, x(p), kHeight - kBottom, "#ddd");
            text(x(p), kHeight - kBottom + 18.0, "middle", p < 6.0 ? power(p - 3.0) + "k" : power(p - 6.0) + "M");
        }
        text(0.5 * (kLeft + kWidth - kRight), kHeight - 8.0, "middle", "boxes, a fifth of them visible");
        double free_below = 0.0;  // labels do not overlap; lines come from above
        for (const Line& l : lines) {
            std::string points;
            for (std::size_t i = 0; i < counts.size(); ++i)
                points += number(x(std::log10(counts[i]))) + "," + number(y(std::log10(l.microseconds[i]))) + " ";
            out_ += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + std::string(l.color) + "\" points=\"" +
                    points + "\"/>\n";
            const double at = std::max(y(std::log10(l.microseconds.back())) + 4.0, free_below);
            text(kWidth - kRight + 6.0, at, "start", l.name, l.color);
            free_below = at + 14.0;
        }
        return out_ + "</svg>\n";
    }

  private:
    [[nodiscard]] double x(double log) const { return kLeft + (kWidth - kLeft - kRight) * (log - x0_) / (x1_ - x0_); }
    [[nodiscard]] double y(double log) const {
        return kHeight - kBottom - (kHeight - kTop - kBottom) * (log - y0_) / (y1_ - y0_);
    }
    static std::string number(double value) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.1f", value);
        return buffer;
    }
    static std::string power(double p) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%g", std::pow(10.0, p));
        return buffer;
    }
    void line(double xa, double ya, double xb, double yb, const char* color) {
        out_ += "<line x1=\"" + number(xa) + "\" y1=\"" + number(ya) + "\" x2=\"" + number(xb) + "\" y2=\"" +
                number(yb) + "\" stroke=\"" + color + "\"/>\n";
    }
    void text(double at_x, double at_y, const char* anchor, const std::string& words, const char* color = "#333") {
        out_ += "<text x=\"" + number(at_x) + "\" y=\"" + number(at_y) + "\" text-anchor=\"" + anchor + "\" fill=\"" +
                color + "\">" + words + "</text>\n";
    }

    double x0_, x1_, y0_, y1_;
    std::string out_;
};

}  // namespace

int main(int argc, char** argv) {
    const double largest = argc > 2 ? std::atof(argv[2]) : 1e7;
    std::vector<Line> lines{
        {"list, exact", "#17a2b8", {}}, {"list, planes only", "#1f77b4", {}}, {"tree, exact", "#d62728", {}}};
    std::vector<double> counts;
    std::puts("     boxes   list, exact  planes only   tree, exact   visible   (nanoseconds a box)");
    for (double count = 1e3; count <= largest * 1.01; count *= std::sqrt(10.0)) {
        const auto n = static_cast<std::size_t>(std::llround(count));
        const std::vector<Obb> boxes = bench::crowd(n);
        const cull::View view = bench::view_of_share(boxes, 0.2);
        cull::BoxSet set;
        set.assign(boxes);
        cull::VerdictBits bits;
        cull::VisibleSet visible;
        const auto tree = tree::BoxTree::build(boxes);
        counts.push_back(count);
        lines[0].microseconds.push_back(least_time([&] { cull::cull(set, boxes, view, bits); }));
        lines[1].microseconds.push_back(
            least_time([&] { cull::cull(set, boxes, view, bits, cull::Mode::conservative); }));
        lines[2].microseconds.push_back(least_time([&] {
            cull::cull(*tree, view, visible, {cull::Mode::exact, cull::Order::tree});
        }));
        const auto per_box = [&](const Line& line) { return 1e3 * line.microseconds.back() / static_cast<double>(n); };
        std::printf("%10zu %13.3f %12.3f %13.3f %9zu\n", n, per_box(lines[0]), per_box(lines[1]), per_box(lines[2]),
                    visible.size());
        std::fflush(stdout);
    }
    if (argc < 2) return 0;
    double low = 1e30, high = 0.0;
    for (const Line& line : lines)
        for (const double time : line.microseconds) low = std::min(low, time), high = std::max(high, time);
    std::ofstream file(argv[1]);
    file << Chart(counts.front(), counts.back(), low, high).draw(counts, lines);
    return file.good() ? 0 : 1;
}
