// SPDX-License-Identifier: MIT
// A program outside the project that links the package: it must compile, link and answer, from every room of
// crofton::crofton.
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/version.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdio>

int main() {
    crofton::Obb box;
    box.half_extents = {1.0f, 2.0f, 3.0f};
    const double edges = crofton::measure::minimal_perimeter()(crofton::measure::intrinsic_volumes_of_box(box));
    bool good = edges > 11.999 && edges < 12.001 && crofton::contains(box, {1.0, 2.0, 3.0});
    good = good && crofton::collide::intersects(box, box);
    const glm::vec3 points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    good = good && crofton::fit::fit_obb(points).has_value();
    crofton::scene::Scene scene;
    good = good && scene.update().nodes_updated == 0;
    crofton::cull::VisibleSet visible;
    const auto frustum = crofton::frustum_of(crofton::Camera{});
    if (frustum) crofton::cull::find_visible({&box, 1}, {}, {.frustum = *frustum}, visible);
    good = good && visible.size() == 1;
    // A template of the library's, which a shared one has to export too.
    crofton::cull::BoxSet set;
    set.assign({&box, 1});
    crofton::cull::VerdictBits verdicts;
    if (frustum) crofton::cull::find_visible(set, {&box, 1}, {.frustum = *frustum}, verdicts);
    good = good && verdicts.visible.size() == 1 && verdicts.visible[0] == 1;
    std::printf("crofton %s: edge sum %g, %zu box in view\n", crofton::version_string(), edges, visible.size());
    return good ? 0 : 1;
}
