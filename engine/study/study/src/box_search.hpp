// SPDX-License-Identifier: MIT
// Branch and bound over the orientations of a box. The derivation is in docs/notes/measure.md.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "ancestor_directions.hpp"

namespace crofton::study {

class BoxSearch {
  public:
    // Points relative to `origin`, which lies in their hull. The directions must outlive this.
    BoxSearch(Vector<glm::dvec3> points, const glm::dvec3& origin, const AncestorDirections& directions);
    // Returns the measure of the planes that hit all ancestors and the tight box with these axes.
    [[nodiscard]] double measure_of(const glm::dmat3& axes) const;
    // Below the measure of the tight box of every orientation in the cell (rotation_cells.hpp).
    [[nodiscard]] double bound(const glm::dvec3& center, double half) const;
    void run(const BoxGivenAncestorsOptions& options, glm::dmat3& best, BoxGivenAncestors& result) const;

  private:
    // The points farthest along each axis, and against it.
    struct Supports {
        std::array<glm::dvec3, 3> high, low;
    };
    [[nodiscard]] Supports supports(const glm::dmat3& axes) const;
    [[nodiscard]] double remainder(const Supports& s, double longest, double angle) const;

    Vector<glm::dvec3> points_;
    const Vector<glm::dvec3>& normals_;
    Vector<double> limits_;
    double mean_cosine_ = 1.0;
};

}  // namespace crofton::study
