// SPDX-License-Identifier: MIT
// The regions that are attached to a World.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/moved_tree.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/moved_tree.hpp>
#include <crofton/geometry/move.hpp>
#include <crofton/world/answers.hpp>
#include <crofton/world/region.hpp>

#include "object_table.hpp"
#include "picture_view.hpp"
#include "region_data.hpp"

namespace crofton::world {

struct RegionQuery;

[[nodiscard]] inline bool is_region_index(std::uint32_t index) {
    return index >= kFirstRegionIndex && index != kNoIndex;
}

// A region at an origin. Its objects' indices are consecutive, from `first` on.
struct Attachment {
    Region region;
    Move move;
    cull::MovedTree tree;  // the region's, of which there are objects
    std::uint32_t common_layers = 0;
    Obb bounds;  // in the world, around all objects
    std::uint32_t first = kNoIndex;
    std::uint32_t generation = 0;
    boxtree::ItemId item = 0;     // in the tree of regions, if `placed`
    bool alive = false;           // attached, and not detached since
    bool placed = false;          // since the last update
    Vector<std::uint64_t> shown;  // a bit for each object; empty: all are shown
    std::size_t hidden_count = 0;

    [[nodiscard]] const RegionData& data() const { return *region.data(); }
    [[nodiscard]] std::size_t size() const { return region.object_count(); }
    [[nodiscard]] Obb box(std::uint32_t item_of_region) const { return move(data().tree.boxes()[item_of_region]); }
    [[nodiscard]] ObjectRef ref(std::uint32_t item_of_region) const {
        return {{first + item_of_region, generation}, data().items[item_of_region].user};
    }
    [[nodiscard]] Object object(std::uint32_t item_of_region) const;
    [[nodiscard]] bool is_shown(std::uint32_t item_of_region) const {
        return shown.empty() || (shown[item_of_region / 64] >> item_of_region % 64 & 1) != 0;
    }
};

// Attached regions are a few lines of memory each, in a tree by their bounds; what they hold stays where it is.
class Regions {
  public:
    explicit Regions(std::uint32_t first_generation);

    [[nodiscard]] Result<RegionHandle> attach(const Region& region, const glm::dvec3& origin);
    [[nodiscard]] Result<void> detach(RegionHandle region);
    [[nodiscard]] Result<void> set_hidden(ObjectHandle object, bool hidden);
    // Applies what has been called for. Returns whether anything has.
    bool update();
    // Slots of regions that the last update() has placed, or of which it has hidden or shown objects.
    [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }
    [[nodiscard]] const Attachment& at_slot(std::uint32_t slot) const { return attachments_[slot]; }

    [[nodiscard]] Aabb bounds() const;  // around all regions of the last update; roughly
    // None was attached in the last update, and none was before it.
    [[nodiscard]] bool is_empty() const { return tree_.item_count() == 0; }
    [[nodiscard]] std::size_t object_count() const { return object_count_; }
    [[nodiscard]] bool contains(RegionHandle region) const;
    [[nodiscard]] bool contains(ObjectHandle object) const;
    [[nodiscard]] bool is_shown(ObjectHandle object) const {  // attached, and not hidden
        return contains(object) && of(object.index).is_shown(object.index - of(object.index).first);
    }
    [[nodiscard]] Result<void> check(RegionHandle region) const;
    [[nodiscard]] const Attachment& at(RegionHandle region) const { return attachments_[region.index]; }
    // Why an object of a region cannot be changed, or that the handle is stale.
    [[nodiscard]] Result<void> refuse_change(ObjectHandle object, std::uint64_t item) const;
    [[nodiscard]] Result<void> check(ObjectHandle object, std::uint64_t item) const;

    // Of an object's index in an answer, or in a handle that is not stale.
    [[nodiscard]] const Attachment& of(std::uint32_t index) const { return attachments_[slot_of(index)]; }
    [[nodiscard]] RegionHandle handle_of(std::uint32_t index) const { return {slot_of(index), of(index).generation}; }
    [[nodiscard]] ObjectRef ref(std::uint32_t index) const;  // null: its region is gone
    [[nodiscard]] Obb box(std::uint32_t index) const {
        const Attachment& region = of(index);
        return region.box(index - region.first);
    }
    [[nodiscard]] Object object(std::uint32_t index) const;  // as if it were the World's own, but for its mesh
    // As the World's own: an object's mesh, if triangles stand for it, and its shape.
    [[nodiscard]] PlacedMesh mesh(std::uint32_t index) const;
    [[nodiscard]] PictureView::Drawn drawn(std::uint32_t index) const;        // in a picture
    [[nodiscard]] const TriangleMesh& triangles(std::uint32_t index) const {  // of an object with a mesh
        return of(index).data().meshes[solid(index)->mesh].triangles;
    }
    [[nodiscard]] bool has_shape(std::uint32_t index) const { return placed_shape(index) != nullptr; }
    [[nodiscard]] const convex::Shape& shape(std::uint32_t index) const { return placed_shape(index)->shape(); }
    [[nodiscard]] std::optional<RigidTransform> pose(std::uint32_t index) const;
    [[nodiscard]] const RegionData::Solid* solid(std::uint32_t index) const {
        const Attachment& region = of(index);
        return region.data().solid(index - region.first);
    }
    [[nodiscard]] bool has_transform(std::uint32_t index) const {
        return solid(index) != nullptr && solid(index)->has_transform;
    }
    [[nodiscard]] Transform transform(std::uint32_t index) const;  // of an object that has one

    // As the World's own of these names, for the regions' objects. The visitors get indices. A ray's visitor is called
    // for boxes that the ray meets.
    void visit_along(const Ray& ray, std::uint32_t layers, collide::RayVisitor visit) const;
    void visit_swept(const Ray& path, const glm::dvec3& half_size, std::uint32_t layers,
                     collide::NearVisitor visit) const;
    void visit_near(const Aabb& bounds, double distance, std::uint32_t layers, collide::NearVisitor visit) const;
    // Adds what a view sees to an answer.
    void find_visible(const RegionQuery& query, WholeView& result) const;

  private:
    static constexpr std::uint32_t kPage = 1024;  // indices are given away by pages
    struct Pages {
        std::uint32_t first = 0, count = 0;
    };
    struct StagedHide {
        ObjectHandle object;
        bool hidden = false;
    };
    [[nodiscard]] collide::MovedTree tree_of(boxtree::ItemId item) const;  // none where it is detached
    [[nodiscard]] std::uint32_t slot_of(std::uint32_t index) const {
        return page_slots_[(index - kFirstRegionIndex) / kPage];
    }
    [[nodiscard]] static std::uint32_t pages_of(const Region& region) {
        return static_cast<std::uint32_t>((region.object_count() + kPage - 1) / kPage);
    }
    [[nodiscard]] const PlacedShape* placed_shape(std::uint32_t index) const {
        const Attachment& region = of(index);
        return region.data().shape(index - region.first);
    }
    [[nodiscard]] Result<std::uint32_t> take_pages(std::uint32_t count);
    void give_back(Pages pages);
    void place(std::uint32_t slot);
    void drop(std::uint32_t slot);
    void apply(const StagedHide& change);
    [[nodiscard]] bool may_be_within(const cull::DrawLimits& limits, const Attachment& region) const;
    void list_seen(const RegionQuery& query, WholeView& result) const;
    void add_visible(const RegionQuery& query, WholeView& result) const;  // of the regions in the batch
    static void add_whole(const Attachment& region, bool by_tree, WholeView& result);
    void add_listed(const Attachment& region, std::size_t tree, const RegionQuery& query, WholeView& result) const;

    Vector<Attachment> attachments_;
    Vector<std::uint32_t> free_slots_;
    Vector<std::uint32_t> page_slots_;           // which attachment has the page; kNoIndex: none
    Vector<Pages> free_pages_;                   // ascending, never two that adjoin
    Vector<std::uint32_t> attached_, detached_;  // slots, since the last update
    Vector<StagedHide> hides_;
    Vector<std::uint32_t> changed_;
    boxtree::BoxTree tree_;               // of bounds
    Vector<std::uint32_t> slot_of_item_;  // of the tree's items
    std::uint32_t next_generation_;
    std::size_t object_count_ = 0;  // of those that are alive
    unsigned rebuilds_wanted_ = 0;
};

}  // namespace crofton::world
