// SPDX-License-Identifier: MIT
// Whether a part of a mesh closes the face of a box, including its recesses.
#pragma once
#include <array>
#include <crofton/geometry/mesh.hpp>
#include <crofton/occlude/occluder.hpp>

#include "finding/pieces.hpp"

namespace crofton::occlude {

// An axis-aligned box in the mesh's frame; its numbers are exact.
struct WallBox {
    glm::vec3 low{0.0f}, high{0.0f};
};

// Face 2 · axis is at high, 2 · axis + 1 at low.
[[nodiscard]] inline float face_of(const WallBox& box, std::size_t face) {
    return (face % 2 == 0 ? box.high : box.low)[static_cast<int>(face / 2)];
}

// Whether each straight path that enters the box through the inner part of the face, and continues in the box to
// `inner` beyond, meets a triangle that lies between the face and `inner`. With Sides::front: one whose front it meets.
// Decided exactly (docs/notes/occluder_finding.md, "Walls"); false where the proof does not apply.
[[nodiscard]] bool is_walled(const PieceMesh& mesh, Sides sides, const WallBox& box, std::size_t face, float inner);

}  // namespace crofton::occlude
