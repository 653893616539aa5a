// SPDX-License-Identifier: MIT
#include "mesh_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>

#include "least_rectangle.hpp"
#include "symmetric_eigen.hpp"

namespace crofton::mesh {
namespace {

float float_above(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                                : rounded;
}

// The box with this frame. Coordinates along axes that are orthonormal only to 3e-7 differ from those in the exact
// parallelepiped by that share of their size. A margin of 1e-6 of all half extents covers it and the float rounding.
MeshBox box_with(std::span<const glm::vec3> points, const glm::dmat3& frame) {
    MeshBox box{};
    glm::dvec3 axis[3], low(kInfinity), high(-kInfinity);
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 rounded(frame[k]);
        axis[k] = glm::dvec3(rounded);
        for (int i = 0; i < 3; ++i) box.axes[k][i] = rounded[i];
    }
    const glm::dmat3 rows(axis[0].x, axis[1].x, axis[2].x, axis[0].y, axis[1].y, axis[2].y, axis[0].z, axis[1].z,
                          axis[2].z);
    for (const glm::vec3& p : points) {
        const glm::dvec3 along = rows * glm::dvec3(p);
        low = glm::min(low, along);
        high = glm::max(high, along);
    }
    const glm::dvec3 middle = 0.5 * (low + high);
    const glm::vec3 center(axis[0] * middle.x + axis[1] * middle.y + axis[2] * middle.z);
    const glm::dvec3 along = rows * glm::dvec3(center);
    const glm::dvec3 half = glm::max(high - along, along - low);
    const double margin = 1e-6 * (half.x + half.y + half.z) + 1e-37;
    for (int k = 0; k < 3; ++k) {
        box.center[k] = center[k];
        box.half[k] = float_above(half[k] + margin);
    }
    return box;
}

// Principal axes, that of the least spread first.
glm::dmat3 principal_axes(std::span<const glm::vec3> points, int sweeps) {
    const glm::dmat3 covariance = covariance_of(points.size(), [&](std::size_t i) { return points[i]; });
    glm::dmat3 frame = eigenvectors(covariance, sweeps);
    std::array<double, 3> spread;
    for (int k = 0; k < 3; ++k) spread[static_cast<std::size_t>(k)] = glm::dot(frame[k], covariance * frame[k]);
    const auto put_in_order = [&](int i, int j) {
        double &a = spread[static_cast<std::size_t>(i)], &b = spread[static_cast<std::size_t>(j)];
        if (b < a) std::swap(a, b), std::swap(frame[i], frame[j]);
    };
    put_in_order(0, 1);
    put_in_order(1, 2);
    put_in_order(0, 1);
    return frame;
}

// A turn by an angle; `half` is the tangent of its half. Nothing is left to a library's sine: the same bits everywhere.
struct Turn {
    double c = 1.0, s = 0.0;
    static constexpr Turn by(double half) {
        return {(1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half)};
    }
};

constexpr Turn operator*(const Turn& a, const Turn& b) {
    return {a.c * b.c - a.s * b.s, a.c * b.s + a.s * b.c};
}

// Sixteen angles, as the kernel takes them too.
struct Turns {
    std::array<Turn, kAngles> turns;
    Angles angles{};

    constexpr Turns() = default;
    constexpr Turns(Turn turn, const Turn& step) {
        for (std::size_t i = 0; i < kAngles; ++i) {
            turns[i] = turn;
            angles.cosine[i] = static_cast<float>(turn.c);
            angles.sine[i] = static_cast<float>(turn.s);
            turn = turn * step;
        }
    }
};

// Those of a quarter turn, and those around each of them.
struct TurnTable {
    Turns coarse;
    std::array<Turns, kAngles> fine;
    constexpr TurnTable() {
        constexpr double kCoarse = 0.049126849769467254, kFine = 0.006136000157623402;  // tan of half 90°/16, 90°/128
        coarse = Turns(Turn(), Turn::by(kCoarse));
        for (std::size_t i = 0; i < kAngles; ++i)
            fine[i] = Turns(coarse.turns[i] * Turn::by(-kCoarse), Turn::by(kFine));
    }
};
constexpr TurnTable kTurns;

}  // namespace

// Among sixteen angles of a quarter turn, then among sixteen around the best of these.
void MeshBoxFitter::turn(std::span<const glm::vec3> points, int axis, glm::dmat3& frame) {
    const glm::dvec3 x = frame[(axis + 1) % 3], y = frame[(axis + 2) % 3];
    const glm::vec3 along(x), across(y), origin = points.front();
    for (std::size_t p = 0; p < points.size(); ++p) {
        const glm::vec3 from = points[p] - origin;
        u_[p] = from.x * along.x + from.y * along.y + from.z * along.z;
        v_[p] = from.x * across.x + from.y * across.y + from.z * across.z;
    }
    const auto best_of = [&](const Angles& angles) {
        return least_rectangle(u_.data(), v_.data(), points.size(), angles);
    };
    const Turns& around = kTurns.fine[best_of(kTurns.coarse.angles)];
    const Turn& best = around.turns[best_of(around.angles)];
    frame[(axis + 1) % 3] = best.c * x + best.s * y;
    frame[(axis + 2) % 3] = best.c * y - best.s * x;
}

MeshBox MeshBoxFitter::fit(std::span<const glm::vec3> points, MeshBoxes boxes, bool by_all) {
    if (boxes == MeshBoxes::least_perimeter)
        if (const auto box = fit::fit_obb(points)) return box_with(points, glm::dmat3(box->axes));
    sample_.clear();
    const std::size_t step = by_all ? 1 : sample_step(points.size());
    for (std::size_t i = 0; i < points.size(); i += step) sample_.push_back(points[i]);
    glm::dmat3 frame = principal_axes(sample_, by_all || boxes == MeshBoxes::principal_axes ? 4 : 2);
    if (boxes == MeshBoxes::small_perimeter) {
        u_.resize(sample_.size());
        v_.resize(sample_.size());
        for (int axis = 0; axis < 3; ++axis) turn(sample_, axis, frame);
    }
    return box_with(points, frame);
}

}  // namespace crofton::mesh
