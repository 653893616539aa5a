// SPDX-License-Identifier: MIT
// Local search in double on a small set of points: turns of a frame to its best angles.
#pragma once
#include <crofton/core/memory.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "search/weights.hpp"

namespace crofton::fit {

struct Candidate {
    glm::dmat3 axes{1.0};
    double value = 0.0;
};

// An edge that lies in a face of the box: the face's axis and the edge's direction.
struct FlushEdge {
    int axis;
    glm::dvec3 direction;
};

// Scratch memory for the searches; grows once, then is reused.
struct SearchBuffers {
    Vector<glm::dvec2> flat, hull;
    Vector<glm::dvec3> near;
    Vector<FlushEdge> edges;
};

[[nodiscard]] glm::dvec3 widths(std::span<const glm::dvec3> points, const glm::dmat3& axes);
[[nodiscard]] double value_of(const Weights& weights, std::span<const glm::dvec3> points, const glm::dmat3& axes);

// Turns the frame about each of its axes in turn to the globally best angle (by rotating calipers) until no turn lowers
// the value. The value never rises. Requires at least one point.
void descend(const Weights& weights, std::span<const glm::dvec3> points, Candidate& candidate, SearchBuffers& buffers);

// Frames built from extreme points, as in the tetrahedra of Larsson and Källberg's DiTO (2011): the widest pair, the
// point farthest from its line, the two farthest from that plane; for each triangle its normal with each of its edges.
void tetrahedral_frames(std::span<const glm::dvec3> points, Vector<glm::dmat3>& frames);

// An orthonormal frame whose first axis is the unit vector `first`.
[[nodiscard]] glm::dmat3 frame_along(const glm::dvec3& first);

}  // namespace crofton::fit
