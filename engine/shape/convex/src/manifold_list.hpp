// SPDX-License-Identifier: MIT
// Collects contact points by direction and makes manifolds of them.
#pragma once
#include "clip.hpp"

namespace crofton::convex {

class ManifoldList {
  public:
    void clear();
    // Points of one part along its normal.
    void add(const glm::dvec3& normal, std::span<const ContactPoint> points);
    // For `rewind`, which forgets what has been added since.
    struct Mark {
        std::size_t parts, points;
    };
    [[nodiscard]] Mark mark() const { return {parts_.size(), points_.size()}; }
    void rewind(const Mark& mark);
    // Replaces `manifolds`: of each at most `most` points. Parts are taken deepest first. Each joins the manifold whose
    // normal agrees best with its own, within 5 degrees, else it begins a manifold with its normal. So a point's normal
    // is within 5 degrees of its manifold's, which is that of its deepest point, and no two manifolds agree as well.
    void finish(int most, Vector<Manifold>& manifolds);

  private:
    struct Touching {  // a part
        glm::dvec3 normal;
        double depth;
        std::uint32_t first, count;  // of points_
        std::uint32_t manifold;
    };
    void assign_manifolds();
    void number_by_first_part(std::size_t count);

    Vector<Touching> parts_;
    Vector<ContactPoint> points_, sorted_;
    Vector<std::uint32_t> by_depth_;  // parts
    Vector<std::uint32_t> number_;    // by manifold
    Vector<glm::dvec3> normals_;      // by manifold
    Vector<std::uint32_t> first_;     // by manifold, of sorted_
};

}  // namespace crofton::convex
