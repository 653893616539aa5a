// SPDX-License-Identifier: MIT
#include "k_dop_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "rotation_cells.hpp"

namespace crofton::study {
namespace {

constexpr double kParallel = 1e-9;

// The rotations of a cube that give other sets of directions: where the directions are a cube's, one does.
Vector<glm::dmat3> distinct_turns(std::span<const glm::dvec3> directions) {
    Vector<glm::dmat3> turns;
    const auto same_set = [&](const glm::dmat3& a, const glm::dmat3& b) {
        return std::all_of(directions.begin(), directions.end(), [&](const glm::dvec3& d) {
            return std::any_of(directions.begin(), directions.end(),
                               [&](const glm::dvec3& e) { return glm::length(glm::cross(a * d, b * e)) < kParallel; });
        });
    };
    for (unsigned order = 0; order < 6; ++order)
        for (unsigned signs = 0; signs < 8; ++signs) {
            constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
            glm::dmat3 turn(0.0);
            for (int k = 0; k < 3; ++k) turn[k][kOrders[order][k]] = (signs >> k & 1u) != 0 ? -1.0 : 1.0;
            if (glm::dot(turn[0], glm::cross(turn[1], turn[2])) < 0.0) continue;
            if (std::none_of(turns.begin(), turns.end(), [&](const glm::dmat3& t) { return same_set(t, turn); }))
                turns.push_back(turn);
        }
    return turns;
}

struct TurnCell {
    std::size_t turn;
    glm::dvec3 center;
    double half, bound;
};

}  // namespace

SlabPolytopes::SlabPolytopes(std::span<const glm::dvec3> directions) {
    for (const glm::dvec3& d : directions) normals_.insert(normals_.end(), {d, -d});
    for (std::size_t i = 0; i < normals_.size(); ++i)
        for (std::size_t j = i + 1; j < normals_.size(); ++j) {
            const glm::dvec3 &a = normals_[i], &b = normals_[j], across = glm::cross(a, b);
            const double sine = glm::length(across), cosine = glm::dot(a, b);
            if (sine < kParallel) continue;
            const double scale = 1.0 / (sine * sine);
            lines_.push_back({i, j, across / sine, (a - cosine * b) * scale, (b - cosine * a) * scale, cosine, sine,
                              arc_tangent(sine, cosine)});
        }
}

double SlabPolytopes::edge_length(const Line& line, std::span<const double> offsets) const {
    const glm::dvec3 base = offsets[line.i] * line.from_i + offsets[line.j] * line.from_j;
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < normals_.size(); ++k) {
        if (k == line.i || k == line.j) continue;
        const double slope = glm::dot(normals_[k], line.along), room = offsets[k] - glm::dot(normals_[k], base);
        if (slope > kParallel)
            high = std::min(high, room / slope);
        else if (slope < -kParallel)
            low = std::max(low, room / slope);
        else if (room < 0.0)
            return 0.0;
        if (low >= high) return 0.0;
    }
    return high - low;
}

measure::IntrinsicVolumes SlabPolytopes::operator()(std::span<const double> offsets) const {
    measure::IntrinsicVolumes result;
    const auto add_face = [&](std::size_t i, double area) {
        result.area += area;
        result.volume += offsets[i] * area / 3.0;
    };
    for (const Line& line : lines_) {
        const double length = edge_length(line, offsets);
        if (length == 0.0) continue;
        const double b_i = offsets[line.i], b_j = offsets[line.j];
        // Triangles of the edge and the foot of the origin on each face.
        add_face(line.i, 0.5 * length * (b_j - line.cosine * b_i) / line.sine);
        add_face(line.j, 0.5 * length * (b_i - line.cosine * b_j) / line.sine);
        result.mean_curvature += 0.5 * length * line.angle;
    }
    result.volume = std::max(0.0, result.volume);
    result.area = std::max(0.0, result.area);
    return result;
}

KDopRotations::KDopRotations(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                             const measure::Criterion& criterion)
    : points_(points), polytopes_(directions), criterion_(criterion), offsets_(polytopes_.faces()) {
    for (const glm::dvec3& p : points_) size_ = std::max(size_, glm::length(p));
    support_.resize(polytopes_.faces());
}

double KDopRotations::value(const glm::dmat3& rotation) {
    find_supports(rotation);
    for (std::size_t f = 0; f < offsets_.size(); ++f)
        offsets_[f] = lowered(f, glm::dot(support_[f], rotation * polytopes_.normal(f)));
    return criterion_(polytopes_(offsets_));
}

double KDopRotations::bound(const glm::dvec3& center, double half, const glm::dmat3& rotation) {
    const auto [turns, longest] = corner_turns(center, half);
    // dot(turned n, p) beside its linear part: (t × (t × n))·p is at least −t² (|p| + n·p) / 2.
    const double part = longest * longest / (1.0 + longest * longest);
    measure::IntrinsicVolumes least;
    for (unsigned c = 0; c < 8; ++c) {
        for (std::size_t f = 0; f < offsets_.size(); ++f) {
            const glm::dvec3 n = rotation * polytopes_.normal(f), &p = support_[f];
            const double linear = glm::dot(n, p) + 2.0 * glm::dot(turns[c], glm::cross(n, p));
            const double rest = part * ((1.0 + 2.0 * longest) * glm::length(p) + glm::dot(n, p));
            offsets_[f] = lowered(f, linear - rest);
        }
        const measure::IntrinsicVolumes v = polytopes_(offsets_);
        if (c == 0) least = v;
        least.volume = std::min(least.volume, v.volume);
        least.area = std::min(least.area, v.area);
        least.mean_curvature = std::min(least.mean_curvature, v.mean_curvature);
    }
    return criterion_(least) * (1.0 - 1e-9);
}

double KDopRotations::lowered(std::size_t face, double offset) const {
    const double part = static_cast<double>(face) * 0.6180339887498949;
    return offset - 1e-9 * size_ * (1.0 + part - std::floor(part));
}

void KDopRotations::find_supports(const glm::dmat3& rotation) {
    for (std::size_t f = 0; f < support_.size(); ++f) {
        const glm::dvec3 n = rotation * polytopes_.normal(f);
        double most = -std::numeric_limits<double>::infinity();
        for (const glm::dvec3& p : points_)
            if (const double along = glm::dot(n, p); along > most) most = along, support_[f] = p;
    }
}

KDopSearch search_rotations(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                            const measure::Criterion& criterion, double known, double tolerance,
                            std::uint64_t max_cells) {
    const Vector<glm::dmat3> turns = distinct_turns(directions);
    KDopRotations rotations(points, directions, criterion);
    KDopSearch result;
    result.value = known;
    CellQueue<TurnCell> queue;
    const auto add = [&](std::size_t turn, const glm::dvec3& center, double half, double above) {
        const glm::dmat3 rotation = rotation_of(center) * turns[turn];
        if (const double value = rotations.value(rotation); value < result.value * (1.0 - 1e-8))
            result.value = value, result.rotation = rotation;
        queue.add({turn, center, half, std::max(above, rotations.bound(center, half, rotation))}, result.value);
    };
    for (std::size_t turn = 0; turn < turns.size(); ++turn) add(turn, glm::dvec3(0.0), kHalfOfAllRotations, 0.0);
    while (queue.cells() < max_cells && queue.has_below(result.value * (1.0 - tolerance))) {
        const TurnCell cell = queue.take();
        divide(cell.center, cell.half, [&](const glm::dvec3& c, double half) { add(cell.turn, c, half, cell.bound); });
    }
    result.cells = queue.cells();
    result.lower_bound = queue.lower_bound(result.value);
    return result;
}

}  // namespace crofton::study
