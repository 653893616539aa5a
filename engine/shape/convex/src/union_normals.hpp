// SPDX-License-Identifier: MIT
// Contacts of shapes whose convex parts are flush or overlap: gives them the normals of the union.
#pragma once
#include <crofton/convex/push_out_of_union.hpp>
#include <crofton/core/executor.hpp>

#include "gather.hpp"

namespace crofton::convex {

// Faces of two shapes count as flush that are within this of each other: rounding of their sizes to float.
[[nodiscard]] double flush_tolerance(const ShapeAtPose& a, const ShapeAtPose& b);

// Of flat faces. A triangle has two.
[[nodiscard]] int face_count(const Shape& shape);
// Outward; 0 of a triangle without area.
[[nodiscard]] glm::dvec3 face_normal(const ShapeAtPose& placed, int face);

// Two lists of convex parts, and where parts of the first touch parts of the second. The least deep way out of one part
// may lead into its neighbour. So a contact whose points the neighbours cover is none of the union's: its pair of parts
// pushes along the normal of another contact that parts them as well, else along the face that is least deep and free.
// A neighbour covers a point that it holds, up to rounding to float, if it rises above it along the normal. A contact
// that is covered in part, as that of a wall with its foot on the floor, stays unless another contact parts the pair.
// Where none is found it stays, too.
class UnionNormals {
  public:
    struct Contact {
        std::uint32_t part[2];  // of either list
        glm::dvec3 normal;      // from the first list's to the second's
        double depth;
        int count;
        ContactPoint points[8];
    };

    void start(double margin);
    // Returns its number in its list. Parts that touch nothing count as neighbours.
    std::uint32_t add_part(int list, const Part& part);
    void add_contact(std::uint32_t first, std::uint32_t second, const Manifold& manifold);
    // Whether a neighbour covers any contact, in part at least.
    [[nodiscard]] bool is_any_covered() const;
    // Of one contact of two parts, each the first of its list, and parts beside them of which only those count that
    // `counts` names: whether apply() surely leaves the contact as it is. `touch` tells the contact of two parts.
    using PartTest = FunctionRef<bool(int list, std::uint32_t part)>;
    using PairTouch = FunctionRef<PairContact(std::uint32_t first, std::uint32_t second)>;
    [[nodiscard]] bool is_first_left(PartTest counts, PairTouch touch);
    // Each of the first `told` contacts keeps a point, as a pair that meets has one.
    void apply(std::size_t told = 0);
    void keep_parts(int list, std::uint32_t count) {
        parts_[list].erase(parts_[list].begin() + count, parts_[list].end());
        to_local_[list].resize(count);
    }
    [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
    [[nodiscard]] const Part& part(int list, std::uint32_t number) const { return parts_[list][number]; }

  private:
    enum class State : std::uint8_t { free, partly_covered, covered, replaced };
    struct Samples;
    [[nodiscard]] Samples samples_of(const Contact& contact, int list) const;
    [[nodiscard]] ShapeAtPose placed(int list, std::uint32_t number) const {
        return {parts_[list][number].shape, parts_[list][number].pose};
    }
    [[nodiscard]] bool is_of_half_space(const Contact& contact) const;
    [[nodiscard]] State state_of(const Contact& contact) const;
    [[nodiscard]] State state_on(int list, const Contact& contact) const;
    [[nodiscard]] static bool is_sharp_box(const Shape& shape) {
        return shape.kind() == Kind::box && shape.radius() == 0.0;
    }
    // A part beside another of its list.
    struct Neighbor {
        std::uint32_t number;
        ShapeAtPose shape;
        double tolerance;            // within which the two count as flush
        double reach;                // of the neighbor, wider by that
        const glm::dmat3& to_local;  // of a box without rounding
        [[nodiscard]] bool is_box() const { return is_sharp_box(shape.shape); }
        // Whether it may hold a point that is no farther than `radius` from `point`.
        [[nodiscard]] bool is_near(const glm::dvec3& point, double radius) const;
        [[nodiscard]] bool holds(const glm::dvec3& point) const;
        // Whether all points of a polygon are surely farther away than what counts as flush; of a box.
        [[nodiscard]] bool is_beside(const Samples& polygon) const;
        [[nodiscard]] bool covers(const glm::dvec3& point, const glm::dvec3& direction) const;
        // Whether it covers any point of a contact.
        [[nodiscard]] bool covers_any(const Samples& samples, const glm::dvec3& direction) const;
    };
    [[nodiscard]] Neighbor neighbor_of(int list, std::uint32_t own, std::uint32_t other) const;
    // Into `near_`: those that may hold a point no farther from `middle`.
    void list_near(int list, std::uint32_t own, const glm::dvec3& middle, double radius) const;
    [[nodiscard]] bool is_covered(const glm::dvec3& point, const glm::dvec3& direction) const;
    [[nodiscard]] static bool meets_polygon(const Neighbor& neighbor, const Samples& samples,
                                            const glm::dvec3& direction);
    [[nodiscard]] bool parts_pair(const Contact& by, const Contact& contact) const;
    [[nodiscard]] const Contact* find_free(const Contact& contact) const;
    void replace_by_free();
    [[nodiscard]] bool is_behind(const Contact& contact, const Contact& other) const;
    [[nodiscard]] bool may_be_behind(int list, std::uint32_t part) const;
    void replace_behind();
    void keep_deepest(const Contact& from, Contact& contact) const;
    bool push_least_deep();
    int leave_out_covered(int list, std::uint32_t own, const glm::dvec3& normal, ContactPoint* points, int count) const;
    double gather_along(const glm::dvec3& normal, Contact& contact) const;
    [[nodiscard]] bool find_own_face(const Contact& contact, Contact& found) const;

    double margin_ = 0.0;
    Vector<Part> parts_[2];
    Vector<glm::dmat3> to_local_[2];  // inverse rotations of the parts that are boxes without rounding
    Vector<Contact> contacts_, raw_;
    Vector<State> states_;           // by contact
    mutable Vector<Neighbor> near_;  // scratch
};

}  // namespace crofton::convex
