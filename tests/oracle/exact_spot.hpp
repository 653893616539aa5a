// SPDX-License-Identifier: MIT
// Oracle: does a spot light (a cone with a spherical cap) meet a cell between three pairs of planes? With numbers of
// 3,000 bits: what is below 2^-1000 is 0.
#pragma once
#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <crofton/cull/lights.hpp>
#include <crofton/geometry/camera.hpp>
#include <vector>

namespace crofton::oracle {

class SpotOracle {
  public:
    SpotOracle(const Frustum& cell, const cull::SpotLight& spot) {
        for (int j = 0; j < 3; ++j) axis_[std::size_t(j)] = number(double(spot.axis[j]));
        const mpf_class length = sqrt(dot(axis_, axis_));
        for (mpf_class& a : axis_) a /= length;
        range_ = number(double(spot.range));
        cosine_ = number(double(spot.cos_half_angle));
        sine_ = sqrt(number(1) - cosine_ * cosine_);
        for (const Plane& plane : cell.view()) {
            Vector n;
            mpf_class value = number(plane.offset);
            for (int j = 0; j < 3; ++j) {
                n[std::size_t(j)] = number(plane.normal[j]);
                value += n[std::size_t(j)] * (number(spot.apex[j]) - number(cell.origin[j]));
            }
            normals_.push_back(n);
            values_.push_back(value);
        }
    }

    // The light is connected: it has its apex in the cell or crosses one of the faces.
    bool meets() const {
        if (is_in_cell({number(0), number(0), number(0)})) return true;
        std::array<Vector, 8> corners;
        for (std::size_t c = 0; c < 8; ++c) corners[c] = meet(c & 1, 2 + (c >> 1 & 1), 4 + (c >> 2));
        for (std::size_t c = 0; c < 8; ++c)
            for (std::size_t k = 0; k < 3; ++k)
                if (!(c >> k & 1) && is_crossed(corners[c], corners[c | std::size_t(1) << k])) return true;
        for (std::size_t i = 0; i < 6; ++i)
            if (lights_middle_of(i)) return true;
        return false;
    }

  private:
    using Vector = std::array<mpf_class, 3>;
    static mpf_class number(double value) {
        mpf_set_default_prec(3000);  // for numbers that are made without a value, too
        return mpf_class(value, 3000);
    }
    static mpf_class trifle() {
        mpf_class result = number(1);
        mpf_div_2exp(result.get_mpf_t(), result.get_mpf_t(), 1000);
        return result;
    }
    static mpf_class dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Vector cross(const Vector& a, const Vector& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    static Vector along(const Vector& a, const Vector& step, const mpf_class& t) {
        return {a[0] + t * step[0], a[1] + t * step[1], a[2] + t * step[2]};
    }

    bool is_in_cell(const Vector& y) const {
        for (std::size_t i = 0; i < normals_.size(); ++i)
            if (dot(normals_[i], y) + values_[i] < -trifle()) return false;
        return true;
    }
    bool is_lit(const Vector& y) const {
        const mpf_class length = sqrt(dot(y, y));
        return length <= range_ + trifle() && dot(axis_, y) >= cosine_ * length - trifle();
    }
    Vector meet(std::size_t i, std::size_t j, std::size_t k) const {
        const Vector jk = cross(normals_[j], normals_[k]), ki = cross(normals_[k], normals_[i]),
                     ij = cross(normals_[i], normals_[j]);
        const mpf_class size = dot(normals_[i], jk);
        Vector result;
        for (std::size_t n = 0; n < 3; ++n)
            result[n] = -(values_[i] * jk[n] + values_[j] * ki[n] + values_[k] * ij[n]) / size;
        return result;
    }

    // The light's part of a segment ends at the segment's ends, on the sphere or on the cone: one of these points is
    // lit if any is.
    bool is_crossed(const Vector& from, const Vector& to) const {
        const Vector step{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        std::vector<mpf_class> places{number(0), number(1)};
        const auto add_roots = [&](const mpf_class& a, const mpf_class& b, const mpf_class& c) {
            mpf_class square = b * b - a * c;
            if (abs(square) < trifle()) square = 0;
            if (square < 0) return;
            if (abs(a) > trifle()) {
                places.push_back((-b - sqrt(square)) / a);
                places.push_back((-b + sqrt(square)) / a);
            } else if (abs(b) > trifle()) {
                places.push_back(-c / (2 * b));
            }
        };
        const mpf_class ff = dot(from, from), fs = dot(from, step), ss = dot(step, step);
        add_roots(ss, fs, ff - range_ * range_);
        const mpf_class af = dot(axis_, from), as = dot(axis_, step), limit = cosine_ * cosine_;
        add_roots(as * as - limit * ss, as * af - limit * fs, af * af - limit * ff);
        for (const mpf_class& t : places)
            if (t >= -trifle() && t <= 1 + trifle() && is_lit(along(from, step, t))) return true;
        return false;
    }

    // What of the light lies in face i's plane crosses no edge: any point of it tells, so its nearest to the apex.
    bool lights_middle_of(std::size_t i) const {
        const Vector& n = normals_[i];
        const mpf_class nn = dot(n, n), na = dot(n, axis_), length = sqrt(nn);
        // Towards the plane.
        const mpf_class side = values_[i] > 0 ? number(-1) : number(1);
        Vector ray;
        if (side * na >= cosine_ * length) {
            for (std::size_t j = 0; j < 3; ++j) ray[j] = side * n[j];
        } else {
            Vector across;
            for (std::size_t j = 0; j < 3; ++j) across[j] = side * (n[j] - na * axis_[j]);
            const mpf_class size = sqrt(dot(across, across));
            if (size < trifle()) return false;
            for (std::size_t j = 0; j < 3; ++j) ray[j] = cosine_ * axis_[j] + sine_ * across[j] / size;
        }
        const mpf_class steepness = dot(n, ray);
        if (abs(steepness) < trifle()) return false;
        const mpf_class t = -values_[i] / steepness;
        if (t < 0) return false;
        const Vector y = along({number(0), number(0), number(0)}, ray, t);
        return is_lit(y) && is_in_cell(y);
    }

    const mpf_class precise_ = number(0);  // first: sets the precision of those that follow
    std::vector<Vector> normals_;
    std::vector<mpf_class> values_;
    Vector axis_;
    mpf_class range_, cosine_, sine_;
};

inline bool meets(const Frustum& cell, const cull::SpotLight& spot) {
    return SpotOracle(cell, spot).meets();
}

}  // namespace crofton::oracle
