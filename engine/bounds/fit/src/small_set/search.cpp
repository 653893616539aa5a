// SPDX-License-Identifier: MIT
#include "small_set/search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>

#include "search/root_cell.hpp"

namespace crofton::fit {
namespace {

using kernels::kLanes;

constexpr std::size_t kFrames = 256;

// Frames spread evenly over all orientations. By the symmetries of a box these are the Rodrigues vectors of a truncated
// cube, filled by the generalised golden ratio's sequence (Roberts 2018). Frames of one lane lie near each other.
struct Frames {
    alignas(64) float axes[9][kFrames];
    std::array<glm::dmat3, kFrames> exact;

    Frames() {
        std::array<glm::dvec3, kFrames> rodrigues;
        constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
        double at = 0.5;
        for (glm::dvec3& c : rodrigues) {
            do {
                for (int k = 0; k < 3; ++k)
                    c[k] = (2.0 * (at * kStep[k] - std::floor(at * kStep[k])) - 1.0) * kRootCellHalfSize;
                at += 1.0;
            } while (std::abs(c.x) + std::abs(c.y) + std::abs(c.z) > 1.0);
        }
        // Each lane begins with one of the first kLanes vectors and takes, row by row, the nearest that is left.
        for (std::size_t i = kLanes; i < kFrames; ++i) {
            const glm::dvec3 center = rodrigues[i % kLanes];
            std::size_t nearest = i;
            for (std::size_t j = i + 1; j < kFrames; ++j)
                if (glm::distance(rodrigues[j], center) < glm::distance(rodrigues[nearest], center)) nearest = j;
            std::swap(rodrigues[i], rodrigues[nearest]);
        }
        for (std::size_t i = 0; i < kFrames; ++i) {
            const double x = rodrigues[i].x, y = rodrigues[i].y, z = rodrigues[i].z;
            const double s = 1.0 / (1.0 + x * x + y * y + z * z);
            exact[i] = glm::dmat3(glm::dvec3(1.0 + x * x - y * y - z * z, 2.0 * (x * y + z), 2.0 * (z * x - y)) * s,
                                  glm::dvec3(2.0 * (x * y - z), 1.0 + y * y - x * x - z * z, 2.0 * (y * z + x)) * s,
                                  glm::dvec3(2.0 * (z * x + y), 2.0 * (y * z - x), 1.0 + z * z - x * x - y * y) * s);
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j)
                    axes[static_cast<std::size_t>(3 * k + j)][i] = static_cast<float>(exact[i][k][j]);
        }
    }
};

const Frames& frames() {
    static const Frames table;
    return table;
}

// Half of the directions whose extreme points begin the subset: spread evenly (Fibonacci's spiral).
constexpr std::size_t kDirectionSets = 2;
struct DirectionTable {
    kernels::Directions sets[kDirectionSets];

    DirectionTable() {
        constexpr std::size_t kCount = kDirectionSets * kLanes;
        for (std::size_t i = 0; i < kCount; ++i) {
            const double z = (static_cast<double>(i) + 0.5) / static_cast<double>(kCount), r = std::sqrt(1.0 - z * z);
            const double angle = 2.399963229728653 * static_cast<double>(i);
            kernels::Directions& set = sets[i / kLanes];
            const glm::dvec2 around = r * cosine_sine(angle);
            set.x[i % kLanes] = static_cast<float>(around.x);
            set.y[i % kLanes] = static_cast<float>(around.y);
            set.z[i % kLanes] = static_cast<float>(z);
        }
    }
};

const DirectionTable& directions() {
    static const DirectionTable table;
    return table;
}

constexpr double kNoValue = 1e30;
constexpr float kFlushInFloat = 3e-6f;  // points this near a face lie on it: above the rounding of float coordinates
constexpr double kShortEdge = 1e-4;     // a shorter edge has no direction that could be trusted
constexpr double kGain = 2e-7;          // relative; a smaller gain may be rounding

// Whether two frames lie within about 15 degrees, up to the symmetries of a box.
bool alike(const glm::dmat3& a, const glm::dmat3& b) {
    for (int i = 0; i < 3; ++i) {
        double nearest = 0.0;
        for (int j = 0; j < 3; ++j) nearest = std::max(nearest, std::abs(glm::dot(a[i], b[j])));
        if (nearest < 0.966) return false;
    }
    return true;
}

void to_floats(const glm::dvec3& v, float out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

}  // namespace

void SmallSetSearch::assign(std::span<const glm::dvec3> points) {
    points_ = points;
    const std::size_t padded = (points.size() + kLanes - 1) / kLanes * kLanes;
    for (Vector<float>* list : {&x_, &y_, &z_, &subset_.x, &subset_.y, &subset_.z}) list->resize(padded);
    for (std::size_t i = 0; i < padded; ++i) {
        const glm::dvec3& p = points[i < points.size() ? i : 0];
        x_[i] = static_cast<float>(p.x);
        y_[i] = static_cast<float>(p.y);
        z_[i] = static_cast<float>(p.z);
    }
    marked_.assign(padded, 0);
    scratch_.resize(2 * kLanes * padded);
}

void SmallSetSearch::mark(const float* indices, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        unsigned char& mark = marked_[static_cast<std::size_t>(static_cast<int>(indices[i]))];
        grown_ = grown_ || mark == 0;
        mark = 1;
    }
}

void SmallSetSearch::update_subset() {
    if (!grown_) return;
    grown_ = false;
    subset_.indices.clear();
    for (std::size_t i = 0; i < points_.size(); ++i)
        if (marked_[i] != 0) subset_.indices.push_back(static_cast<std::uint32_t>(i));
    const std::size_t size = subset_.indices.size(), padded = (size + kLanes - 1) / kLanes * kLanes;
    for (std::size_t i = 0; i < padded; ++i) {
        const std::size_t from = subset_.indices[i < size ? i : 0];
        subset_.x[i] = x_[from];
        subset_.y[i] = y_[from];
        subset_.z[i] = z_[from];
    }
}

void SmallSetSearch::gather_extremes() {
    float ends[2 * kLanes];
    for (const kernels::Directions& set : directions().sets) {
        kernels::find_extremes(all_points(), set, ends, ends + kLanes);
        mark(ends, 2 * kLanes);
    }
    update_subset();
}

void SmallSetSearch::find_starts() {
    float values[kLanes], rows[kLanes];
    kernels::best_frames(subset_points(), float_weights_, frames().axes[0], kFrames, values, rows);
    for (std::size_t i = 0; i < kLanes; ++i)
        for (std::size_t j = 0; j < 9; ++j)
            starts_.axes[j][i] = frames().axes[j][static_cast<std::size_t>(rows[i]) * kLanes + i];
    kernels::descend_frames(subset_points(), float_weights_, scratch_.data(), starts_);
    float supports[6 * kLanes];
    kernels::supports_of_frames(all_points(), float_weights_, starts_, supports);
    mark(supports, 6 * kLanes);
    update_subset();
}

void SmallSetSearch::turn_until_idle(Candidate& candidate, int turns) {
    kernels::Turn turn;
    for (int step = 0, idle = 0; idle < 2 && step < turns; ++step) {
        const int k = step % 3;
        glm::dvec3 &axis = candidate.axes[k], &right = candidate.axes[(k + 1) % 3], &up = candidate.axes[(k + 2) % 3];
        to_floats(axis, turn.axis);
        to_floats(right, turn.right);
        to_floats(up, turn.up);
        kernels::turn_frame(subset_points(), float_weights_, scratch_.data(), turn);
        const double value = static_cast<double>(turn.value);
        if (!(value < candidate.value * (1.0 - kGain))) {
            ++idle;
            continue;
        }
        idle = 0;
        candidate.value = value;
        right = glm::normalize(static_cast<double>(turn.cosine) * right + static_cast<double>(turn.sine) * up);
        up = glm::cross(axis, right);
    }
}

void SmallSetSearch::find_flush_edges(const glm::dmat3& frame) {
    edges_.clear();
    float axes[9];
    for (int k = 0; k < 3; ++k) to_floats(frame[k], axes + 3 * k);
    kernels::FlushSide sides[6];
    kernels::flush_points(subset_points(), axes, kFlushInFloat, scratch_.data(), sides);
    for (std::size_t side = 0; side < 6; ++side)
        for (std::size_t i = 0; i < sides[side].count; ++i)
            for (std::size_t j = i + 1; j < sides[side].count; ++j) {
                const glm::dvec3 d =
                    points_[subset_.indices[sides[side].indices[j]]] - points_[subset_.indices[sides[side].indices[i]]];
                if (const double length = glm::length(d); length > kShortEdge)
                    edges_.push_back({static_cast<int>(side / 2), d / length});
            }
}

bool SmallSetSearch::slide_along(const glm::dmat3& frame, const FlushEdge& first, const FlushEdge& second,
                                 Candidate& best) {
    glm::dvec3 start = frame[first.axis];
    start = glm::normalize(start - glm::dot(start, first.direction) * first.direction);
    const glm::dvec3 across = glm::cross(first.direction, start);
    kernels::Slides slides;
    to_floats(start, slides.start);
    to_floats(across, slides.across);
    to_floats(second.direction, slides.edge);
    for (std::size_t i = 0; i < kLanes; ++i)
        slides.t[i] = (i % 2 == 0 ? 0.08f : -0.08f) / static_cast<float>(std::size_t{1} << (i / 2));
    std::size_t least = 0;
    const auto evaluate_slides = [&] {
        kernels::values_of_slides(subset_points(), float_weights_, slides);
        least = 0;
        for (std::size_t i = 1; i < kLanes; ++i) least = slides.values[i] < slides.values[least] ? i : least;
    };
    evaluate_slides();
    if (!(static_cast<double>(slides.values[least]) < best.value * (1.0 - kGain))) return false;
    float from = 0.5f * slides.t[least], to = 2.0f * slides.t[least], t = slides.t[least], value = slides.values[least];
    for (int pass = 0; pass < 3; ++pass) {
        const float step = (to - from) / static_cast<float>(kLanes + 1);
        for (std::size_t i = 0; i < kLanes; ++i) slides.t[i] = from + static_cast<float>(i + 1) * step;
        evaluate_slides();
        if (slides.values[least] < value) {
            value = slides.values[least];
            t = slides.t[least];
        }
        from = t - step;
        to = t + step;
    }
    const glm::dvec3 n = glm::normalize(start + static_cast<double>(t) * across);
    const glm::dvec3 m = glm::normalize(glm::cross(second.direction, n));
    best = {glm::dmat3(n, m, glm::cross(n, m)), static_cast<double>(value)};
    return true;
}

bool SmallSetSearch::slide(Candidate& candidate) {
    find_flush_edges(candidate.axes);
    const glm::dmat3 frame = candidate.axes;
    bool better = false;
    for (const FlushEdge& first : edges_)
        for (const FlushEdge& second : edges_)
            if (first.axis < second.axis) better = slide_along(frame, first, second, candidate) || better;
    return better;
}

SmallSetSearch::Found SmallSetSearch::search(const Weights& weights, const SmallSetEffort& effort) {
    set(weights);
    return search_starts(effort, nullptr, nullptr);
}

SmallSetSearch::Found SmallSetSearch::search_further(const Weights& weights, const SmallSetEffort& effort,
                                                     const SmallSetEffort& little, Found& first) {
    set(weights);
    return search_starts(effort, &little, &first);
}

SmallSetSearch::Found SmallSetSearch::search_starts(const SmallSetEffort& effort, const SmallSetEffort* little,
                                                    Found* first) {
    gather_extremes();
    find_starts();
    Found best{glm::dmat3(1.0), glm::dvec3(0.0), kNoValue};
    std::array<glm::dmat3, kLanes> tried;
    std::size_t tries = 0;
    for (unsigned remaining = (1u << kLanes) - 1u; remaining != 0 && tries < effort.finalists;) {
        std::size_t next = static_cast<std::size_t>(std::countr_zero(remaining));
        for (std::size_t i = next + 1; i < kLanes; ++i)
            if ((remaining >> i & 1u) != 0 && starts_.values[i] < starts_.values[next]) next = i;
        remaining &= ~(1u << next);
        glm::dmat3 frame;
        for (std::size_t j = 0; j < 9; ++j)
            frame[static_cast<int>(j / 3)][static_cast<int>(j % 3)] = static_cast<double>(starts_.axes[j][next]);
        if (std::any_of(tried.begin(), tried.begin() + tries, [&](const glm::dmat3& a) { return alike(a, frame); }))
            continue;
        tried[tries++] = frame;
        Candidate start{frame, static_cast<double>(starts_.values[next])};
        if (tries == 1 && little != nullptr) {
            *first = best = descend(*little, start);
            start = {best.axes, best.value};
        }
        const Found found = descend(effort, start);
        if (found.value < best.value) best = found;
    }
    return best;
}

SmallSetSearch::Found SmallSetSearch::improve(const Weights& weights, const SmallSetEffort& effort,
                                              const glm::dmat3& frame) {
    set(weights);
    gather_extremes();
    const Found there = evaluate(frame);
    update_subset();
    const Found found = descend(effort, {frame, there.value});
    return found.value < there.value ? found : there;
}

void SmallSetSearch::set(const Weights& weights) {
    weights_ = weights;
    float_weights_ = {static_cast<float>(weights.product), static_cast<float>(weights.pairs),
                      static_cast<float>(weights.sum)};
}

// Improves on the subset, then asks all points; again, with the support points that were missing, until none is.
SmallSetSearch::Found SmallSetSearch::descend(const SmallSetEffort& effort, Candidate candidate) {
    Found best{glm::dmat3(1.0), glm::dvec3(0.0), kNoValue};
    for (int round = 0; round < 3; ++round) {
        turn_until_idle(candidate, effort.turns);
        for (int slides = 0; slides < effort.rounds && slide(candidate); ++slides) {
        }
        const Found found = evaluate(candidate.axes);
        if (found.value < best.value) best = found;
        if (!grown_) break;
        update_subset();
        candidate.value = found.value;
    }
    return best;
}

// The frame's value for all points, whose support points join the subset.
SmallSetSearch::Found SmallSetSearch::evaluate(const glm::dmat3& frame) {
    float axes[9], supports[6], widths[3];
    for (int k = 0; k < 3; ++k) to_floats(frame[k], axes + 3 * k);
    kernels::supports_of_frame(all_points(), axes, supports, widths);
    mark(supports, 6);
    const glm::dvec3 extent(glm::vec3(widths[0], widths[1], widths[2]));
    return {frame, extent, weights_(extent.x, extent.y, extent.z)};
}

}  // namespace crofton::fit
