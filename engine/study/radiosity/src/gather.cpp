// SPDX-License-Identifier: MIT
// Gathers the light that arrives on every patch along one set of lines.
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <crofton/sampling/sampling.hpp>
#include <numeric>

#include "local_lines.hpp"
#include "ordered_tracing.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::uint64_t kUnseenStream = 1u << 20;  // added to a gathering's own
constexpr std::uint64_t kRaysOfUnseen = 4;
constexpr double kLeastBundles = 8.0;

}  // namespace

void Solver::take(std::span<const lines::Hit> crossings, const Gathering& what, Light& arrived) {
    for_each_ray(crossings, *patches_, [&](std::uint32_t i, std::uint32_t j) {
        ++drawn_[i];
        if (j == kBack) {
            ++buried_[i];
            return;
        }
        ++rays_[i];
        arrived[i] += j == kSky ? what.sky : (*what.leaving)[j];
    });
}

void Solver::gather(const Gathering& what, Light& arrived, Executor& executor) {
    rays_.assign(patches_->count(), 0);
    if (options_.transport == Transport::local)
        gather_local(what, arrived, executor);
    else if (method_ == lines::LineMethod::bundles)
        gather_bundles(what, arrived, executor);
    else
        gather_lines(what, arrived, executor);
    gather_unseen(what, arrived, executor);
    for (std::size_t i = 0; i < arrived.size(); ++i) {
        if (rays_[i] > 0)
            arrived[i] /= static_cast<double>(rays_[i]);
        else
            ++unseen_;
    }
    seen_ += arrived.size();
}

void Solver::gather_bundles(const Gathering& what, Light& arrived, Executor& executor) {
    const double lines = static_cast<double>(what.lines);
    const double count = std::max(kLeastBundles, std::ceil(lines / lines_of_bundle()));
    const double cell_area = 0.25 * box_area_ * count / lines;
    const std::uint64_t bundles = static_cast<std::uint64_t>(count);
    const sampling::UnitPoints points(mixed(options_.seed, what.stream), options_.sequence);
    const std::size_t wave = 2 * std::size_t{executor.concurrency()};
    Vector<lines::LineHits> hits(wave);
    Vector<lines::Bundle> drawn(wave);
    Vector<lines::BundleTracer::Scratch> scratch(executor.concurrency());
    for (std::uint64_t first = 0; first < bundles; first += wave) {
        const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(wave, bundles - first));
        executor.parallel_for(now, 1, [&](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t b = begin; b < end; ++b) {
                if (is_raised(stop_)) return;
                const std::uint64_t number = (first_run_ + runs_) * bundles + first + b;
                drawn[b] = lines::make_bundle(bundles_.bounds(), cell_area, points.at<2>(number),
                                              mixed(mixed(options_.seed, what.stream), number));
                bundles_.all_hits(drawn[b], scratch[worker], hits[b]);
            }
        });
        if (is_raised(stop_)) return;
        for (std::size_t b = 0; b < now; ++b) {
            lines_traced_ += static_cast<std::uint64_t>(drawn[b].lines);
            std::uint32_t begin = 0;
            for (const std::uint32_t end : hits[b].ends) {
                if (end > begin)
                    take(std::span<const lines::Hit>(hits[b].hits).subspan(begin, end - begin), what, arrived);
                begin = end;
            }
        }
    }
}

void Solver::gather_lines(const Gathering& what, Light& arrived, Executor& executor) {
    const lines::LineSource source(tracer_.bounds(), method_, mixed(options_.seed, what.stream), options_.sequence);
    const std::uint64_t blocks = (what.lines + lines::LineSource::kBlock - 1) / lines::LineSource::kBlock;
    Vector<lines::LineHits> hits(kWave);
    for (std::uint64_t first = 0; first < blocks; first += kWave) {
        const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(kWave, blocks - first));
        executor.parallel_for(now, 1, [&](std::size_t begin, std::size_t end, unsigned) {
            Vector<Line> lines;
            for (std::size_t b = begin; b < end; ++b) {
                if (is_raised(stop_)) return;
                source.draw((first_run_ + runs_) * blocks + first + b, lines);
                tracer_.all_hits(lines, hits[b]);
            }
        });
        if (is_raised(stop_)) return;
        for (std::size_t b = 0; b < now; ++b) {
            lines_traced_ += hits[b].ends.size();
            std::uint32_t begin = 0;
            for (const std::uint32_t end : hits[b].ends) {
                take(std::span<const lines::Hit>(hits[b].hits).subspan(begin, end - begin), what, arrived);
                begin = end;
            }
        }
    }
}

// Rays ends[k−1] … ends[k]−1 leave patches[k].
void Solver::cast_local(const Gathering& what, std::span<const std::uint32_t> patches,
                        std::span<const std::uint64_t> ends, std::uint64_t stream, Light& arrived, Executor& executor) {
    if (ends.empty()) return;
    const std::uint64_t count = ends.back();
    lines_traced_ += count;
    const auto patch_of = [&](std::uint64_t ray) {
        return patches[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), ray) - ends.begin())];
    };
    const sampling::UnitPoints points(mixed(mixed(options_.seed, stream), first_run_ + runs_));
    trace_in_order(
        tracer_, count, executor, stop_,
        [&](std::uint64_t ray) {
            const auto u = points.at<5>(ray);
            return local_ray(*patches_, triangle_of(patch_of(ray), u[4]), u[0], u[1], std::sqrt(u[2]), u[3]);
        },
        [&](std::uint64_t ray, const lines::Hit& hit) {
            const std::uint32_t i = patch_of(ray);
            ++drawn_[i];
            if (hit.triangle != lines::Hit::kNothing && !hit.front) {
                ++buried_[i];
                return;
            }
            ++rays_[i];
            arrived[i] += hit.triangle == lines::Hit::kNothing
                              ? what.sky
                              : (*what.leaving)[patches_->patch_of_triangle[hit.triangle]];
        });
}

// Global lines start 2·N·A/F rays on a patch of area A: shared out the same way, but at least one each.
void Solver::gather_local(const Gathering& what, Light& arrived, Executor& executor) {
    const double per_area = 2.0 * static_cast<double>(what.lines) / box_area_;
    Vector<std::uint32_t> patches(patches_->count());
    std::iota(patches.begin(), patches.end(), 0u);
    Vector<std::uint64_t> ends;
    std::uint64_t count = 0;
    for (const double area : patches_->areas)
        ends.push_back(count += std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(per_area * area))));
    cast_local(what, patches, ends, what.stream, arrived, executor);
}

void Solver::gather_unseen(const Gathering& what, Light& arrived, Executor& executor) {
    Vector<std::uint32_t> patches;
    Vector<std::uint64_t> ends;
    for (std::uint32_t i = 0; i < patches_->count(); ++i) {
        if (rays_[i] > 0) continue;
        patches.push_back(i);
        ends.push_back(kRaysOfUnseen * patches.size());
    }
    cast_local(what, patches, ends, what.stream + kUnseenStream, arrived, executor);
}

}  // namespace crofton::radiosity
