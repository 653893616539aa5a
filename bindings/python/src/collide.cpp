// SPDX-License-Identifier: MIT
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "convert.hpp"
#include "module.hpp"

namespace crofton::python {
namespace {

using collide::Broadphase;

// Two arrays of boxes, one beside the other; one box goes with all of the other side.
struct BoxPairs {
    Boxes a, b;
    std::size_t count;

    BoxPairs(const py::handle& given_a, const py::handle& given_b) : a(given_a, "a"), b(given_b, "b") {
        const std::size_t n = a.span().size(), m = b.span().size();
        if (n != m && n != 1 && m != 1)
            raise({ErrorCode::invalid_argument, kNoItem, "a and b: as many boxes on both sides, or one on either"});
        count = n == 1 ? m : n;
    }
    [[nodiscard]] const Obb& first(std::size_t i) const { return a.span()[a.span().size() == 1 ? 0 : i]; }
    [[nodiscard]] const Obb& second(std::size_t i) const { return b.span()[b.span().size() == 1 ? 0 : i]; }
};

py::array intersects(const py::handle& given_a, const py::handle& given_b) {
    const BoxPairs pairs(given_a, given_b);
    py::array_t<bool> hits(static_cast<py::ssize_t>(pairs.count));
    static_assert(sizeof(bool) == 1);
    auto* out = reinterpret_cast<std::uint8_t*>(hits.mutable_data());
    unlocked([&] {
        if (pairs.a.span().size() == pairs.b.span().size()) {
            collide::intersects(pairs.a.span(), pairs.b.span(), {out, pairs.count});
            return;
        }
        for (std::size_t i = 0; i < pairs.count; ++i) out[i] = collide::intersects(pairs.first(i), pairs.second(i));
    });
    return hits;
}

void check(std::span<const Obb> boxes, const char* name) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (auto valid = validate(boxes[i], i); !valid) {
            valid.error().message = std::string(name) + ": " + valid.error().message;
            raise(valid.error());
        }
}

py::array distance(const py::handle& given_a, const py::handle& given_b) {
    const BoxPairs pairs(given_a, given_b);
    check(pairs.a.span(), "a");
    check(pairs.b.span(), "b");
    py::array_t<double> result(static_cast<py::ssize_t>(pairs.count));
    double* out = result.mutable_data();
    unlocked([&] {
        for (std::size_t i = 0; i < pairs.count; ++i)
            out[i] = collide::distance(pairs.first(i), pairs.second(i)).distance;
    });
    return result;
}

py::tuple penetration(const Obb& a, const Obb& b) {
    const collide::Penetration p = collide::penetration(a, b);
    return py::make_tuple(p.depth, tuple_of(p.axis));
}

py::dict contact_manifold(const Obb& a, const Obb& b) {
    const collide::Manifold manifold = collide::contact_manifold(a, b);
    py::array_t<double> points({py::ssize_t{manifold.count}, py::ssize_t{3}}), depths(py::ssize_t{manifold.count});
    for (int i = 0; i < manifold.count; ++i) {
        const collide::ContactPoint& point = manifold.points[i];
        for (int k = 0; k < 3; ++k) points.mutable_at(i, k) = point.position[k];
        depths.mutable_at(i) = point.depth;
    }
    py::dict result;
    result["normal"] = tuple_of(manifold.normal);
    result["depth"] = manifold.depth;
    result["points"] = points;
    result["depths"] = depths;
    return result;
}

py::array pairs_of(std::span<const IdPair> pairs) {
    static_assert(sizeof(IdPair) == 8);
    return array_of<std::uint32_t>(pairs, 2);
}

// A mutex beside it: an update runs without the interpreter's lock.
class Pairs {
  public:
    explicit Pairs(bool exact_boxes) : broadphase_({.exact_boxes = exact_boxes}) {}

    void update(const py::handle& given, const py::object& moved) {
        const Boxes boxes(given, "boxes");
        // Its own copy: the exact tests and the order of the items read boxes more than once.
        std::vector<Obb> copy(boxes.span().begin(), boxes.span().end());
        std::vector<std::uint32_t> items;
        const bool some = !moved.is_none();
        if (some) {
            const auto indices = integers<std::uint32_t>(moved, "moved");
            items.assign(span_of(indices).begin(), span_of(indices).end());
        }
        const auto threads = executor();
        value_of(unlocked([&] {
            const std::lock_guard lock(mutex_);
            return some ? broadphase_.update_moved(copy, items, {}, *threads) : broadphase_.update(copy, {}, *threads);
        }));
    }
    template <class F>
    py::array read(F&& f) {
        py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        const py::gil_scoped_acquire acquire;
        return pairs_of(f(broadphase_));
    }

  private:
    Broadphase broadphase_;
    std::mutex mutex_;
};

}  // namespace

void bind_collide(py::module_& module) {
    module.def("intersects", &intersects, py::arg("a"), py::arg("b"),
               "Tests whether a[i] and b[i] share a point, exactly; touching counts. A single box is tested against "
               "all of the other side. A box with NaN or infinite members overlaps nothing.");
    module.def("distance", &distance, py::arg("a"), py::arg("b"),
               "Returns the distance between a[i] and b[i]; 0 if they overlap.");
    module.def("penetration", &penetration, py::arg("a"), py::arg("b"),
               "Returns (depth, axis): moving b by depth · axis ends the overlap by the shortest way. A negative depth "
               "is a gap.");
    module.def(
        "contact_manifold", &contact_manifold, py::arg("a"), py::arg("b"),
        "Returns where two boxes touch: `normal` from a to b, `points` of shape (n, 3), n ≤ 4, and their `depths`.");
    py::class_<Pairs>(module, "Broadphase",
                      "Finds all pairs of boxes that overlap, and updates them from frame to frame.")
        .def(py::init<bool>(), py::kw_only(), py::arg("exact_boxes") = true)
        .def("__repr__",
             [](Pairs& p) {
                 return format("Broadphase(%zd pairs)", p.read([](auto& b) { return b.pairs(); }).shape(0));
             })
        .def("update", &Pairs::update, py::arg("boxes"), py::arg("moved") = py::none(),
             "Updates the pairs. boxes[i] is the same item as in the last call. If `moved` is given, only these items "
             "have changed. A box that is not valid overlaps nothing.")
        .def_property_readonly(
            "pairs", [](Pairs& p) { return p.read([](auto& b) { return b.pairs(); }); },
            "indices of shape (n, 2), in order")
        .def_property_readonly("began", [](Pairs& p) { return p.read([](auto& b) { return b.began(); }); })
        .def_property_readonly("stayed", [](Pairs& p) { return p.read([](auto& b) { return b.stayed(); }); })
        .def_property_readonly("ended", [](Pairs& p) { return p.read([](auto& b) { return b.ended(); }); });
}

}  // namespace crofton::python
