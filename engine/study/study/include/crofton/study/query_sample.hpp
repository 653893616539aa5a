// SPDX-License-Identifier: MIT
// A fixed sample of uniform queries, to count those that hit several boxes if there is no formula (docs/theory.md,
// section 4).
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

class QuerySample {
  public:
    QuerySample() = default;  // no queries

    // Draw quasi-random queries by seed, at most 2^24.
    //
    // They are planes and lines that hit the region, or frusta of this camera whose own box, grown by the region's
    // radius, contains its centre. These include all frusta that hit anything inside the region. Errors: a radius that
    // is not positive and finite; a count that is 0 or too large; as measure::intrinsic_volumes_of_frustum for the
    // camera.
    [[nodiscard]] static Result<QuerySample> planes(const Sphere& region, std::uint32_t count, std::uint64_t seed);
    [[nodiscard]] static Result<QuerySample> lines(const Sphere& region, std::uint32_t count, std::uint64_t seed);
    [[nodiscard]] static Result<QuerySample> frusta(const Camera& camera, const Sphere& region, std::uint32_t count,
                                                    std::uint64_t seed);

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(queries_.size()); }
    // Returns the measure of the set that the queries are sampled from, normalised as in docs/theory.md (4), (5) and
    // (1). A share of the queries times this is a measure.
    [[nodiscard]] double measure() const { return measure_; }

    // Tests whether query i meets the box, in double: if they touch, rounding decides.
    [[nodiscard]] bool hits(std::uint32_t i, const Obb& box) const;

    // Tests whether query i meets the convex hull of points, by its triangles, and so meets every convex body around
    // them, by a margin of 2^-46 of the distances from the origin.
    //
    // Returns false for queries that only touch, and for frusta that no edge of the hull enters. Planes need no
    // triangles.
    [[nodiscard]] bool surely_hits(std::uint32_t i, std::span<const glm::dvec3> points,
                                   std::span<const std::uint32_t> triangles) const;

    // Tests whether it meets the box without containing it, so that a traversal must descend below it. Planes and lines
    // contain nothing.
    [[nodiscard]] bool straddles(std::uint32_t i, const Obb& box) const;

    // Returns the queries among `candidates` that hit the box, in order.
    [[nodiscard]] Vector<std::uint32_t> hitting(std::span<const std::uint32_t> candidates, const Obb& box) const;
    [[nodiscard]] Vector<std::uint32_t> all() const;

  private:
    enum class Kind : std::uint8_t { plane, line, frustum };
    // A plane: direction and offset. A line: point and direction. A frustum: its placement.
    struct Query {
        glm::dvec3 point{0.0};
        glm::dvec3 direction{0.0};
        glm::dmat3 rotation{1.0};
    };
    static Result<QuerySample> make(Kind kind, const Sphere& region, std::uint32_t count);
    [[nodiscard]] bool segment_enters(const Query& query, const glm::dvec3& from, const glm::dvec3& to,
                                      double margin) const;
    [[nodiscard]] bool frustum_hits(const Query& query, const Obb& box, bool* contained) const;

    Kind kind_ = Kind::plane;
    double measure_ = 0.0;
    Vector<Query> queries_;
    // The frustum before it is placed.
    std::array<glm::dvec3, 8> corners_{};
    std::array<glm::dvec3, 5> normals_{};
    std::array<glm::dvec3, 6> edges_{};
    std::array<std::array<double, 2>, 5> extents_{};  // of the corners along the normals
};

}  // namespace crofton::study
