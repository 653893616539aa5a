// SPDX-License-Identifier: MIT
// Objects whose shapes are infinite: finds what touches them, in addition to the broadphase.
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/world/answers.hpp>

#include "contact_finder.hpp"

namespace crofton::world {

// The half-spaces of a shape in the world, with unit normals, and a box around all else.
struct GroundShape {
    Vector<Plane> planes;
    Aabb rest;

    void add(const convex::Shape& shape, const RigidTransform& pose);
    // Whether the box is within `margin`, as far as rounding tells: then yes.
    [[nodiscard]] bool is_near(const Obb& box, double margin) const;
    // Around a half-space, as far as an axis bounds it; coordinates are within 1e30.
    static Aabb around(const Plane& plane);
};

// Pairs with ground, contacts of ground with what has no shape, and all of the World's with these among them.
class Ground {
  public:
    struct Touching {
        ObjectPair pair;
        glm::dvec3 normal{0.0};
        double depth = 0.0;
        std::uint32_t first_point = 0, point_count = 0;
        mesh::Containment inside = mesh::Containment::none;
        bool hit = false;
    };

    void start();
    void add(const ObjectPair& pair) { pairs_.push_back(pair); }
    // All pairs in order, with the finder's.
    void merge_pairs(std::span<const ObjectPair> found);
    [[nodiscard]] std::span<const ObjectPair> own_pairs() const { return pairs_; }
    void add_contact(const ObjectPair& pair, const ShapeTouch& touch);
    void merge_contacts(std::span<const Contact> found);
    void stay();

    [[nodiscard]] bool is_used() const { return is_used_; }
    [[nodiscard]] std::span<const ObjectPair> pairs() const { return all_pairs_; }
    [[nodiscard]] std::span<const Contact> contacts() const { return all_contacts_; }
    // Now, or in the update before.
    [[nodiscard]] bool is_or_was_used() const { return is_used_ || was_used_; }
    void set_used(bool used) {
        was_used_ = is_used_;
        is_used_ = used || !touching_.empty() || !before_.empty();
    }

    ShapeTouch shape_touch;  // scratch

  private:
    bool was_used_ = false;
    bool is_used_ = false;  // there is ground, or was in the update before
    Vector<ObjectPair> pairs_, all_pairs_, before_;
    Vector<Touching> touching_;
    Vector<collide::ContactPoint> points_;
    Vector<Contact> all_contacts_;
};

}  // namespace crofton::world
