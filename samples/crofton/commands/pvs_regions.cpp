// SPDX-License-Identifier: MIT
#include "pvs_regions.hpp"

#include <atomic>
#include <bit>
#include <crofton/bake/checksum.hpp>
#include <cstdio>
#include <mutex>

#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "for_each_region.hpp"
#include "interrupt.hpp"
#include "pipeline/baked_parts.hpp"
#include "pipeline/pvs_scene.hpp"
#include "pipeline/region_sets.hpp"
#include "pipeline/scene_occluders.hpp"
#include "progress_bar.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace crofton::cli {
namespace {

// As high as those of a whole scene, and as wide as the region.
Result<pvs::Cells> cells_of(const RegionSetsBake& bake, const bake::RegionFile& region, const scene::Scene& scene) {
    Aabb eyes = pipeline::eyes_of(scene, bake.height);
    for (const int k : {0, 2})
        eyes.min[k] = region.bounds.min[k] - bake.reach, eyes.max[k] = region.bounds.max[k] + bake.reach;
    return pvs::Cells::grid(eyes, bake.cells);
}

std::uint64_t sum_of_options(const RegionSetsBake& bake) {
    const std::uint64_t all[] = {bake.cells.x,
                                 bake.cells.y,
                                 bake.cells.z,
                                 std::bit_cast<std::uint64_t>(bake.height),
                                 std::bit_cast<std::uint64_t>(bake.reach),
                                 std::bit_cast<std::uint64_t>(bake.lines.epsilon),
                                 std::bit_cast<std::uint64_t>(bake.lines.confidence),
                                 bake.lines.seed,
                                 static_cast<std::uint64_t>(bake.lines.sides),
                                 std::bit_cast<std::uint64_t>(bake.proofs.near_radius),
                                 bake.proofs.halvings,
                                 bake.proofs.surface_steps};
    return bake::checksum(std::as_bytes(std::span(all)));
}

// The region's own occluders, or those that are found if it was baked without.
std::shared_ptr<const pipeline::SceneOccluders> occluders_of(const std::string& path, const scene::Scene& scene,
                                                             const assets::ReadLimits& limits) {
    if (const auto parts = pipeline::load_baked_parts(path, scene, limits); parts && parts->occluders)
        return parts->occluders;
    return std::make_shared<const pipeline::SceneOccluders>(pipeline::find_scene_occluders(scene, serial_executor()));
}

Result<pvs::Pvs> sets_of(const RegionSetsBake& bake, const bake::RegionFile& region, const std::string& path) {
    const assets::ReadLimits limits{.bytes = bake.largest_file};
    auto source = assets::load_scene(path, {.limits = limits});
    if (!source) return source.error();
    scene::Scene& scene = source->scene;
    scene.update();
    const auto geometry = pvs::geometry_of(scene);
    if (!geometry) return geometry.error();
    const auto cells = cells_of(bake, region, scene);
    if (!cells) return cells.error();
    auto lines = pvs::Bake::create(*geometry, *cells, bake.lines);
    if (!lines) return lines.error();
    if (auto traced = lines->run({.should_stop = should_stop}); !traced) return traced.error();
    const auto found = occluders_of(path, scene, limits);
    std::vector<pvs::PlacedOccluder> occluders;
    for (const pipeline::SceneOccluders::Object& object : found->objects)
        for (const occlude::FoundOccluder& occluder : found->kinds[object.kind].found.occluders)
            occluders.push_back({&occluder, scene.world(object.node)});
    pvs::ProofOptions proofs = bake.proofs;
    proofs.should_stop = should_stop;
    return pvs::Pvs::finish(*lines, occluders, proofs);
}

struct BakedSets {
    std::mutex mutex;
    std::size_t baked = 0, empty = 0;
    pvs::PairCounts pairs;
    std::uint64_t bytes = 0;
};

// Nothing is written once interrupted: sets that lack proofs would count as done.
Result<void> bake_one(const RegionSetsBake& bake, const bake::RegionFile& region, BakedSets& totals) {
    const std::string path = bake.folder + "/" + region.name;
    const auto bytes = bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = bake.largest_file});
    if (!bytes) return bytes.error();
    const pipeline::RegionSetsOf of{bake::checksum(bytes->bytes()), sum_of_options(bake), bake.proofs.near_radius};
    if (const auto known = pipeline::load_region_sets(bake.folder, region, of.region, bake.largest_file);
        known && *known && (*known)->of == of)
        return {};
    auto sets = sets_of(bake, region, path);
    if (interrupted()) return {};
    if (!sets && sets.error().code == ErrorCode::empty) {
        const std::lock_guard lock(totals.mutex);
        ++totals.empty;
        return {};
    }
    if (!sets) return fail(sets.error().code, sets.error().item, path + ": " + sets.error().message);
    const pvs::PairCounts pairs = sets->counts();
    const auto file = pipeline::to_file({of, std::move(*sets)});
    if (!file) return file.error();
    if (auto written = bake::write_file(bake.folder + "/" + pipeline::sets_name_of(region.name), *file); !written)
        return written;
    const std::lock_guard lock(totals.mutex);
    ++totals.baked;
    totals.pairs.hidden += pairs.hidden, totals.pairs.unseen += pairs.unseen, totals.pairs.seen += pairs.seen;
    totals.bytes += file->size();
    return {};
}

Result<int> bake_all(const RegionSetsBake& bake, Executor& executor) {
    const Stopwatch watch;
    const auto index = bake::open_region_index(bake.folder, {.largest = bake.largest_file});
    if (!index) return index.error();
    std::vector<std::size_t> places;
    for (std::size_t i = bake.shard.index; i < index->size(); i += bake.shard.count) places.push_back(i);
    catch_interrupts();
    BakedSets totals;
    ProgressBar bar("pvs: regions", places.size());
    std::atomic<std::size_t> done = 0;
    const auto baked = for_each_region(places.size(), executor, [&](std::size_t i) -> Result<void> {
        if (interrupted()) return {};
        auto one = bake_one(bake, (*index)[places[i]], totals);
        bar.set(++done);
        return one;
    });
    finish_what_there_is();
    if (!baked) return baked.error();
    const auto all = static_cast<double>(std::max<std::uint64_t>(1, totals.pairs.all()));
    if (bake.json != "-")
        print_to(
            stdout,
            "%s: baked the sets of %zu of %zu regions in %.1f ms (%.1f ms of CPU), %.1f kB; %.1f %% of their pairs of "
            "a cell and an object are proved hidden\n",
            printable(bake.folder).c_str(), totals.baked, places.size(), watch.milliseconds(), watch.cpu_milliseconds(),
            static_cast<double>(totals.bytes) / 1e3, 100.0 * static_cast<double>(totals.pairs.hidden) / all);
    if (!bake.json.empty())
        if (auto told = write_json(bake.json, {{"folder", bake.folder},
                                               {"regions", places.size()},
                                               {"regions_baked", totals.baked},
                                               {"regions_without_triangles", totals.empty},
                                               {"hidden", static_cast<double>(totals.pairs.hidden) / all},
                                               {"seen", static_cast<double>(totals.pairs.seen) / all},
                                               {"bytes", totals.bytes},
                                               {"milliseconds", watch.milliseconds()},
                                               {"cpu_milliseconds", watch.cpu_milliseconds()}});
            !told)
            return told.error();
    return interrupted() ? kInterrupted : kSuccess;
}

}  // namespace

int bake_region_sets(const RegionSetsBake& bake, Executor& executor) {
    const auto status = bake_all(bake, executor);
    return status ? *status : report_error("", status.error());
}

}  // namespace crofton::cli
