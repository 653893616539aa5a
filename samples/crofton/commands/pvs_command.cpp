// SPDX-License-Identifier: MIT
// `crofton pvs`: what can be seen from each cell of a level, baked by global lines.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/baked_source.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "pipeline/pvs_scene.hpp"
#include "pipeline/pvs_views.hpp"
#include "pipeline/region_stream.hpp"
#include "progress_bar.hpp"
#include "pvs_cells.hpp"
#include "pvs_regions.hpp"
#include "read_options.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Views = std::optional<pipeline::PvsViewFigures>;

constexpr double kMapWidth = 1200.0;

class Map {
  public:
    Map(const pvs::Pvs& pvs, const pvs::BakeGeometry& geometry, std::uint32_t cell)
        : pvs_(pvs), geometry_(geometry), cell_(cell), bounds_(pvs.cells().bounds()) {
        const glm::dvec3 room = 0.1 * (bounds_.max - bounds_.min);
        bounds_.min -= room, bounds_.max += room;
        scale_ = kMapWidth / (bounds_.max.x - bounds_.min.x);
    }

    std::string draw() {
        const double height = scale_ * (bounds_.max.z - bounds_.min.z);
        print("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' width='%.0f' height='%.0f'>\n",
              kMapWidth, height, kMapWidth, height);
        svg_ += "<rect width='100%' height='100%' fill='#ffffff'/>\n";
        objects();
        cells();
        legend();
        svg_ += "</svg>\n";
        return std::move(svg_);
    }

  private:
    template <class... Numbers>
    void print(const char* format, Numbers... numbers) {
        char text[256];
        std::snprintf(text, sizeof text, format, numbers...);
        svg_ += text;
    }

    static const char* color_of(pvs::PairState state) {
        if (state == pvs::PairState::hidden) return "#d4d8dd";
        return state == pvs::PairState::unseen ? "#f0d48a" : "#4caf78";
    }

    // An object from above: the ring of its box around that axis which is nearest to the vertical.
    static std::array<glm::dvec3, 4> ring_of(const Obb& box) {
        int up = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(box.axes[k].y) > std::abs(box.axes[up].y)) up = k;
        const glm::dvec3 a = glm::dvec3(box.axes[(up + 1) % 3]) * double(box.half_extents[(up + 1) % 3]);
        const glm::dvec3 b = glm::dvec3(box.axes[(up + 2) % 3]) * double(box.half_extents[(up + 2) % 3]);
        return {box.center - a - b, box.center + a - b, box.center + a + b, box.center - a + b};
    }

    // The largest first: the ground must not cover what stands on it.
    void objects() {
        std::vector<std::pair<double, std::uint32_t>> order;
        for (std::uint32_t o = 0; o < geometry_.boxes.size(); ++o) {
            if (!pvs_.is_baked(o)) continue;
            const auto ring = ring_of(geometry_.boxes[o]);
            order.emplace_back(-glm::length(glm::cross(ring[1] - ring[0], ring[3] - ring[0])), o);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [size, o] : order) {
            const auto ring = ring_of(geometry_.boxes[o]);
            svg_ += "<path d='";
            for (std::size_t i = 0; i < 4; ++i) print(i ? "L%.1f %.1f" : "M%.1f %.1f", x(ring[i]), z(ring[i]));
            print("Z' fill='%s' stroke='#00000055' stroke-width='0.5'/>\n", color_of(pvs_.state(cell_, o)));
        }
    }

    void legend() {
        constexpr pvs::PairState states[] = {pvs::PairState::seen, pvs::PairState::unseen, pvs::PairState::hidden};
        constexpr const char* names[] = {"seen from the red cell", "unseen, so far", "proved hidden"};
        svg_ += "<rect x='8' y='8' width='190' height='74' fill='#ffffffdd' stroke='#888888' stroke-width='0.5'/>\n";
        for (int i = 0; i < 3; ++i) {
            print("<rect x='16' y='%d' width='16' height='14' fill='%s' stroke='#00000055'/>", 16 + 22 * i,
                  color_of(states[i]));
            print("<text x='40' y='%d' font-family='sans-serif' font-size='14'>%s</text>\n", 28 + 22 * i, names[i]);
        }
    }

    void cells() {
        const Aabb own = pvs_.cells().box(cell_);
        for (std::size_t c = 0; c < pvs_.cells().size(); ++c) {
            const Aabb box = pvs_.cells().box(c);
            if (box.max.y <= own.min.y || box.min.y >= own.max.y || c == cell_) continue;
            outline(c, pvs_.kind(c) == pvs::CellKind::solid ? "#00000066" : "none", "#5577aa55", 0.4);
        }
        outline(cell_, "#d0202088", "#d02020", 2.0);
    }

    // A cell from above: the hull of its corners.
    void outline(std::size_t cell, const char* fill, const char* stroke, double width) {
        svg_ += "<path d='";
        const auto ring = ring_of(pvs_.cells().corners(cell));
        for (std::size_t i = 0; i < ring.size(); ++i) print(i ? "L%.1f %.1f" : "M%.1f %.1f", x(ring[i]), z(ring[i]));
        print("Z' fill='%s' stroke='%s' stroke-width='%.1f'/>\n", fill, stroke, width);
    }

    // Andrew's monotone chain, from above.
    static std::vector<glm::dvec3> ring_of(const pvs::ConvexCell& cell) {
        auto corners = cell.corners;
        std::sort(corners.begin(), corners.end(),
                  [](const auto& p, const auto& q) { return p.x != q.x ? p.x < q.x : p.z < q.z; });
        std::vector<glm::dvec3> ring;
        for (const bool back : {false, true}) {
            const std::size_t first = ring.size();
            for (const glm::dvec3& p : corners) {
                while (ring.size() >= first + 2) {
                    const glm::dvec3 &a = ring[ring.size() - 2], &b = ring.back();
                    if ((b.x - a.x) * (p.z - a.z) - (b.z - a.z) * (p.x - a.x) > 0.0) break;
                    ring.pop_back();
                }
                ring.push_back(p);
            }
            if (!back) std::reverse(corners.begin(), corners.end());
            ring.pop_back();
        }
        return ring;
    }

    [[nodiscard]] double x(const glm::dvec3& p) const { return scale_ * (p.x - bounds_.min.x); }
    [[nodiscard]] double z(const glm::dvec3& p) const { return scale_ * (p.z - bounds_.min.z); }

    const pvs::Pvs& pvs_;
    const pvs::BakeGeometry& geometry_;
    std::uint32_t cell_;
    Aabb bounds_;
    double scale_ = 1.0;
    std::string svg_;
};

// Objects by their boxes' outlines: green where the cell sees them, yellow where that is open, grey where they are
// hidden. Cells of the same height as thin lines, solid ones dark. y is up.
std::string pvs_svg(const pvs::Pvs& pvs, const pvs::BakeGeometry& geometry, std::uint32_t cell) {
    return Map(pvs, geometry, cell).draw();
}

constexpr double kSaveSeconds = 20.0;
// Relative to the near radius: keeps the walls of a room far enough from its cell for proofs.
constexpr double kInset = 1.01;
constexpr std::uint32_t kByScene = ~std::uint32_t{0}, kStepsInLevels = 10000;

struct PvsRequest {
    ReadOptions read;
    std::string scene, map, cells, eyes, sides = "both", shard, state, out, svg, eye, json;
    double reach = 0.0, height = 10.0, epsilon = 1e-4, confidence = 0.999, seconds = 0.0, near_radius = 0.5,
           cell_size = HUGE_VAL;
    std::uint64_t seed = 1;
    std::uint32_t instances = 0, halvings = 4, surface_steps = kByScene, views = 0;
    unsigned threads = 1;
    bool with_scene = false;
};

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Job {
    const PvsRequest& options;
    assets::SceneSource source;
    pipeline::PvsScene scene;
    pvs::Cells cells;
    pvs::Shard shard;
    Vector<std::byte> scene_file;  // of --with-scene
    double trace_seconds = 0.0, proof_seconds = 0.0;
};

Result<Job> make_job(const PvsRequest& options, Executor& executor) {
    const auto shard = shard_from(options.shard);
    if (!shard) return shard.error();
    if (!options.shard.empty() && options.state.empty())
        return fail(ErrorCode::invalid_argument, kNoItem, "--shard needs --state: the part to write");
    auto source =
        load_updated_scene(options.scene, options.read,
                           {.map = options.map, .seed = options.seed, .instances = options.instances}, executor);
    if (!source) return source.error();
    Aabb eyes = pipeline::eyes_of(source->scene, options.height);
    if (!options.eyes.empty()) {
        double x[6];
        if (auto read = read_numbers("--eyes", options.eyes, x); !read) return read.error();
        eyes = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
    }
    auto cells = cells_from(options.cells.empty() ? "64x2x64" : options.cells, eyes, *source,
                            {.inset = kInset * options.near_radius, .size = options.cell_size}, options.read.limits);
    if (!cells) return cells.error();
    auto scene =
        pipeline::make_pvs_scene(*source, !options.out.empty() || !options.svg.empty() || options.views > 0, executor);
    if (!scene) return scene.error();
    // Before the lines: once they are interrupted, little is left to do.
    Vector<std::byte> scene_file;
    if (options.with_scene) {
        auto baked = assets::bake_source(*source, executor);
        if (!baked) return baked.error();
        scene_file = std::move(*baked);
    }
    return Job{options, std::move(*source), std::move(*scene), std::move(*cells), *shard, std::move(scene_file)};
}

// Levels have no bodies; other scenes mostly do, and many more triangles.
std::uint32_t surface_steps_of(const Job& job) {
    if (job.options.surface_steps != kByScene) return job.options.surface_steps;
    if (!job.scene.found) return 0;
    const auto& kinds = job.scene.found->kinds;
    const bool is_level = std::any_of(kinds.begin(), kinds.end(), [](const auto& kind) { return kind.is_level; });
    return is_level ? kStepsInLevels : 0;
}

// A part of the work, with its name and its share that is done.
struct PartProgress {
    ProgressBar bar;
    explicit PartProgress(const char* name) : bar(name, 1000) {}
    static bool should_stop(void* user, double share) {
        static_cast<PartProgress*>(user)->bar.set(static_cast<std::size_t>(1000.0 * share));
        return interrupted();
    }
};

Result<void> save(const std::string& path, const pvs::Bake& bake) {
    if (path.empty()) return {};
    const auto bytes = bake.state();
    if (!bytes) return bytes.error();
    return write_file(path, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<void> load_state(const std::string& path, pvs::Bake& bake, const PvsRequest& options) {
    if (path.empty() || !std::filesystem::exists(path)) return {};
    const auto file =
        bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = options.read.limits.bytes});
    if (!file) return file.error();
    if (auto added = bake.add_state(file->bytes()); !added)
        return fail(added.error().code, kNoItem, path + ": " + added.error().message);
    return {};
}

// Traces until the shard, the time or the user's patience ends; what there is has been saved then.
Result<void> trace(Job& job, pvs::Bake& bake, Executor& executor) {
    if (auto loaded = load_state(job.options.state, bake, job.options); !loaded) return loaded;
    PartProgress progress("pvs: lines");
    const auto start = Clock::now();
    for (bool done = false; !done;) {
        const std::uint64_t before = bake.lines_done();
        double seconds = kSaveSeconds;
        if (job.options.seconds > 0.0) seconds = std::min(seconds, job.options.seconds - seconds_since(start));
        const auto ran = bake.run(
            {.seconds = seconds, .shard = job.shard, .should_stop = PartProgress::should_stop, .user = &progress},
            executor);
        if (!ran) return ran;
        done = interrupted() || bake.lines_done() == before ||
               (job.options.seconds > 0.0 && seconds_since(start) >= job.options.seconds);
        job.trace_seconds = seconds_since(start);
        if (auto saved = save(job.options.state, bake); !saved) return saved;
    }
    return {};
}

// The cell that is nearest to the middle of all, of those that eyes may be in.
std::uint32_t middle_cell(const pvs::Pvs& sets) {
    const pvs::Cells& cells = sets.cells();
    const glm::dvec3 middle = cells.bounds().center();
    std::uint32_t best = pvs::kNoCell;
    double least = HUGE_VAL;
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
        if (sets.kind(c) == pvs::CellKind::solid || sets.kind(c) == pvs::CellKind::unknown) continue;
        const double distance = glm::distance(cells.box(c).center(), middle);
        if (distance < least) least = distance, best = c;
    }
    return best;
}

Result<void> write_outputs(const Job& job, const pvs::Pvs& sets, std::size_t& file_bytes) {
    const PvsRequest& options = job.options;
    if (!options.out.empty()) {
        const auto file = sets.to_file(job.scene_file);
        if (!file) return file.error();
        file_bytes = file->size() - job.scene_file.size();
        if (auto written = write_file(options.out, {reinterpret_cast<const char*>(file->data()), file->size()});
            !written)
            return written;
    }
    if (options.svg.empty()) return {};
    std::uint32_t cell = middle_cell(sets);
    if (!options.eye.empty()) {
        double x[3];
        if (auto read = read_numbers("--eye", options.eye, x); !read) return read;
        cell = sets.cells().find({x[0], x[1], x[2]});
    }
    if (cell == pvs::kNoCell) return fail(ErrorCode::out_of_range, kNoItem, "--eye: no cell holds it");
    return write_file(options.svg, pvs_svg(sets, job.scene.geometry, cell));
}

Json to_json(const pipeline::PvsModeFigures& mode) {
    return {{"wrong_pixels_mean", mode.wrong_mean},
            {"wrong_pixels_worst", mode.wrong_worst},
            {"triangles", mode.triangles}};
}

Json to_json(const Views& views) {
    if (!views) return nullptr;
    return {{"views", views->views},
            {"eyes_in_no_cell", views->in_no_cell},
            {"frustum_triangles", views->frustum_triangles},
            {"owner_triangles", views->owner_triangles},
            {"conservative", to_json(views->conservative)},
            {"statistical", to_json(views->statistical)},
            {"occlusion", to_json(views->occlusion)},
            {"conservative_and_occlusion", to_json(views->conservative_and_occlusion)},
            {"statistical_and_occlusion", to_json(views->statistical_and_occlusion)}};
}

void print(const pipeline::PvsViewFigures& views) {
    print_to(
        stdout,
        "%u street views: wrong pixels, mean and worst; triangles a view, and over those of objects that own a pixel\n",
        views.views);
    const auto row = [&](const char* name, const pipeline::PvsModeFigures& mode) {
        print_to(stdout, "  %-26s %8.2g %8.2g %10.0f %7.2f\n", name, mode.wrong_mean, mode.wrong_worst, mode.triangles,
                 mode.triangles / std::max(1.0, views.owner_triangles));
    };
    row("conservative", views.conservative);
    row("statistical", views.statistical);
    row("conservative and occlusion", views.conservative_and_occlusion);
    row("statistical and occlusion", views.statistical_and_occlusion);
    row("occlusion alone", views.occlusion);
    row("frustum alone", {0.0, 0.0, views.frustum_triangles});
}

Json figures(const Job& job, const pvs::Bake& bake, const pvs::Pvs& sets, std::size_t file_bytes, const Views& views) {
    const pvs::PairCounts counts = sets.counts();
    std::size_t kinds[4] = {};
    for (std::size_t c = 0; c < sets.cells().size(); ++c) ++kinds[static_cast<std::size_t>(sets.kind(c))];
    const auto share = [&](std::uint64_t pairs) {
        return static_cast<double>(pairs) / static_cast<double>(std::max<std::uint64_t>(1, counts.all()));
    };
    const Aabb& bounds = sets.cells().bounds();
    return {{"scene", job.source.name},
            {"cells", sets.cells().size()},
            {"cells_unknown", kinds[0]},
            {"cells_solid", kinds[1]},
            {"cells_inner", kinds[2]},
            {"cells_open", kinds[3]},
            {"eyes", {bounds.min.x, bounds.min.y, bounds.min.z, bounds.max.x, bounds.max.y, bounds.max.z}},
            {"objects", sets.object_count()},
            {"triangles", job.scene.geometry.object_of.size()},
            {"occluders", job.scene.occluders.size()},
            {"pairs", counts.all()},
            {"seen", share(counts.seen)},
            {"hidden", share(counts.hidden)},
            {"unseen", share(counts.unseen)},
            {"lines_planned", bake.lines_planned()},
            {"lines", bake.lines_done()},
            {"epsilon", sets.epsilon()},
            {"confidence", sets.confidence()},
            {"bytes", file_bytes},
            {"bits_a_pair", 8.0 * static_cast<double>(file_bytes) /
                                static_cast<double>(sets.cells().size() * std::max(1u, sets.object_count()))},
            {"trace_seconds", job.trace_seconds},
            {"proof_seconds", job.proof_seconds},
            {"street_views", to_json(views)}};
}

void print_figures(const Job& job, const pvs::Bake& bake, const pvs::Pvs& sets, std::size_t file_bytes) {
    const pvs::PairCounts counts = sets.counts();
    std::size_t solid = 0, open = 0;
    for (std::size_t c = 0; c < sets.cells().size(); ++c) {
        solid += sets.kind(c) == pvs::CellKind::solid;
        open += sets.kind(c) == pvs::CellKind::open;
    }
    const auto percent = [&](std::uint64_t pairs) {
        return 100.0 * static_cast<double>(pairs) / static_cast<double>(std::max<std::uint64_t>(1, counts.all()));
    };
    char promise[120] = "nothing is promised yet: the first round of lines is not complete\n";
    if (std::isfinite(sets.epsilon()))
        std::snprintf(promise, sizeof promise, "no pair above %.3g of its cell's lines is missed, with confidence %g\n",
                      sets.epsilon(), sets.confidence());
    print_to(stdout,
             "%s: %zu cells (%zu solid, %zu that see out of the scene), %u objects, %llu of %llu lines in %.1f s\n"
             "%s"
             "pairs: %.1f %% seen, %.1f %% proved hidden (%.1f s), %.1f %% unseen\n",
             printable(job.source.name).c_str(), sets.cells().size(), solid, open, sets.object_count(),
             static_cast<unsigned long long>(bake.lines_done()), static_cast<unsigned long long>(bake.lines_planned()),
             job.trace_seconds, promise, percent(counts.seen), percent(counts.hidden), job.proof_seconds,
             percent(counts.unseen));
    const double pairs = static_cast<double>(sets.cells().size()) * std::max(1u, sets.object_count());
    if (file_bytes > 0)
        print_to(stdout, "%.1f kB, %.3f bits a pair\n", 1e-3 * static_cast<double>(file_bytes),
                 8.0 * static_cast<double>(file_bytes) / pairs);
}

// Returns what the lines have seen, and proofs for the rest. Proves nothing more once interrupted.
Result<pvs::Pvs> finish_sets(Job& job, const pvs::Bake& bake, Executor& executor) {
    PartProgress progress("pvs: proofs");
    const auto start = Clock::now();
    auto sets =
        pvs::Pvs::finish(bake, job.options.shard.empty() ? job.scene.occluders : std::vector<pvs::PlacedOccluder>{},
                         {.near_radius = job.options.near_radius,
                          .halvings = job.options.halvings,
                          .surface_steps = surface_steps_of(job),
                          .should_stop = PartProgress::should_stop,
                          .user = &progress},
                         executor);
    job.proof_seconds = seconds_since(start);
    return sets;
}

// Looks from random places, as many as there is time for.
Result<Views> look_from_places(const Job& job, const pvs::Pvs& sets, Executor& executor) {
    if (job.options.views == 0 || interrupted()) return Views{};
    PartProgress progress("pvs: views");
    const auto looked = pipeline::look_at_views(job.source.scene, job.scene.geometry, sets,
                                                {.views = job.options.views,
                                                 .seed = job.options.seed,
                                                 .near_radius = job.options.near_radius,
                                                 .occluders = job.scene.found,
                                                 .unit = job.source.unit,
                                                 .should_stop = PartProgress::should_stop,
                                                 .user = &progress},
                                                executor);
    if (!looked && looked.error().code == ErrorCode::cancelled) return Views{};
    if (!looked) return looked.error();
    return Views{*looked};
}

// Sets of each region of a folder, by the options that make sense there.
Result<int> run_regions(const PvsRequest& options, Executor& executor) {
    const PvsRequest fixed;
    if (options.state != fixed.state || options.out != fixed.out || options.svg != fixed.svg || options.views != 0 ||
        options.map != fixed.map || options.instances != 0 || options.eyes != fixed.eyes || options.seconds > 0.0)
        return fail(ErrorCode::unsupported, kNoItem,
                    "--state, --out, --svg, --views, --map, --instances, --eyes and --seconds are not for a folder of "
                    "regions: sets are written next to the regions, and a run continues where one was interrupted");
    const auto shard = shard_from(options.shard);
    if (!shard) return shard.error();
    RegionSetsBake bake;
    bake.folder = options.scene;
    if (!options.cells.empty()) {
        const auto grid = grid_from(options.cells);
        if (!grid) return fail(ErrorCode::invalid_argument, kNoItem, "--cells: regions have NXxNYxNZ cells each");
        bake.cells = *grid;
    }
    bake.height = options.height;
    bake.reach = options.reach;
    bake.lines = {.epsilon = options.epsilon,
                  .confidence = options.confidence,
                  .seed = options.seed,
                  .sides = options.sides == "front" ? occlude::Sides::front : occlude::Sides::both};
    bake.proofs.near_radius = options.near_radius;
    bake.proofs.halvings = options.halvings;
    bake.proofs.surface_steps = options.surface_steps == kByScene ? 0 : options.surface_steps;
    bake.shard = *shard;
    bake.largest_file = options.read.limits.bytes;
    bake.json = options.json;
    return bake_region_sets(bake, executor);
}

Result<int> run_pvs(const PvsRequest& options) {
    ThreadPool pool(options.threads);
    if (pipeline::holds_regions(options.scene)) return run_regions(options, pool);
    if (options.reach > 0.0) return fail(ErrorCode::invalid_argument, kNoItem, "--reach is for a folder of regions");
    auto job = make_job(options, pool);
    if (!job) return job.error();
    catch_interrupts();  // before, there is nothing to keep
    auto bake = pvs::Bake::create(job->scene.geometry, job->cells,
                                  {.epsilon = options.epsilon,
                                   .confidence = options.confidence,
                                   .seed = options.seed,
                                   .sides = options.sides == "front" ? occlude::Sides::front : occlude::Sides::both});
    if (!bake) return bake.error();
    if (auto traced = trace(*job, *bake, pool); !traced) return traced.error();
    if (interrupted())
        print_to(stderr, "crofton: interrupted after %llu of %llu lines%s\n",
                 static_cast<unsigned long long>(bake->lines_done()),
                 static_cast<unsigned long long>(bake->lines_planned()),
                 options.state.empty() ? "; with --state the next run would continue from here"
                                       : ": the next run continues from here");
    const bool all_lines = !interrupted();
    const auto sets = finish_sets(*job, *bake, pool);
    if (!sets) return sets.error();
    if (all_lines && interrupted())
        std::fputs("crofton: interrupted: pairs whose proof was not reached count as unseen, so that they are drawn\n",
                   stderr);
    finish_what_there_is();
    std::size_t file_bytes = 0;
    if (auto written = write_outputs(*job, *sets, file_bytes); !written) return written.error();
    const auto views = look_from_places(*job, *sets, pool);
    if (!views) return views.error();
    if (options.views > 0 && !*views) std::fputs("crofton: interrupted: there are no figures of --views\n", stderr);
    if (options.json != "-") {
        print_figures(*job, *bake, *sets, file_bytes);
        if (*views) print(**views);
    }
    if (!options.json.empty())
        if (auto written = write_json(options.json, figures(*job, *bake, *sets, file_bytes, *views)); !written)
            return written.error();
    return interrupted() ? kInterrupted : kSuccess;
}

}  // namespace

void add_pvs_command(CommandLine& line) {
    auto options = std::make_shared<PvsRequest>();
    Command command = line.command("pvs", "Bake visible sets: the objects that can be seen from each cell of a level");
    command.footer(
        "Cells are NXxNYxNZ equal boxes over the possible eye positions, or a file with a box per line: six numbers, "
        "min and max.\n"
        "Exit status: 0 done, 2 bad usage or input, 130 interrupted (results so far have been written).\n"
        "\n"
        "Examples:\n"
        "  crofton pvs town --cells 64x2x64 --out town_pvs.crofton --svg town.svg\n"
        "  crofton pvs level.wad --map MAP01 --cells rooms --near 0.2 --out map01.crofton\n"
        "  crofton pvs town --shard 0/2 --state part0       # half of the lines; the others: 1/2, part1\n"
        "  crofton merge part0 part1 --out town.state       # then both together\n"
        "  crofton pvs town --state town.state --out town_pvs.crofton --views 1000\n"
        "  crofton pvs regions/ --cells 8x1x8 --reach 50    # a file of sets for each region of a folder");
    command
        .option(
            "scene", options->scene,
            "town, room, office, valley, hall, a folder of city parts or of regions, or a .glb, .gltf, .obj, .wad or "
            ".crofton file")
        .required();
    command.option(
        "--cells", options->cells,
        "NXxNYxNZ, rooms (the sectors of a WAD, cut into convex pieces), or a file of boxes and convex cells. "
        "Default: 64x2x64; of each region in a folder 8x1x8");
    const Option cell_size =
        command
            .option("--cell-size", options->cell_size, "With --cells rooms: cut cells until none is longer in x or z")
            .positive();
    const Option eyes = command.option("--eyes", options->eyes,
                                       "x,y,z,x,y,z: the box of the grid; by default where the scene is dense");
    command
        .option("--height", options->height,
                "Height of the grid over the lowest point, without --eyes; the grid begins at a twentieth of it")
        .positive()
        .show_default()
        .excludes(eyes);
    command
        .option("--reach", options->reach,
                "Of a folder of regions: how far cells reach in x and z beyond a region's objects")
        .not_negative();
    command.option("--epsilon", options->epsilon, "Share of the lines through a cell above which no pair is missed")
        .show_default();
    command.option("--confidence", options->confidence, "Confidence that no such pair is missed").show_default();
    command.option("--seconds", options->seconds, "Stop tracing after this time").positive();
    command.option("--sides", options->sides, "The sides of triangles that you draw: both or front")
        .one_of({"both", "front"})
        .show_default();
    const Option shard = command.option("--shard", options->shard, "i/n: trace only part i of n; needs --state");
    command.option("--state", options->state, "Save to this file from time to time; continue from it if it exists")
        .writable_file();
    command
        .option("--near", options->near_radius, "Largest distance of a point of the camera's near plane from the eye")
        .not_negative()
        .show_default();
    command
        .option("--halvings", options->halvings,
                "How often to halve cells and boxes that no single proof hides: more prove more")
        .whole_between(0, 16)
        .show_default();
    command
        .option("--surface-steps", options->surface_steps,
                "Triangle sides that a proof by the scene's own surface may visit; 0: prove by bodies only. By default "
                "10000 in levels (minutes for thousands of cells), otherwise 0")
        .whole_between(0, 1'000'000);
    const Option out =
        command.option("--out", options->out, "Write the sets to this .crofton file").writable_file().excludes(shard);
    command.flag("--with-scene", options->with_scene, "Put the baked scene into the same file").needs(out);
    const Option svg = command.option("--svg", options->svg, "Write a map of the objects that one cell sees, as SVG")
                           .writable_file()
                           .excludes(shard);
    command.option("--eye", options->eye, "x,y,z: a point in the map's cell; by default the middle cell").needs(svg);
    command
        .option("--views", options->views,
                "Test the sets from this many random places: wrong pixels and triangles in either mode, with and "
                "without occlusion")
        .whole_between(1, 1'000'000)
        .excludes(shard);
    command.option("--seed", options->seed, "Seed of the lines, of the town and of the views").show_default();
    command.option("--instances", options->instances, "Approximate number of instances of the town");
    command.option("--map", options->map, "Level of a .wad file");
    command.option("--threads", options->threads, "Worker threads; 0: one per core")
        .whole_between(0, 256)
        .show_default();
    command.option("--json", options->json, "Write the figures as JSON; - for stdout").writable_file_or_stdout();
    add_unit_option(command, options->read);
    add_read_options(command, options->read);
    command.action([options, cell_size] {
        if (cell_size.given() && options->cells != "rooms")
            return report_error("", {ErrorCode::invalid_argument, kNoItem, "--cell-size needs --cells rooms"});
        const auto done = run_pvs(*options);
        return done ? *done : report_error("", done.error());
    });
}

}  // namespace crofton::cli
