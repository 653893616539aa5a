// SPDX-License-Identifier: MIT
// Shape: solids and surfaces that touch, move and meet.
#include <pybind11/stl.h>

#include <cmath>
#include <limits>

#include "mesh.hpp"
#include "module.hpp"
#include "world.hpp"

namespace crofton::python {

const char* kind_name(convex::Kind kind) {
    constexpr const char* kNames[] = {"sphere", "capsule",    "cylinder", "cone",         "box",     "triangle",
                                      "hull",   "half_space", "mesh",     "height_field", "compound"};
    return kNames[static_cast<std::size_t>(kind)];
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct PointRecord {
    double position[3], depth, normal[3];
};

SharedShape shape_of(Result<convex::Shape> made) {
    auto result = std::make_shared<PyShape>();
    result->shape = value_of(std::move(made));
    return result;
}

SharedShape hull_shape(const py::handle& given, int max_vertices) {
    const Points<3> points(given, "points");
    const auto floats = points.visit([](auto span) { return std::vector<glm::vec3>(span.begin(), span.end()); });
    auto result = std::make_shared<PyShape>();
    result->hull = value_of(unlocked([&] { return convex::Hull::build(floats, {.max_vertices = max_vertices}); }));
    result->shape = convex::Shape::hull(*result->hull);
    return result;
}

SharedShape mesh_shape(const std::shared_ptr<PyMesh>& mesh, bool front_only) {
    auto result = std::make_shared<PyShape>();
    result->mesh = mesh;
    result->shape = value_of(unlocked([&]() -> Result<convex::Shape> {
        const auto tree = mesh->tree();
        if (!tree) return tree.error();
        return convex::Shape::mesh(**tree, front_only ? convex::Sides::front : convex::Sides::both);
    }));
    return result;
}

SharedShape field_shape(const py::handle& given, const py::handle& spacing) {
    const auto heights = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!heights) PyErr_Clear();
    if (!heights || heights.ndim() != 2)
        raise_type("heights: an array of shape (rows along z, columns along x) is expected");
    const py::array_t<double> step = py::array_t<double, py::array::forcecast>::ensure(spacing);
    if (!step) PyErr_Clear();
    if (!step || step.ndim() != 1 || step.size() != 2) raise_type("spacing: two numbers, along x and z, are expected");
    convex::HeightFieldDescription description;
    description.rows = static_cast<std::uint32_t>(heights.shape(0));
    description.columns = static_cast<std::uint32_t>(heights.shape(1));
    description.heights = {heights.data(), static_cast<std::size_t>(heights.size())};
    description.spacing = {step.at(0), step.at(1)};
    auto result = std::make_shared<PyShape>();
    result->field = value_of(convex::HeightField::build(description));
    result->shape = convex::Shape::height_field(*result->field);
    return result;
}

SharedShape rounded_shape(const SharedShape& core, double radius) {
    auto result = shape_of(convex::Shape::rounded(*core->shape, radius));
    result->parts.push_back(core);
    return result;
}

SharedShape compound_shape(const py::sequence& children) {
    auto result = std::make_shared<PyShape>();
    std::vector<convex::CompoundChild> parts;
    // Held: a sequence may make its items as it is asked.
    for (const py::handle item : py::reinterpret_borrow<py::iterable>(children)) {
        const auto one = py::reinterpret_borrow<py::object>(item);
        const bool is_pair = py::isinstance<py::tuple>(one) && py::len(one) == 2;
        const py::object shape = is_pair ? py::object(one.cast<py::tuple>()[0]) : one;
        if (!py::isinstance<PyShape>(shape)) raise_type("children: shapes, or pairs (shape, pose), are expected");
        const auto held = shape.cast<SharedShape>();
        const py::object pose = is_pair ? py::object(one.cast<py::tuple>()[1]) : py::object(py::none());
        parts.push_back({*held->shape, pose_of(pose, "pose")});
        result->parts.push_back(held);
    }
    result->compound = value_of(convex::Compound::build(parts));
    result->shape = convex::Shape::compound(*result->compound);
    return result;
}

// Calls with two shapes where they stand, without the interpreter's lock.
template <class F>
auto with_poses(const PyShape& a, const PyShape& b, const py::object& b_pose, const py::object& a_pose, F&& f) {
    const RigidTransform at_a = pose_of(a_pose, "own_pose"), at_b = pose_of(b_pose, "pose");
    return unlocked([&] { return f(convex::ShapeAtPose{*a.shape, at_a}, convex::ShapeAtPose{*b.shape, at_b}); });
}

bool touches(const PyShape& a, const PyShape& b, const py::object& pose, const py::object& own_pose) {
    return with_poses(a, b, pose, own_pose, [](const auto& x, const auto& y) { return convex::intersects(x, y); });
}

NearestPoints distance(const PyShape& a, const PyShape& b, const py::object& pose, const py::object& own_pose) {
    const convex::Distance found =
        with_poses(a, b, pose, own_pose, [](const auto& x, const auto& y) { return convex::distance(x, y); });
    return {found.distance, found.on_a, found.on_b};
}

py::tuple penetration(const PyShape& a, const PyShape& b, const py::object& pose, const py::object& own_pose) {
    const convex::Penetration found =
        with_poses(a, b, pose, own_pose, [](const auto& x, const auto& y) { return convex::penetration(x, y); });
    return py::make_tuple(found.depth, tuple_of(found.normal));
}

py::array contacts(const PyShape& a, const PyShape& b, const py::object& pose, const py::object& own_pose) {
    std::vector<PointRecord> points;
    with_poses(a, b, pose, own_pose, [&](const auto& x, const auto& y) {
        convex::Manifolds found;
        convex::contact_manifolds(x, y, {}, found);
        for (const convex::Manifold& manifold : found.all())
            for (int i = 0; i < manifold.count; ++i) {
                const auto& point = manifold.points[i];
                const glm::dvec3 &p = point.position, &n = manifold.normal;
                points.push_back({{p.x, p.y, p.z}, point.depth, {n.x, n.y, n.z}});
            }
        return true;
    });
    py::array_t<PointRecord> result(static_cast<py::ssize_t>(points.size()));
    std::copy(points.begin(), points.end(), result.mutable_data());
    return result;
}

std::optional<convex::Impact> cast(const PyShape& a, const py::handle& velocity, const PyShape& b,
                                   const py::object& pose, const py::object& own_pose, const py::handle& spin,
                                   double duration) {
    convex::Motion motion;
    motion.velocity = vector_of(velocity, "velocity");
    motion.spin = vector_of(spin, "spin");
    const convex::Impact impact = value_of(with_poses(a, b, pose, own_pose, [&](const auto& x, const auto& y) {
        return convex::cast(x, motion, y, {}, {.duration = duration});
    }));
    if (impact.result == convex::CastResult::miss) return std::nullopt;
    return impact;
}

std::optional<SurfaceHit> raycast(const PyShape& shape, const py::handle& origin, const py::handle& direction,
                                  double max_t, const py::object& given_pose) {
    const Ray ray{vector_of(origin, "origin"), vector_of(direction, "direction"), max_t};
    value_of(validate(ray));
    const RigidTransform pose = pose_of(given_pose, "pose");
    const auto hit = unlocked([&] { return convex::raycast({*shape.shape, pose}, ray); });
    if (!hit) return std::nullopt;
    return SurfaceHit{hit->t, hit->point, hit->normal, hit->part.triangle, hit->started_inside};
}

std::string show(const PyShape& shape) {
    const Aabb& box = shape.shape->bounds();
    return format("Shape(%s, bounds=(%g, %g, %g) to (%g, %g, %g))", kind_name(shape.shape->kind()), box.min.x,
                  box.min.y, box.min.z, box.max.x, box.max.y, box.max.z);
}

}  // namespace

void bind_shape(py::module_& module) {
    PYBIND11_NUMPY_DTYPE(PointRecord, position, depth, normal);
    py::class_<convex::MassProperties>(module, "MassProperties",
                                       "Mass properties of a shape of density 1, in its own frame.")
        .def_readonly("volume", &convex::MassProperties::volume)
        .def_property_readonly(
            "center", [](const convex::MassProperties& m) { return tuple_of(m.center); }, "of mass")
        .def_property_readonly(
            "inertia",
            [](const convex::MassProperties& m) {
                return py::array_t<double>({3, 3}, &m.inertia[0][0]);
            },
            "about the center of mass, shape (3, 3)")
        .def("__repr__", [](const convex::MassProperties& m) {
            return format("MassProperties(volume=%g, center=(%g, %g, %g))", m.volume, m.center.x, m.center.y,
                          m.center.z);
        });
    py::class_<convex::Impact>(module, "Impact", "The time and place at which a moving shape meets another.")
        .def_readonly("time", &convex::Impact::time)
        .def_property_readonly(
            "normal", [](const convex::Impact& i) { return tuple_of(i.normal); },
            "unit, from the moving shape to the other")
        .def_property_readonly("on_a", [](const convex::Impact& i) { return tuple_of(i.on_a); })
        .def_property_readonly("on_b", [](const convex::Impact& i) { return tuple_of(i.on_b); })
        .def_readonly("distance", &convex::Impact::distance,
                      "the gap at that time; if negative, how deep they overlap at the start")
        .def_property_readonly(
            "resolved", [](const convex::Impact& i) { return i.result == convex::CastResult::hit; },
            "False if the search ended early: nothing is hit up to `time`, and later is not known")
        .def("__repr__", [](const convex::Impact& i) {
            return format("Impact(time=%g, normal=(%g, %g, %g))", i.time, i.normal.x, i.normal.y, i.normal.z);
        });

    const auto lengths = "Lengths are 0 or more. The axis is y, with the origin half way up.";
    py::class_<PyShape, SharedShape>(
        module, "Shape",
        "A solid or a surface that never changes. Tests overlap with other shapes, and finds distance, depth, contacts "
        "and the time of impact. A pose is a matrix of a rotation and a translation.")
        .def_static(
            "sphere", [](double radius) { return shape_of(convex::Shape::sphere(radius)); }, py::arg("radius"),
            "Around the origin.")
        .def_static(
            "capsule",
            [](float half_height, float radius) { return shape_of(convex::Shape::capsule(half_height, radius)); },
            py::arg("half_height"), py::arg("radius"), lengths)
        .def_static(
            "cylinder",
            [](float half_height, float radius) { return shape_of(convex::Shape::cylinder(half_height, radius)); },
            py::arg("half_height"), py::arg("radius"), lengths)
        .def_static(
            "cone", [](float half_height, float radius) { return shape_of(convex::Shape::cone(half_height, radius)); },
            py::arg("half_height"), py::arg("radius"), lengths)
        .def_static(
            "box", [](const py::handle& half) { return shape_of(convex::Shape::box(vector_of(half, "half_extents"))); },
            py::arg("half_extents"), "A box along the axes, centred at the origin.")
        .def_static("hull", &hull_shape, py::arg("points"), py::arg("max_vertices") = convex::kMaxHullVertices,
                    "The convex hull of points (n, 3), stored as float32. A hull with more than `max_vertices` "
                    "vertices is replaced by a larger one that contains it.")
        .def_static(
            "half_space",
            [](const py::handle& normal, double offset) {
                return shape_of(convex::Shape::half_space({vector_of(normal, "normal"), offset}));
            },
            py::arg("normal"), py::arg("offset") = 0.0,
            "All points x with dot(normal, x) + offset >= 0; the normal points into the solid.")
        .def_static("mesh", &mesh_shape, py::arg("mesh").none(false), py::arg("front_only") = false,
                    "The triangles of a Mesh, as a surface.")
        .def_static("height_field", &field_shape, py::arg("heights"), py::arg("spacing") = py::make_tuple(1.0, 1.0),
                    "Ground given by heights: heights[j, i] is y at x = i · spacing[0] and z = j · spacing[1].")
        .def_static("rounded", &rounded_shape, py::arg("core").none(false), py::arg("radius"),
                    "All points within `radius` of a convex shape.")
        .def_static("compound", &compound_shape, py::arg("children"), "The union of shapes, or of pairs (shape, pose).")
        .def_property_readonly("kind", [](const PyShape& b) { return kind_name(b.shape->kind()); })
        .def_property_readonly(
            "bounds",
            [](const PyShape& b) {
                return py::array_t<double>({2, 3}, &b.shape->bounds().min.x);
            },
            "in its own frame, shape (2, 3); infinite for half-spaces")
        .def_property_readonly(
            "mass", [](const PyShape& b) { return value_of(convex::mass_properties(*b.shape)); },
            "Returns the MassProperties. Error: a surface or a half-space.")
        .def("touches", &touches, py::arg("other"), py::arg("pose") = py::none(), py::arg("own_pose") = py::none(),
             "Tests whether the shapes share a point. `pose` is that of `other`.")
        .def("distance", &distance, py::arg("other"), py::arg("pose") = py::none(), py::arg("own_pose") = py::none(),
             "Returns the Distance between the shapes. `pose` is that of `other`.")
        .def("penetration", &penetration, py::arg("other"), py::arg("pose") = py::none(),
             py::arg("own_pose") = py::none(),
             "Returns (depth, normal): moving `other` by depth · normal ends the overlap. Both are 0 if there is none.")
        .def("contacts", &contacts, py::arg("other"), py::arg("pose") = py::none(), py::arg("own_pose") = py::none(),
             "Returns the points where the shapes touch, as an array of records: `position`, `depth`, and `normal` to "
             "the other.")
        .def("cast", &cast, py::arg("velocity"), py::arg("other"), py::arg("pose") = py::none(),
             py::arg("own_pose") = py::none(), py::kw_only(), py::arg("spin") = py::make_tuple(0.0, 0.0, 0.0),
             py::arg("duration") = 1.0,
             "Moves and turns this shape (radians around the origin of its frame) and returns its first Impact on "
             "`other`, which rests, or None.")
        .def("raycast", &raycast, py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity,
             py::arg("pose") = py::none(), "Returns the first RayHit, or None.")
        .def("__repr__", &show);
}

}  // namespace crofton::python
