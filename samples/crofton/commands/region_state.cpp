// SPDX-License-Identifier: MIT
#include "region_state.hpp"

#include <crofton/bake/checksum.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/bake/occluder_sections.hpp>
#include <filesystem>

#include "assets/baked_source.hpp"

namespace crofton::cli {
namespace {

struct StateRecord {
    std::uint64_t key = 0;
    std::uint32_t regions = 0, reserved = 0;
};
struct DoneRecord {
    std::uint64_t checksum = 0;
    std::uint32_t place = 0, reserved = 0;
};
static_assert(sizeof(StateRecord) == 16 && sizeof(DoneRecord) == 16);

// The sums of several arrays, summed.
class Sums {
  public:
    explicit Sums(Executor& executor) : executor_(executor) {}
    template <class T>
    void add(std::span<const T> values) {
        sums_.push_back(bake::checksum(std::as_bytes(values), executor_));
    }
    [[nodiscard]] std::uint64_t sum() const { return bake::checksum(std::as_bytes(std::span(sums_)), executor_); }

  private:
    Executor& executor_;
    Vector<std::uint64_t> sums_;
};

}  // namespace

std::uint64_t region_key(const assets::SceneSource& source, std::uint32_t columns, std::uint32_t rows,
                         const bake::BakeOptions& options, Executor& executor) {
    const scene::Scene& scene = source.scene;
    Sums sums(executor);
    const std::uint32_t given[] = {CROFTON_VERSION, bake::kVersion, bake::kClustersVersion,
                                   columns,         rows,           static_cast<std::uint32_t>(options.tree),
                                   options.clusters};
    sums.add(std::span<const std::uint32_t>(given));
    for (scene::MeshId m = 0; m < scene.mesh_count(); ++m) {
        const TriangleMesh& mesh = scene.mesh(m);
        sums.add(std::span(mesh.positions));
        sums.add(std::span(mesh.colors));
        sums.add(std::span(mesh.indices));
        sums.add(std::span<const char>(scene.mesh_name(m)));
        sums.add(std::span(&scene.mesh_box(m), 1));
    }
    for (const bake::MeshLook& look : assets::looks_of(source)) {
        const std::uint8_t flags[] = {look.one_sided, look.flat, look.unlit};
        sums.add(std::span<const std::uint8_t>(flags));
    }
    std::vector<Transform> worlds(scene.node_count());
    for (scene::NodeId node = 0; node < worlds.size(); ++node)
        if (!scene.is_node_removed(node)) worlds[node] = scene.world(node);
    sums.add(std::span<const Transform>(worlds));
    std::vector<std::uint32_t> instances;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        instances.insert(instances.end(), {scene.node_of(i), scene.mesh_of(i)});
    sums.add(std::span<const std::uint32_t>(instances));
    sums.add(scene.layer_masks());
    if (options.occluders != nullptr) {
        bake::Writer occluders;  // if it refuses them, so does the bake
        if (bake::add_occluders(*options.occluders, scene.node_count(), occluders))
            sums.add(std::span<const std::byte>(occluders.finish()));
    }
    return sums.sum();
}

Result<Vector<std::byte>> to_file(const RegionState& state) {
    const StateRecord whole{.key = state.key, .regions = state.regions};
    std::vector<DoneRecord> records;
    std::vector<bake::RegionFile> files;
    for (const auto& [place, done] : state.done) {
        records.push_back({.checksum = done.checksum, .place = place});
        files.push_back(done.file);
    }
    const auto index = bake::bake_region_index(files);
    if (!index) return index.error();
    bake::Writer writer;
    writer.add("rg_state", std::span<const StateRecord>(&whole, 1));
    writer.add("rg_done", std::span<const DoneRecord>(records));
    writer.add("rg_files", std::span<const std::byte>(*index));
    return writer.finish();
}

bool is_region_state(std::span<const std::byte> file) {
    const auto reader = bake::Reader::open(file);
    return reader && reader->has("rg_state");
}

Result<RegionState> region_state_from(std::span<const std::byte> file) {
    const auto reader = bake::Reader::open(file);
    if (!reader) return reader.error();
    const auto whole = reader->section<StateRecord>("rg_state");
    if (!whole) return whole.error();
    const auto records = reader->section<DoneRecord>("rg_done");
    if (!records) return records.error();
    const auto index = reader->section<std::byte>("rg_files");
    if (!index) return index.error();
    const auto files = bake::read_region_index(*index);
    if (!files) return files.error();
    if (whole->size() != 1 || files->size() != records->size())
        return fail(ErrorCode::parse, kNoItem, "regions: the parts of the state do not fit");
    RegionState state{.key = whole->front().key, .regions = whole->front().regions, .done = {}};
    for (std::size_t i = 0; i < records->size(); ++i) {
        const DoneRecord& record = (*records)[i];
        if (record.place >= state.regions ||
            !state.done.try_emplace(record.place, RegionState::Done{(*files)[i], record.checksum}).second)
            return fail(ErrorCode::parse, i, "regions: a region is there twice, or is beyond the last");
    }
    return state;
}

Result<void> check_region_file(const std::string& folder, const RegionState::Done& done, Executor& executor) {
    const std::string path = folder + "/" + done.file.name;
    const auto file = bake::MappedFile::open(path);
    if (!file) return file.error();
    if (file->bytes().size() == done.file.bytes && bake::checksum(file->bytes(), executor) == done.checksum) return {};
    return fail(ErrorCode::parse, kNoItem, path + ": is damaged, or is not the file that was baked");
}

Result<std::vector<std::uint32_t>> merge_region_states(std::span<const std::string> names,
                                                       std::span<const std::span<const std::byte>> parts,
                                                       const std::string& out, std::uint32_t shards,
                                                       Executor& executor) {
    const std::filesystem::path path(out);
    if (path.filename() != bake::kRegionIndexName)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--out: " + out + " must be FOLDER/" + bake::kRegionIndexName + ", next to the regions' files");
    RegionState sum;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        auto part = region_state_from(parts[i]);
        if (!part) return fail(part.error().code, kNoItem, names[i] + ": " + part.error().message);
        if (i == 0) sum.key = part->key, sum.regions = part->regions;
        if (part->key != sum.key || part->regions != sum.regions)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        names[i] + ": is of another scene, or of other options, than " + names[0]);
        for (const auto& [place, done] : part->done)
            if (const auto& known = sum.done.try_emplace(place, done).first->second; known != done)
                return fail(ErrorCode::invalid_argument, kNoItem,
                            names[i] + ": has another " + done.file.name + " than a part before it");
    }
    std::vector<std::uint32_t> missing;
    for (std::uint32_t shard = 0; shard < shards; ++shard)
        for (std::uint32_t place = shard; place < sum.regions; place += shards)
            if (!sum.done.contains(place)) {
                missing.push_back(shard);
                break;
            }
    if (!missing.empty()) return missing;
    std::vector<bake::RegionFile> index;
    const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
    for (const auto& [place, done] : sum.done) {
        if (auto whole = check_region_file(folder, done, executor); !whole) return whole.error();
        index.push_back(done.file);
    }
    const auto file = bake::bake_region_index(index);
    if (!file) return file.error();
    if (auto written = bake::write_file(out, *file); !written) return written.error();
    return missing;
}

}  // namespace crofton::cli
