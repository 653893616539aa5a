// SPDX-License-Identifier: MIT
// What rays and shapes meet in a World, and what is known of its objects.
#include <pybind11/stl.h>

#include <limits>

#include "shapes.hpp"
#include "world.hpp"

namespace crofton::python {
namespace {

struct HitRecord {
    std::uint32_t index, generation;
    double t;
    double point[3];
    std::uint32_t triangle, hit;
    std::uint64_t user;
};

py::array raycast_many(const PyWorld& python_world, const py::handle& origins, const py::handle& directions,
                       double max_t, std::uint32_t layers) {
    const Points<3> from(origins, "origins"), along(directions, "directions");
    if (from.size() != along.size() && from.size() != 1)
        raise({ErrorCode::invalid_argument, kNoItem, "origins: as many as directions, or one, are expected"});
    const auto at = [](const Points<3>& points, std::size_t i) {
        if (points.size() == 1) i = 0;
        return points.is_float() ? glm::dvec3(points.floats()[i]) : points.doubles()[i];
    };
    py::array_t<HitRecord> result(static_cast<py::ssize_t>(along.size()));
    HitRecord* out = result.mutable_data();
    value_of(python_world.ask([&](const World& world) -> Result<void> {
        for (std::size_t i = 0; i < along.size(); ++i) {
            const Ray ray{at(from, i), at(along, i), max_t};
            if (auto valid = validate(ray, i); !valid) return valid;
            const auto hit = world.raycast(ray, layers);
            out[i] = {};
            out[i].t = std::numeric_limits<double>::infinity();
            out[i].index = kNoIndex;
            out[i].triangle = kNoTriangle;
            if (!hit) continue;
            out[i] = {hit->object.index,
                      hit->object.generation,
                      hit->t,
                      {hit->point.x, hit->point.y, hit->point.z},
                      hit->triangle,
                      1,
                      hit->user};
        }
        return {};
    }));
    return result;
}

Ray ray_of(const py::handle& origin, const py::handle& direction, double max_t) {
    const Ray ray{vector_of(origin, "origin"), vector_of(direction, "direction"), max_t};
    value_of(validate(ray));
    return ray;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void bind_world_queries(py::module_& module, py::class_<PyWorld>& type) {
    PYBIND11_NUMPY_DTYPE(HitRecord, index, generation, t, point, triangle, hit, user);
    py::class_<ObjectRef>(module, "ObjectRef", "An object and its user number.")
        .def_readonly("object", &ObjectRef::object)
        .def_readonly("user", &ObjectRef::user);
    py::class_<ObjectHit>(module, "Hit", "Where a ray meets an object.")
        .def_readonly("object", &ObjectHit::object)
        .def_readonly("user", &ObjectHit::user)
        .def_readonly("t", &ObjectHit::t, "how far along the ray, in lengths of its direction")
        .def_property_readonly("point", [](const ObjectHit& h) { return tuple_of(h.point); })
        .def_property_readonly(
            "normal", [](const ObjectHit& h) { return tuple_of(h.normal); },
            "unit, of the surface, to the side that the ray comes from; 0 if it began inside")
        .def_readonly("started_inside", &ObjectHit::started_inside, "the ray began in the box or sphere: t is 0")
        .def("__repr__",
             [](const ObjectHit& h) {
                 return format("Hit(user=%llu, t=%g, point=(%g, %g, %g))", static_cast<unsigned long long>(h.user), h.t,
                               h.point.x, h.point.y, h.point.z);
             })
        .def_property_readonly("triangle", [](const ObjectHit& h) {
            return h.triangle == kNoTriangle ? py::object(py::none()) : py::object(py::int_(h.triangle));
        });
    py::class_<ClosestObject>(module, "Closest", "The nearest object.")
        .def_readonly("object", &ClosestObject::object)
        .def_readonly("user", &ClosestObject::user)
        .def_readonly("distance", &ClosestObject::distance)
        .def("__repr__",
             [](const ClosestObject& c) {
                 return format("Closest(user=%llu, distance=%g)", static_cast<unsigned long long>(c.user), c.distance);
             })
        .def_property_readonly("on_shape", [](const ClosestObject& c) { return tuple_of(c.on_shape); })
        .def_property_readonly("on_object", [](const ClosestObject& c) { return tuple_of(c.on_object); });
    type.def(
            "raycast",
            [](const PyWorld& world, const py::handle& origin, const py::handle& direction, double max_t,
               std::uint32_t layers) {
                const Ray ray = ray_of(origin, direction, max_t);
                return world.ask([&](const World& w) { return w.raycast(ray, layers); });
            },
            py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
            "The nearest Hit, or None.")
        .def("raycast_many", &raycast_many, py::arg("origins"), py::arg("directions"), py::arg("max_t") = kInfinity,
             py::arg("layers") = ~0u,
             "The nearest hit of each ray, as an array of records; `hit` is 0 where there is none.")
        .def(
            "raycast_all",
            [](const PyWorld& world, const py::handle& origin, const py::handle& direction, double max_t,
               std::uint32_t layers) {
                const Ray ray = ray_of(origin, direction, max_t);
                Vector<ObjectHit> hits;
                world.ask([&](const World& w) { w.raycast_all(ray, hits, layers); });
                py::list result;
                for (const ObjectHit& hit : hits) result.append(hit);
                return result;
            },
            py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
            "Every object's nearest Hit, in the order in which the ray meets them.")
        .def(
            "overlap",
            [](const PyWorld& world, const py::object& box, const py::object& sphere, const py::object& capsule,
               std::uint32_t layers) {
                const Shape shape = shape_of(box, sphere, capsule);
                Vector<ObjectRef> found;
                world.ask([&](const World& w) {
                    std::visit([&](const auto& one) { w.overlap(one, found, layers); }, shape);
                });
                std::vector<ObjectHandle> handles;
                for (const ObjectRef& ref : found) handles.push_back(ref.object);
                return handles_of(handles);
            },
            py::kw_only(), py::arg("box") = py::none(), py::arg("sphere") = py::none(), py::arg("capsule") = py::none(),
            py::arg("layers") = ~0u, "The handles of the objects that overlap the shape.")
        .def(
            "closest",
            [](const PyWorld& world, double max_distance, const py::object& box, const py::object& sphere,
               const py::object& capsule, std::uint32_t layers) {
                const Shape shape = shape_of(box, sphere, capsule);
                check_limit(max_distance, "max_distance");
                return world.ask([&](const World& w) {
                    return std::visit([&](const auto& one) { return w.closest(one, max_distance, layers); }, shape);
                });
            },
            py::arg("max_distance"), py::kw_only(), py::arg("box") = py::none(), py::arg("sphere") = py::none(),
            py::arg("capsule") = py::none(), py::arg("layers") = ~0u, "The nearest object, or None.")
        .def(
            "box_of",
            [](const PyWorld& world, ObjectHandle object) {
                return value_of(world.ask([&](const World& w) { return w.box_of(object); }));
            },
            py::arg("object"), "The object's box as of the last update.")
        .def(
            "transform_of",
            [](const PyWorld& world, ObjectHandle object) {
                return matrix_of(value_of(world.ask([&](const World& w) { return w.transform_of(object); })));
            },
            py::arg("object"), "Its matrix to the world, shape (4, 4), as of the last update.")
        .def(
            "user_of",
            [](const PyWorld& world, ObjectHandle object) {
                return value_of(world.ask([&](const World& w) { return w.user_of(object); }));
            },
            py::arg("object"))
        .def("__contains__",
             [](const PyWorld& world, ObjectHandle object) {
                 return world.ask([&](const World& w) { return w.contains(object); });
             })
        .def("__contains__",
             [](const PyWorld& world, NodeHandle node) {
                 return world.ask([&](const World& w) { return w.contains(node); });
             })
        .def("__contains__",
             [](const PyWorld& world, MeshHandle mesh) {
                 return world.ask([&](const World& w) { return w.contains(mesh); });
             })
        .def("__len__",
             [](const PyWorld& world) { return world.ask([](const World& w) { return w.object_count(); }); });
}

}  // namespace crofton::python
