// SPDX-License-Identifier: MIT
// `crofton study radiosity`: light in a scene, to a target error, baked into vertex colours.
#include <chrono>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/solver.hpp>
#include <crofton/study/light_field.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <glm/geometric.hpp>
#include <optional>
#include <string>

#include "assets/flat_scene.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/png.hpp"
#include "progress_bar.hpp"
#include "pvs_cells.hpp"
#include "radiosity_output.hpp"
#include "read_options.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct LightFieldRun {
    const TriangleMesh& light;  // three vertices a triangle, colours: what leaves there
    const lines::LineTracer& tracer;
    glm::vec3 sky;
    const Camera& camera;
    float exposure;
    std::uint64_t lines, seed;
    std::string png_path;
};

struct LightFieldReport {
    std::uint64_t lines = 0, crossings = 0, bytes = 0, samples = 0;
    double aperture = 0.0;
    double relative_error = 0.0;  // against the direct picture: of light
    double color_error = 0.0;     // and of the colours shown, 1 being white against black
};

constexpr std::uint32_t kPictureWidth = 640, kPictureHeight = 360;

// Between the triangle's corners, by areas.
study::Leaving light_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dvec3& point) {
    const std::size_t v = std::size_t{3} * triangle;
    const glm::dvec3 a(mesh.positions[v]), b(mesh.positions[v + 1]), c(mesh.positions[v + 2]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double whole = glm::dot(normal, normal);
    const double at_b = glm::dot(glm::cross(point - a, c - a), normal) / whole,
                 at_c = glm::dot(glm::cross(b - a, point - a), normal) / whole;
    const glm::dvec3 light = (1.0 - at_b - at_c) * glm::dvec3(mesh.colors[v]) + at_b * glm::dvec3(mesh.colors[v + 1]) +
                             at_c * glm::dvec3(mesh.colors[v + 2]);
    return {glm::vec3(glm::max(light, glm::dvec3(0.0))), glm::vec3(glm::normalize(normal))};
}

// IEC 61966-2-1.
std::uint8_t srgb_byte(float linear) {
    const float value = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(255.0f * glm::clamp(value, 0.0f, 1.0f)));
}

render::Image shown(const study::LightPicture& picture, float exposure) {
    render::Image image{picture.width, picture.height, {}};
    for (const glm::vec3& light : picture.pixels) {
        const glm::vec3 color = compressed(exposure * light);
        for (int k = 0; k < 3; ++k) image.rgba.push_back(srgb_byte(color[k]));
        image.rgba.push_back(255);
    }
    return image;
}

// The mean absolute difference, of 255 steps.
double steps_apart(const render::Image& a, const render::Image& b) {
    double apart = 0.0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) apart += std::abs(a.rgba[i] - b.rgba[i]);
    return apart / (0.75 * static_cast<double>(a.rgba.size()));
}

// Writes the picture from lines alone, 640 by 360. Error: cancelled, if interrupted; then nothing is written.
Result<LightFieldReport> draw_light_field(const LightFieldRun& run, Executor& executor) {
    const auto light = [&](std::uint32_t triangle, const glm::dvec3& point) {
        return light_at(run.light, triangle, point);
    };
    study::LightFieldOptions options;
    options.lines = run.lines;
    options.seed = run.seed;
    options.sky = run.sky;
    options.should_stop = should_stop;
    ProgressBar bar("radiosity: light field");
    const auto field = study::LightField::record(run.tracer, light, options, executor);
    if (!field) return field.error();
    const auto drawn = field->draw(run.camera, kPictureWidth, kPictureHeight, {});
    if (!drawn) return drawn.error();
    const auto direct =
        study::direct_picture(run.tracer, light, run.sky, run.camera, kPictureWidth, kPictureHeight, executor);
    if (!direct) return direct.error();
    const render::Image from_lines = shown(drawn->picture, run.exposure), from_scene = shown(*direct, run.exposure);
    if (auto written = write_file(run.png_path, pipeline::encode_png(from_lines)); !written) return written.error();
    return LightFieldReport{field->lines(),
                            field->crossings(),
                            field->bytes(),
                            drawn->samples,
                            drawn->aperture,
                            study::relative_difference(drawn->picture, *direct),
                            steps_apart(from_lines, from_scene) / 255.0};
}

Json to_json(const LightFieldReport& report) {
    return {{"lines", report.lines},
            {"crossings", report.crossings},
            {"bytes", report.bytes},
            {"samples", report.samples},
            {"aperture", report.aperture},
            {"relative_error", report.relative_error},
            {"color_error", report.color_error}};
}

void print(const LightFieldReport& report) {
    print_to(stdout,
             "light field: %llu stored lines with %llu crossings, %.0f MB; those within %.3g m of the eye give %llu "
             "points;\n"
             "the picture from them is %.2f %% off in light, %.2f %% in colour\n",
             static_cast<unsigned long long>(report.lines), static_cast<unsigned long long>(report.crossings),
             1e-6 * static_cast<double>(report.bytes), report.aperture, static_cast<unsigned long long>(report.samples),
             100.0 * report.relative_error, 100.0 * report.color_error);
}

constexpr double kSaveLightEvery = 20.0;  // seconds
// An error of e means that this part of the patches is within 2 e, as for two standard deviations.
constexpr double kPatchesWithin = 0.95, kDeviations = 2.0;

struct RadiosityOptions {
    ReadOptions read;
    std::string scene, method = "global", out, png, light_field, json, checkpoint, map, shard;
    std::uint64_t lines = 20'000'000, seed = 1, stored_lines = 1 << 22, runs = 0, reference = 0;
    double error = 0.0, edge = 0.0, sky = 1.0, sun = 3.0;
    unsigned threads = 1, shadow_cuts = 3;
};

Result<radiosity::SolverOptions> solver_options(const RadiosityOptions& options) {
    radiosity::SolverOptions result;
    result.seed = options.seed;
    if (options.method == "local")
        result.transport = radiosity::Transport::local;
    else if (options.method == "bundles")
        result.method = lines::LineMethod::bundles;
    else if (options.method == "walls")
        result.method = lines::LineMethod::walls;
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
    if (!path) return path.error();
    return path->cameras.front();
}

Result<void> save(const std::string& path, std::span<const std::byte> bytes) {
    return path.empty() ? Result<void>{}
                        : write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// Adds what an earlier run has left in the file of --checkpoint, if it exists.
template <class Add>
Result<void> load(const std::string& path, Add&& add) {
    if (path.empty() || !std::filesystem::exists(path)) return {};
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    if (const Result<void> added = add(std::as_bytes(std::span(*bytes))); !added)
        return fail(added.error().code, kNoItem, path + ": " + added.error().message);
    return {};
}

// Runs until the error or the number of lines is reached.
Result<void> solve(const RadiosityOptions& options, radiosity::Solver& solver, Executor& executor) {
    if (auto loaded = load(options.checkpoint, [&](auto bytes) { return solver.resume(bytes); }); !loaded)
        return loaded;
    const auto done = [&] {
        if (solver.runs() < 2) return false;
        if (!(options.error > 0.0)) return solver.lines_traced() >= options.lines;
        return solver.relative_error() <= options.error &&
               solver.share_within(kDeviations * options.error) >= kPatchesWithin;
    };
    ProgressBar bar("radiosity", 1000);
    while (!done() && solver.run(should_stop, nullptr, executor)) {
        const double share = options.error > 0.0
                                 ? std::pow(options.error / solver.relative_error(), 2.0)
                                 : static_cast<double>(solver.lines_traced()) / static_cast<double>(options.lines);
        bar.set(static_cast<std::size_t>(1000.0 * std::min(1.0, share)));
        if (options.checkpoint.empty()) continue;
        if (auto saved = save(options.checkpoint, solver.checkpoint()); !saved) return saved;
    }
    return {};
}

struct LightProgress {
    ProgressBar bar{"radiosity", 1000};
    static bool should_stop(void* user, double share) {
        static_cast<LightProgress*>(user)->bar.set(static_cast<std::size_t>(1000.0 * share));
        return interrupted();
    }
};

// Makes the runs of a shard; what there is is saved as time goes by.
Result<void> solve(const RadiosityOptions& options, const pvs::Shard& shard, radiosity::Bake& bake,
                   Executor& executor) {
    if (auto loaded = load(options.checkpoint, [&](auto bytes) { return bake.add_state(bytes); }); !loaded)
        return loaded;
    LightProgress progress;
    for (bool done = false; !done;) {
        const std::uint64_t before = bake.runs_done();
        const auto ran = bake.run({.seconds = kSaveLightEvery,
                                   .shard = {shard.index, shard.count},
                                   .should_stop = LightProgress::should_stop,
                                   .user = &progress},
                                  executor);
        if (!ran) return ran;
        done = interrupted() || bake.runs_done() == before;
        const auto bytes = bake.state();
        if (!bytes) return bytes.error();
        if (auto saved = save(options.checkpoint, *bytes); !saved) return saved;
    }
    return {};
}

// The light, by a solver alone or by a bake of a given number of runs.
struct Light {
    std::optional<radiosity::Solver> alone;
    std::optional<radiosity::Bake> bake;
    [[nodiscard]] const radiosity::Solver& solver() const { return bake ? bake->solver() : *alone; }
};

Result<Light> find_light(const RadiosityOptions& options, const radiosity::Patches& patches,
                         const radiosity::SolverOptions& parameters, Executor& executor) {
    Light light;
    if (options.runs > 0) {
        const auto shard = shard_from(options.shard);
        if (!shard) return shard.error();
        auto bake = radiosity::Bake::create(patches, parameters, options.runs);
        if (!bake) return bake.error();
        light.bake.emplace(std::move(*bake));
        if (auto solved = solve(options, *shard, *light.bake, executor); !solved) return solved.error();
    } else {
        auto solver = radiosity::Solver::create(patches, parameters);
        if (!solver) return solver.error();
        light.alone.emplace(std::move(*solver));
        if (auto solved = solve(options, *light.alone, executor); !solved) return solved.error();
    }
    if (light.solver().runs() == 0 && interrupted())
        return fail(ErrorCode::cancelled, kNoItem, "interrupted in the first run: there is no light yet to write");
    return light;
}

// What needs lines of its own, besides the light.
struct LightStudies {
    std::optional<LightFieldReport> field;
    std::optional<ReferenceReport> reference;
    Json visibility;
};

struct FoundLight {
    const assets::SceneSource& source;
    const LitScene& lit;
    const radiosity::SolverOptions& parameters;
    const radiosity::Solver& solver;
    const TriangleMesh& mesh;
    float exposure;
};

// Ends at the first that is interrupted; this one and those after it are left out.
Result<LightStudies> study_light(const RadiosityOptions& options, const FoundLight& found, Executor& executor) {
    LightStudies studies;
    if (interrupted()) return studies;
    const auto tracer = lines::LineTracer::build(found.lit.patches.mesh);
    if (!tracer) return tracer.error();
    if (!options.light_field.empty()) {
        const auto camera = camera_for(found.source, options.seed);
        if (!camera) return camera.error();
        auto drawn = draw_light_field({found.mesh, *tracer, found.parameters.outside.sky, *camera, found.exposure,
                                       options.stored_lines, options.seed, options.light_field},
                                      executor);
        if (!drawn && drawn.error().code == ErrorCode::cancelled) return studies;
        if (!drawn) return drawn.error();
        studies.field = *drawn;
    }
    if (options.reference > 0) {
        const auto compared =
            compare_to_reference(found.lit.patches, found.parameters, options.reference, found.solver, executor);
        if (!compared && compared.error().code == ErrorCode::cancelled) return studies;
        if (!compared) return compared.error();
        studies.reference = *compared;
    }
    const auto seen = lines::visibility_complexity(
        *tracer, lines::LineSource(tracer->bounds(), lines::LineMethod::walls, options.seed), 50);
    studies.visibility = {
        {"mean_crossings", seen.mean_crossings}, {"deviation", seen.deviation}, {"wasted", seen.wasted}};
    return studies;
}

Result<int> run_radiosity(const RadiosityOptions& options) {
    const auto parameters = solver_options(options);
    if (!parameters) return parameters.error();
    if (!options.shard.empty() && (options.runs == 0 || options.checkpoint.empty()))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--shard needs --runs, of the whole bake, and --state: the part to write");
    const auto source = load_updated_scene(options.scene, options.read, {.map = options.map, .seed = options.seed});
    if (!source) return source.error();
    const auto flat = assets::flat_scene(*source, options.read.limits);
    if (!flat) return flat.error();
    std::optional<SunEdges> sun;
    if (options.sun > 0.0 && options.shadow_cuts > 0) sun = {parameters->outside.to_sun, options.shadow_cuts};
    const auto lit = lit_scene(*flat, options.edge, sun);
    if (!lit) return lit.error();
    ThreadPool pool(options.threads);
    const auto start = Clock::now();
    catch_interrupts();  // before, there is nothing to keep
    const auto found = find_light(options, lit->patches, *parameters, pool);
    if (!found) return found.error();
    const radiosity::Solver* const solver = &found->solver();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const TriangleMesh light = lit_mesh(*lit, *solver);
    const float exposure = automatic_exposure(*lit, *solver);
    const auto studied = study_light(options, {*source, *lit, *parameters, *solver, light, exposure}, pool);
    if (!studied) return studied.error();
    const auto& [field, reference, visibility] = *studied;
    const bool cut_short = interrupted();
    finish_what_there_is();
    TriangleMesh picture = light;
    for (glm::vec3& color : picture.colors) color = compressed(exposure * color);
    if (!options.out.empty())
        if (auto written = write_glb(options.out, picture); !written) return written.error();
    if (!options.png.empty()) {
        const auto camera = camera_for(*source, options.seed);
        if (!camera) return camera.error();
        const float sky = static_cast<float>(std::min(1.0, options.sky));
        if (auto written = write_lit_picture(options.png, picture, *camera, 1280, 720, sky); !written)
            return written.error();
    }
    glm::dvec3 mean(0.0);
    double area = 0.0;
    for (std::size_t i = 0; i < lit->patches.count(); ++i) {
        mean += lit->patches.areas[i] * glm::dvec3(solver->radiosity()[i]);
        area += lit->patches.areas[i];
    }
    mean /= area;
    const Json report = {{"scene", source->name},
                         {"patches", lit->patches.count()},
                         {"triangles", lit->patches.mesh.triangle_count()},
                         {"solver_bytes", solver->bytes()},
                         {"method", options.method},
                         {"lines_from", lines::to_string(solver->method())},
                         {"runs", solver->runs()},
                         {"runs_planned", found->bake ? Json(found->bake->runs_planned()) : Json(nullptr)},
                         {"lines", solver->lines_traced()},
                         {"relative_error", solver->relative_error()},
                         {"share_within_10_percent", solver->share_within(0.1)},
                         {"reference", reference ? to_json(*reference) : Json(nullptr)},
                         {"unseen", solver->unseen()},
                         {"bounces", solver->bounces_of_last_run()},
                         {"mean_radiosity", {mean.x, mean.y, mean.z}},
                         {"seconds", seconds},
                         {"light_field", field ? to_json(*field) : Json(nullptr)},
                         {"visibility", visibility}};
    std::string missing;
    if (!options.light_field.empty() && !field) missing = ", but no light field";
    if (options.reference > 0 && !reference)
        missing += std::string(missing.empty() ? ", but" : " and") + " no comparison with a reference";
    if (cut_short)
        print_to(stderr, "crofton: interrupted: the results of %llu runs are written%s%s\n",
                 static_cast<unsigned long long>(solver->runs()), missing.c_str(),
                 options.checkpoint.empty() ? "; with --checkpoint the next run would continue from here" : "");
    const int status = cut_short ? kInterrupted : kSuccess;
    if (!options.json.empty()) {
        if (auto written = write_json(options.json, report); !written) return written.error();
        return status;
    }
    if (solver->runs() == 0) {
        print_to(stdout,
                 "%s: this part has no runs: they are made in chains of eight, and there are more parts than chains\n",
                 printable(source->name).c_str());
        return status;
    }
    print_to(stdout, "%s: %zu patches, %llu runs, %llu lines in %.1f s, relative error %.3f %%\n",
             printable(source->name).c_str(), lit->patches.count(), static_cast<unsigned long long>(solver->runs()),
             static_cast<unsigned long long>(solver->lines_traced()), seconds, 100.0 * solver->relative_error());
    print_to(stdout, "%.1f %% of patches are within 10 %% of their light, by the spread of the runs\n",
             100.0 * solver->share_within(0.1));
    if (reference) print(*reference);
    if (field) print(*field);
    return status;
}

}  // namespace

void add_radiosity_command(CommandLine& line) {
    auto options = std::make_shared<RadiosityOptions>();
    Command command = kRadiosity.add_to(line);
    command.footer(
        "Colours are reflectances. Those above 0.9, as of white paint, count as 0.9, so that light ends. Triangles "
        "without area are left out.\n"
        "Light comes from the sun and the sky, from emission in glTF and OBJ materials, and from the lamps of the town "
        "and the room.\n"
        "\n"
        "Examples:\n"
        "  crofton study radiosity room --edge 0.2 --error 0.02 --out room.glb --png room.png\n"
        "  crofton study radiosity town --lines 20000000 --checkpoint town.state --out town.glb\n"
        "  crofton study radiosity room --runs 64 --shard 0/2 --state part0    # half of the runs; the others: 1/2, "
        "part1\n"
        "  crofton merge part0 part1 --out whole.state                         # then both together\n"
        "  crofton study radiosity room --runs 64 --state whole.state --out room.glb\n"
        "  crofton study radiosity room --light-field lines.png --stored-lines 16000000\n"
        "  crofton study radiosity level.wad --map MAP01 --method local --json -\n");
    command
        .option(
            "scene", options->scene,
            "town, room, office, valley, hall, a folder of city parts, or a .glb, .gltf, .obj, .wad or .crofton file")
        .required();
    const Option lines =
        command
            .option("--lines", options->lines,
                    "Trace at least this many lines, in two or more runs; the patches decide how many lines a run has")
            .show_default();
    const Option error =
        command
            .option("--error", options->error,
                    "Stop at this relative error instead, for example 0.02, once 95 % of patches are within twice that")
            .positive()
            .excludes(lines);
    command
        .option("--runs", options->runs,
                "Make this many runs instead, in independent chains of eight, so that the bake can be split")
        .whole_between(1, std::uint64_t{1} << 32)
        .excludes(lines)
        .excludes(error);
    const Option shard =
        command.option("--shard", options->shard, "i/n: make only part i of n; needs --runs and --state");
    command.option("--reference", options->reference, "Compare with this many runs of another seed, patch by patch")
        .whole_between(2, 1'000'000)
        .excludes(shard);
    command.option("--method", options->method, "local | global | bundles | walls").show_default();
    command.option("--edge", options->edge, "Longest edge of a patch in metres; chosen automatically by default")
        .positive();
    command
        .option("--shadow-cuts", options->shadow_cuts,
                "How often to cut patches into four where shadows of the sun end; 0: shadows are as sharp as patches")
        .whole_between(0, 8)
        .show_default();
    command.option("--sky", options->sky, "Radiosity of the sky").not_negative().show_default();
    command.option("--sun", options->sun, "Irradiance toward the sun").not_negative().show_default();
    command.option("--seed", options->seed, "Seed of the lines and of the town").show_default();
    command.option("--map", options->map, "Level of a .wad file");
    command.option("--threads", options->threads, "Worker threads; 0: one per core")
        .whole_between(0, 256)
        .show_default();
    command.option("--out", options->out, "Write the lit scene as .glb").writable_file().excludes(shard);
    command.option("--png", options->png, "Write a picture of the lit scene").writable_file().excludes(shard);
    const Option light_field = command
                                   .option("--light-field", options->light_field,
                                           "Store global lines with the light along them, draw a picture from these "
                                           "lines alone, and print how much it differs from the scene's own")
                                   .writable_file()
                                   .excludes(shard);
    command.option("--stored-lines", options->stored_lines, "With --light-field: the approximate number of lines")
        .whole_between(1, 1 << 28)
        .show_default()
        .needs(light_field);
    command.option("--json", options->json, "Write the figures as JSON; - for stdout").writable_file_or_stdout();
    command
        .option("--checkpoint,--state", options->checkpoint,
                "Save to this file from time to time; continue from it if it exists")
        .writable_file();
    add_read_options(command, options->read);
    command.action([options] {
        const auto done = run_radiosity(*options);
        return done ? *done : report_error("", done.error());
    });
}

}  // namespace crofton::cli
