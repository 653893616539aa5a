// SPDX-License-Identifier: MIT
// Boxes, aligned boxes and spheres against a view: alone, as a span, as packed lists, as a query; against rational
// arithmetic.
#include <crofton/cull/bound_set.hpp>
#include <oracle/quick_frustum.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using cull::Verdict;
using fuzz::demand;

// By the planes alone, for a sphere: their normals are of any length.
Verdict conservative_of_sphere(const Frustum& frustum, const Sphere& sphere) {
    bool inside = true;
    for (const Plane& plane : frustum.view()) {
        const Verdict verdict = oracle::decide([&]<class Number>() {
            const auto normal = oracle::vector_of<Number>(plane.normal);
            const Number value = oracle::quick::plane_value<Number>(frustum, plane, sphere.center),
                         radius(sphere.radius);
            const int beyond = sgn(Number(value * value - oracle::dot(normal, normal) * radius * radius));
            const int side = sgn(value);
            if (side < 0 && beyond > 0) return Verdict::outside;
            return side >= 0 && beyond >= 0 ? Verdict::inside : Verdict::straddling;
        });
        if (verdict == Verdict::outside) return Verdict::outside;
        inside = inside && verdict == Verdict::inside;
    }
    return inside ? Verdict::inside : Verdict::straddling;
}

// The verdicts of a packed list are those of classify(), bound by bound, also after some have changed.
template <class Bound>
void check_list(fuzz::Shapes& in, const cull::View& view, std::vector<Bound>& bounds, const std::vector<Bound>& later) {
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits bits;
    for (int round = 0; round < 2; ++round) {
        for (const auto mode : {cull::CullMode::exact, cull::CullMode::conservative}) {
            cull::find_visible<Bound>(set, bounds, view, bits, mode);
            for (std::size_t i = 0; i < bounds.size(); ++i)
                demand(bits.verdict(i) == cull::classify(view.frustum, bounds[i], mode), "a list's verdict");
        }
        std::vector<std::uint32_t> changed;
        for (std::uint32_t i = 0; i < later.size(); ++i)
            if (in.flag()) changed.push_back(i), bounds[i] = later[i];
        set.update(changed, bounds);
    }
}

void check_boxes(fuzz::Shapes& in, const cull::View& view) {
    std::vector<Obb> boxes(1 + in.below(3)), later;
    for (Obb& box : boxes) box = in.flag() ? in.box_at(in.point_of(view.frustum)) : in.box();
    std::vector<std::uint32_t> layers, expected;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        const Verdict exact = oracle::quick::classify(view.frustum, boxes[i]);
        demand(cull::classify(view.frustum, boxes[i]) == exact, "a box's verdict");
        const Verdict by_planes = oracle::quick::is_rejected_by_a_plane(view.frustum, boxes[i]) ? Verdict::outside
                                  : exact == Verdict::inside                                    ? Verdict::inside
                                                                                                : Verdict::straddling;
        demand(cull::classify(view.frustum, boxes[i], cull::CullMode::conservative) == by_planes, "a box by planes");
        layers.push_back(in.layers());
        if (exact != Verdict::outside && (layers.back() & view.layer_mask) != 0) expected.push_back(i);
        later.push_back(in.box_near(boxes[i]));
    }
    std::vector<Verdict> verdicts(boxes.size());
    cull::classify(view.frustum, boxes, verdicts);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        demand(verdicts[i] == cull::classify(view.frustum, boxes[i]), "a span's verdict");
    cull::VisibleSet visible;
    cull::find_visible(boxes, layers, view, visible);
    demand(std::vector(visible.ids().begin(), visible.ids().end()) == expected, "what a list's query sees");
    check_list(in, view, boxes, later);
}

void check_aligned(fuzz::Shapes& in, const cull::View& view) {
    std::vector<Aabb> boxes(1 + in.below(3)), later(boxes.size());
    for (std::vector<Aabb>* list : {&boxes, &later})
        for (Aabb& box : *list) {
            // Middles and half extents are stored without rounding.
            const glm::dvec3 middle = in.grid_point();
            glm::dvec3 half;
            for (int k = 0; k < 3; ++k) half[k] = std::fabs(in.grid());
            box = {middle - half, middle + half};
            Obb same;
            same.center = middle;
            same.half_extents = glm::vec3(half);
            demand(cull::classify(view.frustum, box) == oracle::quick::classify(view.frustum, same), "an aligned box");
        }
    check_list(in, view, boxes, later);
}

void check_spheres(fuzz::Shapes& in, const cull::View& view) {
    std::vector<Sphere> spheres(1 + in.below(3)), later(spheres.size());
    for (std::vector<Sphere>* list : {&spheres, &later})
        for (Sphere& sphere : *list) {
            sphere = {in.flag() ? in.point_of(view.frustum) + in.nudge() : in.point(), std::fabs(in.coordinate())};
            const Verdict by_planes = conservative_of_sphere(view.frustum, sphere);
            demand(cull::classify(view.frustum, sphere, cull::CullMode::conservative) == by_planes,
                   "a sphere by planes");
            const Verdict exact = cull::classify(view.frustum, sphere);
            demand(by_planes != Verdict::outside || exact == Verdict::outside, "a sphere outside a plane");
            demand((exact == Verdict::inside) == (by_planes == Verdict::inside), "a sphere inside all planes");
        }
    check_list(in, view, spheres, later);
}

}  // namespace

CROFTON_FUZZ(in) {
    const unsigned kind = in.below(3);
    const cull::View view{in.frustum(), in.layers()};
    if (kind == 0) check_boxes(in, view);
    if (kind == 1) check_aligned(in, view);
    if (kind == 2) check_spheres(in, view);
}
