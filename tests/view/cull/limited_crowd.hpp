// SPDX-License-Identifier: MIT
// Draw limits as they are defined, and random crowds with limits at which some of their boxes lie.
#pragma once
#include <gmpxx.h>
#include <cmath>
#include <crofton/cull/cull.hpp>
#include <cstdint>
#include <limits>
#include <oracle/random_boxes.hpp>
#include <vector>

namespace crofton::testing {

// The definition of DrawLimits, in rationals.
inline bool oracle_keeps(const cull::DrawLimits& limits, const Obb& box, std::uint32_t item, std::uint32_t layers) {
    mpq_class distance = 0, radius = 0;
    for (int j = 0; j < 3; ++j) {
        const mpq_class step = mpq_class(box.center[j]) - mpq_class(limits.eye[j]);
        distance += step * step;
        radius += mpq_class(double(box.half_extents[j])) * mpq_class(double(box.half_extents[j]));
    }
    mpq_class longer = 1;
    if (item / 64 < limits.drawn_before.size() && limits.drawn_before[item / 64] >> (item % 64) & 1)
        longer = limits.hysteresis;
    const auto within = [&](double limit, const mpq_class& size) {
        if (!std::isfinite(limit)) return true;
        const mpq_class most = longer * mpq_class(limit);
        return distance <= most * most * size;
    };
    const mpq_class least = mpq_class(limits.least_radius) / longer;
    if (radius < least * least || !within(limits.max_distance_in_radii, radius)) return false;
    if (!limits.item_distances.empty() && !within(double(limits.item_distances[item]), 1)) return false;
    if (limits.layer_distances.empty()) return true;
    for (std::uint32_t l = 0; l < 32; ++l)
        if (layers >> l & 1 && within(double(limits.layer_distances[l]), 1)) return true;
    return false;
}

struct LimitedCrowd {
    oracle::Crowd crowd;
    std::vector<float> layer_distances, item_distances;
    std::vector<std::uint64_t> drawn;
    cull::View view;
    cull::DrawLimits limits;

    LimitedCrowd(std::uint64_t seed, std::size_t count, double offset)
        : crowd(oracle::random_crowd(count, offset, seed)) {
        oracle::NearMisses random(seed, offset);
        Camera camera = random.camera();
        camera.far_distance = camera.near_distance + 200.0;
        view = {*frustum_of(camera), random.index(2) ? ~0u : 7u};
        limits.eye = camera.position;
        if (random.index(4)) limits.max_distance_in_radii = random.number(5.0, 100.0);
        if (random.index(4) == 0) limits.least_radius = random.number(0.1, 1.0);
        for (int l = 0; l < 32; ++l)
            layer_distances.push_back(l % 7 == 6 ? std::numeric_limits<float>::infinity()
                                                 : float(random.number(0.0, 80.0)));
        if (random.index(2)) limits.layer_distances = layer_distances;
        for (std::size_t i = 0; i < count; ++i) item_distances.push_back(float(random.number(0.0, 150.0)));
        if (random.index(3) == 0) limits.item_distances = item_distances;
        for (std::size_t w = 0; w < count / 128; ++w)
            drawn.push_back(std::uint64_t{random.index(~0u)} << 32 | random.index(~0u));
        if (random.index(2)) {
            limits.drawn_before = drawn;
            limits.hysteresis = random.number(1.0, 1.5);
        }
        // Some exactly on a limit: five radii of √(1 + 4 + 4) away.
        for (std::size_t i = 0; i < count; i += 50) {
            crowd.boxes[i].half_extents = {1.0f, 2.0f, 2.0f};
            crowd.boxes[i].center = limits.eye + glm::dvec3(0.0, 0.0, i % 100 ? 15.0 : std::nextafter(15.0, 20.0));
        }
        if (seed % 3 == 0) limits.max_distance_in_radii = 5.0;
    }

    std::vector<cull::ItemId> expected() const {
        std::vector<cull::ItemId> ids;
        for (cull::ItemId i = 0; i < crowd.boxes.size(); ++i)
            if (crowd.layers[i] & view.layer_mask &&
                cull::classify(view.frustum, crowd.boxes[i]) != cull::Verdict::outside &&
                oracle_keeps(limits, crowd.boxes[i], i, crowd.layers[i] & view.layer_mask))
                ids.push_back(i);
        return ids;
    }
};

}  // namespace crofton::testing
