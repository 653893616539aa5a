// SPDX-License-Identifier: MIT
// Polytopes where they stand, in numbers that are never rounded: proofs that two of them meet or not, and how deep.
#pragma once
#include <array>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/dyadic.hpp>
#include <span>
#include <vector>

namespace crofton::cli {

using ExactVector = std::array<Dyadic, 3>;

// A translation: velocity · time, not rounded.
struct ExactWay {
    glm::dvec3 velocity{0.0};
    double time = 0.0;
};

// The images of a shape's stored corners under its stored pose, at the end of a way. Of hulls, boxes and triangles.
struct ExactShape {
    std::vector<ExactVector> points;
    std::vector<std::array<std::size_t, 3>> triangles;  // counter-clockwise seen from outside
    explicit ExactShape(const convex::ShapeAtPose& placed, const ExactWay& way = {});
};

// By a plane across one of the `normals` (from a to b), or a common point: `origin` plus one of the `points`. Where
// neither is a proof, by all separating axes, which takes long; *by_axes is raised by one then.
[[nodiscard]] bool meet_exactly(const ExactShape& a, const ExactShape& b, std::span<const glm::dvec3> normals,
                                const glm::dvec3& origin, std::span<const glm::dvec3> points, std::uint64_t& by_axes);

// The same of shapes that stand anywhere, b at the end of a way. Planes and points are guessed by the engine, and
// `normal` is tried too.
[[nodiscard]] bool meet_exactly(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const glm::dvec3& normal,
                                std::uint64_t& by_axes, const ExactWay& way_of_b = {});

// Whether the depth of two shapes that meet lies in [lower, upper]: by all faces of the difference body, found among
// all triples of its points. For shapes of few corners.
[[nodiscard]] bool depth_lies_between(const ExactShape& a, const ExactShape& b, double lower, double upper);

}  // namespace crofton::cli
