// SPDX-License-Identifier: MIT
// A piece's triangles in the frame of a box, and boxes that grow among them.
#pragma once
#include <algorithm>
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace crofton::occlude {

// A convex polygon that planes across the axes cut: a triangle has at most nine corners after six of them.
class CutPolygon {
  public:
    explicit CutPolygon(const Triangle& t) : count_(3) { std::copy(t.begin(), t.end(), corners_.begin()); }
    // Keeps the part with coordinate `axis` at most `value` (sign > 0) or at least `value` (sign < 0).
    void keep(int axis, double value, int sign);
    [[nodiscard]] std::span<const glm::dvec3> corners() const { return {corners_.data(), count_}; }

  private:
    std::array<glm::dvec3, 12> corners_;
    std::size_t count_;
};

// Coordinates x with position = origin + Σ x_k · axes[k], rounded. Nothing is proven in this frame: certify() decides.
struct FramedPiece {
    glm::mat3 axes{1.0f};
    glm::dvec3 origin{0.0};
    Vector<Triangle> triangles;  // in the frame
    Vector<Triangle> positions;  // as they are
    glm::dvec3 low{0.0}, high{0.0};
};
// Requires at least one triangle. The axes are orthonormal to float rounding.
[[nodiscard]] FramedPiece frame_piece(Vector<Triangle> triangles, const glm::mat3& axes);

// In a FramedPiece's frame.
struct FrameBox {
    glm::dvec3 low{0.0}, high{0.0};

    [[nodiscard]] double mean_shadow() const {
        const glm::dvec3 e = high - low;
        return 0.5 * (e.x * e.y + e.y * e.z + e.z * e.x);
    }
};

// Pushes the faces of a box that no triangle meets outward, each until it meets the surface. The face that adds most to
// the mean shadow goes first.
void push_faces(const FramedPiece& piece, FrameBox& box);

// The box as stored, and the hull of its corners rounded to float.
struct StoredBox {
    Obb box;
    std::array<glm::vec3, 8> corners;
};

// The box a little smaller, if no triangle meets its interior or that of the hull of its corners. That is proven by a
// separating direction for each triangle, evaluated with an error bound.
[[nodiscard]] std::optional<StoredBox> certify(const FramedPiece& piece, const FrameBox& box);

// Whether the triangle surely does not meet the open box, nor the open hull; false where rounding cannot decide.
[[nodiscard]] bool surely_apart(const StoredBox& box, const Triangle& triangle);

}  // namespace crofton::occlude
