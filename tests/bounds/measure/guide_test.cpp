// SPDX-License-Identifier: MIT
// The example of docs/measure.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/measure/measure.hpp>
#include <cstdio>

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

int compare_shapes() {
    // clang-format off
    using namespace crofton;

    // How often does a camera that moves uniformly see a crate, and a sheet of the same volume?
    const Camera camera;  // 60 degrees, from 0.1 m to 1000 m
    const auto view = measure::intrinsic_volumes_of_frustum(camera);
    if (!view) return report(view.error());
    const double crate = measure::kinematic_measure(*view, measure::intrinsic_volumes_of_box(1.0, 1.0, 1.0));
    const double sheet = measure::kinematic_measure(*view, measure::intrinsic_volumes_of_box(5.0, 5.0, 0.04));
    std::printf("the sheet is seen %.3f times as often\n", sheet / crate);

    // The criterion by which boxes should be fitted for this camera.
    const measure::Criterion criterion = measure::for_frustum(camera).value();
    // clang-format on
    return sheet > crate && measure::validate(criterion) ? 0 : 2;
}

}  // namespace

TEST_SUITE("measure/guide") {
    TEST_CASE("the example of the guide runs: a sheet is seen more often than a crate of its volume") {
        CHECK(compare_shapes() == 0);
    }
}
