// SPDX-License-Identifier: MIT
// Objects with meshes and shapes of a region that is being prepared.
#pragma once
#include <crofton/core/stop_signal.hpp>
#include <crofton/world/world.hpp>
#include <optional>

#include "region_data.hpp"

namespace crofton::world {

// Adds meshes, and objects with shapes, to a World of its own, so that they become what World::add makes of them, and
// then takes them out. Objects with a mesh alone are the most; they are made here, as World::add would.
class RegionSolids {
  public:
    static constexpr std::size_t kBetweenQuestions = 4096;  // objects, of the caller's StopCallback
    RegionSolids();

    void reserve(std::size_t objects) {
        added_.reserve(objects);
        solids_.reserve(objects);
    }

    // Errors: as World::add_mesh and set_occluders; the item is the mesh's place.
    [[nodiscard]] Result<void> add_meshes(std::span<const RegionMesh> meshes, detail::StopSignal& stop);
    // The object at place `item`. Errors: as World::add, and of a shape without bounds.
    [[nodiscard]] Result<void> add(const RegionObject& object, std::uint32_t item);
    // Replaces the boxes, layers and items of the objects that were added. The boxes contain mesh and shape wherever
    // the region is attached, up to `max_origin`. Errors: a box that is out of range then; cancelled.
    [[nodiscard]] Result<void> place(double max_origin, Vector<Obb>& boxes, Vector<std::uint32_t>& layers,
                                     Vector<RegionData::Item>& items, detail::StopSignal& stop);
    // Moves all the rest to the region, which has `item_count` objects. False: stopped.
    [[nodiscard]] bool finish(RegionData& data, std::size_t item_count, detail::StopSignal& stop, Executor& executor);

  private:
    struct Added {
        std::uint32_t item = 0;
        std::uint32_t object = kNoIndex;  // in the World; kNoIndex: a mesh alone
        bool only_occludes = false;
    };
    // Sets what the World's entry of an object holds. Returns what its box is moved with, if it may need a wider one.
    std::optional<glm::dvec3> place_object(const Added& added, const RegionData::Solid& solid, Obb& box,
                                           std::uint32_t& layers, RegionData::Item& item) const;
    World world_;
    Vector<MeshHandle> meshes_;
    Vector<std::uint8_t> wants_triangles_;  // by mesh
    Vector<Added> added_;
    Vector<RegionData::Solid> solids_;  // of these
};

}  // namespace crofton::world
