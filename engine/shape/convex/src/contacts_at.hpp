// SPDX-License-Identifier: MIT
// The contacts in which a cast begins, and what the shape passes while it slides along them.
#pragma once
#include <array>
#include <optional>

#include "closing.hpp"
#include "part_query.hpp"

namespace crofton::convex {

// One of the shapes of a cast.
struct Mover {
    const ShapeAtPose& shape;
    const Motion& motion;
    std::span<const ShapeAtPose> beside;  // shapes that move by the motion's velocity and do not turn
};

// Whether other parts of the two shapes are nearer to each other at the time of a hit than those that hit: by `margin`,
// or along another normal by any amount. A corner that lands beside the edge of a tile is hardly farther from that edge
// than from the tile under it. `farther`: how much farther they may be along another normal.
[[nodiscard]] bool is_nearer_elsewhere(const Mover& a, const Mover& b, const Impact& hit, double margin,
                                       double farther);

// The contacts of two shapes at a time of their cast: of all pairs of parts of the two, and at the start also of either
// with what is beside the other.
//
// Take a contact whose parts do not come together along its normal. Another pair of parts that is no deeper than it
// along that normal at the start never gets deeper either. A plane across the normal stays between its parts, within
// the tolerance. So the shapes slide past it: it is no hit, whatever edge it turns to the mover. This holds for all
// that lies in the plane of a floor, or below it. But a contact that lies behind the plane of another that comes
// together, which in turn is not behind its own, only seems to slide: the edge of a tile that is hardly beside the
// mover turns its normal away from it, while the tile below is about to be met. Likewise, of two contacts at one time
// the one tells where the surface is that has more of them in its plane or behind it.
class ContactsAt {
  public:
    ContactsAt(const Mover& a, const Mover& b, const CastOptions& options, double time);

    [[nodiscard]] double time() const { return time_; }
    [[nodiscard]] bool slides() const { return slides_; }
    // Of contacts at the start: whether two convex parts slide past each other. They stand as at time 0. `flipped`: the
    // first is b's.
    [[nodiscard]] bool passes(const ShapeAtPose& first, const Motion& motion_first, const ShapeAtPose& second,
                              const Motion& motion_second, bool flipped) const;
    // The deepest of the two shapes' contacts over cracks that come together.
    [[nodiscard]] std::optional<Impact> deepest_over_crack() const;
    // For a hit at this time: the deepest of the two shapes' contacts that come together and that no other contact
    // tells better. Normals are within an angle of the hit's, told by its cosine. If contacts of shapes beside them
    // tell all of them better: the deepest of those that come together, else nothing.
    [[nodiscard]] std::optional<Impact> deepest(const Impact& hit, double least_cosine);

  private:
    struct Contact {
        Part a, b;
        Motion motion_a, motion_b;
        Impact impact;
        bool own;  // of the two shapes
        bool slides = false;
        bool over_crack = false;
        bool is_covered = false;  // slides behind a contact that comes together
        std::size_t behind = 0;   // contacts in its plane or behind it
    };
    static constexpr std::size_t kMost = 16;  // with different normals
    // Of this time, with its points in the world.
    [[nodiscard]] Impact in_world(Impact impact) const;
    using MovingPairVisitor =
        FunctionRef<void(const Part& a, const Motion& motion_a, const Part& b, const Motion& motion_b)>;

    void visit_all_pairs(FunctionRef<void(bool own)> begin, MovingPairVisitor visit) const;
    [[nodiscard]] std::optional<Impact> touch(const Part& a, const Part& b) const;
    void add(const Contact& contact);
    [[nodiscard]] bool slides_past(const Contact& contact) const;
    void close_cracks();
    [[nodiscard]] bool is_free_face(const glm::dvec3& face) const;
    void find_covered();
    void count_behind();
    [[nodiscard]] bool is_behind(const ShapeAtPose& a, const ShapeAtPose& b, const Contact& contact,
                                 double closing) const;
    [[nodiscard]] bool is_left_out(const Contact& contact) const;
    [[nodiscard]] bool is_flush_with(const ShapeAtPose& a, const ShapeAtPose& b, const Contact& contact) const;
    [[nodiscard]] bool is_covered_by(const Contact& contact, const Contact& by) const;
    [[nodiscard]] bool is_told_by(const Contact& contact, const Contact& by) const;

    Flight flight_;
    const double time_;
    const RigidTransform pose_a_, pose_b_;
    const ShapeAtPose placed_a_, placed_b_;
    const Mover a_, b_;
    const CastOptions& options_;
    // Room for contacts, of which the first `count_` are there: setting all of it to nothing takes longer than a cast.
    union Room {
        Room() {}
        Contact contact;
    };
    static_assert(std::is_trivially_destructible_v<Contact>);
    [[nodiscard]] Contact& at(std::size_t i) { return contacts_[i].contact; }
    [[nodiscard]] const Contact& at(std::size_t i) const { return contacts_[i].contact; }
    std::array<Room, kMost> contacts_;
    std::size_t count_ = 0;
    bool slides_ = false;
};

// Of a part of a shape, about the shape's pivot.
[[nodiscard]] Motion motion_of_part(const ShapeAtPose& whole, const Motion& motion, const RigidTransform& part);
// Whether b meets the back of a triangle: both where they are at the impact's time.
[[nodiscard]] bool comes_from_behind(const ShapeAtPose& triangle, const ShapeAtPose& b, const Impact& impact);

}  // namespace crofton::convex
