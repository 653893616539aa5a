// The local search on few points: a cluster, or the extreme points of a mesh. Works in float, sixteen frames at a time.
#pragma once
#include <span>

#include "few_kernels.hpp"
#include "local_search.hpp"

namespace crofton::fit {

// How much a search may cost.
struct FewEffort {
    std::size_t finalists;  // frames it descends from
    int turns;              // about axes, of each
    int rounds;             // of slides along flush edges after them
};

class FewSearch {
  public:
    struct Found {
        glm::dmat3 axes;
        glm::dvec3 extent;  // widths along the axes, rounded to float
        double value;
    };

    // Takes points in canonical order; coordinates within [−1, 1]. Reads them until the next call.
    void assign(std::span<const glm::dvec3> points);
    // The best frame found.
    [[nodiscard]] Found search(const Weights& weights, const FewEffort& effort);
    // The best frame near a given one.
    [[nodiscard]] Found improve(const Weights& weights, const FewEffort& effort, const glm::dmat3& frame);

  private:
    // Those of all points that matter: extreme in some direction asked for so far.
    struct Subset {
        Vector<float> x, y, z;
        Vector<std::uint32_t> indices;
    };
    void mark(const float* indices, std::size_t count);
    void collect();
    void gather();
    void find_starts();
    void set(const Weights& weights);
    [[nodiscard]] Found descend(const FewEffort& effort, Candidate candidate);
    [[nodiscard]] Found look(const glm::dmat3& frame);
    void turn_to_rest(Candidate& candidate, int turns);
    // True if the value fell.
    bool slide(Candidate& candidate);
    bool slide_along(const glm::dmat3& frame, const FlushEdge& first, const FlushEdge& second, Candidate& best);
    void find_flush_edges(const glm::dmat3& frame);
    [[nodiscard]] kernels::FewPoints all() const { return {x_.data(), y_.data(), z_.data(), points_.size()}; }
    [[nodiscard]] kernels::FewPoints view() const {
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
