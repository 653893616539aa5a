// SPDX-License-Identifier: MIT
// Finds the axis along which two boxes overlap least, among all fifteen, and where they touch.
#pragma once
#include <glm/gtc/type_ptr.hpp>
#include <optional>

#include "epa.hpp"
#include "gather.hpp"

namespace crofton::convex {

// Coordinate i of v; glm's own operator[] has a branch for each.
[[nodiscard]] inline double coordinate(const glm::dvec3& v, int i) {
    return glm::value_ptr(v)[i];
}

// The faces of other boxes are segments or points.
[[nodiscard]] inline bool is_solid_box(const Shape& shape) {
    const glm::dvec3& half = shape.half_extents();
    return shape.kind() == Kind::box && half.x > 0.0 && half.y > 0.0 && half.z > 0.0;
}

inline constexpr int kNext[3] = {1, 2, 0}, kLast[3] = {2, 0, 1};  // in a circle

// The edge that is coordinate k's axis or its opposite, while the two others are across it, all exactly; -1: none.
[[nodiscard]] int upright_edge(const glm::dmat3& edges, int k);

// Edges i of a and j of b are exactly along coordinate k, and all others are across it; else k is -1. Then what is
// across edge i or j and another is across two edges of one box, and what is across two others is along k. So the faces
// have all axes, and face j of b has that of face i of a.
struct Upright {
    int k = -1, i = 0, j = 0;
};
[[nodiscard]] Upright upright_of(const glm::dmat3& edges_a, const glm::dmat3& edges_b);

// A separating axis: 0-2 across the faces of a, 3-5 of b, 6 + 3i + j across edge i of a and edge j of b.
struct BoxAxis {
    int number = -1;
    double extent = 0.0;  // of the difference body along it: how deep the boxes overlap; negative: a gap
};

// Boxes are parallelepipeds, since poses are rigid to 1e-6 alone. Axes are covectors m of a's frame, of length
// √(mᵀ G m) in the world, G = R⁻¹ R⁻ᵀ. Three of a, three of b and nine products of edges are all the normals that the
// difference body has, also where half extents are 0. With u = 2^-53, entries of the matrices below are off by 20 u,
// so that a face's extent is off by 60 u of the size, which is below `error`. A product of edges is off by 40 u / |m|
// in direction. Below |m| = 3e-5 it is left to try_slivers(), which goes without cancellation. Such an axis is across a
// parallelogram of width 2 |m| times the shorter half edge, whose neighbours are across other axes; so the least of
// these is at most `sliver_width` above the least of all.
class BoxPair {
  public:
    explicit BoxPair(const Pair& pair);

    // Of all axes but slivers. Faces come first, and another axis must be less deep by more than rounding, so that the
    // choice does not flicker. Ends early, with an axis that is surely below `far`, where there is one.
    [[nodiscard]] BoxAxis least(double far);
    [[nodiscard]] double sliver_width() const { return sliver_width_; }
    void try_slivers(BoxAxis& least) const;
    // Whether the cores meet, after least() has not ended early: along most axes rounding tells, along the others exact
    // sums do. Nothing: numbers beyond what exact sums take.
    [[nodiscard]] std::optional<bool> meet_exactly() const;

    // Whether neither box is turned: both frames are the world's. look_along() is not for these.
    [[nodiscard]] bool is_straight() const { return straight_; }

    // Of one face's axis alone, 0 to 5; then normal() and face_towards_other() know this axis, and seen_by() and
    // into_frame() this box.
    [[nodiscard]] BoxAxis look_along(int axis);

    // The rest is known after least() has not ended early. Along the outward normal of face 2k + s of one box.
    [[nodiscard]] double face_extent(bool of_a, int face) const;
    // The face across axis 0 to 5 that looks at the other box.
    [[nodiscard]] int face_towards_other(int axis) const {
        const double along = along_[axis / 3][axis % 3];
        return 2 * (axis % 3) + ((axis < 3 ? along >= 0.0 : along < 0.0) ? 1 : 0);
    }
    // Unit, from a to b.
    [[nodiscard]] glm::dvec3 normal(int axis) const;
    [[nodiscard]] double error() const { return error_; }

    // A box as the other one sees it, in that one's frame.
    struct Seen {
        glm::dvec3 center, edge[3];  // edges of unit length
    };
    [[nodiscard]] Seen seen_by(bool a) const;
    [[nodiscard]] glm::dvec3 into_frame(bool of_a, const glm::dvec3& direction) const;  // times R⁻¹

  private:
    void find_edges(int k) {
        for (int j = 0; j < 3; ++j) edge_[j][k] = glm::dot(to_a_[k], pair_.pose_b.rotation[j]);
    }
    void find_products();
    [[nodiscard]] BoxAxis least_of_straight(double far);
    [[nodiscard]] BoxAxis least_in_common_frame(double far);
    [[nodiscard]] BoxAxis least_of_upright(double far);
    [[nodiscard]] double face_of_a(int k);
    [[nodiscard]] double face_of_b(int j);
    [[nodiscard]] bool try_faces(double far, BoxAxis& least);
    void try_edges(BoxAxis& least);

    const Pair& pair_;
    const glm::dvec3 &half_a_, &half_b_;
    bool straight_;      // neither box is turned
    bool common_frame_;  // the poses' rotations are the same: the faces of a have all axes
    Upright upright_;
    double depth_margin_, error_, sliver_width_ = 0.0;
    int slivers_ = 0;                         // bit 3i + j
    int near_ = 0;                            // by number: axes along which rounding may hide that they part the boxes
    glm::dvec3 to_a_[3];                      // rows of the inverse of a's rotation
    glm::dvec3 edge_[3];                      // of b in a's frame
    glm::dvec3 across_[3];                    // products of the other two edges
    double determinant_ = 1.0, share_ = 1.0;  // of the edges, and 1 / determinant
    glm::dvec3 at_;                           // b's center
    double radius_sum_[2][3], along_[2][3];   // of a's and b's faces: sum of the boxes' radii, and where b's center is
    double row_share_[3];                     // 1 / length of to_a_, where face_of_a() was asked
};

// A face of one box, the other box's face that looks against it, and what they have in common along a direction.
class BoxClip {
  public:
    // `direction`: unit, from a to b. The face is that of the reference.
    BoxClip(const ShapeAtPose& a, const ShapeAtPose& b, const BoxPair& pair, bool reference_is_a, int face,
            const glm::dvec3& direction);
    // How deep the deepest point is, without roundings; −infinity where there is none.
    [[nodiscard]] double deepest() const;
    // That point's shadow on the face, around the reference's origin.
    [[nodiscard]] glm::dvec3 deepest_place() const;
    void gather(const Touch& touch, double margin, GatheredPoints& to) const;
    // How far a corner of the other box is within the sides of the prism: the least distance, negative outside.
    [[nodiscard]] double corner_within(int corner) const;
    // Whether no axis at all is less deep than the face, of this extent, by more than `allowed`. False: not proven.
    [[nodiscard]] bool proves_least(double extent, double allowed) const;

  private:
    // A corner of the clipped polygon: its shadow on the face, and how far it is above along the direction. `lines`:
    // which meet in it.
    struct FlatCorner {
        double x, y, height;
        unsigned lines;
    };
    static constexpr int kMost = 8;  // four corners and four sides; roundings can add one, which is left out
    int clip_side(const FlatCorner* from, int count, int side, double level, FlatCorner* to) const;
    void find_corners(int incident_face);
    void find_straight_corners();
    [[nodiscard]] double level() const;  // of the reference face along its axis
    void clip();

    const ShapeAtPose &reference_, &other_;
    BoxPair::Seen seen_;
    glm::dvec3 direction_;  // unit, out of the reference, in its frame
    bool reference_is_a_;
    double rounding_;  // corners that are nearer to a side lie on it: a polygon as narrow is an edge
    int face_, incident_ = 0, k_, u_, v_, count_ = 0;
    FlatCorner corner_[kMost + 1];
};

// Whether two solid boxes meet. Nothing: that is nearer to their rounding than the search tells, or beyond exact sums.
[[nodiscard]] std::optional<bool> boxes_meet(const Pair& pair);

// Whether two boxes overlap by more than so much ≥ 0. Nothing: that is nearer to it than the search tells.
[[nodiscard]] std::optional<bool> boxes_overlap_by_more(const Pair& pair, double depth);

// How deep the cores of two solid boxes overlap, with the deepest points. `apart`: the boxes do not meet. `unknown`:
// they are nearer to a touch than the axes tell, or the deepest points are not found.
[[nodiscard]] Warm depth_of_boxes(const Pair& pair, Depth& depth);

// The manifold of two boxes up to thinning out. The touch's depth and normal are proven, as the least of all axes. The
// face that the cache names stays while it is the least deep within kKeptDepth of the size. `unknown`: apart where
// neither a face nor two edges decide, or beyond exact sums.
[[nodiscard]] Warm touch_of_boxes(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin,
                                  PairCache* cache, Touch& touch, GatheredPoints& points);

}  // namespace crofton::convex
