#include "fitter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "enclose.hpp"
#include "polish.hpp"

namespace crofton::fit {
namespace {

// Half of the directions of a 30-DOP, three by three: faces, edges and corners of a cube, and two more.
const glm::dmat3 kDirections[] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                  {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}},
                                  {{1, -1, -1}, {1, 1, 0}, {1, 0, 1}},
                                  {{0, 1, 1}, {1, -1, 0}, {1, 0, -1}},
                                  {{0, 1, -1}, {1, 0.5, 0}, {0, 0.5, -1}}};

// Flat and straight sets have boxes of no volume in many frames: among these the surface area chooses.
constexpr double kFlat = 1e-13;

constexpr Effort kFast{3, 3, 4, false}, kTight{5, 4, 40, true}, kTightFew{5, 3, 40, true};
constexpr std::size_t kFew = 512;  // points of a cluster; more may have more local optima

class Deadline {
  public:
    explicit Deadline(double seconds) : seconds_(seconds) {}
    [[nodiscard]] bool passed() const {
        if (seconds_ == std::numeric_limits<double>::infinity()) return false;
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() >= seconds_;
    }

  private:
    double seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

void Fitter::gather(const Weights& weights, std::size_t frames, std::size_t directions) {
    subset_.clear();
    for (const glm::dmat3& triple : std::span(kDirections).first(directions)) {
        const Supports supports = cloud_.supports(triple);
        subset_.insert(subset_.end(), supports.begin(), supports.end());
    }
    make_canonical(subset_);
    frames_.assign(1, glm::dmat3(1.0));
    tetrahedral_frames(subset_, frames_);
    candidates_.clear();
    for (const glm::dmat3& frame : frames_) candidates_.push_back({frame, value_of(weights, subset_, frame)});
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value < b.value; });
    if (candidates_.size() > frames) candidates_.resize(frames);
}

Weights Fitter::effective(const Weights& weights) {
    if (weights.pairs + weights.sum > 0.0) return weights;
    Weights area{0.0, 1.0, 0.0};
    gather(weights, 1);
    return candidates_[0].value <= kFlat ? area : weights;
}

// Local optima on a growing subset. A candidate's value on the subset is at most its value on the cloud, so the cloud
// is asked only about the candidate that looks best; its support points join the subset, until the best is what it
// looks.
Candidate Fitter::local(const Weights& weights, const Effort& effort) {
    gather(weights, effort.starts, effort.directions);
    Candidate best;
    best.value = std::numeric_limits<double>::infinity();
    // How many points the subset had when each candidate was last searched from, and whether it has been polished: that
    // is worth its time only where turning about the axes has come to rest.
    fresh_.assign(candidates_.size(), 0);
    polished_.assign(candidates_.size(), 0);
    for (Candidate& candidate : candidates_) candidate.value = 0.0;
    for (int queries = 0; queries < effort.queries;) {
        std::size_t i = 0;
        for (std::size_t j = 1; j < candidates_.size(); ++j)
            if (candidates_[j].value < candidates_[i].value) i = j;
        Candidate& candidate = candidates_[i];
        if (candidate.value >= best.value * (1.0 - 1e-12) && (!effort.slide || polished_[i] != 0)) break;
        if (fresh_[i] != subset_.size()) {
            fresh_[i] = subset_.size();
            descend(weights, subset_, candidate, buffers_);
            if (polished_[i] != 0) polish(weights, subset_, candidate, buffers_, kCoarseSteps);
            continue;
        }
        if (effort.slide && polished_[i] == 0 && candidate.value >= best.value * (1.0 - 1e-12)) {
            polished_[i] = 1;
            polish(weights, subset_, candidate, buffers_, kCoarseSteps);
            continue;
        }
        ++queries;
        const Supports supports = cloud_.supports(candidate.axes);
        const double value = value_of(weights, supports, candidate.axes);
        if (value < best.value) best = {candidate.axes, value};
        const std::size_t before = subset_.size();
        subset_.insert(subset_.end(), supports.begin(), supports.end());
        make_canonical(subset_);
        if (subset_.size() == before && (!effort.slide || polished_[i] != 0)) break;
    }
    return best;
}

SearchResult Fitter::global(const Weights& weights, const SearchLimits& limits) {
    gather(weights, 1);
    return branch_and_bound(cloud_, weights, subset_, candidates_[0].axes, limits, buffers_);
}

Obb Fitter::box_of(const glm::dmat3& axes, const Weights& weights, double tolerance) {
    const Supports supports = cloud_.supports(axes);
    return enclose(cloud_, rounded(axes, widths(supports, axes), weights, tolerance));
}

template <class Point>
Result<Obb> Fitter::fit(std::span<const Point> points, const Options& options) {
    if (options.quality == Quality::exact) {
        ExactOptions exact_options;
        exact_options.criterion = options.criterion;
        return exact(points, exact_options).map([](const ExactFit& fit) { return fit.box; });
    }
    if (auto valid = measure::validate(options.criterion); !valid) return tl::unexpected(valid.error());
    if (auto valid = cloud_.assign(points); !valid) return tl::unexpected(valid.error());
    const Weights weights = effective(normalised_weights(options.criterion, cloud_.unit()).weights);
    const Effort& effort = options.quality == Quality::fast ? kFast : points.size() <= kFew ? kTightFew : kTight;
    return box_of(local(weights, effort).axes, weights, 1e-5);
}

template Result<Obb> Fitter::fit(std::span<const glm::vec3>, const Options&);
template Result<Obb> Fitter::fit(std::span<const glm::dvec3>, const Options&);

template <class Point>
Result<ExactFit> Fitter::exact(std::span<const Point> points, const ExactOptions& options) {
    if (auto valid = measure::validate(options.criterion); !valid) return tl::unexpected(valid.error());
    if (!(options.gap >= 1e-12 && options.gap < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "fit_exact: the gap must lie in [1e-12, 1)");
    if (!(options.time_budget_seconds >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "fit_exact: the time budget is negative or NaN");
    if (auto valid = cloud_.assign(points); !valid) return tl::unexpected(valid.error());
    const NormalisedWeights normalised = normalised_weights(options.criterion, cloud_.unit());
    const Weights weights = effective(normalised.weights);
    const bool flat = weights.product == 0.0 && normalised.weights.product > 0.0 && normalised.weights.pairs == 0.0 &&
                      normalised.weights.sum == 0.0;

    const Deadline deadline(options.time_budget_seconds);
    const auto keep_going = [&](double value, double bound, std::uint64_t cells) {
        if (options.progress != nullptr &&
            !(*options.progress)({value * normalised.scale, flat ? 0.0 : bound * normalised.scale, cells}))
            return false;
        return !deadline.passed();
    };
    const FunctionRef<bool(double, double, std::uint64_t)> go_on(keep_going);
    SearchLimits limits{options.gap, options.max_cells, &go_on};
    const SearchResult found = global(weights, limits);

    ExactFit fit;
    fit.box = box_of(found.best.axes, weights, 3e-7);
    fit.value = options.criterion(measure::of_box(fit.box));
    fit.lower_bound = flat ? 0.0 : std::min(found.lower_bound * normalised.scale, fit.value);
    fit.gap = fit.value > 0.0 ? (fit.value - fit.lower_bound) / fit.value : 0.0;
    fit.complete = found.complete;
    fit.cells = found.cells;
    fit.subset = found.subset;
    return fit;
}

template Result<ExactFit> Fitter::exact(std::span<const glm::vec3>, const ExactOptions&);
template Result<ExactFit> Fitter::exact(std::span<const glm::dvec3>, const ExactOptions&);

}  // namespace crofton::fit
