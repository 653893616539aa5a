// SPDX-License-Identifier: MIT
#include "overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>

namespace crofton::viewer {
namespace {

// Corner i and corner i with one bit set: the twelve edges of a box.
void edges(LineList& lines, const std::array<glm::dvec3, 8>& corner, std::uint32_t color) {
    for (unsigned i = 0; i < 8; ++i)
        for (unsigned bit = 1; bit < 8; bit <<= 1)
            if ((i & bit) == 0) lines.segment(corner[i], corner[i | bit], color);
}

constexpr std::uint32_t kOutside = rgba(225, 60, 70), kBound = rgba(250, 235, 90), kFrustum = rgba(255, 255, 255),
                        kTree = rgba(110, 220, 255), kPair = rgba(255, 90, 60), kContact = rgba(255, 250, 80),
                        kSelection = rgba(90, 170, 255), kHiddenBound = rgba(190, 110, 255),
                        kSeparation = rgba(80, 255, 210);
constexpr std::array<std::uint32_t, 8> kCascades{rgba(255, 90, 90),   rgba(255, 190, 70),  rgba(130, 230, 90),
                                                 rgba(70, 220, 220),  rgba(100, 140, 255), rgba(210, 110, 255),
                                                 rgba(255, 120, 200), rgba(200, 200, 200)};
// Beyond this many pairs the picture says nothing more.
constexpr std::size_t kMaxPairs = 200;
constexpr std::size_t kMaxContactsOfPair = 64;

// The bound of a node's child, along the node's axes.
Obb bound_of(const boxtree::Structure& structure, boxtree::NodeId id, unsigned lane) {
    const boxtree::Node& node = structure.nodes()[id];
    const boxtree::Axes& axes = structure.axes_of(node);
    Obb box{{node.origin[0], node.origin[1], node.origin[2]}, {}, {}};
    for (unsigned k = 0; k < 3; ++k) {
        const glm::dvec3 axis(axes.rows[k][0], axes.rows[k][1], axes.rows[k][2]);
        box.center += double{node.unit} * boxtree::middle_of(node, lane, k) * axis;
        box.axes[static_cast<int>(k)] = glm::vec3(axis);
        box.half_extents[static_cast<int>(k)] = node.unit * static_cast<float>(boxtree::half_of(node, lane, k));
    }
    return box;
}

}  // namespace

Json to_json(const CellSight& sight) {
    constexpr const char* kKinds[] = {"unknown", "solid", "inner", "open"};
    return {{"cell", sight.cell},
            {"kind", kKinds[static_cast<std::size_t>(sight.kind)]},
            {"seen", sight.seen},
            {"unseen", sight.unseen},
            {"hidden", sight.hidden}};
}

std::optional<CellSight> look_up(const pvs::Pvs* pvs, const pipeline::FrameStatistics& frame) {
    if (pvs == nullptr) return std::nullopt;
    CellSight sight;
    sight.cell = pvs->find_cell(frame.camera.position);
    if (sight.cell == pvs::kNoCell) return std::nullopt;
    sight.kind = pvs->kind(sight.cell);
    sight.box = pvs->cells().box(sight.cell);
    for (std::uint32_t o = 0; o < pvs->object_count(); ++o) {
        if (!pvs->is_baked(o)) continue;
        const pvs::PairState state = pvs->state(sight.cell, o);
        ++(state == pvs::PairState::seen ? sight.seen : state == pvs::PairState::unseen ? sight.unseen : sight.hidden);
    }
    return sight;
}

void LineList::segment(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t color) {
    vertices_.push_back({glm::vec3(a - controller_), color});
    vertices_.push_back({glm::vec3(b - controller_), color});
}

void LineList::box(const Obb& box, std::uint32_t color) {
    edges(*this, corners(box), color);
}

void LineList::axes(const Obb& box) {
    constexpr std::array<std::uint32_t, 3> kAxisColors{rgba(255, 60, 60), rgba(60, 255, 60), rgba(90, 120, 255)};
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 arm = glm::dvec3(box.axes[k]) * (1.3 * static_cast<double>(box.half_extents[k]));
        segment(box.center - arm, box.center + arm, kAxisColors[static_cast<std::size_t>(k)]);
    }
}

void LineList::cross(const glm::dvec3& at, double size, std::uint32_t color) {
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 arm(0.0);
        arm[k] = size;
        segment(at - arm, at + arm, color);
    }
}

std::array<glm::dvec3, 8> view_corners(const Camera& camera, double far) {
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    std::array<glm::dvec3, 8> result;
    for (unsigned i = 0; i < 8; ++i) {
        const double depth = (i & 4) != 0 ? std::min(camera.far_distance, far) : camera.near_distance;
        const double half =
            camera.projection == Projection::perspective ? depth * std::tan(0.5 * camera.fov_y) : 0.5 * camera.height;
        const glm::dvec3 in_view((i & 1) != 0 ? half * camera.aspect : -half * camera.aspect,
                                 (i & 2) != 0 ? half : -half, -depth);
        result[i] = camera.position + to_world * in_view;
    }
    return result;
}

void LineList::frustum(const Camera& camera, double far, std::uint32_t color) {
    edges(*this, view_corners(camera, far), color);
}

std::vector<Cascade> split_view(const Camera& camera, int count, double range) {
    std::vector<Cascade> result;
    const double near = camera.near_distance, far = std::min(camera.far_distance, std::max(range, 2.0 * near));
    const auto depth_at = [&](int i) {
        const double share = static_cast<double>(i) / count;
        return 0.5 * (near + (far - near) * share) + 0.5 * near * std::pow(far / near, share);
    };
    for (int i = 0; i < count; ++i) {
        Cascade cascade{camera, 0, kCascades[static_cast<std::size_t>(i) % kCascades.size()]};
        cascade.camera.near_distance = depth_at(i);
        cascade.camera.far_distance = depth_at(i + 1);
        result.push_back(cascade);
    }
    return result;
}

void Overlay::draw(LineList& lines, const Settings& settings, const LoadedScene& loaded,
                   const pipeline::FrameStatistics& frame, const FoundContacts& contacts,
                   std::span<const Cascade> cascades, scene::InstanceId selected, bool show_frustum) {
    const scene::Scene& scene = loaded.scene();
    legend_.clear();
    if (loaded.regions() && settings.coloring == Coloring::regions) draw_regions(lines, loaded.regions()->stream());
    draw_bounds(lines, settings, loaded, frame);
    if (settings.tree_level >= 0) draw_tree_level(lines, loaded.pipeline().world().tree(), settings.tree_level);
    contacts_ = separations_ = hulls_ = manifold_points_ = 0;
    if (settings.coloring == Coloring::collision && settings.collisions) {
        legend_.push_back({"boxes that meet, and their centres", kPair});
        draw_pairs(lines, loaded, frame);
        draw_contacts(lines, scene, contacts.triangles());
        legend_.push_back({"contacts between triangles", kContact, contacts_});
        draw_separations(lines, loaded, frame);
        legend_.push_back({"near misses, separating axis", kSeparation, separations_});
    }
    if (selected < scene.instance_count() && !scene.is_removed(selected)) {
        legend_.push_back({"its bound and its own axes", kSelection});
        lines.box(loaded.pipeline().bounds().boxes()[selected], kSelection);
        lines.axes(scene.world_boxes()[selected]);
    }
    if (const pipeline::RegionPipeline* const regions = loaded.regions())
        if (const auto box = regions->stream().world().box_of(regions->object_of(selected))) {
            legend_.push_back({"its bound", kSelection});
            lines.box(*box, kSelection);
        }
    const double range = 1.5 * glm::length(loaded.extent().half_extents());
    if (show_frustum && cascades.size() < 2) {
        legend_.push_back({"view that culls", kFrustum});
        lines.frustum(frame.camera, range, kFrustum);
    }
    if (show_frustum || settings.freeze)
        for (const Cascade& cascade : cascades)
            if (cascades.size() > 1) lines.frustum(cascade.camera, cascade.camera.far_distance, cascade.color);
}

void Overlay::draw_regions(LineList& lines, const pipeline::RegionStream& stream) {
    constexpr std::uint32_t kAttached = rgba(120, 230, 120), kComing = rgba(255, 220, 80), kAway = rgba(90, 95, 110);
    std::vector<bool> is_attached(stream.index().size());
    for (const pipeline::RegionStream::Attached& entry : stream.attached()) is_attached[entry.place] = true;
    std::uint64_t coming = 0, away = 0;
    for (std::uint32_t place = 0; place < stream.index().size(); ++place) {
        const bake::RegionFile& file = stream.index()[place];
        const bool comes = !is_attached[place] && stream.is_coming(place);
        coming += comes;
        away += !is_attached[place] && !comes;
        lines.box(obb_of(Aabb{file.bounds.min + file.origin, file.bounds.max + file.origin}), is_attached[place]
                                                                                                  ? kAttached
                                                                                              : comes ? kComing
                                                                                                      : kAway);
    }
    legend_.push_back({"regions attached", kAttached, stream.attached().size()});
    legend_.push_back({"regions being prepared, or ready", kComing, coming});
    legend_.push_back({"regions that are away", kAway, away});
}

void Overlay::draw_bounds(LineList& lines, const Settings& settings, const LoadedScene& loaded,
                          const pipeline::FrameStatistics& frame) {
    const scene::Scene& scene = loaded.scene();
    const auto verdicts = loaded.pipeline().verdicts();
    const auto boxes = loaded.pipeline().bounds().boxes();
    if (settings.outside) {
        legend_.push_back({"bounds of culled objects", kOutside});
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
            if (!scene.is_removed(i) && verdicts[i] == cull::Verdict::outside) lines.box(boxes[i], kOutside);
    }
    if (settings.outside && loaded.occlusion() != nullptr) {
        legend_.push_back({"bounds of hidden objects", kHiddenBound, loaded.occlusion()->hidden().size()});
        for (const scene::InstanceId i : loaded.occlusion()->hidden()) lines.box(boxes[i], kHiddenBound);
    }
    if (settings.bounds) {
        legend_.push_back({"bounds of visible objects", kBound});
        for (const scene::InstanceId i : frame.visible_ids) lines.box(boxes[i], kBound);
    }
}

void Overlay::draw_tree_level(LineList& lines, const boxtree::BoxTree& tree, int level) {
    const boxtree::Structure& structure = tree.structure();
    if (structure.nodes().empty()) return;
    legend_.push_back({"bounds of the tree's nodes", kTree});
    Aabb all;
    for (unsigned lane = 0; lane < structure.nodes()[0].count; ++lane) all.include(structure.child_bounds(0, lane));
    if (level == 0 && !all.is_empty()) lines.box(obb_of(all), kTree);
    if (level == 0) return;
    std::vector<boxtree::NodeId> nodes{0}, next;
    for (int depth = 1; depth < level && !nodes.empty(); ++depth) {
        next.clear();
        for (const boxtree::NodeId node : nodes)
            for (unsigned lane = 0; lane < structure.nodes()[node].count; ++lane)
                if ((structure.nodes()[node].child[lane] & boxtree::kLeafBit) == 0)
                    next.push_back(structure.nodes()[node].child[lane]);
        nodes.swap(next);
    }
    for (const boxtree::NodeId node : nodes)
        for (unsigned lane = 0; lane < structure.nodes()[node].count; ++lane)
            if (boxtree::half_of(structure.nodes()[node], lane, 0) >= 0)
                lines.box(bound_of(structure, node, lane), kTree);
}

void Overlay::draw_pairs(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame) {
    const auto boxes = loaded.scene().world_boxes();
    const std::size_t count = std::min(frame.colliding_ids.size(), kMaxPairs);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [a, b] = frame.colliding_ids[i];
        for (const scene::InstanceId instance : {a, b}) {
            lines.box(boxes[instance], kPair);
            lines.axes(boxes[instance]);
        }
        lines.segment(boxes[a].center, boxes[b].center, kPair);
    }
}

void Overlay::draw_contacts(LineList& lines, const scene::Scene& scene, std::span<const TriangleContacts> contacts) {
    for (const TriangleContacts& contact : contacts) contacts_ += contact.triangles.size();
    for (const TriangleContacts& contact : contacts.first(std::min(contacts.size(), kMaxPairs))) {
        const double size = 0.05 * glm::length(glm::dvec3(scene.world_boxes()[contact.first].half_extents));
        for (const mesh::MeshContact& found :
             std::span(contact.triangles).first(std::min(contact.triangles.size(), kMaxContactsOfPair))) {
            lines.segment(found.segment.begin, found.segment.end, kContact);
            lines.cross(0.5 * (found.segment.begin + found.segment.end), size, kContact);
        }
    }
}

// Between moving shapes in view that come close.
void Overlay::draw_separations(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame) {
    const auto boxes = loaded.scene().world_boxes();
    std::vector<scene::InstanceId> movers;
    std::set_intersection(frame.visible_ids.begin(), frame.visible_ids.end(), loaded.pipeline().movers().begin(),
                          loaded.pipeline().movers().end(), std::back_inserter(movers));
    for (const auto& [a, b] : near_pairs(boxes, movers, kMaxPairs)) {
        const auto gap = separation(boxes[a], boxes[b]);
        if (!gap) continue;
        ++separations_;
        lines.segment(gap->begin, gap->end, kSeparation);
        const double smaller =
            std::min(glm::length(glm::dvec3(boxes[a].half_extents)), glm::length(glm::dvec3(boxes[b].half_extents)));
        lines.cross(gap->begin, 0.1 * smaller, kSeparation);
        lines.cross(gap->end, 0.1 * smaller, kSeparation);
    }
}

}  // namespace crofton::viewer
