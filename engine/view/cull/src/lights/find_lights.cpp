// SPDX-License-Identifier: MIT
// The lights of each froxel: checks of the input, the work shared among threads, the lists put together.
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/lights.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "exact/box_constraints.hpp"
#include "exact/spot.hpp"
#include "lights/filter_light.hpp"

namespace crofton::cull {
namespace {

constexpr double kLargestLight = 1e12;
// A cone without a width is taken to have one, far below all rounding. With a sine of 0, support functions would take
// what is straight behind the apex to be in the cone.
constexpr double kLeastSine = 1e-30;

Error bad_light(std::size_t light, ErrorCode code, const char* why) {
    return fail(code, light, {"light ", light, ": ", why});
}

Result<void> check_place(std::size_t light, const glm::dvec3& place, double range) {
    for (int j = 0; j < 3; ++j) {
        if (!std::isfinite(place[j])) return bad_light(light, ErrorCode::non_finite, "its place is NaN or infinite");
        if (std::fabs(place[j]) > kLargestLight)
            return bad_light(light, ErrorCode::out_of_range, "its place is beyond 1e12; move the world's origin");
    }
    if (!std::isfinite(range)) return bad_light(light, ErrorCode::non_finite, "its range is NaN or infinite");
    if (range < 0.0 || range > kLargestLight)
        return bad_light(light, ErrorCode::out_of_range, "its range must be 0 to 1e12");
    return {};
}

Result<void> check_lights(std::span<const Sphere> points, std::span<const SpotLight> spots) {
    for (std::size_t i = 0; i < points.size(); ++i)
        if (auto valid = check_place(i, points[i].center, points[i].radius); !valid) return valid;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const std::size_t light = points.size() + i;
        const SpotLight& spot = spots[i];
        if (auto valid = check_place(light, spot.apex, static_cast<double>(spot.range)); !valid) return valid;
        if (!(spot.cos_half_angle >= 0.0f && spot.cos_half_angle <= 1.0f))
            return bad_light(light, ErrorCode::out_of_range, "the cosine of its half angle must be in [0, 1]");
        if (!std::isfinite(spot.axis.x) || !std::isfinite(spot.axis.y) || !std::isfinite(spot.axis.z))
            return bad_light(light, ErrorCode::non_finite, "its axis is NaN or infinite");
        if (spot.axis == glm::vec3(0.0f)) return bad_light(light, ErrorCode::degenerate, "its axis is zero");
    }
    return {};
}

}  // namespace

// One call of find_lights at work in the result's buffers.
class LightPass {
  public:
    LightPass(const FroxelGrid& grid, std::span<const Sphere> points, std::span<const SpotLight> spots,
              FroxelLights& result)
        : grid_(grid), points_(points), spots_(spots), result_(result), kernel_grid_(kernel_grid_of(grid)) {}

    // For a grid without froxels.
    static Result<void> list_nothing(FroxelLights& result) {
        result.offsets_.assign(1, 0);
        result.exact_tests_ = 0;
        return {};
    }

    Result<void> run(Executor& executor) {
        const std::size_t lights = points_.size() + spots_.size();
        const std::size_t parts = (lights + kLightsAPart - 1) / kLightsAPart;
        if (result_.parts_.size() < parts) result_.parts_.resize(parts);
        executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t p = begin; p < end; ++p)
                run_part(p, std::min<std::size_t>(kLightsAPart, lights - p * kLightsAPart));
        });
        return gather(parts);
    }

  private:
    static_assert(sizeof(LitRun) == sizeof(FroxelLights::Run));

    static FroxelKernelGrid kernel_grid_of(const FroxelGrid& grid) {
        const std::uint32_t size[3] = {grid.columns(), grid.rows(), grid.slices()};
        return {{size[0], size[1], size[2]},
                FroxelArrays<float>(grid.floats_.data(), size),
                FroxelArrays<double>(grid.doubles_.data(), size),
                grid.spread_,
                grid.start_};
    }

    struct Context {
        const LightPass* pass;
        std::size_t first;
        std::uint64_t exact_tests;
    };

    static bool decide(void* context, std::uint32_t light, std::uint32_t froxel) {
        auto& at = *static_cast<Context*>(context);
        ++at.exact_tests;
        const LightPass& pass = *at.pass;
        const std::size_t number = at.first + light;
        const Frustum frustum = pass.grid_.froxel(froxel);
        if (number < pass.points_.size())
            return classify_usable(frustum, pass.points_[number], CullMode::exact) != Verdict::outside;
        return meets(frustum, as_read(pass.spots_[number - pass.points_.size()]));
    }

    [[nodiscard]] KernelLight kernel_light(std::size_t number) const {
        KernelLight light{};
        light.is_spot = number >= points_.size();
        const auto to_frame = [&](const glm::dvec3& v, double* to) {
            for (int k = 0; k < 3; ++k) to[k] = glm::dot(grid_.axes_[k], v);
        };
        if (!light.is_spot) {
            to_frame(points_[number].center - grid_.origin_, light.at);
            light.radius = points_[number].radius;
            return light;
        }
        const SpotLight spot = as_read(spots_[number - points_.size()]);
        to_frame(spot.apex - grid_.origin_, light.at);
        to_frame(glm::normalize(glm::dvec3(spot.axis)), light.axis);
        light.radius = static_cast<double>(spot.range);
        light.cosine = static_cast<double>(spot.cos_half_angle);
        light.sine = std::max(std::sqrt(1.0 - light.cosine * light.cosine), kLeastSine);
        return light;
    }

    void run_part(std::size_t p, std::size_t count) const {
        FroxelLights::Part& part = result_.parts_[p];
        KernelLight lights[kLightsAPart];
        const std::size_t first = p * kLightsAPart;
        for (std::size_t i = 0; i < count; ++i) lights[i] = kernel_light(first + i);
        Context context{this, first, 0};
        const FroxelKernelInput input{
            &kernel_grid_, lights,  static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(first),
            decide,        &context};
        part.count = 0;
        SpotBatch batch;
        const auto free_runs = [&](std::size_t room) {
            if (part.runs.size() < part.count + room) part.runs.resize(2 * part.count + room);
            return reinterpret_cast<LitRun*>(part.runs.data() + part.count);
        };
        for (std::uint32_t i = 0; i < count; ++i)
            part.count += run_froxel_kernel(input, i, batch, free_runs(SpotBatch::kPairs + grid_.size()));
        part.count += finish_spots(input, batch, free_runs(SpotBatch::kPairs + 1));
        part.exact_tests = context.exact_tests;
    }

    // A counting sort: the lights of a froxel come in the order of the parts, so ascending.
    Result<void> gather(std::size_t parts) {
        std::uint64_t pairs = 0, exact_tests = 0;
        for (std::size_t p = 0; p < parts; ++p) {
            const FroxelLights::Part& part = result_.parts_[p];
            for (std::size_t r = 0; r < part.count; ++r)
                pairs += static_cast<std::uint64_t>(std::popcount(part.runs[r].mask));
            exact_tests += part.exact_tests;
        }
        if (pairs > std::numeric_limits<std::uint32_t>::max())
            return fail(ErrorCode::out_of_range, kNoItem,
                        "lights: 2^32 pairs or more; use fewer lights, shorter ranges or a coarser grid");
        result_.exact_tests_ = exact_tests;
        Vector<std::uint32_t>& offsets = result_.offsets_;
        offsets.assign(grid_.size() + 2, 0);
        for_each_pair(parts, [&](std::uint32_t froxel, std::uint32_t) { ++offsets[froxel + 2]; });
        for (std::size_t f = 2; f < offsets.size(); ++f) offsets[f] += offsets[f - 1];
        if (result_.lights_.size() < pairs) result_.lights_.resize(pairs);
        std::uint32_t* to = result_.lights_.data();
        for_each_pair(parts, [&](std::uint32_t froxel, std::uint32_t light) { to[offsets[froxel + 1]++] = light; });
        offsets.pop_back();
        return {};
    }

    template <class Visit>
    void for_each_pair(std::size_t parts, const Visit& visit) const {
        for (std::size_t p = 0; p < parts; ++p) {
            const FroxelLights::Part& part = result_.parts_[p];
            for (std::size_t r = 0; r < part.count; ++r) {
                const FroxelLights::Run run = part.runs[r];
                for (std::uint32_t mask = run.mask; mask; mask &= mask - 1)
                    visit(run.froxel + static_cast<std::uint32_t>(std::countr_zero(mask)), run.light);
            }
        }
    }

    const FroxelGrid& grid_;
    std::span<const Sphere> points_;
    std::span<const SpotLight> spots_;
    FroxelLights& result_;
    FroxelKernelGrid kernel_grid_;
};

Result<void> find_lights(const FroxelGrid& grid, std::span<const Sphere> points, std::span<const SpotLight> spots,
                         FroxelLights& result, Executor& executor) {
    if (auto valid = check_lights(points, spots); !valid) return valid;
    if (grid.size() == 0) return LightPass::list_nothing(result);
    return LightPass(grid, points, spots, result).run(executor);
}

}  // namespace crofton::cull
