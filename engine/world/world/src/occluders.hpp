// SPDX-License-Identifier: MIT
// What of a World's objects hides other things: the occluders of meshes, placed with each object.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/scene/scene.hpp>
#include <span>

#include "object_table.hpp"

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
    void update(const ObjectTable& table, const scene::Scene& scene);

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
    };
    struct Holder {
        occlude::OccluderId first = kNoIndex;
        scene::MeshId mesh = kNoIndex;
    };
    void remove_shapes(Vector<occlude::ShapeId>& shapes);
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
    Vector<Placed> placed_;   // by occluder
    Vector<Holder> holders_;  // by object
    Vector<scene::MeshId> changed_meshes_;
    Vector<std::uint32_t> changed_objects_;
    bool any_ = false;  // some mesh has had occluders
};

}  // namespace crofton::world
