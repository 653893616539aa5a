// SPDX-License-Identifier: MIT
// Estimates by several rays the worth of an occluder that looks large, or whose middle has nothing behind it.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "choosing/candidate_storage.hpp"

namespace crofton::occlude {

class LargeWorth {
  public:
    // `objects`: bounds of the objects that may be hidden.
    LargeWorth(const OcclusionView& view, const Aabb& objects, const glm::dvec3& candidates_origin);

    // As the kernel's worth: the share of all directions that the candidate covers, times the way behind it through the
    // objects' bounds; here a sum over rays through the part of the picture where the two meet. 0: nothing is behind
    // it, or it covers less than `least` there and `cover` is less.
    [[nodiscard]] float of(const CandidatePage& page, std::size_t i, float cover, float least) const;

  private:
    struct Ray {
        glm::dvec3 start, along;  // relative to the view's origin; `along` is 1 deep
    };
    // A rectangle of the window [−1, 1]².
    struct Rectangle {
        glm::dvec2 min{1e300}, max{-1e300};
        void include(const glm::dvec2& p);
        [[nodiscard]] bool is_empty() const { return !(min.x < max.x && min.y < max.y); }
    };
    [[nodiscard]] glm::dvec3 project(const glm::dvec3& point) const;  // column, row, w
    [[nodiscard]] Rectangle rectangle_of(const Aabb& box) const;
    [[nodiscard]] Ray ray_through(const glm::dvec2& pixel) const;

    const OcclusionView& view_;
    glm::dvec3 origin_;  // of the candidates, relative to the view's
    Aabb objects_;       // relative to the view's origin
    glm::dmat3 inverse_;
    Rectangle window_;
    double share_ = 0.0;  // of all directions, or of the picture, that a unit of the window's area is in its middle
};

}  // namespace crofton::occlude
