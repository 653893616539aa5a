// SPDX-License-Identifier: MIT
// `crofton study lines`: the ways to draw global lines, compared on one scene.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstdio>

#include "assets/flat_scene.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "lines_factors.hpp"
#include "progress_bar.hpp"
#include "read_options.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using lines::LineMethod;

struct LinesOptions {
    std::vector<std::string> scenes;
    ReadOptions read;
    std::string scene = "town", map, json;
    std::uint64_t blocks = 32, seed = 1, patches = 1000;
    std::uint32_t repeats = 12;
    bool factors = false;
};

// Sums over the lines of one estimate.
struct Seen {
    double lines = 0.0, crossings = 0.0, squares = 0.0, met = 0.0;
    double surface_area = 0.0;  // of the body that the lines fill
};

Seen by_lines(const lines::LineTracer& tracer, const lines::LineSource& source, const LinesOptions& options) {
    const auto seen = lines::visibility_complexity(tracer, source, options.blocks);
    const double n = static_cast<double>(options.blocks * lines::LineSource::kBlock);
    return {n, n * seen.mean_crossings, n * (std::pow(seen.deviation, 2.0) + std::pow(seen.mean_crossings, 2.0)),
            n * (1.0 - seen.wasted), source.surface_area()};
}

// As many bundles as there are blocks / 2, of the size that the solver takes: a cell as large as a triangle.
Seen by_bundles(const lines::BundleTracer& tracer, double cell_area, double box_area, std::uint64_t seed,
                sampling::Sequence sequence, const LinesOptions& options) {
    const sampling::UnitPoints points(seed, sequence);
    lines::BundleTracer::Scratch scratch;
    lines::LineHits hits;
    Seen seen;
    seen.surface_area = box_area;
    const std::uint64_t bundles = std::max<std::uint64_t>(1, options.blocks / 2);
    for (std::uint64_t k = 0; k < bundles; ++k) {
        const auto bundle = lines::make_bundle(tracer.bounds(), cell_area, points.at<2>(k), seed << 32 | k);
        tracer.all_hits(bundle, scratch, hits);
        seen.lines += 0.25 * box_area / cell_area;  // as many as are meant: on average over directions
        std::uint32_t begin = 0;
        for (const std::uint32_t end : hits.ends) {
            const double n = end - begin;
            begin = end;
            seen.crossings += n;
            seen.squares += n * n;
            seen.met += n > 0.0 ? 1.0 : 0.0;
        }
    }
    return seen;
}

// How well a way to draw lines counts the scene's surface, a number known exactly: S = crossings · F / (2 N).
// Efficiency is the reciprocal of error² · time, so it does not depend on how many lines were spent.
template <class Look>
Json compare(const char* method, sampling::Sequence sequence, double surface, const LinesOptions& options,
             ProgressBar& bar, Look&& look) {
    double squares = 0.0;
    Seen all;
    const auto start = std::chrono::steady_clock::now();
    for (std::uint32_t r = 0; r < options.repeats; ++r) {
        const Seen seen = look(sampling::seed_of_repetition(options.seed, r, options.repeats));
        squares += std::pow(seen.crossings * seen.surface_area / (2.0 * seen.lines) / surface - 1.0, 2.0);
        all.lines += seen.lines;
        all.crossings += seen.crossings;
        all.squares += seen.squares;
        all.met += seen.met;
        bar.add(1);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double error = std::sqrt(squares / options.repeats), mean = all.crossings / all.lines;
    return {{"method", method},
            {"sequence", sequence == sampling::Sequence::quasi_random ? "quasi" : "pseudo"},
            {"lines_per_second", all.lines / seconds},
            {"mean_crossings", mean},
            {"deviation", std::sqrt(std::max(0.0, all.squares / all.lines - mean * mean))},
            {"wasted", 1.0 - all.met / all.lines},
            {"relative_error", error},
            {"efficiency", 1.0 / (error * error * seconds / options.repeats)}};
}

Result<void> run_lines(const LinesOptions& options) {
    const auto source = load_updated_scene(options.scene, options.read, {.map = options.map, .seed = options.seed});
    if (!source) return source.error();
    const auto flat = assets::flat_scene(*source, options.read.limits);
    if (!flat) return flat.error();
    const TriangleMesh& mesh = flat->mesh;
    const Vector<radiosity::Material> materials(mesh.triangle_count());
    const auto patches = radiosity::make_patches(mesh, materials);
    if (!patches) return patches.error();
    const auto tracer = lines::LineTracer::build(mesh);
    if (!tracer) return tracer.error();
    double surface = 0.0;
    for (const double area : patches->areas) surface += area;
    const auto bundles = lines::BundleTracer::build(mesh);
    if (!bundles) return bundles.error();
    const double box_area = lines::LineSource(tracer->bounds(), LineMethod::walls, 1).surface_area();
    const double cell_area = surface / static_cast<double>(mesh.triangle_count());
    Json rows = Json::array();
    ProgressBar bar("lines", std::size_t{8} * options.repeats);
    for (const sampling::Sequence sequence : {sampling::Sequence::pseudo_random, sampling::Sequence::quasi_random}) {
        for (const LineMethod method : {LineMethod::sphere_points, LineMethod::disc, LineMethod::walls})
            rows.push_back(compare(lines::to_string(method), sequence, surface, options, bar, [&](std::uint64_t seed) {
                return by_lines(*tracer, lines::LineSource(tracer->bounds(), method, seed, sequence), options);
            }));
        rows.push_back(compare("bundles", sequence, surface, options, bar, [&](std::uint64_t seed) {
            return by_bundles(*bundles, cell_area, box_area, seed, sequence, options);
        }));
    }
    const char* best = lines::to_string(lines::choose_method(*tracer, options.seed));
    if (!options.json.empty())
        return write_json(options.json, {{"scene", source->name},
                                         {"triangles", mesh.triangle_count()},
                                         {"surface", surface},
                                         {"chosen", best},
                                         {"methods", rows}});
    print_to(stdout, "%s: %zu triangles, %.0f square metres; lines one by one from: %s\n",
             printable(source->name).c_str(), mesh.triangle_count(), surface, best);
    print_to(stdout, "%-8s %-7s %12s %10s %10s %8s %10s %12s\n", "method", "numbers", "lines/s", "crossings",
             "deviation", "wasted", "error", "efficiency");
    for (const Json& row : rows.elements()) {
        const auto text = [&](const char* name) { return row.find(name)->text(); };
        const auto number = [&](const char* name) { return row.find(name)->number(); };
        print_to(stdout, "%-8s %-7s %12.0f %10.3f %10.3f %7.1f%% %9.3f%% %12.0f\n", text("method").c_str(),
                 text("sequence").c_str(), number("lines_per_second"), number("mean_crossings"), number("deviation"),
                 100.0 * number("wasted"), 100.0 * number("relative_error"), number("efficiency"));
    }
    return {};
}

}  // namespace

void add_lines_command(CommandLine& line) {
    auto options = std::make_shared<LinesOptions>();
    Command command = kLines.add_to(line);
    command.footer(
        "Each method of drawing uniform lines estimates the scene's surface S, which is known exactly, as\n"
        "S = crossings a line * F / 2, where F is the surface of the body that the lines fill (docs/theory.md).\n"
        "Columns: lines a second; crossings a line, and their deviation; lines that hit nothing (wasted); the\n"
        "relative error of an estimate of S; 1 / (error^2 seconds), which does not depend on the number of lines\n"
        "(efficiency).\n"
        "\n"
        "Examples:\n"
        "  crofton study lines                       the built-in town\n"
        "  crofton study lines level.wad --map MAP07\n"
        "  crofton study lines room --json -\n"
        "  crofton study lines --factors             form factors of Howell's standard pairs\n"
        "  crofton study lines --factors room town   complexity: mean crossings, and mutual information in bits\n");
    command.option("scenes", options->scenes,
                   "town (the default), room, or a .glb, .gltf, .obj or .wad file; several with --factors");
    const Option blocks = command
                              .option("--blocks", options->blocks,
                                      "Blocks of 1024 lines per estimate; with --factors the default is 5000")
                              .whole_between(1, 100000)
                              .show_default();
    const Option factors = command.flag(
        "--factors", options->factors,
        "Estimate form factors: of standard pairs next to their known values, or of scenes, with their statistics");
    command
        .option("--patches", options->patches,
                "With --factors: merge small triangles until there are at most this many patches")
        .whole_between(2, 16384)
        .show_default()
        .needs(factors);
    command.option("--repeats", options->repeats, "Estimates per method, for its error")
        .whole_between(2, 10000)
        .show_default();
    command.option("--seed", options->seed, "Seed of the lines and of the town").show_default();
    command.option("--map", options->map, "Level of a .wad file");
    command.option("--json", options->json, "Write the comparison as JSON; - for stdout").writable_file_or_stdout();
    add_read_options(command, options->read);
    command.action([options, blocks] {
        if (options->factors) {
            const auto status =
                run_factors({options->scenes, options->map, options->json, blocks.given() ? options->blocks : 5000,
                             options->seed, options->patches, options->read});
            return status ? *status : report_error("", status.error());
        }
        if (options->scenes.size() > 1)
            return report_error(
                "", Error{ErrorCode::invalid_argument, kNoItem, "lines: one scene at a time, unless with --factors"});
        if (!options->scenes.empty()) options->scene = options->scenes[0];
        const auto done = run_lines(*options);
        return done ? int{kSuccess} : report_error("", done.error());
    });
}

}  // namespace crofton::cli
