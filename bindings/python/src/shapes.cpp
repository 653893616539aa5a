// SPDX-License-Identifier: MIT
#include "shapes.hpp"

#include <cmath>
#include <string>

namespace crofton::python {
namespace {

// The parts of a sequence of so many. `what` says what is expected.
py::sequence parts_of(const py::object& given, std::size_t count, const char* what) {
    if (!py::isinstance<py::sequence>(given) || py::isinstance<py::str>(given) || py::len(given) != count)
        raise_type(std::string(what) + " is expected");
    return py::reinterpret_borrow<py::sequence>(given);
}

const Obb& box_of(const py::object& given) {
    const Obb* const box = as<Obb>(given);
    if (!box) raise_type("box: a Box is expected");
    return *box;
}

Sphere sphere_of(const py::object& given) {
    const py::sequence parts = parts_of(given, 2, "sphere: (center, radius)");
    return {vector_of(py::object(parts[0]), "sphere"), number_of<double>(py::object(parts[1]), "sphere")};
}

collide::Capsule capsule_of(const py::object& given) {
    const py::sequence parts = parts_of(given, 3, "capsule: (begin, end, radius)");
    return {vector_of(py::object(parts[0]), "capsule"), vector_of(py::object(parts[1]), "capsule"),
            number_of<double>(py::object(parts[2]), "capsule")};
}

Aabb aligned_of(const py::object& given) {
    const py::sequence parts = parts_of(given, 2, "aligned: (low, high)");
    return {vector_of(py::object(parts[0]), "aligned"), vector_of(py::object(parts[1]), "aligned")};
}

int given_of(const py::object& a, const py::object& b, const py::object& c) {
    return int{!a.is_none()} + int{!b.is_none()} + int{!c.is_none()};
}

void check_place(const glm::dvec3& place, const char* name) {
    for (int k = 0; k < 3; ++k)
        if (!std::isfinite(place[k]))
            raise({ErrorCode::non_finite, kNoItem, std::string(name) + ": a coordinate is NaN or infinite"});
}

void check_radius(double radius, const char* name) {
    if (!std::isfinite(radius))
        raise({ErrorCode::non_finite, kNoItem, std::string(name) + ": the radius is NaN or infinite"});
    if (radius < 0.0) raise({ErrorCode::invalid_argument, kNoItem, std::string(name) + ": the radius is negative"});
}

}  // namespace

Bound bound_of(const py::object& box, const py::object& sphere, const py::object& aligned) {
    if (given_of(box, sphere, aligned) > 1) raise_type("one of box=, sphere= and aligned= is expected, not more");
    if (!box.is_none()) return Bound(box_of(box));
    if (!sphere.is_none()) return Bound(sphere_of(sphere));
    if (!aligned.is_none()) return Bound(aligned_of(aligned));
    return {};
}

Shape shape_of(const py::object& box, const py::object& sphere, const py::object& capsule) {
    if (given_of(box, sphere, capsule) != 1) raise_type("one of box=, sphere= and capsule= is expected");
    if (!box.is_none()) return box_of(box);
    if (!sphere.is_none()) {
        const Sphere shape = sphere_of(sphere);
        check_place(shape.center, "sphere");
        check_radius(shape.radius, "sphere");
        return shape;
    }
    const collide::Capsule shape = capsule_of(capsule);
    check_place(shape.begin, "capsule");
    check_place(shape.end, "capsule");
    check_radius(shape.radius, "capsule");
    return shape;
}

void check_limit(double value, const char* name) {
    if (std::isnan(value)) raise({ErrorCode::non_finite, kNoItem, std::string(name) + " is NaN"});
    if (value < 0.0) raise({ErrorCode::invalid_argument, kNoItem, std::string(name) + " is negative"});
}

}  // namespace crofton::python
