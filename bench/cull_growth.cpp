// SPDX-License-Identifier: MIT
// How the cost of culling grows with the number of boxes: cull_growth [SVG [LARGEST]] measures a list and a tree
// from 1,000 boxes up, a fifth of them visible, prints a table and draws it, time against number, both logarithmic.
#include <algorithm>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "cull_crowd.hpp"
#include "growth_chart.hpp"

namespace {

using namespace crofton;

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

}  // namespace

int main(int argc, char** argv) {
    const double largest = argc > 2 ? std::atof(argv[2]) : 1e7;
    std::vector<bench::GrowthLine> lines{
        {"list, exact", "#17a2b8", {}}, {"list, planes only", "#1f77b4", {}}, {"tree, exact", "#d62728", {}}};
    std::puts("     boxes   list, exact  planes only   tree, exact   visible   (nanoseconds a box)");
    for (double count = 1e3; count <= largest * 1.01; count *= std::sqrt(10.0)) {
        const auto n = static_cast<std::size_t>(std::llround(count));
        const std::vector<Obb> boxes = bench::crowd(n);
        const cull::View view = bench::view_of_share(boxes, 0.2);
        cull::BoxSet set;
        set.assign(boxes);
        cull::VerdictBits bits;
        cull::VisibleSet visible;
        const auto tree = boxtree::BoxTree::build(boxes);
        lines[0].points.emplace_back(count, least_time([&] { cull::find_visible(set, boxes, view, bits); }));
        lines[1].points.emplace_back(
            count, least_time([&] { cull::find_visible(set, boxes, view, bits, cull::CullMode::conservative); }));
        lines[2].points.emplace_back(
            count, least_time([&] {
                cull::find_visible(*tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
            }));
        const auto per_box = [&](const bench::GrowthLine& line) {
            return 1e3 * line.points.back().second / static_cast<double>(n);
        };
        std::printf("%10zu %13.3f %12.3f %13.3f %9zu\n", n, per_box(lines[0]), per_box(lines[1]), per_box(lines[2]),
                    visible.size());
        std::fflush(stdout);
    }
    if (argc < 2) return 0;
    const std::string svg = bench::growth_chart("microseconds a query", "boxes, a fifth of them visible", lines);
    return bench::write_growth_chart(argv[1], svg) ? 0 : 1;
}
