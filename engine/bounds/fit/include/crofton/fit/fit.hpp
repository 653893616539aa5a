// SPDX-License-Identifier: MIT
// Oriented boxes around points, best for a criterion: quickly, many at once, with a proof, in the plane.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <limits>
#include <span>

namespace crofton::fit {

// Oriented boxes around points, best by a criterion that the user's queries imply.

enum class Quality : std::uint8_t {
    fast,   // a local search with little effort: within 0.3 % of the optimum on average (docs/notes/fit.md)
    tight,  // a local search from many frames: within 0.03 % on average, never worse than `fast` (by area where flat)
    exact,  // the global optimum, proved, and never worse than `tight` in the same sense; fit_exact tells the bound
};

struct FitOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    Quality quality = Quality::tight;
};

// A box that contains every point exactly, in the sense of contains(Obb, point). The same bits for any order and
// duplication of the points and any instruction set; −0 counts as 0. Of points beyond 5e29 in magnitude a half extent
// may exceed 1e30, which validate(Obb) refuses. Errors: no points (empty); a coordinate that is NaN, infinite or beyond
// 1e30 in magnitude (the item is the first such point); weights that are negative, not finite or all zero.
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::vec3> points, const FitOptions& options = {});
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::dvec3> points, const FitOptions& options = {});

// The box with the given orthonormal axes around the points: refits a box whose points have moved. Its half extents are
// the least floats that hold all points around its centre. Errors: as fit_obb; axes that are not orthonormal.
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::vec3> points, const glm::mat3& axes);
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes);

// A box that contains all the boxes, locally best by the criterion. One box is returned as it is.
// Errors: no boxes (empty); a box that is not valid, or one of several that reaches beyond 1e30, by index.
[[nodiscard]] Result<Obb> merge(std::span<const Obb> boxes, const measure::Criterion& criterion);

// Boxes around many small clusters at once, as the leaves and nodes of trees need them.

// Cluster i holds the points positions[indices[j]], j in [ends[i − 1], ends[i]); the first begins at 0. An index may
// occur in several clusters, and several times in one.
struct Clusters {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;
    std::span<const std::uint32_t> ends;
};

// As fit_obb for every cluster: writes boxes[i] for cluster i. The same bits with any executor. A cluster that cannot
// be fitted (no points, a bad index or point) gets a default box. The others get theirs, and the error names the first
// bad cluster. Requires boxes.size() == clusters.ends.size(), and ends that never decrease and stay within `indices`.
[[nodiscard]] Result<void> fit_many(const Clusters& clusters, const FitOptions& options, Executor& executor,
                                    std::span<Obb> boxes);

// The best box there is, with a proof of how good it is.

struct Progress {
    double value = 0.0;        // criterion of the best box so far
    double lower_bound = 0.0;  // proved: no box has less
    std::uint64_t cells = 0;   // sets of orientations bounded so far
};

struct ExactOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    double gap = 2e-7;  // relative; the search stops when it has proved this much. In [1e-12, 1)
    // The search also ends when one of these is spent, or when `should_stop` says so; the result carries the gap
    // reached.
    double time_budget_seconds = std::numeric_limits<double>::infinity();
    std::uint64_t max_cells = 1u << 22;
    // Return true to end the search. Called some thousand times a second, or null. The clock is read as often. A step
    // may take half a second where 100,000 points lie on a sphere, since each cell then needs others of them.
    const FunctionRef<bool(const Progress&)>* should_stop = nullptr;
};

struct ExactFit {
    Obb box;                   // contains every point exactly
    double value = 0.0;        // the criterion of `box`, its rounding to float included
    double lower_bound = 0.0;  // proved: no box with orthonormal axes has less; those of float are so up to 1e-7
    double gap = 0.0;          // (value − lower_bound) / value, 0 for value 0
    // The part of `gap` due to storing the axes as floats. These are tilted by up to 6e-8, which widens thin boxes. By
    // volume, gap and rounding of a tilted flat set are 1: its best box has volume 0, its best box of floats has not.
    // gap − rounding is what the search left unproved.
    double rounding = 0.0;
    // The search ended by itself and proved ExactOptions::gap: gap − rounding is no more, but for 1e-12, or the value
    // is rounding to a thousandth, as a line's area is. False of what cannot be proved in double: thin sets by volume,
    // and flat ones by volume and edges together at sizes at which the volume counts 10^6 times as much as the rest.
    bool complete = false;
    std::uint64_t cells = 0;
    std::size_t subset = 0;  // number of points that the proof used
};

// The global optimum over all orientations. The same bits for any order and duplication of the points and any
// instruction set, unless a time budget or the callback ends the search. Errors: as fit_obb, and a gap or a time budget
// out of range.
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::vec3> points, const ExactOptions& options = {});
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::dvec3> points, const ExactOptions& options = {});

// In the plane: the best rectangle, the smallest disc and the best triangle around points. Points times a power of two
// give the same bits, scaled. Of sets smaller than 1e-90 nothing is promised: products of lengths underflow.

enum class PlanarCriterion : std::uint8_t {
    perimeter,  // the measure of the lines that meet the rectangle
    area,       // the measure of the points in it
};

// The best of all rectangles, by rotating calipers: one side holds an edge of the hull (theory.md section 3). O(n log
// n). Contains every point, and is larger than the best by rounding only. Errors: no points; a coordinate that is NaN,
// infinite or beyond 1e30 in magnitude, by index.
[[nodiscard]] Result<Rectangle> minimal_rectangle(std::span<const glm::dvec2> points, PlanarCriterion criterion);

// The same in O(n) around a convex polygon given by its corners in counter-clockwise order, none twice. One or two
// corners are a point or a segment. If the polygon is not convex, the rectangle contains every point but may not be
// best.
[[nodiscard]] Result<Rectangle> minimal_rectangle_of_convex(std::span<const glm::dvec2> polygon,
                                                            PlanarCriterion criterion);

// The smallest disc. Contains every point, and is larger than the smallest by rounding only. Errors as above.
// O(n log n) for the hull, then expected linear in its corners (Welzl 1991).
[[nodiscard]] Result<Disc> minimal_disc(std::span<const glm::dvec2> points);

// The best of all triangles, its corners in counter-clockwise order. One side holds an edge of the hull (Klee and
// Laskowski 1985; DePano 1987). The other sides touch the hull, by area in their middles, by perimeter where the
// excircles touch them. Contains every point, decided exactly, and is larger than the best by rounding only (1e-9 of
// it for slivers). Points that are as thin as the rounding of their coordinates have, by area, a triangle twice as long
// and twice as thick as they are. One point is a triangle of three equal corners, points of a line have one with two.
// By area O(n log n + h²) for n points and h edges of their hull: 0.1 s for 4,000 edges. By perimeter besides some 0.2
// ms an edge. Errors as above.
[[nodiscard]] Result<std::array<glm::dvec2, 3>> minimal_triangle(std::span<const glm::dvec2> points,
                                                                 PlanarCriterion criterion);

// The least sphere around points.

// V, F and M of a sphere grow with its radius alone: the least sphere is the best by every criterion. Contains every
// point, by distances in double, and is larger than the least by rounding only (1e-9 of it at worst). Exact up to that:
// the least sphere around at most four points, which contains all others. It is found by adding the farthest point
// outside until there is none. Each step is linear in the points, and a dozen steps are usual. Of sets smaller than
// 1e-150 nothing is promised: squares of lengths underflow. Errors: as fit_obb.
[[nodiscard]] Result<Sphere> minimal_sphere(std::span<const glm::dvec3> points);

}  // namespace crofton::fit
