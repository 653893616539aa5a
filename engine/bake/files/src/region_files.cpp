// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/bake/container.hpp>
#include <crofton/bake/region_files.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/geometry/finite.hpp>
#include <limits>
#include <string_view>

#include "mesh_sections.hpp"

namespace crofton::bake {
namespace {

using scene::InstanceId;

// A record of the section "regions"; names are in the section "names".
struct RegionRecord {
    glm::dvec3 origin{0.0}, low{0.0}, high{0.0};
    std::uint64_t objects = 0, bytes = 0;
    std::uint32_t first_name = 0, name_size = 0;
};
static_assert(sizeof(RegionRecord) == 96);

// A name in the index's own folder, on any system.
bool is_plain_name(std::string_view name) {
    return !name.empty() && name != "." && name != ".." && name.find_first_of("/\\:") == std::string_view::npos &&
           name.find('\0') == std::string_view::npos;
}

Result<void> check(const RegionFile& region, std::uint64_t item) {
    if (!is_plain_name(region.name))
        return fail(ErrorCode::parse, item, "regions: the name of a file is empty or leads out of the folder");
    if (!is_finite(region.origin) || !is_finite(region.bounds.min) || !is_finite(region.bounds.max))
        return fail(ErrorCode::non_finite, item, "regions: an origin or bounds are NaN or infinite");
    return {};
}

// Cells between these, of a size that is not 0.
struct Cells {
    double low = 0.0, size = 1.0;
    std::uint32_t count = 1;

    Cells(double from, double to, std::uint32_t the_count)
        : low(from), size((to - from) / the_count), count(the_count) {
        if (!(size > 0.0)) size = 1.0;
    }
    [[nodiscard]] std::uint32_t cell_of(double x) const {
        return static_cast<std::uint32_t>(std::clamp(std::floor((x - low) / size), 0.0, count - 1.0));
    }
    // The middle of a cell, of few digits, so that coordinates relative to it are seldom rounded.
    [[nodiscard]] double middle(std::uint32_t cell) const {
        const double unit = std::exp2(std::floor(std::log2(size)) - 4.0);
        return std::round((low + (cell + 0.5) * size) / unit) * unit;
    }
};

// The instances' boxes, by node.
Vector<Aabb> bounds_of_nodes(const scene::Scene& scene) {
    Vector<Aabb> bounds(scene.node_count());
    for (InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i)) bounds[scene.node_of(i)].include(aabb_of(scene.world_boxes()[i]));
    return bounds;
}

// The sections of a region's file besides its scene, indexed by the whole scene's meshes and nodes.
struct PartMaps {
    Vector<scene::MeshId> mesh_of, old_mesh;  // by old mesh; by new mesh
    Vector<scene::NodeId> node_of;            // by old node
};

BakedOccluders occluders_of(const BakedOccluders& all, const PartMaps& maps) {
    BakedOccluders result;
    Vector<std::uint32_t> kind_of(all.kinds.size(), scene::kNone);
    for (const OccludingNode& occluding : all.nodes) {
        const scene::NodeId node = maps.node_of[occluding.node];
        if (node == scene::kNone) continue;
        std::uint32_t& kind = kind_of[occluding.kind];
        if (kind == scene::kNone) {
            kind = static_cast<std::uint32_t>(result.kinds.size());
            result.kinds.push_back(all.kinds[occluding.kind]);
        }
        result.nodes.push_back({node, kind});
    }
    std::sort(result.nodes.begin(), result.nodes.end(),
              [](const OccludingNode& a, const OccludingNode& b) { return a.node < b.node; });
    return result;
}

}  // namespace

void SharedClustersDeleter::operator()(SharedClusters* clusters) const {
    Destroy<SharedClusters>()(clusters);
}

Result<SceneRegions> SceneRegions::split(const scene::Scene& scene, std::uint32_t columns, std::uint32_t rows) {
    constexpr std::uint32_t kMost = 1024;
    if (columns < 1 || columns > kMost || rows < 1 || rows > kMost)
        return fail(ErrorCode::out_of_range, kNoItem, "regions: there are 1 to 1024 columns and rows");
    return detail::recover([&]() -> Result<SceneRegions> {
        const Vector<Aabb> bounds = bounds_of_nodes(scene);
        Aabb middles;
        for (const Aabb& of_node : bounds)
            if (!of_node.is_empty()) middles.include(of_node.center());
        SceneRegions result;
        result.scene_ = &scene;
        result.clusters_ = SharedClustersOwner(Owner<SharedClusters>::make(scene.mesh_count()).release());
        if (middles.is_empty()) return result;
        const Cells x(middles.min.x, middles.max.x, columns), z(middles.min.z, middles.max.z, rows);
        Vector<Part> parts(std::size_t{columns} * rows);
        for (InstanceId i = 0; i < scene.instance_count(); ++i) {
            if (scene.is_removed(i)) continue;
            const glm::dvec3 middle = bounds[scene.node_of(i)].center();
            const std::uint32_t column = x.cell_of(middle.x), row = z.cell_of(middle.z);
            Part& part = parts[std::size_t{row} * columns + column];
            if (part.instances.empty()) {
                part.file.name = "r" + std::to_string(column) + "_" + std::to_string(row) + ".crofton";
                part.file.origin = {x.middle(column), 0.0, z.middle(row)};
            }
            part.instances.push_back(i);
            Aabb box = aabb_of(scene.world_boxes()[i]);
            part.file.bounds.include(Aabb{box.min - part.file.origin, box.max - part.file.origin});
            ++part.file.objects;
        }
        for (Part& part : parts)
            if (!part.instances.empty()) result.parts_.push_back(std::move(part));
        return result;
    });
}

Result<Vector<std::byte>> SceneRegions::bake(std::size_t i, const BakeOptions& options) const {
    return detail::recover([&]() -> Result<Vector<std::byte>> {
        const Part& part = parts_[i];
        const scene::Scene& whole = *scene_;
        PartMaps maps;
        maps.mesh_of.assign(whole.mesh_count(), scene::kNone);
        maps.node_of.assign(whole.node_count(), scene::kNone);
        scene::Scene scene;
        for (const InstanceId instance : part.instances) {
            scene::MeshId& mesh = maps.mesh_of[whole.mesh_of(instance)];
            if (mesh == scene::kNone) {
                const auto added =
                    scene.add_mesh(whole.mesh(whole.mesh_of(instance)), whole.mesh_name(whole.mesh_of(instance)));
                if (!added) return added.error();
                mesh = *added;
                maps.old_mesh.push_back(whole.mesh_of(instance));
            }
            scene::NodeId& node = maps.node_of[whole.node_of(instance)];
            if (node == scene::kNone) {
                Transform transform = whole.world(whole.node_of(instance));
                transform.translation -= part.file.origin;
                const auto added = scene.add_node(scene::kNone, transform);
                if (!added) return added.error();
                node = *added;
            }
            const auto added = scene.add_instance(node, mesh);
            if (!added) return added.error();
            if (auto set = scene.set_instance_layers(*added, whole.layer_masks()[instance]); !set) return set.error();
        }
        scene.update();
        BakeOptions of_part = options;
        Vector<MeshLook> looks;
        for (const scene::MeshId old : maps.old_mesh)
            looks.push_back(old < options.looks.size() ? options.looks[old] : MeshLook());
        BakedOccluders occluders;
        if (options.occluders != nullptr) occluders = occluders_of(*options.occluders, maps);
        of_part.region_max_origin = RegionOptions().max_origin;
        of_part.looks = looks;
        of_part.occluders = options.occluders != nullptr ? &occluders : nullptr;
        return bake::bake(scene, serial_executor(), of_part, {clusters_.get(), maps.old_mesh});
    });
}

Result<Vector<std::byte>> bake_region_index(std::span<const RegionFile> regions) {
    return detail::recover([&]() -> Result<Vector<std::byte>> {
        Vector<RegionRecord> records;
        Vector<char> names;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const RegionFile& region = regions[i];
            if (auto good = check(region, i); !good) return good.error();
            records.push_back({region.origin, region.bounds.min, region.bounds.max, region.objects, region.bytes,
                               static_cast<std::uint32_t>(names.size()),
                               static_cast<std::uint32_t>(region.name.size())});
            names.insert(names.end(), region.name.begin(), region.name.end());
        }
        Writer writer;
        writer.add("regions", std::span<const RegionRecord>(records));
        writer.add("names", std::span<const char>(names));
        return writer.finish();
    });
}

Result<Vector<RegionFile>> read_region_index(std::span<const std::byte> file) {
    return detail::recover([&]() -> Result<Vector<RegionFile>> {
        const auto reader = Reader::open(file);
        if (!reader) return reader.error();
        const auto records = reader->section<RegionRecord>("regions");
        if (!records) return records.error();
        const auto names = reader->section<char>("names");
        if (!names) return names.error();
        Vector<RegionFile> regions;
        for (std::size_t i = 0; i < records->size(); ++i) {
            const RegionRecord& record = (*records)[i];
            if (record.first_name > names->size() || record.name_size > names->size() - record.first_name)
                return fail(ErrorCode::parse, i, "regions: a name is not in the file");
            RegionFile& region = regions.emplace_back();
            region.name.assign(names->data() + record.first_name, record.name_size);
            region.origin = record.origin;
            region.bounds = {record.low, record.high};
            region.objects = record.objects;
            region.bytes = record.bytes;
            if (auto good = check(region, i); !good) return good.error();
        }
        return regions;
    });
}

Result<Vector<RegionFile>> open_region_index(const std::string& folder, const FileOptions& options) {
    const std::string path = folder + "/" + kRegionIndexName;
    const auto file = MappedFile::open(path, options);
    if (!file) return file.error();
    auto regions = read_region_index(file->bytes());
    if (!regions && regions.error().code != ErrorCode::out_of_memory)
        return fail(regions.error().code, regions.error().item, {path, ": ", regions.error().message});
    return regions;
}

Result<Region> open_region(const std::string& folder, const RegionFile& file, const BakedRegionOptions& options,
                           const FileOptions& access, Executor& executor) {
    if (auto good = check(file, kNoItem); !good) return good.error();
    const std::string path = folder + "/" + file.name;
    const auto mapped = MappedFile::open(path, access);
    if (!mapped) return mapped.error();
    if (mapped->bytes().size() != file.bytes)
        return fail(ErrorCode::parse, kNoItem, {path, ": is not the file that the index names: its size is another"});
    constexpr double kRead = 0.35;  // of the time
    detail::PartOfStop reading{options.region.should_stop, options.region.stop_user, 0.0, kRead};
    detail::PartOfStop preparing{options.region.should_stop, options.region.stop_user, kRead, 1.0};
    auto baked = BakedScene::from_memory(mapped->bytes(), executor, detail::PartOfStop::ask, &reading);
    if (!baked && baked.error().code == ErrorCode::cancelled) return baked.error();
    if (!baked) return fail(baked.error().code, baked.error().item, {path, ": ", baked.error().message});
    if (baked->instances().size() != file.objects)
        return fail(ErrorCode::parse, kNoItem,
                    {path, ": is not the file that the index names: it has ", baked->instances().size(), " instances"});
    BakedRegionOptions prepared = options;
    prepared.region.should_stop = detail::PartOfStop::ask;
    prepared.region.stop_user = &preparing;
    auto region = prepare_region(std::move(*baked), prepared, executor);
    if (!region && region.error().code != ErrorCode::out_of_memory && region.error().code != ErrorCode::cancelled)
        return fail(region.error().code, region.error().item, {path, ": ", region.error().message});
    return region;
}

}  // namespace crofton::bake
