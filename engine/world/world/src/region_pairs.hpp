// SPDX-License-Identifier: MIT
// Pairs and contacts of the World's own objects with objects of regions.
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/world/answers.hpp>
#include <span>

#include "contact_finder.hpp"
#include "regions.hpp"

namespace crofton::world {

// The World's own object is the first of each pair, since its index is lower.
class RegionPairs {
  public:
    // Pairs in order: those of objects that have not changed are kept, others are found again.
    void begin();
    void keep(const ObjectPair& old);
    void add(const ObjectPair& pair, const BoundTouch& touch);
    void end(bool finds_contacts);

    struct Entry {
        ObjectPair pair;
        bool hit = false;
        mesh::Containment inside = mesh::Containment::none;
        glm::dvec3 normal{0.0};
        double depth = 0.0;
        std::size_t first_point = 0, point_count = 0, first_triangle = 0, triangle_count = 0;
    };
    [[nodiscard]] std::span<const Entry> entries() const { return entries_; }  // as of the last end()
    // Of the last end(), in order: pairs that were added, and those that are there no more.
    [[nodiscard]] std::span<const IdPair> added() const { return added_; }
    [[nodiscard]] std::span<const IdPair> ended() const { return ended_; }
    [[nodiscard]] std::size_t added_count() const { return next_.size(); }  // since begin()

    void forget_changes() {  // added() and ended() are empty then
        added_.clear();
        ended_.clear();
    }
    void stay();  // nothing has changed
    // With all others of the World.
    void merge(std::span<const ObjectPair> pairs, std::span<const Contact> contacts);

    // Returns the triangles of a region's object that is a box, or a mesh under a map that is no rotation, under a map;
    // nullptr: none is valid under it. The tree is built once and kept while updates ask for it.
    [[nodiscard]] const mesh::MeshTree* tree_under(ObjectHandle object, const glm::dmat3& linear,
                                                   FunctionRef<TriangleMesh()> triangles);
    // Once an update: frees what belongs to objects whose regions are gone, and what was not asked for in a while.
    void forget_trees(const Regions& regions);
    [[nodiscard]] bool is_used() const { return !entries_.empty() || !contacts_.empty(); }
    [[nodiscard]] std::span<const ObjectPair> pairs() const { return all_pairs_; }
    [[nodiscard]] std::span<const Contact> contacts() const { return all_contacts_; }

    Vector<std::uint32_t> changed;        // scratch: own objects whose pairs are found again
    BoundTouch touch;                     // scratch
    ShapeTouch shape_touch;               // scratch
    Vector<IdPair> all_added, all_ended;  // scratch: of the World's own as well
    bool lost = false;                    // the update before found too many pairs

  private:
    struct OwnTree {
        ObjectHandle object;
        Owner<mesh::MeshTree> tree;
        std::uint64_t last_use = 0;  // an update
    };
    [[nodiscard]] Contact contact_of(const Entry& entry, ContactPhase phase) const;
    void list_ended();

    Vector<Entry> entries_, next_;
    Vector<collide::ContactPoint> points_, next_points_;  // of the entries
    Vector<mesh::MeshContact> triangles_, next_triangles_;
    Vector<IdPair> added_, ended_;
    Vector<Contact> contacts_;  // of these pairs
    Vector<ObjectPair> all_pairs_;
    Vector<Contact> all_contacts_;
    Vector<OwnTree> trees_;  // in order
    std::uint64_t updates_ = 0;
    std::size_t kept_ = 0;  // entries before it have been looked at since begin()
};

}  // namespace crofton::world
