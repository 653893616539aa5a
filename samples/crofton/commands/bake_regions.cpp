// SPDX-License-Identifier: MIT
#include "bake_regions.hpp"

#include <algorithm>
#include <charconv>
#include <crofton/bake/region_files.hpp>
#include <crofton/world/world.hpp>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "assets/baked_source.hpp"
#include "commands.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace crofton::cli {
namespace {

struct Figures {
    std::size_t regions = 0;
    std::uint64_t objects = 0, bytes = 0;
};

Figures figures_of(std::span<const bake::RegionFile> index) {
    Figures figures{.regions = index.size()};
    for (const bake::RegionFile& file : index) {
        figures.objects += file.objects;
        figures.bytes += file.bytes;
    }
    return figures;
}

// Runs `body` for each region, and returns the error of the first that has one.
template <class Body>
Result<void> for_each_region(std::size_t count, Executor& executor, Body body) {
    std::mutex mutex;
    std::size_t first_bad = count;
    Result<void> first;
    executor.parallel_for(count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            Result<void> done = body(i);
            const std::lock_guard lock(mutex);
            if (done || i >= first_bad) continue;
            first_bad = i;
            first = std::move(done);
        }
    });
    return first;
}

}  // namespace

Result<RegionGrid> region_grid_from(const std::string& text) {
    RegionGrid grid;
    const char* const end = text.data() + text.size();
    const auto columns = std::from_chars(text.data(), end, grid.columns);
    if (columns.ec == std::errc() && columns.ptr != end && *columns.ptr == 'x') {
        const auto rows = std::from_chars(columns.ptr + 1, end, grid.rows);
        if (rows.ec == std::errc() && rows.ptr == end) return grid;
    }
    return fail(ErrorCode::invalid_argument, kNoItem,
                {"--regions: '", text, "' is no number of columns and rows, such as 8x8"});
}

int write_regions(const assets::SceneSource& source, const RegionGrid& grid, const std::string& folder,
                  const bake::BakeOptions& options, const std::string& json, Executor& executor) {
    const Stopwatch watch;
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) return report_error(folder, {ErrorCode::io, kNoItem, failed.message()});
    const auto regions = bake::SceneRegions::split(source.scene, grid.columns, grid.rows);
    if (!regions) return report_error("--regions", regions.error());
    const std::vector<bake::MeshLook> looks = assets::looks_of(source);
    bake::BakeOptions with_looks = options;
    with_looks.looks = looks;
    std::vector<bake::RegionFile> index(regions->size());
    const auto written = for_each_region(index.size(), executor, [&](std::size_t i) -> Result<void> {
        const auto file = regions->bake(i, with_looks);
        if (!file) return tl::unexpected(file.error());
        index[i] = regions->region(i);
        index[i].bytes = file->size();
        return bake::write_file(folder + "/" + index[i].name, *file);
    });
    if (!written) return report_error("", written.error());
    const auto file = bake::bake_region_index(index);
    if (!file) return report_error(folder, file.error());
    if (auto done = bake::write_file(folder + "/" + bake::kRegionIndexName, *file); !done)
        return report_error("", done.error());
    const Figures figures = figures_of(index);
    if (json != "-")
        std::printf("%s: baked %zu regions of %llu instances in %.1f ms (%.1f ms of CPU), %.1f MB in all\n",
                    folder.c_str(), figures.regions, static_cast<unsigned long long>(figures.objects),
                    watch.milliseconds(), watch.cpu_milliseconds(), static_cast<double>(figures.bytes) / 1e6);
    if (json.empty()) return kSuccess;
    const auto told = write_json(json, {{"folder", folder},
                                        {"regions", figures.regions},
                                        {"instances", figures.objects},
                                        {"bytes", figures.bytes},
                                        {"milliseconds", watch.milliseconds()},
                                        {"cpu_milliseconds", watch.cpu_milliseconds()}});
    return told ? kSuccess : report_error("", told.error());
}

bool has_regions(const std::string& folder) {
    std::error_code ignored;
    return std::filesystem::exists(std::filesystem::path(folder) / bake::kRegionIndexName, ignored);
}

int check_regions(const std::string& folder, std::uint64_t largest_file, const std::string& json, Executor& executor) {
    const Stopwatch watch;
    const bake::FileOptions access{.largest = largest_file};
    const auto index = bake::open_region_index(folder, access);
    if (!index) return report_error("", index.error());
    std::vector<std::optional<Region>> regions(index->size());
    std::vector<double> milliseconds(index->size());
    const auto opened = for_each_region(index->size(), executor, [&](std::size_t i) -> Result<void> {
        const Stopwatch one;
        auto region = bake::open_region(folder, (*index)[i], {}, access);
        if (!region) return tl::unexpected(region.error());
        regions[i] = std::move(*region);
        milliseconds[i] = one.milliseconds();
        return {};
    });
    if (!opened) return report_error("", opened.error());
    const double opening = watch.milliseconds();
    World world({.pairs = false});
    double attaching = 0.0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Stopwatch one;
        const auto attached = world.attach(*regions[i], (*index)[i].origin);
        if (!attached) return report_error((*index)[i].name, attached.error());
        attaching = std::max(attaching, one.milliseconds());
    }
    if (auto updated = world.update(); !updated) return report_error(folder, updated.error());
    const Figures figures = figures_of(*index);
    const double slowest = milliseconds.empty() ? 0.0 : *std::max_element(milliseconds.begin(), milliseconds.end());
    if (json != "-")
        std::printf(
            "%s: opened %zu regions of %llu instances in %.1f ms, the slowest in %.1f ms, and attached each in %.3f ms "
            "at most, %.1f MB in all\n",
            folder.c_str(), figures.regions, static_cast<unsigned long long>(world.object_count()), opening, slowest,
            attaching, static_cast<double>(figures.bytes) / 1e6);
    if (json.empty()) return kSuccess;
    const auto told = write_json(json, {{"folder", folder},
                                        {"regions", figures.regions},
                                        {"instances", world.object_count()},
                                        {"bytes", figures.bytes},
                                        {"milliseconds", opening},
                                        {"slowest_milliseconds", slowest},
                                        {"attach_milliseconds", attaching}});
    return told ? kSuccess : report_error("", told.error());
}

}  // namespace crofton::cli
