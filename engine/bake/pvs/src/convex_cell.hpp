// SPDX-License-Identifier: MIT
// A convex cell by its corners: its planes and its surface.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/pvs/pvs.hpp>

namespace crofton::pvs {

struct ConvexCellFaces {
    Vector<Plane> planes;  // unit normals, inward, relative to corner 0: the cell is where all are at least 0
    double surface = 0.0;  // area
};

// Returns the faces of the hull of the corners. Corners within 1e-12 of the size of a plane lie on it. The plane is
// then moved inward behind all of them, so that what lies within the planes lies within the hull, but for rounding.
// Returns none for a flat hull.
[[nodiscard]] ConvexCellFaces faces_of(const ConvexCell& cell);

}  // namespace crofton::pvs
