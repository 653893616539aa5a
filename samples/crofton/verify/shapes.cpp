// SPDX-License-Identifier: MIT
// Formulas of shapes that no theorem's row calls: the least figures around points, masses, contacts with the ground,
// meshes, limits of what is drawn, shadows and transforms. Against closed forms and plain sums.
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "topics.hpp"

namespace crofton::cli {
namespace {

using std::numbers::pi;

Obb any_box(sampling::Random& random, double places, double sizes) {
    Obb box;
    box.center = places * (2.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - 1.0);
    box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(sizes * random.uniform());
    return box;
}

TriangleMesh box_mesh(const Obb& box) {
    TriangleMesh mesh;
    for (const glm::dvec3& corner : corners(box)) mesh.positions.emplace_back(corner);
    const std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces)
        for (const std::uint32_t i : {f[0], f[1], f[2], f[0], f[2], f[3]}) mesh.indices.push_back(i);
    return mesh;
}

// Figures around regular polygons and solids, and boxes around boxes.
void least_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 3";
    std::vector<glm::dvec2> heptagon, hexagon;
    for (int i = 0; i < 7; ++i)
        heptagon.emplace_back(3.0 + 2.5 * std::cos(2.0 * pi * i / 7.0), 2.5 * std::sin(2.0 * pi * i / 7.0));
    for (int i = 0; i < 6; ++i) hexagon.emplace_back(std::cos(pi * i / 3.0 + 0.3), std::sin(pi * i / 3.0 + 0.3));
    const auto disc = fit::minimal_disc(heptagon);
    rows.push_back(computed_row("the least disc around a regular heptagon: its circle", source, 2.5,
                                disc ? disc->radius : std::nan(""), 1e-12));
    for (const bool ordered : {false, true}) {
        const auto rectangle = ordered ? fit::minimal_rectangle_of_convex(hexagon, fit::PlanarCriterion::area)
                                       : fit::minimal_rectangle(hexagon, fit::PlanarCriterion::area);
        rows.push_back(computed_row(ordered ? "the least rectangle around a regular hexagon, from its corners in order"
                                            : "the least rectangle around a regular hexagon: 2 times the root of 3",
                                    source, 2.0 * std::sqrt(3.0), rectangle ? area(*rectangle) : std::nan(""), 1e-12));
    }
    // Corners of a cube of edge 2 and its middle.
    std::vector<glm::dvec3> cube{glm::dvec3(5.0, 0.0, 0.0)};
    for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1 ? 6.0 : 4.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    const auto sphere = fit::minimal_sphere(cube);
    rows.push_back(computed_row("the least sphere around a cube: half its diagonal", source, std::sqrt(3.0),
                                sphere ? sphere->radius : std::nan(""), 1e-12));
    sampling::Random random(options.seed, 71);
    Obb turned = any_box(random, 10.0, 1.0);
    turned.half_extents = {0.5f, 1.0f, 2.0f};
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& corner : corners(turned)) points.push_back(corner);
    const auto exact = fit::fit_exact(points, fit::ExactOptions{.criterion = measure::minimal_volume()});
    rows.push_back(computed_row("the best box around a turned box's corners: its volume", source, 8.0,
                                exact ? exact->value : std::nan(""), 8e-6));
    rows.push_back(at_most_row("its proof: a bound below its value", source, exact ? exact->value : std::nan(""),
                               exact ? exact->lower_bound : HUGE_VAL, 0.0));
    std::vector<Obb> pair(2);
    pair[0].half_extents = pair[1].half_extents = glm::vec3(0.5f);
    pair[1].center.x = 2.0;
    const auto merged = fit::merge(pair, measure::minimal_volume());
    rows.push_back(computed_row("one box around two unit cubes in a row: 3", source, 3.0,
                                merged ? volume(*merged) : std::nan(""), 1e-5));
    // Clusters are fitted as each is alone.
    std::vector<glm::vec3> cloud;
    std::vector<std::uint32_t> indices, ends;
    for (std::uint32_t i = 0; i < 800; ++i) {
        cloud.emplace_back(random.uniform(), 2.0 * random.uniform(), 0.2 * random.uniform());
        indices.push_back(i);
        if (i % 20 == 19) ends.push_back(i + 1);
    }
    std::vector<Obb> boxes(ends.size());
    const auto many = fit::fit_many({cloud, indices, ends}, {}, serial_executor(), boxes);
    std::uint64_t wrong = many ? 0 : 1;
    for (std::size_t c = 0; many && c < boxes.size(); ++c) {
        const auto one = fit::fit_obb(std::span<const glm::vec3>(cloud).subspan(20 * c, 20));
        wrong += !one || one->center != boxes[c].center || one->half_extents != boxes[c].half_extents;
    }
    rows.push_back(none_row("clusters that are fitted otherwise than alone", source, boxes.size(), wrong));
}

void mass_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "mass of solids, in closed form";
    using convex::Shape;
    const auto add = [&](const char* claim, const Result<convex::MassProperties>& mass, double volume, double inertia) {
        const double told = mass ? mass->volume : std::nan("");
        rows.push_back(computed_row(std::string(claim) + ": volume", source, volume, told, 1e-6 * volume));
        rows.push_back(computed_row(std::string(claim) + ": inertia about y", source, inertia,
                                    mass ? mass->inertia[1][1] : std::nan(""), 2e-6 * inertia));
    };
    const double r = 0.5, h = 0.75;  // floats hold them
    const double ball = 4.0 / 3.0 * pi * r * r * r, cylinder = 2.0 * pi * r * r * h, cone = cylinder / 3.0;
    add("a ball", mass_properties(*Shape::sphere(r)), ball, 0.4 * ball * r * r);
    add("a cylinder", mass_properties(*Shape::cylinder(0.75f, 0.5f)), cylinder, 0.5 * cylinder * r * r);
    add("a cone", mass_properties(*Shape::cone(0.75f, 0.5f)), cone, 0.3 * cone * r * r);
    add("a capsule", mass_properties(*Shape::capsule(0.75f, 0.5f)), cylinder + ball,
        0.5 * cylinder * r * r + 0.4 * ball * r * r);
    add("a box", mass_properties(*Shape::box({0.5f, 0.75f, 1.0f})), 3.0, 3.0 * (0.25 + 1.0) / 3.0);
}

// A ball, a box and a cone over level ground.
void ground_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "header of convex/query.hpp";
    using convex::Shape;
    const Shape level = *Shape::half_space({{0.0, -1.0, 0.0}, 0.0}), box = *Shape::box({0.5f, 0.25f, 0.5f}),
                ball = *Shape::sphere(0.5);
    const RigidTransform zero, above{glm::dmat3(1.0), {3.0, 1.25, -2.0}}, sunk{glm::dmat3(1.0), {3.0, 0.125, -2.0}};
    rows.push_back(computed_row("a ball over level ground: how far", source, 0.75,
                                convex::distance({level, zero}, {ball, above}).distance, 1e-12));
    const auto fall = convex::cast({level, zero}, {}, {ball, above}, {{1.0, -1.5, 0.0}, {}, {}});
    rows.push_back(
        computed_row("a ball that falls on level ground: when", source, 0.5, fall ? fall->time : std::nan(""), 1e-6));
    convex::Manifolds found;
    convex::contact_manifolds({level, zero}, {box, sunk}, {}, found);
    const bool one = found.all().size() == 1;
    rows.push_back(
        computed_row("a box sunk in level ground: its four corners", source, 4.0, one ? found.all()[0].count : 0, 0.0));
    rows.push_back(computed_row("and how deep", source, 0.125, one ? found.all()[0].depth : std::nan(""), 1e-12));
}

void mesh_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "header of mesh/mesh_query.hpp";
    sampling::Random random(options.seed, 72);
    std::uint64_t near_cases = 0, near_wrong = 0, pair_cases = 0, pair_wrong = 0, inside_cases = 0, inside_wrong = 0,
                  ray_cases = 0, ray_wrong = 0, moved_cases = 0, moved_wrong = 0, axis_cases = 0, axis_wrong = 0;
    double off_segment = 0.0;
    for (int i = 0; i < 300; ++i) {
        const Obb a_box = any_box(random, 0.5, 1.0), b_box = any_box(random, 1.5, 0.6);
        const TriangleMesh a_mesh = box_mesh(a_box), b_mesh = box_mesh(b_box);
        auto a = mesh::MeshTree::build(a_mesh), b = mesh::MeshTree::build(b_mesh);
        if (!a || !b) continue;
        const double distance = mesh::distance(*a, *b, {}).distance, limit = random.uniform();
        near_wrong += mesh::closer_than(*a, *b, {}, limit) != (distance < limit);
        ++near_cases;
        axis_wrong +=
            (collide::separating_axis(a_box, b_box) == collide::kNotSeparated) != collide::intersects(a_box, b_box);
        ++axis_cases;
        Vector<mesh::TrianglePair> pairs;
        mesh::intersecting_triangles(*a, *b, {}, pairs);
        std::size_t met = 0;
        const auto corner = [](const TriangleMesh& mesh, std::size_t t) {
            return Triangle{glm::dvec3(mesh.positions[mesh.indices[3 * t]]),
                            glm::dvec3(mesh.positions[mesh.indices[3 * t + 1]]),
                            glm::dvec3(mesh.positions[mesh.indices[3 * t + 2]])};
        };
        for (std::size_t s = 0; s < 12; ++s)
            for (std::size_t t = 0; t < 12; ++t) {
                const Triangle u = corner(a_mesh, s), v = corner(b_mesh, t);
                if (!mesh::intersects(u, v)) continue;
                ++met;
                const mesh::SegmentOfContact segment = mesh::contact_segment(u, v);
                for (const glm::dvec3& end : {segment.begin, segment.end})
                    for (const Triangle& w : {u, v}) {
                        const glm::dvec3 normal = glm::normalize(glm::cross(w[1] - w[0], w[2] - w[0]));
                        off_segment = std::max(off_segment, std::fabs(glm::dot(normal, end - w[0])));
                    }
            }
        pair_wrong += pairs.size() != met;
        ++pair_cases;
        const bool within = [&] {
            const auto points = corners(b_box);
            return std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) { return contains(a_box, p); });
        }();
        if (pairs.empty()) {
            inside_wrong += (mesh::containment(*a, *b, {}) == mesh::Containment::b_inside_a) != within;
            ++inside_cases;
        }
        const glm::dvec3 from = 4.0 * sampling::direction(random.point<2>());
        const Ray ray{from, 0.5 * sampling::direction(random.point<2>()) - from};
        ray_wrong += mesh::hits_any(ray, *a) != mesh::raycast(ray, *a).has_value();
        ++ray_cases;
        // Refitted to b's vertices it answers as b's tree.
        auto refittable = mesh::MeshTree::build(a_mesh, {.refittable = true});
        if (!refittable || !refittable->refit(b_mesh.positions)) continue;
        moved_wrong += mesh::raycast(ray, *refittable).has_value() != mesh::raycast(ray, *b).has_value();
        ++moved_cases;
    }
    rows.push_back(
        none_row("meshes that are nearer than a limit and than their distance", source, near_cases, near_wrong));
    rows.push_back(
        none_row("pairs of meshes with other triangles that meet than one by one", source, pair_cases, pair_wrong));
    rows.push_back(
        computed_row("segments where triangles meet: how far off their planes", source, 0.0, off_segment, 1e-9));
    rows.push_back(none_row("boxes as meshes that lie within each other otherwise than boxes do", source, inside_cases,
                            inside_wrong));
    rows.push_back(none_row("rays that hit a mesh at all, and nowhere", source, ray_cases, ray_wrong));
    rows.push_back(
        none_row("rays at refitted meshes that meet other ones than at new ones", source, moved_cases, moved_wrong));
    rows.push_back(none_row("boxes with a separating axis that meet, or without one that do not",
                            "header of collide/narrow_phase.hpp", axis_cases, axis_wrong));
}

void picture_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "headers of cull/classify.hpp, cull.hpp and lights.hpp";
    sampling::Random random(options.seed, 73);
    Camera camera;
    camera.fov_y = 0.9;
    camera.far_distance = 50.0;
    camera.position = {1.0, -2.0, 3.0};
    // A ball of radius r is 2 r / (2 d tan(fov / 2)) · height pixels high in the middle.
    const auto limits = cull::limits_of(camera, 1080.0, 4.0);
    std::uint64_t wrong = 0, cases = 0;
    for (int i = 0; limits && i < 2000; ++i) {
        const Sphere ball{camera.position + 40.0 * random.uniform() * sampling::direction(random.point<2>()),
                          0.2 * random.uniform()};
        const double pixels = ball.radius / (glm::distance(ball.center, camera.position) * std::tan(0.45)) * 1080.0;
        if (std::fabs(pixels - 4.0) < 1e-9) continue;
        wrong += cull::is_worth_drawing(*limits, ball, 0) != (pixels > 4.0);
        ++cases;
    }
    rows.push_back(none_row("balls that are dropped at another size than four pixels", source, cases, wrong));
    // A point may cast a shadow into the view if its ray along the light meets the view.
    const auto view = frustum_of(camera);
    const glm::dvec3 toward = glm::normalize(glm::dvec3(0.3, 0.8, -0.2)), lamp = camera.position + glm::dvec3(0, 20, 0);
    const auto sun = view ? cull::shadow_volume(*view, toward) : Result<Frustum>(Error{});
    const auto hull = view ? cull::shadow_volume_of_point(*view, lamp) : Result<Frustum>(Error{});
    const auto holds = [](const Frustum& volume, const glm::dvec3& p, double slack) {
        for (std::uint32_t k = 0; k < volume.plane_count; ++k)
            if (glm::dot(volume.planes[k].normal, p - volume.origin) + volume.planes[k].offset < slack) return false;
        return true;
    };
    std::uint64_t sun_wrong = 0, lamp_wrong = 0, shadow_cases = 0;
    for (int i = 0; sun && hull && i < 2000; ++i) {
        const glm::dvec3 p =
            camera.position + 40.0 * (2.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - 1.0);
        // Clipped to the view: from p along the light.
        const auto meets = [&](const glm::dvec3& way, double end) {
            double low = 0.0, high = end;
            for (std::uint32_t k = 0; k < view->plane_count; ++k) {
                const double at = glm::dot(view->planes[k].normal, p - view->origin) + view->planes[k].offset,
                             by = glm::dot(view->planes[k].normal, way);
                if (by > 0.0) low = std::max(low, -at / by);
                if (by < 0.0) high = std::min(high, -at / by);
                if (by == 0.0 && at < 0.0) return false;
            }
            return low <= high;
        };
        ++shadow_cases;
        const bool in_sun = meets(-toward, 1e9);
        if (in_sun ? !holds(*sun, p, -1e-9) : holds(*sun, p, 1e-9)) ++sun_wrong;
        // For a lamp, it must be on a segment between the lamp and the view.
        const bool in_hull = meets(p - lamp, 1e9);
        if (in_hull ? !holds(*hull, p, -1e-9) : holds(*hull, p, 1e-9)) ++lamp_wrong;
    }
    rows.push_back(none_row("points that the sun's shadow volume takes for others", source, shadow_cases, sun_wrong));
    rows.push_back(none_row("points that a lamp's shadow volume takes for others", source, shadow_cases, lamp_wrong));
    // Splits: equal steps, equal ratios, and between.
    double splits[5] = {};
    double off = 0.0;
    for (const double share : {0.0, 0.5, 1.0}) {
        if (!cull::split_depths(0.5, 40.5, share, splits)) off = HUGE_VAL;
        for (int i = 0; i <= 4; ++i)
            off = std::max(
                off, std::fabs(splits[i] - ((1.0 - share) * (0.5 + 10.0 * i) + share * 0.5 * std::pow(81.0, i / 4.0))));
    }
    rows.push_back(
        computed_row("depths of cascades: off the mean of equal steps and equal ratios", source, 0.0, off, 1e-12));
    // All that is seen between two depths lies in the cascade's view.
    const auto cascade = cull::cascade_camera(camera, 5.0, 20.0, toward, 30.0);
    Camera slice = camera;
    slice.near_distance = 5.0;
    slice.far_distance = 20.0;
    const auto seen = frustum_of(slice), lit = cascade ? frustum_of(*cascade) : Result<Frustum>(Error{});
    std::uint64_t outside = 0, tried = 0;
    for (int i = 0; seen && lit && i < 20000; ++i) {
        const glm::dvec3 p =
            camera.position + 30.0 * (2.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - 1.0);
        if (!holds(*seen, p, 0.0)) continue;
        ++tried;
        outside += !holds(*lit, p, -1e-9);
    }
    rows.push_back(none_row("points of a cascade's slice that its camera does not see", source, tried, outside));
    // Lights in froxels: one that reaches all is in each; one behind the camera in none.
    const auto grid = cull::FroxelGrid::build(camera);
    cull::FroxelLights lights;
    const Sphere reach[2] = {{camera.position, 1e4}, {camera.position - 30.0 * camera.forward, 5.0}};
    const bool listed = grid && cull::find_lights(*grid, reach, {}, lights).has_value();
    std::uint64_t found = 0;
    for (std::uint32_t i = 0; listed && i < grid->size(); ++i) found += lights.lights_of(i).size();
    rows.push_back(computed_row("froxels with a light that reaches all, and with one behind the camera: share", source,
                                1.0, grid ? static_cast<double>(found) / static_cast<double>(grid->size()) : 0.0, 0.0));
}

void number_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "headers of geometry";
    sampling::Random random(options.seed, 74);
    std::uint64_t wrong = 0, cases = 0;
    for (int i = 0; i < 2000; ++i) {
        // Around (3, 4, 5) circles of integers, whose points are exact.
        const double s = 1.0 + std::floor(1000.0 * random.uniform()), x = std::floor(100.0 * random.uniform());
        const glm::dvec2 m(x, -x), on(4.0 * s, 3.0 * s),
            a = m + 5.0 * s * glm::dvec2(1, 0), b = m + 5.0 * s * glm::dvec2(0, 1), c = m - 5.0 * s * glm::dvec2(1, 0);
        const double by = std::floor(3.0 * random.uniform()) - 1.0;
        const int side = in_circle(a, b, c, m + on - glm::dvec2(by, 0.0));
        wrong += side != static_cast<int>(by);
        ++cases;
    }
    rows.push_back(none_row("points on the wrong side of a circle", source, cases, wrong));
    double volume_off = 0.0, area_off = 0.0, edges_off = 0.0, trs_off = 0.0;
    for (int i = 0; i < 200; ++i) {
        const Obb box = any_box(random, 5.0, 2.0);
        const glm::dvec3 e = 2.0 * glm::dvec3(box.half_extents);
        const auto volumes = measure::intrinsic_volumes_of_box(e.x, e.y, e.z);
        volume_off = std::max(volume_off, std::fabs(volume(box) - volumes.volume));
        area_off = std::max(area_off, std::fabs(surface_area(box) - volumes.area));
        edges_off = std::max(edges_off, std::fabs(pi * edge_sum(box) - volumes.mean_curvature));
        // Scale, turn, move: of a point, by hand.
        const glm::dmat3 turn = sampling::rotation(random.point<3>());
        const glm::dvec3 scale(1.0 + random.uniform(), 2.0, -random.uniform()), move(1.0, 2.0, 3.0), p(0.3, -0.7, 0.9);
        const auto trs = from_trs(move, glm::quat_cast(turn), scale);
        if (!trs) continue;
        trs_off = std::max(trs_off, glm::length(*trs * p - (turn * (scale * p) + move)));
        const glm::dmat4 rows_of(glm::dvec4(trs->linear[0], 0.0), glm::dvec4(trs->linear[1], 0.0),
                                 glm::dvec4(trs->linear[2], 0.0), glm::dvec4(trs->translation, 1.0));
        const auto again = from_matrix(rows_of);
        trs_off = std::max(trs_off, again ? glm::length(*again * p - *trs * p) : HUGE_VAL);
    }
    rows.push_back(computed_row("boxes' volumes: off the intrinsic ones", source, 0.0, volume_off, 1e-12));
    rows.push_back(computed_row("boxes' surfaces: off the intrinsic ones", source, 0.0, area_off, 1e-12));
    rows.push_back(computed_row("boxes' edges times pi: off the mean curvature", source, 0.0, edges_off, 1e-12));
    rows.push_back(computed_row("points scaled, rotated and moved: difference from the same by hand", source, 0.0,
                                trs_off, 1e-12));
}

}  // namespace

std::vector<VerifyRow> shape_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    least_rows(options, rows);
    mass_rows(rows);
    ground_rows(rows);
    mesh_rows(options, rows);
    picture_rows(options, rows);
    number_rows(options, rows);
    return rows;
}

}  // namespace crofton::cli
