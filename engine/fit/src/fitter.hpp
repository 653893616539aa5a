// Everything a fit needs besides the points; memory is kept from one fit to the next.
#pragma once
#include <crofton/fit/exact.hpp>
#include <crofton/fit/fit.hpp>

#include "branch_and_bound.hpp"
#include "few_search.hpp"
#include "local_search.hpp"
#include "point_cloud.hpp"

namespace crofton::fit {

class Fitter {
  public:
    template <class Point>
    [[nodiscard]] Result<Obb> fit(std::span<const Point> points, const Options& options);
    template <class Point>
    [[nodiscard]] Result<ExactFit> exact(std::span<const Point> points, const ExactOptions& options);

  private:
    // Extreme points along the directions of a k-DOP, and frames built from them, best first.
    void gather(const Weights& weights, std::size_t frames, std::size_t directions = 5);
    // A good frame for the points of subset_, or for all: few extreme points are searched, and grow by the support
    // points of the frames found, `queries` times at most.
    [[nodiscard]] Candidate local_of_subset(const Weights& weights, const FewEffort& effort);
    [[nodiscard]] Candidate local(const Weights& weights, const FewEffort& effort, int queries);
    [[nodiscard]] Obb fit_few(const Weights& weights, const FewEffort& effort);
    [[nodiscard]] SearchResult global(const Weights& weights, const SearchLimits& limits);
    [[nodiscard]] Obb box_of(const glm::dmat3& axes, const Weights& weights, double tolerance);
    [[nodiscard]] Weights effective(const Weights& weights);

    PointCloud cloud_;
    SearchBuffers buffers_;
    Vector<glm::dvec3> subset_;
    Vector<glm::dmat3> frames_;
    Vector<Candidate> candidates_;
    FewSearch few_;
};

}  // namespace crofton::fit
