// SPDX-License-Identifier: MIT
#include "fit_modes.hpp"

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdio>
#include <glm/geometric.hpp>

#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "pipeline/bounds.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

Obb stretched(const Obb& box, const glm::dvec3& by) {
    const Aabb bound = aabb_of(box);
    Obb result;
    result.center = by * bound.center();
    result.half_extents = glm::vec3(by * bound.half_extents());
    return result;
}

Frustum stretched(const Frustum& frustum, const glm::dvec3& by) {
    Frustum result = frustum;
    result.origin *= by;
    for (Plane& plane : result.planes) {
        const glm::dvec3 normal = plane.normal / by;
        const double length = glm::length(normal);
        if (!(length > 0.0)) continue;
        plane.normal = normal / length;
        plane.offset /= length;
    }
    return result;
}

struct Visits {
    std::uint64_t nodes = 0, boxes = 0, seen = 0;
};

Result<Visits> visits_of(std::span<const Obb> boxes, std::span<const Camera> cameras, const glm::dvec3& by) {
    Vector<Obb> there;
    for (const Obb& box : boxes) there.push_back(stretched(box, by));
    const auto tree = boxtree::BoxTree::build(there);
    if (!tree) return tl::unexpected(tree.error());
    Visits visits;
    cull::VisibleSet visible;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto frustum = frustum_of(cameras[i]);
        if (!frustum) return fail(frustum.error().code, i, frustum.error().message);
        cull::find_visible(*tree, {stretched(*frustum, by)}, visible);
        visits.nodes += visible.statistics().nodes_tested;
        visits.boxes += visible.statistics().boxes_tested;
        visits.seen += visible.size();
    }
    return visits;
}

}  // namespace

Result<int> run_fit_view_trees(const ViewTreesRun& run) {
    const study::QueryDistribution& d = run.distribution;
    const glm::dvec3 weights =
        2.0 * glm::dvec3(d.mean_cosine({1, 0, 0}), d.mean_cosine({0, 1, 0}), d.mean_cosine({0, 0, 1}));
    Json list = Json::array();
    if (run.json_path != "-")
        std::printf("weights of the axes: %.3f %.3f %.3f (uniform: 1)\n%-24s %9s %12s %12s %9s %12s %12s %9s\n",
                    weights.x, weights.y, weights.z, "scene", "objects", "nodes plain", "directed", "saved",
                    "boxes plain", "directed", "saved");
    for (const std::string& name : run.scenes) {
        const auto source = load_updated_scene(name, run.read);
        if (!source) return tl::unexpected(source.error());
        const pipeline::Bounds bounds(source->scene, pipeline::BoundsKind::aabb);
        const auto plain = visits_of(bounds.boxes(), run.cameras, glm::dvec3(1.0));
        const auto directed = visits_of(bounds.boxes(), run.cameras, weights);
        if (!plain || !directed) {
            const Error& error = plain ? directed.error() : plain.error();
            return fail(error.code, error.item, name + ": " + error.message);
        }
        const auto saved = [](std::uint64_t before, std::uint64_t after) {
            return before == 0 ? 0.0 : 1.0 - static_cast<double>(after) / static_cast<double>(before);
        };
        if (run.json_path != "-")
            std::printf("%-24s %9zu %12llu %12llu %8.2f%% %12llu %12llu %8.2f%%\n", source->name.c_str(),
                        bounds.boxes().size(), static_cast<unsigned long long>(plain->nodes),
                        static_cast<unsigned long long>(directed->nodes), 100.0 * saved(plain->nodes, directed->nodes),
                        static_cast<unsigned long long>(plain->boxes), static_cast<unsigned long long>(directed->boxes),
                        100.0 * saved(plain->boxes, directed->boxes));
        list.push_back({{"scene", source->name},
                        {"objects", bounds.boxes().size()},
                        {"plain_nodes", plain->nodes},
                        {"directed_nodes", directed->nodes},
                        {"plain_boxes", plain->boxes},
                        {"directed_boxes", directed->boxes},
                        {"plain_seen", plain->seen},
                        {"directed_seen", directed->seen}});
    }
    if (!run.json_path.empty())
        if (const auto written = write_json(
                run.json_path, {{"weights", {weights.x, weights.y, weights.z}}, {"scenes", std::move(list)}});
            !written)
            return tl::unexpected(written.error());
    return kSuccess;
}

}  // namespace crofton::cli
