// Everything a fit needs besides the points; memory is kept from one fit to the next.
#pragma once
#include <crofton/fit/exact.hpp>
#include <crofton/fit/fit.hpp>

#include "branch_and_bound.hpp"
#include "few_search.hpp"
#include "local_search.hpp"
#include "point_cloud.hpp"

namespace crofton::fit {

// How much a local search on many points may cost.
struct Effort {
    FewEffort few;
    std::size_t triples;  // of directions that give the first extreme points
    int searches;         // from all frames; after them only from the best
    int queries;          // times it may ask all points for the support points of a frame
};

class Fitter {
  public:
    template <class Point>
    [[nodiscard]] Result<Obb> fit(std::span<const Point> points, const Options& options);
    template <class Point>
    [[nodiscard]] Result<ExactFit> exact(std::span<const Point> points, const ExactOptions& options);

  private:
    // Into subset_: extreme points along `triples` triples of the directions of a k-DOP, at most 5.
    void gather(std::size_t triples);
    // Of the frames built from subset_, the best for it.
    [[nodiscard]] Candidate rough(const Weights& weights);
    // A good frame for subset_; near a given one, if any.
    [[nodiscard]] FewSearch::Found search_subset(const Weights& weights, const FewEffort& effort,
                                                 const glm::dmat3* near);
    // A good frame for all: few extreme points are searched, and grow by the support points of the frames found.
    [[nodiscard]] Candidate local(const Weights& weights, const Effort& effort);
    [[nodiscard]] Obb fit_few(const Weights& weights, const FewEffort& effort);
    [[nodiscard]] SearchResult global(const Weights& weights, const SearchLimits& limits);
    [[nodiscard]] Obb box_of(const glm::dmat3& axes, const Weights& weights, double tolerance);
    [[nodiscard]] Weights effective(const Weights& weights);

    PointCloud cloud_;
    SearchBuffers buffers_;
    Vector<glm::dvec3> subset_;
    Vector<glm::dmat3> frames_;
    FewSearch few_;
};

}  // namespace crofton::fit
