// SPDX-License-Identifier: MIT
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>

#include "convert.hpp"
#include "module.hpp"
#include "view.hpp"

namespace crofton::python {

cull::View view_of(const py::handle& given, std::uint32_t layers) {
    if (py::isinstance<Camera>(given)) return {value_of(frustum_of(given.cast<const Camera&>())), layers};
    if (py::isinstance<Frustum>(given)) return {given.cast<const Frustum&>(), layers};
    raise_type("view: a Camera or a Frustum is expected");
}

namespace {

cull::CullMode mode_of(bool conservative) {
    return conservative ? cull::CullMode::conservative : cull::CullMode::exact;
}

py::array classify(const py::handle& view, const py::handle& given, bool conservative) {
    const Boxes boxes(given, "boxes");
    const cull::View seen = view_of(view, ~0u);
    py::array_t<std::uint8_t> verdicts(static_cast<py::ssize_t>(boxes.span().size()));
    static_assert(sizeof(cull::Verdict) == 1);
    const std::span<cull::Verdict> out(reinterpret_cast<cull::Verdict*>(verdicts.mutable_data()), boxes.span().size());
    unlocked([&] { cull::classify(seen.frustum, boxes.span(), out, mode_of(conservative)); });
    return verdicts;
}

py::array find_visible(const py::handle& view, const py::handle& given, const py::object& layers,
                       std::uint32_t layer_mask, bool conservative) {
    const Boxes boxes(given, "boxes");
    std::span<const std::uint32_t> masks;
    py::array_t<std::uint32_t, py::array::c_style> held;
    if (!layers.is_none()) {
        held = integers<std::uint32_t>(layers, "layers");
        masks = span_of(held);
        if (masks.size() != boxes.span().size())
            raise({ErrorCode::invalid_argument, kNoItem, "layers: as many as boxes are expected"});
    }
    const cull::View seen = view_of(view, layer_mask);
    cull::VisibleSet visible;
    const auto threads = executor();
    unlocked(
        [&] { cull::find_visible(boxes.span(), masks, seen, visible, {.mode = mode_of(conservative)}, *threads); });
    return array_of<std::uint32_t>(visible.ids());
}

// Boxes laid out once for many queries. They are copied: nobody can change what has been laid out.
class BoxList {
  public:
    explicit BoxList(const py::handle& given) {
        const Boxes boxes(given, "boxes");
        boxes_.assign(boxes.span().begin(), boxes.span().end());
        const auto threads = executor();
        unlocked([&] { set_.assign(boxes_, *threads); });
    }
    [[nodiscard]] std::size_t size() const { return boxes_.size(); }
    [[nodiscard]] py::array boxes() const { return boxes_of(boxes_); }
    [[nodiscard]] py::array find_visible(const py::handle& view, bool conservative) const {
        const cull::View seen = view_of(view, ~0u);
        const auto threads = executor();
        cull::VerdictBits verdicts;
        Vector<boxtree::ItemId> ids;
        std::size_t count = 0;
        unlocked([&] {
            cull::find_visible(set_, std::span<const Obb>(boxes_), seen, verdicts, mode_of(conservative), *threads);
            ids.resize(boxes_.size() + 16);
            count = cull::list_bits(verdicts.visible, ids);
        });
        return array_of<std::uint32_t>(std::span<const std::uint32_t>(ids).first(count));
    }

  private:
    std::vector<Obb> boxes_;
    cull::BoxSet set_;
};

}  // namespace

void bind_cull(py::module_& module) {
    module.attr("OUTSIDE") = static_cast<int>(cull::Verdict::outside);
    module.attr("STRADDLING") = static_cast<int>(cull::Verdict::straddling);
    module.attr("INSIDE") = static_cast<int>(cull::Verdict::inside);
    module.def("classify", &classify, py::arg("view"), py::arg("boxes"), py::kw_only(), py::arg("conservative") = false,
               "Returns OUTSIDE, STRADDLING or INSIDE for each box, exactly. `view` is a Camera or a Frustum. A box "
               "that is not finite is STRADDLING, because nothing that may be visible is left out.");
    module.def("find_visible", &find_visible, py::arg("view"), py::arg("boxes"), py::kw_only(),
               py::arg("layers") = py::none(), py::arg("layer_mask") = ~0u, py::arg("conservative") = false,
               "Returns the indices, ascending, of the boxes that a view sees. `layers` holds 32 bits per box; boxes "
               "that share no bit with `layer_mask` are left out.");
    py::class_<BoxList>(module, "BoxList", "A list of boxes that do not change, prepared once for many views.")
        .def(py::init<const py::handle&>(), py::arg("boxes"))
        .def("__len__", &BoxList::size)
        .def("__repr__", [](const BoxList& list) { return format("BoxList(%zu boxes)", list.size()); })
        .def_property_readonly("boxes", &BoxList::boxes)
        .def("find_visible", &BoxList::find_visible, py::arg("view"), py::kw_only(), py::arg("conservative") = false,
             "Returns the indices, ascending, of the boxes that a view sees.");
}

}  // namespace crofton::python
