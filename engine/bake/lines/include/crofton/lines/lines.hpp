// SPDX-License-Identifier: MIT
// Lines through a scene with all their crossings, one at a time or in bundles of parallel lines.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdint>
#include <span>

namespace crofton::mesh {

// Declared here for LineTracer below.
struct BoxNode;
}  // namespace crofton::mesh

namespace crofton::lines {

// Crossings of lines and rays with many triangles: all in order, or the first.

namespace detail {
struct TracerLeaf;
struct TracerView;
}  // namespace detail

struct Hit {
    static constexpr std::uint32_t kNothing = ~std::uint32_t{0};
    float t = 0.0f;  // along the line's direction, from its point
    std::uint32_t triangle = kNothing;
    bool front = false;  // the line comes from the triangle's front
};

// Crossings by line. Those of line i are hits[ends[i−1] .. ends[i]), ascending in t (ties: see LineTracer).
struct LineHits {
    Vector<Hit> hits;
    Vector<std::uint32_t> ends;
};

// A query for the first triangle that a line meets, forward from its point, other than `skip`, the triangle it starts
// on.
struct FirstHitQuery {
    Line line;
    std::uint32_t skip = Hit::kNothing;
};

// A hierarchy of axis-aligned boxes, eight per node, over the triangles.
//
// It is for measurements, where one wrong crossing in 10^6 is far below the spread of random lines, and works in single
// precision. A line through the common edge of two triangles may cross both or neither, about once in 10^6. Crossings
// closer together than 10^-6 of the scene's half diagonal count as one place, fronts first, so that two faces back to
// back at one place (a two-sided sheet) are seen from either side. The bits are the same on every machine and for any
// thread count.
class LineTracer {
  public:
    // Builds the hierarchy. Errors: as validate(TriangleMesh); no triangles; 2^30 of them or more.
    [[nodiscard]] static Result<LineTracer> build(const TriangleMesh& mesh);
    ~LineTracer();
    LineTracer(LineTracer&&) noexcept;
    LineTracer& operator=(LineTracer&&) noexcept;

    // Replaces `result` by all crossings of each line over its whole length; thread-safe.
    //
    // Lines go through the hierarchy together, up to 4,096 at once, so pass many in one call. Lines with similar
    // positions and directions are faster. Keeps about a megabyte per thread.
    void all_hits(std::span<const Line> lines, LineHits& result) const;
    // Finds the first crossing of each query, with triangle = kNothing if there is none. Requires equal sizes.
    void first_hits(std::span<const FirstHitQuery> queries, std::span<Hit> result) const;

    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] std::size_t bytes() const;

  private:
    LineTracer();
    [[nodiscard]] detail::TracerView view() const;
    Aabb bounds_;
    glm::dvec3 origin_{0.0};
    float tie_ = 0.0f;
    Vector<mesh::BoxNode> nodes_;
    Vector<detail::TracerLeaf> leaves_;
};

// Global lines for a scene, in reproducible blocks, by the four correct ways of docs/theory.md, section 6.

enum class LineMethod : std::uint8_t {
    sphere_points,  // two uniform points of the bounding sphere
    disc,           // uniform direction, uniform point of the orthogonal disc
    bundles,        // parallel lines through a jittered grid
    walls,          // from the bounding box's surface, cosine-weighted
};
[[nodiscard]] const char* to_string(LineMethod method);

// Draws lines in blocks of kBlock, exactly or, for bundles, on average.
class LineSource {
  public:
    static constexpr std::size_t kBlock = 1024;

    // Requires bounds with at least two positive extents.
    LineSource(const Aabb& bounds, LineMethod method, std::uint64_t seed,
               sampling::Sequence sequence = sampling::Sequence::pseudo_random);

    // Replaces `lines` by block number `block`: the same lines whenever and wherever it is drawn.
    void draw(std::uint64_t block, Vector<Line>& lines) const;

    // Returns the surface area of the body that the lines fill uniformly. N lines cross a surface of area S inside it
    // 2·N·S/surface_area() times on average.
    [[nodiscard]] double surface_area() const;
    [[nodiscard]] LineMethod method() const { return method_; }

  private:
    Aabb bounds_;
    Sphere sphere_;
    LineMethod method_;
    std::uint64_t seed_;
    sampling::UnitPoints points_;
};

// Statistics of uniform lines in a scene. The mean number of crossings is 2·S/F for a surface S in a convex body of
// surface F, for every shape. The spread, and the share of lines that hit nothing, distinguish open scenes from crowded
// ones.
struct VisibilityComplexity {
    double mean_crossings = 0.0;
    double deviation = 0.0;  // of the number of crossings, from line to line
    double wasted = 0.0;     // share of lines without any
    std::uint64_t lines = 0;
};
[[nodiscard]] VisibilityComplexity visibility_complexity(const LineTracer& tracer, const LineSource& source,
                                                         std::uint64_t blocks, Executor& executor = serial_executor());

// Whole bundles of parallel global lines at once: the scene is drawn into the grid whose cells the lines pass through.

namespace detail {
struct DrawnTriangles;
}  // namespace detail

// A bundle: one line in each cell of a square grid, at a uniform place of its cell (jitter), all in one uniform
// direction.
//
// The grid covers the projection of the scene's box, so lines have density 1/cell_area everywhere in it. A surface of
// area S is crossed S/(2·cell_area) times per bundle, averaged over directions.
struct Bundle {
    glm::dvec3 direction{0.0}, right{0.0}, up{0.0};  // orthonormal, right-handed
    glm::dvec3 corner{0.0};                          // of cell (0, 0); lines start in the plane through it
    double cell = 1.0;                               // side of a cell
    std::uint32_t columns = 0, rows = 0;
    std::uint64_t seed = 0;  // of the jitter
    double lines = 0.0;      // expected number of lines that meet the box; the others do not count

    [[nodiscard]] std::size_t cells() const { return std::size_t{columns} * rows; }
    [[nodiscard]] Line line(std::size_t cell_number) const;  // row by row
};

// Makes a bundle. `u` are two uniform numbers, for the direction. Requires bounds with at least two positive extents,
// cell_area > 0 and at most 2^24 cells across the projection.
[[nodiscard]] Bundle make_bundle(const Aabb& bounds, double cell_area, const std::array<double, 2>& u,
                                 std::uint64_t seed);

// Returns the crossings that LineTracer::all_hits(bundle.line(0), bundle.line(1), …) gives, with the same limits of
// accuracy. Its cost hardly depends on the number of lines: triangles + crossings instead of lines · log(triangles).
class BundleTracer {
  public:
    // Errors: as LineTracer::build.
    [[nodiscard]] static Result<BundleTracer> build(const TriangleMesh& mesh);
    ~BundleTracer();
    BundleTracer(BundleTracer&&) noexcept;
    BundleTracer& operator=(BundleTracer&&) noexcept;

    // Memory for one thread, kept between calls.
    struct Scratch {
        Vector<float> sample_x, sample_y;
        Vector<std::uint32_t> cells, starts;
        Vector<Hit> fragments;
    };

    // Replaces `result` by the crossings; those of the line of cell i are result.hits[ends[i−1] .. ends[i]), ascending
    // in t. Thread-safe with a scratch per thread.
    void all_hits(const Bundle& bundle, Scratch& scratch, LineHits& result) const;

    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] std::size_t bytes() const;

  private:
    BundleTracer();
    void place_samples(const Bundle& bundle, Scratch& scratch) const;
    void draw(const Bundle& bundle, Scratch& scratch) const;
    void sort_by_cell(const Bundle& bundle, Scratch& scratch, LineHits& result) const;

    Aabb bounds_;
    glm::dvec3 origin_{0.0};
    float tie_ = 0.0f;
    std::size_t triangles_ = 0;
    Vector<detail::DrawnTriangles> blocks_;
};

}  // namespace crofton::lines
