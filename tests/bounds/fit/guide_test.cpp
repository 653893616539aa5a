// SPDX-License-Identifier: MIT
// The example of docs/fit.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/fit/fit.hpp>
#include <cstdio>
#include <vector>

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

int fit_roof() {
    // clang-format off
    const std::vector<glm::vec3> points = {{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}, {2, 1, 1}};

    // The box for culling: default quality, default criterion.
    const crofton::Result<crofton::Obb> box = crofton::fit::fit_obb(points);
    if (!box) return report(box.error());  // which point is bad, and why

    // The box that a random ray is least likely to hit, with a proof.
    const auto proved = crofton::fit::fit_exact(points, {.criterion = crofton::measure::minimal_area()});
    if (!proved) return report(proved.error());
    std::printf("area %g, and no box has less than %g\n", proved->value, proved->lower_bound);
    // clang-format on
    for (const glm::vec3& p : points)
        if (!contains(*box, glm::dvec3(p)) || !contains(proved->box, glm::dvec3(p))) return 2;
    return proved->lower_bound <= proved->value ? 0 : 3;
}

}  // namespace

TEST_SUITE("fit/guide") {
    TEST_CASE("the example of the guide runs, and its boxes hold all points") {
        CHECK(fit_roof() == 0);
    }
}
