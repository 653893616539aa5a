// SPDX-License-Identifier: MIT
#include "triangulate_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "assets/gltf_builder.hpp"
#include "assets/gltf_patches.hpp"
#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "progress_bar.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using assets::PrimitivePatches;

// So many lines say what was left alone and why; the JSON has all of them.
constexpr std::size_t kMostReasons = 20;

Result<assets::GltfDocument> document_of(const std::string& file, const ReadOptions& options) {
    const std::string kind = assets::extension(file);
    if (kind == "glb" || kind == "gltf") return assets::read_gltf_document(file, {.limits = options.limits});
    if (kind == "obj") {
        const auto obj = assets::read_obj(file, {.limits = options.limits});
        if (!obj) return obj.error();
        return assets::gltf_from_obj(*obj, assets::folder(file));
    }
    auto source = assets::load_scene(file, {.limits = options.limits, .strict = options.strict});
    if (!source) return source.error();
    source->scene.update();
    auto document = assets::gltf_from_scene(source->scene);
    document.warnings = std::move(source->warnings);
    return document;
}

struct Sums {
    std::size_t primitives = 0, vertices = 0, triangles_before = 0, triangles_after = 0, patches = 0;
    std::size_t patch_triangles = 0, improved = 0, unproven = 0, left_alone = 0, refused = 0;
    double weight_before = 0.0, weight_after = 0.0, microseconds = 0.0;

    void add(const PrimitivePatches& p) {
        ++primitives;
        vertices += p.vertices;
        triangles_before += p.triangles_before;
        triangles_after += p.triangles_after;
        patches += p.report.patches;
        patch_triangles += p.report.triangles;
        improved += p.report.improved;
        unproven += p.report.unproven;
        left_alone += p.report.refused + !p.left_alone.empty();
        refused += p.error.has_value();
        weight_before += p.report.weight_before;
        weight_after += p.report.weight_after;
        microseconds += p.microseconds;
    }

    [[nodiscard]] Json to_json() const {
        return {{"primitives", primitives},
                {"vertices", vertices},
                {"triangles_before", triangles_before},
                {"triangles_after", triangles_after},
                {"patches", patches},
                {"patch_triangles", patch_triangles},
                {"improved", improved},
                {"unproven", unproven},
                {"refused", refused},
                {"weight_before", weight_before},
                {"weight_after", weight_after},
                {"microseconds", microseconds}};
    }

    void print(const std::string& name) const {
        print_to(stdout, "%-24s %8zu %10zu %10zu %9zu %9zu %9zu %9zu %14.8g %14.8g\n", printable(name).c_str(),
                 primitives, triangles_before, triangles_after, patches, improved, unproven, left_alone + refused,
                 weight_before, weight_after);
    }
};

std::string label(const PrimitivePatches& p) {
    return "mesh " + std::to_string(p.mesh) + (p.name.empty() ? "" : " '" + p.name + "'") + ": primitive " +
           std::to_string(p.primitive);
}

Json patch_json(const PrimitivePatches& p, std::size_t number) {
    const triangulate::PatchResult& r = p.report.results[number];
    Json entry{{"name", p.name + "_" + std::to_string(p.primitive) + "_" + std::to_string(number)},
               {"primitive", p.primitive},
               {"vertices", r.vertices},
               {"holes", r.holes},
               {"triangle_count", r.triangles.size()},
               {"weight_before", r.weight_before},
               {"weight", r.weight_after},
               {"optimal", r.optimal},
               {"gap", std::isfinite(r.gap) ? Json(r.gap) : Json(nullptr)},
               {"microseconds", r.microseconds}};
    Json triangles = Json::array();
    for (const std::size_t t : r.triangles)
        triangles.push_back({p.indices[3 * t], p.indices[3 * t + 1], p.indices[3 * t + 2]});
    entry["triangles"] = std::move(triangles);
    return entry;
}

// Lists what stayed unchanged: whole primitives, or a patch by its first triangle.
void add_reasons(const PrimitivePatches& p, Json& reasons) {
    if (!p.left_alone.empty()) reasons.push_back({{"primitive", p.primitive}, {"why", p.left_alone}});
    for (const auto& r : p.report.results)
        if (!r.refused.empty())
            reasons.push_back({{"primitive", p.primitive}, {"first_triangle", r.triangles[0]}, {"why", r.refused}});
}

// A mesh's primitives; `primitives` is not empty.
Json mesh_json(const std::vector<const PrimitivePatches*>& primitives) {
    Sums sums;
    Json polygons = Json::array(), left_alone = Json::array(), errors = Json::array();
    for (const PrimitivePatches* p : primitives) {
        sums.add(*p);
        for (std::size_t i = 0; i < p->report.results.size(); ++i) polygons.push_back(patch_json(*p, i));
        add_reasons(*p, left_alone);
        if (p->error)
            errors.push_back(
                {{"primitive", p->primitive}, {"code", to_string(p->error->code)}, {"message", p->error->message}});
    }
    Json entry = sums.to_json();
    entry["name"] = primitives[0]->name;
    entry["mesh"] = primitives[0]->mesh;
    entry["polygons"] = std::move(polygons);
    entry["left_alone"] = std::move(left_alone);
    entry["errors"] = std::move(errors);
    return entry;
}

using ByMesh = std::vector<std::vector<const PrimitivePatches*>>;

ByMesh by_mesh(const std::vector<PrimitivePatches>& outcomes) {
    ByMesh meshes;
    for (const PrimitivePatches& p : outcomes) {
        if (meshes.empty() || meshes.back()[0]->mesh != p.mesh) meshes.emplace_back();
        meshes.back().push_back(&p);
    }
    return meshes;
}

void print_reasons(const std::vector<PrimitivePatches>& outcomes) {
    std::size_t count = 0;
    const auto line = [&](const std::string& what, const std::string& why) {
        if (++count == 1) print_to(stdout, "left as they were:\n");
        if (count <= kMostReasons) print_to(stdout, "  %s: %s\n", printable(what).c_str(), printable(why).c_str());
    };
    for (const PrimitivePatches& p : outcomes) {
        if (!p.left_alone.empty()) line(label(p), p.left_alone);
        for (const auto& r : p.report.results)
            if (!r.refused.empty()) line(label(p) + ", patch at triangle " + std::to_string(r.triangles[0]), r.refused);
    }
    if (count > kMostReasons) print_to(stdout, "  and %zu more, which --json lists\n", count - kMostReasons);
}

void print_table(const ByMesh& meshes, const Sums& total, const std::vector<PrimitivePatches>& outcomes) {
    print_to(stdout, "%-24s %8s %10s %10s %9s %9s %9s %9s %14s %14s\n", "mesh", "parts", "triangles", "after",
             "patches", "improved", "unproven", "left", "weight before", "weight after");
    for (const auto& primitives : meshes) {
        Sums sums;
        for (const PrimitivePatches* p : primitives) sums.add(*p);
        sums.print(std::to_string(primitives[0]->mesh) + " " + primitives[0]->name);
    }
    total.print("all");
    print_reasons(outcomes);
}

Result<void> write_report(const MeshRun& run, const ByMesh& meshes, const Sums& total) {
    Json entries = Json::array();
    for (const auto& primitives : meshes) entries.push_back(mesh_json(primitives));
    Json summary = total.to_json();
    summary["meshes"] = meshes.size();
    return write_json(run.json, {{"file", assets::file_name(run.file)},
                                 {"method", run.method_name},
                                 {"meshes", std::move(entries)},
                                 {"summary", std::move(summary)}});
}

}  // namespace

Result<int> run_meshes(const MeshRun& run) {
    if (!run.out.empty() && run.out != "-" && assets::extension(run.out) != "glb")
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--out writes binary glTF: name it .glb, not '" + run.out + "'");
    auto document = document_of(run.file, run.read);
    if (!document) return document.error();
    for (const auto& warning : document->warnings)
        print_to(stderr, "crofton: warning: %s: %s\n", printable(run.file).c_str(), printable(warning).c_str());
    if (auto whole = refuse_if_strict(run.file, document->warnings, run.read); !whole) return whole.error();
    assets::PatchSettings settings{run.triangulation, run.tolerance, run.attribute_tolerance};
    std::vector<PrimitivePatches> outcomes;
    {
        std::optional<ProgressBar> bar;
        settings.progress = [&](std::size_t done, std::size_t of) {
            if (!bar) bar.emplace("triangulate", of);
            bar->set(done);
            return !interrupted();
        };
        auto done = assets::retriangulate_patches(*document, settings);
        if (!done) return assets::in_file(run.file, "", done.error());
        outcomes = std::move(*done);
    }
    finish_what_there_is();
    if (outcomes.empty()) return fail(ErrorCode::empty, kNoItem, run.file + ": holds no meshes");
    if (!run.out.empty()) {
        const auto glb = assets::write_glb(*document);
        if (!glb) return assets::in_file(run.out, "", glb.error());
        if (auto written = write_file(run.out, *glb); !written) return written.error();
    }
    Sums total;
    for (const PrimitivePatches& p : outcomes) {
        total.add(p);
        if (p.error)
            print_to(stderr, "crofton: %s: %s: %s\n", printable(run.file).c_str(), printable(label(p)).c_str(),
                     printable(p.error->message).c_str());
    }
    const ByMesh meshes = by_mesh(outcomes);
    if (!run.json.empty())
        if (auto written = write_report(run, meshes, total); !written) return written.error();
    if (run.json != "-" && run.out != "-") print_table(meshes, total, outcomes);
    if (interrupted()) {
        print_to(stderr, "crofton: interrupted: the remaining meshes are written unchanged\n");
        return kInterrupted;
    }
    return total.refused ? kBadInput : kSuccess;
}

}  // namespace crofton::cli
