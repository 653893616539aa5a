// SPDX-License-Identifier: MIT
// What is seen of a town: rays through a fine grid of points of the picture, and to the corners of each object.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlude_town.hpp"

namespace crofton::bench {

class OcclusionReference {
  public:
    std::vector<bool> seen, in_view;  // by object
    std::size_t seen_count = 0, in_view_count = 0;

    OcclusionReference(const OcclusionTown& town, const Camera& camera, std::uint32_t width, std::uint32_t height)
        : camera_(camera), width_(width), height_(height), depths_(std::size_t{width} * height, 1e30f) {
        to_view_ = world_to_view_rotation(camera);
        tan_y_ = std::tan(0.5 * camera.fov_y);
        for (const Obb& house : town.houses)
            for_each_sample(house, [&](std::size_t at, double distance) {
                depths_[at] = std::min(depths_[at], static_cast<float>(distance));
                return true;
            });
        seen.assign(town.objects.size(), false);
        in_view.assign(town.objects.size(), false);
        for (std::size_t i = 0; i < town.objects.size(); ++i) {
            bool met = false, free = false;
            for_each_sample(town.objects[i], [&](std::size_t at, double distance) {
                met = true;
                free = static_cast<float>(distance) < depths_[at];
                return !free;
            });
            if (!free && met) free = sees_corner(town, town.objects[i]);
            in_view[i] = met;
            seen[i] = free;
            in_view_count += met;
            seen_count += free;
        }
    }

  private:
    struct Slabs {
        glm::dvec3 at, normal[3];
        double half[3];
    };
    Slabs slabs_of(const Obb& box) const {
        Slabs slabs{box.center - camera_.position, {}, {}};
        const glm::dvec3 a(box.axes[0]), b(box.axes[1]), c(box.axes[2]);
        const double volume = glm::dot(a, glm::cross(b, c));
        slabs.normal[0] = glm::cross(b, c) / volume;
        slabs.normal[1] = glm::cross(c, a) / volume;
        slabs.normal[2] = glm::cross(a, b) / volume;
        for (int k = 0; k < 3; ++k) slabs.half[k] = static_cast<double>(box.half_extents[k]);
        return slabs;
    }
    // Where the ray from the eye enters the box, or 1e30.
    static double enter(const Slabs& slabs, const glm::dvec3& along) {
        double enter = 0.0, leave = 1e30;
        for (int k = 0; k < 3; ++k) {
            const double slope = glm::dot(slabs.normal[k], along), at = glm::dot(slabs.normal[k], slabs.at);
            const double a = (at - slabs.half[k]) / slope, b = (at + slabs.half[k]) / slope;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter < leave ? enter : 1e30;
    }

    // Calls visit(sample, distance along the view's axis) for the samples whose ray meets the box, until it says no.
    template <class Visit>
    void for_each_sample(const Obb& box, const Visit& visit) const {
        double low_x = 1e30, high_x = -1e30, low_y = 1e30, high_y = -1e30;
        for (const glm::dvec3& corner : corners(box)) {
            const glm::dvec3 v = to_view_ * (corner - camera_.position);
            if (v.z > -camera_.near_distance) {  // any ray may meet it
                low_x = low_y = -1.0, high_x = high_y = 1.0;
                break;
            }
            const double x = v.x / (-v.z * tan_y_ * camera_.aspect), y = v.y / (-v.z * tan_y_);
            low_x = std::min(low_x, x), high_x = std::max(high_x, x);
            low_y = std::min(low_y, y), high_y = std::max(high_y, y);
        }
        const auto first = [](double v, std::uint32_t size) {
            return static_cast<std::int64_t>(std::clamp(std::floor((v + 1.0) * 0.5 * size), 0.0, double(size)));
        };
        const Slabs slabs = slabs_of(box);
        for (std::int64_t y = first(low_y, height_); y < std::min<std::int64_t>(height_, first(high_y, height_) + 1);
             ++y)
            for (std::int64_t x = first(low_x, width_); x < std::min<std::int64_t>(width_, first(high_x, width_) + 1);
                 ++x) {
                const double u = 2.0 * (static_cast<double>(x) + 0.5) / width_ - 1.0,
                             v = 2.0 * (static_cast<double>(y) + 0.5) / height_ - 1.0;
                const glm::dvec3 along =
                    glm::transpose(to_view_) * glm::dvec3(u * tan_y_ * camera_.aspect, v * tan_y_, -1.0);
                const double distance = enter(slabs, along);
                if (distance < 1e29 && distance >= camera_.near_distance &&
                    !visit(static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x), distance))
                    return;
            }
    }

    bool sees_corner(const OcclusionTown& town, const Obb& box) const {
        for (const glm::dvec3& corner : corners(box)) {
            const glm::dvec3 along = corner - camera_.position, v = to_view_ * along;
            if (std::fabs(v.x) > -v.z * tan_y_ * camera_.aspect || std::fabs(v.y) > -v.z * tan_y_) continue;
            bool free = true;
            for (const Obb& house : town.houses) {
                const double t = enter(slabs_of(house), along);
                free = free && (t >= 1.0 || t * -v.z < camera_.near_distance);
            }
            if (free) return true;
        }
        return false;
    }

    const Camera& camera_;
    std::uint32_t width_, height_;
    std::vector<float> depths_;
    glm::dmat3 to_view_;
    double tan_y_;
};

}  // namespace crofton::bench
