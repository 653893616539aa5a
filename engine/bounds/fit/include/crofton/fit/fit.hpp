// SPDX-License-Identifier: MIT
// Boxes, spheres and plane figures around points that minimise a criterion.
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

// Oriented boxes around points.

enum class Quality : std::uint8_t {
    fast,   // a local search with little effort: within 0.3 % of the optimum on average (docs/notes/fit.md)
    tight,  // a local search from many frames: within 0.03 % on average, never worse than `fast` (by area where flat)
    exact,  // the global optimum, proved, and never worse than `tight` in the same sense; fit_exact returns the bound
};

struct FitOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    Quality quality = Quality::tight;
};

// Returns a box that contains every point exactly, in the sense of contains(Obb, point).
//
// The bits are the same for any order and duplication of the points and any instruction set; −0 counts as 0. If points
// lie beyond 5e29 in magnitude, a half extent may exceed 1e30, which validate(Obb) refuses. Errors: no points (empty);
// a coordinate that is NaN, infinite or beyond 1e30 in magnitude (the item is the first such point); weights that are
// negative, not finite or all zero.
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::vec3> points, const FitOptions& options = {});
[[nodiscard]] Result<Obb> fit_obb(std::span<const glm::dvec3> points, const FitOptions& options = {});

// Returns the box with the given orthonormal axes around the points. Use it to refit a box whose points have moved.
//
// The half extents are the smallest floats that contain all points around the box's centre. Errors: as fit_obb; axes
// that are not orthonormal.
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::vec3> points, const glm::mat3& axes);
[[nodiscard]] Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes);

// Returns a box that contains all the boxes, a local optimum of the criterion. A single box is returned unchanged.
//
// Errors: no boxes (empty); a box that is not valid, or one of several that reaches beyond 1e30, by index.
[[nodiscard]] Result<Obb> merge(std::span<const Obb> boxes, const measure::Criterion& criterion);

// Boxes around many small clusters at once, for the leaves and nodes of trees.

// Lists clusters of points. Cluster i has the points positions[indices[j]] for j in [ends[i − 1], ends[i]); the first
// begins at 0. An index may occur in several clusters, and several times in one.
struct Clusters {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;
    std::span<const std::uint32_t> ends;
};

// Fits a box to every cluster as fit_obb does, and writes it to boxes[i] for cluster i.
//
// The bits are the same with any executor. A cluster that cannot be fitted (no points, a bad index or point) gets a
// default box. The others get theirs, and the error names the first bad cluster. Requires boxes.size() ==
// clusters.ends.size(), and ends that never decrease and stay within `indices`.
[[nodiscard]] Result<void> fit_many(const Clusters& clusters, const FitOptions& options, Executor& executor,
                                    std::span<Obb> boxes);

// The globally best box, with a proof.

struct Progress {
    double value = 0.0;        // criterion of the best box so far
    double lower_bound = 0.0;  // proved: no box has less
    std::uint64_t cells = 0;   // sets of orientations bounded so far
};

struct ExactOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    double gap = 2e-7;  // relative, in [1e-12, 1); the search stops when it has proved this gap
    // The search also ends when one of these budgets is spent or `should_stop` returns true. The result then contains
    // the gap reached.
    double time_budget_seconds = std::numeric_limits<double>::infinity();
    std::uint64_t max_cells = 1u << 22;
    // Return true to end the search; may be null. It is called some thousand times a second, and the clock is read as
    // often. If 100,000 points lie on a sphere, a step may take half a second, because each cell then needs other
    // points.
    const FunctionRef<bool(const Progress&)>* should_stop = nullptr;
};

struct ExactFit {
    Obb box;                   // contains every point exactly
    double value = 0.0;        // the criterion of `box`, its rounding to float included
    double lower_bound = 0.0;  // proved: no box with orthonormal axes has less; float axes are orthonormal up to 1e-7
    double gap = 0.0;          // (value − lower_bound) / value, 0 for value 0
    // The part of `gap` that comes from storing the axes as floats. These are tilted by up to 6e-8, which widens thin
    // boxes. For a tilted flat set and the volume, gap and rounding are 1: its best box has volume 0, but its best box
    // of floats does not. gap − rounding is the gap that the search left unproved.
    double rounding = 0.0;
    // True if the search ended by itself and proved ExactOptions::gap. Then gap − rounding is at most that gap plus
    // 1e-12, or the value is rounding to a thousandth, as the area of a line is. False if double cannot prove it: for
    // thin sets by volume, and for flat sets by volume and edges together, at sizes where the volume counts 10^6 times
    // as much as the rest.
    bool complete = false;
    std::uint64_t cells = 0;
    std::size_t subset = 0;  // number of points that the proof used
};

// Finds the global optimum over all orientations.
//
// The bits are the same for any order and duplication of the points and any instruction set, unless a time budget or
// the callback ends the search. Errors: as fit_obb, and a gap or a time budget out of range.
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::vec3> points, const ExactOptions& options = {});
[[nodiscard]] Result<ExactFit> fit_exact(std::span<const glm::dvec3> points, const ExactOptions& options = {});

// The best rectangle, disc and triangle around points in the plane. If the points are multiplied by a power of two, the
// result has the same bits, scaled. Sets smaller than 1e-90 are not supported, because products of lengths underflow.

enum class PlanarCriterion : std::uint8_t {
    perimeter,  // the measure of the lines that meet the rectangle
    area,       // the measure of the points in it
};

// Returns the best of all rectangles, by rotating calipers in O(n log n): one side contains an edge of the hull
// (docs/theory.md, section 3).
//
// It contains every point, and exceeds the optimum by rounding only. Errors: no points; a coordinate that is NaN,
// infinite or beyond 1e30 in magnitude, by index.
[[nodiscard]] Result<Rectangle> minimal_rectangle(std::span<const glm::dvec2> points, PlanarCriterion criterion);

// Does the same in O(n) for a convex polygon, given by its corners in counter-clockwise order, none twice. One or two
// corners are a point or a segment. If the polygon is not convex, the rectangle contains every point but may not be the
// best.
[[nodiscard]] Result<Rectangle> minimal_rectangle_of_convex(std::span<const glm::dvec2> polygon,
                                                            PlanarCriterion criterion);

// Returns the smallest disc. It contains every point, and exceeds the optimum by rounding only.
//
// Takes O(n log n) for the hull, then expected linear time in its corners (Welzl 1991). Errors as above.
[[nodiscard]] Result<Disc> minimal_disc(std::span<const glm::dvec2> points);

// Returns the best of all triangles, with its corners in counter-clockwise order.
//
// One side contains an edge of the hull (Klee and Laskowski 1985; DePano 1987). The other sides touch the hull: by area
// at their midpoints, by perimeter where the excircles touch them. The triangle contains every point, decided exactly,
// and exceeds the optimum by rounding only (1e-9 of it for slivers). By area, points that are as thin as the rounding
// of their coordinates get a triangle twice as long and twice as thick as they are. One point gives a triangle of three
// equal corners, points on a line give one with two equal corners. By area it takes O(n log n + h²) for n points and h
// edges of their hull: 0.1 s for 4,000 edges. By perimeter it takes another 0.2 ms or so per edge. Errors as above.
[[nodiscard]] Result<std::array<glm::dvec2, 3>> minimal_triangle(std::span<const glm::dvec2> points,
                                                                 PlanarCriterion criterion);

// The smallest sphere around points.

// Returns the smallest sphere around points. It is the best by every criterion, because V, F and M of a sphere grow
// with its radius alone.
//
// It contains every point, by distances in double, and exceeds the optimum by rounding only (1e-9 of it at worst). Up
// to that it is exact: the smallest sphere around at most four points, which contains all others. The search adds the
// farthest point outside until there is none. Each step takes linear time, and a dozen steps are usual. Sets smaller
// than 1e-150 are not supported, because squares of lengths underflow. Errors: as fit_obb.
[[nodiscard]] Result<Sphere> minimal_sphere(std::span<const glm::dvec3> points);

}  // namespace crofton::fit
