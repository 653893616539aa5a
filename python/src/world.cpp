// SPDX-License-Identifier: MIT
#include <pybind11/stl.h>

#include <crofton/crofton.hpp>
#include <cstdio>
#include <mutex>
#include <shared_mutex>
#include <string>

#include "convert.hpp"
#include "module.hpp"
#include "shapes.hpp"
#include "view.hpp"

namespace crofton::python {
namespace {

template <class... Values>
std::string format(const char* text, Values... values) {
    char line[200];
    std::snprintf(line, sizeof line, text, values...);
    return line;
}

// Points and indices that keep their arrays alive.
struct MeshArrays {
    Points<3> positions;
    py::array indices;

    MeshArrays(const py::handle& given, const py::object& given_indices) : positions(given, "positions") {
        if (given_indices.is_none()) return;
        const py::array array = py::array::ensure(given_indices);
        if (!array) PyErr_Clear();
        const bool is_short = array && array.dtype().equal(py::dtype::of<std::uint16_t>());
        indices = is_short ? py::array(integers<std::uint16_t>(array, "indices"))
                           : py::array(integers<std::uint32_t>(given_indices, "indices"));
        // The library takes no indices for "three positions are one triangle".
        if (indices.size() == 0) raise({ErrorCode::empty, kNoItem, "indices: there are none, so there is no triangle"});
    }
    [[nodiscard]] PointsView points() const {
        return positions.is_float() ? PointsView(positions.floats()) : PointsView(positions.doubles());
    }
    [[nodiscard]] MeshDescription description() const {
        MeshDescription result{.positions = points()};
        if (!indices) return result;
        const auto size = static_cast<std::size_t>(indices.size());
        result.indices = indices.itemsize() == 2 ? IndicesView(static_cast<const std::uint16_t*>(indices.data()), size)
                                                 : IndicesView(static_cast<const std::uint32_t*>(indices.data()), size);
        return result;
    }
};

template <class H>
H handle_or_null(const py::object& given, const char* name) {
    if (given.is_none()) return {};
    if (!py::isinstance<H>(given)) raise_type(std::string(name) + ": another kind of handle is expected");
    return given.cast<H>();
}

// What a view saw. Its arrays are made when the view is, so that the World may change afterwards.
struct Seen {
    py::array_t<std::uint32_t> ids, occluded_ids;
    py::array_t<std::uint64_t> users;
    py::array_t<std::uint8_t> verdicts;
    py::array handles;
    py::object depth = py::none();
    cull::Statistics statistics;
    OcclusionStatistics occlusion;
};

struct HitRecord {
    std::uint32_t index, generation;
    double t;
    double point[3];
    std::uint32_t triangle, hit;
    std::uint64_t user;
};

// A World and a lock: changes need it for themselves, questions share it. Taken without the interpreter's lock.
class PyWorld {
  public:
    explicit PyWorld(const WorldOptions& options) : world_(options) {}

    template <class F>
    auto change(F&& f) {
        return unlocked([&] {
            const std::unique_lock lock(mutex_);
            return f(world_);
        });
    }
    template <class F>
    auto ask(F&& f) const {
        return unlocked([&] {
            const std::shared_lock lock(mutex_);
            return f(world_);
        });
    }

    ObjectHandle add(const py::object& mesh, const py::object& node, const py::object& transform, const py::object& box,
                     const py::object& ball, const py::object& aligned, std::uint64_t user, std::uint32_t layers,
                     std::uint32_t collides_with, bool occludes) {
        ObjectDescription description;
        description.mesh = handle_or_null<MeshHandle>(mesh, "mesh");
        description.node = handle_or_null<NodeHandle>(node, "node");
        if (!transform.is_none()) description.transform = transform_of(transform, "transform");
        description.bound = bound_of(box, ball, aligned);
        description.user = user;
        description.layers = layers;
        description.collides_with = collides_with;
        description.occludes = occludes;
        return value_of(change([&](World& world) { return world.add(description); }));
    }

    py::array add_boxes(const py::handle& given, const py::object& users, std::uint32_t layers,
                        std::uint32_t collides_with) {
        const Boxes boxes(given, "boxes");
        return add_all(boxes.span().size(), users, [&](std::size_t i) {
            return ObjectDescription{.bound = boxes.span()[i], .layers = layers, .collides_with = collides_with};
        });
    }
    py::array add_instances(MeshHandle mesh, const py::handle& given, const py::object& users, std::uint32_t layers,
                            std::uint32_t collides_with) {
        const auto transforms = transforms_of(given, "transforms");
        return add_all(transforms.size(), users, [&](std::size_t i) {
            return ObjectDescription{
                .mesh = mesh, .transform = transforms[i], .layers = layers, .collides_with = collides_with};
        });
    }

    Seen view(const py::handle& given, std::uint32_t layers, bool conservative, bool occlusion,
              std::pair<std::uint32_t, std::uint32_t> size) const;
    py::array raycast_many(const py::handle& origins, const py::handle& directions, double max_t,
                           std::uint32_t layers) const;

  private:
    // All or none: what was added before an error is taken out again.
    template <class F>
    py::array add_all(std::size_t count, const py::object& users, F&& description) {
        py::array_t<std::uint64_t, py::array::c_style> held;
        if (!users.is_none()) {
            held = integers<std::uint64_t>(users, "users");
            if (static_cast<std::size_t>(held.size()) != count)
                raise({ErrorCode::invalid_argument, kNoItem, "users: as many as objects are expected"});
        }
        std::vector<ObjectHandle> handles;
        handles.reserve(count);
        auto failed = change([&](World& world) -> Result<void> {
            for (std::size_t i = 0; i < count; ++i) {
                ObjectDescription one = description(i);
                if (held.size() > 0) one.user = held.data()[i];
                auto added = world.add(one);
                if (!added) {
                    for (const ObjectHandle handle : handles) (void)world.remove(handle);
                    added.error().item = i;
                    return tl::unexpected(added.error());
                }
                handles.push_back(*added);
            }
            return {};
        });
        value_of(std::move(failed));
        return handles_of(handles);
    }

    World world_;
    mutable std::shared_mutex mutex_;
};

Seen PyWorld::view(const py::handle& given, std::uint32_t layers, bool conservative, bool occlusion,
                   std::pair<std::uint32_t, std::uint32_t> size) const {
    const bool is_camera = py::isinstance<Camera>(given);
    if (occlusion && !is_camera) raise_type("view: with occlusion a Camera is expected");
    const Camera camera = is_camera ? given.cast<Camera>() : Camera{};
    const cull::View seen = view_of(given, layers);
    const cull::CullOptions options{.mode = conservative ? cull::CullMode::conservative : cull::CullMode::exact};
    const OcclusionOptions hiding{.size = {size.first, size.second}, .list_occluded = true};
    VisibleObjects visible;
    std::vector<ObjectHandle> handles;
    std::vector<std::uint64_t> users;
    std::vector<float> nearness;
    const auto threads = executor();
    value_of(ask([&](const World& world) -> Result<void> {
        if (occlusion) {
            auto view = occlude::occlusion_view_of(camera);
            if (!view) return tl::unexpected(view.error());
            if (auto found = world.view(OccludingView{*view, layers}, hiding, visible, options, *threads); !found)
                return found;
            if (const auto* buffer = visible.occlusion_buffer()) {
                nearness.resize(std::size_t{buffer->size().width} * buffer->size().height);
                buffer->read(nearness);
            }
        } else {
            world.view(seen, visible, options, *threads);
        }
        for (std::size_t i = 0; i < visible.size(); ++i) {
            handles.push_back(visible[i].object);
            users.push_back(visible[i].user);
        }
        return {};
    }));
    Seen result;
    result.ids = array_of<std::uint32_t>(visible.ids());
    result.occluded_ids = array_of<std::uint32_t>(visible.occluded_ids());
    result.users = array_of<std::uint64_t>(users);
    result.verdicts = array_of<std::uint8_t>(visible.verdicts());
    result.handles = handles_of(handles);
    result.statistics = visible.statistics();
    result.occlusion = visible.occlusion_statistics();
    if (!nearness.empty())
        result.depth = array_of<float>(nearness).reshape({py::ssize_t{size.second}, py::ssize_t{size.first}});
    return result;
}

py::array PyWorld::raycast_many(const py::handle& origins, const py::handle& directions, double max_t,
                                std::uint32_t layers) const {
    const Points<3> from(origins, "origins"), along(directions, "directions");
    if (from.size() != along.size() && from.size() != 1)
        raise({ErrorCode::invalid_argument, kNoItem, "origins: as many as directions, or one, are expected"});
    const auto at = [](const Points<3>& points, std::size_t i) {
        if (points.size() == 1) i = 0;
        return points.is_float() ? glm::dvec3(points.floats()[i]) : points.doubles()[i];
    };
    py::array_t<HitRecord> result(static_cast<py::ssize_t>(along.size()));
    HitRecord* out = result.mutable_data();
    value_of(ask([&](const World& world) -> Result<void> {
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

template <class Tag>
void bind_handle(py::module_& module, const char* name) {
    using H = Handle<Tag>;
    py::class_<H>(module, name, "Names a thing in a World. Stale once the thing has been removed.")
        .def(py::init([](std::uint32_t index, std::uint32_t generation) {
                 return H{index, generation};
             }),
             py::arg("index"), py::arg("generation"))
        .def_readonly("index", &H::index)
        .def_readonly("generation", &H::generation)
        .def("__eq__", [](const H& a, const H& b) { return a == b; })
        .def("__eq__", [](const H&, const py::object&) { return false; })
        .def("__hash__", [](const H& h) { return py::hash(py::make_tuple(h.index, h.generation)); })
        .def("__repr__", [name = std::string(name)](const H& h) {
            return name + "(index=" + std::to_string(h.index) + ", generation=" + std::to_string(h.generation) + ")";
        });
}

void bind_answers(py::module_& module) {
    py::class_<Seen>(module, "Visible", "What a view saw, as of the update before.")
        .def_readonly("ids", &Seen::ids, "the objects' indices, ascending")
        .def_readonly("handles", &Seen::handles, "their handles, an array of handle_dtype")
        .def_readonly("users", &Seen::users, "their user numbers")
        .def_readonly("verdicts", &Seen::verdicts, "STRADDLING or INSIDE for each")
        .def_readonly("occluded_ids", &Seen::occluded_ids, "in the view's frustum, and hidden by others")
        .def_readonly("depth", &Seen::depth,
                      "the depth buffer, (height, width), the bottom row first, larger is nearer; or None")
        .def_property_readonly("statistics",
                               [](const Seen& s) {
                                   py::dict d;
                                   d["nodes_tested"] = s.statistics.nodes_tested;
                                   d["boxes_tested"] = s.statistics.boxes_tested;
                                   d["straddling"] = s.statistics.straddling;
                                   d["occluders_drawn"] = s.occlusion.occluders_drawn;
                                   return d;
                               })
        .def("__len__", [](const Seen& s) { return s.ids.size(); })
        .def("__repr__", [](const Seen& s) { return format("Visible(%d objects)", static_cast<int>(s.ids.size())); });
    py::class_<ObjectRef>(module, "ObjectRef", "An object and its user number.")
        .def_readonly("object", &ObjectRef::object)
        .def_readonly("user", &ObjectRef::user);
    py::class_<ObjectHit>(module, "Hit", "Where a ray meets an object.")
        .def_readonly("object", &ObjectHit::object)
        .def_readonly("user", &ObjectHit::user)
        .def_readonly("t", &ObjectHit::t, "how far along the ray, in lengths of its direction")
        .def_property_readonly("point", [](const ObjectHit& h) { return tuple_of(h.point); })
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
}

// A copy of a Contact, whose spans end with the next update.
struct ContactCopy {
    ObjectRef first, second;
    ContactPhase phase;
    glm::dvec3 normal;
    double depth;
    std::vector<collide::ContactPoint> points;
};

std::vector<ContactCopy> contacts_of(const PyWorld& world) {
    return world.ask([](const World& w) {
        std::vector<ContactCopy> result;
        for (const Contact& c : w.contacts())
            result.push_back({c.first, c.second, c.phase, c.normal, c.depth, {c.points.begin(), c.points.end()}});
        return result;
    });
}

const char* phase_name(ContactPhase phase) {
    return phase == ContactPhase::began ? "began" : phase == ContactPhase::stayed ? "stayed" : "ended";
}

void bind_contact(py::module_& module) {
    py::class_<ContactCopy>(module, "Contact", "Two objects that touch, or that did in the update before.")
        .def_property_readonly("first", [](const ContactCopy& c) { return c.first; })
        .def_property_readonly("second", [](const ContactCopy& c) { return c.second; })
        .def_property_readonly(
            "phase", [](const ContactCopy& c) { return phase_name(c.phase); }, "'began', 'stayed' or 'ended'")
        .def_property_readonly(
            "normal", [](const ContactCopy& c) { return tuple_of(c.normal); }, "unit, from the first to the second")
        .def_readonly("depth", &ContactCopy::depth)
        .def("__repr__",
             [](const ContactCopy& c) {
                 return format("Contact(%llu and %llu, %s, depth=%g, %d points)",
                               static_cast<unsigned long long>(c.first.user),
                               static_cast<unsigned long long>(c.second.user), phase_name(c.phase), c.depth,
                               static_cast<int>(c.points.size()));
             })
        .def_property_readonly("points", [](const ContactCopy& c) {
            py::array_t<double> points({static_cast<py::ssize_t>(c.points.size()), py::ssize_t{3}});
            for (std::size_t i = 0; i < c.points.size(); ++i)
                for (int k = 0; k < 3; ++k) points.mutable_at(i, k) = c.points[i].position[k];
            return points;
        });
}

py::array pairs_of(const PyWorld& world) {
    std::vector<std::uint32_t> indices;
    world.ask([&](const World& w) {
        for (const ObjectPair& pair : w.pairs()) {
            indices.push_back(pair.first.object.index);
            indices.push_back(pair.second.object.index);
        }
    });
    py::array_t<std::uint32_t> result = array_of<std::uint32_t>(indices);
    return result.reshape({static_cast<py::ssize_t>(indices.size() / 2), py::ssize_t{2}});
}

// For set_transforms, set_boxes, remove: objects or nodes, one or many.
template <class H, class F>
void for_handles(PyWorld& world, const py::handle& given, F&& f) {
    const Handles<H> handles(given, "handles");
    std::size_t i = 0;
    value_of(world.change([&](World& w) -> Result<void> {
        Result<void> first;
        for (const H handle : handles.span()) {
            if (auto done = f(w, handle, i); !done && first) {
                first = done;
                first.error().item = i;
            }
            ++i;
        }
        return first;
    }));
}

template <class H>
void set_transforms(PyWorld& world, const py::handle& given, const py::handle& matrices) {
    const Handles<H> handles(given, "handles");
    const auto transforms = transforms_of(matrices, "transforms");
    if (transforms.size() != handles.span().size())
        raise({ErrorCode::invalid_argument, kNoItem, "transforms: as many as handles are expected"});
    value_of(world.change([&](World& w) { return w.set_transforms(handles.span(), transforms); }));
}

void set_boxes(PyWorld& world, const py::handle& given, const py::handle& given_boxes) {
    const Handles<ObjectHandle> handles(given, "handles");
    const Boxes boxes(given_boxes, "boxes");
    if (boxes.span().size() != handles.span().size())
        raise({ErrorCode::invalid_argument, kNoItem, "boxes: as many as handles are expected"});
    value_of(world.change([&](World& w) { return w.set_bounds(handles.span(), boxes.span()); }));
}

boxtree::Orientation orientation_of(const std::string& name) {
    using boxtree::Orientation;
    return choice_of<Orientation>("tree", name,
                                  {{"aligned", Orientation::aligned},
                                   {"oriented", Orientation::oriented},
                                   {"automatic", Orientation::automatic}});
}

Ray ray_of(const py::handle& origin, const py::handle& direction, double max_t) {
    const Ray ray{vector_of(origin, "origin"), vector_of(direction, "direction"), max_t};
    value_of(validate(ray));
    return ray;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void bind_questions(py::class_<PyWorld>& type) {
    type.def("view", &PyWorld::view, py::arg("view"), py::kw_only(), py::arg("layers") = ~0u,
             py::arg("conservative") = false, py::arg("occlusion") = false,
             py::arg("size") = std::pair<std::uint32_t, std::uint32_t>(480, 270),
             "What a Camera or a Frustum sees. With occlusion, what others hide is left out; `size` is that of its "
             "depth "
             "buffer, (width, height).")
        .def(
            "raycast",
            [](const PyWorld& world, const py::handle& origin, const py::handle& direction, double max_t,
               std::uint32_t layers) {
                const Ray ray = ray_of(origin, direction, max_t);
                return world.ask([&](const World& w) { return w.raycast(ray, layers); });
            },
            py::arg("origin"), py::arg("direction"), py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
            "The nearest Hit, or None.")
        .def("raycast_many", &PyWorld::raycast_many, py::arg("origins"), py::arg("directions"),
             py::arg("max_t") = kInfinity, py::arg("layers") = ~0u,
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
            [](const PyWorld& world, const py::object& box, const py::object& ball, const py::object& capsule,
               std::uint32_t layers) {
                const Shape shape = shape_of(box, ball, capsule);
                Vector<ObjectRef> found;
                world.ask([&](const World& w) {
                    std::visit([&](const auto& one) { w.overlap(one, found, layers); }, shape);
                });
                std::vector<ObjectHandle> handles;
                for (const ObjectRef& ref : found) handles.push_back(ref.object);
                return handles_of(handles);
            },
            py::kw_only(), py::arg("box") = py::none(), py::arg("ball") = py::none(), py::arg("capsule") = py::none(),
            py::arg("layers") = ~0u, "The handles of the objects whose box or ball meets the shape.")
        .def(
            "closest",
            [](const PyWorld& world, double max_distance, const py::object& box, const py::object& ball,
               const py::object& capsule, std::uint32_t layers) {
                const Shape shape = shape_of(box, ball, capsule);
                check_limit(max_distance, "max_distance");
                return world.ask([&](const World& w) {
                    return std::visit([&](const auto& one) { return w.closest(one, max_distance, layers); }, shape);
                });
            },
            py::arg("max_distance"), py::kw_only(), py::arg("box") = py::none(), py::arg("ball") = py::none(),
            py::arg("capsule") = py::none(), py::arg("layers") = ~0u, "The nearest box or ball, or None.")
        .def_property_readonly("pairs", &pairs_of, "indices of objects whose boxes or balls meet, shape (n, 2)")
        .def_property_readonly("contacts", &contacts_of, "the Contacts of the last update")
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

void bind_changes(py::class_<PyWorld>& type) {
    type.def(
            "add_mesh",
            [](PyWorld& world, const py::handle& positions, const py::object& indices, bool triangles, bool occluders) {
                const MeshArrays arrays(positions, indices);
                MeshDescription description = arrays.description();
                description.triangles = triangles;
                description.occluders = occluders;
                return value_of(world.change([&](World& w) { return w.add_mesh(description); }));
            },
            py::arg("positions"), py::arg("indices") = py::none(), py::kw_only(), py::arg("triangles") = true,
            py::arg("occluders") = false,
            "A mesh of points (n, 3) and indices, three a triangle. With occluders it hides what is behind it.")
        .def(
            "set_vertices",
            [](PyWorld& world, MeshHandle mesh, const py::handle& positions) {
                const MeshArrays arrays(positions, py::none());
                value_of(world.change([&](World& w) { return w.set_vertices(mesh, arrays.points()); }));
            },
            py::arg("mesh"), py::arg("positions"), "Other positions, as many as before.")
        .def(
            "add_node",
            [](PyWorld& world, const py::object& parent, const py::object& transform, std::uint32_t layers) {
                NodeDescription description;
                description.parent = handle_or_null<NodeHandle>(parent, "parent");
                if (!transform.is_none()) description.transform = transform_of(transform, "transform");
                description.layers = layers;
                return value_of(world.change([&](World& w) { return w.add_node(description); }));
            },
            py::arg("parent") = py::none(), py::arg("transform") = py::none(), py::arg("layers") = ~0u)
        .def("add", &PyWorld::add, py::kw_only(), py::arg("mesh") = py::none(), py::arg("node") = py::none(),
             py::arg("transform") = py::none(), py::arg("box") = py::none(), py::arg("ball") = py::none(),
             py::arg("aligned") = py::none(), py::arg("user") = 0, py::arg("layers") = ~0u,
             py::arg("collides_with") = ~0u, py::arg("occludes") = true,
             "An object: a mesh, placed by `transform` under `node` or in the world; or a bound: a Box, a ball "
             "(center, radius) or an aligned box (low, high).")
        .def("add_boxes", &PyWorld::add_boxes, py::arg("boxes"), py::kw_only(), py::arg("users") = py::none(),
             py::arg("layers") = ~0u, py::arg("collides_with") = ~0u,
             "One object a box. Returns an array of handle_dtype. All or none.")
        .def("add_instances", &PyWorld::add_instances, py::arg("mesh"), py::arg("transforms"), py::kw_only(),
             py::arg("users") = py::none(), py::arg("layers") = ~0u, py::arg("collides_with") = ~0u,
             "One object of the mesh a matrix, shape (n, 4, 4). All or none.")
        .def(
            "remove",
            [](PyWorld& world, NodeHandle node) { value_of(world.change([&](World& w) { return w.remove(node); })); },
            py::arg("node"), "With all nodes and objects below it.")
        .def(
            "remove",
            [](PyWorld& world, MeshHandle mesh) { value_of(world.change([&](World& w) { return w.remove(mesh); })); },
            py::arg("mesh"), "An error while objects use it.")
        .def(
            "remove",
            [](PyWorld& world, const py::object& objects) {
                for_handles<ObjectHandle>(world, objects,
                                          [](World& w, ObjectHandle handle, std::size_t) { return w.remove(handle); });
            },
            py::arg("objects"), "One object or many: all but those refused; the error names the first.")
        .def(
            "set_transform",
            [](PyWorld& world, ObjectHandle object, const py::handle& matrix) {
                const auto transform = transform_of(matrix, "transform");
                value_of(world.change([&](World& w) { return w.set_transform(object, transform); }));
            },
            py::arg("handle"), py::arg("transform"))
        .def(
            "set_transform",
            [](PyWorld& world, NodeHandle node, const py::handle& matrix) {
                const auto transform = transform_of(matrix, "transform");
                value_of(world.change([&](World& w) { return w.set_transform(node, transform); }));
            },
            py::arg("handle"), py::arg("transform"))
        .def("set_transforms", &set_transforms<ObjectHandle>, py::arg("objects"), py::arg("transforms"),
             "Of objects with a mesh. All but those refused change; the error names the first.")
        .def("set_node_transforms", &set_transforms<NodeHandle>, py::arg("nodes"), py::arg("transforms"),
             "As set_transforms.")
        .def("set_boxes", &set_boxes, py::arg("objects"), py::arg("boxes"),
             "Of objects that were added with a bound, which becomes a box. Refused ones as in set_transforms.")
        .def(
            "set_hidden",
            [](PyWorld& world, const py::object& objects, bool hidden) {
                for_handles<ObjectHandle>(world, objects, [hidden](World& w, ObjectHandle handle, std::size_t) {
                    return w.set_hidden(handle, hidden);
                });
            },
            py::arg("objects"), py::arg("hidden"), "Hidden ones are in no answer. Refused ones as in set_transforms.")
        .def(
            "set_layers",
            [](PyWorld& world, const py::object& objects, std::uint32_t layers) {
                for_handles<ObjectHandle>(world, objects, [layers](World& w, ObjectHandle handle, std::size_t) {
                    return w.set_layers(handle, layers);
                });
            },
            py::arg("objects"), py::arg("layers"), "Refused ones as in set_transforms.")
        .def(
            "update",
            [](PyWorld& world) {
                const auto threads = executor();
                value_of(world.change([&](World& w) { return w.update(*threads); }));
            },
            "Makes all changes since the last call count. Once a frame. Error: more than `max_pairs` pairs; then there "
            "are "
            "none, and all else is as it should be.")
        .def_property_readonly("statistics", [](const PyWorld& world) {
            const WorldStatistics s = world.ask([](const World& w) { return w.statistics(); });
            py::dict d;
            d["objects"] = s.objects;
            d["resting"] = s.resting;
            d["moving"] = s.moving;
            d["boxes_changed"] = s.boxes_changed;
            d["out_of_range"] = s.out_of_range;
            return d;
        });
}

}  // namespace

void bind_world(py::module_& module) {
    PYBIND11_NUMPY_DTYPE(HitRecord, index, generation, t, point, triangle, hit, user);
    bind_handle<ObjectTag>(module, "ObjectHandle");
    bind_handle<NodeTag>(module, "NodeHandle");
    bind_handle<MeshTag>(module, "MeshHandle");
    bind_answers(module);
    bind_contact(module);
    py::class_<PyWorld> type(
        module, "World",
        "Objects in; what a view sees, what a ray meets and what touches out. Changes count from the "
        "next update(). May be used from several threads.");
    type.def(py::init([](bool pairs, bool contacts, bool containment, std::size_t max_pairs,
                         std::uint32_t updates_to_rest, const std::string& tree) {
                 return std::make_unique<PyWorld>(WorldOptions{.pairs = pairs,
                                                               .contacts = contacts,
                                                               .containment = containment,
                                                               .max_pairs = max_pairs,
                                                               .updates_to_rest = updates_to_rest,
                                                               .tree = orientation_of(tree)});
             }),
             py::kw_only(), py::arg("pairs") = true, py::arg("contacts") = true, py::arg("containment") = true,
             py::arg("max_pairs") = WorldOptions{}.max_pairs, py::arg("updates_to_rest") = 16,
             py::arg("tree") = "aligned");
    bind_changes(type);
    bind_questions(type);
}

}  // namespace crofton::python
