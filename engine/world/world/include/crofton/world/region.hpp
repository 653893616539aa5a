// SPDX-License-Identifier: MIT
// A part of a large world, prepared on any thread and attached to a World in constant time.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/world/inputs.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace crofton {

namespace world {
struct RegionData;
}

// One object of a region: a bound, or a mesh, or a shape alone. All of it is relative to the region's origin.
struct RegionObject {
    Bound bound = {};
    std::uint64_t user = 0;             // returned with every answer
    std::uint32_t layers = ~0u;         // as ObjectDescription
    std::uint32_t collides_with = ~0u;  // as ObjectDescription; regions' objects form no pairs with each other
    std::uint32_t mesh = kNoIndex;      // its place in RegionOptions::meshes
    // As World::set_shape, but bounded: add ground to the World itself. Data that the shape refers to must stay alive
    // and unchanged while a copy of the region lives (RegionOptions::keep).
    const convex::Shape* shape = nullptr;
    Transform transform = {};    // of a mesh, or of a shape without a bound
    bool occludes = true;        // as ObjectDescription
    bool only_occludes = false;  // as ObjectDescription
};

// A mesh of a region, which its objects share.
struct RegionMesh {
    MeshDescription mesh = {};
    // As World::set_occluders. Not used if `mesh.occluders` is set: occluders are then searched for.
    std::span<const occlude::FoundOccluder> occluders = {};
};

struct RegionOptions {
    std::size_t max_objects = std::size_t{1} << 24;  // more are refused, so that time and memory stay bounded
    boxtree::Orientation tree = boxtree::Orientation::aligned;
    StopCallback should_stop = nullptr;
    void* stop_user = nullptr;
    std::span<const RegionMesh> meshes = {};  // read by prepare() alone
    // No coordinate of an origin may be larger if an object has a mesh or a shape. The boxes of such objects are wider
    // by about 1e-15 of it, so that they contain the mesh and the shape at any such origin, however sums round.
    double max_origin = 1e9;
    // A tree that an earlier prepare() of the same objects, or a bake, has built. The region takes it if its items have
    // the boxes and layers of the objects, bit for bit; otherwise it builds its own. Building takes most of the time.
    boxtree::BoxTree* built = nullptr;
    // The region holds it until its last copy is destroyed: what shapes refer to, if you like.
    std::shared_ptr<const void> keep = {};
};

// Many objects that do not move, with a tree over them. A Region does not change; World::attach places it, at several
// origins if you like.
//
// Copies share one block of memory, which is released with the last copy; a World keeps a copy of what is attached.
// Hold one of your own if freeing a million objects would disturb the thread that updates the World. Copies may be made
// and destroyed on any thread.
class Region {
  public:
    // Builds a region. Call it on any thread, also while a World is updated or queried: it touches no World.
    //
    // Error: what World::add would refuse, with `item` the object's place; what World::add_mesh or set_occluders would
    // refuse, with `item` the mesh's place; unsupported: a shape without bounds; out_of_range: more than max_objects;
    // cancelled: should_stop has returned true. It is asked every few milliseconds, except while a single mesh is
    // prepared.
    [[nodiscard]] static Result<Region> prepare(Strided<RegionObject> objects, const RegionOptions& options = {},
                                                Executor& executor = serial_executor());
    Region();  // without objects
    ~Region();
    Region(const Region& other);
    Region& operator=(const Region& other);
    Region(Region&& other) noexcept;  // the other is then without objects
    Region& operator=(Region&& other) noexcept;

    [[nodiscard]] std::size_t object_count() const;
    // Returns the box around all objects, relative to the origin, rounded outward; empty without objects.
    [[nodiscard]] const Aabb& bounds() const;
    // Returns how much memory all copies share, but for that of the allocator itself.
    // Meshes count with their triangles and trees; occluders and clusters are left out.
    [[nodiscard]] std::size_t bytes() const;
    // Returns the place of an object's mesh; kNoIndex: it has none. Requires a place below object_count().
    [[nodiscard]] std::uint32_t mesh_of(std::uint32_t place) const;
    // As World::clusters_of and World::occluders_of, of the mesh at a place.
    [[nodiscard]] const depth::ClusteredMesh* clusters_of(std::uint32_t mesh) const;
    [[nodiscard]] std::span<const occlude::FoundOccluder> occluders_of(std::uint32_t mesh) const;

    // For the engine's own use. nullptr: no objects.
    [[nodiscard]] const world::RegionData* data() const { return data_; }

  private:
    const world::RegionData* data_ = nullptr;
};

}  // namespace crofton
