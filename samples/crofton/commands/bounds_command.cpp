// SPDX-License-Identifier: MIT
// crofton study bounds: spheres, boxes and k-DOPs around each mesh, and which of them costs least.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/k_dop.hpp>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>

#include "assets/print.hpp"
#include "commands.hpp"
#include "criterion.hpp"
#include "json/json.hpp"
#include "mesh_file.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

constexpr std::uint64_t kViewCount = 4096;

struct BoundsRequest {
    std::vector<std::string> files;
    std::string criterion_name = "perimeter", directions_text, json_path;
    bool only_best = false;
    double region = 20.0;        // radius of the sphere that queries hit, over that of the mesh's sphere
    double triangle_cost = 1.0;  // nanoseconds for a triangle that is passed on
    ReadOptions read;

    measure::Criterion criterion = {};
    std::vector<glm::dvec3> directions = {};  // half of a k-DOP's, the user's own; empty: none
};

struct Candidate {
    std::string kind;
    double value = 0.0, lower_bound = 0.0;
    double share = 0.0;      // predicted: of the queries that hit the region
    std::size_t passed = 0;  // views in which the bound is not outside
    double test_ns = 0.0;    // C_v: of a test
    double cost_ns = 0.0;    // (N_v C_v + N_p C_p) / N_v
};

struct MeshBounds {
    std::string file;
    std::size_t triangles = 0;
    double hull = 0.0;  // criterion of the mesh's hull: no bound has less
    std::vector<Candidate> candidates;
    std::size_t best = 0;
};

// Views of 60° that stand in a box around the mesh, four regions' radii wide.
std::vector<Frustum> views_around(const Sphere& sphere, double region) {
    std::vector<Frustum> views;
    const sampling::UnitPoints points(3);
    const double half_width = 2.0 * region * sphere.radius;
    Camera prototype;
    prototype.near_distance = 0.01 * sphere.radius;
    prototype.far_distance = 2.0 * half_width;
    const Aabb room{sphere.center - half_width, sphere.center + half_width};
    for (std::uint64_t i = 0; i < kViewCount; ++i)
        if (const auto frustum = frustum_of(sampling::random_camera(prototype, room, points.at<6>(i))))
            views.push_back(*frustum);
    return views;
}

// The least of five runs: the time without what else the machine does.
double nanoseconds(const std::vector<Frustum>& views, const std::function<cull::Verdict(const Frustum&)>& test) {
    double least = HUGE_VAL;
    volatile int sink = 0;
    for (int run = 0; run < 5; ++run) {
        const auto start = std::chrono::steady_clock::now();
        for (const Frustum& view : views) sink = sink + static_cast<int>(test(view));
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        least = std::min(least, time.count() / static_cast<double>(views.size()));
    }
    return least;
}

Result<MeshBounds> bounds_of(const std::string& file, const BoundsRequest& run) {
    MeshBounds result;
    result.file = file;
    const auto mesh = load_mesh(file, run.read);
    if (!mesh) return mesh.error();
    result.triangles = mesh->triangle_count();
    const std::vector<glm::dvec3> points(mesh->positions.begin(), mesh->positions.end());
    const auto hull = measure::intrinsic_volumes_of_hull(points);
    const auto sphere = fit::minimal_sphere(points);
    const auto box = fit::fit_exact(std::span<const glm::dvec3>(points), {.criterion = run.criterion});
    const auto axes = fit::fit_oriented(std::span<const glm::dvec3>(points), glm::mat3(1.0f));
    for (const Error* error : {hull ? nullptr : &hull.error(), sphere ? nullptr : &sphere.error(),
                               box ? nullptr : &box.error(), axes ? nullptr : &axes.error()})
        if (error != nullptr) return fail(error->code, error->item, file + ": " + error->message);
    result.hull = run.criterion(*hull);
    const std::vector<Frustum> views = views_around(*sphere, run.region);
    const double region = run.criterion(measure::intrinsic_volumes_of_sphere(run.region * sphere->radius));
    const double pass_ns = run.triangle_cost * static_cast<double>(result.triangles);
    const auto add = [&](std::string kind, double value, double lower_bound,
                         const std::function<cull::Verdict(const Frustum&)>& test) {
        Candidate c{std::move(kind), value, lower_bound, std::min(1.0, value / region)};
        for (const Frustum& view : views) c.passed += test(view) != cull::Verdict::outside;
        c.test_ns = nanoseconds(views, test);
        c.cost_ns = c.test_ns + pass_ns * static_cast<double>(c.passed) / static_cast<double>(views.size());
        if (!result.candidates.empty() && c.cost_ns < result.candidates[result.best].cost_ns)
            result.best = result.candidates.size();
        result.candidates.push_back(std::move(c));
    };
    const double sphere_value = run.criterion(measure::intrinsic_volumes_of_sphere(sphere->radius));
    add("sphere", sphere_value, sphere_value, [&](const Frustum& v) { return cull::classify(v, *sphere); });
    const Aabb aligned = aabb_of(*axes);
    const double aligned_value = run.criterion(measure::intrinsic_volumes_of_box(*axes));
    add("aligned box", aligned_value, aligned_value, [&](const Frustum& v) { return cull::classify(v, aligned); });
    add("oriented box", box->value, box->lower_bound, [&](const Frustum& v) { return cull::classify(v, box->box); });
    const auto add_k_dop = [&](std::string kind, std::span<const glm::dvec3> directions) -> Result<void> {
        const auto dop = study::best_k_dop(points, directions, run.criterion);
        if (!dop) return dop.error();
        const auto body = study::hull_around(dop->bound, points);
        if (!body) return body.error();
        add(std::move(kind), dop->value, dop->lower_bound, [&](const Frustum& v) { return cull::classify(v, *body); });
        return {};
    };
    for (const std::uint32_t k : {14u, 18u, 26u})
        static_cast<void>(add_k_dop(std::to_string(k) + "-DOP", *study::k_dop_directions(k)));  // not of what is flat
    if (!run.directions.empty())
        if (auto added = add_k_dop("own " + std::to_string(2 * run.directions.size()) + "-DOP", run.directions); !added)
            return fail(added.error().code, added.error().item, "--directions: " + added.error().message);
    return result;
}

Json to_json(const MeshBounds& mesh) {
    Json list = Json::array();
    for (const Candidate& c : mesh.candidates)
        list.push_back({{"bound", c.kind},
                        {"value", c.value},
                        {"lower_bound", c.lower_bound},
                        {"over_hull", mesh.hull > 0.0 ? Json(c.value / mesh.hull - 1.0) : Json(nullptr)},
                        {"predicted_share", c.share},
                        {"passed", c.passed},
                        {"test_nanoseconds", c.test_ns},
                        {"cost_nanoseconds", c.cost_ns}});
    return {{"file", mesh.file},
            {"triangles", mesh.triangles},
            {"hull", mesh.hull},
            {"views", kViewCount},
            {"best", mesh.candidates[mesh.best].kind},
            {"bounds", std::move(list)}};
}

void print(const MeshBounds& mesh, bool only_best) {
    for (std::size_t i = 0; i < mesh.candidates.size(); ++i) {
        if (only_best && i != mesh.best) continue;
        const Candidate& c = mesh.candidates[i];
        print_to(stdout, "%-24s %9zu %-13s %14.7g %9.2f%% %9.2f%% %8zu %9.1f %12.2f%s\n",
                 printable(mesh.file.substr(mesh.file.find_last_of('/') + 1)).c_str(), mesh.triangles, c.kind.c_str(),
                 c.value, 100.0 * (c.value / mesh.hull - 1.0), 100.0 * (1.0 - c.lower_bound / c.value), c.passed,
                 c.test_ns, c.cost_ns, i == mesh.best ? "  best" : "");
    }
}

// "x,y,z;x,y,z;…"; none of an empty text.
Result<std::vector<glm::dvec3>> parse_directions(const std::string& text) {
    std::vector<glm::dvec3> directions;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(';', at), text.size());
        const std::string one = text.substr(at, end - at);
        glm::dvec3 d;
        int used = 0;
        if (std::sscanf(one.c_str(), "%lf,%lf,%lf%n", &d.x, &d.y, &d.z, &used) != 3 ||
            static_cast<std::size_t>(used) != one.size())
            return fail(ErrorCode::parse, directions.size(), "--directions: " + one + " is not x,y,z");
        directions.push_back(d);
        at = end + 1;
    }
    return directions;
}

// The cost of N_v views is N_v·C_v + N_p·C_p, measured: each bound is tested against the same views, through
// cull::classify. C_v is the time of a test, N_p the number of views that see the bound, C_p the mesh's triangles times
// their cost. Beside it stands the share that the criterion predicts.
Result<int> run_bounds(BoundsRequest& run) {
    const auto criterion = parse_criterion(run.criterion_name, run.read);
    if (!criterion) return criterion.error();
    auto directions = parse_directions(run.directions_text);
    if (!directions) return directions.error();
    run.criterion = *criterion;
    run.directions = std::move(*directions);
    Json list = Json::array();
    if (run.json_path != "-")
        print_to(
            stdout,
            "criterion %s; %zu views from within %g times the mesh's radius; %g ns a triangle; cost = (N_v C_v + N_p "
            "C_p) "
            "/ N_v\n%-24s %9s %-13s %14s %10s %10s %8s %9s %12s\n",
            run.criterion_name.c_str(), std::size_t{kViewCount}, 2.0 * run.region, run.triangle_cost, "mesh",
            "triangles", "bound", "value", "over hull", "gap <=", "N_p", "C_v ns", "cost ns");
    for (const std::string& file : run.files) {
        const auto mesh = bounds_of(file, run);
        if (!mesh) return mesh.error();
        if (run.json_path != "-") print(*mesh, run.only_best);
        list.push_back(to_json(*mesh));
    }
    if (!run.json_path.empty())
        if (const auto written =
                write_json(run.json_path, {{"criterion", run.criterion_name}, {"meshes", std::move(list)}});
            !written)
            return written.error();
    return kSuccess;
}

}  // namespace

void add_bounds_command(CommandLine& line) {
    auto request = std::make_shared<BoundsRequest>();
    Command command = kBounds.add_to(line);
    command.option("files", request->files, "OBJ, glTF, GLB or WAD files").required();
    command.option("--criterion", request->criterion_name, kCriterionSyntax).show_default();
    command.flag("--best", request->only_best, "Print only the bound that costs least");
    command.option("--region", request->region, "Radius of the sphere that queries hit, in radii of the mesh")
        .between(1.0, 1e9)
        .show_default();
    command.option("--triangle-cost", request->triangle_cost, "Nanoseconds for each triangle that passes")
        .not_negative()
        .show_default();
    command.option("--directions", request->directions_text,
                   "Add a k-DOP of these directions, as x,y,z;x,y,z;...: one for each pair of opposite faces");
    command.option("--json", request->json_path, "Write the table as JSON; - for stdout, instead of the text")
        .writable_file_or_stdout();
    command.footer(
        "Compares sphere, boxes and k-DOPs by the expected cost C_v + p C_p of a test and of the queries that pass "
        "it.\n"
        "\n"
        "Examples:\n"
        "  crofton study bounds *.obj --best --criterion frustum:1.0472,1.7778,0.1,1000\n"
        "  crofton study bounds bunny.obj --directions '1,0,0;0,1,0;0,0,1;1,1,0;1,-1,0'");
    add_read_options(command, request->read);
    command.action([request] {
        const auto status = run_bounds(*request);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
