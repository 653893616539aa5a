// SPDX-License-Identifier: MIT
// `crofton bake`: a scene made ready at build time, and what such a file holds.
#include <chrono>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "assets/baked_source.hpp"
#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "bake_regions.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/region_stream.hpp"
#include "pipeline/scene_occluders.hpp"
#include "pvs_cells.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct BakeOptions {
    std::string scene, output, folder, regions, shard, state, map, json, tree = "aligned";
    std::uint32_t instances = 0;
    std::uint64_t seed = 1;
    unsigned threads = 1;
    bool no_occluders = false, no_clusters = false;
    ReadOptions read;
};

// Time on the wall, and on all of the process's cores: on a busy machine only the second one says much.
struct Times {
    double milliseconds, cpu_milliseconds;
    double occluder_milliseconds = 0.0;  // to find them, which is not in the others
};

std::uint64_t occluder_count(const bake::BakedScene& baked) {
    std::uint64_t count = 0;
    if (baked.occluders())
        for (const auto& kind : baked.occluders()->kinds) count += kind.size();
    return count;
}

struct ClusterFigures {
    std::uint64_t count = 0, bytes = 0;
};

ClusterFigures cluster_figures(const bake::BakedScene& baked) {
    ClusterFigures figures;
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i)
        if (const depth::ClusteredMesh* const cut = baked.clusters(i)) {
            figures.count += cut->clusters().size();
            figures.bytes += cut->serialise().size();
        }
    return figures;
}

int show(const BakeOptions& options, const char* verb, const Times& times, const std::string& path,
         const bake::BakedScene& baked, std::uintmax_t bytes) {
    std::uint64_t triangles = 0, polygons = 0;
    for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
        triangles += baked.mesh(i).indices.size() / 3;
        polygons += baked.polygon(i) ? 1 : 0;
    }
    const ClusterFigures clusters = cluster_figures(baked);
    if (options.json != "-") {
        print_to(stdout,
                 "%s: %s in %.1f ms (%.1f ms of CPU); %zu instances of %zu meshes (%llu triangles, %llu triangulated "
                 "polygons), %zu nodes, "
                 "a tree of height %u, %llu occluders on %zu nodes, %llu clusters (%.1f MB), %.1f MB in all",
                 printable(path).c_str(), verb, times.milliseconds, times.cpu_milliseconds, baked.instances().size(),
                 baked.mesh_count(), static_cast<unsigned long long>(triangles),
                 static_cast<unsigned long long>(polygons), baked.nodes().size(), baked.tree().structure().height(),
                 static_cast<unsigned long long>(occluder_count(baked)),
                 baked.occluders() ? baked.occluders()->nodes.size() : 0,
                 static_cast<unsigned long long>(clusters.count), static_cast<double>(clusters.bytes) / 1e6,
                 static_cast<double>(bytes) / 1e6);
        if (times.occluder_milliseconds > 0.0)
            print_to(stdout, "; before that the occluders were found in %.1f ms", times.occluder_milliseconds);
        print_to(stdout, "\n");
    }
    if (options.json.empty()) return kSuccess;
    const auto written = write_json(options.json, {{"file", path},
                                                   {"version", bake::kVersion},
                                                   {"bytes", bytes},
                                                   {"milliseconds", times.milliseconds},
                                                   {"cpu_milliseconds", times.cpu_milliseconds},
                                                   {"instances", baked.instances().size()},
                                                   {"meshes", baked.mesh_count()},
                                                   {"triangles", triangles},
                                                   {"polygons", polygons},
                                                   {"nodes", baked.nodes().size()},
                                                   {"occluders", occluder_count(baked)},
                                                   {"clusters", clusters.count},
                                                   {"cluster_bytes", clusters.bytes},
                                                   {"occluder_milliseconds", times.occluder_milliseconds},
                                                   {"tree_height", baked.tree().structure().height()}});
    return written ? kSuccess : report_error("", written.error());
}

class BakeRun {
  public:
    explicit BakeRun(BakeOptions options) : options_(std::move(options)) {
        if (options_.threads != 1) pool_.emplace(options_.threads);
    }

    int run() {
        const bool writes = !options_.output.empty() || !options_.folder.empty() || !options_.regions.empty() ||
                            !options_.shard.empty() || !options_.state.empty();
        const bool is_told_how = !options_.map.empty() || options_.instances != 0 || options_.seed != 1 ||
                                 options_.tree != "aligned" || options_.no_occluders || options_.no_clusters;
        if (!writes && is_told_how)
            return report_error("", {ErrorCode::invalid_argument, kNoItem,
                                     "options of baking need --output FILE, or --folder FOLDER, to write to"});
        if (!writes) return check();
        if (options_.folder.empty() != options_.regions.empty())
            return report_error(
                "", {ErrorCode::invalid_argument, kNoItem, "--regions says how many, --folder where to: give both"});
        if (options_.folder.empty() && !(options_.shard.empty() && options_.state.empty()))
            return report_error(
                "", {ErrorCode::invalid_argument, kNoItem, "--shard and --state are of regions: give --regions too"});
        if (!options_.shard.empty() && options_.state.empty())
            return report_error("", {ErrorCode::invalid_argument, kNoItem, "--shard needs --state: the part to write"});
        return write();
    }

  private:
    // Loads the file as an engine would and says how long that took.
    int check() {
        if (pipeline::holds_regions(options_.scene))
            return check_regions(options_.scene, options_.read.limits.bytes, options_.json, executor());
        if (auto file = assets::refuse_regions(options_.scene); !file) return report_error("", file.error());
        if (assets::extension(options_.scene) != "crofton" && (is_scene() || !std::filesystem::exists(options_.scene)))
            return report_error(
                options_.scene,
                {ErrorCode::invalid_argument, kNoItem,
                 "is no .crofton file to check; -o is missing: to bake a scene, say where to: -o FILE"});
        const Stopwatch watch;
        const auto baked = bake::BakedScene::open(options_.scene, executor(), {.largest = options_.read.limits.bytes});
        const Times times{watch.milliseconds(), watch.cpu_milliseconds()};
        if (!baked) return report_error("", baked.error());
        return show(options_, "loaded", times, options_.scene, *baked, std::filesystem::file_size(options_.scene));
    }

    [[nodiscard]] bool is_scene() const {
        const std::string kind = assets::extension(options_.scene);
        return assets::is_made(options_.scene) || kind == "obj" || kind == "glb" || kind == "gltf" || kind == "wad";
    }

    int write() {
        const auto tree = pipeline::orientation_from(options_.tree);
        if (!tree) return report_error("", tree.error());
        RegionBake regions{{}, options_.folder, {}, options_.state, options_.json};
        if (!options_.regions.empty()) {
            const auto grid = region_grid_from(options_.regions);
            if (!grid) return report_error("", grid.error());
            const auto shard = shard_from(options_.shard);
            if (!shard) return report_error("", shard.error());
            regions.grid = *grid;
            regions.shard = *shard;
        }
        const auto source = load_updated_scene(
            options_.scene, options_.read,
            {.map = options_.map, .seed = options_.seed, .instances = options_.instances}, executor());
        if (!source) return report_error("", source.error());
        std::optional<bake::BakedOccluders> occluders;
        double finding_ms = 0.0;
        if (!options_.no_occluders) {
            const Stopwatch finding;
            occluders = pipeline::to_baked(pipeline::find_scene_occluders(source->scene, executor()));
            finding_ms = finding.milliseconds();
        }
        const bake::BakeOptions how{
            .tree = *tree, .occluders = occluders ? &*occluders : nullptr, .clusters = !options_.no_clusters};
        if (!options_.folder.empty()) return write_regions(*source, regions, how, executor());
        const Stopwatch watch;
        const auto file = assets::bake_source(*source, executor(), how);
        const Times times{watch.milliseconds(), watch.cpu_milliseconds(), finding_ms};
        if (!file) return report_error(options_.scene, file.error());
        const std::string_view bytes(reinterpret_cast<const char*>(file->data()), file->size());
        if (const auto written = write_file(options_.output, bytes); !written) return report_error("", written.error());
        const auto baked = bake::BakedScene::from_memory(*file, executor());
        if (!baked) return report_error(options_.output, baked.error());
        return show(options_, "baked", times, options_.output, *baked, file->size());
    }

    Executor& executor() { return pool_ ? static_cast<Executor&>(*pool_) : serial_executor(); }

    BakeOptions options_;
    std::optional<ThreadPool> pool_;
};

}  // namespace

void add_bake_command(CommandLine& line) {
    auto options = std::make_shared<BakeOptions>();
    Command command =
        line.command("bake", "Write a scene's boxes, tree, triangulations, clusters and occluders to a .crofton file");
    command
        .option("scene", options->scene,
                "town, room, office, valley, hall, a folder of city parts, or a .glb, .gltf, .obj or .wad file to bake "
                "with -o; without -o a .crofton file, or a folder of regions, to check")
        .required();
    const Option output = command.option("-o,--output", options->output, "File to write").writable_file();
    command
        .option("--regions", options->regions,
                "Columns and rows of regions along x and z, such as 8x8: each becomes a file in --folder")
        .excludes(output);
    command.option("--folder", options->folder, "Folder to write regions and their index to").excludes(output);
    command.option("--shard", options->shard, "i/n: bake only every n-th region, from i on; needs --state");
    command
        .option("--state", options->state,
                "Save what is done to this file; continue from it if it exists. By default a file in --folder, which "
                "goes when all is done")
        .writable_file();
    command.option("--map", options->map, "Level of a .wad file");
    command.option("--instances", options->instances, "Approximate number of instances of the town");
    command.option("--seed", options->seed, "Seed of the town").show_default();
    command.option("--tree", options->tree, "aligned | oriented | automatic: axes of the tree's inner bounds")
        .show_default();
    command.flag("--no-occluders", options->no_occluders,
                 "Do not search for occluders, which takes a second or more for each mesh of 100,000 triangles");
    command.flag("--no-clusters", options->no_clusters,
                 "Do not cut meshes into clusters, which 'frames --occlude' then does whenever the file is opened");
    command.option("--threads", options->threads, "Worker threads; 0: one per core")
        .whole_between(0, 256)
        .show_default();
    command.option("--json", options->json, "Write the figures as JSON; - for stdout").writable_file_or_stdout();
    command.footer(
        "A .crofton file contains the whole scene, as it stands when it has been read: the town's traffic does not\n"
        "move. Every sub-command that reads scenes reads it too. A folder of regions has a .crofton file for each and\n"
        "index.crofton, which is written last; a World attaches those that are near (docs/large_worlds.md). Regions\n"
        "that an interrupted run has finished are not baked again; 'crofton merge' writes the index of shards.\n"
        "Exit status: 0 done, 2 bad usage, a scene that cannot be read or a damaged .crofton file, 130 interrupted\n"
        "(nothing is written then, but finished regions).\n"
        "\n"
        "Examples:\n"
        "  crofton bake level.wad --map MAP01 -o map01.crofton\n"
        "  crofton bake map01.crofton\n"
        "  crofton bake town --instances 100000 --regions 8x8 --folder regions --threads 0 && crofton bake regions\n"
        "  crofton bake town --regions 8x8 --folder town_regions --shard 0/2 --state part0   # the other: 1/2, part1\n"
        "  crofton merge part0 part1 --out town_regions/index.crofton\n"
        "  crofton frames map01.crofton --camera street --occlude\n"
        "  crofton frames level.wad --map MAP01 --occlude --baked map01.crofton\n"
        "  crofton bake town --instances 1000000 -o town.crofton && crofton bake town.crofton --threads 0");
    add_unit_option(command, options->read);
    add_read_options(command, options->read);
    command.action([options] { return BakeRun(*options).run(); });
}

}  // namespace crofton::cli
