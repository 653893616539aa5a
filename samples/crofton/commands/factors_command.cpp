// SPDX-License-Identifier: MIT
// `crofton study factors`: form factors by global lines, of Howell's standard pairs or of scenes.
#include <algorithm>
#include <cmath>
#include <crofton/radiosity/patches.hpp>
#include <crofton/study/mutual_information.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <memory>

#include "assets/flat_scene.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "verify/rows.hpp"
#include "verify/standard_pairs.hpp"

namespace crofton::cli {
namespace {

struct FactorsRun {
    std::vector<std::string> scenes;  // none: the standard pairs
    std::string map, json;
    std::uint64_t blocks = 5000, seed = 1;  // blocks of 1024 lines
    std::uint64_t patches = 1000;           // at most so many a scene
    ReadOptions read = {};
};

// Lists F_12 beside its known value; kCheckFailed if one is off by more than kMaxZ errors.
Result<int> run_pairs(const FactorsRun& run) {
    std::vector<VerifyRow> rows;
    for (const StandardPair& pair : standard_pairs()) {
        const auto found = factor_by_global_lines(pair, run.blocks, run.seed);
        if (!found) return found.error();
        rows.push_back(measured_row(pair.name, pair.source, pair.factor, found->value, found->standard_error));
        rows.back().cases = found->rays;
    }
    if (run.json != "-") print_text_to(stdout, table_of(rows));
    if (!run.json.empty())
        if (const auto written = write_json(run.json, json_of(rows)); !written) return written.error();
    return std::all_of(rows.begin(), rows.end(), [](const VerifyRow& row) { return row.holds; }) ? kSuccess
                                                                                                 : kCheckFailed;
}

// Triangles that are small beside a cell share a patch; the cells grow until there are few enough patches. Large
// triangles are not cut, so a scene may have fewer.
Vector<std::uint32_t> patch_numbers(const TriangleMesh& mesh, const Aabb& bounds, std::uint64_t most) {
    const double size = glm::length(bounds.max - bounds.min);
    Vector<std::uint32_t> numbers;
    for (double cell = size / 256.0; cell < 2.0 * size; cell *= 1.25) {
        numbers = radiosity::group_small_triangles(mesh, {}, cell);
        if (1 + std::uint64_t{*std::max_element(numbers.begin(), numbers.end())} <= most) break;
    }
    return numbers;
}

struct SceneComplexity {
    std::string name;
    std::size_t triangles = 0, patches = 0;
    double mean_crossings = 0.0, escaped = 0.0;
    study::MutualInformation information;
};

Result<SceneComplexity> look_at(const std::string& scene, const FactorsRun& run) {
    assets::LoadOptions load;
    load.seed = run.seed;
    if (scene.ends_with(".wad")) load.map = run.map;
    const auto source = load_updated_scene(scene, run.read, load);
    if (!source) return source.error();
    const auto flat = assets::flat_scene(*source, run.read.limits);
    if (!flat) return flat.error();
    const TriangleMesh& mesh = flat->mesh;
    const auto tracer = lines::LineTracer::build(mesh);
    if (!tracer) return tracer.error();
    const Vector<std::uint32_t> numbers = patch_numbers(mesh, tracer->bounds(), run.patches);
    const Vector<radiosity::Material> materials(std::size_t{*std::max_element(numbers.begin(), numbers.end())} + 1);
    const auto patches = radiosity::make_patches(mesh, numbers, materials);
    if (!patches) return patches.error();
    const lines::LineSource lines(tracer->bounds(), lines::LineMethod::walls, run.seed);
    const auto matrix = radiosity::factors_by_global_lines(*tracer, *patches, lines, run.blocks);
    if (!matrix) return matrix.error();
    const auto information = study::mutual_information(*matrix);
    if (!information) return information.error();
    SceneComplexity result{source->name, mesh.triangle_count(), patches->count(), 0.0, 0.0, *information};
    double surface = 0.0, rays = 0.0, escaped = 0.0;
    for (const double area : patches->areas) surface += area;
    for (std::size_t i = 0; i < matrix->size; ++i) {
        rays += static_cast<double>(matrix->rays[i]);
        escaped += static_cast<double>(matrix->escaped[i]);
    }
    result.mean_crossings = 2.0 * surface / lines.surface_area();
    result.escaped = escaped / rays;
    return result;
}

// One line a scene: mean crossings, what escapes, and the mutual information of the form factors in bits.
Result<int> run_scenes(const FactorsRun& run) {
    Json rows = Json::array();
    if (run.json != "-")
        print_to(stdout, "%-24s %10s %8s %10s %9s %10s %10s %10s\n", "scene", "triangles", "patches", "crossings",
                 "escape", "bits", "of at most", "bias");
    for (const std::string& scene : run.scenes) {
        const auto seen = look_at(scene, run);
        if (!seen) return seen.error();
        const auto& i = seen->information;
        if (run.json != "-")
            print_to(stdout, "%-24s %10zu %8zu %10.3f %8.1f%% %10.3f %10.3f %10.3f\n", printable(seen->name).c_str(),
                     seen->triangles, seen->patches, seen->mean_crossings, 100.0 * seen->escaped, i.bits,
                     i.entropy_bits, i.bias);
        rows.push_back({{"scene", seen->name},
                        {"triangles", seen->triangles},
                        {"patches", seen->patches},
                        {"mean_crossings", seen->mean_crossings},
                        {"escaped", seen->escaped},
                        {"bits", i.bits},
                        {"entropy_bits", i.entropy_bits},
                        {"bias_bits", i.bias},
                        {"rays", i.rays}});
    }
    if (!run.json.empty())
        if (const auto written = write_json(run.json, rows); !written) return written.error();
    return kSuccess;
}

}  // namespace

void add_factors_command(CommandLine& line) {
    auto run = std::make_shared<FactorsRun>();
    Command command = kFactors.add_to(line);
    command.footer(
        "Without a scene: the form factors of standard pairs next to their known values. With scenes: their mean\n"
        "number of crossings a line, the rays that escape, and the mutual information in bits (docs/theory.md).\n"
        "\n"
        "Examples:\n"
        "  crofton study factors\n"
        "  crofton study factors room town --json -\n"
        "  crofton study factors level.wad --map MAP07\n");
    command.option("scenes", run->scenes, "town, room, or .glb, .gltf, .obj or .wad files");
    command.option("--blocks", run->blocks, "Blocks of 1024 lines per scene or pair")
        .whole_between(1, 100000)
        .show_default();
    command.option("--patches", run->patches, "Merge small triangles until a scene has at most this many patches")
        .whole_between(2, 16384)
        .show_default();
    command.option("--seed", run->seed, "Seed of the lines and of the town").show_default();
    command.option("--map", run->map, "Level of a .wad file");
    command.option("--json", run->json, "Write the figures as JSON; - for stdout").writable_file_or_stdout();
    add_read_options(command, run->read);
    command.action([run] {
        const auto status = run->scenes.empty() ? run_pairs(*run) : run_scenes(*run);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
