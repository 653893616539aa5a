// Everything a fit needs besides the points; memory is kept from one fit to the next.
#pragma once
#include <crofton/fit/exact.hpp>
#include <crofton/fit/fit.hpp>

#include "branch_and_bound.hpp"
#include "local_search.hpp"
#include "point_cloud.hpp"

namespace crofton::fit {

// How much a local search may cost.
struct Effort {
    std::size_t directions;  // triples of directions whose extreme points it begins with, at most 5
    std::size_t starts;      // frames it descends from
    int queries;             // times it may ask the whole cloud for the support points of a frame
    bool slide;              // whether it polishes
};

class Fitter {
  public:
    template <class Point>
    [[nodiscard]] Result<Obb> fit(std::span<const Point> points, const Options& options);
    template <class Point>
    [[nodiscard]] Result<ExactFit> exact(std::span<const Point> points, const ExactOptions& options);

  private:
    // Extreme points along the directions of a k-DOP, and frames built from them, best first.
    void gather(const Weights& weights, std::size_t frames, std::size_t directions = 5);
    [[nodiscard]] Candidate local(const Weights& weights, const Effort& effort);
    [[nodiscard]] SearchResult global(const Weights& weights, const SearchLimits& limits);
    [[nodiscard]] Obb box_of(const glm::dmat3& axes, const Weights& weights, double tolerance);
    [[nodiscard]] Weights effective(const Weights& weights);

    PointCloud cloud_;
    SearchBuffers buffers_;
    Vector<glm::dvec3> subset_;
    Vector<glm::dmat3> frames_;
    Vector<Candidate> candidates_;
    Vector<std::size_t> fresh_;
    Vector<unsigned char> polished_;
};

}  // namespace crofton::fit
