// SPDX-License-Identifier: MIT
// Pairs and contacts of a World.
#include <pybind11/stl.h>

#include "world.hpp"

namespace crofton::python {
namespace {

// A copy of a Contact, whose spans end with the next update.
struct ContactCopy {
    ObjectRef first, second;
    ContactPhase phase;
    mesh::Containment inside;
    glm::dvec3 normal;
    double depth;
    std::vector<collide::ContactPoint> points;
    std::vector<mesh::MeshContact> triangles;
};

ContactCopy copy_of(const Contact& c) {
    ContactCopy result{c.first,
                       c.second,
                       c.phase,
                       c.inside,
                       c.normal,
                       c.depth,
                       {c.points.begin(), c.points.end()},
                       {c.triangles.begin(), c.triangles.end()}};
    for (const convex::TrackedPoint& point : c.shape_points)
        result.points.push_back({point.contact.position, point.contact.depth});
    return result;
}

std::vector<ContactCopy> contacts_of(const PyWorld& world) {
    return world.ask([](const World& w) {
        std::vector<ContactCopy> result;
        for (const Contact& c : w.contacts()) result.push_back(copy_of(c));
        return result;
    });
}

const char* phase_name(ContactPhase phase) {
    return phase == ContactPhase::began ? "began" : phase == ContactPhase::stayed ? "stayed" : "ended";
}

const char* inside_name(mesh::Containment inside) {
    switch (inside) {
        case mesh::Containment::a_inside_b:
            return "first";
        case mesh::Containment::b_inside_a:
            return "second";
        case mesh::Containment::partly:
            return "partly";
        default:
            return "nothing";
    }
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

}  // namespace

void bind_world_contacts(py::module_& module, py::class_<PyWorld>& type) {
    py::class_<ContactCopy>(module, "Contact", "Two objects that touch, or stopped touching in this update.")
        .def_property_readonly("first", [](const ContactCopy& c) { return c.first; })
        .def_property_readonly("second", [](const ContactCopy& c) { return c.second; })
        .def_property_readonly(
            "phase", [](const ContactCopy& c) { return phase_name(c.phase); }, "'began', 'stayed' or 'ended'")
        .def_property_readonly(
            "normal", [](const ContactCopy& c) { return tuple_of(c.normal); }, "unit, from the first to the second")
        .def_readonly("depth", &ContactCopy::depth)
        .def_property_readonly(
            "inside", [](const ContactCopy& c) { return inside_name(c.inside); },
            "the object that is inside the other: 'nothing', 'first', 'second', or 'partly' for some pieces of one")
        .def_property_readonly(
            "triangles", [](const ContactCopy& c) { return mesh_contacts_of(c.triangles); },
            "of two meshes, or a mesh and a box: the pairs of triangles that overlap, as Mesh.contacts, in the world")
        .def_property_readonly(
            "depths",
            [](const ContactCopy& c) {
                std::vector<double> depths;
                for (const auto& point : c.points) depths.push_back(point.depth);
                return array_of<double>(depths);
            },
            "depth at each of `points`; negative for a gap")
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
    type.def_property_readonly("pairs", &pairs_of, "indices of objects whose boxes or spheres overlap, shape (n, 2)")
        .def_property_readonly("contacts", &contacts_of, "the contacts of the last update");
}

}  // namespace crofton::python
