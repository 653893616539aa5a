// SPDX-License-Identifier: MIT
// Where bodies of objects touch from update to update.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/scene/scene.hpp>

#include "object_bodies.hpp"
#include "object_table.hpp"
#include "pair_neighbors.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

class BodyContacts {
  public:
    // The object's body, or where it stands, has changed otherwise than by its box.
    void note(std::uint32_t object) { changed_.push_back(object); }
    void forget_changes() { changed_.clear(); }  // where contacts are not asked for

    // False: the pairs do not matter to an update.
    [[nodiscard]] bool has_work(const ObjectBodies& bodies) const { return bodies.count() > 0 || !states_.empty(); }
    // Pairs are computed that are new, or of an object among the index's moved_items(), or with another body, or noted;
    // or where that holds of a neighbour.
    void update(std::span<const ObjectPair> pairs, const ObjectBodies& bodies, const ObjectTable& table,
                const SpatialIndex& index, const scene::Scene& scene, double margin, Executor& executor);
    void stay();  // nothing has changed
    [[nodiscard]] std::span<const BodyContact> contacts() const { return contacts_; }
    [[nodiscard]] std::size_t computed() const { return computed_; }  // pairs, in the last update or stay

  private:
    // A pair that touches, with what it remembers.
    struct PairState {
        ObjectPair pair;
        convex::PairCache cache;
        std::uint64_t neighbors = 0;  // their name
        std::uint32_t first_point = 0, point_count = 0;
    };
    // What one pair has come to: a range of the worker's points.
    struct Touch {
        std::uint32_t pair = 0;           // of the pairs given
        std::uint32_t before = kNoIndex;  // its state in the update before
        std::uint32_t worker = 0, first_point = 0, point_count = 0;
        bool computed = false;
        std::uint64_t neighbors = 0;
        convex::PairCache cache;
    };
    struct Worker {
        convex::Manifolds found;
        Vector<convex::TrackedPoint> points, pair_points;
        Neighbors neighbors;
        Vector<RigidTransform> poses;  // of them
        Vector<convex::BodyAtPose> placed[2];
    };
    void list(std::span<const ObjectPair> pairs, const ObjectBodies& bodies);
    void list_neighbors(std::span<const ObjectPair> pairs, const SpatialIndex& index, double margin);
    [[nodiscard]] bool have_moved(const Neighbors& neighbors) const;
    void place_neighbors(const ObjectBodies& bodies, const ObjectTable& table, const SpatialIndex& index,
                         const scene::Scene& scene, Worker& worker) const;
    void note_moved(const SpatialIndex& index);
    void gather(std::span<const ObjectPair> pairs);
    void add(const ObjectPair& pair, ContactPhase phase, std::uint32_t first_point, std::uint32_t count);

    std::size_t computed_ = 0;
    Vector<std::uint32_t> changed_;  // noted since the last update
    Vector<std::uint8_t> moved_;     // by object, in this update
    PairNeighbors neighbors_;
    Vector<Touch> touches_;
    Vector<Worker> workers_;
    Vector<PairState> states_, next_states_;
    Vector<convex::TrackedPoint> points_, next_points_;
    Vector<BodyContact> contacts_;
};

}  // namespace crofton::world
