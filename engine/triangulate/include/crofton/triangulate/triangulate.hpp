// SPDX-License-Identifier: MIT
// Polygons with holes to triangles: minimum weight, because that is what a frustum pays for (theory.md section 5).
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/polygon.hpp>
#include <cstdint>
#include <limits>
#include <memory>

namespace crofton::triangulate {

enum class Method : std::uint8_t { ear, delaunay, minimum_weight };

// Limits of the exact search for the minimum weight. Where one is reached, the lightest of several triangulations is
// returned, with `optimal` false and a proven `gap`: what is proven so far completed to a constrained Delaunay one,
// that of Method::delaunay and that of Method::ear, each improved by flips and by exact minima of windows of fifty
// triangles. They are linear, and not counted. All but the largest and smoothest polygons (docs/triangulate.md) need a
// small part.
struct TriangulateOptions {
    static constexpr std::uint64_t kUnlimitedWork = ~std::uint64_t{0};

    Method method = Method::minimum_weight;
    // In elementary steps of the search, of some 10 ns each: the same answer on every machine, however busy.
    std::uint64_t work = 1'000'000'000;
    // By the clock: the answer depends on the machine. Infinite or above 1e9 is no limit.
    double seconds = std::numeric_limits<double>::infinity();
    // Of the candidates' memory.
    std::size_t bytes = std::size_t{1} << 30;
    // Called now and then with the share of the work done, between 0 and 1; returning false ends the call with the
    // error `cancelled`.
    bool (*progress)(void* user, double fraction) = nullptr;
    void* user = nullptr;
};

// Triangles hold indices into polygon.points, counter-clockwise. Conforming: every vertex is used, collinear ones too,
// and no vertex lies in the interior of a triangle's side. The triangles' areas add up to the polygon's.
struct Triangulation {
    Vector<std::array<std::uint32_t, 3>> triangles;
    double weight = 0.0;   // total length of the diagonals
    bool optimal = false;  // weight is proven minimal
    double gap = 0.0;      // proven bound on (weight − minimum) / minimum, 0 when optimal, infinity when unknown
};

// What input means that is not a simple polygon with disjoint simple holes inside it:
// - a point is inside a ring if an odd number of the ring's edges lie between it and infinity; rings may touch
//   themselves and each other, at points or along edges;
// - points at one position are one vertex: triangles name the index of the ring whose corner they fill, and of
//   consecutive duplicates the first;
// - a vertex on another edge splits that edge;
// - an edge that one ring traverses there and back is no boundary: a spike pointing inside becomes a slit that
//   triangles do not cross, one pointing outside vanishes and its tip is used by no triangle;
// - a hole of one point is a Steiner point, of two a slit, of none nothing.
// Errors name ring, point and position: an outer ring of fewer than three points, positions not finite or differing by
// more than 2^200 in size, edges that cross, holes outside, overlapping or nested, zero area.
[[nodiscard]] Result<Triangulation> triangulate(const Polygon& polygon, const TriangulateOptions& options = {});

// The same with memory kept between calls: allocates nothing once its buffers fit the largest polygon seen.
class Triangulator {
  public:
    Triangulator();
    ~Triangulator();
    Triangulator(Triangulator&&) noexcept;
    Triangulator& operator=(Triangulator&&) noexcept;

    // On error `result` is empty.
    [[nodiscard]] Result<void> triangulate(const Polygon& polygon, const TriangulateOptions& options,
                                           Triangulation& result);

  private:
    struct Workspace;
    struct Release {
        void operator()(Workspace* workspace) const;
    };
    std::unique_ptr<Workspace, Release> workspace_;
};

}  // namespace crofton::triangulate
