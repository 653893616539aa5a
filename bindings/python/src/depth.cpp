// SPDX-License-Identifier: MIT
// Meshes cut into clusters, and the triangles of them that a picture needs.
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

using depth::ClusteredMesh;
using depth::DepthCuller;

struct ClusterRecord {
    std::uint32_t first_triangle, triangle_count;
    float center[3];
    float half_edges[3][3];
};
static_assert(sizeof(ClusterRecord) == sizeof(depth::Cluster) + sizeof(depth::ClusterBox));

// The library's message, with the names of Python's arguments in place of the module's.
Error with_arguments(Error error, std::string arguments) {
    const std::size_t colon = error.message.find(": ");
    error.message = std::move(arguments) + error.message.substr(colon == std::string::npos ? 0 : colon + 2);
    return error;
}

Error in_cut(const Error& error) {
    if (error.code == ErrorCode::non_finite) return with_arguments(error, "positions: ");
    const bool is_of_indices = error.item != kNoItem || error.code == ErrorCode::empty;
    return with_arguments(error, is_of_indices ? "indices: " : "");
}

std::shared_ptr<ClusteredMesh> cut(const py::handle& given, const py::handle& given_indices,
                                   const py::handle& max_triangles) {
    const Points<3> points(given, "positions");
    const auto corners = integers<std::uint32_t>(given_indices, "indices");
    const depth::ClusterOptions options{number_of<std::uint32_t>(max_triangles, "max_triangles")};
    // Copies: another thread could change what has been checked.
    std::vector<glm::vec3> positions;
    points.visit([&](auto span) { positions.assign(span.begin(), span.end()); });
    const std::vector<std::uint32_t> indices(span_of(corners).begin(), span_of(corners).end());
    auto mesh = unlocked([&] { return ClusteredMesh::cut(positions, indices, options); });
    if (!mesh) raise(in_cut(mesh.error()));
    return std::make_shared<ClusteredMesh>(std::move(*mesh));
}

// The culler follows what is lent without looking again, so that the arrays must be as they were.
template <class T>
std::span<const T> read_only(const py::array& given, const char* name, std::size_t width) {
    if (!py::isinstance<py::array_t<T, py::array::c_style>>(given) || given.writeable())
        throw py::value_error(std::string(name) +
                              " must be a contiguous array of the mesh's type that cannot be written: set its "
                              "flags.writeable to False");
    return {static_cast<const T*>(given.data()), static_cast<std::size_t>(given.size()) / width * width};
}

// The arrays live as long as the mesh, which Python keeps them for.
void lend(ClusteredMesh& mesh, const py::array& positions, const py::array& indices, bool permuted) {
    const auto numbers = read_only<float>(positions, "positions", 3);
    if (positions.ndim() != 2 || positions.shape(1) != 3) throw py::value_error("positions must have the shape (n, 3)");
    const auto corners = read_only<std::uint32_t>(indices, "indices", 1);
    const auto order = permuted ? depth::IndexOrder::permuted : depth::IndexOrder::original;
    auto lent = mesh.lend({reinterpret_cast<const glm::vec3*>(numbers.data()), numbers.size() / 3}, corners, order);
    if (!lent) raise(lent.error());
}

py::array clusters_of(const ClusteredMesh& mesh) {
    py::array_t<ClusterRecord> result(static_cast<py::ssize_t>(mesh.clusters().size()));
    for (std::size_t c = 0; c < mesh.clusters().size(); ++c) {
        ClusterRecord& record = result.mutable_data()[c];
        const depth::ClusterBox box = mesh.box_of(c);
        const depth::Cluster range = mesh.clusters()[c];
        std::memcpy(&record, &range, sizeof range);
        std::memcpy(record.center, &box, sizeof box);
    }
    return result;
}

// A mesh as a picture draws it. The matrix is the vertex shader's, in float.
struct DrawnMesh {
    std::shared_ptr<const ClusteredMesh> mesh;
    glm::mat4 to_clip{1.0f};
    bool one_sided = false;
    bool hides = true;
    float position_error = 0.0f;

    [[nodiscard]] depth::DepthObject object() const { return {mesh.get(), to_clip, one_sided, hides, position_error}; }
};

DrawnMesh drawn_mesh(const py::handle& mesh, const py::handle& to_clip, bool one_sided, bool hides,
                     const py::handle& position_error) {
    if (!py::isinstance<ClusteredMesh>(mesh)) raise_type("mesh: a ClusteredMesh is expected");
    return {mesh.cast<std::shared_ptr<ClusteredMesh>>(), glm::mat4(projection_of(to_clip, "to_clip")), one_sided, hides,
            number_of<float>(position_error, "position_error")};
}

py::array_t<float> rows_of(const glm::mat4& matrix) {
    py::array_t<float> result({4, 4});
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) result.mutable_at(row, column) = matrix[column][row];
    return result;
}

// Copies, which keep the meshes alive.
template <class T>
std::vector<T> copies_of(const py::handle& given, const char* expected) {
    if (!py::isinstance<py::iterable>(given)) raise_type(expected);
    std::vector<T> result;
    for (const py::handle one : py::reinterpret_borrow<py::iterable>(given)) {
        if (!py::isinstance<T>(one)) raise_type(expected);
        result.push_back(one.cast<const T&>());
    }
    return result;
}

// Where an object of a camera's picture lies in a shadow map.
struct Receiver {
    std::shared_ptr<const ClusteredMesh> mesh;
    glm::mat4 to_map{1.0f};
    bool solid = false;
};

Receiver receiver(const py::object& mesh, const py::handle& to_map, bool solid) {
    if (!mesh.is_none() && !py::isinstance<ClusteredMesh>(mesh))
        raise_type("mesh: a ClusteredMesh, or None, is expected");
    return {mesh.is_none() ? nullptr : mesh.cast<std::shared_ptr<ClusteredMesh>>(),
            glm::mat4(projection_of(to_map, "to_map")), solid};
}

// A culler, the size of its last picture, and a lock: calls run without the interpreter's.
class Culler {
  public:
    py::tuple find_visible(const py::handle& given, const py::handle& width, const py::handle& height,
                           const std::string& depth, std::uint32_t samples) {
        const auto threads = executor();
        return find(given, width, height, depth, samples, [&](const auto& objects, const auto& view) {
            const std::lock_guard lock(mutex_);
            return keep(culler_.find_visible(objects, view, *threads), view);
        });
    }

    py::tuple find_casters(const py::handle& given, const py::handle& width, const py::handle& height, Culler& seen,
                           const py::handle& given_receivers, float radius, const std::string& depth) {
        const auto held = copies_of<Receiver>(given_receivers, "receivers: a list of DepthReceiver is expected");
        std::vector<depth::DepthReceiver> receivers;
        for (const Receiver& one : held) receivers.push_back({one.mesh.get(), one.to_map, one.solid});
        if (&seen == this)
            raise({ErrorCode::invalid_argument, kNoItem, "seen: another DepthCuller, that of the camera, is expected"});
        const auto threads = executor();
        return find(given, width, height, depth, 1, [&](const auto& objects, const auto& view) {
            const std::scoped_lock lock(mutex_, seen.mutex_);
            return keep(culler_.find_casters(objects, view, {&seen.culler_, receivers, radius}, *threads), view);
        });
    }
    py::dict statistics() {
        const depth::DepthStatistics s = unlocked([&] {
            const std::lock_guard lock(mutex_);
            return culler_.statistics();
        });
        py::dict result;
        result["objects_listed"] = s.objects_listed;
        result["objects_asked"] = s.objects_asked;
        result["clusters_asked"] = s.clusters_asked;
        result["clusters_drawn"] = s.clusters_drawn;
        result["triangles_drawn"] = s.triangles_drawn;
        result["triangles_listed"] = s.triangles_listed;
        return result;
    }

    py::array nearness() {
        std::vector<float> values;
        py::ssize_t width = 0, height = 0;
        unlocked([&] {
            const std::lock_guard lock(mutex_);
            width = width_;
            height = height_;
            for (std::uint32_t y = 0; y < height_; ++y)
                for (std::uint32_t x = 0; x < width_; ++x) values.push_back(culler_.nearness(x, y));
        });
        return array_of<float>(values).reshape({height, width});
    }

  private:
    // Holds a copy of what a call listed. The call makes it while it holds the lock.
    struct Listed {
        std::vector<std::uint32_t> object, cluster;
        std::vector<std::uint64_t> triangles;
    };

    Result<Listed> keep(const Result<std::span<const depth::VisibleCluster>>& found, const depth::PictureView& view) {
        if (!found) return fail(found.error().code, found.error().item, found.error().message);
        width_ = view.width;
        height_ = view.height;
        Listed result;
        for (const depth::VisibleCluster& c : *found) {
            result.object.push_back(c.object);
            result.cluster.push_back(c.cluster);
            result.triangles.push_back(c.triangles);
        }
        return result;
    }

    template <class F>
    static py::tuple find(const py::handle& given, const py::handle& width, const py::handle& height,
                          const std::string& depth, std::uint32_t samples, F&& f) {
        const auto meshes = copies_of<DrawnMesh>(given, "objects: a list of DepthObject is expected");
        depth::PictureView view{number_of<std::uint32_t>(width, "width"), number_of<std::uint32_t>(height, "height"),
                                depth_range(depth)};
        view.samples = samples;
        std::vector<depth::DepthObject> objects;
        for (const DrawnMesh& mesh : meshes) objects.push_back(mesh.object());
        const Listed listed = value_of(unlocked([&] { return f(objects, view); }));
        return py::make_tuple(array_of<std::uint32_t>(listed.object), array_of<std::uint32_t>(listed.cluster),
                              array_of<std::uint64_t>(listed.triangles));
    }

    DepthCuller culler_;
    std::uint32_t width_ = 0, height_ = 0;
    std::mutex mutex_;
};

}  // namespace

void bind_depth(py::module_& module) {
    PYBIND11_NUMPY_DTYPE(ClusterRecord, first_triangle, triangle_count, center, half_edges);
    py::class_<ClusteredMesh, std::shared_ptr<ClusteredMesh>>(
        module, "ClusteredMesh", "A mesh cut into clusters, groups of neighbouring triangles, for DepthCuller.")
        .def(py::init(&cut), py::arg("positions"), py::arg("indices"), py::arg("max_triangles") = 0,
             "Cuts a mesh given by points (n, 3), stored as float32, and indices, three per triangle. A cluster has up "
             "to `max_triangles` triangles, at most 64; 0 chooses by the mesh's size.")
        .def("lend", &lend, py::arg("positions"), py::arg("indices"), py::kw_only(), py::arg("permuted") = true,
             py::keep_alive<1, 2>(), py::keep_alive<1, 3>(),
             "Reads positions (n, 3), float32, from these arrays from now on, in place of copies. `indices`, uint32, "
             "are "
             "the mesh's in `triangle_order`, which is empty then; with permuted=False they are the mesh's own. Both "
             "must be read-only. If their memory is changed all the same, which is not noticed, views are wrong or the "
             "process ends. Do not call it while a picture of the mesh is being made.")
        .def_property_readonly(
            "triangle_order", [](const ClusteredMesh& mesh) { return array_of<std::uint32_t>(mesh.triangle_order()); },
            "the mesh's triangles in the order of the clusters: indices.reshape(-1, 3)[triangle_order] is an index "
            "buffer in which each cluster is one range")
        .def_property_readonly(
            "clusters", &clusters_of,
            "an array of records: `first_triangle` and `triangle_count` in that order, and a box around "
            "them, `center` ± each of the three `half_edges`")
        .def(
            "to_bytes",
            [](const ClusteredMesh& mesh) {
                const auto bytes = mesh.serialise();
                return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            },
            "Returns bytes to store: from_bytes makes an equal object without cutting again.")
        .def_static(
            "from_bytes",
            [](const py::bytes& given) {
                const std::string_view text(given);
                return std::make_shared<ClusteredMesh>(
                    value_of(ClusteredMesh::deserialise(std::as_bytes(std::span(text)))));
            },
            py::arg("bytes"), "Error: the bytes are cut off, or numbers are out of range.")
        .def("__len__", [](const ClusteredMesh& mesh) { return mesh.clusters().size(); })
        .def("__repr__", [](const ClusteredMesh& mesh) {
            return format("ClusteredMesh(%zu clusters, %zu triangles)", mesh.clusters().size(), mesh.triangle_count());
        });

    py::class_<DrawnMesh>(module, "DepthObject", "A mesh in a picture, for DepthCuller.")
        .def(py::init(&drawn_mesh), py::arg("mesh"), py::arg("to_clip"), py::kw_only(), py::arg("one_sided") = false,
             py::arg("hides") = true, py::arg("position_error") = 0.0,
             "`to_clip` transforms columns (x, y, z, 1) from the mesh's frame to clip space, in float32 as a vertex "
             "shader does. `position_error` bounds how far drawn vertices may be from the mesh's, apart from the "
             "rounding of that product.")
        .def_property_readonly("mesh",
                               [](const DrawnMesh& m) { return std::const_pointer_cast<ClusteredMesh>(m.mesh); })
        .def_property(
            "to_clip", [](const DrawnMesh& m) { return rows_of(m.to_clip); },
            [](DrawnMesh& m, const py::handle& given) { m.to_clip = glm::mat4(projection_of(given, "to_clip")); },
            "shape (4, 4), as NumPy prints it")
        .def_readwrite("one_sided", &DrawnMesh::one_sided,
                       "True if back faces are not drawn; front faces are counter-clockwise seen with y up")
        .def_readwrite("hides", &DrawnMesh::hides, "False for alpha-tested and transparent meshes, which hide nothing")
        .def_readwrite("position_error", &DrawnMesh::position_error)
        .def("__repr__", [](const DrawnMesh& m) {
            return format("DepthObject(%zu triangles%s%s)", m.mesh->triangle_count(), m.one_sided ? ", one_sided" : "",
                          m.hides ? "" : ", hides nothing");
        });

    py::class_<Receiver>(module, "DepthReceiver", "Where an object of a camera's picture lies in a shadow map.")
        .def(
            py::init(&receiver), py::arg("mesh"), py::arg("to_map"), py::kw_only(), py::arg("solid") = false,
            "`mesh` is that of the picture; None does where nothing of it was listed. `to_map` transforms columns "
            "(x, y, z, 1) from the mesh's frame to the map's clip space. `solid`: anything within the mesh's bound may "
            "be seen, and not its triangles only.")
        .def("__repr__", [](const Receiver& r) {
            return format("DepthReceiver(%zu triangles%s)", r.mesh ? r.mesh->triangle_count() : 0,
                          r.solid ? ", solid" : "");
        });

    py::class_<Culler>(module, "DepthCuller",
                       "Finds the triangles that a picture needs: walks front to back and tests clusters against the "
                       "depth of the triangles found before. Keeps its memory between calls.")
        .def(py::init<>())
        .def("__repr__",
             [](Culler& culler) {
                 return "DepthCuller(triangles_listed=" +
                        std::string(py::str(culler.statistics()["triangles_listed"])) + ")";
             })
        .def("find_visible", &Culler::find_visible, py::arg("objects"), py::arg("width"), py::arg("height"),
             py::kw_only(), py::arg("depth") = "reversed_zero_to_one", py::arg("samples") = 1,
             "Returns (object, cluster, triangles): arrays with one item per listed cluster, by object, then by "
             "cluster. Bit k of `triangles` stands for triangle first_triangle + k of the cluster. The picture has "
             "32-bit "
             "float depth, and 1, 2, 4 or 8 samples in each pixel.")
        .def("find_casters", &Culler::find_casters, py::arg("objects"), py::arg("width"), py::arg("height"),
             py::arg("seen"), py::arg("receivers"), py::kw_only(), py::arg("radius") = 1.0f,
             py::arg("depth") = "reversed_zero_to_one",
             "Lists the triangles of `objects` to draw into a light's shadow map: those without which a shadow on what "
             "a camera sees would change. `to_clip` of each leads to the map's clip space. `seen` is the DepthCuller "
             "whose last find_visible was of the camera's picture, `receivers` has one DepthReceiver for each object "
             "of that call, and a lookup reads texels up to `radius` from its point along each axis.")
        .def_property_readonly("statistics", &Culler::statistics,
                               "what the last call tested, drew and listed, as a dict")
        .def_property_readonly("nearness", &Culler::nearness,
                               "a depth that the triangles of the last call certainly cover, (height, width), the "
                               "bottom row first; negated unless reversed, and −inf where no triangle covers");
}

}  // namespace crofton::python
