// SPDX-License-Identifier: MIT
// `crofton radiosity`: light in a scene, to a target error, baked into vertex colours.
#include <chrono>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "assets/flat_scene.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "pipeline/camera_path.hpp"
#include "progress_bar.hpp"
#include "radiosity_light_field.hpp"
#include "radiosity_output.hpp"
#include "read_options.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct RadiosityOptions {
    ReadOptions read;
    std::string scene, method = "global", out, png, light_field, json, checkpoint, map;
    std::uint64_t lines = 20'000'000, seed = 1, stored_lines = 1 << 22;
    double error = 0.0, edge = 0.0, sky = 1.0, sun = 3.0, exposure = 0.0;
    unsigned threads = 1;
};

Result<radiosity::SolverOptions> solver_options(const RadiosityOptions& options) {
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
    return result;
}

// Into the room from a corner, over the table to the window; elsewhere from above.
Result<Camera> camera_for(const assets::SceneSource& source, std::uint64_t seed) {
    if (source.name == "room") {
        Camera camera;
        camera.position = {0.45, 1.6, 3.75};
        camera.forward = {3.2, -0.55, -2.2};
        camera.fov_y = 1.15;
        camera.near_distance = 0.05;
        return camera;
    }
    auto path =
        pipeline::make_camera_path({"orbit", 8, seed, 16.0 / 9.0, {}}, pipeline::focus_of(source.scene), source.walk);
    if (!path) return tl::unexpected(path.error());
    return path->cameras.front();
}

Result<void> save_checkpoint(const std::string& path, const radiosity::Solver& solver) {
    const auto bytes = solver.checkpoint();
    return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// Runs until the error or the number of lines is reached.
Result<void> solve(const RadiosityOptions& options, radiosity::Solver& solver, Executor& executor) {
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
    while (!done() && !interrupted()) {
        solver.run(executor);
        const double share = options.error > 0.0
                                 ? std::pow(options.error / solver.relative_error(), 2.0)
                                 : static_cast<double>(solver.lines_traced()) / static_cast<double>(options.lines);
        bar.set(static_cast<std::size_t>(1000.0 * std::min(1.0, share)));
        if (options.checkpoint.empty()) continue;
        if (auto saved = save_checkpoint(options.checkpoint, solver); !saved) return saved;
    }
    if (solver.runs() == 0) return fail(ErrorCode::cancelled, kNoItem, "interrupted before the first run");
    return {};
}

Result<int> run_radiosity(const RadiosityOptions& options) {
    catch_interrupts();
    const auto parameters = solver_options(options);
    if (!parameters) return tl::unexpected(parameters.error());
    const auto source = load_updated_scene(options.scene, options.read, {.map = options.map, .seed = options.seed});
    if (!source) return tl::unexpected(source.error());
    const auto flat = assets::flat_scene(*source, options.read.limits);
    if (!flat) return tl::unexpected(flat.error());
    const auto lit = lit_scene(*flat, options.edge);
    if (!lit) return tl::unexpected(lit.error());
    auto solver = radiosity::Solver::create(lit->patches, *parameters);
    if (!solver) return tl::unexpected(solver.error());
    ThreadPool pool(options.threads);
    const auto start = Clock::now();
    if (auto solved = solve(options, *solver, pool); !solved) return tl::unexpected(solved.error());
    const bool cut_short = interrupted();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const TriangleMesh light = lit_mesh(*lit, *solver);
    const float exposure =
        options.exposure > 0.0 ? static_cast<float>(options.exposure) : automatic_exposure(*lit, *solver);
    TriangleMesh picture = light;
    for (glm::vec3& color : picture.colors) color = compressed(exposure * color);
    if (!options.out.empty())
        if (auto written = write_glb(options.out, picture); !written) return tl::unexpected(written.error());
    if (!options.png.empty()) {
        const auto camera = camera_for(*source, options.seed);
        if (!camera) return tl::unexpected(camera.error());
        const float sky = static_cast<float>(std::min(1.0, options.sky));
        if (auto written = write_lit_picture(options.png, picture, *camera, 1280, 720, sky); !written)
            return tl::unexpected(written.error());
    }
    const auto tracer = radiosity::LineTracer::build(lit->patches.mesh);
    if (!tracer) return tl::unexpected(tracer.error());
    std::optional<LightFieldReport> field;
    if (!options.light_field.empty()) {
        const auto camera = camera_for(*source, options.seed);
        if (!camera) return tl::unexpected(camera.error());
        auto drawn = draw_light_field({light, *tracer, parameters->outside.sky, *camera, exposure, options.stored_lines,
                                       options.seed, options.light_field},
                                      pool);
        if (!drawn) return tl::unexpected(drawn.error());
        field = *drawn;
    }
    const auto seen = radiosity::visibility_complexity(
        *tracer, radiosity::LineSource(tracer->bounds(), radiosity::LineMethod::walls, options.seed), 50);
    glm::dvec3 mean(0.0);
    double area = 0.0;
    for (std::size_t i = 0; i < lit->patches.count(); ++i) {
        mean += lit->patches.areas[i] * glm::dvec3(solver->radiosity()[i]);
        area += lit->patches.areas[i];
    }
    mean /= area;
    const Json report = {
        {"scene", source->name},
        {"patches", lit->patches.count()},
        {"triangles", lit->patches.mesh.triangle_count()},
        {"solver_bytes", solver->bytes()},
        {"method", options.method},
        {"lines_from", radiosity::to_string(solver->method())},
        {"runs", solver->runs()},
        {"lines", solver->lines_traced()},
        {"relative_error", solver->relative_error()},
        {"unseen", solver->unseen()},
        {"bounces", solver->bounces_of_last_run()},
        {"mean_radiosity", {mean.x, mean.y, mean.z}},
        {"seconds", seconds},
        {"light_field", field ? to_json(*field) : Json(nullptr)},
        {"visibility",
         {{"mean_crossings", seen.mean_crossings}, {"deviation", seen.deviation}, {"wasted", seen.wasted}}}};
    if (cut_short)
        std::fprintf(stderr, "crofton: interrupted: what %llu runs found is written%s\n",
                     static_cast<unsigned long long>(solver->runs()),
                     options.checkpoint.empty() ? "; with --checkpoint the next run would go on from here" : "");
    const int status = cut_short ? kInterrupted : kSuccess;
    if (!options.json.empty()) {
        if (auto written = write_json(options.json, report); !written) return tl::unexpected(written.error());
        return status;
    }
    std::printf("%s: %zu patches, %llu runs, %llu lines in %.1f s, relative error %.3f %%\n", source->name.c_str(),
                lit->patches.count(), static_cast<unsigned long long>(solver->runs()),
                static_cast<unsigned long long>(solver->lines_traced()), seconds, 100.0 * solver->relative_error());
    if (field) print(*field);
    return status;
}

}  // namespace

void add_radiosity_command(CommandLine& line) {
    auto options = std::make_shared<RadiosityOptions>();
    Command command = line.command("radiosity", "Light a scene by global lines and bake it into vertex colours");
    command.footer(
        "Colours are reflectances; above 0.9, white paint's, they count as 0.9, so that light ends. Triangles of no "
        "area are "
        "left out.\n"
        "Light comes from the sun and the sky, from emission in glTF and OBJ materials, and from the town's and room's "
        "lamps.\n\n"
        "Examples:\n"
        "  crofton radiosity room --edge 0.2 --error 0.02 --out room.glb --png room.png\n"
        "  crofton radiosity town --lines 20000000 --checkpoint town.state --out town.glb\n"
        "  crofton radiosity room --light-field lines.png --stored-lines 16000000\n"
        "  crofton radiosity level.wad --map MAP01 --method local --json -\n");
    command.option("scene", options->scene, "town, room, or a .glb, .gltf, .obj or .wad file").required();
    const Option lines =
        command.option("--lines", options->lines, "Trace about this many lines, in two runs or more").show_default();
    command.option("--error", options->error, "Stop at this relative error instead, for example 0.02")
        .positive()
        .excludes(lines);
    command.option("--method", options->method, "local, global, bundles or walls").show_default();
    command.option("--edge", options->edge, "Cut patches until no edge is longer (metres); automatic without")
        .positive();
    command.option("--sky", options->sky, "Radiosity of the sky").not_negative().show_default();
    command.option("--sun", options->sun, "Irradiance toward the sun").not_negative().show_default();
    command.option("--exposure", options->exposure, "Factor from radiosity to colour; automatic without").positive();
    command.option("--seed", options->seed, "Seed of the lines and of the town").show_default();
    command.option("--map", options->map, "Which level of a .wad");
    command.option("--threads", options->threads, "Worker threads; 0: one per core")
        .whole_between(0, 256)
        .show_default();
    command.option("--out", options->out, "Write the lit scene as .glb").writable_file();
    command.option("--png", options->png, "Write a picture of it").writable_file();
    command
        .option("--light-field", options->light_field,
                "Store global lines with the light along them, draw a picture from these lines alone, and say how far "
                "it is from the scene's own")
        .writable_file();
    command.option("--stored-lines", options->stored_lines, "--light-field: about so many lines")
        .whole_between(1, 1 << 28)
        .show_default();
    command.option("--json", options->json, "Write the figures as JSON; - for stdout").writable_file();
    command
        .option("--checkpoint", options->checkpoint, "Save after every run to this file; go on from it where it exists")
        .writable_file();
    add_read_options(command, options->read);
    command.action([options] {
        const auto done = run_radiosity(*options);
        return done ? *done : report_error("", done.error());
    });
}

}  // namespace crofton::cli
