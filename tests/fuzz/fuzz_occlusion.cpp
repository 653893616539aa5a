// SPDX-License-Identifier: MIT
// What boxes hide: rays from the eye are witnesses, and a proof in rationals is asked for; lists, trees and movers give
// the same answer.
#include <algorithm>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/hidden_certificate.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

// In front of the camera, at a depth and with a size that the bytes say.
Obb box_before(fuzz::Shapes& in, const Camera& camera, double depth) {
    Obb box = in.box();
    const glm::dvec3 side = glm::normalize(glm::cross(camera.forward, camera.up));
    const glm::dvec3 above = glm::cross(side, camera.forward);
    const double half_width = 0.03 * depth;
    const double across = in.grid(), up = in.grid();
    box.center = camera.position + depth * camera.forward + half_width * (across * side + up * above);
    return validate(box) ? box : Obb{};
}

// The ray from the camera to a point; in a parallel view, along its axis.
oracle::WitnessRay ray_to(const Camera& camera, const glm::dvec3& point) {
    const double along = glm::dot(point - camera.position, camera.forward);
    if (camera.projection == Projection::perspective)
        return {camera.position, point, camera.near_distance / along * (1.0 - 1e-9)};
    return {point - along * camera.forward, point, camera.near_distance / along * (1.0 - 1e-9)};
}

bool is_in_view(const Frustum& frustum, const glm::dvec3& p) {
    for (const Plane& plane : frustum.view())
        if (glm::dot(plane.normal, p - frustum.origin) + plane.offset < 1e-9 * (1.0 + glm::length(p))) return false;
    return true;
}

// Whether a corner's picture is on the border of two pixels, or as near as rounding.
bool is_on_a_line_of_pixels(const occlude::OcclusionBuffer& buffer, const Obb& box) {
    const occlude::OcclusionView& view = buffer.view();
    const std::uint32_t sizes[2] = {buffer.size().width, buffer.size().height};
    for (const glm::dvec3& corner : corners(box)) {
        const glm::dvec3 y = corner - view.origin;
        const auto form = [&](std::size_t r) {
            return view.rows[r][0] * y.x + view.rows[r][1] * y.y + view.rows[r][2] * y.z + view.rows[r][3];
        };
        for (std::size_t k = 0; k < 2; ++k) {
            const double half = 0.5 * sizes[k], at = form(k) / form(2) * (half - 1.0 / 64.0) + half;
            if (std::fabs(at - std::round(at)) < 1e-6) return true;
        }
    }
    return false;
}

bool comes_before_near(const occlude::OcclusionView& view, double near_distance, const Obb& box) {
    for (const glm::dvec3& corner : corners(box)) {
        const glm::dvec3 y = corner - view.origin;
        const auto& row = view.rows[view.perspective ? 2 : 3];
        const double t = row[0] * y.x + row[1] * y.y + row[2] * y.z + row[3];
        if ((view.perspective ? t : -t) < near_distance * (1.0 + 1e-9)) return true;
    }
    return false;
}

void check_hidden(fuzz::Shapes& in, const Camera& camera, const occlude::OcclusionBuffer& buffer, const Obb& box,
                  const std::vector<Obb>& occluders) {
    // Points of a witness are rounded, so they are taken a little inside.
    for (int i = 0; i < 8; ++i) {
        glm::dvec3 p = box.center;
        for (int k = 0; k < 3; ++k)
            p += 0.999 * (i >> k & 1 ? 1 : -1) * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        // What is beside the picture no ray of the view meets; a parallel ray is off by its foot's rounding.
        if (camera.projection != Projection::perspective || !is_in_view(buffer.view().frustum, p)) continue;
        demand(!oracle::is_free(ray_to(camera, p), occluders), "a hidden box is seen");
    }
    if (in.below(4) != 0) return;
    Vector<occlude::OccluderId> ids;
    buffer.hidden_by(box, ids);
    demand(!ids.empty(), "nothing hides a hidden box");
    if (comes_before_near(buffer.view(), camera.near_distance, box)) return;  // the proof knows no near plane
    if (is_on_a_line_of_pixels(buffer, box)) return;  // the proof asks for both sides of the line
    const oracle::HiddenCertificate certificate(buffer.view(), camera.near_distance, buffer.size().width,
                                                buffer.size().height);
    demand(certificate.proves(box, occluders), "a hidden box without a proof");
}

void check_queries(const occlude::OcclusionBuffer& buffer, const std::vector<Obb>& boxes) {
    const cull::View view{buffer.view().frustum, ~0u};
    cull::VisibleSet seen;
    cull::find_visible(boxes, {}, view, seen);
    std::vector<boxtree::ItemId> expected;
    for (const boxtree::ItemId id : seen.ids())
        if (!buffer.hides(boxes[id])) expected.push_back(id);
    std::vector<std::uint64_t> bits((boxes.size() + 63) / 64);
    buffer.find_hidden(boxes, bits);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        demand((bits[i / 64] >> (i % 64) & 1) == (buffer.hides(boxes[i]) ? 1u : 0u), "a bit of a hidden box");
    occlude::VisibleSet visible;
    occlude::find_visible(boxes, {}, buffer, visible);
    demand(std::equal(expected.begin(), expected.end(), visible.ids().begin(), visible.ids().end()), "a list's answer");
    // A node's bound may be hidden where a box's own filter cannot decide: never fewer hidden, never one that is seen.
    const auto tree = boxtree::BoxTree::build(boxes);
    demand(tree.has_value(), "a tree");
    occlude::find_visible(*tree, buffer, visible);
    demand(std::includes(expected.begin(), expected.end(), visible.ids().begin(), visible.ids().end()),
           "a tree sees what a list does not");
}

}  // namespace

CROFTON_FUZZ(in) {
    Camera camera = in.camera();
    camera.near_distance = (std::min)(camera.near_distance, 0.5);
    camera.far_distance = (std::max)(camera.far_distance, 100.0);
    const auto view = occlude::occlusion_view_of(camera);
    demand(view.has_value(), "a view");
    std::vector<Obb> occluders, boxes;
    occlude::OccluderSet set;
    for (unsigned i = in.below(6) + 1; i > 0; --i) {
        const Obb box = box_before(in, camera, 1.0 + in.byte() / 8.0);
        if (set.place(box)) occluders.push_back(box);
    }
    for (unsigned i = in.below(12); i > 0; --i)
        boxes.push_back(in.below(4) == 0 && !occluders.empty() ? in.box_near(occluders[0])
                                                               : box_before(in, camera, 1.0 + in.byte()));
    const occlude::BufferSize pixels{8 + in.below(24), 8 + in.below(24)};
    auto buffer = occlude::OcclusionBuffer::create(pixels);
    demand(buffer.has_value(), "a buffer");
    buffer->draw(set, *view);
    for (const Obb& box : boxes)
        if (buffer->hides(box)) check_hidden(in, camera, *buffer, box, occluders);
    check_queries(*buffer, boxes);
}
