// SPDX-License-Identifier: MIT
// Estimates form factors from traced lines.
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/patches.hpp>
#include <string>

#include "local_lines.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::size_t kMostPatches = 16384;

struct Triangles {
    Vector<std::uint32_t> ids;
    Vector<double> cumulative_area;

    Triangles(const Patches& patches, std::uint32_t patch) {
        double sum = 0.0;
        for (std::uint32_t t = 0; t < patches.patch_of_triangle.size(); ++t) {
            if (patches.patch_of_triangle[t] != patch) continue;
            ids.push_back(t);
            cumulative_area.push_back(sum += patches.triangle_areas[t]);
        }
    }
    [[nodiscard]] std::uint32_t at(double u) const {
        const auto found = std::upper_bound(cumulative_area.begin(), cumulative_area.end(), u * cumulative_area.back());
        return ids[std::min(static_cast<std::size_t>(found - cumulative_area.begin()), ids.size() - 1)];
    }
};

}  // namespace

FactorRow factors_by_local_lines(const lines::LineTracer& tracer, const Patches& patches, std::uint32_t i,
                                 std::uint64_t lines, LocalDensity density, std::uint64_t seed,
                                 sampling::Sequence sequence) {
    CROFTON_ASSERT(i < patches.count() && lines >= 1, "no such patch, or no lines");
    constexpr std::size_t kBatch = 1024;
    const Triangles triangles(patches, i);
    const sampling::UnitPoints points(seed, sequence);
    FactorRow row;
    row.lines = lines;
    Vector<double> squares(patches.count(), 0.0);
    row.factors.assign(patches.count(), 0.0);
    Vector<lines::FirstHitQuery> rays;
    Vector<double> weights;
    Vector<lines::Hit> hits;
    for (std::uint64_t begin = 0; begin < lines; begin += kBatch) {
        rays.clear();
        weights.clear();
        for (std::uint64_t l = begin; l < std::min(lines, begin + kBatch); ++l) {
            const auto u = points.at<5>(l);
            const double cosine = density == LocalDensity::cosine ? std::sqrt(u[2]) : u[2];
            rays.push_back(local_ray(patches, triangles.at(u[4]), u[0], u[1], cosine, u[3]));
            weights.push_back(density == LocalDensity::uniform ? 2.0 * cosine : 1.0);
        }
        hits.resize(rays.size());
        tracer.first_hits(rays, hits);
        for (std::size_t k = 0; k < hits.size(); ++k) {
            if (hits[k].triangle == lines::Hit::kNothing) {
                row.escaped += weights[k];
            } else if (hits[k].front) {
                const std::uint32_t j = patches.patch_of_triangle[hits[k].triangle];
                row.factors[j] += weights[k];
                squares[j] += weights[k] * weights[k];
            }
        }
    }
    const double n = static_cast<double>(lines);
    row.escaped /= n;
    row.standard_errors.resize(patches.count());
    for (std::size_t j = 0; j < patches.count(); ++j) {
        row.factors[j] /= n;
        row.standard_errors[j] = std::sqrt(std::max(0.0, squares[j] / n - row.factors[j] * row.factors[j]) / n);
    }
    return row;
}

double FactorMatrix::factor(std::size_t i, std::size_t j) const {
    return rays[i] == 0 ? 0.0 : static_cast<double>(transfers[i * size + j]) / static_cast<double>(rays[i]);
}

double FactorMatrix::standard_error(std::size_t i, std::size_t j) const {
    if (rays[i] == 0) return 1.0;
    const double f = factor(i, j);
    return std::sqrt(f * (1.0 - f) / static_cast<double>(rays[i]));
}

Result<FactorMatrix> factors_by_global_lines(const lines::LineTracer& tracer, const Patches& patches,
                                             const lines::LineSource& source, std::uint64_t blocks,
                                             Executor& executor) {
    if (patches.count() > kMostPatches)
        return fail(ErrorCode::out_of_range, patches.count(),
                    "form factors: the full matrix is for 16384 patches at most");
    return crofton::detail::recover([&]() -> Result<FactorMatrix> {
        FactorMatrix matrix;
        matrix.size = patches.count();
        matrix.transfers.assign(matrix.size * matrix.size, 0);
        matrix.rays.assign(matrix.size, 0);
        matrix.escaped.assign(matrix.size, 0);
        // Waves of blocks: traced by any thread, counted by this one.
        constexpr std::uint64_t kWave = 32;
        Vector<lines::LineHits> hits(static_cast<std::size_t>(std::min(kWave, blocks)));
        for (std::uint64_t first = 0; first < blocks; first += kWave) {
            const std::size_t count = static_cast<std::size_t>(std::min(kWave, blocks - first));
            crofton::detail::recoverable_for(executor, count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
                Vector<Line> lines;
                for (std::size_t b = begin; b < end; ++b) {
                    source.draw(first + b, lines);
                    tracer.all_hits(lines, hits[b]);
                }
            });
            for (std::size_t b = 0; b < count; ++b) {
                std::uint32_t begin = 0;
                matrix.lines += hits[b].ends.size();
                for (const std::uint32_t end : hits[b].ends) {
                    for_each_ray(std::span<const lines::Hit>(hits[b].hits).subspan(begin, end - begin), patches,
                                 [&](std::uint32_t i, std::uint32_t j) {
                                     ++matrix.rays[i];
                                     if (j == kSky)
                                         ++matrix.escaped[i];
                                     else if (j != kBack)
                                         ++matrix.transfers[i * matrix.size + j];
                                 });
                    begin = end;
                }
            }
        }
        return matrix;
    });
}

}  // namespace crofton::radiosity
