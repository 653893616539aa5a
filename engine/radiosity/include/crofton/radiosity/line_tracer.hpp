// SPDX-License-Identifier: MIT
// What lines and rays meet among many triangles: every crossing in order, or the first.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/aabb.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/sampling/global_lines.hpp>
#include <cstdint>
#include <span>

namespace crofton::radiosity {

namespace detail {
struct TracerNode;
struct TracerLeaf;
}  // namespace detail

struct Hit {
    static constexpr std::uint32_t kNothing = ~std::uint32_t{0};
    float t = 0.0f;  // along the line's direction, from its point
    std::uint32_t triangle = kNothing;
    bool front = false;  // the line comes from the triangle's front
};

// The crossings of line i are hits[ends[i−1] .. ends[i]), ascending in t (ties: see LineTracer).
struct LineHits {
    Vector<Hit> hits;
    Vector<std::uint32_t> ends;
};

// Where a line, followed forward from its point, first meets a triangle other than `skip`, the one it starts on.
struct FirstHitQuery {
    Line line;
    std::uint32_t skip = Hit::kNothing;
};

// A hierarchy of axis-aligned boxes, eight to a node, over the triangles. For measuring, where a crossing more or less
// in 10^6 drowns in the spread of random lines: single precision, so a line through the common edge of two triangles
// may (about once in 10^6) cross both or neither. Crossings closer together than 10^-6 of the scene's half diagonal
// count as one place, fronts first: so two faces back to back at one place (a sheet with two sides) are seen from
// either side. The same bits on every machine and for any thread count.
class LineTracer {
  public:
    // Errors: as validate(TriangleMesh); no triangles; 2^30 of them or more.
    [[nodiscard]] static Result<LineTracer> build(const TriangleMesh& mesh);
    ~LineTracer();
    LineTracer(LineTracer&&) noexcept;
    LineTracer& operator=(LineTracer&&) noexcept;

    // All crossings of each line over its whole length. Appends nothing, replaces `result`; thread-safe.
    void all_hits(std::span<const Line> lines, LineHits& result) const;
    // The first crossing for each query beyond that distance, triangle = kNothing where there is none. Same sizes.
    void first_hits(std::span<const FirstHitQuery> queries, std::span<Hit> result) const;

    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] std::size_t bytes() const;

  private:
    LineTracer();
    Aabb bounds_;
    glm::dvec3 origin_{0.0};
    float tie_ = 0.0f;
    Vector<detail::TracerNode> nodes_;
    Vector<detail::TracerLeaf> leaves_;
};

}  // namespace crofton::radiosity
