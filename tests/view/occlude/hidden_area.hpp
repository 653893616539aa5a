// SPDX-License-Identifier: MIT
// What occluders hide in a picture, by brute force: for each pixel the objects that lie behind.
#pragma once
#include <algorithm>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

namespace crofton::testing {

struct Footprint {
    std::vector<std::pair<std::uint32_t, float>> pixels;  // pixel, distance along the view direction
};

// Pixels whose centres triangles cover, with the nearest depth of each; triangles that reach behind the near plane are
// clipped to it.
class Picture {
  public:
    Picture(const Camera& camera, int width, int height)
        : camera_(camera),
          rotation_(world_to_view_rotation(camera)),
          width_(width),
          height_(height),
          scale_(0.5 * height / std::tan(0.5 * camera.fov_y)),
          depth_(static_cast<std::size_t>(width * height), std::numeric_limits<float>::infinity()) {}

    Footprint draw(const TriangleMesh& mesh, const Transform& transform, bool front_only) {
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            std::vector<glm::dvec3> polygon;
            for (std::size_t k = 0; k < 3; ++k)
                polygon.push_back(rotation_ *
                                  (transform * glm::dvec3(mesh.positions[mesh.indices[i + k]]) - camera_.position));
            const glm::dvec3 normal = glm::cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
            if (front_only && glm::dot(normal, polygon[0]) >= 0.0) continue;
            clip(polygon);
            for (std::size_t k = 2; k < polygon.size(); ++k) fill(polygon[0], polygon[k - 1], polygon[k]);
        }
        Footprint result;
        std::sort(touched_.begin(), touched_.end());
        for (const std::uint32_t p : touched_) {
            result.pixels.emplace_back(p, depth_[p]);
            depth_[p] = std::numeric_limits<float>::infinity();
        }
        touched_.clear();
        return result;
    }

  private:
    void clip(std::vector<glm::dvec3>& polygon) const {
        std::vector<glm::dvec3> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double a = -p.z - camera_.near_distance, b = -q.z - camera_.near_distance;
            if (a >= 0.0) kept.push_back(p);
            if ((a >= 0.0) != (b >= 0.0)) kept.push_back(p + (q - p) * (a / (a - b)));
        }
        polygon = std::move(kept);
    }
    void fill(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const auto project = [&](const glm::dvec3& p) {
            return glm::dvec2(0.5 * width_ + scale_ * p.x / -p.z, 0.5 * height_ + scale_ * p.y / -p.z);
        };
        const glm::dvec2 p[3] = {project(a), project(b), project(c)};
        const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
        if (area == 0.0) return;
        const auto bound = [](double v, int most) { return static_cast<int>(std::clamp(v, 0.0, double(most))); };
        const int x1 = bound(std::ceil(std::max({p[0].x, p[1].x, p[2].x})), width_);
        const int y1 = bound(std::ceil(std::max({p[0].y, p[1].y, p[2].y})), height_);
        for (int y = bound(std::floor(std::min({p[0].y, p[1].y, p[2].y})), height_); y < y1; ++y)
            for (int x = bound(std::floor(std::min({p[0].x, p[1].x, p[2].x})), width_); x < x1; ++x) {
                double w[3];
                const glm::dvec2 at(x + 0.5, y + 0.5);
                for (int k = 0; k < 3; ++k) {
                    const glm::dvec2 &u = p[(k + 1) % 3], &v = p[(k + 2) % 3];
                    w[k] = ((v.x - u.x) * (at.y - u.y) - (v.y - u.y) * (at.x - u.x)) / area;
                }
                if (w[0] < 0.0 || w[1] < 0.0 || w[2] < 0.0) continue;
                const float depth = static_cast<float>(1.0 / (w[0] / -a.z + w[1] / -b.z + w[2] / -c.z));
                const auto pixel = static_cast<std::uint32_t>(y * width_ + x);
                if (depth_[pixel] == std::numeric_limits<float>::infinity()) touched_.push_back(pixel);
                depth_[pixel] = std::min(depth_[pixel], depth);
            }
    }

    Camera camera_;
    glm::dmat3 rotation_;
    int width_, height_;
    double scale_;
    std::vector<float> depth_;
    std::vector<std::uint32_t> touched_;
};

// The objects' first depths in each pixel, sorted: how many of them lie behind a depth.
class HiddenArea {
  public:
    explicit HiddenArea(std::size_t pixels) : depths_(pixels), hidden_(pixels, 0) {}
    void add(const Footprint& object) {
        for (const auto& [pixel, depth] : object.pixels) depths_[pixel].push_back(depth);
    }
    void finish() {
        for (auto& list : depths_) std::sort(list.begin(), list.end());
    }
    // Pixels of objects that the occluder hides and that were not hidden before it; `keep`: from now on they are.
    std::size_t gain(const Footprint& occluder, bool keep) {
        std::size_t sum = 0;
        for (const auto& [pixel, depth] : occluder.pixels) {
            const auto& list = depths_[pixel];
            // A hundredth behind: an object's own surface is not hidden by what lies in it.
            const auto behind =
                static_cast<std::size_t>(list.end() - std::upper_bound(list.begin(), list.end(), 1.01f * depth));
            if (behind <= hidden_[pixel]) continue;
            sum += behind - hidden_[pixel];
            if (keep) hidden_[pixel] = behind;
        }
        return sum;
    }
    void reset() { std::fill(hidden_.begin(), hidden_.end(), 0); }

  private:
    std::vector<std::vector<float>> depths_;
    std::vector<std::size_t> hidden_;
};

}  // namespace crofton::testing
