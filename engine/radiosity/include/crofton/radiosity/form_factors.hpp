// SPDX-License-Identifier: MIT
// Form factors F_ij: the share of what leaves patch i that reaches patch j first, estimated three ways.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/line_source.hpp>
#include <crofton/radiosity/line_tracer.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstdint>

namespace crofton::radiosity {

// How a local line leaves its uniform point of the patch. Both give the same factors, the first with less spread.
enum class LocalDensity : std::uint8_t {
    cosine,              // density cosθ/π, every line counts 1
    uniform,             // density 1/2π over the hemisphere, every line counts 2·cosθ (the paper's f₂)
    uniform_unweighted,  // wrong on purpose, for tests to reject: uniform directions that count 1
};

struct FactorRow {
    Vector<double> factors;          // by patch
    Vector<double> standard_errors;  // by patch
    double escaped = 0.0;            // the share that reaches nothing; 0 in closed scenes
    std::uint64_t lines = 0;
};

// Row i from `lines` local lines, from triangles of the patch by area. A line that arrives at a back counts as
// swallowed: it reaches no patch and does not escape, so the row then sums to less than 1. Requires i <
// patches.count(), lines ≥ 1.
[[nodiscard]] FactorRow factors_by_local_lines(const LineTracer& tracer, const Patches& patches, std::uint32_t i,
                                               std::uint64_t lines, LocalDensity density, std::uint64_t seed,
                                               sampling::Sequence sequence = sampling::Sequence::pseudo_random);

// All rows at once from global lines. Every crossing of a patch's front with a line starts one ray there, whatever the
// patch's shape: crossings are counted, not lines, so non-planar patches are right too (the paper's section 6.1).
struct FactorMatrix {
    std::size_t size = 0;
    Vector<std::uint32_t> transfers;  // [i·size + j]: rays from i that reach j
    Vector<std::uint64_t> rays;       // by i
    Vector<std::uint64_t> escaped;    // by i
    std::uint64_t lines = 0;

    [[nodiscard]] double factor(std::size_t i, std::size_t j) const;
    [[nodiscard]] double standard_error(std::size_t i, std::size_t j) const;  // binomial: √(F(1−F)/rays)
};

// The full matrix takes size² counters: for small scenes, tests and studies; the solver never builds it.
// Errors: more than 16,384 patches.
[[nodiscard]] Result<FactorMatrix> factors_by_global_lines(const LineTracer& tracer, const Patches& patches,
                                                           const LineSource& source, std::uint64_t blocks,
                                                           Executor& executor = serial_executor());

// What a ray meets that reaches no patch's front.
inline constexpr std::uint32_t kSky = ~std::uint32_t{0};       // nothing
inline constexpr std::uint32_t kBack = ~std::uint32_t{0} - 1;  // the back of a triangle, which swallows light

// Calls ray(i, j) for every ray that starts on the front of patch i along the line, either way, with what it reaches
// first: a patch, kSky or kBack. Two fronts that face each other give ray(i, j) and ray(j, i).
template <class RayVisitor>
void for_each_ray(std::span<const Hit> crossings, const Patches& patches, RayVisitor&& ray) {
    std::uint32_t before = kSky;  // patch whose front looks along the line into this stretch, or what is there instead
    for (const Hit& hit : crossings) {
        const std::uint32_t here = patches.patch_of_triangle[hit.triangle];
        if (before < kBack) ray(before, hit.front ? here : kBack);
        if (hit.front) ray(here, before);
        before = hit.front ? kBack : here;
    }
    if (before < kBack) ray(before, kSky);
}

}  // namespace crofton::radiosity
