// SPDX-License-Identifier: MIT
// Whole bundles of parallel global lines at once: the scene is drawn into the grid whose cells the lines pass through.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/radiosity/line_tracer.hpp>
#include <crofton/sampling/global_lines.hpp>
#include <cstdint>

namespace crofton::radiosity {

namespace detail {
struct DrawnTriangles;
}  // namespace detail

// One line in each cell of a square grid, at a uniform place of its cell (jitter), all in one uniform direction. The
// grid covers the shadow of the scene's box, so every place in it is met with density 1/cell_area: a surface of area S
// expects S/(2·cell_area) crossings per bundle, averaged over directions.
struct Bundle {
    glm::dvec3 direction{0.0}, right{0.0}, up{0.0};  // orthonormal, right-handed
    glm::dvec3 corner{0.0};                          // of cell (0, 0); lines start in the plane through it
    double cell = 1.0;                               // side of a cell
    std::uint32_t columns = 0, rows = 0;
    std::uint64_t seed = 0;  // of the jitter
    double lines = 0.0;      // expected number of lines that meet the box; the others are no lines at all

    [[nodiscard]] std::size_t cells() const { return std::size_t{columns} * rows; }
    [[nodiscard]] Line line(std::size_t cell_number) const;  // row by row
};

// u: two uniform numbers, of the direction. Requires bounds of two positive extents at least, cell_area > 0 and at most
// 2^24 cells across the shadow.
[[nodiscard]] Bundle make_bundle(const Aabb& bounds, double cell_area, const std::array<double, 2>& u,
                                 std::uint64_t seed);

// What LineTracer::all_hits(bundle.line(0), bundle.line(1), …) gives, with the same caveats, at a cost that hardly
// depends on the number of lines: triangles + crossings instead of lines · log(triangles).
class BundleTracer {
  public:
    // Errors: as LineTracer::build.
    [[nodiscard]] static Result<BundleTracer> build(const TriangleMesh& mesh);
    ~BundleTracer();
    BundleTracer(BundleTracer&&) noexcept;
    BundleTracer& operator=(BundleTracer&&) noexcept;

    // Memory of one thread's tracing, kept between calls.
    struct Scratch {
        Vector<float> sample_x, sample_y;
        Vector<std::uint32_t> cells, starts;
        Vector<Hit> fragments;
    };

    // The crossings of the line of cell i are result.hits[ends[i−1] .. ends[i]), ascending in t. Replaces `result`;
    // thread-safe with a scratch per thread.
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

}  // namespace crofton::radiosity
