// SPDX-License-Identifier: MIT
// A part of a large world, prepared on any thread and attached to a World in constant time.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/world/inputs.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton {

namespace world {
struct RegionData;
}

// One object of a region. Its bound is relative to the region's origin.
struct RegionObject {
    Bound bound;
    std::uint64_t user = 0;             // returned with every answer
    std::uint32_t layers = ~0u;         // as ObjectDescription
    std::uint32_t collides_with = ~0u;  // as ObjectDescription; regions' objects form no pairs with each other
};

struct RegionOptions {
    std::size_t max_objects = std::size_t{1} << 24;  // more are refused, so that time and memory stay bounded
    boxtree::Orientation tree = boxtree::Orientation::aligned;
    StopCallback should_stop = nullptr;
    void* stop_user = nullptr;
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
    // Error: a bound that World::add would refuse, with `item` its place; out_of_range: more than max_objects;
    // cancelled: should_stop has returned true. It is asked between the steps and while objects are read, and not while
    // the tree is built, which takes most of the time: 0.5 s for a million objects.
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
    [[nodiscard]] std::size_t bytes() const;

    // For the engine's own use. nullptr: no objects.
    [[nodiscard]] const world::RegionData* data() const { return data_; }

  private:
    const world::RegionData* data_ = nullptr;
};

}  // namespace crofton
