// SPDX-License-Identifier: MIT
// Prepares regions, on any thread.
#include <crofton/world/region.hpp>

#include <algorithm>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "bound_rules.hpp"
#include "region_data.hpp"
#include "region_solids.hpp"

namespace crofton {
namespace {

constexpr double kTreeFrom = 0.15, kTreeTo = 0.8;  // shares of the time

Error cancelled() {
    return detail::cancelled("region");
}

// What the tree is built over, and what it does not hold.
struct Contents {
    Vector<Obb> boxes;
    Vector<std::uint32_t> layers;
    Vector<world::RegionData::Item> items;
    std::optional<world::RegionSolids> solids;  // none: all are bounds
};

bool is_solid(const RegionObject& object) {
    return object.mesh != kNoIndex || object.shape != nullptr || object.only_occludes;
}

Result<void> read(Strided<RegionObject> objects, const RegionOptions& options, detail::StopSignal& stop,
                  Contents& contents) {
    if (!options.meshes.empty())
        if (auto added = contents.solids.emplace().add_meshes(options.meshes, stop); !added) return added;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (i % world::RegionSolids::kBetweenQuestions == 0 &&
            stop.is_raised(0.1 * static_cast<double>(i) / static_cast<double>(objects.size())))
            return cancelled();
        const RegionObject& object = objects[i];
        if (is_solid(object)) {
            if (!contents.solids) contents.solids.emplace();
            if (contents.items.empty()) contents.solids->reserve(objects.size());
            if (auto added = contents.solids->add(object, static_cast<std::uint32_t>(i)); !added) return added;
        } else if (auto valid = world::validate(object.bound, i, "region: an object needs a bound, a mesh or a shape");
                   !valid) {
            return valid;
        }
        contents.boxes.push_back(object.bound.box);
        contents.layers.push_back(object.layers);
        contents.items.push_back({object.user, object.bound.radius, object.collides_with, object.bound.kind});
    }
    if (!contents.solids) return {};
    return contents.solids->place(options.max_origin, contents.boxes, contents.layers, contents.items, stop);
}

template <class T>
bool have_same_bits(std::span<const T> a, std::span<const T> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

Result<boxtree::BoxTree> tree_over(std::span<const Obb> boxes, std::span<const std::uint32_t> layers,
                                   const RegionOptions& options, detail::StopSignal& stop, Executor& executor) {
    boxtree::BoxTree* const built = options.built;
    if (built != nullptr && built->item_count() == boxes.size() && have_same_bits(built->boxes(), boxes) &&
        have_same_bits(built->layer_masks(), layers))
        return std::move(*built);
    boxtree::BuildOptions build{.orientation = options.tree};
    if (options.should_stop != nullptr) {
        build.should_stop = [](void* signal, double share) {
            return static_cast<detail::StopSignal*>(signal)->is_raised(kTreeFrom + (kTreeTo - kTreeFrom) * share);
        };
        build.stop_user = &stop;
    }
    return boxtree::BoxTree::build(boxes, layers, build, executor);
}

}  // namespace

Result<Region> Region::prepare(Strided<RegionObject> objects, const RegionOptions& options, Executor& executor) {
    const std::uint64_t most = std::min<std::uint64_t>(options.max_objects, kFirstRegionIndex);
    if (objects.size() > most)
        return fail(ErrorCode::out_of_range, most,
                    {"region: ", objects.size(), " objects are more than max_objects: prepare several regions"});
    if (!(options.max_origin >= 0.0 && options.max_origin <= 0.5 * kMaxCoordinate))
        return fail(ErrorCode::out_of_range, kNoItem, "region: max_origin is not from 0 to 5e29");
    return detail::recover([&]() -> Result<Region> {
        detail::StopSignal stop(options.should_stop, options.stop_user);
        Contents contents;
        Vector<Obb>& boxes = contents.boxes;
        Vector<std::uint32_t>& layers = contents.layers;
        boxes.reserve(objects.size());
        layers.reserve(objects.size());
        contents.items.reserve(objects.size());
        if (auto done = read(objects, options, stop, contents); !done) return done.error();
        Region region;
        if (boxes.empty()) return region;
        if (stop.is_raised(kTreeFrom)) return cancelled();
        auto tree = tree_over(boxes, layers, options, stop, executor);
        if (!tree) return stop.was_raised() ? cancelled() : tree.error();
        if (stop.is_raised(kTreeTo)) return cancelled();
        auto data = Owner<world::RegionData>::make(std::move(*tree));
        data->items = std::move(contents.items);
        if (contents.solids) {
            if (!contents.solids->finish(*data, boxes.size(), stop, executor)) return cancelled();
            data->max_origin = options.max_origin;
            data->keep = options.keep;
        }
        data->common_layers = ~0u;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (i % world::RegionSolids::kBetweenQuestions == 0 && stop.is_raised(kTreeTo)) return cancelled();
            data->bounds.include(aabb_of(boxes[i]));
            data->most_radius = std::max(data->most_radius, glm::length(glm::dvec3(boxes[i].half_extents)));
            data->any_layers |= layers[i];
            data->common_layers &= layers[i];
        }
        data->most_radius *= 1.0 + 0x1p-40;  // of the root's rounding
        if (stop.is_raised(1.0)) return cancelled();
        region.data_ = data.release();
        return region;
    });
}

Region::Region() = default;
Region::~Region() {
    if (data_ == nullptr || data_->owners.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    Destroy<world::RegionData>()(const_cast<world::RegionData*>(data_));
}
Region::Region(const Region& other) : data_(other.data_) {
    if (data_ != nullptr) data_->owners.fetch_add(1, std::memory_order_relaxed);
}
Region& Region::operator=(const Region& other) {
    return *this = Region(other);
}
Region::Region(Region&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
Region& Region::operator=(Region&& other) noexcept {
    const Region old(std::move(*this));
    data_ = std::exchange(other.data_, nullptr);
    return *this;
}

std::size_t Region::object_count() const {
    return data_ != nullptr ? data_->items.size() : 0;
}

const Aabb& Region::bounds() const {
    static const Aabb kEmpty;
    return data_ != nullptr ? data_->bounds : kEmpty;
}

std::size_t Region::bytes() const {
    if (data_ == nullptr) return 0;
    const boxtree::Structure& tree = data_->tree.structure();
    std::size_t bytes = sizeof(world::RegionData) + data_->items.size() * sizeof(world::RegionData::Item) +
                        data_->tree.boxes().size_bytes() + data_->tree.layer_masks().size_bytes() +
                        tree.nodes().size_bytes() + tree.leaves().size_bytes() + tree.slot_items().size_bytes() +
                        tree.leaf_counts().size_bytes() + tree.leaf_ranges().size_bytes() +
                        tree.leaf_radii().size_bytes() + tree.node_radii().size_bytes() +
                        tree.item_slots().size_bytes() + tree.axes().size_bytes();
    bytes += std::span(data_->solid_of_item).size_bytes() + std::span(data_->solids).size_bytes() +
             std::span(data_->shapes).size_bytes() + std::span(data_->occluding).size_bytes();
    for (const world::RegionData::Mesh& mesh : data_->meshes)
        bytes += sizeof mesh + std::span(mesh.triangles.positions).size_bytes() +
                 std::span(mesh.triangles.indices).size_bytes() + std::span(mesh.shape.places).size_bytes() +
                 std::span(mesh.shape.tree.parts().nodes).size_bytes() +
                 std::span(mesh.shape.tree.parts().leaves).size_bytes();
    return bytes;
}

std::uint32_t Region::mesh_of(std::uint32_t place) const {
    const world::RegionData::Solid* const solid = data_->solid(place);
    return solid != nullptr ? solid->mesh : kNoIndex;
}

const depth::ClusteredMesh* Region::clusters_of(std::uint32_t mesh) const {
    if (data_ == nullptr || mesh >= data_->meshes.size() || !data_->meshes[mesh].clusters.usable) return nullptr;
    return &data_->meshes[mesh].clusters.cut;
}

std::span<const occlude::FoundOccluder> Region::occluders_of(std::uint32_t mesh) const {
    if (data_ == nullptr || mesh >= data_->meshes.size()) return {};
    return data_->meshes[mesh].occluders;
}

}  // namespace crofton
