// SPDX-License-Identifier: MIT
#include "fitter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "cloud/enclose.hpp"
#include "search/polish.hpp"

namespace crofton::fit {
namespace {

// Half of the directions of a 30-DOP, three by three: faces, edges and corners of a cube, and two more.
const glm::dmat3 kDirections[] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                  {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}},
                                  {{1, -1, -1}, {1, 1, 0}, {1, 0, 1}},
                                  {{0, 1, 1}, {1, -1, 0}, {1, 0, -1}},
                                  {{0, 1, -1}, {1, 0.5, 0}, {0, 0.5, -1}}};

// A flat or straight set has a box of volume 0 in many frames. Volumes up to this count as 0 (the set's largest half
// extent is between 1/2 and 1); the surface area then chooses.
constexpr double kFlat = 1e-13;
constexpr Weights kArea{0.0, 1.0, 0.0};

// Rounding the axes to float may raise the criterion by this much, relatively, before neighbouring floats are tried.
constexpr double kAxisTolerance = 1e-5;

// A box whose thinnest edge is below this part of its longest is searched again in double: float is too coarse for it.
constexpr double kThin = 1e-3;
// The relative change of a box's value when its axes are stored as floats.
constexpr double kRoundingThatCounts = 1e-6;
// The part of the value by which proofs for ordinary sets allow for the rounding of widths.
constexpr double kProofRounding = 1e-12;
// A share of the value from which on the value is nothing but rounding.
constexpr double kAllRounding = 0.999;

constexpr SmallSetEffort kFastSmallSet{1, 6, 2}, kTightSmallSet{2, 9, 4}, kTightSmallSetByVolume{3, 9, 4};
constexpr Effort kFast{kFastSmallSet, 4, 2, 5}, kTight{{4, 9, 4}, 5, 40, 40};
// Extreme points along this many directions show which points are inside.
constexpr std::size_t kExtremesToForgetBy = 18;
const Candidate kNone{glm::dmat3(1.0), std::numeric_limits<double>::infinity()};

bool is_volume_alone(const Weights& weights) {
    return weights.pairs + weights.sum == 0.0;
}

// A box of a flat set has no volume but by rounding, so the area decides.
const Obb& better_of(const Obb& first, const Obb& second, const measure::Criterion& criterion, bool flat) {
    const measure::Criterion by = flat ? measure::minimal_area() : criterion;
    return by(measure::intrinsic_volumes_of_box(second)) < by(measure::intrinsic_volumes_of_box(first)) ? second
                                                                                                        : first;
}

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

template <class Point>
Result<void> Fitter::assign(std::span<const Point> points) {
    known_.clear();
    forgotten_ = false;
    return cloud_.assign(points);
}

Supports Fitter::supports(const glm::dmat3& directions) {
    for (const CachedSupports& known : known_)
        if (known.directions == directions) return known.supports;
    known_.push_back({directions, cloud_.supports(directions)});
    return known_.back().supports;
}

void Fitter::gather_extremes(std::size_t triples) {
    subset_.clear();
    for (const glm::dmat3& triple : std::span(kDirections).first(triples)) {
        const Supports extremes = supports(triple);
        subset_.insert(subset_.end(), extremes.begin(), extremes.end());
        if (subset_.size() == kExtremesToForgetBy && !forgotten_) {
            forgotten_ = true;
            cloud_.forget_interior(subset_);
        }
    }
    make_canonical(subset_);
}

Candidate Fitter::best_tetrahedral_frame(const Weights& weights) {
    frames_.assign(1, glm::dmat3(1.0));
    tetrahedral_frames(subset_, frames_);
    Candidate best{glm::dmat3(1.0), std::numeric_limits<double>::infinity()};
    for (const glm::dmat3& frame : frames_)
        if (const double value = value_of(weights, subset_, frame); value < best.value) best = {frame, value};
    return best;
}

Weights Fitter::search_weights(const Weights& weights) {
    if (!is_volume_alone(weights)) return weights;
    gather_extremes(5);
    // A thin set that is not flat can have extreme points that are, three of a needle for example: points that stand
    // out of the frame they span join them, until the frame is flat for all points or for none.
    for (std::size_t before = 0; before < subset_.size();) {
        const Candidate frame = best_tetrahedral_frame(weights);
        if (frame.value > kFlat) break;
        const Supports extremes = supports(frame.axes);
        if (value_of(weights, extremes, frame.axes) <= kFlat) return kArea;
        before = subset_.size();
        subset_.insert(subset_.end(), extremes.begin(), extremes.end());
        make_canonical(subset_);
    }
    return weights;
}

SmallSetSearch::Found Fitter::finished(const Weights& weights, const SmallSetSearch::Found& found) {
    const glm::dvec3 extent = found.extent;
    if (std::min({extent.x, extent.y, extent.z}) >= kThin * std::max({extent.x, extent.y, extent.z})) return found;
    Candidate candidate{found.axes, found.value};
    descend(weights, subset_, candidate, buffers_);
    polish(weights, subset_, candidate, buffers_, kCoarseSteps);
    return {candidate.axes, widths(subset_, candidate.axes), candidate.value};
}

SmallSetSearch::Found Fitter::search_subset(const Weights& weights, const SmallSetEffort& effort,
                                            const glm::dmat3* near) {
    small_set_search_.assign(subset_);
    return finished(weights, near == nullptr ? small_set_search_.search(weights, effort)
                                             : small_set_search_.improve(weights, effort, *near));
}

Fitter::Pair Fitter::search_pair(const Weights& weights, const SmallSetEffort& effort) {
    small_set_search_.assign(subset_);
    Pair found;
    found.tight = small_set_search_.search_further(weights, effort, kFastSmallSet, found.fast);
    const bool same = found.tight.axes == found.fast.axes;
    found.fast = finished(weights, found.fast);
    found.tight = same ? found.fast : finished(weights, found.tight);
    return found;
}

// The value of a frame for the subset is a lower bound of its value for all points. The search ends when both agree, or
// when the subset has all support points.
Candidate Fitter::local_search(const Weights& weights, const Effort& effort, Candidate best) {
    for (int query = 0; query < effort.queries; ++query) {
        const bool anew = query < effort.searches;
        const SmallSetSearch::Found found = search_subset(weights, effort.small_set, anew ? nullptr : &best.axes);
        const Supports extremes = supports(found.axes);
        const double value = value_of(weights, extremes, found.axes);
        if (value < best.value) best = {found.axes, value};
        const std::size_t before = subset_.size();
        subset_.insert(subset_.end(), extremes.begin(), extremes.end());
        make_canonical(subset_);
        if (subset_.size() == before || best.value <= found.value * (1.0 + 1e-6)) break;
    }
    return best;
}

Obb Fitter::fit_small_set_fast(const Weights& weights) {
    cloud_.sorted(subset_);
    SmallSetSearch::Found found = search_subset(weights, kFastSmallSet, nullptr);
    Weights by = weights;
    if (is_volume_alone(weights) && found.value <= kFlat) {
        by = kArea;
        found = search_subset(by, kFastSmallSet, nullptr);
    }
    return enclose_small_set(cloud_, rounded(found.axes, found.extent, by, kAxisTolerance));
}

Obb Fitter::fit_small_set_tight(const Weights& weights, const measure::Criterion& criterion) {
    cloud_.sorted(subset_);
    Pair found = search_pair(weights, weights.product > 0.0 ? kTightSmallSetByVolume : kTightSmallSet);
    const SmallSetSearch::Found fast_by_volume = found.fast;
    Weights by = weights;
    const bool flat = is_volume_alone(weights) && std::min(found.fast.value, found.tight.value) <= kFlat;
    if (flat) {
        by = kArea;
        found = search_pair(by, kTightSmallSet);
    }
    const auto box = [&](const SmallSetSearch::Found& of, const Weights& searched_by) {
        return enclose_small_set(cloud_, rounded(of.axes, of.extent, searched_by, kAxisTolerance));
    };
    Obb best = box(found.tight, by);
    if (found.tight.axes != found.fast.axes) best = better_of(best, box(found.fast, by), criterion, flat);
    // A set that a fast fit does not find to be flat is fitted by volume.
    if (flat && fast_by_volume.value > kFlat) best = better_of(best, box(fast_by_volume, weights), criterion, false);
    return best;
}

Obb Fitter::fit_large_set(const Weights& asked, const FitOptions& options) {
    const Weights weights = search_weights(asked);
    gather_extremes(kFast.triples);
    const Candidate fast = local_search(weights, kFast, kNone);
    const Obb first = box_of(fast.axes, weights, kAxisTolerance);
    if (options.quality == Quality::fast) return first;
    gather_extremes(kTight.triples);
    const Candidate tight = local_search(weights, kTight, fast);
    if (tight.axes == fast.axes) return first;
    return better_of(box_of(tight.axes, weights, kAxisTolerance), first, options.criterion,
                     is_volume_alone(asked) && !is_volume_alone(weights));
}

SearchResult Fitter::global_search(const Weights& weights, const SearchLimits& limits) {
    gather_extremes(5);
    return branch_and_bound(cloud_, weights, subset_, best_tetrahedral_frame(weights).axes, limits, buffers_);
}

Obb Fitter::box_of(const glm::dmat3& axes, const Weights& weights, double tolerance) {
    return enclose(cloud_, rounded(axes, widths(supports(axes), axes), weights, tolerance));
}

template <class Point>
Result<Obb> Fitter::fit(std::span<const Point> points, const FitOptions& options) {
    if (options.quality == Quality::exact) {
        ExactOptions exact_options;
        exact_options.criterion = options.criterion;
        const auto best = exact(points, exact_options);
        if (!best) return best.error();
        return best->box;
    }
    if (auto valid = measure::validate(options.criterion); !valid) return valid.error();
    if (auto valid = assign(points); !valid) return valid.error();
    const Weights asked = normalised_weights(options.criterion, cloud_.unit()).weights;
    if (cloud_.has_more_than(kSmallSet)) return fit_large_set(asked, options);
    return options.quality == Quality::fast ? fit_small_set_fast(asked) : fit_small_set_tight(asked, options.criterion);
}

template Result<Obb> Fitter::fit(std::span<const glm::vec3>, const FitOptions&);
template Result<Obb> Fitter::fit(std::span<const glm::dvec3>, const FitOptions&);

template <class Point>
Result<ExactFit> Fitter::exact(std::span<const Point> points, const ExactOptions& options) {
    if (auto valid = measure::validate(options.criterion); !valid) return valid.error();
    if (!(options.gap >= 1e-12 && options.gap < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "fit_exact: the gap must lie in [1e-12, 1)");
    if (!(options.time_budget_seconds >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "fit_exact: the time budget is negative or NaN");
    if (auto valid = assign(points); !valid) return valid.error();
    const NormalisedWeights normalised = normalised_weights(options.criterion, cloud_.unit());
    const Weights weights = search_weights(normalised.weights);
    const bool flat = weights.product == 0.0 && normalised.weights.product > 0.0 && normalised.weights.pairs == 0.0 &&
                      normalised.weights.sum == 0.0;

    const double scale = flat ? 0.0 : normalised.scale;  // the search's values are areas then, and the volume is 0

    const Deadline deadline(options.time_budget_seconds);
    const auto should_stop = [&](double value, double bound, std::uint64_t cells) {
        if (options.should_stop != nullptr && (*options.should_stop)({value * scale, bound * scale, cells}))
            return true;
        return deadline.passed();
    };
    const FunctionRef<bool(double, double, std::uint64_t)> callback(should_stop);
    SearchLimits limits{options.gap, options.max_cells, &callback};
    const SearchResult found = global_search(weights, limits);

    ExactFit fit;
    fit.box = box_of(found.best.axes, weights, 3e-7);
    fit.value = options.criterion(measure::intrinsic_volumes_of_box(fit.box));
    const double unrounded = found.best.value * scale;
    // Where the axes' rounding to float counts, or the search has not ended, another frame may be better.
    if (!found.complete || fit.value - unrounded > kRoundingThatCounts * fit.value) {
        const auto tight = Fitter().fit(points, {options.criterion, Quality::tight});
        if (!tight) return tight.error();
        fit.box = better_of(fit.box, *tight, options.criterion, flat);
        fit.value = options.criterion(measure::intrinsic_volumes_of_box(fit.box));
    }
    fit.lower_bound = std::min(found.lower_bound * scale, fit.value);
    fit.gap = fit.value > 0.0 ? (fit.value - fit.lower_bound) / fit.value : 0.0;
    fit.rounding = fit.value > 0.0 ? std::clamp((fit.value - unrounded) / fit.value, 0.0, fit.gap) : 0.0;
    // Rounding of widths in double, which the proof leaves out, may be more than the gap: but for sets whose best value
    // is 0 but for rounding.
    const bool is_proved = !(fit.gap - fit.rounding > options.gap + kProofRounding) || fit.rounding > kAllRounding;
    fit.complete = found.complete && is_proved;
    fit.cells = found.cells;
    fit.subset = found.subset;
    return fit;
}

template Result<ExactFit> Fitter::exact(std::span<const glm::vec3>, const ExactOptions&);
template Result<ExactFit> Fitter::exact(std::span<const glm::dvec3>, const ExactOptions&);

}  // namespace crofton::fit
