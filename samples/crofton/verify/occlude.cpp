// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlude_setups.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using sampling::Random;

constexpr std::size_t kManyOccluders = 1000;  // each ray takes long

struct OccludeCounts {
    std::uint64_t rays = 0, free = 0, hidden = 0, culled = 0, covered_rays = 0, passed = 0;
};

// The points from + t · along, t ≥ t_near; the question is about t = 1.
struct WitnessRay {
    glm::dvec3 from, along;
    double t_near;
};

// False only if the ray certainly meets no front of the box between the near plane and t = 1: its slabs, in double,
// with room for their rounding. A ray that cannot be decided is no witness.
bool may_block(const WitnessRay& ray, const Obb& box) {
    const glm::dvec3 from = ray.from - box.center;
    const glm::dvec3 axes[3] = {glm::dvec3(box.axes[0]), glm::dvec3(box.axes[1]), glm::dvec3(box.axes[2])};
    const double volume = glm::dot(axes[0], glm::cross(axes[1], axes[2]));
    const double size = glm::length(from) + glm::length(ray.along);
    double enter = -1e300, leave = 1e300, error = 0.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 normal = glm::cross(axes[(k + 1) % 3], axes[(k + 2) % 3]) / volume;
        const double at = glm::dot(normal, from), slope = glm::dot(normal, ray.along);
        const auto half = static_cast<double>(box.half_extents[k]);
        const double rounding = 1e-14 * (size + half);
        // Along this slab the ray is in it, or beside it, for all of 0 ≤ t ≤ 1; or that is unknown.
        if (std::fabs(slope) <= 1e3 * rounding) {
            if (std::fabs(at) - std::fabs(slope) > half + rounding) return false;
            if (std::fabs(at) + std::fabs(slope) < half - rounding) continue;
            return true;
        }
        const double a = (-half - at) / slope, b = (half - at) / slope;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
        error = std::max(error, 2.0 * rounding * (1.0 + std::max(std::fabs(a), std::fabs(b))) / std::fabs(slope));
    }
    return !(enter > leave + 2.0 * error || enter > 1.0 + error || enter < ray.t_near - error);
}

// Objects that may block rays: boxes, each with a slightly larger sphere around it that most rays miss.
class Blockers {
  public:
    explicit Blockers(const std::vector<Obb>& boxes) : boxes_(&boxes) {
        for (const Obb& box : boxes) {
            for (int k = 0; k < 3; ++k) center_[k].push_back(box.center[k]);
            const double radius = 1.001 * glm::length(glm::dvec3(box.half_extents)) + 1e-5;
            radius_squared_.push_back(radius * radius);
        }
    }

    [[nodiscard]] bool is_free(const WitnessRay& ray) const {
        const glm::dvec3 along = glm::normalize(ray.along);
        for (std::size_t i = 0; i < radius_squared_.size(); ++i) {
            const glm::dvec3 to(center_[0][i] - ray.from.x, center_[1][i] - ray.from.y, center_[2][i] - ray.from.z);
            const glm::dvec3 beside = glm::cross(to, along);
            if (glm::dot(beside, beside) <= radius_squared_[i] && may_block(ray, (*boxes_)[i])) return false;
        }
        return true;
    }

  private:
    const std::vector<Obb>* boxes_;
    std::vector<double> center_[3], radius_squared_;
};

bool is_in_view(const Frustum& frustum, const glm::dvec3& point) {
    for (const Plane& plane : frustum.view())
        if (!(glm::dot(plane.normal, point - frustum.origin) + plane.offset >= 0.0)) return false;
    return true;
}

WitnessRay ray_to(const Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const double depth = glm::dot(point - camera.position, forward);
    const double t_near = camera.near_distance / depth;
    if (camera.projection == Projection::perspective) return {camera.position, point - camera.position, t_near};
    return {point - forward * depth, forward * depth, t_near};
}

void ask_for_objects(Random& random, const OccludeSetup& setup, const Blockers& blockers,
                     const occlude::OcclusionBuffer& buffer, OccludeCounts& counts) {
    occlude::VisibleSet visible;
    occlude::find_visible(setup.objects, {}, buffer, visible);
    std::vector<bool> shown(setup.objects.size(), false);
    for (const boxtree::ItemId id : visible.ids()) shown[id] = true;
    const Frustum& frustum = buffer.view().frustum;
    for (std::size_t i = 0; i < setup.objects.size(); ++i) {
        counts.hidden += !shown[i];
        for (int n = 0; n < 8; ++n) {
            glm::dvec3 point = setup.objects[i].center;
            for (int k = 0; k < 3; ++k) {
                const double t = random.uniform(-1.0, 1.0), end = t < 0.0 ? -1.0 : 1.0;
                point += (k < n % 4 ? t : end) * static_cast<double>(setup.objects[i].half_extents[k]) *
                         glm::dvec3(setup.objects[i].axes[k]);
            }
            ++counts.rays;
            if (!is_in_view(frustum, point) || !blockers.is_free(ray_to(setup.camera, point))) continue;
            ++counts.free;
            counts.culled += !shown[i];
        }
    }
}

// A ray through each of some covered squares, up to the depth that is stored there: it must not be free.
void ask_for_pixels(Random& random, const OccludeSetup& setup, const Blockers& blockers,
                    const occlude::OcclusionBuffer& buffer, OccludeCounts& counts) {
    const Camera& camera = setup.camera;
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    const double half_x = 0.5 * setup.size.width, half_y = 0.5 * setup.size.height;
    const int rays = setup.occluders.size() > kManyOccluders ? 256 : 2048;
    for (int n = 0; n < rays; ++n) {
        const auto x = static_cast<std::uint32_t>(random.bits() % setup.size.width);
        const auto y = static_cast<std::uint32_t>(random.bits() % setup.size.height);
        const auto nearness = static_cast<double>(buffer.nearness(x, y));
        if (nearness < -1e38) continue;
        // 2^-6 of a pixel is left free along the picture's edges.
        const double u = (x + random.uniform() - half_x) / (half_x - 0x1p-6);
        const double v = (y + random.uniform() - half_y) / (half_y - 0x1p-6);
        WitnessRay ray{camera.position, {}, 0.0};
        if (camera.projection == Projection::perspective) {
            const double t = std::tan(0.5 * camera.fov_y);
            ray.along = to_world * glm::dvec3(u * t * camera.aspect, v * t, -1.0) / nearness;
            ray.t_near = camera.near_distance * nearness;
        } else {
            const double half = 0.5 * camera.height;
            ray.from += to_world * glm::dvec3(u * half * camera.aspect, v * half, 0.0);
            ray.along = glm::normalize(camera.forward) * -nearness;
            ray.t_near = camera.near_distance / -nearness;
        }
        ++counts.covered_rays;
        counts.passed += blockers.is_free(ray);
    }
}

// A few set-ups more where none of these rays is a witness or no square is covered.
template <class Make>
OccludeCounts run_setups(Random& random, std::uint64_t rays, const Make& make) {
    constexpr int kMostMore = 100;
    OccludeCounts counts;
    const auto lacks = [&] { return counts.free == 0 || counts.covered_rays == 0; };
    for (int more = 0; counts.rays < rays || (lacks() && more < kMostMore); more += counts.rays >= rays) {
        const OccludeSetup setup = make();
        occlude::OccluderSet set;
        for (const Obb& box : setup.occluders) (void)set.place(box);
        auto buffer = *occlude::OcclusionBuffer::create(setup.size);
        buffer.draw(set, *occlude::occlusion_view_of(setup.camera));
        const Blockers blockers(setup.occluders);
        ask_for_objects(random, setup, blockers, buffer, counts);
        ask_for_pixels(random, setup, blockers, buffer, counts);
    }
    return counts;
}

void add_none(std::vector<VerifyRow>& rows, const std::string& claim, std::uint64_t cases, std::uint64_t wrong) {
    rows.push_back(none_row(claim, "docs/notes/occlude.md", cases, wrong));
}

void add_rows(std::vector<VerifyRow>& rows, const std::string& where, const OccludeCounts& counts) {
    add_none(rows, "of " + std::to_string(counts.free) + " rays that witness an object none has it culled, " + where,
             counts.free, counts.culled);
    add_none(rows, "no ray passes a covered pixel, " + where, counts.covered_rays, counts.passed);
}

constexpr double kOffsets[] = {0.0, 1e4, 1e5, 1e6, 1e7};

}  // namespace

std::vector<VerifyRow> verify_occlude(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const double offset : kOffsets) {
        Random random(options.seed);
        const OccludeCounts counts = run_setups(random, options.trials, [&] { return random_setup(random, offset); });
        char where[64];
        std::snprintf(where, sizeof where, "at camera offset %g", offset);
        add_rows(rows, where, counts);
    }
    for (const HardSetup& hard : hard_setups()) {
        Random random(options.seed);
        std::size_t turn = 0;
        const std::uint64_t rays = std::max<std::uint64_t>(1, options.trials / hard.trials_a_ray);
        const OccludeCounts counts =
            run_setups(random, rays, [&] { return hard.make(random, kOffsets[turn++ % std::size(kOffsets)]); });
        char offsets[64] = ", offset 0";  // those that were used: slow set-ups are few
        if (turn > 1)
            std::snprintf(offsets, sizeof offsets, ", offsets 0 to %g",
                          kOffsets[std::min(turn, std::size(kOffsets)) - 1]);
        add_rows(rows, std::string(hard.name) + offsets, counts);
    }
    return rows;
}

}  // namespace crofton::cli
