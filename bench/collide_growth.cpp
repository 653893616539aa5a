// SPDX-License-Identifier: MIT
// How the broadphase's cost grows with the number of boxes, from the results of bench_collide:
//   bench_collide --benchmark_filter=broadphase --benchmark_out=growth.json --benchmark_out_format=json
//   collide_growth growth.json docs/pictures/collide_growth.svg
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "growth_chart.hpp"

using namespace crofton;
using nlohmann::json;

namespace {

double nanoseconds_of(const std::string& unit) {
    return unit == "s" ? 1e9 : unit == "ms" ? 1e6 : unit == "us" ? 1e3 : 1.0;
}

// "broadphase/bounds/crofton/1000" adds to the line "broadphase/bounds/crofton": nanoseconds a box, the least of its
// repetitions.
std::map<std::string, std::map<double, double>> costs(const json& results) {
    std::map<std::string, std::map<double, double>> lines;
    for (const json& run : results.at("benchmarks")) {
        std::string name = run.at("name");
        name = name.substr(0, name.find("/iterations:"));
        const std::size_t last = name.rfind('/');
        if (name.rfind("broadphase/", 0) != 0 || run.value("run_type", "") != "iteration" ||
            run.contains("error_occurred"))
            continue;
        const double count = std::stod(name.substr(last + 1));
        const double cost = run.at("cpu_time").get<double>() * nanoseconds_of(run.at("time_unit")) / count;
        const auto [place, is_new] = lines[name.substr(0, last)].emplace(count, cost);
        if (!is_new && cost < place->second) place->second = cost;
    }
    return lines;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) return std::fprintf(stderr, "usage: collide_growth RESULTS.json FILE.svg\n"), 2;
    std::ifstream file(arguments[1]);
    const json results = json::parse(file, nullptr, false);
    if (!results.is_object() || !results.contains("benchmarks"))
        return std::fprintf(stderr, "%s: no results of bench_collide\n", arguments[1]), 2;
    const std::pair<const char*, bench::GrowthLine> known[] = {
        {"broadphase/bounds/crofton", {"Crofton, bounds", "#c0392b", {}}},
        {"broadphase/boxes/crofton", {"Crofton, exact boxes", "#8e44ad", {}}},
        {"broadphase/bounds/bullet", {"Bullet, bounds", "#1b6ca8", {}}},
        {"broadphase/bounds/embree", {"Embree, bounds", "#2e8b57", {}}},
    };
    auto measured = costs(results);
    std::vector<bench::GrowthLine> lines;
    for (const auto& [name, line] : known) {
        lines.push_back(line);
        lines.back().points.assign(measured[name].begin(), measured[name].end());
    }
    const std::string svg =
        bench::growth_chart("nanoseconds a box and update", "moving boxes, about 1.2 pairs each", lines);
    return bench::write_growth_chart(arguments[2], svg) ? 0 : 1;
}
