// SPDX-License-Identifier: MIT
// Two boxes, closely: along which of their fifteen axes do they overlap least?
#pragma once
#include "touch.hpp"

namespace crofton::convex {

// A separating axis: 0-2 across the faces of a, 3-5 of b, 6 + 3i + j across edge i of a and edge j of b.
struct BoxAxis {
    int number = -1;
    double extent = 0.0;  // of the difference body along it: how deep the boxes overlap; negative: a gap
};

// Boxes are parallelepipeds, since poses are rigid to 1e-6 alone. Axes are covectors m of a's frame, of length
// √(mᵀ G m) in the world, G = R⁻¹ R⁻ᵀ. Three of a and three of b and nine products of edges are all the normals that
// the difference body has, also where half extents are 0. An extent is off by less than `error`: entries of the
// matrices below by 20 u, with u = 2^-53, so a face's extent by 60 u of the size. A product of edges is off by 40 u /
// |m| in direction; below |m| = 1e-4 it is reckoned from the stored axes instead, without cancellation.
class BoxPair {
  public:
    explicit BoxPair(const Pair& pair);

    // Faces come first, and another axis must be less deep by more than rounding, so that the choice does not flicker.
    // Ends early, with an axis that is surely below `far`, where there is one.
    [[nodiscard]] BoxAxis least(double far);
    // Along the outward normal of face 2k + s of one box; after least() has not ended early.
    [[nodiscard]] double face_extent(bool of_a, int face) const;
    // The face across axis 0 to 5 that looks at the other box.
    [[nodiscard]] int face_towards_other(int axis) const {
        const double along = along_[axis / 3][axis % 3];
        return 2 * (axis % 3) + ((axis < 3 ? along >= 0.0 : along < 0.0) ? 1 : 0);
    }
    // Unit, from a to b.
    [[nodiscard]] glm::dvec3 normal(int axis) const;
    [[nodiscard]] double error() const { return error_; }
    [[nodiscard]] const glm::dmat3& world_to_a() const { return to_a_; }

  private:
    [[nodiscard]] bool try_faces(double far, BoxAxis& least);
    void try_edges(BoxAxis& least) const;

    const Pair& pair_;
    const glm::dvec3 &half_a_, &half_b_;
    double slack_, error_;
    glm::dmat3 to_a_;                   // the inverse of a's rotation
    glm::dmat3 edges_, normals_;        // of b in a's frame: column j is edge j, or the product of the other two
    glm::dvec3 at_;                     // b's center
    glm::dmat3 metric_;                 // G
    double reach_[2][3], along_[2][3];  // of a's and b's faces: sum of the boxes' radii, and where b's center is
};

// The touch of two boxes: its depth and normal are proven, as the least of all axes. The face that the cache names
// stays while it is the least deep within kKeptDepth of the size. `unknown`: nearer to a touch than rounding tells, or
// apart where neither a face nor two edges decide. Sets `reference`, whose face has been clipped: 1 a's, 2 b's.
struct BoxTouchOf {
    Touch touch;
    Clipped clipped;
    int reference = 0;
};
[[nodiscard]] Warm touch_of_boxes(const Placed& a, const Placed& b, const Pair& pair, double margin, PairCache* cache,
                                  BoxTouchOf& found);

}  // namespace crofton::convex
