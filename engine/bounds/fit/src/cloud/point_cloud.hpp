// SPDX-License-Identifier: MIT
// A point set that answers support queries: the input of every search, checked and normalised.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "cloud/cloud_kernels.hpp"

namespace crofton::fit {

// The extreme points along each axis: index 2k the farthest along +axes[k], 2k + 1 along −axes[k].
using Supports = std::array<glm::dvec3, 6>;

// A view of the caller's points, with an aligned box around every 128 successive ones (a chunk). Neighbours in the
// input are mostly neighbours in space, so a support query reads few chunks. Normalised coordinates are (p − origin) /
// unit with `unit` a power of two: all lie within [−1, 1]. Every answer depends on the set of points alone, never on
// their order: ties go to the lexicographically least point. One thread at a time: queries write scratch memory.
class PointCloud {
  public:
    PointCloud() = default;
    PointCloud(const PointCloud&) = delete;
    PointCloud& operator=(const PointCloud&) = delete;

    // Reads the points once and keeps a reference to them; memory is reused from one call to the next.
    // Errors: no points; NaN, infinite or beyond kMaxCoordinate: the item is the first such index.
    [[nodiscard]] Result<void> assign(std::span<const glm::vec3> points);
    [[nodiscard]] Result<void> assign(std::span<const glm::dvec3> points);

    [[nodiscard]] std::size_t size() const { return count_; }
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }
    [[nodiscard]] double unit() const { return unit_; }
    [[nodiscard]] glm::dvec3 point(std::size_t i) const { return world(i); }

    // Least and greatest dot(normals[k], p − center) over all points by one pass, in input coordinates: each
    // difference, product and sum rounded once.
    void slab_extents(const glm::dmat3& normals, const glm::dvec3& center, glm::dvec3& low, glm::dvec3& high) const {
        if (floats_)
            kernels::slab_extents(floats_, count_, &center.x, &normals[0].x, &low.x, &high.x);
        else
            kernels::slab_extents(doubles_, count_, &center.x, &normals[0].x, &low.x, &high.x);
    }
    // Whether more than `most` points differ. Most clouds that have more show it early.
    [[nodiscard]] bool has_more_than(std::size_t most) const;
    // The distinct points, normalised, in canonical order. Meant for small sets: quadratic up to 160 points.
    void sorted(Vector<glm::dvec3>& points);

    // The columns are any three directions with |components| ≤ 1.
    [[nodiscard]] Supports supports(const glm::dmat3& directions);
    // Calls `visit` with k and the input coordinates of every point p with |dot(directions[k], p − center)| ≥ limit[k],
    // and of some others. `center` and `limit` are in input coordinates.
    void visit_beyond(const glm::dmat3& directions, const glm::dvec3& center, const glm::dvec3& limit,
                      FunctionRef<void(int k, const glm::dvec3& p)> visit);

    // After a support query: forgets points that are inside the hull of `extremes`, which are normalised points of the
    // cloud. No answer changes. Does so only where the query read many chunks and few points are left, so that the next
    // ones are quicker.
    void forget_interior(std::span<const glm::dvec3> extremes);

  private:
    struct Support {
        glm::dvec3 point;
        double height;  // along the direction asked for
    };

    template <class T>
    Result<void> assign_points(const T* points, std::size_t count);
    template <class T>
    void forget_interior_of(const T* points, const InteriorTest& test, Vector<T>& kept);
    // Writes each wanted chunk's least and greatest projections on each direction to low_ and high_, in normalised
    // units, with an error of at most extent_error_bound_. A chunk that is not wanted gets an empty range.
    void find_extents(const glm::dmat3& directions);
    template <class T>
    void find_extents_of(const T* points, Vector<T>& storage, const T* directions, const T* origin,
                         const glm::dvec3& shift);
    // The chunk whose box goes farthest to this side.
    [[nodiscard]] std::size_t most_promising_chunk(std::size_t side) const;
    // Replaces `best` where a point of the chunk is higher along the direction, or as high and lexicographically less.
    void scan(std::size_t chunk, const glm::dvec3& direction, Support& best) const;
    // Writes the interval that each chunk's box covers on each direction to middle_ and projected_radius_.
    void project_boxes(const glm::dmat3& directions);
    [[nodiscard]] glm::dvec3 world(std::size_t i) const {
        return floats_ ? glm::dvec3(glm::vec3(floats_[3 * i], floats_[3 * i + 1], floats_[3 * i + 2]))
                       : glm::dvec3(doubles_[3 * i], doubles_[3 * i + 1], doubles_[3 * i + 2]);
    }
    // Never gives −0, since shift_ is not −0: so −0 and 0 become one number.
    [[nodiscard]] glm::dvec3 normalised(std::size_t i) const { return (world(i) + shift_) * scale_; }

    const float* floats_ = nullptr;
    const double* doubles_ = nullptr;
    std::size_t count_ = 0, chunks_ = 0;
    Vector<unsigned char> wanted_;
    Vector<float> float_bounds_, ranks_, kept_floats_;
    Vector<std::uint32_t> order_;
    Vector<double> double_bounds_, boxes_, kept_doubles_;
    Vector<double> middle_, projected_radius_, low_, high_;  // one array per direction
    Aabb bounds_;
    glm::dvec3 origin_{0.0}, shift_{0.0};  // shift_ = −origin_
    glm::vec3 float_origin_{0.0f};
    double unit_ = 1.0, scale_ = 1.0, extent_error_bound_ = 0.0;
};

[[nodiscard]] inline bool lexicographic(const glm::dvec3& a, const glm::dvec3& b) {
    if (a.x != b.x) return a.x < b.x;
    return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Sorts and removes duplicates: the canonical order of a point set.
void make_canonical(Vector<glm::dvec3>& points);

}  // namespace crofton::fit
