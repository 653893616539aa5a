// SPDX-License-Identifier: MIT
// The sphere around an object that the fewest planes hit together with all its ancestors' bounds, with a proven gap.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/study/convex_body.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

struct SphereOptions {
    double largest = 8.0;             // spheres of up to so many times the least one's radius are considered
    double tolerance = 1e-3;          // stop when value − lower_bound ≤ tolerance · value …
    std::uint64_t max_cells = 20000;  // … or after this many cells of centres
};

struct SphereGivenAncestors {
    Sphere sphere;
    double value = 0.0;        // the measure of the planes that hit it and all ancestors, theory.md (4)
    double lower_bound = 0.0;  // no sphere of the size considered has less
    double plain_value = 0.0;  // that of the least sphere
    std::uint64_t cells = 0;
};

// Finds the sphere, with a certificate.
//
// All measures use the same 1,024 directions, a quadrature within about 1e-3 of (4); the certificate holds for it. With
// h the sphere's support and A the least of the ancestors', the measure is 4π × the mean of min(A, h) over directions,
// because all contain the object. Branch and bound over centres c = c₀ + δ: for any point p of the object the radius is
// at least |p − c₀| + e·δ, with e the unit vector from p to c₀. So h is at least a linear function of δ, the mean of
// min(A, that) is concave, and over a cube it is smallest in a corner. Errors: no points; NaN or infinite ones (by
// index); as validate_bodies for ancestors; an object that sticks out of them in one of these directions; options out
// of range.
[[nodiscard]] Result<SphereGivenAncestors> sphere_given_ancestors(std::span<const glm::dvec3> points,
                                                                  std::span<const ConvexBody> ancestors,
                                                                  const SphereOptions& options = {});

}  // namespace crofton::study
