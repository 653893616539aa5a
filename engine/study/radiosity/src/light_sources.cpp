// SPDX-License-Identifier: MIT
// First-shot improvement: what lamps and the sun send before any bounce.
#include <array>
#include <cmath>
#include <crofton/radiosity/solver.hpp>
#include <glm/geometric.hpp>

#include "local_lines.hpp"
#include "ordered_tracing.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::uint64_t kLampStream = 0, kSunStream = 1;
constexpr double kSunRays = 2.0;  // per run on a patch of mean area
constexpr std::uint64_t kMostSunRays = 8;

// Points of the unit cube for each patch: shifted lattice points that go on from run to run.
class PatchPoints {
  public:
    PatchPoints(std::uint64_t seed, sampling::Sequence sequence) : seed_(seed), sequence_(sequence) {}

    [[nodiscard]] std::array<double, 3> at(std::size_t patch, std::uint64_t index) const {
        if (sequence_ == sampling::Sequence::pseudo_random)
            return sampling::Random(mixed(seed_, patch), index).point<3>();
        // Powers of the root of x⁴ = x + 1: the additive recurrence of least discrepancy known for three dimensions.
        constexpr double kRoot = 1.2207440846057596;
        constexpr std::array<double, 3> kStep = {1.0 / kRoot, 1.0 / (kRoot * kRoot), 1.0 / (kRoot * kRoot * kRoot)};
        std::array<double, 3> point = sampling::Random(seed_, patch).point<3>();
        for (std::size_t k = 0; k < 3; ++k) {
            point[k] += static_cast<double>(index) * kStep[k];
            point[k] -= std::floor(point[k]);
        }
        return point;
    }

  private:
    std::uint64_t seed_;
    sampling::Sequence sequence_;
};

}  // namespace

double Solver::exposed_share(std::size_t patch) const {
    if (drawn_[patch] == 0) return 1.0;
    return static_cast<double>(drawn_[patch] - buried_[patch]) / static_cast<double>(drawn_[patch]);
}

void Solver::shoot_lamps(Light& arrived, Executor& executor) {
    const Patches& p = *patches_;
    const auto emission = [&](std::uint32_t t) { return glm::dvec3(p.materials[p.patch_of_triangle[t]].emission); };
    Vector<std::uint32_t> lamps;
    Vector<double> sums;
    double sum = 0.0;
    for (std::uint32_t t = 0; t < p.triangle_areas.size(); ++t) {
        if (!(total(emission(t)) > 0.0)) continue;
        lamps.push_back(t);
        sums.push_back(sum += p.triangle_areas[t] * total(emission(t)));
    }
    if (lamps.empty()) return;
    const auto lamp = [&](double u) {
        const auto found = std::upper_bound(sums.begin(), sums.end() - 1, u * sum);
        return lamps[static_cast<std::size_t>(found - sums.begin())];
    };
    const sampling::UnitPoints points(mixed(options_.seed, kLampStream), options_.sequence);
    const std::uint64_t first = (first_run_ + runs_) * options_.first_shot;
    const double each = sum / static_cast<double>(options_.first_shot);
    lines_traced_ += options_.first_shot;
    trace_in_order(
        tracer_, options_.first_shot, executor, stop_,
        [&](std::uint64_t i) {
            const auto u = points.at<5>(first + i);
            return local_ray(p, lamp(u[4]), u[0], u[1], std::sqrt(u[2]), u[3]);
        },
        [&](std::uint64_t i, const lines::Hit& hit) {
            if (hit.triangle == lines::Hit::kNothing || !hit.front) return;
            const glm::dvec3 color = emission(lamp(points.at<5>(first + i)[4]));
            const std::uint32_t to = p.patch_of_triangle[hit.triangle];
            const double open = exposed_share(to);
            arrived[to] += color * (each / total(color) / (p.areas[to] * (open > 0.0 ? open : 1.0)));
        });
}

// From points of each patch that faces the sun: only whether it is seen is left to chance.
void Solver::look_for_sun(Light& arrived, Executor& executor) {
    const glm::dvec3 irradiance(options_.outside.sun);
    if (!(total(irradiance) > 0.0)) return;
    const Patches& p = *patches_;
    const glm::dvec3 to_sun = glm::normalize(options_.outside.to_sun);
    const PatchPoints points(mixed(options_.seed, kSunStream), options_.sequence);
    const double per_area = kSunRays * static_cast<double>(p.count()) / surface_;
    struct Look {
        std::uint32_t patch, triangle;
        float u, v, cosine;
    };
    Vector<Look> looks;
    Vector<std::uint8_t> counts(p.count());
    for (std::uint32_t i = 0; i < p.count(); ++i) {
        const std::uint64_t n =
            std::min(kMostSunRays, std::max<std::uint64_t>(1, static_cast<std::uint64_t>(per_area * p.areas[i])));
        counts[i] = static_cast<std::uint8_t>(n);
        for (std::uint64_t k = 0; k < n; ++k) {
            const auto u = points.at(i, (first_run_ + runs_) * n + k);
            const std::uint32_t triangle = triangle_of(i, u[2]);
            const Corners c = corners_of(p, triangle);
            const double cosine = glm::dot(glm::normalize(glm::cross(c.b - c.a, c.c - c.a)), to_sun);
            if (cosine > 0.0)
                looks.push_back(
                    {i, triangle, static_cast<float>(u[0]), static_cast<float>(u[1]), static_cast<float>(cosine)});
        }
    }
    Vector<double> lit(p.count(), 0.0);
    lines_traced_ += looks.size();
    trace_in_order(
        tracer_, looks.size(), executor, stop_,
        [&](std::uint64_t i) {
            const Look& look = looks[static_cast<std::size_t>(i)];
            lines::FirstHitQuery ray =
                local_ray(p, look.triangle, static_cast<double>(look.u), static_cast<double>(look.v), 1.0, 0.0);
            ray.line.direction = to_sun;
            return ray;
        },
        [&](std::uint64_t i, const lines::Hit& hit) {
            const Look& look = looks[static_cast<std::size_t>(i)];
            if (hit.triangle == lines::Hit::kNothing)
                lit[look.patch] += static_cast<double>(look.cosine);
            else if (!hit.front)
                --counts[look.patch];
        });
    for (std::size_t i = 0; i < p.count(); ++i)
        if (counts[i] > 0) arrived[i] += irradiance * (lit[i] / static_cast<double>(counts[i]));
}

}  // namespace crofton::radiosity
