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

// The least k-DOPs around points, by the rotation of their directions. The points are relative to one inside their
// hull; the directions are as for SlabPolytopes.
class KDopRotations {
  public:
    KDopRotations(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                  const measure::Criterion& criterion);
    // The criterion of the least k-DOP whose directions are turned.
    [[nodiscard]] double value(const glm::dmat3& rotation);
    // Below value(rotation_of(g) · turn) for every g of a cell (rotation_cells.hpp). `rotation` is that of the cell's
    // center, rotation_of(center) · turn, and value(rotation) was the last call.
    [[nodiscard]] double bound(const glm::dvec3& center, double half, const glm::dmat3& rotation);

  private:
    // Faces through one edge would be counted twice where offsets tie: each is lowered by another small amount.
    [[nodiscard]] double lowered(std::size_t face, double offset) const;
    void find_supports(const glm::dmat3& rotation);

    std::span<const glm::dvec3> points_;
    SlabPolytopes polytopes_;
    const measure::Criterion& criterion_;
    Vector<double> offsets_;
    Vector<glm::dvec3> support_;
    double size_ = 0.0;
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
