// SPDX-License-Identifier: MIT
// Makes contact points from a touch: clips the patches of both shapes along the normal against each other.
#pragma once
#include "touch.hpp"

namespace crofton::convex {

struct GatheredPoints {
    int count = 0;
    ContactPoint point[kMaxClipped + 1];
};

// Two shapes as the gatherer sees them: a's origin, how far the surfaces are from the cores, and the pair's size.
struct Gathering {
    const glm::dvec3& origin;
    double radius_a, radius_b, margin, size;
};

// The middle between the surfaces at the touch's deepest points. Its features are known.
[[nodiscard]] ContactPoint deepest_point(const Gathering& of, const Touch& touch);

class Gatherer {
  public:
    Gatherer(const Gathering& of, const Touch& touch, GatheredPoints& to) : points(to), of_(of), touch_(touch) {}

    // Points of the cores, around a's origin.
    void add(const glm::dvec3& core_a, const glm::dvec3& core_b, const Feature& on_a, const Feature& on_b);
    void add(const Clipped& clipped, bool reference_is_a);
    // Whether the patches have left out the deepest place by more than `tolerance`.
    [[nodiscard]] bool lacks_deepest(double tolerance) const;
    [[nodiscard]] double size() const { return of_.size; }
    // In place of a point with the same id, where there is one.
    void add_deepest();

    GatheredPoints& points;

  private:
    Gathering of_;
    const Touch& touch_;
};

// Of patches one of which is a face at least. The reference is the face that looks along the normal more; of faces
// alike a's, so that it stays. Returns whose it is: 1 a's, 2 b's, 0 where no face is clipped.
int gather_patches(const Patch& a, const Patch& b, const glm::dvec3& normal, Clipped& clipped, Gatherer& gatherer);

// The deepest point of one core, a vertex of it, above the other's face; if it is over it.
void add_support(const Patch& face, const glm::dvec3& out, const glm::dvec3& deepest, int vertex, bool face_is_a,
                 Gatherer& gatherer);

// Sets the features of a touch that are not known: what the vertices of its simplex span, else the patches.
void name_features(const Shape& a, const Shape& b, const Patch& patch_a, const Patch& patch_b, Touch& touch);

// Moves the ends of points, which are above the core of a rounded shape by its radius along `normal`, out to the
// shape's surface: under a face that is tilted against the normal they lie inside. No point becomes deeper than
// `deepest`, and what is as deep stays.
void move_to_surface(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal, double deepest,
                     std::span<ContactPoint> points);

}  // namespace crofton::convex
