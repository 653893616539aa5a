// SPDX-License-Identifier: MIT
// Many pairs of boxes at once: the exact answers of intersects(Obb, Obb), sixteen pairs to a step.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/id_pair.hpp>
#include <crofton/geometry/obb.hpp>
#include <cstdint>
#include <span>

namespace crofton::collide {

struct BoxBlock;

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
    PackedBoxes();
    ~PackedBoxes();
    PackedBoxes(PackedBoxes&&) noexcept;
    PackedBoxes& operator=(PackedBoxes&&) noexcept;

    // Any finite origin near the boxes; the nearer, the fewer pairs are left to the slow path. Answers do not depend on
    // it.
    void pack(std::span<const Obb> boxes, const glm::dvec3& origin);
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const BoxBlock> blocks() const;  // for the queries
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
