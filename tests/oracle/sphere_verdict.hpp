// SPDX-License-Identifier: MIT
// Oracle: does a sphere meet a frustum, in any kind of number that knows its sign. Nothing is divided.
#pragma once
#include <algorithm>
#include <crofton/cull/classify.hpp>
#include <oracle/frustum_rows.hpp>
#include <vector>

namespace crofton::oracle {

// The nearest point of the volume is the centre, or its projection onto a face, an edge or a corner. All of them are
// tried, by eliminating what lies along the planes chosen before (Gram, Schmidt).
template <class Number>
class SphereVerdict {
  public:
    SphereVerdict(const Frustum& frustum, const Sphere& sphere)
        : square_(Number(sphere.radius) * Number(sphere.radius)) {
        for (const Plane& plane : frustum.view())
            sides_.push_back({vector_of<Number>(plane.normal),
                              quick::plane_value<Number>(frustum, plane, sphere.center), plane.normal});
    }

    [[nodiscard]] bool is_rejected_by_a_plane() const {
        return std::any_of(sides_.begin(), sides_.end(),
                           [&](const Side& side) { return sgn(side.offset) < 0 && reach(side) > 0; });
    }
    [[nodiscard]] cull::Verdict operator()() {
        if (is_rejected_by_a_plane()) return cull::Verdict::outside;
        if (std::all_of(sides_.begin(), sides_.end(),
                        [&](const Side& side) { return sgn(side.offset) >= 0 && reach(side) >= 0; }))
            return cull::Verdict::inside;
        const Number zero(0.0);
        return reaches({zero, zero, zero}, Number(1.0), 0) ? cull::Verdict::straddling : cull::Verdict::outside;
    }

  private:
    // normal · x + offset ≥ 0, for x relative to the sphere's centre.
    struct Side {
        Vec3<Number> normal;
        Number offset;
        glm::dvec3 stored_normal;
    };

    // Whether the plane is farther from the centre than the radius (1), as far (0), or nearer (−1).
    [[nodiscard]] int reach(const Side& side) const {
        return sgn(Number(side.offset * side.offset - square_ * dot(side.normal, side.normal)));
    }
    [[nodiscard]] bool is_chosen(std::size_t i) const {
        return std::find(chosen_.begin(), chosen_.end(), i) != chosen_.end();
    }
    [[nodiscard]] bool is_parallel_to_chosen(const glm::dvec3& normal) const {
        return std::any_of(chosen_.begin(), chosen_.end(), [&](std::size_t i) {
            return sides_[i].stored_normal == normal || sides_[i].stored_normal == -normal;
        });
    }

    // Whether the sphere holds x / weight, which lies on the chosen planes, and so does the volume; or one of the
    // points that are reached from there by choosing more planes.
    [[nodiscard]] bool reaches(const Vec3<Number>& x, const Number& weight, std::size_t first) {
        bool in_volume = true;
        for (std::size_t i = 0; i < sides_.size() && in_volume; ++i)
            in_volume = is_chosen(i) || sgn(value(i, x, weight)) >= 0;
        if (in_volume && sgn(Number(dot(x, x) - square_ * weight * weight)) <= 0) return true;
        for (std::size_t i = first; i < sides_.size() && basis_.size() < 3; ++i) {
            const Vec3<Number>& normal = sides_[i].normal;
            if (is_parallel_to_chosen(sides_[i].stored_normal)) continue;
            Vec3<Number> along = normal;
            for (const Vec3<Number>& b : basis_) {
                const Number length = dot(b, b), share = dot(along, b);
                for (std::size_t k = 0; k < 3; ++k) along[k] = Number(along[k] * length - share * b[k]);
            }
            const Number slope = dot(normal, along), distance = value(i, x, weight);
            if (sgn(slope) == 0) continue;
            Vec3<Number> moved;
            for (std::size_t k = 0; k < 3; ++k) moved[k] = Number(x[k] * slope - distance * along[k]);
            chosen_.push_back(i);
            basis_.push_back(along);
            const bool found = reaches(moved, Number(weight * slope), i + 1);
            chosen_.pop_back();
            basis_.pop_back();
            if (found) return true;
        }
        return false;
    }
    [[nodiscard]] Number value(std::size_t i, const Vec3<Number>& x, const Number& weight) const {
        return Number(dot(sides_[i].normal, x) + sides_[i].offset * weight);
    }

    std::vector<Side> sides_;
    Number square_;
    std::vector<std::size_t> chosen_;
    std::vector<Vec3<Number>> basis_;
};

}  // namespace crofton::oracle
