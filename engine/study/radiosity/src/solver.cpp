// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/radiosity/solver.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "local_lines.hpp"
#include "ordered_tracing.hpp"

namespace crofton::radiosity {
namespace {

// From the second run on most light is known already. What still travels is mostly noise of the last gathering: fewer
// lines and an earlier end do for it.
constexpr std::uint64_t kFewerLinesAtFirst = 4, kFewerLines = 8;
constexpr double kEarlierEnd = 10.0;
constexpr std::uint64_t kGatherStream = 8;
// Added after the first run. Bundles and blocks are numbered by run, times how many a run has. Later runs have fewer.
// In the first one's stream they would draw some of its lines again, and their expectation would not be the light.
constexpr std::uint64_t kLaterRuns = std::uint64_t{1} << 40;

double absolute(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

Result<void> check(const SolverOptions& options) {
    const auto valid = [](const glm::vec3& v) {
        return v.x >= 0.0f && v.y >= 0.0f && v.z >= 0.0f && std::isfinite(v.x + v.y + v.z);
    };
    if (!valid(options.outside.sky) || !valid(options.outside.sun))
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: sky and sun must be finite and not negative");
    if (!(options.cutoff > 0.0))
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: the cutoff must be positive");
    if (options.lines > std::uint64_t{1} << 40)
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: more than 2^40 lines in one gathering");
    const double to_sun = glm::length(options.outside.to_sun);
    if (total(glm::dvec3(options.outside.sun)) > 0.0) {
        if (to_sun == 0.0)
            return fail(ErrorCode::degenerate, kNoItem, "radiosity: the direction to the sun has no length");
        if (!std::isfinite(to_sun))
            return fail(ErrorCode::out_of_range, kNoItem,
                        "radiosity: the direction to the sun is too long or not finite");
    }
    return {};
}

}  // namespace

Solver::Solver(const Patches& patches, const SolverOptions& options, lines::LineTracer tracer,
               lines::BundleTracer bundles)
    : patches_(&patches),
      options_(options),
      tracer_(std::move(tracer)),
      bundles_(std::move(bundles)),
      method_(options.method.value_or(lines::LineMethod::bundles)) {
    sum_.assign(patches.count(), glm::dvec3(0.0));
    squares_ = sum_;
    drawn_.assign(patches.count(), 0);
    buried_ = drawn_;
    mean_.assign(patches.count(), glm::vec3(0.0f));
    for (const double area : patches.areas) surface_ += area;
    box_area_ = lines::LineSource(tracer_.bounds(), lines::LineMethod::walls, options.seed).surface_area();
    if (options_.lines == 0) options_.lines = static_cast<std::uint64_t>(std::ceil(64.0 * lines_of_bundle()));
    if (options_.first_shot == 0)
        options_.first_shot = std::clamp<std::uint64_t>(options_.lines / 4, 1u << 12, 1u << 18);
    list_triangles();
}

// A cell is as large as a triangle on average. Then crossings cost about as much as triangles, and a patch of one
// triangle has half a ray of each bundle. More lines of one direction would tell it little.
double Solver::lines_of_bundle() const {
    constexpr double kMostLines = 1 << 21;
    return std::min(kMostLines, 0.25 * box_area_ * static_cast<double>(patches_->triangle_areas.size()) / surface_);
}

void Solver::list_triangles() {
    const Patches& p = *patches_;
    first_triangle_.assign(p.count() + 1, 0);
    for (const std::uint32_t patch : p.patch_of_triangle) ++first_triangle_[patch + 1];
    for (std::size_t i = 0; i < p.count(); ++i) first_triangle_[i + 1] += first_triangle_[i];
    triangles_.resize(p.patch_of_triangle.size());
    Vector<std::uint32_t> at(first_triangle_.begin(), first_triangle_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) triangles_[at[p.patch_of_triangle[t]]++] = t;
    triangle_sums_.resize(triangles_.size());
    for (std::size_t i = 0; i < p.count(); ++i) {
        double sum = 0.0;
        for (std::uint32_t k = first_triangle_[i]; k < first_triangle_[i + 1]; ++k)
            triangle_sums_[k] = sum += p.triangle_areas[triangles_[k]];
    }
}

std::uint32_t Solver::triangle_of(std::size_t patch, double u) const {
    const auto begin = triangle_sums_.begin() + first_triangle_[patch],
               end = triangle_sums_.begin() + first_triangle_[patch + 1];
    const auto found = std::upper_bound(begin, end - 1, u * *(end - 1));
    return triangles_[static_cast<std::size_t>(found - triangle_sums_.begin())];
}

Result<Solver> Solver::create(const Patches& patches, const SolverOptions& options) {
    return crofton::detail::recover([&]() -> Result<Solver> {
        if (auto valid = check(options); !valid) return valid.error();
        bool light = total(glm::dvec3(options.outside.sky) + glm::dvec3(options.outside.sun)) > 0.0;
        for (const Material& m : patches.materials) light = light || total(glm::dvec3(m.emission)) > 0.0;
        if (!light)
            return fail(ErrorCode::empty, kNoItem,
                        "radiosity: nothing gives light; give a patch emission, or a sky or sun");
        auto tracer = lines::LineTracer::build(patches.mesh);
        if (!tracer) return tracer.error();
        auto bundles = lines::BundleTracer::build(patches.mesh);
        if (!bundles) return bundles.error();
        return Solver(patches, options, std::move(*tracer), std::move(*bundles));
    });
}

void Solver::run(Executor& executor) {
    add_run(arriving_in_a_run(executor));
}

bool Solver::run(StopCallback should_stop, void* user, Executor& executor) {
    crofton::detail::StopSignal stop(should_stop, user);
    const Vector<std::uint64_t> drawn = drawn_, buried = buried_;
    const std::uint64_t lines = lines_traced_, unseen = unseen_, seen = seen_;
    const std::uint32_t bounces = bounces_;
    stop_ = &stop;
    const Light arrived = arriving_in_a_run(executor);
    stop_ = nullptr;
    if (!stop.was_raised()) {
        add_run(arrived);
        return true;
    }
    drawn_ = drawn, buried_ = buried;
    lines_traced_ = lines, unseen_ = unseen, seen_ = seen, bounces_ = bounces;
    return false;
}

// Returns the light that arrives on the patches in one more run; undefined if it is stopped.
Solver::Light Solver::arriving_in_a_run(Executor& executor) {
    const Patches& p = *patches_;
    const std::size_t count = p.count();
    const double known_runs = static_cast<double>(std::max<std::uint64_t>(1, runs_));
    const auto reflectance = [&](std::size_t i) { return glm::dvec3(p.materials[i].reflectance); };
    Light leaving(count), arrived(count, glm::dvec3(0.0)), all(count);
    for (std::size_t i = 0; i < count; ++i) leaving[i] = reflectance(i) * sum_[i] / known_runs;  // what was known
    gather({&leaving, glm::dvec3(options_.outside.sky), options_.lines, kGatherStream}, arrived, executor);
    shoot_lamps(arrived, executor);
    look_for_sun(arrived, executor);
    double light = 0.0, travelling = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        all[i] = arrived[i];
        leaving[i] = reflectance(i) * arrived[i] - leaving[i];
        light += p.areas[i] * total(glm::dvec3(p.materials[i].emission) + reflectance(i) * arrived[i]);
        travelling += p.areas[i] * absolute(leaving[i]);
    }
    const std::uint64_t share = runs_ == 0 ? kFewerLinesAtFirst : kFewerLines;
    const std::uint64_t lines = std::max<std::uint64_t>(1, options_.lines / share);
    const std::uint64_t streams = kGatherStream + 1 + (runs_ == 0 ? 0 : kLaterRuns);
    const double cutoff = runs_ == 0 ? options_.cutoff : kEarlierEnd * options_.cutoff;
    for (bounces_ = 0; bounces_ < options_.most_bounces && travelling > cutoff * light && !is_raised(stop_);
         ++bounces_) {
        arrived.assign(count, glm::dvec3(0.0));
        gather({&leaving, glm::dvec3(0.0), lines, streams + bounces_}, arrived, executor);
        travelling = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            all[i] += arrived[i];
            leaving[i] = reflectance(i) * arrived[i];
            light += p.areas[i] * total(leaving[i]);
            travelling += p.areas[i] * absolute(leaving[i]);
        }
    }
    return all;
}

}  // namespace crofton::radiosity
