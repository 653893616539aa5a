// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/box.hpp>
#include <cstdio>
#include <limits>
#include <string>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

py::array_t<float> axes_of(const Obb& box) {
    return py::array_t<float>({3, 3}, &box.axes[0][0]);
}

// The least float that is not below a number, so that a box holds what it held.
float rounded_up(double value) {
    const auto nearest = static_cast<float>(value);
    return double{nearest} < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

Obb make_box(const py::handle& center, const py::handle& half_extents, const py::object& axes) {
    Obb box;
    box.center = vector_of(center, "center");
    const glm::dvec3 half = vector_of(half_extents, "half_extents");
    for (int k = 0; k < 3; ++k) box.half_extents[k] = rounded_up(half[k]);
    if (!axes.is_none()) {
        const Points<3> rows(axes, "axes");
        if (rows.size() != 3) raise_type("axes: an array of shape (3, 3) is expected");
        rows.visit([&](auto span) {
            for (int k = 0; k < 3; ++k) box.axes[k] = glm::vec3(span[static_cast<std::size_t>(k)]);
        });
    }
    value_of(validate(box));
    return box;
}

std::string show(const Obb& box) {
    char text[200];
    std::snprintf(text, sizeof text, "Box(center=(%g, %g, %g), half_extents=(%g, %g, %g))", box.center.x, box.center.y,
                  box.center.z, double{box.half_extents.x}, double{box.half_extents.y}, double{box.half_extents.z});
    return text;
}

Camera make_camera(const py::handle& position, const py::handle& forward, const py::handle& up, double fov_y,
                   const py::object& height, double aspect, double near_distance, double far_distance) {
    Camera camera;
    camera.position = vector_of(position, "position");
    camera.forward = vector_of(forward, "forward");
    camera.up = vector_of(up, "up");
    camera.fov_y = fov_y;
    camera.aspect = aspect;
    camera.near_distance = near_distance;
    camera.far_distance = far_distance;
    if (!height.is_none()) {
        camera.projection = Projection::orthographic;
        camera.height = number_of<double>(height, "height");
    }
    value_of(validate(camera));
    return camera;
}

Frustum frustum_from(const py::handle& matrix, const std::string& depth, const py::handle& origin) {
    const glm::dmat4 to_clip = projection_of(matrix, "matrix");
    return value_of(frustum_of(to_clip, depth_range(depth), vector_of(origin, "origin")));
}

py::array planes_of(const Frustum& frustum) {
    py::array_t<double> result({static_cast<py::ssize_t>(frustum.plane_count), py::ssize_t{4}});
    auto at = result.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < result.shape(0); ++i) {
        const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3; ++k) at(i, k) = plane.normal[k];
        at(i, 3) = plane.offset;
    }
    return result;
}

py::array corners_of(const Obb& box) {
    const auto all = corners(box);
    return array_of<double>(all, 3);
}

}  // namespace

void bind_geometry(py::module_& module) {
    py::class_<Obb>(module, "Box",
                    "An oriented box. Its centre is in double, its axes and half extents in single precision.")
        .def(py::init(&make_box), py::arg("center"), py::arg("half_extents"), py::arg("axes") = py::none(),
             "`axes[k]` is the direction of axis k, of unit length; by default x, y and z. Half extents are rounded up "
             "to float.")
        .def_property_readonly("center", [](const Obb& b) { return py::array_t<double>(3, &b.center[0]); })
        .def_property_readonly("axes", &axes_of, "axes[k] is the direction of axis k")
        .def_property_readonly("half_extents", [](const Obb& b) { return py::array_t<float>(3, &b.half_extents[0]); })
        .def_property_readonly(
            "extents",
            [](const Obb& b) {
                const glm::vec3 edges = 2.0f * b.half_extents;
                return py::array_t<float>(3, &edges[0]);
            },
            "the three edges")
        .def_property_readonly(
            "matrix",
            [](const Obb& b) {
                return matrix_of({glm::dmat3(b.axes), b.center});
            },
            "shape (4, 4): transforms the box's own coordinates to the world; its columns are the axes and the center")
        .def_property_readonly("corners", &corners_of,
                               "shape (8, 3); a corner is on the + side of axis k if bit k of its index is set")
        .def_property_readonly("volume", [](const Obb& b) { return volume(b); })
        .def_property_readonly("surface_area", [](const Obb& b) { return surface_area(b); })
        .def_property_readonly(
            "edge_sum", [](const Obb& b) { return edge_sum(b); },
            "the sum of the three edge lengths, which the perimeter criterion minimises")
        .def(
            "contains", [](const Obb& b, const py::handle& p) { return contains(b, vector_of(p, "point")); },
            py::arg("point"), "Tests whether the box contains the point, exactly. The boundary belongs to the box.")
        .def("__eq__",
             [](const Obb& a, const Obb& b) {
                 return a.center == b.center && a.axes == b.axes && a.half_extents == b.half_extents;
             })
        .def("__eq__", [](const Obb&, const py::object&) { return false; })
        .def("__repr__", &show)
        .attr("__hash__") = py::none();

    py::class_<Camera>(module, "Camera",
                       "A right-handed camera. Angles are in radians; all lengths have the same unit.")
        .def(py::init(&make_camera), py::arg("position") = py::make_tuple(0.0, 0.0, 0.0),
             py::arg("forward") = py::make_tuple(0.0, 0.0, -1.0), py::arg("up") = py::make_tuple(0.0, 1.0, 0.0),
             py::kw_only(), py::arg("fov_y") = Camera{}.fov_y, py::arg("height") = py::none(),
             py::arg("aspect") = Camera{}.aspect, py::arg("near") = Camera{}.near_distance,
             py::arg("far") = Camera{}.far_distance,
             "A perspective camera with the full vertical angle `fov_y`; if `height` is given, an orthographic one.")
        .def_property_readonly("position", [](const Camera& c) { return tuple_of(c.position); })
        .def_property_readonly("forward", [](const Camera& c) { return tuple_of(c.forward); })
        .def_property_readonly("frustum", [](const Camera& c) { return value_of(frustum_of(c)); })
        .def("__repr__", [](const Camera& c) {
            const std::string wide =
                c.projection == Projection::perspective ? format("fov_y=%g", c.fov_y) : format("height=%g", c.height);
            return format("Camera(position=(%g, %g, %g), forward=(%g, %g, %g), %s, near=%g, far=%g)", c.position.x,
                          c.position.y, c.position.z, c.forward.x, c.forward.y, c.forward.z, wide.c_str(),
                          c.near_distance, c.far_distance);
        });

    py::class_<Frustum>(module, "Frustum", "A view volume: all points on the inner side of its planes.")
        .def_static("from_matrix", &frustum_from, py::arg("matrix"), py::arg("depth") = "reversed_zero_to_one",
                    py::arg("origin") = py::make_tuple(0.0, 0.0, 0.0),
                    "Makes the view volume of a matrix that transforms columns (x, y, z, 1), relative to `origin`, to "
                    "clip space.")
        .def_property_readonly("origin", [](const Frustum& f) { return tuple_of(f.origin); })
        .def("__repr__",
             [](const Frustum& f) {
                 return format("Frustum(%u planes, origin=(%g, %g, %g))", static_cast<unsigned>(f.plane_count),
                               f.origin.x, f.origin.y, f.origin.z);
             })
        .def_property_readonly("planes", &planes_of, "shape (n, 4): normal · (x − origin) + offset ≥ 0 inside")
        .def(
            "shadow_volume",
            [](const Frustum& f, const py::handle& toward_light) {
                return value_of(cull::shadow_volume(f, vector_of(toward_light, "toward_light")));
            },
            py::arg("toward_light"),
            "Returns the volume of all points whose shadow from a distant light may fall into the view.");
}

}  // namespace crofton::python
