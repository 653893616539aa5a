// SPDX-License-Identifier: MIT
// What a view asks: requests and their parts.
#include <pybind11/stl.h>

#include <algorithm>
#include <utility>

#include "module.hpp"
#include "views.hpp"

namespace crofton::python {
namespace {

// Bit i % 64 of word i / 64 from a one-dimensional array of bools.
std::vector<std::uint64_t> bits_of(const py::handle& given, const char* name) {
    const py::array array = py::array::ensure(given);
    if (!array) PyErr_Clear();
    if (!array || array.dtype().kind() != 'b' || array.ndim() != 1)
        raise_type(std::string(name) + ": an array of bools, one an object index, is expected");
    const py::array_t<bool, py::array::c_style | py::array::forcecast> values(array);
    const auto count = static_cast<std::size_t>(values.size());
    std::vector<std::uint64_t> bits((count + 63) / 64, 0);
    for (std::size_t i = 0; i < count; ++i) bits[i / 64] |= std::uint64_t{values.data()[i]} << (i % 64);
    // Indices beyond the end may be seen.
    if (count % 64 != 0) bits.back() |= ~std::uint64_t{0} << (count % 64);
    return bits;
}

std::vector<float> floats_of(const py::handle& given, const char* name) {
    const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!values) PyErr_Clear();
    if (!values || values.ndim() != 1) raise_type(std::string(name) + ": an array of numbers is expected");
    return {values.data(), values.data() + values.size()};
}

std::pair<std::uint32_t, std::uint32_t> size_of(const py::handle& given, const char* name) {
    if (!py::isinstance<py::sequence>(given) || py::isinstance<py::str>(given) || py::len(given) != 2)
        raise_type(std::string(name) + ": (width, height) is expected");
    const auto parts = py::reinterpret_borrow<py::sequence>(given);
    return {number_of<std::uint32_t>(py::object(parts[0]), name), number_of<std::uint32_t>(py::object(parts[1]), name)};
}

bool flag_of(const py::handle& given, const char* name) {
    if (!PyBool_Check(given.ptr())) raise_type(std::string(name) + ": True or False is expected");
    return given.ptr() == Py_True;
}

OcclusionOptions make_occlusion(const py::handle& size, std::uint32_t max_occluders, float least_cover,
                                bool list_occluded) {
    const auto [width, height] = size_of(size, "size");
    return {{width, height}, max_occluders, least_cover, list_occluded};
}

ViewMatrix make_matrix(const py::handle& to_clip, const std::string& depth, const py::handle& origin) {
    return {projection_of(to_clip, "to_clip"), depth_range(depth), vector_of(origin, "origin")};
}

std::shared_ptr<HeldLimits> make_limits(const py::handle& eye, double max_distance_in_radii, double least_radius,
                                        const py::handle& layer_distances, const py::handle& item_distances,
                                        const py::handle& drawn_before, double hysteresis) {
    auto held = std::make_shared<HeldLimits>();
    cull::DrawLimits& limits = held->limits;
    limits.eye = vector_of(eye, "eye");
    limits.max_distance_in_radii = max_distance_in_radii;
    limits.least_radius = least_radius;
    if (!(hysteresis >= 1.0)) raise({ErrorCode::invalid_argument, kNoItem, "hysteresis: 1 or more is expected"});
    limits.hysteresis = hysteresis;
    if (!layer_distances.is_none()) {
        held->layer_distances = floats_of(layer_distances, "layer_distances");
        if (held->layer_distances.size() != 32)
            raise({ErrorCode::invalid_argument, kNoItem, "layer_distances: 32 numbers are expected"});
        limits.layer_distances = held->layer_distances;
    }
    if (!item_distances.is_none()) {
        held->item_distances = floats_of(item_distances, "item_distances");
        limits.item_distances = held->item_distances;
    }
    if (!drawn_before.is_none()) {
        held->drawn_before = bits_of(drawn_before, "drawn_before");
        // Indices beyond the end were not drawn.
        const auto count = static_cast<std::size_t>(py::len(drawn_before));
        if (count % 64 != 0) held->drawn_before.back() &= ~(~std::uint64_t{0} << (count % 64));
        limits.drawn_before = held->drawn_before;
    }
    return held;
}

std::shared_ptr<HeldLimits> limits_of_camera(const Camera& camera, double picture_height, double pixels) {
    auto held = std::make_shared<HeldLimits>();
    held->limits = value_of(cull::limits_of(camera, picture_height, pixels));
    return held;
}

cull::ResultOrder order_of(const py::handle& given) {
    if (!py::isinstance<py::str>(given)) raise_type("order: 'ascending' or 'tree' is expected");
    return choice_of<cull::ResultOrder>(
        "order", given.cast<std::string>(),
        {{"ascending", cull::ResultOrder::ascending}, {"tree", cull::ResultOrder::tree}});
}

std::optional<OcclusionOptions> occlusion_of(const py::handle& given) {
    if (py::isinstance<OcclusionOptions>(given)) return given.cast<OcclusionOptions>();
    if (!PyBool_Check(given.ptr()))
        raise_type("occlusion: OcclusionOptions, or True for the default ones, is expected");
    if (given.ptr() == Py_True) return OcclusionOptions{};
    return {};
}

const char* depth_name(DepthRange depth) {
    switch (depth) {
        case DepthRange::zero_to_one:
            return "zero_to_one";
        case DepthRange::minus_one_to_one:
            return "minus_one_to_one";
        default:
            return "reversed_zero_to_one";
    }
}

// The names of what a request asks.
std::string show(const HeldRequest& held) {
    const ViewRequest& r = held.request;
    const std::pair<const char*, bool> all[] = {{"camera", r.camera.has_value()},
                                                {"matrix", r.matrix.has_value()},
                                                {"volume", r.volume.has_value()},
                                                {"layers", r.layers != ~0u},
                                                {"occlusion", r.occlusion.has_value()},
                                                {"picture", r.picture.has_value()},
                                                {"receivers", r.receivers.has_value()},
                                                {"limits", r.limits != nullptr},
                                                {"candidates", !r.candidate_mask.empty()},
                                                {"order='tree'", r.order == cull::ResultOrder::tree},
                                                {"conservative", r.mode == cull::CullMode::conservative}};
    std::string text;
    for (const auto& [name, is_given] : all)
        if (is_given) text += (text.empty() ? "" : ", ") + std::string(name);
    return "ViewRequest(" + text + ")";
}

}  // namespace

const char* RequestArguments::first_given() const {
    const std::pair<const char*, py::handle> all[] = {{"matrix", matrix},   {"volume", volume},
                                                      {"layers", layers},   {"occlusion", occlusion},
                                                      {"picture", picture}, {"receivers", receivers},
                                                      {"limits", limits},   {"candidates", candidates},
                                                      {"order", order},     {"conservative", conservative}};
    for (const auto& [name, value] : all)
        if (!value.is_none()) return name;
    return nullptr;
}

void read_request(const RequestArguments& given, HeldRequest& result) {
    ViewRequest& request = result.request;
    if (const Camera* camera = as<Camera>(given.camera))
        request.camera = *camera;
    else if (const Frustum* volume = as<Frustum>(given.camera))
        request.volume = *volume;
    else if (!given.camera.is_none())
        raise_type("camera: a Camera, a Frustum, a ViewRequest or a list of these is expected");
    if (!given.matrix.is_none())
        request.matrix = py::isinstance<ViewMatrix>(given.matrix)
                             ? given.matrix.cast<const ViewMatrix&>()
                             : ViewMatrix{.to_clip = projection_of(given.matrix, "matrix")};
    if (!given.volume.is_none()) {
        if (!py::isinstance<Frustum>(given.volume)) raise_type("volume: a Frustum is expected");
        if (request.volume) raise_type("volume: a Frustum is given twice");
        request.volume = given.volume.cast<const Frustum&>();
    }
    if (!given.layers.is_none()) request.layers = number_of<std::uint32_t>(given.layers, "layers");
    if (!given.occlusion.is_none()) request.occlusion = occlusion_of(given.occlusion);
    if (!given.picture.is_none()) {
        if (!py::isinstance<depth::PictureView>(given.picture)) raise_type("picture: a PictureView is expected");
        request.picture = given.picture.cast<const depth::PictureView&>();
    }
    if (!given.receivers.is_none()) {
        if (!py::isinstance<HeldReceivers>(given.receivers)) raise_type("receivers: ShadowReceivers are expected");
        const auto& held = given.receivers.cast<const HeldReceivers&>();
        result.seen = held.seen;
        request.receivers = ShadowReceivers{&held.seen.cast<const SeenByOne&>().found(), held.radius};
    }
    if (!given.limits.is_none()) {
        if (!py::isinstance<HeldLimits>(given.limits)) raise_type("limits: DrawLimits are expected");
        result.limits = given.limits.cast<std::shared_ptr<HeldLimits>>();
        request.limits = &result.limits->limits;
    }
    if (!given.candidates.is_none()) {
        result.candidates = bits_of(given.candidates, "candidates");
        request.candidate_mask = result.candidates;
    }
    if (!given.order.is_none()) request.order = order_of(given.order);
    if (!given.conservative.is_none() && flag_of(given.conservative, "conservative"))
        request.mode = cull::CullMode::conservative;
}

void bind_view_requests(py::module_& module) {
    py::class_<OcclusionOptions>(module, "OcclusionOptions", "Options of occlusion culling in a view.")
        .def(py::init(&make_occlusion), py::kw_only(), py::arg("size") = py::make_tuple(480, 270),
             py::arg("max_occluders") = OcclusionOptions{}.max_occluders,
             py::arg("least_cover") = OcclusionOptions{}.least_cover, py::arg("list_occluded") = false,
             "`size` is that of the depth buffer, (width, height): more pixels find more hidden objects and cost more. "
             "At most `max_occluders` are drawn, and none that covers less than `least_cover` of the sphere of "
             "directions. `list_occluded` also lists the hidden objects, which costs a second query.")
        .def("__repr__", [](const OcclusionOptions& o) {
            return format("OcclusionOptions(size=(%u, %u), max_occluders=%u, least_cover=%g)",
                          static_cast<unsigned>(o.size.width), static_cast<unsigned>(o.size.height), o.max_occluders,
                          double{o.least_cover});
        });

    py::class_<ViewMatrix>(module, "ViewMatrix", "An engine's own matrix to clip space, with its depth convention.")
        .def(
            py::init(&make_matrix), py::arg("to_clip"), py::kw_only(), py::arg("depth") = "reversed_zero_to_one",
            py::arg("origin") = py::make_tuple(0.0, 0.0, 0.0),
            "`to_clip`, (4, 4) as NumPy prints it, transforms columns (x, y, z, 1) relative to `origin` to clip space.")
        .def("__repr__", [](const ViewMatrix& m) {
            return format("ViewMatrix(depth='%s', origin=(%g, %g, %g))", depth_name(m.depth), m.origin.x, m.origin.y,
                          m.origin.z);
        });

    py::class_<depth::PictureView>(module, "PictureView", "The picture that is drawn.")
        .def(py::init([](std::uint32_t width, std::uint32_t height, const std::string& depth, std::uint32_t samples,
                         std::uint64_t work_limit) {
                 return depth::PictureView{width, height, depth_range(depth), samples, work_limit};
             }),
             py::arg("width") = depth::PictureView{}.width, py::arg("height") = depth::PictureView{}.height,
             py::kw_only(), py::arg("depth") = "reversed_zero_to_one", py::arg("samples") = 1,
             py::arg("work_limit") = 0,
             "`depth` is the depth convention of the renderer's projection; with a ViewMatrix it must be the same as "
             "there. `samples` is the number in each pixel: 1, at its centre, or 2, 4 or 8 for multisampling, at "
             "Vulkan's standard locations. `work_limit`, unless 0, limits the number of clusters tested and of "
             "triangles drawn, together; what is left is then listed whole unless its box is hidden.")
        .def("__repr__", [](const depth::PictureView& p) {
            return format("PictureView(%u, %u, depth='%s')", p.width, p.height, depth_name(p.depth));
        });

    py::class_<HeldReceivers>(module, "ShadowReceivers", "What a camera sees, for the view of a light.")
        .def(py::init([](const py::object& seen, double radius) {
                 if (!py::isinstance<SeenByOne>(seen)) raise_type("seen: a ViewResult is expected");
                 return HeldReceivers{seen, static_cast<float>(radius)};
             }),
             py::arg("seen"), py::kw_only(), py::arg("radius") = double{ShadowReceivers{}.radius},
             "`seen` is the result of the camera's view, which had a picture; it holds until an update changes "
             "something, or an object or a mesh is removed. A lookup of the shadow map reads texels whose centres are "
             "at most `radius` from its point along each axis: 0.5 for the nearest texel, 1 for a bilinear comparison, "
             "r + 1 for one in each of (2 r + 1)^2 texels.")
        .def("__repr__", [](const HeldReceivers& r) { return format("ShadowReceivers(radius=%g)", double{r.radius}); });

    py::class_<HeldLimits, std::shared_ptr<HeldLimits>>(module, "DrawLimits",
                                                        "Limits of what is drawn, by size and distance.")
        .def(py::init(&make_limits), py::arg("eye"), py::kw_only(),
             py::arg("max_distance_in_radii") = cull::DrawLimits::kNone, py::arg("least_radius") = 0.0,
             py::arg("layer_distances") = py::none(), py::arg("item_distances") = py::none(),
             py::arg("drawn_before") = py::none(), py::arg("hysteresis") = 1.0,
             "Leaves out objects farther from `eye` than `max_distance_in_radii` times their radius, smaller than "
             "`least_radius`, or farther than the distance of their layer (32 numbers) or their own (by object index). "
             "For objects in `drawn_before` (bools by index), distances are multiplied by `hysteresis`. Arrays are "
             "copied.")
        .def_static("of_camera", &limits_of_camera, py::arg("camera"), py::arg("picture_height"), py::arg("pixels"),
                    "Makes limits that leave out objects which are less than this many pixels wide in the middle of "
                    "the picture.")
        .def("__repr__", [](const HeldLimits& held) {
            const cull::DrawLimits& l = held.limits;
            return format("DrawLimits(eye=(%g, %g, %g), max_distance_in_radii=%g, least_radius=%g)", l.eye.x, l.eye.y,
                          l.eye.z, l.max_distance_in_radii, l.least_radius);
        });

    py::class_<HeldRequest, std::shared_ptr<HeldRequest>>(
        module, "ViewRequest", "The arguments of World.view, prepared once for many calls. Arrays are copied.")
        .def(py::init([](const py::object& camera, const py::object& matrix, const py::object& volume,
                         const py::object& layers, const py::object& occlusion, const py::object& picture,
                         const py::object& receivers, const py::object& limits, const py::object& candidates,
                         const py::object& order, const py::object& conservative) {
                 auto held = std::make_shared<HeldRequest>();
                 read_request({camera, matrix, volume, layers, occlusion, picture, receivers, limits, candidates, order,
                               conservative},
                              *held);
                 return held;
             }),
             py::arg("camera") = py::none(), py::kw_only(), py::arg("matrix") = py::none(),
             py::arg("volume") = py::none(), py::arg("layers") = py::none(), py::arg("occlusion") = py::none(),
             py::arg("picture") = py::none(), py::arg("receivers") = py::none(), py::arg("limits") = py::none(),
             py::arg("candidates") = py::none(), py::arg("order") = py::none(), py::arg("conservative") = py::none(),
             "The arguments of World.view.")
        .def("__repr__", &show);
}

}  // namespace crofton::python
