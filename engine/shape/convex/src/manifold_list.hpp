// SPDX-License-Identifier: MIT
// Contact points gathered by direction, from which manifolds are made at the end.
#pragma once
#include "clip.hpp"

namespace crofton::convex {

class ManifoldList {
  public:
    void clear();
    // Points of one part along its normal: to the manifold whose normal agrees within 5 degrees, else to a new one. A
    // manifold's normal is that of its deepest point.
    void add(const glm::dvec3& normal, std::span<const ContactPoint> points);
    [[nodiscard]] std::size_t point_count() const { return points_.size(); }
    // Replaces `manifolds`: of each at most `most` points.
    void finish(int most, Vector<Manifold>& manifolds);

  private:
    struct Direction {
        glm::dvec3 normal;
        double depth;
        std::uint32_t count;
    };
    Vector<Direction> directions_;
    Vector<ContactPoint> points_, sorted_;
    Vector<std::uint32_t> direction_of_;  // by point
    Vector<std::uint32_t> first_;         // by direction, of sorted_
};

}  // namespace crofton::convex
