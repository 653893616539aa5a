// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>

#include "statistics_panel.hpp"

namespace crofton::viewer {
namespace {

// Files can nest nodes without end; a person opens them one by one, and no deeper than this.
constexpr int kMaxShownDepth = 64;

void show_node(const PanelInput& input, PanelWish& wish, scene::NodeId node, int depth);

void show_children(const PanelInput& input, PanelWish& wish, scene::NodeId parent, int depth) {
    const auto children = input.nodes.children(parent);
    // A list longer than this is no longer read row by row, and would cost more than the rest of the panels.
    constexpr std::size_t kShown = 300;
    for (std::size_t i = 0; i < std::min(children.size(), kShown); ++i) show_node(input, wish, children[i], depth);
    if (children.size() > kShown) ImGui::TextDisabled("and %zu more", children.size() - kShown);
}

void show_node(const PanelInput& input, PanelWish& wish, scene::NodeId node, int depth) {
    const scene::Scene& scene = input.loaded.scene();
    const auto instances = input.nodes.instances(node);
    const bool leaf = input.nodes.children(node).empty() && instances.empty();
    const std::string name(scene.node_name(node));
    ImGui::PushID(static_cast<int>(node));
    const bool open = ImGui::TreeNodeEx("node", leaf ? ImGuiTreeNodeFlags_Leaf : 0, "%s #%u",
                                        name.empty() ? "node" : name.c_str(), node);
    if (open) {
        for (const scene::InstanceId instance : instances) {
            ImGui::PushID(static_cast<int>(instance));
            const std::string label = "mesh " + std::string(scene.mesh_name(scene.mesh_of(instance))) + " (instance " +
                                      std::to_string(instance) + ")";
            if (ImGui::Selectable(label.c_str(), instance == input.selected)) wish.select = instance;
            ImGui::PopID();
        }
        if (depth < kMaxShownDepth) show_children(input, wish, node, depth + 1);
        ImGui::TreePop();
    }
    ImGui::PopID();
}

const char* verdict_name(cull::Verdict verdict) {
    switch (verdict) {
        case cull::Verdict::outside:
            return "outside";
        case cull::Verdict::straddling:
            return "straddling";
        default:
            return "inside";
    }
}

// A node without a name goes by its first mesh.
std::string name_of(const scene::Scene& scene, scene::NodeId node, std::span<const scene::InstanceId> instances) {
    std::string name(scene.node_name(node));
    if (name.empty() && !instances.empty()) name = scene.mesh_name(scene.mesh_of(instances[0]));
    if (instances.size() > 1) name += " and " + std::to_string(instances.size() - 1) + " more";
    return "node " + std::to_string(node) + (name.empty() ? "" : ": " + name);
}

// Lists what hides the selected object; a click selects it.
void show_hiders(const PanelInput& input, PanelWish& wish) {
    constexpr std::size_t kShown = 3;
    for (std::size_t i = 0; i < std::min(input.hiders.size(), kShown); ++i) {
        const scene::NodeId hider = input.hiders[i];
        const auto instances = input.nodes.instances(hider);
        const std::string label = "  hidden by " + name_of(input.loaded.scene(), hider, instances);
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.55f, 0.5f, 1.0f));
        if (ImGui::Selectable(label.c_str()) && !instances.empty()) wish.select = instances[0];
        ImGui::PopStyleColor();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("red in the picture; a click selects it");
    }
    if (input.hiders.size() > kShown) ImGui::TextDisabled("  and by %zu more", input.hiders.size() - kShown);
}

void show_box(const Obb& box) {
    const glm::vec3 edge = 2.0f * box.half_extents;
    ImGui::Text("box %.2f \u00d7 %.2f \u00d7 %.2f m", static_cast<double>(edge.x), static_cast<double>(edge.y),
                static_cast<double>(edge.z));
    ImGui::Text("centre %.2f %.2f %.2f m", box.center.x, box.center.y, box.center.z);
    ImGui::Text("volume %.3g m\u00b3, surface %.3g m\u00b2", volume(box), surface_area(box));
    ImGui::Text("sum of its three edges %.3g m", edge_sum(box));
}

void show_pick(const PanelInput& input) {
    if (input.pick && input.pick->instance == input.selected)
        ImGui::Text("picked: triangle %u, %.2f m away", input.pick->triangle, input.pick->distance);
}

void show_selection_in(const pipeline::RegionPipeline& regions, const PanelInput& input) {
    const auto box = regions.stream().world().box_of(regions.object_of(input.selected));
    if (!box) return ImGui::TextDisabled("left click picks an object");
    const std::uint32_t place = regions.place_of(input.selected);
    const auto drawables = regions.drawables();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::Text("object %u of %s", input.selected - regions.first_of(place),
                regions.stream().index()[place].name.c_str());
    ImGui::Text("%s triangles, bound %s",
                with_thousands(drawables->mesh(drawables->mesh_of(input.selected)).triangle_count()).c_str(),
                verdict_name(regions.verdicts()[input.selected]));
    show_box(*box);
    show_pick(input);
    ImGui::PopTextWrapPos();
}

void show_selection(const PanelInput& input, PanelWish& wish) {
    if (input.loaded.regions()) return show_selection_in(*input.loaded.regions(), input);
    const scene::Scene& scene = input.loaded.scene();
    const scene::InstanceId instance = input.selected;
    if (instance >= scene.instance_count() || scene.is_removed(instance)) {
        ImGui::TextDisabled("left click picks an instance");
        return;
    }
    const scene::MeshId mesh = scene.mesh_of(instance);
    const Obb& box = scene.world_boxes()[instance];
    ImGui::PushTextWrapPos(0.0f);
    ImGui::Text("instance %u of node %u, mesh %u %s", instance, scene.node_of(instance), mesh,
                std::string(scene.mesh_name(mesh)).c_str());
    ImGui::Text("%s triangles, bound %s%s", with_thousands(scene.mesh(mesh).triangle_count()).c_str(),
                verdict_name(input.loaded.pipeline().verdicts()[instance]), input.hiders.empty() ? "" : ", hidden");
    show_hiders(input, wish);
    show_box(box);
    show_pick(input);
    ImGui::PopTextWrapPos();
}

}  // namespace

void NodeTree::rebuild(const scene::Scene& scene) {
    // Counting sort by parent; slot 0 holds the roots, node n's children are in slot n + 1.
    const auto slot_of = [](scene::NodeId parent) {
        return parent == scene::kNone ? std::size_t{0} : std::size_t{parent} + 1;
    };
    const auto nodes = static_cast<scene::NodeId>(scene.node_count());
    child_begin_.assign(scene.node_count() + 2, 0);
    for (scene::NodeId node = 0; node < nodes; ++node) ++child_begin_[slot_of(scene.parent_of(node)) + 1];
    for (std::size_t i = 1; i < child_begin_.size(); ++i) child_begin_[i] += child_begin_[i - 1];
    children_.resize(scene.node_count());
    std::vector<std::uint32_t> next = child_begin_;
    for (scene::NodeId node = 0; node < nodes; ++node) children_[next[slot_of(scene.parent_of(node))]++] = node;

    const auto instances = static_cast<scene::InstanceId>(scene.instance_count());
    instance_begin_.assign(scene.node_count() + 1, 0);
    for (scene::InstanceId i = 0; i < instances; ++i) ++instance_begin_[scene.node_of(i) + 1];
    for (std::size_t i = 1; i < instance_begin_.size(); ++i) instance_begin_[i] += instance_begin_[i - 1];
    instances_.resize(scene.instance_count());
    next = instance_begin_;
    for (scene::InstanceId i = 0; i < instances; ++i) instances_[next[scene.node_of(i)]++] = i;
}

std::span<const scene::NodeId> NodeTree::children(scene::NodeId parent) const {
    const std::size_t slot = parent == scene::kNone ? 0 : std::size_t{parent} + 1;
    return std::span(children_).subspan(child_begin_[slot], child_begin_[slot + 1] - child_begin_[slot]);
}

std::span<const scene::InstanceId> NodeTree::instances(scene::NodeId node) const {
    return std::span(instances_).subspan(instance_begin_[node], instance_begin_[node + 1] - instance_begin_[node]);
}

void scene_panel(const PanelInput& input, PanelWish& wish) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const ImGuiCond when = input.relayout ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    const float font = ImGui::GetFontSize(), free = display.x - main_panel_width() - 24.0f;
    const float width = std::min(26.0f * font, std::max(free, 8.0f * font));
    ImGui::SetNextWindowPos(ImVec2(display.x - width - 8.0f, 8.0f), when);
    ImGui::SetNextWindowSize(ImVec2(width, std::min(18.0f * font, 0.45f * display.y)), when);
    if (input.fold) ImGui::SetNextWindowCollapsed(*input.fold, ImGuiCond_Always);
    if (ImGui::Begin("Scene")) {
        if (const pipeline::RegionPipeline* const regions = input.loaded.regions())
            ImGui::TextWrapped("%s objects in %zu regions", with_thousands(regions->stream().object_count()).c_str(),
                               regions->stream().index().size());
        else
            ImGui::TextWrapped("%s nodes, %s instances", with_thousands(input.loaded.scene().node_count()).c_str(),
                               with_thousands(input.loaded.scene().instance_count()).c_str());
        if (!input.loaded.regions()) ImGui::Text("%s triangles", with_thousands(input.loaded.triangle_count()).c_str());
        show_selection(input, wish);
        ImGui::Separator();
        if (ImGui::BeginChild("nodes")) show_children(input, wish, scene::kNone, 0);
        ImGui::EndChild();
    }
    const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    wish.covered.push_back({at.x, at.y, at.x + size.x, at.y + size.y});
    ImGui::End();
}

}  // namespace crofton::viewer
