#include "triangulate_meshes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/planar_patches.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "glb_writer.hpp"
#include "progress_bar.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

double size_of(const TriangleMesh& mesh) {
    glm::vec3 low = mesh.positions[0], high = low;
    for (const auto& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::vec3 d = high - low;
    return std::max({d.x, d.y, d.z});
}

json to_json(const std::string& name, const TriangleMesh& mesh, const triangulate::PatchResult& r, bool no_indices) {
    json entry{{"name", name},
               {"vertices", r.vertices},
               {"holes", r.holes},
               {"triangle_count", r.triangles.size()},
               {"weight_before", r.weight_before},
               {"weight", r.weight_after},
               {"optimal", r.optimal},
               {"gap", std::isfinite(r.gap) ? json(r.gap) : json(nullptr)},
               {"microseconds", r.microseconds}};
    if (no_indices) return entry;
    json triangles = json::array();
    for (const std::size_t t : r.triangles)
        triangles.push_back({mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]});
    entry["triangles"] = std::move(triangles);
    return entry;
}

json to_json(const std::string& name, const TriangleMesh& mesh, const triangulate::PatchReport& r, bool no_indices,
             double microseconds) {
    json polygons = json::array();
    for (std::size_t i = 0; i < r.results.size(); ++i)
        polygons.push_back(to_json(name + "_" + std::to_string(i), mesh, r.results[i], no_indices));
    return {{"name", name},
            {"vertices", mesh.positions.size()},
            {"triangles", mesh.triangle_count()},
            {"patches", r.patches},
            {"patch_triangles", r.triangles},
            {"improved", r.improved},
            {"unproven", r.unproven},
            {"weight_before", r.weight_before},
            {"weight_after", r.weight_after},
            {"microseconds", microseconds},
            {"polygons", std::move(polygons)}};
}

}  // namespace

double patch_tolerance(const TriangleMesh& mesh, double tolerance) {
    return tolerance >= 0.0 || mesh.positions.empty() ? std::max(tolerance, 0.0) : 1e-6 * size_of(mesh);
}

Result<int> run_meshes(const MeshRun& run) {
    auto source = assets::load_scene(run.file);
    if (!source) return tl::unexpected(source.error());
    source->scene.update();
    for (const auto& warning : source->warnings) std::fprintf(stderr, "crofton: warning: %s\n", warning.c_str());
    std::vector<TriangleMesh> meshes;
    json entries = json::array();
    triangulate::PatchReport total;
    double total_time = 0.0;
    {
        ProgressBar bar("triangulate", source->scene.mesh_count());
        for (scene::MeshId m = 0; m < source->scene.mesh_count(); ++m) {
            meshes.push_back(source->scene.mesh(m));
            triangulate::PatchOptions options;
            options.tolerance = patch_tolerance(meshes.back(), run.tolerance);
            options.triangulation = {.method = run.method, .seconds = run.seconds};
            const auto start = Clock::now();
            const auto report = triangulate::retriangulate_planar_patches(meshes.back(), options);
            const double time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
            if (!report)
                return fail(report.error().code, m,
                            run.file + ": " + source->scene.mesh_name(m) + ": " + report.error().message);
            entries.push_back(to_json(source->scene.mesh_name(m), meshes.back(), *report, run.no_indices, time));
            total.patches += report->patches;
            total.improved += report->improved;
            total.triangles += report->triangles;
            total.unproven += report->unproven;
            total.weight_before += report->weight_before;
            total.weight_after += report->weight_after;
            total_time += time;
            bar.set(m + 1);
        }
    }
    if (!run.out.empty()) {
        if (auto written = write_file(run.out, make_glb(source->scene, meshes)); !written)
            return tl::unexpected(written.error());
    }
    if (!run.json.empty()) {
        const json document{{"file", source->name},
                            {"method", run.method_name},
                            {"meshes", std::move(entries)},
                            {"summary",
                             {{"meshes", meshes.size()},
                              {"patches", total.patches},
                              {"improved", total.improved},
                              {"unproven", total.unproven},
                              {"weight_before", total.weight_before},
                              {"weight_after", total.weight_after},
                              {"microseconds", total_time}}}};
        if (auto written = write_json(run.json, document); !written) return tl::unexpected(written.error());
    }
    if (run.json != "-") {
        std::printf("%-16s %8s %10s %10s %10s %10s %14s %14s\n", "method", "meshes", "patches", "triangles", "improved",
                    "unproven", "weight before", "weight after");
        std::printf("%-16s %8zu %10zu %10zu %10zu %10zu %14.8g %14.8g\n", run.method_name.c_str(), meshes.size(),
                    total.patches, total.triangles, total.improved, total.unproven, total.weight_before,
                    total.weight_after);
    }
    return kSuccess;
}

}  // namespace crofton::cli
