// What a World keeps.
#pragma once
#include <crofton/collide/tree_query.hpp>
#include <crofton/world/world.hpp>

#include "contact_finder.hpp"
#include "object_table.hpp"
#include "spatial_index.hpp"

namespace crofton {

// What an object gets in the next update(), beside its layers and whether it is shown.
struct StagedChange {
    std::uint32_t object = kNoIndex;
    bool has_bound = false;
    Bound bound;
};

struct World::State {
    explicit State(const WorldOptions& chosen) : options(chosen), finder(chosen) {}

    WorldOptions options;
    WorldStatistics statistics;
    world::ObjectTable table;
    world::SpatialIndex index;
    world::ContactFinder finder;
    Vector<StagedChange> staged;
    Vector<std::uint32_t> removed;
    bool pairs_changed = false;  // something other than a box

    [[nodiscard]] Result<void> check(ObjectHandle object, std::uint64_t item) const;
    StagedChange& stage(std::uint32_t object);
    [[nodiscard]] Result<void> set_bound(ObjectHandle object, const Bound& bound, std::uint64_t item);
    void apply_changes();

    // How far along the ray an object's own shape is met, no farther than the ray goes; its box is met at `box_t`.
    [[nodiscard]] std::optional<ObjectHit> shape_hit(const collide::Ray& ray, std::uint32_t object, double box_t) const;
    // Visits objects whose boxes the ray meets; the visitor answers how far along the ray others are of interest.
    void visit_along(const collide::Ray& ray, std::uint32_t layers, collide::RayVisitor visit) const;
    // Visits objects whose boxes are within `distance` of `bounds`, and some others.
    void visit_near(const Aabb& bounds, double distance, std::uint32_t layers, collide::NearVisitor visit) const;
    template <class Shape>
    void overlap(const Shape& shape, Vector<ObjectRef>& found, std::uint32_t layers) const;
    template <class Shape>
    [[nodiscard]] std::optional<ClosestObject> closest(const Shape& shape, double max_distance,
                                                       std::uint32_t layers) const;
};

}  // namespace crofton
