// SPDX-License-Identifier: MIT
// Results of a World's queries: views, hits, pairs, contacts.
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/inputs.hpp>
#include <cstdint>
#include <span>

namespace crofton {

namespace convex {
struct TrackedPoint;
}
namespace world {
class Regions;

// Indexed by an object's index.
struct ObjectNames {
    std::span<const std::uint32_t> generations;
    std::span<const std::uint64_t> users;
    const Regions* regions = nullptr;  // which have the names of their objects
};

struct OccludedView;  // a view's depth buffer and the results of its tests
struct OccludedViewDeleter {
    void operator()(OccludedView* view) const;
};
using OccludedViewOwner = Owner<OccludedView, OccludedViewDeleter>;

// The answer of a World with regions: of its own objects and of theirs.
struct WholeView;
struct WholeViewDeleter {
    void operator()(WholeView* view) const;
};
using WholeViewOwner = Owner<WholeView, WholeViewDeleter>;
struct WholeViews;
struct WholeViewsDeleter {
    void operator()(WholeViews* views) const;
};
using WholeViewsOwner = Owner<WholeViews, WholeViewsDeleter>;

// Tells whether an answer is of a World as it is now. Numbers are used once in a process, so another World has others.
struct Revision {
    std::uint64_t update = 0;   // of the last update() that changed something
    std::uint64_t removal = 0;  // of the last object or mesh that was removed or replaced, which counts at once
    bool operator==(const Revision&) const = default;
};
}  // namespace world

struct ObjectRef {
    ObjectHandle object;
    std::uint64_t user = 0;
};

namespace world {
[[nodiscard]] ObjectRef region_ref(const ObjectNames& names, std::uint32_t index);
[[nodiscard]] inline ObjectRef ref(const ObjectNames& names, std::uint32_t index) {
    if (index >= kFirstRegionIndex) return region_ref(names, index);
    return {{index, names.generations[index]}, names.users[index]};
}
}  // namespace world

// An object's region, and its place among the objects that the region was prepared from.
struct RegionPlace {
    RegionHandle region;
    std::uint32_t index = 0;
};

// Names an occluder: its object, and its place in World::occluders_of of the object's mesh.
struct OccluderRef {
    ObjectHandle object;
    std::uint64_t user = 0;
    std::uint32_t place = 0;
};

struct OcclusionStatistics {
    std::uint32_t occluders_drawn = 0;  // chosen for the view
    occlude::DrawStatistics drawn;
    occlude::VisibleStatistics asked;
};

// The result of one view. Keep it from frame to frame: it allocates only when it must grow.
//
// operator[] and ref() look objects up in the World, so call them before the World changes or is destroyed. ids() and
// counts stay valid.
class ViewResult {
  public:
    [[nodiscard]] std::size_t size() const { return ids().size(); }
    // Returns indices. In ascending order, objects of regions come last.
    [[nodiscard]] std::span<const std::uint32_t> ids() const {
        return with_regions_ ? whole_ids() : hides_ ? seen_ids() : set_.ids();
    }
    [[nodiscard]] ObjectRef operator[](std::size_t i) const { return ref(ids()[i]); }
    // In tree order, the first inside_count() objects are inside the view and the others straddle its boundary. In
    // ascending order, verdicts() has one verdict for each object.
    [[nodiscard]] std::size_t inside_count() const {
        return with_regions_ ? whole_inside_count() : hides_ ? seen_inside_count() : set_.inside_count();
    }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const {
        return with_regions_ ? whole_verdicts() : hides_ ? seen_verdicts() : set_.verdicts();
    }
    // Returns the counts of the query by the view volume. With occlusion, such a query takes place only for
    // OcclusionOptions::list_occluded and for tree order.
    [[nodiscard]] const cull::Statistics& statistics() const {
        return with_regions_ ? whole_statistics() : set_.statistics();
    }
    [[nodiscard]] ObjectRef ref(std::uint32_t id) const { return world::ref(*names_, id); }

    // Tells whether the last view had occlusion. If not, the results of the following calls are empty.
    [[nodiscard]] bool has_occlusion() const { return hides_ && !has_picture(); }
    // Returns the indices of the objects in the view's frustum that are hidden, ascending. Requires
    // OcclusionOptions::list_occluded; else empty.
    [[nodiscard]] std::span<const std::uint32_t> occluded_ids() const;
    // Requires list_occluded. An index in neither list is outside the view or beyond its limits.
    [[nodiscard]] occlude::Verdict verdict_of(std::uint32_t index) const;
    [[nodiscard]] OcclusionStatistics occlusion_statistics() const;
    // Returns the depth buffer with the drawn occluders, or nullptr without occlusion.
    [[nodiscard]] const occlude::OcclusionBuffer* occlusion_buffer() const;

    // After a view with ViewRequest::picture: triangles() lists the triangles to draw, by object index, then by cluster
    // of its mesh (World::clusters_of). ids() lists the objects with such triangles, and the objects without clusters
    // whose boxes may be visible.
    [[nodiscard]] bool has_picture() const;
    [[nodiscard]] std::span<const depth::VisibleCluster> triangles() const;
    // Returns the counts of the picture. Those of what is listed are of triangles(), without objects that have no
    // clusters.
    [[nodiscard]] depth::DepthStatistics picture_statistics() const;

  private:
    friend class World;
    [[nodiscard]] std::span<const std::uint32_t> seen_ids() const;  // not hidden
    [[nodiscard]] std::size_t seen_inside_count() const;
    [[nodiscard]] std::span<const cull::Verdict> seen_verdicts() const;
    [[nodiscard]] std::span<const std::uint32_t> whole_ids() const;  // of a World with regions
    [[nodiscard]] std::size_t whole_inside_count() const;
    [[nodiscard]] std::span<const cull::Verdict> whole_verdicts() const;
    [[nodiscard]] std::span<const std::uint32_t> whole_occluded_ids() const;
    [[nodiscard]] const cull::Statistics& whole_statistics() const;
    [[nodiscard]] OcclusionStatistics whole_occlusion_statistics() const;
    [[nodiscard]] occlude::Verdict region_verdict_of(std::uint32_t index) const;
    cull::VisibleSet set_;
    world::OccludedViewOwner occluded_;
    world::WholeViewOwner whole_;
    ResetOnMove<bool> hides_, with_regions_;
    const world::ObjectNames* names_ = nullptr;
    world::Revision revision_;          // of the World
    Vector<std::uint64_t> candidates_;  // CullOptions::candidate_mask and what has changed since
};

// The result of up to 32 views, with each object once. Keep it from frame to frame.
class MultiViewResult {
  public:
    [[nodiscard]] std::size_t size() const { return ids().size(); }
    // Returns indices: ascending, or roughly in the order of the tree if the requests asked for tree order.
    // Objects of regions come last.
    [[nodiscard]] std::span<const std::uint32_t> ids() const {
        if (with_regions_) return whole_ids();
        return listed_ ? std::span<const std::uint32_t>(ids_.data(), ids_.size()) : set_.ids();
    }
    [[nodiscard]] ObjectRef operator[](std::size_t i) const { return world::ref(*names_, ids()[i]); }
    // Bit v is set if view v sees object ids()[i].
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const {
        if (with_regions_) return whole_mask(i);
        return listed_ ? masks_[ids_[i]] : set_.view_mask(i);
    }

    // How many views the last call asked for, and what the occlusion of one of them drew and asked; zeros for a view
    // without occlusion.
    [[nodiscard]] std::size_t view_count() const { return view_count_; }
    [[nodiscard]] OcclusionStatistics occlusion_statistics(std::size_t view) const;
    // A view's depth buffer, or nullptr for a view without occlusion.
    [[nodiscard]] const occlude::OcclusionBuffer* occlusion_buffer(std::size_t view) const;
    // As ViewResult::occluded_ids, of one view.
    [[nodiscard]] std::span<const std::uint32_t> occluded_ids(std::size_t view) const;
    // As ViewResult::triangles, of one view; empty for a view without a picture.
    [[nodiscard]] std::span<const depth::VisibleCluster> triangles(std::size_t view) const;
    [[nodiscard]] depth::DepthStatistics picture_statistics(std::size_t view) const;

  private:
    friend class World;
    void forget_ids();
    void add(std::uint32_t id, std::uint32_t views);
    void list_ascending();  // ids_ from bits_
    [[nodiscard]] std::span<const std::uint32_t> whole_ids() const;
    [[nodiscard]] std::uint32_t whole_mask(std::size_t i) const;
    cull::MaskedVisibleSet set_;         // of views that are answered in one walk
    Vector<ViewResult> each_;            // of views that are not: at least view_count_
    Vector<std::uint32_t> ids_, masks_;  // masks by object: 0 but for those in ids_
    Vector<std::uint64_t> bits_;         // by object, while ids are put in order
    ResetOnMove<std::size_t> view_count_;
    world::WholeViewsOwner whole_;
    ResetOnMove<bool> one_walk_, listed_, with_regions_;
    const world::ObjectNames* names_ = nullptr;
};

inline constexpr std::uint32_t kNoTriangle = ~std::uint32_t{0};

struct ObjectHit {
    ObjectHandle object;
    std::uint64_t user = 0;
    double t = 0.0;  // along the ray, in lengths of its direction
    glm::dvec3 point{0.0};
    std::uint32_t triangle = kNoTriangle;  // of the object's mesh, or of the shape's surface
    std::uint32_t child = 0;               // which child, if the shape is a compound (convex::PartId)
    glm::dvec3 normal{0.0};       // unit, of the surface, to the side that the ray comes from; 0 if it began inside
    bool started_inside = false;  // the ray began in the shape, box or sphere: t is 0; meshes have no inside
};

struct ClosestObject {
    ObjectHandle object;
    std::uint64_t user = 0;
    double distance = 0.0;
    glm::dvec3 on_shape{0.0}, on_object{0.0};  // a nearest point of each; if they overlap, any common point
    std::uint32_t triangle = kNoTriangle;      // of the object's mesh, or of the shape's surface, at on_object
    std::uint32_t child = 0;                   // which child, if the object's shape is a compound (convex::PartId)
};

struct ObjectPair {
    ObjectRef first, second;  // first.object.index < second.object.index
};

enum class ContactPhase : std::uint8_t { began, stayed, ended };

// Two objects that touch, or that touched in the update before; these have only the two objects, whose handles may be
// stale. A contact goes on if its objects gain or lose shapes. All points are valid until the next update.
//
// Two shapes also touch within WorldOptions::contact_margin. A point keeps its `memory`, which you may write, while its
// id stays the same. A pair of convex shapes keeps the face and points of the last update while they are as good within
// 1e-4 of its size (convex::contact_manifold). So its depth differs by that at most from a new World's, also where
// flush neighbours decide. All else depends on the present objects alone.
struct Contact {
    ObjectRef first, second;  // ordered as in ObjectPair; the first is shape a
    ContactPhase phase = ContactPhase::began;
    mesh::Containment inside = mesh::Containment::none;
    glm::dvec3 normal{0.0};  // unit, from the first to the second; zero if no direction is known
    // The depth of the deepest point; negative: a gap between shapes. With WorldOptions::mesh_depth, between meshes the
    // distance along the normal by which the second must move to end the contact.
    double depth = 0.0;
    // In world coordinates, at most four. None if a mesh is inside another, or for two shapes, which have shape_points.
    // If one object has a shape: those of convex::contact_manifold with the other's box, sphere or mesh; if the shape
    // is inside a closed mesh, none.
    std::span<const collide::ContactPoint> points;
    // Of two meshes, or a mesh and a box; none if one has a shape. The vertices of a mesh under a scale or shear are
    // rounded to float.
    std::span<const mesh::MeshContact> triangles;
    std::span<convex::TrackedPoint> shape_points = {};  // of two shapes
};

// The first object that a moving shape meets.
struct ShapeHit {
    ObjectHandle object;
    std::uint64_t user = 0;
    double time = 0.0;
    glm::dvec3 normal{0.0};                // unit, from the shape to the object
    glm::dvec3 point{0.0};                 // on the object's surface
    std::uint32_t triangle = kNoTriangle;  // of the object's mesh, or of the shape's surface
    bool resolved = true;                  // false: the shape meets nothing up to `time`; later contacts are unknown
    double distance = 0.0;    // the gap at `time`; negative: the depth by which they overlapped at the start
    std::uint32_t child = 0;  // which child, if the object's shape is a compound (convex::PartId)
};

}  // namespace crofton
