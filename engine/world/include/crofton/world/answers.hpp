// SPDX-License-Identifier: MIT
// What a World answers.
#pragma once
#include <crofton/collide/convex_query.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/world/inputs.hpp>
#include <cstdint>
#include <span>

namespace crofton {

namespace world {
// By an object's index.
struct ObjectNames {
    Vector<std::uint32_t> generations;
    Vector<std::uint64_t> users;
};
}  // namespace world

struct ObjectRef {
    ObjectHandle object;
    std::uint64_t user = 0;
};

// What one view sees, in memory that is kept from frame to frame. Objects are looked up when asked for: ask before the
// next change of the World, and while it lives. ids() and counts stay.
class VisibleObjects {
  public:
    [[nodiscard]] std::size_t size() const { return set_.size(); }
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return set_.ids(); }  // the objects' indices
    [[nodiscard]] ObjectRef operator[](std::size_t i) const {
        const std::uint32_t id = ids()[i];
        return {{id, names_->generations[id]}, names_->users[id]};
    }
    // In CullOptions' tree order the first so many are inside the view, the others straddle its boundary; in ascending
    // order verdicts() says it of each.
    [[nodiscard]] std::size_t inside_count() const { return set_.inside_count(); }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return set_.verdicts(); }
    [[nodiscard]] const cull::Statistics& statistics() const { return set_.statistics(); }

  private:
    friend class World;
    cull::VisibleSet set_;
    const world::ObjectNames* names_ = nullptr;
};

// What up to 32 views see, each object once.
class VisibleInViews {
  public:
    [[nodiscard]] std::size_t size() const { return set_.size(); }
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return set_.ids(); }
    [[nodiscard]] ObjectRef operator[](std::size_t i) const {
        const std::uint32_t id = ids()[i];
        return {{id, names_->generations[id]}, names_->users[id]};
    }
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const { return set_.view_mask(i); }  // bit v: view v sees it

  private:
    friend class World;
    cull::ManyVisible set_;
    const world::ObjectNames* names_ = nullptr;
};

inline constexpr std::uint32_t kNoTriangle = ~std::uint32_t{0};

struct ObjectHit {
    ObjectHandle object;
    std::uint64_t user = 0;
    double t = 0.0;  // the ray's
    glm::dvec3 point{0.0};
    std::uint32_t triangle = kNoTriangle;  // of the object's mesh
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

// Two objects that touch, or that did in the update before. What ended has no more than its objects, whose handles are
// stale where they have been removed.
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

}  // namespace crofton
