// SPDX-License-Identifier: MIT
// Runs the fits of all qualities. Keeps its memory from one fit to the next.
#pragma once
#include <crofton/fit/fit.hpp>

#include "cloud/point_cloud.hpp"
#include "exact/branch_and_bound.hpp"
#include "search/local_search.hpp"
#include "small_set/search.hpp"

namespace crofton::fit {

// Limits of the work of a local search on many points.
struct Effort {
    SmallSetEffort small_set;
    std::size_t triples;  // of k-DOP directions whose extreme points begin the subset
    int searches;         // rounds that search from all frames; later rounds search from the best frame only
    int queries;          // rounds; each asks all points for the support points of one frame
};

class Fitter {
  public:
    template <class Point>
    [[nodiscard]] Result<Obb> fit(std::span<const Point> points, const FitOptions& options);
    template <class Point>
    [[nodiscard]] Result<ExactFit> exact(std::span<const Point> points, const ExactOptions& options);

  private:
    // Checks the points and begins to fit them.
    template <class Point>
    [[nodiscard]] Result<void> assign(std::span<const Point> points);
    // The cloud's support points. Each query may read all points, so its answer is kept until the next points.
    [[nodiscard]] Supports supports(const glm::dmat3& directions);
    // Writes to subset_ the extreme points along `triples` triples of directions of a k-DOP, at most 5.
    void gather_extremes(std::size_t triples);
    // The best for subset_ of the frames that extreme points of subset_ span.
    [[nodiscard]] Candidate best_tetrahedral_frame(const Weights& weights);
    // Returns a better frame of a box that is too thin for float, by a search in double.
    [[nodiscard]] SmallSetSearch::Found finished(const Weights& weights, const SmallSetSearch::Found& found);
    // A locally best frame for subset_, found from `near` or, if that is null, from all orientations.
    [[nodiscard]] SmallSetSearch::Found search_subset(const Weights& weights, const SmallSetEffort& effort,
                                                      const glm::dmat3* near);
    // A frame for all points that is locally best and no worse than `best`. Searches on subset_ and asks all points for
    // the support points of the frame found. Those that subset_ lacks join it, and the search is repeated.
    [[nodiscard]] Candidate local_search(const Weights& weights, const Effort& effort, Candidate best);
    [[nodiscard]] Obb fit_small_set_fast(const Weights& weights);
    [[nodiscard]] Obb fit_small_set_tight(const Weights& weights, const measure::Criterion& criterion);
    [[nodiscard]] Obb fit_large_set(const Weights& weights, const FitOptions& options);
    // The results of a tight and a fast fit of a small set.
    struct Pair {
        SmallSetSearch::Found fast, tight;
    };
    [[nodiscard]] Pair search_pair(const Weights& weights, const SmallSetEffort& effort);
    [[nodiscard]] SearchResult global_search(const Weights& weights, const SearchLimits& limits);
    [[nodiscard]] Obb box_of(const glm::dmat3& axes, const Weights& weights, double tolerance);
    // The weights to search by: those asked for, or those of the area where the volume is 0 in many frames.
    [[nodiscard]] Weights search_weights(const Weights& weights);

    struct CachedSupports {
        glm::dmat3 directions;
        Supports supports;
    };

    PointCloud cloud_;
    Vector<CachedSupports> known_;
    bool forgotten_ = false;  // the interior points, if that helps
    SearchBuffers buffers_;
    Vector<glm::dvec3> subset_;
    Vector<glm::dmat3> frames_;
    SmallSetSearch small_set_search_;
};

}  // namespace crofton::fit
