#include <algorithm>
#include <cmath>
#include <crofton/radiosity/form_factors.hpp>
#include <crofton/radiosity/solver.hpp>
#include <limits>

#include "local_lines.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::size_t kRayBatch = 1024;
constexpr std::size_t kWave = 32;  // batches in flight: traced by any thread, added up in order by one
// Streams of random numbers within a run; bounces come after the light sources.
constexpr std::uint64_t kStreamsPerRun = 1u << 12, kLampStream = 0, kSunStream = 1, kFirstBounce = 2;

std::uint64_t mixed(std::uint64_t seed, std::uint64_t stream) {  // SplitMix64's finaliser
    std::uint64_t z = seed + 0x9e3779b97f4a7c15u * (stream + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Traces rays 0 … count−1 that make(i) gives, and hands each with what it met to `take`, in order.
template <class Make, class Take>
void trace_in_order(const LineTracer& tracer, std::uint64_t count, Executor& executor, Make&& make, Take&& take) {
    Vector<Hit> hits(kWave * kRayBatch);
    for (std::uint64_t first = 0; first < count; first += hits.size()) {
        const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(hits.size(), count - first));
        executor.parallel_for(now, kRayBatch, [&](std::size_t begin, std::size_t end, unsigned) {
            Vector<Ray> rays;
            for (std::size_t i = begin; i < end; ++i) rays.push_back(make(first + i));
            tracer.first_hits(rays, std::span(hits).subspan(begin, end - begin));
        });
        for (std::size_t i = 0; i < now; ++i) take(first + i, hits[i]);
    }
}

// Triangles by cumulative weight.
Vector<double> cumulative(std::size_t count, auto&& weight) {
    Vector<double> sums(count);
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sums[i] = sum += weight(i);
    return sums;
}
std::uint32_t find(const Vector<double>& sums, double u) {
    const auto found = std::upper_bound(sums.begin(), sums.end(), u * sums.back());
    return static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1));
}

double total(const glm::dvec3& v) {
    return v.x + v.y + v.z;
}

}  // namespace

Solver::Solver(const Patches& patches, const SolverOptions& options, LineTracer tracer, LineMethod method)
    : patches_(&patches),
      options_(options),
      tracer_(std::move(tracer)),
      source_(tracer_.bounds(), method, options.seed) {
    sum_.assign(patches.count(), glm::dvec3(0.0));
    squares_ = sum_;
    mean_.assign(patches.count(), glm::vec3(0.0f));
}

Result<Solver> Solver::create(const Patches& patches, const SolverOptions& options) {
    const auto valid = [](const glm::vec3& v) {
        return v.x >= 0.0f && v.y >= 0.0f && v.z >= 0.0f && std::isfinite(v.x + v.y + v.z);
    };
    if (!valid(options.outside.sky) || !valid(options.outside.sun))
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: sky and sun must be finite and not negative");
    if (options.lines == 0 || options.first_shot == 0 || !(options.cutoff > 0.0))
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: lines, first_shot and cutoff must be positive");
    const glm::vec3 outside = options.outside.sky + options.outside.sun;
    bool light = outside.x + outside.y + outside.z > 0.0f;
    for (const Material& m : patches.materials) light = light || m.emission.x + m.emission.y + m.emission.z > 0.0f;
    if (!light)
        return fail(ErrorCode::empty, kNoItem,
                    "radiosity: nothing gives light; give a patch emission, or a sky or sun");
    if (outside.x + outside.y + outside.z > 0.0f && !(glm::length(options.outside.to_sun) > 0.0))
        return fail(ErrorCode::degenerate, kNoItem, "radiosity: the direction to the sun has no length");
    auto tracer = LineTracer::build(patches.mesh);
    if (!tracer) return tl::unexpected(tracer.error());
    const LineMethod method = options.method ? *options.method : choose_method(*tracer, options.seed);
    return Solver(patches, options, std::move(*tracer), method);
}

void Solver::shoot_lamps(Light& arrived, Executor& executor) const {
    const Patches& p = *patches_;
    const auto emission = [&](std::uint32_t t) { return glm::dvec3(p.materials[p.patch_of_triangle[t]].emission); };
    const Vector<double> sums = cumulative(p.triangle_areas.size(), [&](std::size_t t) {
        return p.triangle_areas[t] * total(emission(static_cast<std::uint32_t>(t)));
    });
    if (!(sums.back() > 0.0)) return;
    const measure::UnitPoints points(mixed(options_.seed, kStreamsPerRun * runs_ + kLampStream));
    const double each = sums.back() / static_cast<double>(options_.first_shot);
    trace_in_order(
        tracer_, options_.first_shot, executor,
        [&](std::uint64_t i) {
            const auto u = points.at<5>(i);
            return local_ray(p, find(sums, u[4]), u[0], u[1], std::sqrt(u[2]), u[3]);
        },
        [&](std::uint64_t i, const Hit& hit) {
            if (hit.triangle == Hit::kNothing || !hit.front) return;
            const glm::dvec3 color = emission(find(sums, points.at<5>(i)[4]));
            const std::uint32_t to = p.patch_of_triangle[hit.triangle];
            arrived[to] += color * (each / total(color) / p.areas[to]);
        });
}

// Parallel rays over the disc that the scene's sphere shows to the sun.
void Solver::shoot_sun(Light& arrived, Executor& executor) const {
    const glm::dvec3 irradiance(options_.outside.sun);
    if (!(total(irradiance) > 0.0)) return;
    const Patches& p = *patches_;
    const glm::dvec3 to_sun = glm::normalize(options_.outside.to_sun), center = tracer_.bounds().center();
    const glm::dvec3 side =
        glm::normalize(glm::cross(std::abs(to_sun.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), to_sun));
    const glm::dvec3 up = glm::cross(to_sun, side);
    const double radius = glm::length(tracer_.bounds().half_extents());
    const measure::UnitPoints points(mixed(options_.seed, kStreamsPerRun * runs_ + kSunStream));
    const std::uint64_t count = 4 * options_.first_shot;
    const double each = std::numbers::pi * radius * radius / static_cast<double>(count);
    trace_in_order(
        tracer_, count, executor,
        [&](std::uint64_t i) {
            const auto u = points.at<2>(i);
            const double r = radius * std::sqrt(u[0]), angle = 2.0 * std::numbers::pi * u[1];
            return Ray{{center + radius * to_sun + r * (std::cos(angle) * side + std::sin(angle) * up), -to_sun},
                       Hit::kNothing};
        },
        [&](std::uint64_t, const Hit& hit) {
            if (hit.triangle == Hit::kNothing || !hit.front) return;
            const std::uint32_t to = p.patch_of_triangle[hit.triangle];
            arrived[to] += irradiance * (each / p.areas[to]);
        });
}

void Solver::gather_global(const Light& leaving, bool sky, std::uint64_t stream, Light& arrived, Executor& executor) {
    const LineSource source(tracer_.bounds(), source_.method(), mixed(options_.seed, stream));
    const std::uint64_t blocks = (options_.lines + LineSource::kBlock - 1) / LineSource::kBlock;
    const glm::dvec3 from_sky = sky ? glm::dvec3(options_.outside.sky) : glm::dvec3(0.0);
    rays_.assign(patches_->count(), 0);
    Vector<LineHits> hits(kWave);
    for (std::uint64_t first = 0; first < blocks; first += kWave) {
        const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(kWave, blocks - first));
        executor.parallel_for(now, 1, [&](std::size_t begin, std::size_t end, unsigned) {
            Vector<measure::Line> lines;
            for (std::size_t b = begin; b < end; ++b) {
                source.draw(first + b, lines);
                tracer_.all_hits(lines, hits[b]);
            }
        });
        for (std::size_t b = 0; b < now; ++b) {
            std::uint32_t begin = 0;
            lines_traced_ += hits[b].ends.size();
            for (const std::uint32_t end : hits[b].ends) {
                for_each_ray(std::span<const Hit>(hits[b].hits).subspan(begin, end - begin), *patches_,
                             [&](std::uint32_t i, std::uint32_t j) {
                                 ++rays_[i];
                                 if (j == kSky)
                                     arrived[i] += from_sky;
                                 else if (j != kBack)
                                     arrived[i] += leaving[j];
                             });
                begin = end;
            }
        }
    }
    for (std::size_t i = 0; i < arrived.size(); ++i) {
        if (rays_[i] > 0)
            arrived[i] /= static_cast<double>(rays_[i]);
        else
            ++unseen_;
    }
    seen_ += arrived.size();
}

void Solver::gather_local(const Light& leaving, bool sky, std::uint64_t stream, Light& arrived, Executor& executor) {
    // Global lines start 2·N·A/F rays on a patch of area A: shared out the same way, but at least one each.
    const Patches& p = *patches_;
    const glm::dvec3 from_sky = sky ? glm::dvec3(options_.outside.sky) : glm::dvec3(0.0);
    const double per_area = 2.0 * static_cast<double>(options_.lines) / source_.surface_area();
    Vector<std::uint64_t> ends;
    Vector<std::uint32_t> counts(p.count(), 0);
    std::uint64_t count = 0;
    for (std::size_t t = 0; t < p.triangle_areas.size(); ++t) {
        const auto rays =
            std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(per_area * p.triangle_areas[t])));
        counts[p.patch_of_triangle[t]] += static_cast<std::uint32_t>(rays);
        ends.push_back(count += rays);
    }
    lines_traced_ += count;
    const auto triangle_of = [&](std::uint64_t i) {
        return static_cast<std::uint32_t>(std::upper_bound(ends.begin(), ends.end(), i) - ends.begin());
    };
    const measure::UnitPoints points(mixed(options_.seed, stream));
    trace_in_order(
        tracer_, count, executor,
        [&](std::uint64_t i) {
            const auto u = points.at<4>(i);
            return local_ray(p, triangle_of(i), u[0], u[1], std::sqrt(u[2]), u[3]);
        },
        [&](std::uint64_t i, const Hit& hit) {
            glm::dvec3& here = arrived[p.patch_of_triangle[triangle_of(i)]];
            if (hit.triangle == Hit::kNothing)
                here += from_sky;
            else if (hit.front)
                here += leaving[p.patch_of_triangle[hit.triangle]];
        });
    for (std::size_t i = 0; i < arrived.size(); ++i) arrived[i] /= static_cast<double>(counts[i]);
    seen_ += arrived.size();
}

double Solver::power(const Light& light) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i) sum += patches_->areas[i] * total(light[i]);
    return sum;
}

void Solver::run(Executor& executor) {
    const Patches& p = *patches_;
    Light arrived(p.count(), glm::dvec3(0.0)), leaving, all(p.count());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = glm::dvec3(p.materials[i].emission);
    const auto give_back = [&] {
        for (std::size_t i = 0; i < all.size(); ++i) {
            leaving[i] = arrived[i] * glm::dvec3(p.materials[i].reflectance);
            all[i] += leaving[i];
            arrived[i] = glm::dvec3(0.0);
        }
    };
    shoot_lamps(arrived, executor);
    shoot_sun(arrived, executor);
    leaving.resize(p.count());
    give_back();
    bool sky = total(glm::dvec3(options_.outside.sky)) > 0.0;
    for (bounces_ = 0; bounces_ < options_.most_bounces && (sky || power(leaving) > options_.cutoff * power(all));
         ++bounces_) {
        const std::uint64_t stream = kStreamsPerRun * runs_ + kFirstBounce + bounces_;
        if (options_.transport == Transport::global)
            gather_global(leaving, sky, stream, arrived, executor);
        else
            gather_local(leaving, sky, stream, arrived, executor);
        sky = false;
        give_back();
    }
    add_run(all);
}

}  // namespace crofton::radiosity
