// SPDX-License-Identifier: MIT
// Estimates by sampled cameras how much an occluder hides.
#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/occlude/occluder.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

namespace crofton::occlude {
namespace {

// The k-th number of the van der Corput sequence: Halton's points are spread evenly at any count.
double halton(std::uint32_t k, std::uint32_t base) {
    double result = 0.0, digit = 1.0 / base;
    for (std::uint32_t rest = k + 1; rest != 0; rest /= base, digit /= base) result += digit * (rest % base);
    return result;
}

Result<void> check_scene(const SeenScene& scene) {
    const auto bad = [](ErrorCode code, const char* why) { return fail(code, kNoItem, {"occlusion_worth: ", why}); };
    const glm::dvec3 size = scene.eyes.max - scene.eyes.min;
    if (scene.eyes.is_empty() || !std::isfinite(size.x + size.y + size.z))
        return bad(ErrorCode::invalid_argument, "the eyes' region is empty or not finite");
    if (!(scene.range > 0.0 && std::isfinite(scene.range)))
        return bad(ErrorCode::out_of_range, "the range must be positive and finite");
    if (scene.samples == 0) return bad(ErrorCode::out_of_range, "samples must be at least 1");
    if (!(scene.object.mean_curvature >= 0.0 && std::isfinite(scene.object.mean_curvature)))
        return bad(ErrorCode::out_of_range, "the object's mean curvature must be finite and not negative");
    return {};
}

}  // namespace

Result<double> occlusion_worth(std::span<const glm::dvec3> points, const SeenScene& scene) {
    if (auto status = check_scene(scene); !status) return status.error();
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    Vector<glm::dvec3> body, shadow;
    for (const std::uint32_t i : hull->vertices) body.push_back(points[i]);
    double sum = 0.0;
    for (std::uint32_t k = 0; k < scene.samples; ++k) {
        const glm::dvec3 at(halton(k, 2), halton(k, 3), halton(k, 5));
        const glm::dvec3 eye = scene.eyes.min + at * (scene.eyes.max - scene.eyes.min);
        // Scales the shadow until its farthest corner is at the range. The part that other corners' rays reach beyond
        // is ignored.
        double farthest = 0.0;
        for (const glm::dvec3& p : body) farthest = std::max(farthest, glm::distance(p, eye));
        if (!(farthest > 0.0) || farthest >= scene.range) continue;
        shadow.assign(body.begin(), body.end());
        for (const glm::dvec3& p : body) shadow.push_back(eye + (scene.range / farthest) * (p - eye));
        shadow.push_back(eye);
        const auto with_eye = convex_hull(shadow);
        if (!with_eye) return with_eye.error();
        const auto last = static_cast<std::uint32_t>(shadow.size() - 1);
        if (std::find(with_eye->vertices.begin(), with_eye->vertices.end(), last) == with_eye->vertices.end())
            continue;  // inside
        shadow.pop_back();
        const auto volumes = measure::intrinsic_volumes_of_hull(shadow);
        if (!volumes) return volumes.error();
        sum += std::max(0.0, volumes->volume - volumes->area * scene.object.mean_curvature / (4.0 * std::numbers::pi));
    }
    return sum / scene.samples;
}

}  // namespace crofton::occlude
