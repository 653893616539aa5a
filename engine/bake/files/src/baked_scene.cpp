// SPDX-License-Identifier: MIT
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>

#include <string>

#include <crofton/bake/occluder_sections.hpp>
#include "mesh_sections.hpp"
#include "tree_section.hpp"

namespace crofton::bake {
namespace {

bool lies_in(std::uint64_t first, std::uint64_t count, std::size_t size) {
    return first <= size && count <= size - first;
}

Error damaged(const char* what, std::uint64_t item) {
    return fail(ErrorCode::parse, item, what);
}

template <class T>
Result<void> take(const Reader& reader, std::string_view name, std::span<const T>& section) {
    const auto found = reader.section<T>(name);
    if (!found) return found.error();
    section = *found;
    return {};
}

// Corners are vertices of the mesh.
bool all_below(std::span<const std::uint32_t> indices, std::uint32_t limit) {
    std::uint32_t largest = 0;
    for (const std::uint32_t index : indices) largest = index > largest ? index : largest;
    return indices.empty() || largest < limit;
}

}  // namespace

Result<void> BakedScene::check_meshes() const {
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
        const MeshRecord& mesh = meshes_[i];
        if (!lies_in(mesh.first_position, mesh.position_count, positions_.size()) ||
            !lies_in(mesh.first_color, mesh.color_count, colors_.size()) ||
            !lies_in(mesh.first_index, mesh.index_count, indices_.size()) ||
            !lies_in(mesh.first_name, mesh.name_size, names_.size()))
            return damaged("a mesh's arrays lie outside their sections", i);
        if (mesh.color_count != 0 && mesh.color_count != mesh.position_count)
            return damaged("a mesh has colours, but not one a vertex", i);
        if (mesh.index_count % 3 != 0 ||
            !all_below(indices_.subspan(mesh.first_index, mesh.index_count), mesh.position_count))
            return damaged("a mesh's triangle names a vertex that it does not have", i);
        if (mesh.polygon != scene::kNone && mesh.polygon >= polygons_.size())
            return damaged("a mesh names a polygon that is not there", i);
        if (const auto valid = validate(mesh.box, i); !valid) return damaged("a mesh's box is no box", i);
    }
    for (std::size_t i = 0; i < polygons_.size(); ++i) {
        const PolygonRecord& polygon = polygons_[i];
        if (!lies_in(polygon.first_point, polygon.point_count, points_.size()) ||
            !lies_in(polygon.first_ring, polygon.ring_count, rings_.size()))
            return damaged("a polygon's arrays lie outside their sections", i);
        std::uint32_t end = 0;
        for (const std::uint32_t ring : rings_.subspan(polygon.first_ring, polygon.ring_count)) {
            if (ring < end || ring > polygon.point_count) return damaged("a polygon's ring ends do not ascend", i);
            end = ring;
        }
    }
    return {};
}

Result<void> BakedScene::check_instances() const {
    if (tree_->boxes().size() != instances_.size()) return damaged("the tree is not over the instances", kNoItem);
    for (std::size_t i = 0; i < instances_.size(); ++i)
        if ((instances_[i].mesh >= meshes_.size() || instances_[i].node >= nodes_.size()) &&
            !(instances_[i].mesh == scene::kNone && instances_[i].node == scene::kNone))
            return damaged("an instance names a mesh or a node that is not there", i);
    // The way up from each node ends at a root or where an earlier way has passed, never where it has been itself.
    Vector<std::uint32_t> passed(nodes_.size(), scene::kNone);
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
        for (std::uint32_t at = i; at != scene::kNone; at = nodes_[at].parent) {
            if (at >= nodes_.size()) return damaged("a node names a parent that is not there", i);
            if (passed[at] == i) return damaged("a node is its own ancestor", i);
            if (passed[at] != scene::kNone) break;
            passed[at] = i;
        }
    return {};
}

Result<BakedScene> BakedScene::from_memory(std::span<const std::byte> file, Executor& executor,
                                           StopCallback should_stop, void* stop_user) {
    return detail::recover([&]() -> Result<BakedScene> {
        detail::StopSignal stop(should_stop, stop_user);
        const auto reader = Reader::open(file, executor, &stop);
        if (!reader) return reader.error();
        BakedScene baked;
        const Result<void> taken[] = {
            take(*reader, "meshes", baked.meshes_),      take(*reader, "position", baked.positions_),
            take(*reader, "colors", baked.colors_),      take(*reader, "indices", baked.indices_),
            take(*reader, "names", baked.names_),        take(*reader, "polygons", baked.polygons_),
            take(*reader, "points", baked.points_),      take(*reader, "rings", baked.rings_),
            take(*reader, "instance", baked.instances_), take(*reader, "nodes", baked.nodes_),
        };
        for (const auto& each : taken)
            if (!each) return each.error();
        if (const auto good = baked.check_meshes(); !good) return good.error();
        if (stop.is_raised(0.5)) return detail::cancelled("baked scene");
        detail::PartOfStop reading_tree{should_stop, stop_user, 0.5, 0.7};
        auto tree = read_tree(*reader, detail::PartOfStop::ask, &reading_tree);
        if (!tree) return tree.error();
        baked.tree_.emplace(std::move(*tree));
        if (stop.is_raised(0.7)) return detail::cancelled("baked scene");
        if (const auto good = baked.check_instances(); !good) return good.error();
        const auto looks = read_looks(*reader, baked.meshes_.size());
        if (!looks) return looks.error();
        baked.looks_ = *looks;
        if (stop.is_raised(0.8)) return detail::cancelled("baked scene");
        auto clusters = read_clusters(*reader, baked.meshes_);
        if (!clusters) return clusters.error();
        baked.clusters_ = std::move(*clusters);
        if (stop.is_raised(0.9)) return detail::cancelled("baked scene");
        auto occluders = read_occluders(*reader, baked.nodes_.size());
        if (!occluders) return occluders.error();
        baked.occluders_ = std::move(*occluders);
        return baked;
    });
}

Result<BakedScene> BakedScene::open(const std::string& path, Executor& executor, const FileOptions& options) {
    return detail::recover([&]() -> Result<BakedScene> {
        auto file = MappedFile::open(path, options);
        if (!file) return file.error();
        auto baked = from_memory(file->bytes(), executor);
        if (!baked) return fail(baked.error().code, baked.error().item, {path, ": ", baked.error().message});
        baked->file_.emplace(std::move(*file));
        return baked;
    });
}

MeshView BakedScene::mesh(scene::MeshId id) const {
    const MeshRecord& mesh = meshes_[id];
    return {std::string_view(names_.data() + mesh.first_name, mesh.name_size),
            mesh.box,
            positions_.subspan(mesh.first_position, mesh.position_count),
            colors_.subspan(mesh.first_color, mesh.color_count),
            indices_.subspan(mesh.first_index, mesh.index_count),
            looks_.empty() ? MeshLook{} : look_of(looks_[id])};
}

const depth::ClusteredMesh* BakedScene::clusters(scene::MeshId id) const {
    return clusters_.empty() || !clusters_[id] ? nullptr : &*clusters_[id];
}

std::optional<PolygonView> BakedScene::polygon(scene::MeshId id) const {
    if (meshes_[id].polygon == scene::kNone) return std::nullopt;
    const PolygonRecord& polygon = polygons_[meshes_[id].polygon];
    return PolygonView{points_.subspan(polygon.first_point, polygon.point_count),
                       rings_.subspan(polygon.first_ring, polygon.ring_count), polygon.origin, polygon.u, polygon.v};
}

}  // namespace crofton::bake
