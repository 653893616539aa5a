// SPDX-License-Identifier: MIT
// The occluders of a World's meshes, placed for each object.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/core/paged_vector.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/scene/scene.hpp>
#include <span>

#include "object_table.hpp"
#include "regions.hpp"

namespace crofton::world {

// Shapes and candidates change in update() alone; so do the answers of const calls, but for occluders_of().
class Occluders {
  public:
    // Of a mesh's objects, from the next update on. Errors, by the occluder's place: as OccluderSet's functions.
    [[nodiscard]] Result<void> set(scene::MeshId mesh, std::span<const occlude::FoundOccluder> occluders);
    void clear(scene::MeshId mesh);
    [[nodiscard]] std::span<const occlude::FoundOccluder> occluders_of(scene::MeshId mesh) const {
        return mesh < meshes_.size() ? std::span<const occlude::FoundOccluder>(meshes_[mesh].occluders)
                                     : std::span<const occlude::FoundOccluder>();
    }

    // The object has come, gone, moved, or is shown, drawn or meshed otherwise.
    void note(std::uint32_t object) {
        if (any_) changed_objects_.push_back(object);
    }
    // Returns whether anything has changed.
    bool update(const ObjectTable& table, const scene::Scene& scene);

    // Of regions' objects: adds what has come, and takes away what has gone, as much as an update has time for. The
    // rest hides nothing meanwhile. Returns whether any has come or gone.
    bool update_regions(const Regions& regions);
    // How many objects of attached regions wait for that.
    [[nodiscard]] std::size_t waiting_count() const { return waiting_count_; }
    // Whether its object is one of a region, and detached or hidden.
    [[nodiscard]] bool is_gone(occlude::OccluderId id, const Regions& regions) const {
        const Placed& placed = placed_[id];
        return is_region_index(placed.object) && !regions.is_shown({placed.object, placed.generation});
    }

    // An occluder's id is that of its candidate.
    [[nodiscard]] const occlude::OccluderSet& set() const { return set_; }
    [[nodiscard]] const occlude::OccluderCandidates& candidates() const { return candidates_; }
    [[nodiscard]] bool any() const { return any_; }
    // The object that has it, and its place among the mesh's.
    [[nodiscard]] std::uint32_t object_of(occlude::OccluderId id) const { return placed_[id].object; }
    [[nodiscard]] std::uint32_t place_of(occlude::OccluderId id) const { return placed_[id].place; }

  private:
    struct Mesh {
        Vector<occlude::FoundOccluder> occluders;
        Vector<occlude::ShapeId> shapes;  // of the occluders
        Vector<occlude::ShapeId> placed;  // those that the last update() placed
        bool changed = false;
    };
    struct Placed {
        std::uint32_t object = kNoIndex, place = 0;
        occlude::OccluderId next = kNoIndex;  // of the object
        std::uint32_t generation = 0;         // of a region's object
    };
    struct Holder {
        occlude::OccluderId first = kNoIndex;
        scene::MeshId mesh = kNoIndex;
    };
    // A region's shapes, which all its attachments share.
    struct RegionShapes {
        Region region;
        Vector<Vector<occlude::ShapeId>> of_mesh;
        std::size_t users = 0;
    };
    // What an attached region has placed: the first occluders of its occluding objects, in order.
    struct RegionHolder {
        RegionHandle handle;
        ObjectHandle first_object;
        glm::dvec3 origin{0.0};
        std::size_t shapes = 0;
        Vector<occlude::OccluderId> first;
    };
    [[nodiscard]] std::size_t shapes_of(const Region& region);
    void release_shapes(std::size_t shapes);
    // Does a part of what waits, and returns what it has cost.
    std::size_t add_some(RegionHolder& holder, std::size_t budget);
    std::size_t take_some(RegionHolder& holder, std::size_t budget);
    [[nodiscard]] Result<occlude::ShapeId> add_shape(const occlude::FoundOccluder& occluder);
    void remove_shapes(Vector<occlude::ShapeId>& shapes);
    void take_away_chain(occlude::OccluderId first);
    void place_one(occlude::ShapeId shape, const occlude::FoundOccluder& occluder, const Transform& transform,
                   std::uint32_t layers, Placed placed, occlude::OccluderId& first);
    void change_meshes(const ObjectTable& table);
    void change_object(std::uint32_t object, const ObjectTable& table, const scene::Scene& scene);
    void take_away(std::uint32_t object);
    void place(std::uint32_t object, const Transform& transform, std::uint32_t layers);
    [[nodiscard]] bool move(std::uint32_t object, const Transform& transform, std::uint32_t layers);
    [[nodiscard]] bool set_candidate(occlude::OccluderId id, const occlude::FoundOccluder& occluder,
                                     const Transform& transform, std::uint32_t layers);

    occlude::OccluderSet set_;
    occlude::OccluderCandidates candidates_;
    Vector<Mesh> meshes_;
    PagedVector<Placed, 256> placed_;  // by occluder
    Vector<Holder> holders_;           // by object
    Vector<scene::MeshId> changed_meshes_;
    Vector<std::uint32_t> changed_objects_;
    Vector<RegionShapes> region_shapes_;
    Vector<RegionHolder> region_holders_;  // in the order in which they came
    std::size_t waiting_count_ = 0;
    bool any_ = false;  // some mesh has had occluders
};

}  // namespace crofton::world
