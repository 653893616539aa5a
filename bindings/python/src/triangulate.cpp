// SPDX-License-Identifier: MIT
#include <crofton/triangulate/triangulate.hpp>

#include <string>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

using triangulate::Triangulation;

triangulate::Method method_of(const std::string& name) {
    using triangulate::Method;
    return choice_of<Method>(
        "method", name,
        {{"minimum_weight", Method::minimum_weight}, {"delaunay", Method::delaunay}, {"ear", Method::ear}});
}

void append_ring(const py::handle& given, Polygon& polygon) {
    const Points<2> points(given, "polygon");
    points.visit([&](auto span) {
        for (const auto& p : span) polygon.points.push_back(glm::dvec2(p));
    });
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
}

// One ring as an array of shape (n, 2), or a list or tuple of arrays: the outer ring and its holes.
Polygon polygon_of(const py::handle& given) {
    Polygon polygon;
    const bool is_sequence = py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given);
    bool is_ring = !is_sequence;
    if (is_sequence && py::len(given) > 0) {
        const py::array first = py::array::ensure(py::object(given[py::int_(0)]));
        if (!first) PyErr_Clear();
        is_ring = first && first.ndim() == 1;
    }
    if (is_ring) {
        append_ring(given, polygon);
    } else {
        for (const py::handle ring : given) append_ring(ring, polygon);
    }
    return polygon;
}

struct PolygonTriangles {
    Polygon polygon;
    Triangulation found;
};

PolygonTriangles run(const py::handle& given, const std::string& method, const py::object& seconds,
                     const py::object& work, const py::object& progress) {
    PolygonTriangles result{polygon_of(given), {}};
    Watch watch(progress);
    triangulate::TriangulateOptions options;
    options.method = method_of(method);
    if (!seconds.is_none()) options.seconds = number_of<double>(seconds, "seconds");
    if (!work.is_none()) options.work = number_of<std::uint64_t>(work, "work");
    options.user = &watch;
    options.should_stop = [](void* user, double share) { return static_cast<Watch*>(user)->should_stop(share, 1.0); };
    auto found = unlocked([&] { return triangulate::triangulate(result.polygon, options); });
    watch.raise_if_stopped();
    result.found = value_of(std::move(found));
    return result;
}

py::tuple retriangulate(const py::handle& positions, const py::handle& indices, double tolerance,
                        const py::object& progress) {
    const Points<3> points(positions, "positions");
    const auto given = integers<std::uint32_t>(indices, "indices");
    TriangleMesh mesh;
    points.visit([&](auto span) {
        for (const auto& p : span) mesh.positions.push_back(glm::vec3(p));
    });
    mesh.indices.assign(span_of(given).begin(), span_of(given).end());
    Watch watch(progress);
    triangulate::PatchOptions options;
    options.tolerance = tolerance;
    options.triangulation.user = &watch;
    options.triangulation.should_stop = [](void* user, double share) {
        return static_cast<Watch*>(user)->should_stop(share, 1.0);
    };
    auto report = unlocked([&] { return triangulate::retriangulate_planar_patches(mesh, options); });
    watch.raise_if_stopped();
    const auto done = value_of(std::move(report));
    py::dict summary;
    summary["patches"] = done.patches;
    summary["improved"] = done.improved;
    summary["refused"] = done.refused;
    summary["unproven"] = done.unproven;
    summary["weight_before"] = done.weight_before;
    summary["weight_after"] = done.weight_after;
    py::array_t<std::uint32_t> result = array_of<std::uint32_t>(mesh.indices);
    return py::make_tuple(result.reshape({py::ssize_t{-1}, py::ssize_t{3}}), summary);
}

}  // namespace

void bind_triangulate(py::module_& module) {
    py::class_<PolygonTriangles>(module, "Triangulation", "The triangles of a polygon with holes.")
        .def("__repr__",
             [](const PolygonTriangles& t) {
                 return format("Triangulation(%zu triangles, weight=%g%s)", t.found.triangles.size(), t.found.weight,
                               t.found.optimal ? ", optimal" : "");
             })
        .def_property_readonly(
            "points", [](const PolygonTriangles& t) { return array_of<double>(t.polygon.points, 2); },
            "the points of all rings in sequence, shape (n, 2)")
        .def_property_readonly("ring_ends",
                               [](const PolygonTriangles& t) { return array_of<std::uint32_t>(t.polygon.ring_ends); })
        .def_property_readonly(
            "triangles", [](const PolygonTriangles& t) { return array_of<std::uint32_t>(t.found.triangles, 3); },
            "indices into `points`, shape (m, 3), counter-clockwise")
        .def_property_readonly(
            "weight", [](const PolygonTriangles& t) { return t.found.weight; }, "the total length of the diagonals")
        .def_property_readonly(
            "optimal", [](const PolygonTriangles& t) { return t.found.optimal; },
            "True if the weight is proven minimal")
        .def_property_readonly(
            "gap", [](const PolygonTriangles& t) { return t.found.gap; },
            "a proven bound on how much heavier than the minimum it is");

    module.def("triangulate", &run, py::arg("polygon"), py::arg("method") = "minimum_weight", py::kw_only(),
               py::arg("seconds") = py::none(), py::arg("work") = py::none(), py::arg("progress") = py::none(),
               "Triangulates a polygon: one ring of shape (n, 2), or a list of rings, the outer one first. By default "
               "it finds the triangulation with the least total length of diagonals. `progress(share, 1.0)` may cancel "
               "by returning False.");
    module.def("retriangulate_planar_patches", &retriangulate, py::arg("positions"), py::arg("indices"), py::kw_only(),
               py::arg("tolerance") = 0.0, py::arg("progress") = py::none(),
               "Triangulates the flat parts of a mesh anew where that makes their diagonals shorter. Returns (indices, "
               "summary).");
}

}  // namespace crofton::python
