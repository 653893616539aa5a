// `crofton lines`: the ways to draw global lines, compared on one scene.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <crofton/radiosity/line_source.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "assets/flat_scene.hpp"
#include "commands.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using radiosity::LineMethod;

struct Options {
    std::string scene = "town", map, json;
    std::uint64_t blocks = 32, seed = 1;
    int repeats = 12;
};

// How well a method counts the scene's surface, a number known exactly: S = crossings · F / (2 N). Efficiency is the
// reciprocal of error² · time, so it does not depend on how many lines were spent.
nlohmann::json compare(const radiosity::LineTracer& tracer, double surface, LineMethod method,
                       measure::Sequence sequence, const Options& options) {
    double squares = 0.0, crossings = 0.0, deviation = 0.0, wasted = 0.0;
    std::uint64_t lines = 0;
    const auto start = std::chrono::steady_clock::now();
    for (int r = 0; r < options.repeats; ++r) {
        const radiosity::LineSource source(tracer.bounds(), method, options.seed + static_cast<std::uint64_t>(r),
                                           sequence);
        const auto seen = radiosity::visibility_complexity(tracer, source, options.blocks);
        // Bundles hold a random number of lines; what counts is how many were meant.
        const double meant = static_cast<double>(options.blocks * radiosity::LineSource::kBlock);
        const double estimate =
            seen.mean_crossings * static_cast<double>(seen.lines) * source.surface_area() / (2.0 * meant);
        squares += std::pow(estimate / surface - 1.0, 2.0);
        crossings += seen.mean_crossings / options.repeats;
        deviation += seen.deviation / options.repeats;
        wasted += seen.wasted / options.repeats;
        lines += seen.lines;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double error = std::sqrt(squares / options.repeats);
    return {{"method", radiosity::to_string(method)},
            {"sequence", sequence == measure::Sequence::quasi_random ? "quasi" : "pseudo"},
            {"lines_per_second", static_cast<double>(lines) / seconds},
            {"mean_crossings", crossings},
            {"deviation", deviation},
            {"wasted", wasted},
            {"relative_error", error},
            {"efficiency", 1.0 / (error * error * seconds / options.repeats)}};
}

Result<void> run(const Options& options) {
    assets::LoadOptions load;
    load.map = options.map;
    load.seed = options.seed;
    auto source = assets::load_scene(options.scene, load);
    if (!source) return tl::unexpected(source.error());
    source->scene.update();
    const TriangleMesh mesh = assets::flat_scene(*source).mesh;
    const Vector<radiosity::Material> materials(mesh.triangle_count());
    const auto patches = radiosity::make_patches(mesh, materials);
    if (!patches) return tl::unexpected(patches.error());
    const auto tracer = radiosity::LineTracer::build(mesh);
    if (!tracer) return tl::unexpected(tracer.error());
    double surface = 0.0;
    for (const double area : patches->areas) surface += area;
    nlohmann::json rows = nlohmann::json::array();
    for (const LineMethod method :
         {LineMethod::sphere_points, LineMethod::disc, LineMethod::bundles, LineMethod::walls})
        for (const measure::Sequence sequence : {measure::Sequence::pseudo_random, measure::Sequence::quasi_random}) {
            if (method == LineMethod::bundles && sequence == measure::Sequence::quasi_random) continue;
            rows.push_back(compare(*tracer, surface, method, sequence, options));
        }
    const char* best = radiosity::to_string(radiosity::choose_method(*tracer, options.seed));
    if (!options.json.empty())
        return write_json(options.json, {{"scene", source->name},
                                         {"triangles", mesh.triangle_count()},
                                         {"surface", surface},
                                         {"chosen", best},
                                         {"methods", rows}});
    std::printf("%s: %zu triangles, %.0f square metres; chosen: %s\n", source->name.c_str(), mesh.triangle_count(),
                surface, best);
    std::printf("%-8s %-7s %12s %10s %10s %8s %10s %12s\n", "method", "numbers", "lines/s", "crossings", "deviation",
                "wasted", "error", "efficiency");
    for (const auto& row : rows)
        std::printf("%-8s %-7s %12.0f %10.3f %10.3f %7.1f%% %9.3f%% %12.0f\n", row["method"].get<std::string>().c_str(),
                    row["sequence"].get<std::string>().c_str(), row["lines_per_second"].get<double>(),
                    row["mean_crossings"].get<double>(), row["deviation"].get<double>(),
                    100.0 * row["wasted"].get<double>(), 100.0 * row["relative_error"].get<double>(),
                    row["efficiency"].get<double>());
    return {};
}

}  // namespace

void add_lines_command(CLI::App& app, Outcome& outcome) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("lines", "Compare the ways to draw global lines on a scene");
    command->footer(
        "Examples:\n"
        "  crofton lines                       the built-in town\n"
        "  crofton lines level.wad --map MAP07\n"
        "  crofton lines room --json -\n");
    command->add_option("scene", options->scene, "town, room, or a .glb, .gltf, .obj or .wad file")
        ->capture_default_str();
    command->add_option("--blocks", options->blocks, "Blocks of 1024 lines per estimate")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--repeats", options->repeats, "Estimates per method, for its error")
        ->check(CLI::Range(2, 10000))
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Seed of the lines and of the town")->capture_default_str();
    command->add_option("--map", options->map, "Which level of a .wad");
    command->add_option("--json", options->json, "Write the comparison as JSON; - for stdout");
    command->callback([options, &outcome] {
        if (const auto done = run(*options); !done) outcome.status = report_error("", done.error());
    });
}

}  // namespace crofton::cli
