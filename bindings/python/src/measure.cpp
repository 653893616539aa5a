// SPDX-License-Identifier: MIT
#include <crofton/measure/measure.hpp>

#include <cstdio>
#include <string>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

using measure::Criterion;
using measure::IntrinsicVolumes;

std::string show(const IntrinsicVolumes& v) {
    char text[120];
    std::snprintf(text, sizeof text, "IntrinsicVolumes(volume=%g, area=%g, mean_curvature=%g)", v.volume, v.area,
                  v.mean_curvature);
    return text;
}

Criterion make_criterion(double volume, double area, double mean_curvature) {
    const Criterion criterion{volume, area, mean_curvature};
    value_of(measure::validate(criterion));
    return criterion;
}

IntrinsicVolumes of_hull(const py::handle& given) {
    const Points<3> points(given, "points");
    std::vector<glm::dvec3> doubles;
    std::span<const glm::dvec3> span;
    if (points.is_float()) {
        doubles.assign(points.floats().begin(), points.floats().end());
        span = doubles;
    } else {
        span = points.doubles();
    }
    return value_of(unlocked([&] { return measure::intrinsic_volumes_of_hull(span); }));
}

}  // namespace

void bind_measure(py::module_& module) {
    py::class_<IntrinsicVolumes>(module, "IntrinsicVolumes",
                                 "Volume, surface area and integral of mean curvature of a convex body.")
        .def(py::init([](double v, double f, double m) {
                 return IntrinsicVolumes{v, f, m};
             }),
             py::arg("volume") = 0.0, py::arg("area") = 0.0, py::arg("mean_curvature") = 0.0)
        .def_readonly("volume", &IntrinsicVolumes::volume)
        .def_readonly("area", &IntrinsicVolumes::area)
        .def_readonly("mean_curvature", &IntrinsicVolumes::mean_curvature)
        .def_static(
            "of_box", [](const Obb& box) { return measure::intrinsic_volumes_of_box(box); }, py::arg("box"))
        .def_static(
            "of_box", [](double a, double b, double c) { return measure::intrinsic_volumes_of_box(a, b, c); },
            py::arg("a"), py::arg("b"), py::arg("c"), "Returns the measures of a box with these edges.")
        .def_static("of_sphere", &measure::intrinsic_volumes_of_sphere, py::arg("radius"))
        .def_static("of_segment", &measure::intrinsic_volumes_of_segment, py::arg("length"))
        .def_static("of_hull", &of_hull, py::arg("points"),
                    "Returns the measures of the convex hull of points, shape (n, 3).")
        .def_static(
            "of_frustum", [](const Camera& camera) { return value_of(measure::intrinsic_volumes_of_frustum(camera)); },
            py::arg("camera"), "Returns the measures of a camera's view volume; its far plane must be finite.")
        .def("__repr__", &show);

    py::class_<Criterion>(module, "Criterion",
                          "α·volume + β·area + γ·mean curvature: the cost that a good bound minimises.")
        .def(py::init(&make_criterion), py::arg("volume") = 0.0, py::arg("area") = 0.0, py::arg("mean_curvature") = 0.0)
        .def_readonly("volume_weight", &Criterion::volume_weight)
        .def_readonly("area_weight", &Criterion::area_weight)
        .def_readonly("mean_curvature_weight", &Criterion::mean_curvature_weight)
        .def_static("for_rays", &measure::for_rays, py::arg("length"), "The cost for random segments of this length.")
        .def_static("for_partner", &measure::for_partner, py::arg("body"),
                    "The cost for a convex body at uniformly random motions.")
        .def_static(
            "for_frustum", [](const Camera& camera) { return value_of(measure::for_frustum(camera)); },
            py::arg("camera"), "The cost for the view volume of a camera at uniformly random motions.")
        .def("__repr__",
             [](const Criterion& c) {
                 return format("Criterion(volume=%g, area=%g, mean_curvature=%g)", c.volume_weight, c.area_weight,
                               c.mean_curvature_weight);
             })
        .def("__call__", [](const Criterion& criterion, const IntrinsicVolumes& v) { return criterion(v); })
        .def("__call__", [](const Criterion& criterion, const Obb& box) {
            return criterion(measure::intrinsic_volumes_of_box(box));
        });

    module.def("kinematic_measure",
               py::overload_cast<const IntrinsicVolumes&, const IntrinsicVolumes&>(&measure::kinematic_measure),
               py::arg("b"), py::arg("k"),
               "Returns the measure of the motions under which B meets K: rotations have measure 1, translations their "
               "volume.");
    module.def("improper_outside",
               py::overload_cast<const IntrinsicVolumes&, const IntrinsicVolumes&, const IntrinsicVolumes&>(
                   &measure::improper_outside),
               py::arg("query"), py::arg("bound"), py::arg("object"),
               "Returns the measure of the motions under which the query meets the bound but not the object in it.");
    module.def(
        "triangles_met",
        [](const IntrinsicVolumes& b, double triangles, double area, double boundary, double weight) {
            return measure::triangles_met(b, {triangles, area, boundary, weight});
        },
        py::arg("body"), py::arg("triangles"), py::arg("area"), py::arg("boundary"), py::arg("weight"),
        "Returns the sum, over the triangles of a flat polygon, of the measures of the motions under which a body "
        "meets them.");
}

}  // namespace crofton::python
