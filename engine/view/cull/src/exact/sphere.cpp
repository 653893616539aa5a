// SPDX-License-Identifier: MIT
// Ball against convex volume, exactly. A ball misses the volume iff some sum of its half-spaces with weights ≥ 0 does
// not reach the ball. That is Σ λ_i s_i + r |Σ λ_i n_i| < 0, with s_i the value of plane i at the centre. The best
// weights are those of the nearest point of the volume, which lies where at most three planes of independent normals
// vanish. There G λ = −s over these planes, G their normals' products. So it is enough to try all sets of one to three
// planes. The adjugate of G stands for its inverse, and squares for roots, so that everything is sums and products.
// Planes that the whole ball is inside of may be left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "exact/box_constraints.hpp"
#include "exact/numbers.hpp"

namespace crofton::cull {
namespace {

template <class Number>
class BallTest {
  public:
    static constexpr bool kExact = std::is_same_v<Number, Exact>;

    BallTest(const Frustum& frustum, const Sphere& sphere) : count_(frustum.plane_count) {
        Number offset[3];
        for (int j = 0; j < 3; ++j) offset[j] = Number(sphere.center[j]) - Number(frustum.origin[j]);
        for (std::uint32_t i = 0; i < count_; ++i) {
            value_[i] = Number(frustum.planes[i].offset);
            for (int j = 0; j < 3; ++j) {
                normal_[i][j] = Number(frustum.planes[i].normal[j]);
                value_[i] = value_[i] + normal_[i][j] * offset[j];
            }
        }
        square_ = Number(sphere.radius) * Number(sphere.radius);
        is_inside_ = Answer::yes;
        for (std::uint32_t i = 0; i < count_; ++i) {
            const Number margin = value_[i] * value_[i] - square_ * dot(i, i);
            const bool rejected = value_[i].is_negative() || margin.is_negative();
            const bool accepted = kExact ? !rejected : value_[i].is_positive() && margin.is_positive();
            if (!accepted) crossed_[crossed_count_++] = i;
            if (rejected)
                is_inside_ = Answer::no;
            else if (!accepted && is_inside_ == Answer::yes)
                is_inside_ = Answer::unknown;
        }
    }

    [[nodiscard]] Answer is_inside() const { return is_inside_; }

    // By sets of at most `largest` planes.
    [[nodiscard]] Answer is_outside(std::uint32_t largest) const {
        Answer result = Answer::no;
        const auto note = [&](Answer answer) {
            if (answer == Answer::yes || (answer == Answer::unknown && result == Answer::no)) result = answer;
            return answer == Answer::yes;
        };
        for (std::uint32_t i = 0; i < crossed_count_; ++i) {
            if (note(excludes<1>({crossed_[i]}))) return result;
            for (std::uint32_t j = i + 1; largest > 1 && j < crossed_count_; ++j) {
                if (note(excludes<2>({crossed_[i], crossed_[j]}))) return result;
                for (std::uint32_t k = j + 1; largest > 2 && k < crossed_count_; ++k)
                    if (note(excludes<3>({crossed_[i], crossed_[j], crossed_[k]}))) return result;
            }
        }
        return result;
    }

  private:
    [[nodiscard]] Number dot(std::uint32_t i, std::uint32_t j) const {
        return normal_[i][0] * normal_[j][0] + normal_[i][1] * normal_[j][1] + normal_[i][2] * normal_[j][2];
    }

    // −adj(G) s
    void weigh(const std::array<std::uint32_t, 1>& set, std::array<Number, 1>& weights) const {
        weights[0] = Number(0.0) - value_[set[0]];
    }
    void weigh(const std::array<std::uint32_t, 2>& set, std::array<Number, 2>& weights) const {
        const Number mixed = dot(set[0], set[1]);
        weights[0] = mixed * value_[set[1]] - dot(set[1], set[1]) * value_[set[0]];
        weights[1] = mixed * value_[set[0]] - dot(set[0], set[0]) * value_[set[1]];
    }
    void weigh(const std::array<std::uint32_t, 3>& set, std::array<Number, 3>& weights) const {
        for (std::size_t a = 0; a < 3; ++a) {
            weights[a] = Number(0.0);
            for (std::size_t b = 0; b < 3; ++b) {
                const std::uint32_t p = set[(a + 1) % 3], q = set[(a + 2) % 3];
                const std::uint32_t r = set[(b + 1) % 3], s = set[(b + 2) % 3];
                weights[a] = weights[a] - (dot(p, r) * dot(q, s) - dot(p, s) * dot(q, r)) * value_[set[b]];
            }
        }
    }

    template <std::size_t kCount>
    [[nodiscard]] Answer excludes(const std::array<std::uint32_t, kCount>& set) const {
        std::array<Number, kCount> weights;
        weigh(set, weights);
        bool known = true;
        for (const Number& weight : weights) {
            if (weight.is_negative()) return Answer::no;
            known = known && (kExact || weight.is_positive());
        }
        Number sum(0.0), direction[3] = {Number(0.0), Number(0.0), Number(0.0)};
        for (std::size_t a = 0; a < kCount; ++a) {
            sum = sum + weights[a] * value_[set[a]];
            for (int j = 0; j < 3; ++j) direction[j] = direction[j] + weights[a] * normal_[set[a]][j];
        }
        const Number squared_radius =
            square_ * (direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
        const Number margin = sum * sum - squared_radius;
        if (sum.is_negative() && margin.is_positive()) return known ? Answer::yes : Answer::unknown;
        if (kExact || sum.is_positive() || margin.is_negative()) return Answer::no;
        return Answer::unknown;
    }

    std::uint32_t count_, crossed_count_ = 0;
    std::uint32_t crossed_[Frustum::kMaxPlanes];
    Answer is_inside_;
    Number normal_[Frustum::kMaxPlanes][3], value_[Frustum::kMaxPlanes], square_;
};

// Tests whether exact arithmetic can hold sixteen such factors.
bool is_moderate(double value) {
    return value == 0.0 || std::fabs(value) >= 1e-60;
}

bool is_moderate(const Frustum& frustum, const Sphere& sphere) {
    const auto all = [](const glm::dvec3& v) { return is_moderate(v.x) && is_moderate(v.y) && is_moderate(v.z); };
    for (const Plane& plane : frustum.view())
        if (!all(plane.normal) || !is_moderate(plane.offset)) return false;
    return all(frustum.origin) && all(sphere.center) && is_moderate(sphere.radius);
}

}  // namespace

Verdict classify_usable(const Frustum& frustum, const Sphere& sphere, CullMode mode) {
    const std::uint32_t largest = mode == CullMode::exact ? 3 : 1;
    const BallTest<Bounded> filter(frustum, sphere);
    Answer outside = filter.is_outside(largest), inside = filter.is_inside();
    if ((outside == Answer::unknown || inside == Answer::unknown) && outside != Answer::yes) {
        // The products of one plane's test fit in any case.
        const BallTest<Exact> exact(frustum, sphere);
        if (outside == Answer::unknown) outside = exact.is_outside(is_moderate(frustum, sphere) ? largest : 1);
        if (outside != Answer::yes) inside = exact.is_inside();
    }
    if (outside == Answer::yes) return Verdict::outside;
    return inside == Answer::yes ? Verdict::inside : Verdict::straddling;
}

}  // namespace crofton::cull
