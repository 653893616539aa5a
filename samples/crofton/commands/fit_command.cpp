// SPDX-License-Identifier: MIT
// crofton fit: the best oriented box around each mesh, with the proof that it is.
#include <algorithm>
#include <charconv>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "assets/print.hpp"
#include "commands.hpp"
#include "fit_output.hpp"
#include "fit_planar.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "mesh_file.hpp"
#include "progress_bar.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace crofton::cli {
namespace {

constexpr const char* kCriterionSyntax =
    "volume | area | perimeter | rays:LENGTH | frustum:FOVY,ASPECT,NEAR,FAR (FOVY in radians) | partner:FILE | "
    "weights:A,B,C";

Error bad(const std::string& text, const std::string& why) {
    return fail(ErrorCode::invalid_argument, kNoItem, "--criterion " + text + ": " + why);
}

// Exactly `count` numbers with commas between them; empty if the text is anything else.
std::vector<double> numbers(const std::string& text, std::size_t count) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (values.size() < count) {
        double value = 0.0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) return {};
        values.push_back(value);
        at = next;
        if (values.size() == count) break;
        if (at == end || *at != ',') return {};
        ++at;
    }
    if (at != end) return {};
    return values;
}

Result<measure::Criterion> partner(const std::string& path, const ReadOptions& options) {
    const auto points = load_points(path, options);
    if (!points) return points.error();
    const std::span<const glm::dvec3> span(*points);
    const auto hull = convex_hull(span);
    if (!hull) return fail(hull.error().code, hull.error().item, path + ": " + hull.error().message);
    if (hull->rank == 3) {
        const auto body = measure::intrinsic_volumes_of_polytope(span, hull->triangles);
        if (!body) return body.error();
        return measure::for_partner(*body);
    }
    if (hull->rank == 2) {
        glm::dvec3 twice_area(0.0);
        double perimeter = 0.0;
        const auto at = [&](std::size_t i) { return span[hull->vertices[i % hull->vertices.size()]]; };
        for (std::size_t i = 0; i < hull->vertices.size(); ++i) {
            perimeter += glm::distance(at(i), at(i + 1));
            twice_area += glm::cross(at(i) - at(0), at(i + 1) - at(0));
        }
        return measure::for_partner(
            measure::intrinsic_volumes_of_flat_polygon(0.5 * glm::length(twice_area), perimeter));
    }
    const double length = hull->rank == 1 ? glm::distance(span[hull->vertices[0]], span[hull->vertices[1]]) : 0.0;
    return measure::for_partner(measure::intrinsic_volumes_of_segment(length));
}

// Errors say what is wrong with the text; `partner` reads its file, whose convex hull is the partner.
Result<measure::Criterion> parse_criterion(const std::string& text, const ReadOptions& options = {}) {
    const std::size_t colon = text.find(':');
    const std::string name = text.substr(0, colon), rest = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (colon == std::string::npos) {
        if (name == "volume") return measure::minimal_volume();
        if (name == "area") return measure::minimal_area();
        if (name == "perimeter") return measure::minimal_perimeter();
    }
    Result<measure::Criterion> criterion = bad(text, std::string("expected ") + kCriterionSyntax);
    if (name == "rays") {
        const auto v = numbers(rest, 1);
        if (v.empty() || !(v[0] >= 0.0)) return bad(text, "rays need one length, not negative");
        criterion = measure::for_rays(v[0]);
    } else if (name == "frustum") {
        const auto v = numbers(rest, 4);
        if (v.empty()) return bad(text, "a frustum needs four numbers: FOVY (radians), ASPECT, NEAR, FAR");
        Camera camera;
        camera.fov_y = v[0];
        camera.aspect = v[1];
        camera.near_distance = v[2];
        camera.far_distance = v[3];
        criterion = measure::for_frustum(camera);
    } else if (name == "weights") {
        const auto v = numbers(rest, 3);
        if (v.empty()) return bad(text, "weights are three numbers, of volume, area and mean curvature");
        criterion = measure::Criterion{v[0], v[1], v[2]};
    } else if (name == "partner") {
        if (rest.empty()) return bad(text, "a partner needs a mesh file: partner:FILE");
        criterion = partner(rest, options);
    }
    if (!criterion)
        return criterion.error().message.starts_with("--criterion") ? criterion : bad(text, criterion.error().message);
    if (const auto valid = measure::validate(*criterion); !valid) return bad(text, valid.error().message);
    return criterion;
}

struct FitRequest {
    std::vector<std::string> files;
    std::string criterion = "perimeter", quality = "exact", json_path, svg_path;
    double budget_seconds = 0.0;  // 0: none
    bool planar = false;
    ReadOptions read;
};

Result<FittedBox> fit_box(std::span<const glm::dvec3> points, const measure::Criterion& criterion,
                          const FitRequest& request) {
    FittedBox fitted;
    const Stopwatch watch;
    if (request.quality == "exact") {
        fit::ExactOptions options;
        options.criterion = criterion;
        if (request.budget_seconds > 0.0) options.time_budget_seconds = request.budget_seconds;
        const auto tell = [](const fit::Progress&) { return interrupted(); };
        const FunctionRef<bool(const fit::Progress&)> asked(tell);
        options.should_stop = &asked;
        const auto exact = fit::fit_exact(points, options);
        if (!exact) return exact.error();
        fitted.box = exact->box;
        fitted.value = exact->value;
        fitted.lower_bound = exact->lower_bound;
        fitted.gap = exact->gap;
        fitted.rounding = exact->rounding;
    } else {
        const auto quality = request.quality == "fast" ? fit::Quality::fast : fit::Quality::tight;
        const auto box = fit::fit_obb(points, {criterion, quality});
        if (!box) return box.error();
        fitted.box = *box;
        fitted.value = criterion(measure::intrinsic_volumes_of_box(*box));
    }
    fitted.milliseconds = watch.milliseconds();
    return fitted;
}

Result<FittedMesh> fit_mesh(const std::string& file, const measure::Criterion& criterion, const FitRequest& request) {
    FittedMesh mesh;
    mesh.file = file;
    const auto points = load_points(file, request.read);
    if (!points) return points.error();
    const std::span<const glm::dvec3> span(*points);
    const auto named = [&](const Error& error) { return fail(error.code, error.item, file + ": " + error.message); };
    const Stopwatch watch;
    const auto hull = convex_hull(span);
    mesh.hull_milliseconds = watch.milliseconds();
    if (!hull) return named(hull.error());
    mesh.vertices = points->size();
    mesh.hull_vertices = hull->vertices.size();
    for (const auto i : hull->triangles) mesh.hull_triangles.push_back(span[i]);
    for (std::size_t i = 0; hull->rank < 3 && i < hull->vertices.size(); ++i)
        mesh.outline.insert(mesh.outline.end(),
                            {span[hull->vertices[i]], span[hull->vertices[(i + 1) % hull->vertices.size()]]});
    const auto fit_by = [&](const std::string& name, const measure::Criterion& by) {
        auto fitted = fit_box(span, by, request);
        if (fitted) fitted->criterion = name;
        return fitted;
    };
    auto chosen = fit_by(request.criterion, criterion);
    if (!chosen) return named(chosen.error());
    mesh.chosen = *chosen;
    if (request.files.size() == 1) return mesh;
    const std::pair<const char*, measure::Criterion> all[] = {{"volume", measure::minimal_volume()},
                                                              {"area", measure::minimal_area()},
                                                              {"perimeter", measure::minimal_perimeter()}};
    for (const auto& [name, by] : all) {
        auto other = fit_by(name, by);
        if (!other) return named(other.error());
        mesh.others.push_back(*other);
    }
    return mesh;
}

int run_fit(const FitRequest& request) {
    if (request.planar) {
        const auto status = run_fit_planar({request.files, request.json_path, request.svg_path, request.read});
        return status ? *status : report_error("", status.error());
    }
    const auto criterion = parse_criterion(request.criterion, request.read);
    if (!criterion) return report_error("", criterion.error());
    catch_interrupts();
    std::vector<FittedMesh> meshes;
    {
        ProgressBar bar("fit", request.files.size());
        for (const std::string& file : request.files) {
            auto mesh = fit_mesh(file, *criterion, request);
            if (!mesh) return report_error("", mesh.error());
            // Leaves out the file in which the search was interrupted: it has only some of its boxes.
            if (interrupted() && request.files.size() > 1) break;
            meshes.push_back(std::move(*mesh));
            bar.set(meshes.size());
        }
    }
    finish_what_there_is();
    if (meshes.empty())
        return report_error("", {ErrorCode::cancelled, kNoItem, "interrupted before the first file was done"});
    if (request.json_path != "-" && request.svg_path != "-") print_text_to(stdout, fit_text(meshes));
    if (!request.json_path.empty())
        if (const auto written = write_json(request.json_path, fit_json(meshes, request.quality)); !written)
            return report_error("", written.error());
    if (!request.svg_path.empty())
        if (const auto written = write_file(request.svg_path, fit_svg(meshes)); !written)
            return report_error("", written.error());
    if (!interrupted()) return kSuccess;
    if (request.files.size() > 1)
        print_to(stderr, "crofton: interrupted after %zu of %zu files, which are written\n", meshes.size(),
                 request.files.size());
    else
        std::fputs("crofton: interrupted: the box is the best one so far, and its gap says how good it is\n", stderr);
    return kInterrupted;
}

}  // namespace

void add_fit_command(CommandLine& line) {
    auto request = std::make_shared<FitRequest>();
    Command command = line.command("fit", "Fit the best oriented box around each mesh, for a criterion of your choice");
    command
        .option("files", request->files,
                "OBJ, glTF, GLB or WAD files; only their vertices count. Of a WAD the first level is used, with "
                "--planar all levels")
        .required();
    command.option("--criterion", request->criterion, kCriterionSyntax).show_default();
    command
        .option("--quality", request->quality,
                "fast: a few passes over the points; tight: a local optimum; exact: the optimum, proved")
        .one_of({"fast", "tight", "exact"})
        .show_default();
    const Option budget = command
                              .option("--budget", request->budget_seconds,
                                      "Seconds per box; then --quality exact returns the best box so far, with its gap")
                              .not_negative();
    command.option("--json", request->json_path, "Write the boxes as JSON; - for stdout, instead of the text")
        .writable_file_or_stdout();
    command.option("--svg", request->svg_path, "Draw hulls and boxes as SVG; - for stdout").writable_file_or_stdout();
    command.flag("--planar", request->planar,
                 "Fit rectangles, disc and triangles around polygons (.poly, .json, .geojson, .wad), by perimeter and "
                 "by area");
    command.footer(
        "The criterion is alpha V + beta F + gamma M: volume, surface area and integral of mean curvature (pi times "
        "the edge sum).\n"
        "Every box contains every vertex, checked in exact arithmetic. Several files give a table of all criteria.\n"
        "\n"
        "Examples:\n"
        "  crofton fit bunny.obj\n"
        "  crofton fit bunny.obj --criterion frustum:1.0472,1.7778,0.1,1000 --json -\n"
        "  crofton fit *.obj --criterion rays:10 --quality tight --svg boxes.svg\n"
        "  crofton fit --planar counties.poly --svg bounds.svg");
    add_read_options(command, request->read);
    command.action([request, budget] {
        if (budget.given() && request->quality != "exact")
            return report_error("", {ErrorCode::invalid_argument, kNoItem, "--budget needs --quality exact"});
        return run_fit(*request);
    });
}

}  // namespace crofton::cli
