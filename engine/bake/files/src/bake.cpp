// SPDX-License-Identifier: MIT
// Collects a scene's meshes, instances and tree, and writes them as a baked file.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/world/region_box.hpp>

#include <limits>

#include <crofton/bake/occluder_sections.hpp>
#include "mesh_sections.hpp"
#include "tree_section.hpp"

namespace crofton::bake {
namespace {

// The file's arrays while they grow.
struct Arrays {
    Vector<MeshRecord> meshes;
    Vector<glm::vec3> positions, colors;
    Vector<std::uint32_t> indices, rings;
    Vector<glm::dvec2> points;
    Vector<char> names;
    Vector<PolygonRecord> polygons;
};

template <class T, class Range>
std::uint64_t append(Vector<T>& array, const Range& elements) {
    const std::uint64_t first = array.size();
    array.insert(array.end(), elements.begin(), elements.end());
    return first;
}

std::uint32_t append_polygon(Arrays& arrays, const scene::PlanarPolygon& source) {
    PolygonRecord record;
    record.origin = source.origin;
    record.u = source.u;
    record.v = source.v;
    record.first_point = append(arrays.points, source.polygon.points);
    record.first_ring = append(arrays.rings, source.polygon.ring_ends);
    record.point_count = static_cast<std::uint32_t>(source.polygon.points.size());
    record.ring_count = static_cast<std::uint32_t>(source.polygon.ring_ends.size());
    arrays.polygons.push_back(record);
    return static_cast<std::uint32_t>(arrays.polygons.size() - 1);
}

void append_mesh(Arrays& arrays, const scene::Scene& scene, scene::MeshId id) {
    const TriangleMesh& mesh = scene.mesh(id);
    MeshRecord record;
    record.box = scene.mesh_box(id);
    record.first_position = append(arrays.positions, mesh.positions);
    record.first_color = append(arrays.colors, mesh.colors);
    record.first_index = append(arrays.indices, mesh.indices);
    record.position_count = static_cast<std::uint32_t>(mesh.positions.size());
    record.color_count = static_cast<std::uint32_t>(mesh.colors.size());
    record.index_count = static_cast<std::uint32_t>(mesh.indices.size());
    record.first_name = static_cast<std::uint32_t>(append(arrays.names, scene.mesh_name(id)));
    record.name_size = static_cast<std::uint32_t>(scene.mesh_name(id).size());
    if (const scene::PlanarPolygon* polygon = scene.polygon(id)) record.polygon = append_polygon(arrays, *polygon);
    arrays.meshes.push_back(record);
}

void add_arrays(const Arrays& arrays, Writer& writer) {
    writer.add("meshes", std::span(arrays.meshes));
    writer.add("position", std::span(arrays.positions));
    writer.add("colors", std::span(arrays.colors));
    writer.add("indices", std::span(arrays.indices));
    writer.add("names", std::span(arrays.names));
    writer.add("polygons", std::span(arrays.polygons));
    writer.add("points", std::span(arrays.points));
    writer.add("rings", std::span(arrays.rings));
}

}  // namespace

Result<Vector<std::byte>> bake(const scene::Scene& scene, Executor& executor, const BakeOptions& options) {
    return bake(scene, executor, options, KnownClusters());
}

Result<Vector<std::byte>> bake(const scene::Scene& scene, Executor& executor, const BakeOptions& options,
                               const KnownClusters& known) {
    return detail::recover([&]() -> Result<Vector<std::byte>> {
        if (options.looks.size() > scene.mesh_count())
            return fail(ErrorCode::invalid_argument, scene.mesh_count(), "more looks than the scene has meshes");
        Arrays arrays;
        for (scene::MeshId mesh = 0; mesh < scene.mesh_count(); ++mesh) append_mesh(arrays, scene, mesh);
        if (arrays.names.size() > std::numeric_limits<std::uint32_t>::max())
            return fail(ErrorCode::out_of_range, kNoItem, "the meshes' names have more than 2^32 - 1 characters");
        Writer writer;
        add_arrays(arrays, writer);
        Vector<InstanceRecord> instances;
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
            instances.push_back({scene.mesh_of(i), scene.node_of(i)});
        writer.add("instance", std::span<const InstanceRecord>(instances));
        Vector<NodeRecord> nodes;
        for (scene::NodeId node = 0; node < scene.node_count(); ++node)
            nodes.push_back({scene.world(node), scene.parent_of(node)});
        writer.add("nodes", std::span<const NodeRecord>(nodes));
        const std::span<const Obb> boxes = scene.world_boxes();
        Vector<Obb> of_region;
        if (options.region_max_origin > 0.0) of_region.assign(boxes.begin(), boxes.end());
        for (scene::InstanceId i = 0; i < of_region.size(); ++i)
            if (!scene.is_removed(i))
                of_region[i] =
                    world::region_box(boxes[i], scene.world(scene.node_of(i)).translation, options.region_max_origin);
        if (const auto added =
                add_tree(of_region.empty() ? boxes : of_region, scene.layer_masks(), writer, executor, options.tree);
            !added)
            return added.error();
        if (!options.looks.empty()) add_looks(options.looks, scene.mesh_count(), writer);
        if (options.clusters) add_clusters(scene, known, writer, executor);
        if (options.occluders != nullptr)
            if (const auto added = add_occluders(*options.occluders, scene.node_count(), writer); !added)
                return added.error();
        return writer.finish();
    });
}

}  // namespace crofton::bake
