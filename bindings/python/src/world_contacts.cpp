// SPDX-License-Identifier: MIT
// Pairs and contacts of a World.
#include <pybind11/stl.h>

#include "world.hpp"

namespace crofton::python {
namespace {

// A point of two shapes.
struct ShapePointRecord {
    double position[3], depth, normal[3];
    bool began;
    std::uint8_t kind_a, kind_b;  // 0 a vertex, 1 an edge, 2 a face
    std::uint16_t feature_a, feature_b;
    std::uint32_t child_a, triangle_a, child_b, triangle_b;
};

ShapePointRecord record_of(const convex::TrackedPoint& point) {
    const auto& [position, depth, on_a, on_b, part_a, part_b] = point.contact;
    return {{position.x, position.y, position.z},
            depth,
            {point.normal.x, point.normal.y, point.normal.z},
            point.began,
            static_cast<std::uint8_t>(on_a.kind),
            static_cast<std::uint8_t>(on_b.kind),
            on_a.index,
            on_b.index,
            part_a.child,
            part_a.triangle,
            part_b.child,
            part_b.triangle};
}

// A copy of a Contact, whose spans end with the next update.
struct ContactCopy {
    ObjectRef first, second;
    ContactPhase phase;
    mesh::Containment inside;
    glm::dvec3 normal;
    double depth;
    std::vector<collide::ContactPoint> points;
    std::vector<mesh::MeshContact> triangles;
    std::vector<ShapePointRecord> shape_points;
};

ContactCopy copy_of(const Contact& c) {
    ContactCopy result{c.first,
                       c.second,
                       c.phase,
                       c.inside,
                       c.normal,
                       c.depth,
                       {c.points.begin(), c.points.end()},
                       {c.triangles.begin(), c.triangles.end()},
                       {}};
    for (const convex::TrackedPoint& point : c.shape_points) {
        result.points.push_back({point.contact.position, point.contact.depth});
        result.shape_points.push_back(record_of(point));
    }
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
    PYBIND11_NUMPY_DTYPE(ShapePointRecord, position, depth, normal, began, kind_a, kind_b, feature_a, feature_b,
                         child_a, triangle_a, child_b, triangle_b);
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
        .def_property_readonly(
            "shape_points", [](const ContactCopy& c) { return array_of<ShapePointRecord>(c.shape_points); },
            "of two shapes: records of position, depth, normal; began, False while the same features touch as in the "
            "last update; the features, by kind (0 a vertex, 1 an edge, 2 a face) and number; and the parts: a "
            "compound's child, a surface's triangle")
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
