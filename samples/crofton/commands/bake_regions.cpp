// SPDX-License-Identifier: MIT
#include "bake_regions.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <crofton/bake/checksum.hpp>
#include <crofton/bake/region_files.hpp>
#include <crofton/world/world.hpp>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "assets/baked_source.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "for_each_region.hpp"
#include "interrupt.hpp"
#include "pipeline/region_sets.hpp"
#include "progress_bar.hpp"
#include "region_state.hpp"
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

namespace {

constexpr double kSaveMilliseconds = 1000.0;
constexpr const char* kUnfinished = "unfinished.state";  // in the folder, until its index is written

// Files of regions, and the state that says which are written.
class RegionWriter {
  public:
    RegionWriter(const bake::SceneRegions& regions, const RegionBake& bake, std::uint64_t key, Executor& executor)
        : regions_(regions), bake_(bake), executor_(executor) {
        path_ = bake.state.empty() ? bake.folder + "/" + kUnfinished : bake.state;
        state_.key = key;
        state_.regions = static_cast<std::uint32_t>(regions.size());
    }

    // Takes over what an earlier run has written, as far as it is still there. Another bake's state is an error if the
    // user has named it.
    Result<void> load() {
        std::error_code unknown;
        if (!std::filesystem::exists(path_, unknown)) return {};
        const auto file = bake::MappedFile::open(path_, {.access = bake::FileAccess::read});
        if (!file) return file.error();
        auto earlier = region_state_from(file->bytes());
        if (earlier && (earlier->key != state_.key || earlier->regions != state_.regions))
            earlier = fail(ErrorCode::invalid_argument, kNoItem,
                           "is of another scene, or of other options; remove it to start again");
        if (!earlier && bake_.state.empty()) {
            print_to(stderr, "crofton: %s: %s: starting again\n", printable(path_).c_str(),
                     printable(earlier.error().message).c_str());
            return {};
        }
        if (!earlier) return fail(earlier.error().code, kNoItem, path_ + ": " + earlier.error().message);
        for (const auto& [place, done] : earlier->done) {
            const auto whole = check_region_file(bake_.folder, done, executor_);
            if (whole)
                state_.done.emplace(place, done);
            else
                print_to(stderr, "crofton: %s: baked again\n", printable(whole.error().message).c_str());
        }
        return {};
    }

    // The places of this shard that are not done.
    [[nodiscard]] std::vector<std::uint32_t> left() const {
        std::vector<std::uint32_t> places;
        for (std::uint32_t place = bake_.shard.index; place < state_.regions; place += bake_.shard.count)
            if (!state_.done.contains(place)) places.push_back(place);
        return places;
    }

    // Any thread.
    Result<void> write(std::uint32_t place, const bake::BakeOptions& options) {
        const auto file = regions_.bake(place, options);
        if (!file) return file.error();
        RegionState::Done done{regions_.region(place), bake::checksum(*file)};
        done.file.bytes = file->size();
        std::string path = bake_.folder + "/" + done.file.name;
        std::error_code none;  // visible sets of an earlier file of this name, which are no longer of it
        std::filesystem::remove(bake_.folder + "/" + pipeline::sets_name_of(done.file.name), none);
        if (auto written = bake::write_file(path, *file, bake::Flush::later); !written) return written;
        const std::lock_guard lock(mutex_);
        written_.push_back(std::move(path));
        state_.done.emplace(place, std::move(done));
        return saved_.milliseconds() < kSaveMilliseconds ? Result<void>{} : save();
    }

    // Waits until what write() has written is on the disk.
    Result<void> flush() {
        const std::vector<std::string> paths = std::exchange(written_, {});
        return bake::flush_files(paths);
    }

    // If the power fails before flush(), the next run finds by its sum that a file is not whole, and bakes it again.
    Result<void> save() {
        saved_ = Stopwatch();
        const auto file = to_file(state_);
        return file ? bake::write_file(path_, *file) : file.error();
    }

    // Requires that all regions are done.
    Result<void> write_index() {
        const auto file = bake::bake_region_index(files());
        if (!file) return file.error();
        if (auto written = bake::write_file(bake_.folder + "/" + bake::kRegionIndexName, *file); !written)
            return written;
        std::error_code remains;  // which would do no harm
        if (bake_.state.empty()) std::filesystem::remove(path_, remains);
        return {};
    }

    [[nodiscard]] std::vector<bake::RegionFile> files() const {
        std::vector<bake::RegionFile> files;
        for (const auto& [place, done] : state_.done) files.push_back(done.file);
        return files;
    }
    [[nodiscard]] bool is_whole() const { return state_.done.size() == state_.regions; }

  private:
    const bake::SceneRegions& regions_;
    const RegionBake& bake_;
    Executor& executor_;
    std::string path_;
    RegionState state_;
    std::vector<std::string> written_;  // and not flushed
    std::mutex mutex_;
    Stopwatch saved_;
};

int show_written(const RegionBake& bake, const RegionWriter& writer, std::size_t baked, std::size_t of,
                 const Stopwatch& watch) {
    const Figures figures = figures_of(writer.files());
    if (bake.json != "-") {
        print_to(stdout, "%s: baked %zu regions of %llu instances in %.1f ms (%.1f ms of CPU), %.1f MB in all",
                 printable(bake.folder).c_str(), figures.regions, static_cast<unsigned long long>(figures.objects),
                 watch.milliseconds(), watch.cpu_milliseconds(), static_cast<double>(figures.bytes) / 1e6);
        if (baked < figures.regions) print_to(stdout, "; %zu of them were done before", figures.regions - baked);
        if (!writer.is_whole()) print_to(stdout, "; a part of %zu regions", of);
        print_to(stdout, "\n");
    }
    if (bake.json.empty()) return kSuccess;
    const auto told = write_json(bake.json, {{"folder", bake.folder},
                                             {"regions", figures.regions},
                                             {"regions_baked", baked},
                                             {"instances", figures.objects},
                                             {"bytes", figures.bytes},
                                             {"milliseconds", watch.milliseconds()},
                                             {"cpu_milliseconds", watch.cpu_milliseconds()}});
    return told ? kSuccess : report_error("", told.error());
}

Result<int> write_all(const assets::SceneSource& source, const RegionBake& bake, const bake::BakeOptions& options,
                      Executor& executor) {
    const Stopwatch watch;
    catch_interrupts();
    std::error_code failed;
    std::filesystem::create_directories(bake.folder, failed);
    if (failed) return fail(ErrorCode::io, kNoItem, bake.folder + ": " + failed.message());
    const auto regions = bake::SceneRegions::split(source.scene, bake.grid.columns, bake.grid.rows);
    if (!regions) return fail(regions.error().code, kNoItem, "--regions: " + regions.error().message);
    RegionWriter writer(*regions, bake, region_key(source, bake.grid.columns, bake.grid.rows, options, executor),
                        executor);
    if (auto loaded = writer.load(); !loaded) return loaded.error();
    const bool is_shard = bake.shard.count > 1;
    // Regions of two bakes never have an index.
    if (!is_shard) std::filesystem::remove(bake.folder + "/" + bake::kRegionIndexName, failed);
    const std::vector<std::uint32_t> places = writer.left();
    std::atomic<std::size_t> baked = 0;
    const std::vector<bake::MeshLook> looks = assets::looks_of(source);
    bake::BakeOptions with_looks = options;
    with_looks.looks = looks;
    ProgressBar bar("bake: regions", places.size());
    const auto written = for_each_region(places.size(), executor, [&](std::size_t i) -> Result<void> {
        if (interrupted()) return {};
        auto done = writer.write(places[i], with_looks);
        if (done) bar.set(++baked);
        return done;
    });
    finish_what_there_is();
    // Also after an error: what is done need not be done again.
    auto saved = writer.flush();
    if (saved) saved = writer.save();
    if (!written) return written.error();
    if (!saved) return saved.error();
    if (baked < places.size()) {
        print_to(stderr, "crofton: interrupted after %zu of %zu regions: the next run continues from here\n",
                 baked.load(), places.size());
        return kInterrupted;
    }
    if (!is_shard)
        if (auto indexed = writer.write_index(); !indexed) return indexed.error();
    return show_written(bake, writer, baked, regions->size(), watch);
}

}  // namespace

int write_regions(const assets::SceneSource& source, const RegionBake& bake, const bake::BakeOptions& options,
                  Executor& executor) {
    const auto status = write_all(source, bake, options, executor);
    return status ? *status : report_error("", status.error());
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
        if (!region) return region.error();
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
        print_to(
            stdout,
            "%s: opened %zu regions of %llu instances in %.1f ms, the slowest in %.1f ms, and attached each in %.3f ms "
            "at most, %.1f MB in all\n",
            printable(folder).c_str(), figures.regions, static_cast<unsigned long long>(world.object_count()), opening,
            slowest, attaching, static_cast<double>(figures.bytes) / 1e6);
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
