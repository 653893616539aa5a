// Everything a fit needs besides the points; memory is kept from one fit to the next.
#pragma once
#include <crofton/fit/exact.hpp>
#include <crofton/fit/fit.hpp>

#include "branch_and_bound.hpp"
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
    // Extreme points along the directions of a 26-DOP, and frames built from them, best first.
    void gather(const Weights& weights, std::size_t frames);
    [[nodiscard]] Candidate local(const Weights& weights, std::size_t starts, int rounds, bool slide);
    [[nodiscard]] SearchResult global(const Weights& weights, const SearchLimits& limits);
    [[nodiscard]] Weights effective(const Weights& weights);

    PointCloud cloud_;
    SearchBuffers buffers_;
    Vector<glm::dvec3> subset_;
    Vector<glm::dmat3> frames_;
    Vector<Candidate> candidates_;
};

}  // namespace crofton::fit
