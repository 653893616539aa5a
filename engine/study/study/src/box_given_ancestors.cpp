// SPDX-License-Identifier: MIT
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <utility>

#include "ancestor_directions.hpp"
#include "box_search.hpp"
#include "direction_cells.hpp"

namespace crofton::study {

Result<BoxGivenAncestors> box_given_ancestors(std::span<const glm::dvec3> points, std::span<const ConvexBody> ancestors,
                                              const BoxGivenAncestorsOptions& options) {
    if (!(options.tolerance > 0.0 && options.tolerance < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "box given ancestors: `tolerance` must lie in (0, 1)");
    if (auto valid = validate_bodies(ancestors); !valid) return valid.error();
    const auto plain = fit::fit_obb(points, {.criterion = measure::minimal_perimeter()});
    if (!plain) return plain.error();
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    const auto least = fit::minimal_sphere(points);
    if (!least) return least.error();
    if (!(least->radius > 0.0))
        return fail(ErrorCode::degenerate, kNoItem, "box given ancestors: the object is a point");
    const AncestorDirections directions(ancestors);
    if (!directions.contain(points))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "box given ancestors: the object is not inside its ancestors' bounds");
    Vector<glm::dvec3> corners;
    for (const std::uint32_t v : hull->vertices) corners.push_back(points[v] - least->center);
    const BoxSearch search(std::move(corners), least->center, directions);
    BoxGivenAncestors result;
    glm::dmat3 best(plain->axes);
    result.value = result.plain_value = search.measure_of(best);
    search.run(options, best, result);
    // Axes and extents are rounded to floats, by 1e-7 of the box.
    const auto box = fit::fit_oriented(points, glm::mat3(best));
    if (!box) return box.error();
    result.box = *box;
    return result;
}

}  // namespace crofton::study
