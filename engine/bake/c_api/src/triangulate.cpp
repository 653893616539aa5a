// SPDX-License-Identifier: MIT
#include <crofton/capi/bake.h>

#include <crofton/triangulate/triangulate.hpp>

#include <crofton/capi/call.hpp>

using namespace crofton;
using namespace crofton::capi;

struct crofton_triangulator {
    static constexpr std::uint32_t kKind = 0x43724f06;
    Header header;
    triangulate::Triangulator triangulator{};
    Polygon polygon{};
    triangulate::Triangulation result{};
};

namespace {

// Ring ends are indices into the points: they must be sound before anything follows them.
crofton_status copy_polygon(const crofton_polygon* polygon, const char* function, Polygon& result) {
    CROFTON_CHECK(check_struct(polygon, function));
    CROFTON_CHECK(check_array(polygon->points, polygon->point_count, function, 2));
    CROFTON_CHECK(check_array(polygon->ring_ends, polygon->ring_count, function));
    if (polygon->point_count > CROFTON_NONE || polygon->ring_count > CROFTON_NONE)
        return report(CROFTON_OUT_OF_RANGE, function, "32 bits number the points and the rings");
    std::uint32_t end = 0;
    for (std::size_t r = 0; r < polygon->ring_count; ++r) {
        if (polygon->ring_ends[r] < end || polygon->ring_ends[r] > polygon->point_count)
            return report(CROFTON_OUT_OF_RANGE, function, "ring ends must ascend to the number of points", r);
        end = polygon->ring_ends[r];
    }
    if (end != polygon->point_count)
        return report(CROFTON_OUT_OF_RANGE, function, "the last ring must end at the number of points");
    return recover(function, [&] {
        const auto* points = reinterpret_cast<const glm::dvec2*>(polygon->points);
        result.points.assign(points, points + polygon->point_count);
        result.ring_ends.assign(polygon->ring_ends, polygon->ring_ends + polygon->ring_count);
        return CROFTON_OK;
    });
}

}  // namespace

crofton_status crofton_triangulator_create(crofton_triangulator** triangulator) {
    CROFTON_CHECK(check_pointer(triangulator, __func__));
    return create(triangulator, __func__);
}

crofton_status crofton_triangulator_destroy(crofton_triangulator* triangulator) {
    return destroy(triangulator, __func__);
}

crofton_status crofton_triangulate(crofton_triangulator* triangulator, const crofton_polygon* polygon, uint32_t method,
                                   crofton_triangulation* triangulation) {
    CROFTON_CHANGE(triangulator);
    CROFTON_CHECK(check_struct(triangulation, __func__));
    if (method > CROFTON_TRIANGULATE_MINIMUM_WEIGHT)
        return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown method");
    CROFTON_CHECK(copy_polygon(polygon, __func__, triangulator->polygon));
    const triangulate::TriangulateOptions options{.method = static_cast<triangulate::Method>(method)};
    const triangulate::Triangulation& result = triangulator->result;
    CROFTON_CHECK(status_of(
        triangulator->triangulator.triangulate(triangulator->polygon, options, triangulator->result), __func__));
    *triangulation = {sizeof *triangulation,
                      result.triangles.empty() ? nullptr : result.triangles.data()->data(),
                      result.triangles.size(),
                      result.weight,
                      result.gap,
                      result.optimal ? 1u : 0u};
    return CROFTON_OK;
}
