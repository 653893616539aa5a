// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "pipeline/largest_region.hpp"

using namespace crofton::pipeline;

namespace {

using Ways = std::vector<std::vector<std::uint32_t>>;

void join(Ways& ways, std::uint32_t a, std::uint32_t b) {
    ways[a].push_back(b);
    ways[b].push_back(a);
}

// By labels that spread until none changes: each place has the lowest number of its region.
std::vector<std::uint32_t> region_by_labels(std::span<const glm::dvec3> places, const Ways& ways) {
    std::vector<std::uint32_t> label(places.size());
    for (std::uint32_t i = 0; i < label.size(); ++i) label[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (std::uint32_t i = 0; i < label.size(); ++i)
            for (const std::uint32_t other : ways[i])
                if (label[other] < label[i]) {
                    label[i] = label[other];
                    changed = true;
                }
    }
    std::vector<std::uint32_t> best;
    double best_height = 0.0;
    for (std::uint32_t name = 0; name < label.size(); ++name) {
        std::vector<std::uint32_t> region;
        double height = 0.0;
        for (std::uint32_t i = 0; i < label.size(); ++i) {
            if (label[i] != name) continue;
            region.push_back(i);
            height += places[i].y;
        }
        if (region.empty() || region.size() < best.size()) continue;
        height /= static_cast<double>(region.size());
        if (region.size() == best.size() && height >= best_height) continue;
        best = region;
        best_height = height;
    }
    return best;
}

}  // namespace

TEST_SUITE("pipeline/largest_region") {
    TEST_CASE("no place has no region, and one place is its own") {
        CHECK(largest_region({}, {}).empty());
        const std::vector<glm::dvec3> places(1);
        CHECK(largest_region(places, Ways(1)) == std::vector<std::uint32_t>{0});
    }
    TEST_CASE("random graphs of few to many regions agree with labels that spread") {
        std::mt19937 random(1);
        const auto draw = [&](std::uint32_t below) { return static_cast<std::uint32_t>(random() % below); };
        for (int trial = 0; trial < 400; ++trial) {
            CAPTURE(trial);
            const std::uint32_t count = 1 + draw(60);
            const std::uint32_t joins = draw(60);
            std::vector<glm::dvec3> places(count);
            // Multiples of all numbers up to 30: means are exact, in whatever order they are summed.
            for (std::uint32_t i = 0; i < count; ++i) places[i].y = 2329089562800.0 * (1u + i * 7u % 13u);
            Ways ways(count);
            for (std::uint32_t i = 0; i < joins; ++i) {
                const std::uint32_t a = draw(count);
                const std::uint32_t b = draw(count);
                join(ways, a, b);
            }
            CHECK(largest_region(places, ways) == region_by_labels(places, ways));
        }
    }
    // A pass over all places for each region would take hours.
    TEST_CASE("a million regions take no longer than a million places of one") {
        constexpr std::uint32_t kCount = 1'000'000;
        std::vector<glm::dvec3> places(kCount, glm::dvec3(0.0, 2.0, 0.0));
        places[777].y = 1.0;
        Ways ways(kCount);
        CHECK(largest_region(places, ways) == std::vector<std::uint32_t>{777});
        join(ways, 5, kCount - 1);
        CHECK(largest_region(places, ways) == std::vector<std::uint32_t>{5, kCount - 1});
        for (std::uint32_t i = 1; i < kCount; ++i) join(ways, i - 1, i);
        CHECK(largest_region(places, ways).size() == kCount);
    }
}
