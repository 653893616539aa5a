// SPDX-License-Identifier: MIT
// crofton study triangulations: what each method's triangles cost a frustum, a rasterizer and its pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>
#include <memory>

#include "assets/gltf_primitive.hpp"
#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "polygon_files.hpp"
#include "progress_bar.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "triangulation_costs.hpp"

namespace crofton::cli {
namespace {

using triangulate::Method;

constexpr std::array<Method, 3> kMethods = {Method::ear, Method::delaunay, Method::minimum_weight};
constexpr std::array<const char*, 3> kMethodNames = {"ear", "delaunay", "minimum-weight"};
constexpr double kQuadSize = 64.0;
constexpr int kFrames = 60;

struct TriangulationsRequest {
    std::string file, map, json;
    std::uint64_t frusta = 100'000;
    std::size_t least_vertices = 5;  // smaller polygons leave little choice
    ReadOptions read;
};

Result<std::vector<Polygon>> gather(const TriangulationsRequest& run) {
    std::vector<Polygon> result;
    const auto add = [&](const Polygon& polygon) {
        if (polygon.points.size() >= run.least_vertices) result.push_back(polygon);
    };
    if (is_polygon_file(run.file)) {
        const auto file = read_polygons(run.file, run.map, run.read.limits);
        if (!file) return file.error();
        for (const auto& named : file->polygons) add(named.polygon);
        return result;
    }
    const auto source =
        assets::load_scene(run.file, {.map = run.map, .limits = run.read.limits, .strict = run.read.strict});
    if (!source) return source.error();
    for (scene::MeshId m = 0; m < source->scene.mesh_count(); ++m) {
        const TriangleMesh& mesh = source->scene.mesh(m);
        const auto patches = triangulate::find_planar_patches(mesh, assets::patch_tolerance(mesh, -1.0));
        if (!patches) return patches.error();
        for (const auto& patch : *patches) add(patch.polygon);
    }
    return result;
}

// To the unit square, so that no polygon counts for more than another.
void normalise(Polygon& polygon) {
    glm::dvec2 low = polygon.points[0], high = low;
    for (const auto& p : polygon.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const double size = std::max(high.x - low.x, high.y - low.y);
    for (auto& p : polygon.points) p = (p - low) / size;
}

struct Study {
    std::vector<TriangulatedPolygon> polygons;
    std::size_t refused = 0, unproven = 0;
    std::array<double, 3> weight{};  // in the file's units
};

Study triangulate_all(std::vector<Polygon> polygons) {
    Study study;
    triangulate::Triangulator triangulator;
    ProgressBar bar("triangulate", polygons.size());
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        TriangulatedPolygon entry;
        bool valid = true;
        for (std::size_t m = 0; m < kMethods.size() && valid; ++m) {
            entry.results.emplace_back();
            valid = triangulator.triangulate(polygons[i], {.method = kMethods[m]}, entry.results.back()).has_value();
        }
        bar.set(i + 1);
        if (!valid) {
            ++study.refused;
            continue;
        }
        for (std::size_t m = 0; m < kMethods.size(); ++m) study.weight[m] += entry.results[m].weight;
        study.unproven += !entry.results[2].optimal;
        entry.polygon = std::move(polygons[i]);
        normalise(entry.polygon);
        study.polygons.push_back(std::move(entry));
    }
    return study;
}

Json to_json(const Study& study, const Comparison& passed, const QuadComparison& quads,
             const Result<std::vector<DrawCost>>& drawn) {
    Json rows = Json::array();
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
        Json row{{"method", kMethodNames[m]},
                 {"weight", study.weight[m]},
                 {"triangles_passed",
                  {{"predicted", passed.predicted[m]},
                   {"measured", passed.measured[m]},
                   {"standard_error", passed.error[m]}}},
                 {"pixel_quads",
                  {{"predicted", quads.met.predicted[m]},
                   {"met", quads.met.measured[m]},
                   {"standard_error", quads.met.error[m]},
                   {"covered", quads.covered[m]}}}};
        if (drawn) {
            row["drawn"] = {{"submitted", (*drawn)[m].submitted},
                            {"clipped", (*drawn)[m].clipped},
                            {"milliseconds", (*drawn)[m].milliseconds}};
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

void print(const Study& study, const Comparison& passed, const QuadComparison& quads,
           const Result<std::vector<DrawCost>>& drawn, std::uint64_t frusta) {
    print_to(stdout, "%zu polygons, %zu refused, %zu not proven minimal; %llu frusta\n", study.polygons.size(),
             study.refused, study.unproven, static_cast<unsigned long long>(frusta));
    print_to(stdout, "%-15s %13s %7s | %9s %20s | %9s %18s %9s | %9s %9s\n", "method", "weight", "ratio", "passed:(6)",
             "measured (95 %)", "quads:(A)", "met (95 %)", "covered", "clipped", "ms");
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
        print_to(stdout, "%-15s %13.7g %7.4f | %9.5f %9.5f +- %7.5f | %9.2f %9.2f +- %5.2f %9.2f", kMethodNames[m],
                 study.weight[m], study.weight[m] / study.weight[2], passed.predicted[m], passed.measured[m],
                 1.96 * passed.error[m], quads.met.predicted[m], quads.met.measured[m], 1.96 * quads.met.error[m],
                 quads.covered[m]);
        if (drawn) print_to(stdout, " | %9.1f %9.3f", (*drawn)[m].clipped, (*drawn)[m].milliseconds);
        print_to(stdout, "\n");
    }
}

// Weights of all methods over a file's polygons, or its meshes' planar patches; triangles passed by random frusta and
// pixel quads, predicted and measured; triangles clipped and draw time.
Result<int> run_triangulations(const TriangulationsRequest& run) {
    auto polygons = gather(run);
    if (!polygons) return polygons.error();
    const Study study = triangulate_all(std::move(*polygons));
    if (study.polygons.empty())
        return fail(ErrorCode::empty, kNoItem,
                    run.file + ": no valid polygon of " + std::to_string(run.least_vertices) + " vertices or more");
    const Comparison passed = triangles_passed(study.polygons, run.frusta);
    const QuadComparison quads = pixel_quads(study.polygons, std::max<std::uint64_t>(1, run.frusta / 20), kQuadSize);
    const auto drawn = draw_wall(study.polygons, kFrames);
    if (!drawn) print_to(stderr, "crofton: nothing drawn: %s\n", printable(drawn.error().message).c_str());
    if (!run.json.empty()) {
        const Json document{{"file", assets::file_name(run.file)},
                            {"polygons", study.polygons.size()},
                            {"refused", study.refused},
                            {"unproven", study.unproven},
                            {"frusta", run.frusta},
                            {"quad_size", kQuadSize},
                            {"methods", to_json(study, passed, quads, drawn)}};
        if (auto written = write_json(run.json, document); !written) return written.error();
    }
    if (run.json != "-") print(study, passed, quads, drawn, run.frusta);
    return kSuccess;
}

}  // namespace

void add_triangulations_command(CommandLine& line) {
    auto request = std::make_shared<TriangulationsRequest>();
    Command command = kTriangulations.add_to(line);
    command.option("file", request->file, "Polygons, or a mesh or scene whose planar patches are taken").required();
    command.option("--map", request->map, "Level of a .wad file; all by default");
    command.option("--frusta", request->frusta, "Number of random frusta")
        .whole_between(1, std::uint64_t{1} << 40)
        .show_default();
    command.option("--least-vertices", request->least_vertices, "Leave out polygons of fewer vertices").show_default();
    command.option("--json", request->json, "Write the table as JSON; - for stdout, instead of the text")
        .writable_file_or_stdout();
    command.footer(
        "Compares ear clipping, Delaunay and minimum weight: weight; triangles that meet a random frustum, and 2 x 2\n"
        "pixel quads, predicted and measured; triangles clipped and draw time on a software Vulkan device.\n"
        "\n"
        "Examples:\n"
        "  crofton study triangulations glyphs.poly\n"
        "  crofton study triangulations town --json -");
    add_read_options(command, request->read);
    command.action([request] {
        const auto status = run_triangulations(*request);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
