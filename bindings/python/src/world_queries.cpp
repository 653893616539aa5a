// SPDX-License-Identifier: MIT
// What rays and shapes meet in a World, and what is known of its objects.
#include <pybind11/stl.h>
#include <crofton/world/object_manifold.hpp>

#include <limits>

#include "method.hpp"
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

// A QueryFilter of `layers=` and `ignored=`: None, a handle, or several.
class Filter {
  public:
    Filter(std::uint32_t layers, const py::handle& ignored) : layers_(layers) {
        if (!ignored.is_none()) ignored_.emplace(ignored, "ignored");
    }
    Filter(const py::handle& layers, const py::handle& ignored)
        : Filter(layers.is_none() ? ~0u : number_of<std::uint32_t>(layers, "layers"), ignored) {}
    [[nodiscard]] QueryFilter get() const {
        return {layers_, ignored_ ? ignored_->span() : std::span<const ObjectHandle>()};
    }

  private:
    std::uint32_t layers_;
    std::optional<Handles<ObjectHandle>> ignored_;
};

py::array raycast_many(const PyWorld& python_world, const py::handle& origins, const py::handle& directions,
                       double max_t, std::uint32_t layers, const py::handle& ignored) {
    const Filter filter(layers, ignored);
    const Points<3> from(origins, "origins"), along(directions, "directions");
    if (from.size() != along.size() && from.size() != 1)
        raise({ErrorCode::invalid_argument, kNoItem, "origins: as many as directions, or one, are expected"});
    const auto at = [](const Points<3>& points, std::size_t i) {
        if (points.size() == 1) i = 0;
        return points.is_float() ? glm::dvec3(points.floats()[i]) : points.doubles()[i];
    };
    py::array_t<HitRecord> result(static_cast<py::ssize_t>(along.size()));
    HitRecord* out = result.mutable_data();
    std::size_t i = 0;
    Interrupt interrupt;
    const auto some = [&](const World& world) -> Result<void> {
        for (; i < along.size(); ++i) {
            if (i % 256 == 255 && interrupt.is_pending()) return {};
            const Ray ray{at(from, i), at(along, i), max_t};
            if (auto valid = validate(ray, i); !valid) return valid;
            const auto hit = world.raycast(ray, filter.get());
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
    };
    for (; i < along.size(); Interrupt::raise()) value_of(python_world.ask(some));
    return result;
}

Ray ray_of(const py::handle& origin, const py::handle& direction, double max_t) {
    const Ray ray{vector_of(origin, "origin"), vector_of(direction, "direction"), max_t};
    value_of(validate(ray));
    return ray;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

py::object borrowed(const py::handle& given) {
    return py::reinterpret_borrow<py::object>(given);
}

// What a query asks with: a box, a sphere, a capsule, or a shape and its pose.
struct Probe {
    py::handle box, sphere, capsule, shape, pose;
};

// Calls with the world and the probe; with a shape, also with its pose.
template <class F>
void visit_probe(const PyWorld& world, const Probe& probe, F&& f) {
    if (probe.shape.is_none()) {
        if (!probe.pose.is_none()) raise_type("pose: it places a shape, and there is none");
        const Shape shape = shape_of(borrowed(probe.box), borrowed(probe.sphere), borrowed(probe.capsule));
        world.ask([&](const World& w) { std::visit([&](const auto& one) { f(w, one); }, shape); });
        return;
    }
    const PyShape* const shape = as<PyShape>(probe.shape);
    if (!shape) raise_type("shape: a Shape is expected");
    if (!probe.box.is_none() || !probe.sphere.is_none() || !probe.capsule.is_none())
        raise_type("one of box=, sphere=, capsule= and shape= is expected, not more");
    if (shape->shape->kind() == convex::Kind::half_space)
        raise({ErrorCode::unsupported, kNoItem, "shape: a half-space is infinite; ask with a shape that has bounds"});
    const RigidTransform pose = pose_of(borrowed(probe.pose), "pose");
    world.ask([&](const World& w) { f(w, *shape->shape, pose); });
}

PyObject* overlap_method(PyObject* self, PyObject* const* values, Py_ssize_t count, PyObject* keywords) {
    return call_method<PyWorld>(self, [&](const PyWorld& world) {
        constexpr std::array kNames = {"box", "sphere", "capsule", "shape", "pose", "layers", "ignored"};
        const auto a = arguments_of("overlap", kNames, 0, values, count, keywords);
        const Filter filter(a[5], a[6]);
        Vector<ObjectRef> found;
        visit_probe(world, {a[0], a[1], a[2], a[3], a[4]},
                    [&](const World& w, const auto&... probe) { w.overlap(probe..., found, filter.get()); });
        py::array handles(handle_dtype(), py::array::ShapeContainer{static_cast<py::ssize_t>(found.size())});
        auto* out = static_cast<ObjectHandle*>(handles.mutable_data());
        for (const ObjectRef& ref : found) *out++ = ref.object;
        return handles;
    });
}

PyObject* closest_method(PyObject* self, PyObject* const* values, Py_ssize_t count, PyObject* keywords) {
    return call_method<PyWorld>(self, [&](const PyWorld& world) {
        constexpr std::array kNames = {"max_distance", "box",  "sphere", "capsule",
                                       "shape",        "pose", "layers", "ignored"};
        const auto a = arguments_of("closest", kNames, 1, values, count, keywords);
        const auto max_distance = number_of<double>(a[0], "max_distance");
        check_limit(max_distance, "max_distance");
        const Filter filter(a[6], a[7]);
        std::optional<ClosestObject> found;
        visit_probe(world, {a[1], a[2], a[3], a[4], a[5]}, [&](const World& w, const auto&... probe) {
            found = w.closest(probe..., max_distance, filter.get());
        });
        return py::cast(found);
    });
}

PyObject* raycast_method(PyObject* self, PyObject* const* values, Py_ssize_t count, PyObject* keywords) {
    return call_method<PyWorld>(self, [&](const PyWorld& world) {
        constexpr std::array kNames = {"origin", "direction", "max_t", "layers", "ignored"};
        const auto a = arguments_of("raycast", kNames, 4, values, count, keywords);
        const Ray ray = ray_of(a[0], a[1], a[2].is_none() ? kInfinity : number_of<double>(a[2], "max_t"));
        const Filter filter(a[3], a[4]);
        return py::cast(world.ask([&](const World& w) { return w.raycast(ray, filter.get()); }));
    });
}

// The arguments that all casts share.
struct Cast {
    Cast(const py::handle& velocity, const py::object& given_pose, const py::handle& spin, double duration,
         bool ignore_initial_overlaps, std::uint32_t layers, const py::handle& ignored)
        : filter(layers, ignored),
          motion{vector_of(velocity, "velocity"), vector_of(spin, "spin")},
          pose(pose_of(given_pose, "pose")),
          options{.duration = duration, .ignore_initial_overlaps = ignore_initial_overlaps} {}

    Filter filter;
    convex::Motion motion;
    RigidTransform pose;
    convex::CastOptions options;
};

std::optional<ShapeHit> cast(const PyWorld& world, const PyShape& shape, const py::handle& velocity,
                             const py::object& given_pose, const py::handle& spin, double duration,
                             bool ignore_initial_overlaps, std::uint32_t layers, const py::handle& ignored) {
    const Cast given(velocity, given_pose, spin, duration, ignore_initial_overlaps, layers, ignored);
    return value_of(world.ask([&](const World& w) {
        return w.cast(*shape.shape, given.pose, given.motion, given.options, given.filter.get());
    }));
}

py::list cast_all(const PyWorld& world, const PyShape& shape, const py::handle& velocity, const py::object& given_pose,
                  const py::handle& spin, double duration, bool ignore_initial_overlaps, std::uint32_t layers,
                  const py::handle& ignored) {
    const Cast given(velocity, given_pose, spin, duration, ignore_initial_overlaps, layers, ignored);
    Vector<ShapeHit> hits;
    value_of(world.ask([&](const World& w) {
        return w.cast_all(*shape.shape, given.pose, given.motion, given.options, hits, given.filter.get());
    }));
    py::list result;
    for (const ShapeHit& hit : hits) result.append(hit);
    return result;
}

py::list contact_manifolds(const PyWorld& world, const PyShape& shape, const py::object& given_pose, double margin,
                           int max_points, std::uint32_t layers, const py::handle& ignored) {
    const Filter filter(layers, ignored);
    const RigidTransform pose = pose_of(given_pose, "pose");
    Vector<ObjectManifold> found;
    value_of(world.ask([&](const World& w) {
        return w.contact_manifolds(*shape.shape, pose, {margin, max_points}, found, filter.get());
    }));
    py::list result;
    for (const ObjectManifold& manifold : found) result.append(manifold);
    return result;
}

py::object triangle_or_none(std::uint32_t triangle) {
    return triangle == kNoTriangle ? py::object(py::none()) : py::object(py::int_(triangle));
}

}  // namespace

void bind_world_queries(py::module_& module, py::class_<PyWorld>& type) {
    PYBIND11_NUMPY_DTYPE(HitRecord, index, generation, t, point, triangle, hit, user);
    py::class_<ObjectRef>(module, "ObjectRef", "An object with its user number.")
        .def_readonly("object", &ObjectRef::object)
        .def_readonly("user", &ObjectRef::user)
        .def("__repr__", [](const ObjectRef& r) {
            return format("ObjectRef(index=%u, user=%llu)", r.object.index, static_cast<unsigned long long>(r.user));
        });
    py::class_<ObjectHit>(module, "ObjectHit", "The first hit of a ray on an object.")
        .def_readonly("object", &ObjectHit::object)
        .def_readonly("user", &ObjectHit::user)
        .def_readonly("t", &ObjectHit::t, "how far along the ray, in lengths of its direction")
        .def_property_readonly("point", [](const ObjectHit& h) { return tuple_of(h.point); })
        .def_property_readonly(
            "normal", [](const ObjectHit& h) { return tuple_of(h.normal); },
            "unit, of the surface, towards the ray; 0 if the ray began inside")
        .def_readonly("started_inside", &ObjectHit::started_inside,
                      "True if the ray began in the box, sphere or solid shape; t is then 0")
        .def("__repr__",
             [](const ObjectHit& h) {
                 return format("ObjectHit(user=%llu, t=%g, point=(%g, %g, %g))",
                               static_cast<unsigned long long>(h.user), h.t, h.point.x, h.point.y, h.point.z);
             })
        .def_property_readonly("triangle", [](const ObjectHit& h) { return triangle_or_none(h.triangle); })
        .def_readonly("child", &ObjectHit::child, "which child of a compound");
    py::class_<ShapeHit>(module, "ShapeHit", "The first object that a moving shape hits.")
        .def_readonly("object", &ShapeHit::object)
        .def_readonly("user", &ShapeHit::user)
        .def_readonly("time", &ShapeHit::time)
        .def_property_readonly(
            "normal", [](const ShapeHit& h) { return tuple_of(h.normal); }, "unit, from the shape to the object")
        .def_property_readonly("point", [](const ShapeHit& h) { return tuple_of(h.point); })
        .def_readonly("distance", &ShapeHit::distance,
                      "the gap at that time; if negative, how deep they overlap at the start")
        .def_property_readonly("triangle", [](const ShapeHit& h) { return triangle_or_none(h.triangle); })
        .def_readonly("child", &ShapeHit::child, "which child of a compound")
        .def_readonly("resolved", &ShapeHit::resolved,
                      "False if the search ended early: nothing is hit up to `time`, and later is not known")
        .def("__repr__", [](const ShapeHit& h) {
            return format("ShapeHit(user=%llu, time=%g, point=(%g, %g, %g))", static_cast<unsigned long long>(h.user),
                          h.time, h.point.x, h.point.y, h.point.z);
        });
    py::class_<ClosestObject>(module, "Closest", "The nearest object.")
        .def_readonly("object", &ClosestObject::object)
        .def_readonly("user", &ClosestObject::user)
        .def_readonly("distance", &ClosestObject::distance)
        .def("__repr__",
             [](const ClosestObject& c) {
                 return format("Closest(user=%llu, distance=%g)", static_cast<unsigned long long>(c.user), c.distance);
             })
        .def_property_readonly("triangle", [](const ClosestObject& c) { return triangle_or_none(c.triangle); })
        .def_readonly("child", &ClosestObject::child, "which child of a compound")
        .def_property_readonly("on_shape", [](const ClosestObject& c) { return tuple_of(c.on_shape); })
        .def_property_readonly("on_object", [](const ClosestObject& c) { return tuple_of(c.on_object); });
    py::class_<ObjectManifold>(module, "ObjectManifold", "Where a shape touches an object, in one direction.")
        .def_readonly("object", &ObjectManifold::object)
        .def_readonly("user", &ObjectManifold::user)
        .def_property_readonly(
            "normal", [](const ObjectManifold& m) { return tuple_of(m.manifold.normal); },
            "unit, from the shape to the object")
        .def_property_readonly(
            "depth", [](const ObjectManifold& m) { return m.manifold.depth; }, "of the deepest point; negative: a gap")
        .def_property_readonly(
            "points",
            [](const ObjectManifold& m) {
                py::list points;
                for (int k = 0; k < m.manifold.count; ++k) points.append(tuple_of(m.manifold.points[k].position));
                return points;
            },
            "midway between the surfaces")
        .def_property_readonly(
            "depths",
            [](const ObjectManifold& m) {
                py::list depths;
                for (int k = 0; k < m.manifold.count; ++k) depths.append(m.manifold.points[k].depth);
                return depths;
            },
            "of the points")
        .def("__repr__", [](const ObjectManifold& m) {
            return format("ObjectManifold(user=%llu, depth=%g, %d points)", static_cast<unsigned long long>(m.user),
                          m.manifold.depth, m.manifold.count);
        });
    add_method(type, "raycast", &raycast_method,
               "raycast($self, origin, direction, max_t=inf, layers=None, ignored=None)\n--\n\n"
               "Returns the nearest ObjectHit, or None.");
    add_method(type, "overlap", &overlap_method,
               "overlap($self, *, box=None, sphere=None, capsule=None, shape=None, pose=None, layers=None, "
               "ignored=None)\n--\n\n"
               "Returns the handles of the objects that overlap a box, sphere, capsule, or Shape at `pose`.");
    add_method(type, "closest", &closest_method,
               "closest($self, max_distance, *, box=None, sphere=None, capsule=None, shape=None, pose=None, "
               "layers=None, ignored=None)\n--\n\n"
               "Returns the nearest object, or None.");
    type.def("raycast_many", &raycast_many, py::arg("origins"), py::arg("directions"), py::arg("max_t") = kInfinity,
             py::arg("layers") = ~0u, py::arg("ignored") = py::none(),
             "Returns the nearest hit of each ray, as an array of records; `hit` is 0 for rays that hit nothing.")
        .def(
            "raycast_all",
            [](const PyWorld& world, const py::handle& origin, const py::handle& direction, double max_t,
               std::uint32_t layers, const py::handle& ignored) {
                const Filter filter(layers, ignored);
                const Ray ray = ray_of(origin, direction, max_t);
                Vector<ObjectHit> hits;
                world.ask([&](const World& w) { w.raycast_all(ray, hits, filter.get()); });
                py::list result;
                for (const ObjectHit& hit : hits) result.append(hit);
                return result;
            },
            py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
            py::arg("ignored") = py::none(), "Returns each object's first ObjectHit, ordered along the ray.")
        .def(
            "raycast_any",
            [](const PyWorld& world, const py::handle& origin, const py::handle& direction, double max_t,
               std::uint32_t layers, const py::handle& ignored) {
                const Filter filter(layers, ignored);
                const Ray ray = ray_of(origin, direction, max_t);
                return world.ask([&](const World& w) { return w.raycast_any(ray, filter.get()); });
            },
            py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
            py::arg("ignored") = py::none(), "Tells whether a ray hits anything; faster than raycast.")
        .def("cast", &cast, py::arg("shape"), py::arg("velocity"), py::arg("pose") = py::none(), py::kw_only(),
             py::arg("spin") = py::make_tuple(0.0, 0.0, 0.0), py::arg("duration") = 1.0,
             py::arg("ignore_initial_overlaps") = false, py::arg("layers") = ~0u, py::arg("ignored") = py::none(),
             "Moves and turns a Shape from `pose` and returns its first ShapeHit, or None.")
        .def("cast_all", &cast_all, py::arg("shape"), py::arg("velocity"), py::arg("pose") = py::none(), py::kw_only(),
             py::arg("spin") = py::make_tuple(0.0, 0.0, 0.0), py::arg("duration") = 1.0,
             py::arg("ignore_initial_overlaps") = false, py::arg("layers") = ~0u, py::arg("ignored") = py::none(),
             "Moves and turns a Shape from `pose` and returns the first ShapeHit with each object, ordered by time.")
        .def("contact_manifolds", &contact_manifolds, py::arg("shape"), py::arg("pose") = py::none(), py::kw_only(),
             py::arg("margin") = 0.0, py::arg("max_points") = 4, py::arg("layers") = ~0u,
             py::arg("ignored") = py::none(),
             "Returns where a Shape at `pose`, which need not be an object, touches the objects, as ObjectManifolds.")
        .def(
            "box_of",
            [](const PyWorld& world, ObjectHandle object) {
                return value_of(world.ask([&](const World& w) { return w.box_of(object); }));
            },
            py::arg("object"), "Returns the object's box as of the last update.")
        .def(
            "transform_of",
            [](const PyWorld& world, ObjectHandle object) {
                return matrix_of(value_of(world.ask([&](const World& w) { return w.transform_of(object); })));
            },
            py::arg("object"), "Returns the object's matrix to the world, shape (4, 4), as of the last update.")
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
        .def("__contains__",
             [](const PyWorld& world, RegionHandle region) {
                 return world.ask([&](const World& w) { return w.contains(region); });
             })
        .def("__len__",
             [](const PyWorld& world) { return world.ask([](const World& w) { return w.object_count(); }); });
}

}  // namespace crofton::python
