// SPDX-License-Identifier: MIT
// Finds the objects that touch, and where: first all pairs of boxes, then the shapes of each pair.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/sorted_edits.hpp>
#include <crofton/world/world.hpp>

#include "block_pool.hpp"
#include "object_shapes.hpp"
#include "object_table.hpp"
#include "pair_order.hpp"
#include "shapes.hpp"
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

// How two objects touch of which one has a shape: the shape, and the other's box, sphere or mesh.
struct ShapeTouch {
    convex::Manifolds found;                             // keeps its memory
    const convex::Manifold* deepest = nullptr;           // of these; nullptr: none
    mesh::Containment inside = mesh::Containment::none;  // without a manifold: the shape is inside the mesh

    [[nodiscard]] bool hit() const { return deepest != nullptr || inside != mesh::Containment::none; }
    // Sets these of a Touch or the like, and adds its points.
    template <class T>
    void write_to(T& touch, Vector<collide::ContactPoint>& points) const {
        touch.hit = hit();
        touch.inside = inside;
        if (deepest == nullptr) return;
        touch.normal = deepest->normal;
        touch.depth = deepest->depth;
        for (int i = 0; i < deepest->count; ++i)
            points.push_back({deepest->points[i].position, deepest->points[i].depth});
    }
};

// What the shapes of a pair gave, of which the second stands in no table.
struct BoundTouch {
    bool hit = false;
    mesh::Containment inside = mesh::Containment::none;
    glm::dvec3 normal{0.0};  // from the first to the second
    double depth = 0.0;
    Vector<collide::ContactPoint> points;
    Vector<mesh::MeshContact> triangles;

    void clear() {
        hit = false;
        inside = mesh::Containment::none;
        normal = glm::dvec3(0.0);
        depth = 0.0;
        points.clear();
        triangles.clear();
    }
};

// What may change pairs and contacts beside the items that the spatial index tells of. Since the update before.
struct PairChanges {
    Vector<std::uint32_t> objects;  // whose kind, radius, mesh, shape, user data or layers to collide with have changed
    bool renamed = false;           // some have other user data
    bool after_error = false;       // the update before found too many pairs

    [[nodiscard]] bool any() const { return !objects.empty() || after_error; }
    void clear() {
        objects.clear();
        renamed = after_error = false;
    }
};

// An object with its box, which is also around its sphere.
struct Bounded {
    const Object& object;
    const Obb& box;
    bool has_shape;
};

class ContactFinder {
  public:
    explicit ContactFinder(const WorldOptions& options);

    using ShapeToucher = FunctionRef<void(const IdPair& pair, ShapeTouch& touch)>;
    // After the updates of these. Looks at the index's moved_items() and member_items() and at what `changes` tells of;
    // other pairs and contacts stay as they are. Asks `touch_shape` for pairs of which one has a shape; pairs of two
    // shapes are left to ShapeContacts. Error: as Broadphase::update.
    Result<void> update(const ObjectTable& table, SpatialIndex& index, const scene::Scene& scene, Shapes& shapes,
                        const ObjectShapes& shapes_of, const PairChanges& changes, ShapeToucher touch_shape,
                        Executor& executor);
    // Takes memory for so many objects.
    void reserve(std::size_t objects);
    // Nothing has changed since the update before.
    void stay();
    // After an update: gives back what looking at many pairs has taken. touched() is empty then.
    void release_scratch();

    [[nodiscard]] std::span<const ObjectPair> pairs() const { return pairs_.get(); }  // any thread may ask
    [[nodiscard]] std::size_t pair_count() const { return broadphase_.statistics().box_pairs; }
    [[nodiscard]] std::size_t tested_count() const { return touches_.size(); }  // pairs whose shapes were looked at
    [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
    // Of the last update(), where contacts are asked for: pairs that were looked at, and those that ended; in order.
    [[nodiscard]] std::span<const IdPair> touched() const { return touched_; }
    [[nodiscard]] std::span<const IdPair> ended() const { return broadphase_.ended(); }
    // Objects whose pairs the last update() has found again; they may be named more than once.
    [[nodiscard]] std::span<const std::uint32_t> moved() const { return moved_; }

    // Whether two objects are a pair whose boxes are, wider by the contact margin around shapes.
    [[nodiscard]] bool meet(const Bounded& a, const Bounded& b) const;
    // How the bounds of a pair touch, or its triangles: a tree is that of a mesh or a box, and of a sphere only its
    // pose is read.
    void touch_bounds(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b, BoundTouch& touch) const;
    void touch_trees(const Object& a, const PosedTree& tree_a, const Object& b, const PosedTree& tree_b,
                     BoundTouch& touch);

    [[nodiscard]] const collide::BroadphaseStatistics& broadphase() const { return broadphase_.statistics(); }

  private:
    struct Worker {
        Vector<collide::ContactPoint> points;
        Vector<mesh::MeshContact> triangles, found;
        ShapeTouch of_shape;
    };
    struct IsBefore {
        bool operator()(const ObjectPair& a, const ObjectPair& b) const { return is_before(a, b); }
    };
    // What a contact's spans show.
    struct ContactMemory {
        std::span<collide::ContactPoint> points;
        std::span<mesh::MeshContact> triangles;
    };

    void note_colliders(const ObjectTable& table, SpatialIndex& index, const scene::Scene& scene,
                        const ObjectShapes& shapes_of, const PairChanges& changes);
    void note_box(ItemId item, const Obb* box, SpatialIndex& index);
    void take_own_boxes(const SpatialIndex& index);
    void note_pairs(const ObjectTable& table, const PairChanges& changes);
    void find_contacts(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene, Shapes& shapes,
                       const ObjectShapes& shapes_of, ShapeToucher touch_shape, Executor& executor);
    void touch_bounds(const ObjectTable& table, const SpatialIndex& index, const IdPair& pair, Worker& worker,
                      Touch& touch) const;
    void touch_trees(const Object& a, const PosedTree& tree_a, const Object& b, const PosedTree& tree_b, Worker& worker,
                     Touch& touch) const;
    void touch_triangles(const PosedTree& a, const PosedTree& b, Worker& worker, Touch& touch) const;
    void touch_sphere(const PosedTree& mesh, const PosedTree& center, double radius, Worker& worker,
                      Touch& touch) const;
    void age_contacts();
    void replace_contacts(const ObjectTable& table, std::span<const IdPair> apart);
    void write_contact(const ObjectTable& table, const IdPair& pair, const Touch& touch, ContactPhase phase,
                       std::size_t place);
    void end_contact(std::size_t place);
    void give_back(ContactMemory& memory);

    WorldOptions options_;
    collide::Broadphase broadphase_;  // its items are the objects; those that are no colliders have no valid box
    // The broadphase's boxes, once a shape needs a wider box than the index's, or many objects have been looked at of
    // which one collides with nothing. Until then the broadphase reads SpatialIndex::kept_boxes(), which saves memory
    // and copying: what collides with nothing is kept by its filter from being in a pair.
    GrowingVector<Obb> boxes_;
    bool has_own_boxes_ = false, has_idle_ = false;  // the second: boxes of objects that collide with nothing
    GrowingVector<collide::CollisionFilter> filters_;
    Vector<std::uint32_t> moved_;
    LazySortedList<ObjectPair, IsBefore> pairs_;
    Vector<ObjectPair> began_pairs_, ended_pairs_;
    Vector<IdPair> touched_;  // pairs whose shapes are looked at in this update, in order
    Vector<Touch> touches_;   // of these
    Vector<Worker> workers_;
    Worker bound_worker_;           // of touch_trees()
    Vector<Contact> contacts_;      // in order
    Vector<ContactMemory> memory_;  // of each
    Vector<IdPair> began_, ended_;  // contacts that have in the last update
    Vector<IdPair> ended_before_;   // scratch
    Vector<std::uint32_t> added_;   // scratch: contacts that are new, by their touches
    ListEdits edits_;
    BlockPool<collide::ContactPoint> points_;
    BlockPool<mesh::MeshContact> triangles_;
};

}  // namespace crofton::world
