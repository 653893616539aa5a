// A program outside the project that links the package: it must compile, link and answer.
#include <crofton/core/version.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstdio>

int main() {
    crofton::Obb box;
    box.half_extents = {1.0f, 2.0f, 3.0f};
    const double edges = crofton::measure::minimal_perimeter()(crofton::measure::of_box(box));
    std::printf("crofton %s: edge sum %g\n", crofton::version_string(), edges);
    return crofton::contains(box, {1.0, 2.0, 3.0}) && edges > 11.999 && edges < 12.001 ? 0 : 1;
}
