// `crofton radiosity`: light in a scene, to a target error, baked into vertex colours.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <crofton/core/thread_pool.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/flat_scene.hpp"
#include "commands.hpp"
#include "pipeline/camera_path.hpp"
#include "progress_bar.hpp"
#include "radiosity_output.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
    std::string scene, method = "global", out, png, json, checkpoint, map;
    std::uint64_t lines = 1'000'000, seed = 1;
    double error = 0.0, edge = 0.0, sky = 1.0, sun = 3.0, exposure = 1.0;
    unsigned threads = 1;
};

Result<radiosity::SolverOptions> solver_options(const Options& options) {
    radiosity::SolverOptions result;
    result.seed = options.seed;
    if (options.method == "local")
        result.transport = radiosity::Transport::local;
    else if (options.method == "bundles")
        result.method = radiosity::LineMethod::bundles;
    else if (options.method == "walls")
        result.method = radiosity::LineMethod::walls;
    else if (options.method != "global")
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--method: " + options.method + " is none of local, global, bundles, walls");
    const float sky = static_cast<float>(options.sky), sun = static_cast<float>(options.sun);
    result.outside.sky = glm::vec3(0.75f, 0.88f, 1.1f) * sky;
    result.outside.sun = glm::vec3(1.05f, 0.98f, 0.86f) * sun;
    result.outside.to_sun = {0.75, 0.6, 0.3};
    result.cutoff = 1e-3;
    return result;
}

Result<radiosity::Patches> patches_of(const Options& options, const assets::SceneSource& source) {
    TriangleMesh mesh = assets::flat_scene(source).mesh;
    if (options.edge > 0.0) {
        auto refined = radiosity::refine(mesh, options.edge);
        if (!refined) return tl::unexpected(refined.error());
        mesh = std::move(refined->mesh);
    }
    Vector<radiosity::Material> materials(mesh.triangle_count());
    for (std::size_t t = 0; t < materials.size(); ++t)
        for (int k = 0; k < 3; ++k)
            materials[t].reflectance[k] = std::clamp(mesh.colors[mesh.indices[3 * t]][k], 0.0f, 0.9f);
    return radiosity::make_patches(std::move(mesh), materials);
}

Result<void> save_checkpoint(const std::string& path, const radiosity::Solver& solver) {
    const auto bytes = solver.checkpoint();
    return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// Runs until the error or the number of lines is reached.
Result<void> solve(const Options& options, radiosity::Solver& solver, Executor& executor) {
    if (!options.checkpoint.empty() && std::filesystem::exists(options.checkpoint)) {
        const auto bytes = read_file(options.checkpoint);
        if (!bytes) return tl::unexpected(bytes.error());
        if (auto resumed = solver.resume(std::as_bytes(std::span(*bytes))); !resumed)
            return fail(resumed.error().code, kNoItem, options.checkpoint + ": " + resumed.error().message);
    }
    const auto done = [&] {
        if (solver.runs() < 2) return false;
        return options.error > 0.0 ? solver.relative_error() <= options.error : solver.lines_traced() >= options.lines;
    };
    ProgressBar bar("radiosity", 1000);
    while (!done()) {
        solver.run(executor);
        const double share = options.error > 0.0
                                 ? std::pow(options.error / solver.relative_error(), 2.0)
                                 : static_cast<double>(solver.lines_traced()) / static_cast<double>(options.lines);
        bar.set(static_cast<std::size_t>(1000.0 * std::min(1.0, share)));
        if (options.checkpoint.empty()) continue;
        if (auto saved = save_checkpoint(options.checkpoint, solver); !saved) return saved;
    }
    return {};
}

Result<void> run(const Options& options) {
    const auto parameters = solver_options(options);
    if (!parameters) return tl::unexpected(parameters.error());
    assets::LoadOptions load;
    load.map = options.map;
    load.seed = options.seed;
    auto source = assets::load_scene(options.scene, load);
    if (!source) return tl::unexpected(source.error());
    source->scene.update();
    const auto patches = patches_of(options, *source);
    if (!patches) return tl::unexpected(patches.error());
    auto solver = radiosity::Solver::create(*patches, *parameters);
    if (!solver) return tl::unexpected(solver.error());
    ThreadPool pool(options.threads);
    const auto start = Clock::now();
    if (auto solved = solve(options, *solver, pool); !solved) return solved;
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const TriangleMesh lit = baked(*patches, solver->radiosity(), options.exposure);
    if (!options.out.empty())
        if (auto written = write_glb(options.out, lit); !written) return written;
    if (!options.png.empty()) {
        const bool inside = source->name == "room";
        auto cameras = pipeline::make_camera_path({inside ? "street" : "orbit", 8, options.seed, 16.0 / 9.0},
                                                  pipeline::focus_of(source->scene), source->walk);
        if (!cameras) return tl::unexpected(cameras.error());
        if (auto written = write_lit_picture(options.png, lit, cameras->front(), 1280, 720); !written) return written;
    }
    const auto seen =
        radiosity::visibility_complexity(*radiosity::LineTracer::build(patches->mesh),
                                         radiosity::LineSource(radiosity::LineTracer::build(patches->mesh)->bounds(),
                                                               radiosity::LineMethod::walls, options.seed),
                                         50);
    const nlohmann::json report = {
        {"scene", source->name},
        {"patches", patches->count()},
        {"method", options.method},
        {"lines_from", radiosity::to_string(solver->method())},
        {"runs", solver->runs()},
        {"lines", solver->lines_traced()},
        {"relative_error", solver->relative_error()},
        {"unseen", solver->unseen()},
        {"seconds", seconds},
        {"visibility",
         {{"mean_crossings", seen.mean_crossings}, {"deviation", seen.deviation}, {"wasted", seen.wasted}}}};
    if (!options.json.empty()) return write_json(options.json, report);
    std::printf("%s: %zu patches, %llu runs, %llu lines in %.1f s, relative error %.3f %%\n", source->name.c_str(),
                patches->count(), static_cast<unsigned long long>(solver->runs()),
                static_cast<unsigned long long>(solver->lines_traced()), seconds, 100.0 * solver->relative_error());
    return {};
}

}  // namespace

void add_radiosity_command(CLI::App& app, Outcome& outcome) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("radiosity", "Light a scene by global lines and bake it into vertex colours");
    command->footer(
        "Examples:\n"
        "  crofton radiosity room --edge 0.2 --error 0.02 --out room.glb --png room.png\n"
        "  crofton radiosity town --lines 20000000 --checkpoint town.state --out town.glb\n"
        "  crofton radiosity level.wad --map MAP01 --method local --json -\n");
    command->add_option("scene", options->scene, "town, room, or a .glb, .gltf, .obj or .wad file")->required();
    auto* lines = command->add_option("--lines", options->lines, "Trace about this many lines")->capture_default_str();
    command->add_option("--error", options->error, "Stop at this relative error instead, for example 0.02")
        ->check(CLI::PositiveNumber)
        ->excludes(lines);
    command->add_option("--method", options->method, "local, global, bundles or walls")->capture_default_str();
    command->add_option("--edge", options->edge, "Cut patches until no edge is longer (metres)")
        ->check(CLI::PositiveNumber);
    command->add_option("--sky", options->sky, "Radiosity of the sky")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_option("--sun", options->sun, "Irradiance toward the sun")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_option("--exposure", options->exposure, "Factor from radiosity to colour")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Seed of the lines and of the town")->capture_default_str();
    command->add_option("--map", options->map, "Which level of a .wad");
    command->add_option("--threads", options->threads, "Worker threads; 0: one per core")->capture_default_str();
    command->add_option("--out", options->out, "Write the lit scene as .glb");
    command->add_option("--png", options->png, "Write a picture of it");
    command->add_option("--json", options->json, "Write the figures as JSON; - for stdout");
    command->add_option("--checkpoint", options->checkpoint,
                        "Save after every run to this file; go on from it where it exists");
    command->callback([options, &outcome] {
        if (const auto done = run(*options); !done) outcome.status = report_error("", done.error());
    });
}

}  // namespace crofton::cli
