// SPDX-License-Identifier: MIT
// A World through the C API, in sequences of right and wrong calls, with a model of what each must return and leave.
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <crofton/cull/classify.hpp>
#include <map>

#include "../c_api/shorthand.hpp"
#include "shapes.hpp"

using namespace crofton::capi_test;

namespace {

using namespace crofton;
using fuzz::demand;

template <class Struct>
Struct sized() {
    Struct result{};
    result.size = sizeof result;
    return result;
}

crofton_box c_box(const Obb& box) {
    crofton_box result{};
    for (int k = 0; k < 3; ++k) {
        result.center[k] = box.center[k];
        result.half_extents[k] = box.half_extents[k];
        for (int j = 0; j < 3; ++j) result.axes[3 * k + j] = box.axes[k][j];
    }
    return result;
}

struct Known {
    crofton_object handle{};
    Obb box;
    std::uint64_t user = 0;
    std::uint32_t layers = ~0u;
    bool hidden = false, updated = false;
};

class Sequence {
  public:
    explicit Sequence(fuzz::Shapes& in) : in_(in) {
        crofton_world_options options = crofton_default_world_options();
        options.contacts = in.below(2);
        options.updates_to_rest = in.below(5);
        if (in.below(2)) options.rebuild_budget = 0;
        demand(crofton_world_create(&options, &world_) == CROFTON_OK, "create");
        demand(crofton_view_result_create(&visible_) == CROFTON_OK && crofton_found_create(&found_) == CROFTON_OK,
               "create");
    }
    ~Sequence() {
        crofton_view_result_destroy(visible_);
        crofton_found_destroy(found_);
        crofton_world_destroy(world_);
    }
    Sequence(const Sequence&) = delete;
    Sequence& operator=(const Sequence&) = delete;

    void step() {
        const unsigned kind = in_.below(10);
        if (kind < 3 || objects_.empty()) return add();
        auto& [index, object] = *std::next(objects_.begin(), in_.byte() % static_cast<std::ptrdiff_t>(objects_.size()));
        switch (kind) {
            case 3:
                demand(crofton_world_remove(world_, object.handle) == CROFTON_OK, "remove");
                stale_.push_back(object.handle);
                objects_.erase(index);
                break;
            case 4:
                object.layers = in_.layers();
                demand(world_set_layers(world_, object.handle, object.layers) == CROFTON_OK, "set_layers");
                break;
            case 5:
                object.hidden = in_.flag();
                demand(world_set_hidden(world_, object.handle, object.hidden) == CROFTON_OK, "set_hidden");
                break;
            case 6:
                object.user = in_.word();
                demand(world_set_user(world_, object.handle, object.user) == CROFTON_OK, "set_user");
                break;
            case 7:
                wrong_calls(object);
                break;
            default: {
                object.box = in_.flag() ? in_.box_near(object.box) : in_.box();
                const crofton_box box = c_box(object.box);
                demand(crofton_world_set_boxes(world_, &object.handle, 0, &box, 0, 1) == CROFTON_OK ||
                           crofton_world_set_boxes(world_, &object.handle, sizeof object.handle, &box, sizeof box, 1) ==
                               CROFTON_OK,
                       "set_boxes");
            }
        }
    }

    void update() {
        demand(crofton_world_update(world_, nullptr) == CROFTON_OK, "update");
        std::size_t count = 0;
        demand(world_object_count(world_, &count) == CROFTON_OK && count == objects_.size(), "object_count");
        for (auto& [index, object] : objects_) {
            object.updated = true;
            crofton_box box{};
            std::uint64_t user = 0;
            const crofton_box expected = c_box(object.box);
            demand(world_get_box(world_, object.handle, &box) == CROFTON_OK &&
                       std::memcmp(&box, &expected, sizeof box) == 0,
                   "get_box");
            demand(world_get_user(world_, object.handle, &user) == CROFTON_OK && user == object.user, "get_user");
        }
        for (const crofton_object handle : stale_) {
            int there = 1;
            std::uint64_t user = 0;
            demand(world_contains(world_, handle, &there) == CROFTON_OK && there == 0, "contains what is gone");
            demand(world_get_user(world_, handle, &user) == CROFTON_STALE_HANDLE, "a stale handle");
        }
        check_view();
        check_overlap();
    }

  private:
    void add() {
        Known object;
        object.box = in_.box();
        object.user = in_.word();
        object.layers = in_.layers();
        crofton_bound bound{};
        bound.kind = CROFTON_BOUND_BOX;
        bound.box = c_box(object.box);
        crofton_object_description description = crofton_default_object_description();
        description.bound = &bound;
        description.user = object.user;
        description.layers = object.layers;
        const bool bad = in_.below(8) == 0;
        if (bad) bound.box.center[in_.below(3)] = std::numeric_limits<double>::quiet_NaN();
        const crofton_status status = crofton_world_add(world_, &description, &object.handle);
        demand((status == CROFTON_OK) == !bad, "add");
        if (bad) return;
        demand(!objects_.contains(object.handle.index), "an index in use is given out");
        objects_[object.handle.index] = object;
    }
    // Each is refused, and changes nothing; update() looks.
    void wrong_calls(const Known& object) {
        crofton_box box = c_box(object.box);
        box.half_extents[in_.below(3)] = -1.0f;
        demand(crofton_world_set_boxes(world_, &object.handle, sizeof object.handle, &box, sizeof box, 1) != CROFTON_OK,
               "a box that is none");
        demand(world_set_layers(nullptr, object.handle, 0) != CROFTON_OK, "no world");
        demand(crofton_world_view(world_, nullptr, 1, nullptr, visible_) != CROFTON_OK, "no view");
        crofton_object_description description = crofton_default_object_description();
        description.size += 8 + in_.byte();
        crofton_object handle{};
        demand(crofton_world_add(world_, &description, &handle) == CROFTON_WRONG_SIZE, "a struct too large");
        if (stale_.empty()) return;
        const crofton_object stale = stale_[in_.byte() % stale_.size()];
        demand(world_set_hidden(world_, stale, 1) == CROFTON_STALE_HANDLE, "a stale handle hidden");
        demand(crofton_world_remove(world_, stale) == CROFTON_STALE_HANDLE, "a stale handle removed");
    }
    void check_view() {
        const Frustum frustum = in_.frustum();
        View view;
        view.layer_mask = in_.layers();
        view.frustum = sized<crofton_frustum>();
        view.frustum.plane_count = frustum.plane_count;
        for (int k = 0; k < 3; ++k) view.frustum.origin[k] = frustum.origin[k];
        for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
            for (int k = 0; k < 3; ++k) view.frustum.planes[i].normal[k] = frustum.planes[i].normal[k];
            view.frustum.planes[i].offset = frustum.planes[i].offset;
        }
        std::vector<std::uint32_t> expected;
        for (const auto& [index, object] : objects_)
            if (!object.hidden && (object.layers & view.layer_mask) != 0 &&
                cull::classify(frustum, object.box) != cull::Verdict::outside)
                expected.push_back(index);
        crofton_view_request request = crofton_default_view_request();
        request.volume = &view.frustum;
        request.layers = view.layer_mask;
        demand(crofton_world_view(world_, &request, 1, nullptr, visible_) == CROFTON_OK, "a view");
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        demand(crofton_view_result_ids(visible_, &ids, &count, nullptr, nullptr) == CROFTON_OK, "ids of a view");
        demand(std::equal(expected.begin(), expected.end(), ids, ids + count), "what a view sees");
    }
    void check_overlap() {
        const crofton_box box = c_box(in_.box());
        const std::uint32_t layers = in_.layers();
        const crofton_query_filter filter = in_layers(layers);
        demand(world_overlap(world_, &box, &filter, found_) == CROFTON_OK, "an overlap");
        const crofton_object_ref* list = nullptr;
        std::size_t count = 0;
        demand(crofton_found_objects(found_, &list, &count) == CROFTON_OK, "what overlaps");
        std::size_t at = 0;
        for (const auto& [index, object] : objects_) {
            if (object.hidden || (object.layers & layers) == 0) continue;
            const crofton_box other = c_box(object.box);
            int meet = 0;
            demand(crofton_boxes_meet(&box, &other, &meet) == CROFTON_OK, "two boxes");
            if (meet == 0) continue;
            demand(at < count && list[at].object.index == index && list[at].user == object.user, "who overlaps");
            ++at;
        }
        demand(at == count, "how many overlap");
    }

    fuzz::Shapes& in_;
    crofton_world* world_ = nullptr;
    crofton_view_result* visible_ = nullptr;
    crofton_found* found_ = nullptr;
    std::map<std::uint32_t, Known> objects_;
    std::vector<crofton_object> stale_;
};

}  // namespace

CROFTON_FUZZ(in) {
    Sequence sequence(in);
    for (int frame = 0; frame < 10 && in.more(); ++frame) {
        for (unsigned calls = 1 + in.below(12); calls > 0; --calls) sequence.step();
        sequence.update();
    }
}
