// SPDX-License-Identifier: MIT
// Branch and bound over the rotations of a k-DOP's directions. The derivation is in docs/notes/measure.md.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::study {

// V, F and M of the polytopes { x : dot(±d_i, x) ≤ b } of fixed directions, for many offsets b.
class SlabPolytopes {
  public:
    // Unit directions, which do not all lie in a plane.
    explicit SlabPolytopes(std::span<const glm::dvec3> directions);
    // Offsets of d_0, −d_0, d_1, −d_1, …; all measures are 0 for a polytope that is empty.
    [[nodiscard]] measure::IntrinsicVolumes operator()(std::span<const double> offsets) const;
    [[nodiscard]] std::size_t faces() const { return normals_.size(); }
    [[nodiscard]] const glm::dvec3& normal(std::size_t face) const { return normals_[face]; }

  private:
    // Where two faces meet: from_i · b_i + from_j · b_j + t · along.
    struct Line {
        std::size_t i, j;
        glm::dvec3 along, from_i, from_j;
        double cosine, sine, angle;  // of the normals
    };
    [[nodiscard]] double edge_length(const Line& line, std::span<const double> offsets) const;

    Vector<glm::dvec3> normals_;
    Vector<Line> lines_;
};

struct KDopSearch {
    glm::dmat3 rotation{1.0};
    double value = 0.0;        // of the best rotation found, within 1e-8
    double lower_bound = 0.0;  // no rotation has less
    std::uint64_t cells = 0;
};

// Around points relative to a point inside their hull. `known` is the value of a rotation that is known already.
[[nodiscard]] KDopSearch search_rotations(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                                          const measure::Criterion& criterion, double known, double tolerance,
                                          std::uint64_t max_cells);

}  // namespace crofton::study
