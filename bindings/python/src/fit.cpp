// SPDX-License-Identifier: MIT
#include <crofton/fit/fit.hpp>

#include <string>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

fit::Quality quality_of(const std::string& name) {
    using fit::Quality;
    return choice_of<Quality>("quality", name,
                              {{"fast", Quality::fast}, {"tight", Quality::tight}, {"exact", Quality::exact}});
}

Obb fit_obb(const py::handle& given, const py::handle& criterion, const std::string& quality) {
    const Points<3> points(given, "points");
    const fit::FitOptions options{criterion_of(criterion), quality_of(quality)};
    return value_of(points.visit([&](auto span) { return unlocked([&] { return fit::fit_obb(span, options); }); }));
}

fit::ExactFit fit_exact(const py::handle& given, const py::handle& criterion, double gap, const py::object& seconds,
                        const py::object& progress) {
    const Points<3> points(given, "points");
    Watch watch(progress);
    const auto tell = [&](const fit::Progress& state) { return watch.should_stop(state.value, state.lower_bound); };
    const FunctionRef<bool(const fit::Progress&)> reference(tell);
    fit::ExactOptions options;
    options.criterion = criterion_of(criterion);
    options.gap = gap;
    if (!seconds.is_none()) options.time_budget_seconds = number_of<double>(seconds, "seconds");
    options.should_stop = &reference;
    auto result = points.visit([&](auto span) { return unlocked([&] { return fit::fit_exact(span, options); }); });
    watch.raise_if_stopped();
    return value_of(std::move(result));
}

py::array fit_many(const py::handle& given, const py::handle& ends, const py::object& indices,
                   const py::handle& criterion, const std::string& quality) {
    const Points<3> points(given, "positions");
    if (!points.is_float()) raise_type("positions: float32 is expected; convert with .astype('f4')");
    const auto borders = integers<std::uint32_t>(ends, "ends");
    std::vector<std::uint32_t> chosen;  // a copy: another thread could change what has been checked
    if (indices.is_none()) {
        chosen.resize(points.size());
        for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = static_cast<std::uint32_t>(i);
    } else {
        const auto given_indices = integers<std::uint32_t>(indices, "indices");
        chosen.assign(span_of(given_indices).begin(), span_of(given_indices).end());
    }
    const std::vector<std::uint32_t> cluster_ends(span_of(borders).begin(), span_of(borders).end());
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < cluster_ends.size(); ++i) {
        if (cluster_ends[i] < last || cluster_ends[i] > chosen.size())
            raise({ErrorCode::out_of_range, i, "ends: they must not decrease, nor pass the number of indices"});
        last = cluster_ends[i];
    }
    const fit::FitOptions options{criterion_of(criterion), quality_of(quality)};
    std::vector<Obb> boxes(cluster_ends.size());
    const auto threads = executor();
    value_of(unlocked([&] {
        return fit::fit_many({points.floats(), chosen, cluster_ends}, options, *threads, boxes);
    }));
    return boxes_of(boxes);
}

fit::PlanarCriterion planar_criterion(const std::string& name) {
    using fit::PlanarCriterion;
    return choice_of<PlanarCriterion>("criterion", name,
                                      {{"perimeter", PlanarCriterion::perimeter}, {"area", PlanarCriterion::area}});
}

std::vector<glm::dvec2> planar_points(const py::handle& given) {
    const Points<2> points(given, "points");
    return points.visit([](auto span) { return std::vector<glm::dvec2>(span.begin(), span.end()); });
}

py::tuple minimal_rectangle(const py::handle& given, const std::string& criterion) {
    const auto points = planar_points(given);
    const auto c = planar_criterion(criterion);
    const Rectangle r = value_of(unlocked([&] { return fit::minimal_rectangle(points, c); }));
    return py::make_tuple(py::make_tuple(r.center.x, r.center.y), py::make_tuple(r.axis.x, r.axis.y),
                          py::make_tuple(r.half_extents.x, r.half_extents.y));
}

py::array minimal_triangle(const py::handle& given, const std::string& criterion) {
    const auto points = planar_points(given);
    const auto c = planar_criterion(criterion);
    return array_of<double>(value_of(unlocked([&] { return fit::minimal_triangle(points, c); })), 2);
}

py::tuple minimal_disc(const py::handle& given) {
    const auto points = planar_points(given);
    const Disc disc = value_of(unlocked([&] { return fit::minimal_disc(points); }));
    return py::make_tuple(py::make_tuple(disc.center.x, disc.center.y), disc.radius);
}

py::tuple minimal_sphere(const py::handle& given) {
    const Points<3> points(given, "points");
    const auto doubles = points.visit([](auto span) { return std::vector<glm::dvec3>(span.begin(), span.end()); });
    const Sphere sphere = value_of(unlocked([&] { return fit::minimal_sphere(doubles); }));
    return py::make_tuple(tuple_of(sphere.center), sphere.radius);
}

}  // namespace

void bind_fit(py::module_& module) {
    py::class_<fit::ExactFit>(module, "ExactFit",
                              "The best box around points, with a bound on how far it is from the optimum.")
        .def_readonly("box", &fit::ExactFit::box)
        .def_readonly("value", &fit::ExactFit::value, "the criterion of `box`")
        .def_readonly("lower_bound", &fit::ExactFit::lower_bound,
                      "a lower bound: no box around the points has a smaller value")
        .def_readonly("gap", &fit::ExactFit::gap, "(value − lower_bound) / value")
        .def_readonly("complete", &fit::ExactFit::complete, "the search ended by itself")
        .def_readonly("cells", &fit::ExactFit::cells, "how many sets of orientations the search tested")
        .def("__repr__", [](const fit::ExactFit& f) {
            return format("ExactFit(value=%g, gap=%g, %s)", f.value, f.gap, f.complete ? "complete" : "not complete");
        });

    module.def("fit_obb", &fit_obb, py::arg("points"), py::arg("criterion") = "perimeter", py::arg("quality") = "tight",
               "Returns the oriented box around points of shape (n, 3) that is best by a criterion. It contains every "
               "point exactly.");
    module.def("fit_exact", &fit_exact, py::arg("points"), py::arg("criterion") = "perimeter", py::kw_only(),
               py::arg("gap") = 2e-7, py::arg("seconds") = py::none(), py::arg("progress") = py::none(),
               "Finds the best of all boxes, to the relative `gap`. `progress(value, lower_bound)` may end the search "
               "by returning False; the result then has the gap reached. Ctrl-C raises KeyboardInterrupt.");
    module.def("fit_many", &fit_many, py::arg("positions"), py::arg("ends"), py::arg("indices") = py::none(),
               py::arg("criterion") = "perimeter", py::arg("quality") = "fast",
               "Fits a box to each cluster of points; cluster i holds indices[ends[i − 1]:ends[i]]. Returns an array "
               "of box_dtype.");
    module.def("minimal_rectangle", &minimal_rectangle, py::arg("points"), py::arg("criterion") = "perimeter",
               "Returns the best rectangle around points in the plane: (center, axis, half_extents).");
    module.def("minimal_triangle", &minimal_triangle, py::arg("points"), py::arg("criterion") = "area",
               "Returns the best triangle around points in the plane, shape (3, 2), counter-clockwise.");
    module.def("minimal_disc", &minimal_disc, py::arg("points"),
               "Returns the smallest disc around points in the plane: (center, radius).");
    module.def("minimal_sphere", &minimal_sphere, py::arg("points"),
               "Returns the smallest sphere around points: (center, radius).");
}

}  // namespace crofton::python
