// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdio>
#include <glm/geometric.hpp>

#include "occlude_setups.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using sampling::Random;

constexpr std::size_t kManyOccluders = 1000;  // each ray takes long

struct OccludeCounts {
    std::uint64_t rays = 0, free = 0, hidden = 0, culled = 0, covered_rays = 0, passed = 0;
};

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

    [[nodiscard]] bool is_free(const oracle::WitnessRay& ray) const {
        const glm::dvec3 along = glm::normalize(ray.to - ray.from);
        for (std::size_t i = 0; i < radius_squared_.size(); ++i) {
            const glm::dvec3 to(center_[0][i] - ray.from.x, center_[1][i] - ray.from.y, center_[2][i] - ray.from.z);
            const glm::dvec3 beside = glm::cross(to, along);
            if (glm::dot(beside, beside) <= radius_squared_[i] && !oracle::surely_passes(ray, (*boxes_)[i]))
                return false;
        }
        return true;
    }

  private:
    const std::vector<Obb>* boxes_;
    std::vector<double> center_[3], radius_squared_;
};

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
            const glm::dvec3 point = test::point_of(random, setup.objects[i]);
            ++counts.rays;
            if (!test::is_in_view(frustum, point) || !blockers.is_free(test::ray_to(setup.camera, point))) continue;
            ++counts.free;
            counts.culled += !shown[i];
        }
    }
}

// A ray through each of some covered squares, up to the depth that is stored there: it must not be free.
void ask_for_pixels(Random& random, const OccludeSetup& setup, const Blockers& blockers,
                    const occlude::OcclusionBuffer& buffer, OccludeCounts& counts) {
    const int rays = setup.occluders.size() > kManyOccluders ? 256 : 2048;
    for (int n = 0; n < rays; ++n) {
        const auto x = static_cast<std::uint32_t>(random.bits() % setup.size.width);
        const auto y = static_cast<std::uint32_t>(random.bits() % setup.size.height);
        if (buffer.nearness(x, y) < -1e38f) continue;
        const double u = random.uniform(), v = random.uniform();
        const double distance = test::distance_of(setup.camera, buffer.nearness(x, y));
        ++counts.covered_rays;
        counts.passed += blockers.is_free(test::ray_through(setup, x + u, y + v, distance));
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
