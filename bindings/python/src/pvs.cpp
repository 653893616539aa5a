// SPDX-License-Identifier: MIT
#include <crofton/pvs/pvs.hpp>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

using pvs::Cells;
using pvs::Pvs;

// Numbers of shape (n, `rows`, 3) as doubles.
py::array_t<double> point_groups(const py::handle& given, py::ssize_t rows, const char* what) {
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!array) {
        PyErr_Clear();
        raise_type(what);
    }
    if (array.ndim() != 3 || array.shape(1) != rows || array.shape(2) != 3) raise_type(what);
    return array;
}

constexpr const char* kCellShapes =
    "cells: three counts, boxes of shape (n, 2, 3) or convex cells of shape (n, 8, 3) are expected";

Cells cells_of(const py::handle& given, const Aabb& bounds) {
    const auto array = py::array::ensure(given);
    if (!array) {
        PyErr_Clear();
        raise_type(kCellShapes);
    }
    if (array.ndim() == 1) {
        const auto counts = integers<std::uint32_t>(given, "cells");
        if (counts.size() != 3) raise_type(kCellShapes);
        return value_of(Cells::grid(bounds, {counts.at(0), counts.at(1), counts.at(2)}));
    }
    const py::ssize_t rows = array.ndim() == 3 && array.shape(1) == 8 ? 8 : 2;
    const auto points = point_groups(array, rows, kCellShapes);
    const auto at = points.unchecked<3>();
    const auto point = [&](py::ssize_t i, py::ssize_t k) { return glm::dvec3(at(i, k, 0), at(i, k, 1), at(i, k, 2)); };
    if (rows == 2) {
        Vector<Aabb> boxes;
        for (py::ssize_t i = 0; i < at.shape(0); ++i) boxes.push_back({point(i, 0), point(i, 1)});
        return value_of(Cells::boxes(boxes));
    }
    Vector<pvs::ConvexCell> convex(static_cast<std::size_t>(at.shape(0)));
    for (py::ssize_t i = 0; i < at.shape(0); ++i)
        for (py::ssize_t k = 0; k < 8; ++k)
            convex[static_cast<std::size_t>(i)].corners[static_cast<std::size_t>(k)] = point(i, k);
    return value_of(Cells::convex(convex));
}

// Doubles are stored as floats around the middle of them all, floats as they are.
void take_positions(const Points<3>& points, pvs::BakeGeometry& geometry, Aabb& bounds) {
    points.visit([&](auto span) {
        for (const auto& p : span) {
            bounds.min = glm::min(bounds.min, glm::dvec3(p));
            bounds.max = glm::max(bounds.max, glm::dvec3(p));
        }
        if (!points.is_float() && !bounds.is_empty()) geometry.origin = 0.5 * (bounds.min + bounds.max);
        for (const auto& p : span) geometry.mesh.positions.push_back(glm::vec3(glm::dvec3(p) - geometry.origin));
    });
}

// How much wider a box must be than the stored positions of its object. The caller's positions are up to 2^-24 of the
// mesh's half extent from those. Half extents are rounded to floats as much, and doubles to 2^-53 of a coordinate. The
// object's own extent is no measure: that of a flat one is 0.
double margin_of(const Aabb& bounds) {
    const glm::dvec3 size = bounds.max - bounds.min, far = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
    return 0x1p-23 * std::max({size.x, size.y, size.z}) + 0x1p-50 * std::max({far.x, far.y, far.z});
}

// A box along the axes around each object's triangles, `margin` wider.
void box_objects(pvs::BakeGeometry& geometry, std::size_t objects, double margin) {
    Vector<Aabb> around(objects);
    for (std::size_t t = 0; t < geometry.object_of.size(); ++t) {
        Aabb& box = around[geometry.object_of[t]];
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p =
                glm::dvec3(geometry.mesh.positions[geometry.mesh.indices[3 * t + k]]) + geometry.origin;
            box.min = glm::min(box.min, p);
            box.max = glm::max(box.max, p);
        }
    }
    for (const Aabb& box : around) {
        if (box.is_empty()) {
            geometry.boxes.push_back({});
            continue;
        }
        const glm::dvec3 half = 0.5 * (box.max - box.min) + margin;
        geometry.boxes.push_back({0.5 * (box.min + box.max), glm::mat3(1.0f), glm::vec3(half)});
    }
}

pvs::BakeGeometry geometry_of(const py::handle& positions, const py::handle& indices, const py::object& object_of,
                              Aabb& bounds) {
    const Points<3> points(positions, "positions");
    const auto corners = integers<std::uint32_t>(indices, "indices");
    pvs::BakeGeometry geometry;
    take_positions(points, geometry, bounds);
    geometry.mesh.indices.assign(span_of(corners).begin(), span_of(corners).end());
    value_of(validate(geometry.mesh));
    const std::size_t triangles = geometry.mesh.indices.size() / 3;
    if (object_of.is_none()) {
        geometry.object_of.assign(triangles, 0);
    } else {
        const auto objects = integers<std::uint32_t>(object_of, "object_of");
        if (static_cast<std::size_t>(objects.size()) != triangles)
            raise_type("object_of: an object for each triangle is expected");
        geometry.object_of.assign(span_of(objects).begin(), span_of(objects).end());
    }
    std::size_t count = 0;
    for (std::size_t t = 0; t < triangles; ++t) {
        if (geometry.object_of[t] >= (1u << 24))
            raise({ErrorCode::out_of_range, t, "object_of: objects are numbered from 0, below 2^24"});
        count = std::max(count, std::size_t{geometry.object_of[t]} + 1);
    }
    box_objects(geometry, count, margin_of(bounds));
    return geometry;
}

struct Wanted {
    pvs::BakeOptions bake;
    pvs::RunLimits limits;
    pvs::ProofOptions proof;
};

Pvs bake(const py::handle& positions, const py::handle& indices, const py::object& object_of, const py::handle& cells,
         const py::object& bounds, double epsilon, double confidence, std::uint64_t seed, const std::string& sides,
         std::uint32_t surface_steps, double near_radius, const py::object& seconds, const py::object& progress) {
    Wanted wanted;
    wanted.bake = {
        epsilon, confidence, seed,
        choice_of<occlude::Sides>("sides", sides, {{"both", occlude::Sides::both}, {"front", occlude::Sides::front}})};
    wanted.proof.surface_steps = surface_steps;
    wanted.proof.near_radius = near_radius;
    if (!seconds.is_none()) wanted.limits.seconds = number_of<double>(seconds, "seconds");
    Watch watch(progress);
    wanted.limits.user = &watch;
    wanted.limits.should_stop = [](void* user, double share) {
        return static_cast<Watch*>(user)->should_stop(share, 1.0);
    };
    Aabb around;
    const pvs::BakeGeometry geometry = geometry_of(positions, indices, object_of, around);
    if (!bounds.is_none()) {
        const Points<3> corners(bounds, "bounds");
        if (corners.size() != 2) raise_type("bounds: two corners are expected, the lower one first");
        corners.visit([&](auto span) { around = {glm::dvec3(span[0]), glm::dvec3(span[1])}; });
    }
    const Cells where = cells_of(cells, around);
    const auto threads = executor();
    auto made = unlocked([&]() -> Result<Pvs> {
        auto lines = pvs::Bake::create(geometry, where, wanted.bake);
        if (!lines) return std::move(lines.error());
        if (auto ran = lines->run(wanted.limits, *threads); !ran) return std::move(ran.error());
        if (watch.is_raised()) return fail(ErrorCode::cancelled, kNoItem, "pvs: stopped");  // without the proofs
        return Pvs::finish(*lines, {}, wanted.proof, *threads);
    });
    watch.raise_if_stopped();
    return value_of(std::move(made));
}

std::size_t checked_cell(const Pvs& sets, std::size_t cell) {
    if (cell >= sets.cells().size())
        raise({ErrorCode::out_of_range, cell, "there are " + std::to_string(sets.cells().size()) + " cells"});
    return cell;
}

pvs::Mode mode_of(const std::string& name) {
    return choice_of<pvs::Mode>("mode", name,
                                {{"conservative", pvs::Mode::conservative}, {"statistical", pvs::Mode::statistical}});
}

py::array_t<bool> bits_of(const Pvs& sets, std::span<const std::uint64_t> words) {
    py::array_t<bool> result(static_cast<py::ssize_t>(sets.object_count()));
    auto out = result.mutable_unchecked<1>();
    for (std::uint32_t o = 0; o < sets.object_count(); ++o)
        out(o) = words.empty() || (words[o / 64] >> (o % 64) & 1u) != 0;
    return result;
}

// By an eye, three numbers, or by a cell.
py::array_t<bool> visible(const Pvs& sets, const py::handle& from, const std::string& mode) {
    if (PyIndex_Check(from.ptr()) && !py::isinstance<py::array>(from)) {
        const Py_ssize_t number = PyNumber_AsSsize_t(from.ptr(), nullptr);  // clipped
        const std::size_t cell = checked_cell(sets, number < 0 ? SIZE_MAX : static_cast<std::size_t>(number));
        return bits_of(sets, sets.visible_from(static_cast<std::uint32_t>(cell), mode_of(mode)));
    }
    return bits_of(sets, sets.visible_from(vector_of(from, "eye"), mode_of(mode)));
}

py::array_t<std::uint8_t> states(const Pvs& sets) {
    py::array_t<std::uint8_t> result({sets.cells().size(), std::size_t{sets.object_count()}});
    auto out = result.mutable_unchecked<2>();
    for (py::ssize_t c = 0; c < out.shape(0); ++c)
        for (py::ssize_t o = 0; o < out.shape(1); ++o)
            out(c, o) =
                static_cast<std::uint8_t>(sets.state(static_cast<std::size_t>(c), static_cast<std::uint32_t>(o)));
    return result;
}

py::array_t<std::uint8_t> kinds(const Pvs& sets) {
    py::array_t<std::uint8_t> result(static_cast<py::ssize_t>(sets.cells().size()));
    for (std::size_t c = 0; c < sets.cells().size(); ++c)
        result.mutable_data()[c] = static_cast<std::uint8_t>(sets.kind(c));
    return result;
}

py::array_t<double> cell_boxes(const Pvs& sets) {
    py::array_t<double> result({sets.cells().size(), std::size_t{2}, std::size_t{3}});
    for (std::size_t c = 0; c < sets.cells().size(); ++c) {
        const Aabb box = sets.cells().box(c);
        std::memcpy(result.mutable_data() + 6 * c, &box.min, 3 * sizeof(double));
        std::memcpy(result.mutable_data() + 6 * c + 3, &box.max, 3 * sizeof(double));
    }
    return result;
}

constexpr std::uint64_t kMostPairs = pvs::ReadLimits{}.pairs;

// From a str, bytes or a pathlib.Path. Raises TypeError for others.
Pvs open(const py::object& given, std::uint64_t most_pairs) {
    const std::string path = py::module_::import("os").attr("fsencode")(given).cast<py::bytes>();
    return value_of(unlocked([&] { return Pvs::open(path, {most_pairs}); }));
}

Pvs from_bytes(const py::bytes& given, std::uint64_t most_pairs) {
    const std::string_view text = given;
    const auto* const first = reinterpret_cast<const std::byte*>(text.data());
    const Vector<std::byte> copied(first, first + text.size());  // starts at a multiple of 64
    return value_of(Pvs::from_memory(copied, {most_pairs}));
}

py::bytes to_bytes(const Pvs& sets) {
    const auto file = value_of(sets.to_file());
    return {reinterpret_cast<const char*>(file.data()), file.size()};
}

py::dict counts(const Pvs& sets) {
    const pvs::PairCounts found = sets.counts();
    py::dict result;
    result["hidden"] = found.hidden;
    result["unseen"] = found.unseen;
    result["seen"] = found.seen;
    return result;
}

py::object find_cell(const Pvs& sets, const py::handle& eye) {
    const std::uint32_t cell = sets.find_cell(vector_of(eye, "eye"));
    return cell == pvs::kNoCell ? py::object(py::none()) : py::object(py::int_(cell));
}

}  // namespace

void bind_pvs(py::module_& module) {
    module.attr("HIDDEN") = static_cast<int>(pvs::PairState::hidden);
    module.attr("UNSEEN") = static_cast<int>(pvs::PairState::unseen);
    module.attr("SEEN") = static_cast<int>(pvs::PairState::seen);
    py::class_<Pvs>(module, "Pvs", "Potentially visible sets: which objects can be seen from each cell.")
        .def_static("bake", &bake, py::arg("positions"), py::arg("indices"), py::arg("object_of") = py::none(),
                    py::kw_only(), py::arg("cells") = py::make_tuple(8, 8, 8), py::arg("bounds") = py::none(),
                    py::arg("epsilon") = 1e-4, py::arg("confidence") = 0.999, py::arg("seed") = 1,
                    py::arg("sides") = "both", py::arg("surface_steps") = 0, py::arg("near_radius") = 0.5,
                    py::arg("seconds") = py::none(), py::arg("progress") = py::none(),
                    "Bakes the visible sets of a mesh whose triangle t belongs to object_of[t], by uniform lines. "
                    "`cells` are counts of a grid in `bounds` (by default the mesh's), boxes, or convex cells. The "
                    "probability that any pair that holds more than `epsilon` of its cell's lines is missed is at most "
                    "1 - confidence. If `surface_steps` is above 0 (400 is good for levels), it also proves what the "
                    "triangles hide. After `seconds`, or when `progress(share, 1.0)` returns False, it returns what "
                    "was found so far, and `epsilon` says what that is worth.")
        .def_static("open", &open, py::arg("path"), py::arg("most_pairs") = kMostPairs,
                    "Reads visible sets from the bytes of a file that `crofton pvs --out` or to_bytes() made. Refuses "
                    "a file with more than `max_pairs` pairs of a cell and an object, because a small file may hold "
                    "very many, and each takes a byte while it is read.")
        .def_static("from_bytes", &from_bytes, py::arg("file"), py::arg("most_pairs") = kMostPairs)
        .def("to_bytes", &to_bytes, "Returns the sets as the bytes of a .crofton file.")
        .def("find_cell", &find_cell, py::arg("eye"),
             "Returns the cell that contains a point, or None if there is none or it is solid.")
        .def("visible", &visible, py::arg("eye"), py::arg("mode") = "conservative",
             "Returns for each object whether it may be visible from an eye, or from the cell with that number. "
             "'conservative' returns all that is not proved hidden, 'statistical' what lines have seen. Outside of all "
             "cells everything is visible.")
        .def_property_readonly("states", &states,
                               "HIDDEN (proved), UNSEEN or SEEN for each cell and object, shape (cells, objects).")
        .def_property_readonly("kinds", &kinds, "For each cell: 0 unknown, 1 solid, 2 inner, 3 open to the outside.")
        .def_property_readonly("cell_boxes", &cell_boxes, "The bounds of each cell, shape (n, 2, 3).")
        .def_property_readonly("counts", &counts, "How many pairs of a cell and an object are hidden, unseen and seen.")
        .def_property_readonly("cell_count", [](const Pvs& sets) { return sets.cells().size(); })
        .def_property_readonly("object_count", &Pvs::object_count)
        .def_property_readonly("epsilon", &Pvs::epsilon,
                               "The share of a cell's lines above which a pair is found with the stated confidence; "
                               "above 1 nothing is promised.")
        .def_property_readonly("confidence", &Pvs::confidence)
        .def("__repr__", [](const Pvs& sets) {
            return "Pvs(" + std::to_string(sets.cells().size()) + " cells, " + std::to_string(sets.object_count()) +
                   " objects, epsilon=" + std::to_string(sets.epsilon()) + ")";
        });
}

}  // namespace crofton::python
