// SPDX-License-Identifier: MIT
// Contacts between shapes, kept from update to update.
#pragma once
#include <crofton/convex/push_out_of_union.hpp>
#include <crofton/core/sorted_edits.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/scene/scene.hpp>

#include "block_pool.hpp"
#include "object_shapes.hpp"
#include "object_table.hpp"
#include "pair_neighbors.hpp"
#include "regions.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

class ShapeContacts {
  public:
    // Pairs since the update before, in order: those that are there and new, or of an object that has moved or changed,
    // and maybe others; and those that are there no more.
    struct ChangedPairs {
        std::span<const IdPair> there, ended;
    };

    // What an update looks things up in.
    struct Surroundings {
        const ObjectShapes& shapes;
        const ObjectTable& table;
        const SpatialIndex& index;
        const scene::Scene& scene;
        const Regions& regions;
        double margin;

        // Objects of the World's own and of regions.
        [[nodiscard]] bool has_shape(std::uint32_t object) const {
            return is_region_index(object) ? regions.has_shape(object) : shapes.has(object);
        }
        [[nodiscard]] const convex::Shape& shape(std::uint32_t object) const {
            return is_region_index(object) ? regions.shape(object) : shapes.shape(object);
        }
        [[nodiscard]] Obb box(std::uint32_t object) const {
            return is_region_index(object) ? regions.box(object) : index.box(object);
        }
        [[nodiscard]] std::optional<RigidTransform> pose(std::uint32_t object) const {
            if (is_region_index(object)) return regions.pose(object);
            return shapes.pose_of(object, table.objects[object], index.box(object), scene);
        }
    };

    // The object's shape, or where it stands, has changed otherwise than by its box.
    void note(std::uint32_t object) { changed_.push_back(object); }
    void forget_changes() { changed_.clear(); }  // where contacts are not asked for
    // After an update: gives back what many changes have taken.
    void release_scratch();

    // False: the pairs do not matter to an update. Regions' objects are in pairs with the World's own alone.
    [[nodiscard]] bool has_work(const ObjectShapes& shapes) const { return shapes.count() > 0 || !states_.empty(); }
    // Pairs are computed that are new, or of an object among the index's moved_items(), or with another shape, or
    // noted; or where a neighbour matters for which that holds. The cost follows these, however many others rest.
    void update(const ChangedPairs& pairs, const Surroundings& around, Executor& executor);
    // The same, of all pairs.
    void update_all(std::span<const ObjectPair> pairs, const Surroundings& around, Executor& executor);
    void stay();  // nothing has changed
    [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
    [[nodiscard]] std::size_t computed() const { return computed_; }  // pairs, in the last update or stay

  private:
    // A pair whose boxes meet, with what it remembers.
    struct PairState {
        ObjectPair pair;
        convex::PairCache cache;
        std::uint64_t neighbors = 0;  // their name
        bool asks_neighbors = false;  // else they do not matter
        bool is_new = true;
        std::uint32_t point_count = 0;
        std::span<convex::TrackedPoint> points;  // with room for more
    };
    // What one pair has come to: a range of the worker's points.
    struct Touch {
        std::uint32_t state = 0;
        std::uint32_t worker = 0, first_point = 0, point_count = 0;
        bool computed = false, asks_neighbors = false;
        std::uint64_t neighbors = 0;
        convex::PairCache cache;
    };
    struct Worker {
        convex::Manifolds found;
        Vector<convex::TrackedPoint> points, pair_points;
        Neighbors neighbors;
        Vector<convex::ShapeAtPose> placed[2];
        Vector<std::uint32_t> numbers[2];  // of these
        convex::PairMemory memory;         // of objects, in this update
    };
    void note_moved(const Surroundings& around);
    void note_pairs(const ChangedPairs& pairs, const Surroundings& around);
    void place_object(std::uint32_t object, const Surroundings& around);
    void rename(PairState& state, const ObjectPair& pair);
    void drop(const PairState& state);
    void list_candidates();
    [[nodiscard]] bool has_moved(std::uint32_t object) const {  // regions' objects never do
        return object < moved_.size() && moved_[object] != 0;
    }
    [[nodiscard]] bool have_moved(const Neighbors& neighbors) const;
    void place_neighbors(const Surroundings& around, Worker& worker) const;
    void compute(Touch& touch, const Surroundings& around, Worker& worker) const;
    void touch(Touch& touch, const Surroundings& around, Worker& worker) const;
    void age();
    void write_contacts();
    void write(PairState& state, const Touch& touch);
    static void show(const PairState& state, Contact& contact);

    std::size_t computed_ = 0;
    Vector<std::uint32_t> changed_;  // noted since the last update
    Vector<std::uint8_t> moved_;     // by object, in this update
    Vector<std::uint32_t> movers_;   // of these
    PairNeighbors neighbors_;
    Vector<PairState> states_;      // in order
    Vector<Contact> contacts_;      // in order
    Vector<IdPair> began_, ended_;  // contacts that have in the last update
    Vector<IdPair> fresh_;          // pairs whose points were computed in the last update
    BlockPool<convex::TrackedPoint> points_;
    // Scratch of an update.
    Vector<ObjectPair> came_;
    Vector<PairNeighbors::Pair> joined_, parted_;
    Vector<IdPair> dropped_;  // pairs that touched and are there no more
    Vector<IdPair> candidates_, ended_before_, all_, gone_;
    Vector<Touch> touches_;
    Vector<std::uint32_t> added_;  // contacts that are new, by their touches
    Vector<Worker> workers_;
    ListEdits edits_;
};

}  // namespace crofton::world
