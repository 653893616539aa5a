// SPDX-License-Identifier: MIT
// Do two oriented boxes meet? Exactly: one pair, or many at once.
#pragma once
#include <crofton/collide/box_block.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <span>

namespace crofton::collide {

// Do two oriented boxes meet? Exactly.

// True iff the two exact parallelepipeds share a point; touching counts. Filtered separating-axis test (Gottschalk,
// Lin, Manocha 1996) with a proven error bound, then exact arithmetic. Exact for every pair of boxes that validate(Obb)
// accepts; a box with NaN or infinite members meets nothing.
[[nodiscard]] bool intersects(const Obb& a, const Obb& b);

// Which axis tells two boxes apart, for statistics and for warm starts. Axes 0-2 are the face normals of `a`, 3-5 those
// of `b`, 6 + 3i + j the cross product of edge i of `a` with edge j of `b`.
inline constexpr int kAxisCount = 15;
inline constexpr int kNotSeparated = -1;

// The first separating axis found, or kNotSeparated when the boxes meet. Starts with `hint`, an axis that separated
// them before, when that is in [0, 15). Which of several separating axes is returned is the same on every machine.
[[nodiscard]] int separating_axis(const Obb& a, const Obb& b, int hint = kNotSeparated);

// Many pairs of boxes at once: the exact answers of intersects(Obb, Obb), sixteen pairs to a step.

// How the pairs of a batch were decided; the first four sum to the number of pairs.
struct BatchStatistics {
    std::uint64_t separated_by_face_a = 0;  // early out: a face normal of the first box
    std::uint64_t separated_by_face_b = 0;
    std::uint64_t separated_by_edges = 0;  // only a cross product of edges tells them apart
    std::uint64_t hits = 0;
    std::uint64_t refined = 0;  // of all: pairs that float could not decide, done in double or exactly

    BatchStatistics& operator+=(const BatchStatistics& other);
};

// Boxes packed for repeated use. The caller's boxes are kept by reference: pairs that float cannot decide are decided
// from them, so they are to live, unchanged, as long as queries are made.
class PackedBoxes {
  public:
    // Any finite origin near the boxes; the nearer, the fewer pairs are left to the slow path. Answers do not depend on
    // it.
    void pack(std::span<const Obb> boxes, const glm::dvec3& origin);
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const BoxBlock> blocks() const { return blocks_; }
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }

  private:
    std::span<const Obb> boxes_;
    Vector<BoxBlock> blocks_;
    glm::dvec3 origin_{0.0};
};

// hits[i] = intersects(a.boxes()[i], b.boxes()[i]). Requires equal sizes and equal origins. Allocates nothing.
BatchStatistics intersects(const PackedBoxes& a, const PackedBoxes& b, std::span<std::uint8_t> hits);

// hits[i] = intersects(a[i], b[i]), straight from the boxes.
BatchStatistics intersects(std::span<const Obb> a, std::span<const Obb> b, std::span<std::uint8_t> hits);

// hits[i] = intersects(boxes[pairs[i].first], boxes[pairs[i].second]). Requires hits.size() == pairs.size().
BatchStatistics intersects(std::span<const Obb> boxes, std::span<const IdPair> pairs, std::span<std::uint8_t> hits);

}  // namespace crofton::collide
