// SPDX-License-Identifier: MIT
// The local search on a small set of points: a cluster, or the extreme points of a mesh. Works in float on sixteen
// frames at a time.
#pragma once
#include <span>

#include "search/local_search.hpp"
#include "small_set/kernels.hpp"

namespace crofton::fit {

// Limits of the work of a search.
struct SmallSetEffort {
    std::size_t finalists;  // frames that are improved to a local optimum
    int turns;              // about axes, of each
    int rounds;             // of slides along flush edges, after the turns
};

class SmallSetSearch {
  public:
    struct Found {
        glm::dmat3 axes;
        glm::dvec3 extent;  // widths along the axes, rounded to float
        double value;
    };

    // Requires points in canonical order with coordinates within [−1, 1], which live until the next call.
    void assign(std::span<const glm::dvec3> points);
    // The best frame found.
    [[nodiscard]] Found search(const Weights& weights, const SmallSetEffort& effort);
    // As search with `effort`, begun with what a search with `little` effort of one finalist finds, which goes to
    // `first`: never worse than that.
    [[nodiscard]] Found search_further(const Weights& weights, const SmallSetEffort& effort,
                                       const SmallSetEffort& little, Found& first);
    // The best frame found from a given one.
    [[nodiscard]] Found improve(const Weights& weights, const SmallSetEffort& effort, const glm::dmat3& frame);

  private:
    // The points that were extreme in some direction so far: only these are looked at until all points are asked again.
    struct Subset {
        Vector<float> x, y, z;
        Vector<std::uint32_t> indices;
    };
    void mark(const float* indices, std::size_t count);
    void update_subset();
    void gather_extremes();
    void find_starts();
    void set(const Weights& weights);
    [[nodiscard]] Found search_starts(const SmallSetEffort& effort, const SmallSetEffort* little, Found* first);
    [[nodiscard]] Found descend(const SmallSetEffort& effort, Candidate candidate);
    [[nodiscard]] Found evaluate(const glm::dmat3& frame);
    void turn_until_idle(Candidate& candidate, int turns);
    // True if the value fell.
    bool slide(Candidate& candidate);
    bool slide_along(const glm::dmat3& frame, const FlushEdge& first, const FlushEdge& second, Candidate& best);
    void find_flush_edges(const glm::dmat3& frame);
    [[nodiscard]] kernels::SmallSet all_points() const { return {x_.data(), y_.data(), z_.data(), points_.size()}; }
    [[nodiscard]] kernels::SmallSet subset_points() const {
        return {subset_.x.data(), subset_.y.data(), subset_.z.data(), subset_.indices.size()};
    }

    std::span<const glm::dvec3> points_;
    Weights weights_;
    kernels::FloatWeights float_weights_{};
    Vector<float> x_, y_, z_, scratch_;
    Vector<unsigned char> marked_;
    bool grown_ = false;
    Subset subset_;
    kernels::FrameLanes starts_{};
    Vector<FlushEdge> edges_;
};

}  // namespace crofton::fit
