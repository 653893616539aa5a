// SPDX-License-Identifier: MIT
// Which objects meet, and where: all pairs of boxes, then each pair's own shapes.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/world/world.hpp>

#include "bodies.hpp"
#include "object_bodies.hpp"
#include "object_table.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

// What one pair's shapes gave; ranges of the worker's lists.
struct Touch {
    bool hit = false;
    mesh::Containment inside = mesh::Containment::none;
    glm::dvec3 normal{0.0};
    double depth = 0.0;
    std::uint32_t worker = 0;
    std::uint32_t first_point = 0, point_count = 0;
    std::uint32_t first_triangle = 0, triangle_count = 0;
};

class ContactFinder {
  public:
    explicit ContactFinder(const WorldOptions& options);

    // After the updates of these. `moved_only`: since the update before no more has changed than the boxes of the
    // index's moved_items(). Pairs of two bodies are left to `bodies_of`. Error: as Broadphase::update.
    Result<void> update(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene, Bodies& bodies,
                        const ObjectBodies& bodies_of, bool moved_only, Executor& executor);
    // Nothing has changed since the update before.
    void stay();

    [[nodiscard]] std::span<const ObjectPair> pairs() const { return pairs_; }
    [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
    [[nodiscard]] const collide::BroadphaseStatistics& broadphase() const { return broadphase_.statistics(); }

  private:
    struct Worker {
        Vector<collide::ContactPoint> points;
        Vector<mesh::MeshContact> triangles, found;
    };
    void list_colliders(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                        const ObjectBodies& bodies_of);
    void move_colliders(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                        const ObjectBodies& bodies_of);
    void list_pairs(const ObjectTable& table, const SpatialIndex& index, const ObjectBodies& bodies_of);
    void find_contacts(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene, Bodies& bodies,
                       const ObjectBodies& bodies_of, Executor& executor);
    void touch_bounds(const ObjectTable& table, const SpatialIndex& index, const ObjectPair& pair, Worker& worker,
                      Touch& touch) const;
    void touch_triangles(const PosedTree& a, const PosedTree& b, Worker& worker, Touch& touch) const;
    void touch_ball(const PosedTree& mesh, const PosedTree& center, double radius, Worker& worker, Touch& touch) const;
    void gather();
    void add_contact(const ObjectPair& pair, const Touch& touch, ContactPhase phase);

    WorldOptions options_;
    collide::Broadphase broadphase_;
    Vector<std::uint32_t> colliders_;    // ascending
    Vector<std::uint32_t> collider_of_;  // by object; kNoIndex: it is none
    Vector<std::uint32_t> moved_;        // colliders
    Vector<Obb> boxes_;                  // of them
    Vector<collide::CollisionFilter> filters_;
    Vector<ObjectPair> pairs_;
    Vector<Worker> workers_;
    Vector<Touch> touches_;      // by pair
    Vector<ObjectPair> before_;  // that touched in the update before
    Vector<Contact> contacts_;
    // What the contacts' spans show.
    Vector<collide::ContactPoint> points_;
    Vector<mesh::MeshContact> triangles_;
};

}  // namespace crofton::world
