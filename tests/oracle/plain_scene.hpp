// SPDX-License-Identifier: MIT
// What a scene should hold, computed anew from the roots each time: no order, no dirty marks, no lists.
#pragma once
#include <crofton/scene/scene.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace crofton::testing {

class PlainScene {
  public:
    struct Node {
        scene::NodeId parent;
        Transform local;
        std::uint32_t mask;
    };
    struct Instance {
        scene::NodeId node;
        scene::MeshId mesh;
        std::uint32_t mask;
        bool is_new = true, has_other_mesh = false;  // since the last update; the second: or one that has changed
        Transform place = {};                        // as of the last update
    };
    struct Answer {
        std::optional<Obb> box;
        std::uint32_t mask = 0;
        Transform place;
    };

    std::map<scene::NodeId, Node> nodes;
    std::map<scene::InstanceId, Instance> instances;
    std::map<scene::MeshId, Obb> mesh_boxes;
    std::set<scene::InstanceId> removed;  // since the last update

    [[nodiscard]] bool is_below(scene::NodeId node, scene::NodeId ancestor) const {
        for (; node != scene::kNone; node = nodes.at(node).parent)
            if (node == ancestor) return true;
        return false;
    }

    [[nodiscard]] Transform world(scene::NodeId node) const {
        std::vector<scene::NodeId> way;
        for (; node != scene::kNone; node = nodes.at(node).parent) way.push_back(node);
        Transform result = nodes.at(way.back()).local;
        for (auto at = way.rbegin() + 1; at != way.rend(); ++at) result = result * nodes.at(*at).local;
        return result;
    }

    [[nodiscard]] std::uint32_t mask(scene::NodeId node) const {
        std::uint32_t result = ~0u;
        for (; node != scene::kNone; node = nodes.at(node).parent) result &= nodes.at(node).mask;
        return result;
    }

    [[nodiscard]] Answer answer(const Instance& instance) const {
        const Transform place = world(instance.node);
        const auto box = scene::transformed_box(place, mesh_boxes.at(instance.mesh), measure::minimal_perimeter());
        Answer result;
        result.place = place;
        if (!box) return result;
        result.box = *box;
        result.mask = maps_to_point(place) ? 0 : mask(instance.node) & instance.mask;
        return result;
    }

    // Whether the instance has moved since the last update, at which it had the box `before`; once for each update.
    [[nodiscard]] bool settle(Instance& instance, const Answer& answer, const Obb& before, const Obb& now) const {
        const bool carried =
            instance.place.linear != answer.place.linear || instance.place.translation != answer.place.translation;
        const bool moved =
            instance.is_new || instance.has_other_mesh || carried || std::memcmp(&before, &now, sizeof now) != 0;
        instance.is_new = instance.has_other_mesh = false;
        instance.place = answer.place;
        return moved;
    }

    void remove_instance(scene::InstanceId id) {
        if (!instances.at(id).is_new) removed.insert(id);
        instances.erase(id);
    }

    void remove_node(scene::NodeId root) {
        std::vector<scene::NodeId> gone;
        for (const auto& [id, node] : nodes)
            if (is_below(id, root)) gone.push_back(id);
        std::vector<scene::InstanceId> gone_instances;
        for (const auto& [id, instance] : instances)
            for (const scene::NodeId node : gone)
                if (instance.node == node) gone_instances.push_back(id);
        for (const scene::InstanceId id : gone_instances) remove_instance(id);
        for (const scene::NodeId node : gone) nodes.erase(node);
    }
};

}  // namespace crofton::testing
