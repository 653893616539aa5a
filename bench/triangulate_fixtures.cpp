// SPDX-License-Identifier: MIT
// earcut's fixtures, one line each: time, vertices, triangles beside those that earcut makes, proven or refused.
#include <benchmark/benchmark.h>

#include <crofton/triangulate/triangulate.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

using namespace crofton;

namespace {

const std::string kFolder = std::string(CROFTON_SHARED_DATA) + "/polygons/";

nlohmann::json read_json(const std::string& path) {
    std::ifstream file(path);
    return nlohmann::json::parse(file, nullptr, false);
}

Polygon read_rings(const std::string& path) {
    Polygon result;
    for (const auto& ring : read_json(path)) {
        for (const auto& p : ring) result.points.emplace_back(p[0].get<double>(), p[1].get<double>());
        result.ring_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
    }
    return result;
}

void measure(benchmark::State& state, const Polygon& polygon, double expected) {
    triangulate::Triangulator triangulator;
    triangulate::Triangulation result;
    bool valid = false;
    for (auto _ : state) valid = triangulator.triangulate(polygon, {}, result).has_value();
    state.counters["vertices"] = static_cast<double>(polygon.points.size());
    state.counters["holes"] = static_cast<double>(polygon.ring_count() - 1);
    state.counters["triangles"] = static_cast<double>(result.triangles.size());
    state.counters["earcut"] = expected;
    state.counters["proven"] = result.optimal;
    state.counters["refused"] = !valid;
}

bool register_all() {
    if (!std::filesystem::exists(kFolder + "earcut-fixtures")) return false;
    const auto expected = read_json(kFolder + "earcut-expected.json");
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder + "earcut-fixtures"))
        names.insert(entry.path().stem().string());
    for (const auto& name : names) {
        const auto polygon = std::make_shared<Polygon>(read_rings(kFolder + "earcut-fixtures/" + name + ".json"));
        const double triangles = expected.contains("triangles") ? expected["triangles"].value(name, -1.0) : -1.0;
        benchmark::RegisterBenchmark(("fixture/" + name).c_str(), [polygon, triangles](benchmark::State& state) {
            measure(state, *polygon, triangles);
        })->Unit(benchmark::kMicrosecond);
    }
    return true;
}

[[maybe_unused]] const bool registered = register_all();

}  // namespace
