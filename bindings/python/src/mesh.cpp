// SPDX-License-Identifier: MIT
// Mesh: triangles with boxes around them, and what they touch.
#include "mesh.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "module.hpp"
#include "world.hpp"

namespace crofton::python {

Result<const mesh::MeshTree*> PyMesh::tree() const {
    const std::lock_guard lock(mutex_);
    if (!tree_) {
        auto built = mesh::MeshTree::build(mesh_, {.rays = true});
        if (!built) return built.error();
        if (!built->rejected().empty())
            return fail(ErrorCode::out_of_range, built->rejected()[0],
                        "mesh: a triangle has a vertex beyond 1e12; move or scale the mesh");
        tree_.emplace(std::move(*built));
    }
    return &*tree_;
}

std::shared_ptr<PyMesh> make_mesh(TriangleMesh mesh, std::string name) {
    if (mesh.indices.empty()) raise({ErrorCode::empty, kNoItem, "mesh: it has no triangles"});
    value_of(validate(mesh));
    return std::make_shared<PyMesh>(std::move(mesh), std::move(name));
}

RigidTransform pose_of(const py::object& given, const char* name) {
    if (given.is_none()) return {};
    const Transform transform = transform_of(given, name);
    const RigidTransform pose{transform.linear, transform.translation};
    if (auto valid = convex::validate_pose(pose); !valid) {
        valid.error().message = std::string(name) + ": " + valid.error().message +
                                "; a pose is a rotation and a translation, so apply scale to the vertices";
        raise(valid.error());
    }
    return pose;
}

namespace {
struct ContactRecord {
    std::uint32_t first, second;
    double begin[3], end[3], normal[3];
};
}  // namespace

py::array mesh_contacts_of(std::span<const mesh::MeshContact> contacts) {
    py::array_t<ContactRecord> result(static_cast<py::ssize_t>(contacts.size()));
    ContactRecord* out = result.mutable_data();
    for (const mesh::MeshContact& c : contacts) {
        const glm::dvec3 &begin = c.segment.begin, &end = c.segment.end;
        *out++ = {c.triangles.first,
                  c.triangles.second,
                  {begin.x, begin.y, begin.z},
                  {end.x, end.y, end.z},
                  {c.normal.x, c.normal.y, c.normal.z}};
    }
    return result;
}

namespace {

using SharedMesh = std::shared_ptr<PyMesh>;

struct MeshHitRecord {
    double t;
    double point[3];
    std::uint32_t triangle, hit;
};

SharedMesh mesh_of_arrays(const py::handle& given, const py::object& given_indices, const py::object& colors,
                          std::string name) {
    const Points<3> points(given, "positions");
    TriangleMesh result;
    points.visit([&](auto span) { result.positions.assign(span.begin(), span.end()); });
    if (given_indices.is_none()) {
        if (result.positions.size() % 3 != 0)
            raise({ErrorCode::invalid_argument, kNoItem,
                   "positions: without indices, three positions are a triangle, and " +
                       std::to_string(result.positions.size()) + " is no multiple of three"});
        for (std::uint32_t i = 0; i < result.positions.size(); ++i) result.indices.push_back(i);
    } else {
        const auto indices = integers<std::uint32_t>(given_indices, "indices");
        result.indices.assign(span_of(indices).begin(), span_of(indices).end());
    }
    if (!colors.is_none()) {
        const Points<3> rgb(colors, "colors");
        rgb.visit([&](auto span) { result.colors.assign(span.begin(), span.end()); });
    }
    return make_mesh(std::move(result), std::move(name));
}

// A view of the mesh's memory, which cannot be written.
template <class T, class Range>
py::array view_of(const py::object& owner, const Range& values) {
    const auto rows = static_cast<py::ssize_t>(values.size() * sizeof(values[0]) / (3 * sizeof(T)));
    py::array_t<T> result({rows, py::ssize_t{3}}, reinterpret_cast<const T*>(values.data()), owner);
    result.attr("flags").attr("writeable") = false;
    return result;
}

// Calls with the trees of two meshes, without the interpreter's lock.
template <class F>
auto with_trees(const PyMesh& a, const PyMesh& b, F&& f) {
    using Answer = decltype(f(std::declval<const mesh::MeshTree&>(), std::declval<const mesh::MeshTree&>()));
    return value_of(unlocked([&]() -> Result<Answer> {
        const auto tree_a = a.tree();
        if (!tree_a) return tree_a.error();
        const auto tree_b = b.tree();
        if (!tree_b) return tree_b.error();
        return f(**tree_a, **tree_b);
    }));
}
template <class F>
auto with_tree(const PyMesh& mesh, F&& f) {
    return with_trees(mesh, mesh, [&](const mesh::MeshTree& tree, const mesh::MeshTree&) { return f(tree); });
}

bool touches(const PyMesh& a, const PyMesh& b, const py::object& given_pose) {
    const RigidTransform pose = pose_of(given_pose, "pose");
    return with_trees(a, b, [&](const mesh::MeshTree& x, const mesh::MeshTree& y) {
        return mesh::intersects(x, y, pose) || mesh::containment_of_disjoint(x, y, pose) != mesh::Containment::none;
    });
}

NearestPoints distance(const PyMesh& a, const PyMesh& b, const py::object& given_pose) {
    const RigidTransform pose = pose_of(given_pose, "pose");
    const mesh::MeshDistance found =
        with_trees(a, b, [&](const mesh::MeshTree& x, const mesh::MeshTree& y) { return mesh::distance(x, y, pose); });
    return {found.distance, found.on_a, found.on_b};
}

py::array contacts(const PyMesh& a, const PyMesh& b, const py::object& given_pose) {
    const RigidTransform pose = pose_of(given_pose, "pose");
    const auto found = with_trees(a, b, [&](const mesh::MeshTree& x, const mesh::MeshTree& y) {
        Vector<mesh::MeshContact> all;
        mesh::contacts(x, y, pose, all);
        return all;
    });
    return mesh_contacts_of(found);
}

py::array contains(const PyMesh& mesh, const py::object& given) {
    py::array points = py::array::ensure(given);
    if (!points) PyErr_Clear();
    if (points && points.ndim() == 1) points = points.attr("reshape")(1, points.size());
    const Points<3> places(points ? py::object(points) : given, "points");
    py::array_t<bool> result(static_cast<py::ssize_t>(places.size()));
    bool* const out = result.mutable_data();
    with_tree(mesh, [&](const mesh::MeshTree& tree) {
        places.visit([&](auto span) {
            for (std::size_t i = 0; i < span.size(); ++i) out[i] = mesh::contains(tree, glm::dvec3(span[i]));
        });
        return true;
    });
    return result;
}

glm::dvec3 triangle_normal(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto corner = [&](std::size_t k) {
        return glm::dvec3(mesh.positions[mesh.indices[3 * std::size_t{triangle} + k]]);
    };
    const glm::dvec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const double length = glm::length(normal);
    return length > 0.0 ? normal / length : glm::dvec3(0.0);
}

std::optional<SurfaceHit> raycast(const PyMesh& mesh, const py::handle& origin, const py::handle& direction,
                                  double max_t) {
    const Ray ray{vector_of(origin, "origin"), vector_of(direction, "direction"), max_t};
    value_of(validate(ray));
    const auto hit = with_tree(mesh, [&](const mesh::MeshTree& tree) { return mesh::raycast(ray, tree); });
    if (!hit) return std::nullopt;
    glm::dvec3 normal = triangle_normal(mesh.triangles(), hit->triangle);
    if (glm::dot(normal, ray.direction) > 0.0) normal = -normal;
    return SurfaceHit{hit->t, ray.origin + hit->t * ray.direction, normal, hit->triangle, false};
}

py::array raycast_many(const PyMesh& mesh, const py::handle& origins, const py::handle& directions, double max_t) {
    const Points<3> from(origins, "origins"), along(directions, "directions");
    if (from.size() != along.size() && from.size() != 1)
        raise({ErrorCode::invalid_argument, kNoItem, "origins: as many as directions, or one, are expected"});
    const auto at = [](const Points<3>& points, std::size_t i) {
        return points.visit([&](auto span) { return glm::dvec3(span[points.size() == 1 ? 0 : i]); });
    };
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < along.size(); ++i) {
        rays.push_back({at(from, i), at(along, i), max_t});
        value_of(validate(rays.back(), i));
    }
    std::vector<std::optional<mesh::TriangleHit>> hits(rays.size());
    constexpr std::size_t kAtOnce = 4096;  // between two looks for Ctrl-C
    for (std::size_t done = 0; done < rays.size(); done += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, rays.size() - done);
        with_tree(mesh, [&](const mesh::MeshTree& tree) {
            mesh::raycast(std::span(rays).subspan(done, count), tree, std::span(hits).subspan(done, count));
            return true;
        });
        Interrupt::raise();
    }
    py::array_t<MeshHitRecord> result(static_cast<py::ssize_t>(rays.size()));
    MeshHitRecord* const out = result.mutable_data();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        out[i] = {std::numeric_limits<double>::infinity(), {}, std::numeric_limits<std::uint32_t>::max(), 0};
        if (!hits[i]) continue;
        const glm::dvec3 p = rays[i].origin + hits[i]->t * rays[i].direction;
        out[i] = {hits[i]->t, {p.x, p.y, p.z}, hits[i]->triangle, 1};
    }
    return result;
}

SharedMesh hull_of(const PyMesh& mesh) {
    const auto& positions = mesh.triangles().positions;
    const ConvexHull hull = value_of(unlocked([&] { return convex_hull(std::span<const glm::vec3>(positions)); }));
    if (hull.rank < 3)
        raise({ErrorCode::degenerate, kNoItem, "hull: all vertices lie on one plane, so it has no volume"});
    TriangleMesh result;
    std::vector<std::uint32_t> place(positions.size());
    for (const std::uint32_t vertex : hull.vertices) {
        place[vertex] = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(positions[vertex]);
    }
    for (const std::uint32_t vertex : hull.triangles) result.indices.push_back(place[vertex]);
    return make_mesh(std::move(result), mesh.name());
}

SharedMesh transformed(const PyMesh& mesh, const py::handle& matrix) {
    const Transform transform = transform_of(matrix, "transform");
    TriangleMesh result = mesh.triangles();
    for (glm::vec3& p : result.positions) p = glm::vec3(transform * glm::dvec3(p));
    if (glm::dot(transform.linear[0], glm::cross(transform.linear[1], transform.linear[2])) < 0.0)
        for (std::size_t i = 0; i < result.indices.size(); i += 3) std::swap(result.indices[i], result.indices[i + 2]);
    return make_mesh(std::move(result), mesh.name());
}

Obb fit_box(const PyMesh& mesh, const py::handle& criterion, const std::string& quality) {
    const fit::FitOptions options{criterion_of(criterion), choice_of<fit::Quality>("quality", quality,
                                                                                   {{"fast", fit::Quality::fast},
                                                                                    {"tight", fit::Quality::tight},
                                                                                    {"exact", fit::Quality::exact}})};
    return value_of(
        unlocked([&] { return fit::fit_obb(std::span<const glm::vec3>(mesh.triangles().positions), options); }));
}

py::array bounds_of(const PyMesh& mesh) {
    const auto& positions = mesh.triangles().positions;
    glm::vec3 corners[2] = {positions[0], positions[0]};
    for (const glm::vec3& p : positions) {
        corners[0] = glm::min(corners[0], p);
        corners[1] = glm::max(corners[1], p);
    }
    return py::array_t<float>({2, 3}, &corners[0].x);
}

double area_of(const PyMesh& mesh) {
    double sum = 0.0;
    const TriangleMesh& m = mesh.triangles();
    for (std::size_t i = 0; i < m.indices.size(); i += 3) {
        const glm::dvec3 a(m.positions[m.indices[i]]), b(m.positions[m.indices[i + 1]]),
            c(m.positions[m.indices[i + 2]]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

bool is_closed(const PyMesh& mesh) {
    return with_tree(mesh, [](const mesh::MeshTree& tree) {
        for (const mesh::MeshPiece& piece : tree.pieces())
            if (!piece.closed) return false;
        return true;
    });
}

std::string show(const PyMesh& mesh) {
    const std::string name = mesh.name().empty() ? "" : "'" + mesh.name() + "', ";
    return "Mesh(" + name + std::to_string(mesh.triangles().positions.size()) + " vertices, " +
           std::to_string(mesh.triangles().triangle_count()) + " triangles)";
}

}  // namespace

void bind_mesh(py::module_& module) {
    PYBIND11_NUMPY_DTYPE(ContactRecord, first, second, begin, end, normal);
    PYBIND11_NUMPY_DTYPE(MeshHitRecord, t, point, triangle, hit);
    py::class_<SurfaceHit>(module, "RayHit", "The first hit of a ray on a mesh or a shape.")
        .def_readonly("t", &SurfaceHit::t, "how far along the ray, in lengths of its direction")
        .def_property_readonly("point", [](const SurfaceHit& h) { return tuple_of(h.point); })
        .def_property_readonly(
            "normal", [](const SurfaceHit& h) { return tuple_of(h.normal); },
            "unit, of the surface, towards the ray; 0 if the ray began inside")
        .def_readonly("triangle", &SurfaceHit::triangle, "the triangle of the mesh or surface that was hit")
        .def_readonly("started_inside", &SurfaceHit::started_inside,
                      "True if the ray began in a solid shape; t is then 0")
        .def("__repr__", [](const SurfaceHit& h) {
            return format("RayHit(t=%g, point=(%g, %g, %g), triangle=%u)", h.t, h.point.x, h.point.y, h.point.z,
                          h.triangle);
        });
    py::class_<NearestPoints>(module, "Distance", "The distance between two things, and their nearest points.")
        .def_readonly("distance", &NearestPoints::distance, "0 if they touch")
        .def_property_readonly("on_a", [](const NearestPoints& d) { return tuple_of(d.on_a); })
        .def_property_readonly("on_b", [](const NearestPoints& d) { return tuple_of(d.on_b); })
        .def("__float__", [](const NearestPoints& d) { return d.distance; })
        .def("__repr__", [](const NearestPoints& d) {
            return format("Distance(%g, on_a=(%g, %g, %g), on_b=(%g, %g, %g))", d.distance, d.on_a.x, d.on_a.y,
                          d.on_a.z, d.on_b.x, d.on_b.y, d.on_b.z);
        });

    py::class_<PyMesh, SharedMesh>(
        module, "Mesh", "A triangle mesh that never changes. Fits boxes, tests overlap and distance, casts rays.")
        .def(py::init(&mesh_of_arrays), py::arg("positions"), py::arg("indices") = py::none(), py::kw_only(),
             py::arg("colors") = py::none(), py::arg("name") = "",
             "Makes a mesh of points (n, 3), stored as float32, and indices, three per triangle, counter-clockwise "
             "seen from outside. Without indices, each three points form a triangle.")
        .def_property_readonly("positions",
                               [](const py::object& self) {
                                   return view_of<float>(self, self.cast<const PyMesh&>().triangles().positions);
                               })
        .def_property_readonly(
            "indices",
            [](const py::object& self) {
                return view_of<std::uint32_t>(self, self.cast<const PyMesh&>().triangles().indices);
            },
            "shape (m, 3)")
        .def_property_readonly(
            "colors",
            [](const py::object& self) {
                const auto& colors = self.cast<const PyMesh&>().triangles().colors;
                return colors.empty() ? py::object(py::none()) : py::object(view_of<float>(self, colors));
            },
            "linear red, green and blue of each vertex, or None")
        .def_property_readonly("name", &PyMesh::name)
        .def_property_readonly("bounds", &bounds_of, "the least and the greatest corner, shape (2, 3)")
        .def_property_readonly("area", &area_of)
        .def_property_readonly(
            "is_closed", &is_closed,
            "True if every edge belongs to an even number of triangles, so that the mesh has an inside")
        .def("fit_box", &fit_box, py::arg("criterion") = "perimeter", py::arg("quality") = "tight",
             "Returns the oriented box around all vertices that is best by a criterion; Box.matrix places it.")
        .def("hull", &hull_of, "Returns the convex hull as a Mesh.")
        .def("transformed", &transformed, py::arg("transform"),
             "Returns a copy transformed by a matrix of shape (4, 4).")
        .def("touches", &touches, py::arg("other"), py::arg("pose") = py::none(),
             "Tests exactly whether two meshes share a point, or one lies inside the other, closed one. `pose` is that "
             "of `other`.")
        .def("distance", &distance, py::arg("other"), py::arg("pose") = py::none(),
             "Returns the Distance between the two surfaces; 0 if they touch. `pose` is that of `other`.")
        .def("contacts", &contacts, py::arg("other"), py::arg("pose") = py::none(),
             "Returns the pairs of triangles that intersect, as an array of records: `first`, `second`, the ends "
             "`begin` and `end` of their common segment, and the `normal` of the other's triangle.")
        .def("contains", &contains, py::arg("points"), "Tests whether each point lies inside this closed mesh.")
        .def("raycast", &raycast, py::arg("origin"), py::arg("direction"),
             py::arg("max_t") = std::numeric_limits<double>::infinity(), "Returns the first RayHit, or None.")
        .def("raycast_many", &raycast_many, py::arg("origins"), py::arg("directions"),
             py::arg("max_t") = std::numeric_limits<double>::infinity(),
             "Returns the first hit of each ray, as an array of records; `hit` is 0 for rays that hit nothing.")
        .def("__repr__", &show);
}

}  // namespace crofton::python
