// SPDX-License-Identifier: MIT
// Answers of a World: results of views, hits, pairs, contacts.
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
// By an object's index.
struct ObjectNames {
    Vector<std::uint32_t> generations;
    Vector<std::uint64_t> users;
};

struct OccludedView;  // a view's depth buffer, and what was found with it
struct OccludedViewDeleter {
    void operator()(OccludedView* view) const;
};
using OccludedViewOwner = Owner<OccludedView, OccludedViewDeleter>;
}  // namespace world

struct ObjectRef {
    ObjectHandle object;
    std::uint64_t user = 0;
};

// An occluder: the object that has it, and its place among those of the object's mesh (World::occluders_of).
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

// The result of one view. Keep it from frame to frame, and it allocates nothing once it is large enough.
//
// Objects are looked up when you ask for them: ask before the World's next change, and while it lives. ids() and counts
// stay.
class ViewResult {
  public:
    [[nodiscard]] std::size_t size() const { return ids().size(); }
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return hides_ ? seen_ids() : set_.ids(); }  // indices
    [[nodiscard]] ObjectRef operator[](std::size_t i) const { return ref(ids()[i]); }
    // In CullOptions' tree order the first so many are inside the view, the others straddle its boundary; in ascending
    // order verdicts() says it of each.
    [[nodiscard]] std::size_t inside_count() const { return hides_ ? seen_inside_count() : set_.inside_count(); }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return hides_ ? seen_verdicts() : set_.verdicts(); }
    // Counts the query by the view volume. With occlusion there is one only for OcclusionOptions::list_occluded and for
    // tree order.
    [[nodiscard]] const cull::Statistics& statistics() const { return set_.statistics(); }
    [[nodiscard]] ObjectRef ref(std::uint32_t id) const { return {{id, names_->generations[id]}, names_->users[id]}; }

    // Whether the last view was with occlusion. If not, the calls below return nothing.
    [[nodiscard]] bool has_occlusion() const { return hides_ && !has_picture(); }
    // Indices, ascending: in the view's frustum, and hidden. Empty unless OcclusionOptions::list_occluded.
    [[nodiscard]] std::span<const std::uint32_t> occluded_ids() const;
    // With list_occluded; an index that is in neither list is outside, or not worth drawing.
    [[nodiscard]] occlude::Verdict verdict_of(std::uint32_t index) const;
    [[nodiscard]] OcclusionStatistics occlusion_statistics() const;
    // The depth buffer as it was drawn, or nullptr.
    [[nodiscard]] const occlude::OcclusionBuffer* occlusion_buffer() const;

    // Of the last view with ViewRequest::picture: the triangles to draw, by object index, then by cluster of its mesh
    // (World::clusters_of). ids() are the objects that have some, and those without clusters whose boxes may be seen.
    [[nodiscard]] bool has_picture() const;
    [[nodiscard]] std::span<const depth::VisibleCluster> triangles() const;
    [[nodiscard]] depth::DepthStatistics picture_statistics() const;

  private:
    friend class World;
    [[nodiscard]] std::span<const std::uint32_t> seen_ids() const;  // not hidden
    [[nodiscard]] std::size_t seen_inside_count() const;
    [[nodiscard]] std::span<const cull::Verdict> seen_verdicts() const;
    cull::VisibleSet set_;
    world::OccludedViewOwner occluded_;
    ResetOnMove<bool> hides_;
    const world::ObjectNames* names_ = nullptr;
    Vector<std::uint64_t> candidates_;  // CullOptions::candidate_mask and what has changed since
};

// The result of up to 32 views, each object once. Keep it from frame to frame.
class MultiViewResult {
  public:
    [[nodiscard]] std::size_t size() const { return ids().size(); }
    // Indices: ascending, or by and large along the tree if the requests asked for tree order.
    [[nodiscard]] std::span<const std::uint32_t> ids() const {
        return listed_ ? std::span<const std::uint32_t>(ids_.data(), ids_.size()) : set_.ids();
    }
    [[nodiscard]] ObjectRef operator[](std::size_t i) const {
        const std::uint32_t id = ids()[i];
        return {{id, names_->generations[id]}, names_->users[id]};
    }
    // Bit v: view v sees it.
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const { return listed_ ? masks_[ids_[i]] : set_.view_mask(i); }

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
    void list_ascending();               // ids_ from bits_
    cull::MaskedVisibleSet set_;         // of views that are answered in one walk
    Vector<ViewResult> each_;            // of views that are not: at least view_count_
    Vector<std::uint32_t> ids_, masks_;  // masks by object: 0 but for those in ids_
    Vector<std::uint64_t> bits_;         // by object, while ids are put in order
    ResetOnMove<std::size_t> view_count_;
    ResetOnMove<bool> one_walk_, listed_;
    const world::ObjectNames* names_ = nullptr;
};

inline constexpr std::uint32_t kNoTriangle = ~std::uint32_t{0};

struct ObjectHit {
    ObjectHandle object;
    std::uint64_t user = 0;
    double t = 0.0;  // the ray's
    glm::dvec3 point{0.0};
    std::uint32_t triangle = kNoTriangle;  // of the object's mesh, or of the body's surface
    std::uint32_t child = 0;               // of a body that is a compound: which (convex::PartId)
    glm::dvec3 normal{0.0};       // unit, of the surface, to the side that the ray comes from; 0 if it began inside
    bool started_inside = false;  // the ray began in the body, box or sphere: t is 0; meshes have no inside
};

struct ClosestObject {
    ObjectHandle object;
    std::uint64_t user = 0;
    double distance = 0.0;
    glm::dvec3 on_shape{0.0}, on_object{0.0};  // a nearest point of each; any where they meet
};

struct ObjectPair {
    ObjectRef first, second;  // first.object.index < second.object.index
};

enum class ContactPhase : std::uint8_t { began, stayed, ended };

// Two objects that touch, or that did in the update before. Ended contacts carry only the two object handles, which are
// stale if the objects have been removed.
struct Contact {
    ObjectRef first, second;  // ordered as in ObjectPair
    ContactPhase phase = ContactPhase::began;
    mesh::Containment inside = mesh::Containment::none;
    glm::dvec3 normal{0.0};  // unit, from the first to the second; zero where no direction is known
    // Moving the second so far along the normal ends the contact. Between meshes that is so with
    // WorldOptions::mesh_depth; without, it is the depth of the deepest point.
    double depth = 0.0;
    std::span<const collide::ContactPoint> points;  // in the world's frame; at most four; none of a mesh inside another
    std::span<const mesh::MeshContact> triangles;   // of two meshes, or a mesh and a box
};

// Two objects with bodies that touch, or come within WorldOptions::contact_margin, or did in the update before. Ended
// contacts have no points. Points keep their memory, which is the caller's to write, while their ids stay
// (crofton/convex/query.hpp); valid until the next update.
struct BodyContact {
    ObjectRef first, second;  // ordered as in ObjectPair; the first is body a
    ContactPhase phase = ContactPhase::began;
    convex::TrackedPoint* points = nullptr;
    std::uint32_t point_count = 0;
    std::uint32_t unused = 0;  // the same size as in C where numbers of 8 bytes are aligned to 4
};

// An object that a moving body meets, at that time.
struct BodyHit {
    ObjectHandle object;
    std::uint64_t user = 0;
    double time = 0.0;
    glm::dvec3 normal{0.0};      // unit, from the body to the object
    glm::dvec3 point{0.0};       // on the object's surface
    std::uint32_t triangle = 0;  // of a surface
    bool resolved = true;        // false: up to `time` nothing is met; what comes later is not known
    double distance = 0.0;       // gap at that time; negative: how deep they overlap, from the start
};

}  // namespace crofton
