// SPDX-License-Identifier: MIT
#include "region_solids.hpp"

#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <crofton/world/region_box.hpp>
#include <glm/common.hpp>

#include "require_ok.hpp"
#include "world_state.hpp"

namespace crofton::world {
namespace {

double sum_of_sizes(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

Error at_item(Error error, std::uint64_t item) {
    error.item = item;
    return error;
}

// What stands at t + origin is in a box around c + origin, relative to its own coordinates. Both sums round, by 2^-53
// of themselves on each axis. Twice that.
double rounding_at(const glm::dvec3& t, const glm::dvec3& c, double max_origin) {
    return 0x1p-52 * (sum_of_sizes(t) + sum_of_sizes(c) + 6.0 * max_origin);
}

}  // namespace

Obb region_box(const Obb& box, const glm::dvec3& translation, double max_origin) {
    Obb wider = box;
    wider.half_extents = rounded_up(glm::dvec3(box.half_extents), rounding_at(translation, box.center, max_origin));
    return wider;
}

RegionSolids::RegionSolids() : world_({.pairs = false}, 1) {}

Result<void> RegionSolids::add_meshes(std::span<const RegionMesh> meshes, detail::StopSignal& stop) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (stop.is_raised(0.0)) return detail::cancelled("region");
        MeshDescription description = meshes[i].mesh;
        wants_triangles_.push_back(description.triangles);
        description.triangles = false;  // finish() builds the trees
        const auto mesh = world_.add_mesh(description);
        if (!mesh) return at_item(mesh.error(), i);
        if (!description.occluders && !meshes[i].occluders.empty())
            if (auto set = world_.set_occluders(*mesh, meshes[i].occluders); !set) return at_item(set.error(), i);
        meshes_.push_back(*mesh);
    }
    return {};
}

Result<void> RegionSolids::add(const RegionObject& object, std::uint32_t item) {
    if (object.mesh != kNoIndex && object.mesh >= meshes_.size())
        return fail(ErrorCode::invalid_argument, item, {"region: there is no mesh ", object.mesh, " in the options"});
    if (object.shape != nullptr && !object.shape->is_bounded())
        return fail(ErrorCode::unsupported, item,
                    "region: an object's shape is infinite ground: add it to the World itself");
    const bool has_mesh = object.mesh != kNoIndex, has_transform = has_mesh || object.bound.kind == BoundKind::none;
    Added& added = added_.emplace_back();
    added.item = item;
    added.only_occludes = object.only_occludes;
    solids_.push_back({.transform = has_transform ? object.transform : Transform(),
                       .has_transform = has_transform,
                       .mesh = object.mesh,
                       .occludes = has_mesh && object.occludes});
    if (has_mesh && object.shape == nullptr && object.bound.kind == BoundKind::none)
        return crofton::validate(object.transform, item);
    ObjectDescription description{.bound = object.bound,
                                  .shape = object.shape,
                                  .layers = object.layers,
                                  .occludes = object.occludes,
                                  .only_occludes = object.only_occludes};
    if (has_mesh) description.mesh = meshes_[object.mesh];
    if (has_transform) description.transform = object.transform;
    const auto in_world = world_.add(description);
    if (!in_world) return at_item(in_world.error(), item);
    added.object = in_world->index;
    return {};
}

std::optional<glm::dvec3> RegionSolids::place_object(const Added& added, const RegionData::Solid& solid, Obb& box,
                                                     std::uint32_t& layers, RegionData::Item& item) const {
    const World::State& s = *world_.state_;
    const Object& object = s.table.objects[added.object];
    box = s.index.box(added.object);
    item.kind = object.kind;
    item.radius = object.radius;
    if (solid.has_transform) {
        layers = s.scene.layer_masks()[object.instance];
        return solid.transform.translation;
    }
    if (!s.object_shapes.is_grown(added.object)) return std::nullopt;
    return s.object_shapes.given(added.object).box.center;
}

Result<void> RegionSolids::place(double max_origin, Vector<Obb>& boxes, Vector<std::uint32_t>& layers,
                                 Vector<RegionData::Item>& items, detail::StopSignal& stop) {
    World::State& s = *world_.state_;
    require_ok(s.apply_scene(serial_executor()));
    for (std::size_t i = 0; i < added_.size(); ++i) {
        if (i % kBetweenQuestions == 0 && stop.is_raised(0.1)) return detail::cancelled("region");
        const Added& added = added_[i];
        RegionData::Solid& solid = solids_[i];
        Obb& box = boxes[added.item];
        std::uint32_t& mask = layers[added.item];
        std::optional<glm::dvec3> at = solid.transform.translation;
        if (added.object != kNoIndex) {
            at = place_object(added, solid, box, mask, items[added.item]);
        } else {
            // As in a Scene, what has no box, or is a point, is in no layer.
            const auto placed = scene::transformed_box(solid.transform, s.scene.mesh_box(meshes_[solid.mesh].index),
                                                       scene::SceneOptions().criterion);
            box = placed ? *placed : Obb();
            if (!placed || maps_to_point(solid.transform)) mask = 0;
            items[added.item].radius = 0.0;
        }
        if (solid.occludes) solid.occluding_layers = mask;
        if (added.only_occludes) mask = 0;
        if (!at) continue;
        box = region_box(box, *at, max_origin);
        if (auto valid = validate(box, added.item); !valid) return valid;
    }
    return {};
}

bool RegionSolids::finish(RegionData& data, std::size_t item_count, detail::StopSignal& stop, Executor& executor) {
    World::State& s = *world_.state_;
    data.meshes.resize(meshes_.size());
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
        const scene::MeshId id = meshes_[m].index;
        if (wants_triangles_[m]) data.meshes[m].triangles = s.scene.mesh(id);
        const std::span<const occlude::FoundOccluder> occluders = s.occluders.occluders_of(id);
        data.meshes[m].occluders.assign(occluders.begin(), occluders.end());
        data.meshes[m].clusters = s.mesh_clusters.take(id);
        // It reads the arrays of a World that goes.
        if (wants_triangles_[m])
            require_ok(MeshClusters::lend(data.meshes[m].clusters, data.meshes[m].triangles));
        else
            data.meshes[m].clusters.cut.keep_copy();
    }
    detail::recoverable_for(executor, data.meshes.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t m = begin; m < end; ++m)
            if (wants_triangles_[m] && !stop.is_raised(0.8))
                data.meshes[m].shape.build(data.meshes[m].triangles, false, serial_executor());
    });
    if (stop.was_raised()) return false;
    data.solid_of_item.assign(item_count, kNoIndex);
    data.solids = std::move(solids_);
    for (std::size_t i = 0; i < added_.size(); ++i) {
        const Added& added = added_[i];
        data.solid_of_item[added.item] = static_cast<std::uint32_t>(i);
        RegionData::Solid& solid = data.solids[i];
        if (solid.occludes && data.meshes[solid.mesh].occluders.empty()) solid.occluding_layers = 0;
        if (solid.occluding_layers != 0) data.occluding.push_back(added.item);
        if (added.object == kNoIndex || !s.object_shapes.has(added.object)) continue;
        const Object& object = s.table.objects[added.object];
        solid.shape = static_cast<std::uint32_t>(data.shapes.size());
        const auto pose = s.object_shapes.pose_of(added.object, object, s.index.box(added.object), s.scene);
        data.shapes.push_back(s.object_shapes.take(added.object));
        data.shapes.back().pose = pose;
    }
    return true;
}

}  // namespace crofton::world
