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
constexpr Weights kArea{0.0, 1.0, 0.0};

// What the rounding of axes to float may cost, relatively, before neighbouring floats are tried.
constexpr double kAxisTolerance = 1e-5;

// A box this thin, relatively, is searched again in double: float coordinates are too coarse across it.
constexpr double kThin = 1e-3;

constexpr FewEffort kFastFew{1, 6, 2}, kTightFew{2, 9, 4}, kTightFewByVolume{3, 9, 4};
constexpr Effort kFast{kFastFew, 4, 2, 5}, kTight{{4, 9, 4}, 5, 40, 40};

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

void Fitter::gather(std::size_t triples) {
    subset_.clear();
    for (const glm::dmat3& triple : std::span(kDirections).first(triples)) {
        const Supports supports = cloud_.supports(triple);
        subset_.insert(subset_.end(), supports.begin(), supports.end());
    }
    make_canonical(subset_);
}

Candidate Fitter::rough(const Weights& weights) {
    frames_.assign(1, glm::dmat3(1.0));
    tetrahedral_frames(subset_, frames_);
    Candidate best{glm::dmat3(1.0), std::numeric_limits<double>::infinity()};
    for (const glm::dmat3& frame : frames_)
        if (const double value = value_of(weights, subset_, frame); value < best.value) best = {frame, value};
    return best;
}

// By volume all frames of a flat set may look alike: there the area decides.
Weights Fitter::effective(const Weights& weights) {
    if (weights.pairs + weights.sum > 0.0) return weights;
    gather(5);
    return rough(weights).value <= kFlat ? kArea : weights;
}

FewSearch::Found Fitter::search_subset(const Weights& weights, const FewEffort& effort, const glm::dmat3* near) {
    few_.assign(subset_);
    FewSearch::Found found = near == nullptr ? few_.search(weights, effort) : few_.improve(weights, effort, *near);
    const glm::dvec3 extent = found.extent;
    if (std::min({extent.x, extent.y, extent.z}) < kThin * std::max({extent.x, extent.y, extent.z})) {
        Candidate candidate{found.axes, found.value};
        descend(weights, subset_, candidate, buffers_);
        polish(weights, subset_, candidate, buffers_, kCoarseSteps);
        found = {candidate.axes, widths(subset_, candidate.axes), candidate.value};
    }
    return found;
}

// The subset's best frame looks at least as good as it is. Where all points agree, it is the best of all that the
// search can tell.
Candidate Fitter::local(const Weights& weights, const Effort& effort) {
    gather(effort.triples);
    Candidate best{glm::dmat3(1.0), std::numeric_limits<double>::infinity()};
    for (int query = 0; query < effort.queries; ++query) {
        const bool anew = query < effort.searches;
        const FewSearch::Found found = search_subset(weights, effort.few, anew ? nullptr : &best.axes);
        const Supports supports = cloud_.supports(found.axes);
        const double value = value_of(weights, supports, found.axes);
        if (value < best.value) best = {found.axes, value};
        const std::size_t before = subset_.size();
        subset_.insert(subset_.end(), supports.begin(), supports.end());
        make_canonical(subset_);
        if (subset_.size() == before || best.value <= found.value * (1.0 + 1e-6)) break;
    }
    return best;
}

Obb Fitter::fit_few(const Weights& weights, const FewEffort& effort) {
    cloud_.sorted(subset_);
    FewSearch::Found found = search_subset(weights, effort, nullptr);
    Weights by = weights;
    if (weights.pairs + weights.sum == 0.0 && found.value <= kFlat) {
        by = kArea;
        found = search_subset(by, effort, nullptr);
    }
    return enclose_few(cloud_, rounded(found.axes, found.extent, by, kAxisTolerance));
}

SearchResult Fitter::global(const Weights& weights, const SearchLimits& limits) {
    gather(5);
    return branch_and_bound(cloud_, weights, subset_, rough(weights).axes, limits, buffers_);
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
    const Weights asked = normalised_weights(options.criterion, cloud_.unit()).weights;
    const bool fast = options.quality == Quality::fast;
    if (points.size() <= kFew)
        return fit_few(asked, fast ? kFastFew : asked.product > 0.0 ? kTightFewByVolume : kTightFew);
    const Weights weights = effective(asked);
    return box_of(local(weights, fast ? kFast : kTight).axes, weights, kAxisTolerance);
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
    const double unrounded = flat ? 0.0 : found.best.value * normalised.scale;
    fit.rounding = fit.value > 0.0 ? std::clamp((fit.value - unrounded) / fit.value, 0.0, fit.gap) : 0.0;
    fit.complete = found.complete;
    fit.cells = found.cells;
    fit.subset = found.subset;
    return fit;
}

template Result<ExactFit> Fitter::exact(std::span<const glm::vec3>, const ExactOptions&);
template Result<ExactFit> Fitter::exact(std::span<const glm::dvec3>, const ExactOptions&);

}  // namespace crofton::fit
