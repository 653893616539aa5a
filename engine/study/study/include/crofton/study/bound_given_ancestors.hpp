// SPDX-License-Identifier: MIT
// The oriented box around an object that the fewest queries hit together with all its ancestors' bounds (paper, section
// 4).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/convex_body.hpp>
#include <crofton/study/query_sample.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

struct BoundGivenAncestors {
    Obb bound;
    std::uint32_t ancestor_hits = 0;  // sampled queries that hit all ancestors
    std::uint32_t hits = 0;           // of those, queries that also hit `bound`
    std::uint32_t plain_hits = 0;     // of those, queries that hit the box that the criterion alone chooses
    std::uint32_t lower_bound = 0;    // of those, at least so many hit any box around the object, in any orientation
    std::uint64_t cells = 0;          // sets of orientations bounded
};

struct BoundGivenAncestorsOptions {
    double tolerance = 1e-2;          // stop when hits − lower_bound ≤ tolerance · hits …
    std::uint64_t max_cells = 20000;  // … or after this many cells; 0: by the object's hull alone
};

// Finds the box by counting a sample of queries: planes, rays or frusta.
//
// It tries several orientations first: boxes fitted by the criterion, by area and by edge sum, the ancestors' axes, and
// the world's. Then it turns the best one by ever smaller angles. Ties go to the criterion. The result is never worse
// than the plain fit.
//
// `lower_bound` is a certificate for the sample, by branch and bound over the orientations that differ as boxes. A
// query that hits the object's hull hits every box around it. A query that hits the intersection of all tight boxes of
// a cell of orientations hits each of them. Queries that touch within rounding may be off. The gap shrinks in
// proportion to the size of the cells, so it stays wide for few of them (docs/notes/measure.md). The box contains all
// points. Errors: as fit_obb; an ancestor that fails validate(Obb), by its index; a criterion that fails validate; a
// tolerance outside [0, 1).
[[nodiscard]] Result<BoundGivenAncestors> bound_given_ancestors(std::span<const glm::dvec3> points,
                                                                std::span<const Obb> ancestors,
                                                                const study::QuerySample& queries,
                                                                const measure::Criterion& criterion,
                                                                const BoundGivenAncestorsOptions& options = {});

struct BoxGivenAncestorsOptions {
    double tolerance = 1e-2;           // stop when value − lower_bound ≤ tolerance · value …
    std::uint64_t max_cells = 100000;  // … or after this many cells of orientations
};

struct BoxGivenAncestors {
    Obb box;
    double value = 0.0;        // the measure of the planes that hit it and all ancestors, theory.md (4)
    double lower_bound = 0.0;  // no box around the object, in any orientation, has less
    double plain_value = 0.0;  // that of the box of least edge sum
    std::uint64_t cells = 0;
};

// Finds the box for planes, with a certificate.
//
// All measures use the same 1,024 directions, a quadrature within about 1e-3 of (4); the certificate holds for it. It
// is a branch and bound over the orientations that differ as boxes: a cube of Rodrigues vectors of half side tan(π/8),
// because quarter turns change no box. For each direction the box's support is at least a linear function of the turn,
// minus a remainder of second order. The mean of min(ancestors' support, that) is concave, so over a cell it is
// smallest in a corner (docs/notes/measure.md). Errors: as fit_obb and validate_bodies; an object that sticks out of
// its ancestors in one of these directions; an object without extent; options out of range.
[[nodiscard]] Result<BoxGivenAncestors> box_given_ancestors(std::span<const glm::dvec3> points,
                                                            std::span<const ConvexBody> ancestors,
                                                            const BoxGivenAncestorsOptions& options = {});

}  // namespace crofton::study
