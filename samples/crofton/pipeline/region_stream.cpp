// SPDX-License-Identifier: MIT
#include "region_stream.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <crofton/bake/checksum.hpp>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>

namespace crofton::pipeline {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration;

constexpr double kKeep = 1.25;  // times the distance: is prepared within it, and detached beyond it

Aabb placed(const bake::RegionFile& file) {
    return {file.bounds.min + file.origin, file.bounds.max + file.origin};
}

double distance_to(const Aabb& box, const glm::dvec3& point) {
    return glm::distance(point, glm::clamp(point, box.min, box.max));
}

bool equal(const RegionDrawMesh& a, const bake::MeshView& b) {
    return std::ranges::equal(a.mesh.positions, b.positions) && std::ranges::equal(a.mesh.indices, b.indices) &&
           std::ranges::equal(a.mesh.colors, b.colors) && a.look == b.look;
}

// The meshes of all regions that are loaded, each once.
class MeshLibrary {
  public:
    // Any thread.
    std::shared_ptr<const RegionDrawMesh> find(const bake::BakedScene& scene, scene::MeshId mesh) {
        const bake::MeshView view = scene.mesh(mesh);
        const std::uint64_t sums[] = {bake::checksum(std::as_bytes(view.positions)),
                                      bake::checksum(std::as_bytes(view.indices))};
        const std::lock_guard lock(mutex_);
        auto& known = meshes_[sums[0] ^ sums[1]];
        std::erase_if(known, [](const auto& entry) { return entry.expired(); });
        for (const auto& entry : known)
            if (auto found = entry.lock(); found && equal(*found, view)) return found;
        auto made = std::make_shared<RegionDrawMesh>();
        made->mesh.positions.assign(view.positions.begin(), view.positions.end());
        made->mesh.indices.assign(view.indices.begin(), view.indices.end());
        made->mesh.colors.assign(view.colors.begin(), view.colors.end());
        made->look = view.look;
        if (const depth::ClusteredMesh* const clusters = scene.clusters(mesh))
            made->clusters = std::make_shared<const depth::ClusteredMesh>(*clusters);
        known.push_back(made);
        return made;
    }

  private:
    std::mutex mutex_;
    std::unordered_map<std::uint64_t, std::vector<std::weak_ptr<const RegionDrawMesh>>> meshes_;
};

Result<Region> prepare(bake::BakedScene&& scene, const RegionStreamOptions& options) {
    if (options.meshes)
        return bake::prepare_region(
            std::move(scene),
            {.triangles = false, .collides_with = 0, .region = {}, .occluders = options.places_occluders});
    std::vector<RegionObject> objects(scene.instances().size());
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        objects[i].bound = scene.tree().boxes()[i];
        objects[i].user = i;
        objects[i].layers = scene.tree().layer_masks()[i];
        objects[i].collides_with = 0;
    }
    return Region::prepare(objects);
}

Result<std::unique_ptr<StreamedRegion>> load(const std::string& folder, const bake::RegionFile& file,
                                             const RegionStreamOptions& options, MeshLibrary& library) {
    const std::string path = folder + "/" + file.name;
    // Read, not mapped: whoever writes the folder anew while it is flown over does no harm.
    const auto bytes =
        bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = options.largest_file});
    if (!bytes) return bytes.error();
    auto scene = bake::BakedScene::from_memory(bytes->bytes());
    if (!scene) return fail(scene.error().code, scene.error().item, path + ": " + scene.error().message);
    if (scene->instances().size() != file.objects || bytes->bytes().size() != file.bytes)
        return fail(ErrorCode::parse, kNoItem, path + ": is not the file that the index names");
    auto result = std::make_unique<StreamedRegion>();
    for (scene::MeshId mesh = 0; mesh < scene->mesh_count(); ++mesh)
        result->meshes.push_back(library.find(*scene, mesh));
    for (const bake::InstanceRecord& instance : scene->instances()) {
        result->mesh_of.push_back(instance.mesh);
        result->transforms.push_back(instance.node == scene::kNone ? Transform() : scene->nodes()[instance.node].world);
    }
    const auto layers = scene->tree().layer_masks();
    for (std::uint32_t i = 0; i < layers.size(); ++i)
        if (layers[i] == 0) result->hidden.push_back(i);
    if (options.sets) {
        auto sets = load_region_sets(folder, file, bake::checksum(bytes->bytes()), options.largest_file);
        if (!sets) return sets.error();
        result->sets = std::move(*sets);
    }
    auto region = prepare(std::move(*scene), options);
    if (!region) return fail(region.error().code, region.error().item, path + ": " + region.error().message);
    result->region = std::move(*region);
    return result;
}

}  // namespace

struct RegionStream::State {
    enum class Stage : std::uint8_t { away, loading, ready, attached };
    struct Slot {
        Stage stage = Stage::away;
        Aabb bounds;
        double distance = 0.0;  // from the eye
        double load_ms = 0.0;
        std::unique_ptr<StreamedRegion> region;
        RegionHandle handle;
    };

    std::string folder;
    RegionStreamOptions options;
    Vector<bake::RegionFile> index;
    World world{{.pairs = false}};
    std::vector<Attached> attached;
    MeshLibrary library;

    mutable std::mutex mutex;  // guards what follows; attached regions are only touched by the game's thread
    std::condition_variable wanted, loaded;
    std::vector<Slot> slots;
    std::vector<std::uint32_t> queue;                      // to load; the next one last
    std::vector<std::unique_ptr<StreamedRegion>> dropped;  // to be freed by a thread that loads
    std::optional<Error> failed;
    bool stops = false;
    std::vector<std::thread> threads;

    ~State() {
        {
            const std::lock_guard lock(mutex);
            stops = true;
        }
        wanted.notify_all();
        for (std::thread& thread : threads) thread.join();
    }

    void run_loader() {
        std::unique_lock lock(mutex);
        while (true) {
            wanted.wait(lock, [&] { return stops || !queue.empty() || !dropped.empty(); });
            if (stops) return;
            if (queue.empty()) {
                const auto last = std::move(dropped.back());
                dropped.pop_back();
                lock.unlock();  // frees without the lock: `last` goes at the end of this block
            } else {
                const std::uint32_t place = queue.back();
                queue.pop_back();
                slots[place].stage = Stage::loading;
                lock.unlock();
                const auto start = Clock::now();
                auto region = load(folder, index[place], options, library);
                const double ms = duration<double, std::milli>(Clock::now() - start).count();
                lock.lock();
                Slot& slot = slots[place];
                slot.load_ms = ms;
                slot.stage = region ? Stage::ready : Stage::away;
                if (region)
                    slot.region = std::move(*region);
                else
                    failed = region.error();
                loaded.notify_all();
                continue;
            }
            lock.lock();
        }
    }

    // Asks for what is near and not there, the nearest first; forgets what was prepared and is far again.
    void plan(const glm::dvec3& eye) {
        queue.clear();
        for (std::uint32_t place = 0; place < slots.size(); ++place) {
            Slot& slot = slots[place];
            slot.distance = distance_to(slot.bounds, eye);
            const bool is_near = slot.distance <= kKeep * options.distance;
            if (slot.stage == Stage::away && is_near) queue.push_back(place);
            if (slot.stage == Stage::ready && !is_near) {
                dropped.push_back(std::move(slot.region));
                slot.stage = Stage::away;
            }
        }
        std::sort(queue.begin(), queue.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(slots[a].distance, a) > std::pair(slots[b].distance, b);
        });
    }

    [[nodiscard]] bool is_needed(const Slot& slot) const {
        return slot.distance <= options.distance && slot.stage != Stage::attached;
    }
    [[nodiscard]] bool has_what_is_needed() const {
        return std::all_of(slots.begin(), slots.end(),
                           [&](const Slot& slot) { return !is_needed(slot) || slot.stage == Stage::ready; });
    }

    // Those to attach now, the nearest first.
    [[nodiscard]] std::vector<std::uint32_t> arriving() const {
        std::vector<std::uint32_t> places;
        for (std::uint32_t place = 0; place < slots.size(); ++place)
            if (is_needed(slots[place]) && slots[place].stage == Stage::ready) places.push_back(place);
        std::sort(places.begin(), places.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(slots[a].distance, a) < std::pair(slots[b].distance, b);
        });
        if (!options.waits && places.size() > 1) places.erase(places.begin() + 1, places.end());
        return places;
    }

    Result<void> attach(std::uint32_t place) {
        Slot& slot = slots[place];
        const auto handle = world.attach(slot.region->region, index[place].origin);
        if (!handle)
            return fail(handle.error().code, handle.error().item, index[place].name + ": " + handle.error().message);
        slot.handle = *handle;
        slot.stage = Stage::attached;
        const auto first = slot.region->region.object_count() > 0 ? world.object_in(*handle, 0) : ObjectHandle{};
        if (!first) return first.error();
        const Attached entry{first->index, place, slot.region.get(), *handle};
        attached.insert(
            std::upper_bound(attached.begin(), attached.end(), entry,
                             [](const Attached& a, const Attached& b) { return a.first_object < b.first_object; }),
            entry);
        return {};
    }

    // Detaches what is far; the regions are freed only after the World has let go of them.
    Result<std::vector<std::unique_ptr<StreamedRegion>>> detach_far() {
        std::vector<std::unique_ptr<StreamedRegion>> gone;
        for (Slot& slot : slots) {
            if (slot.stage != Stage::attached || slot.distance <= kKeep * options.distance) continue;
            if (auto done = world.detach(slot.handle); !done) return done.error();
            std::erase_if(attached, [&](const Attached& entry) { return entry.region == slot.region.get(); });
            gone.push_back(std::move(slot.region));
            slot.stage = Stage::away;
        }
        return gone;
    }
};

bool holds_regions(const std::string& folder) {
    std::error_code ignored;
    return std::filesystem::exists(std::filesystem::path(folder) / bake::kRegionIndexName, ignored);
}

RegionStream::RegionStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
RegionStream::~RegionStream() = default;
RegionStream::RegionStream(RegionStream&&) noexcept = default;
RegionStream& RegionStream::operator=(RegionStream&&) noexcept = default;

Result<RegionStream> RegionStream::open(const std::string& folder, const RegionStreamOptions& options) {
    auto index = bake::open_region_index(folder, {.largest = options.largest_file});
    if (!index) return index.error();
    if (index->empty()) return fail(ErrorCode::empty, kNoItem, folder + ": has no regions");
    auto state = std::make_unique<State>();
    state->folder = folder;
    state->options = options;
    double size = 0.0;
    for (const bake::RegionFile& file : *index) {
        State::Slot& slot = state->slots.emplace_back();
        slot.bounds = placed(file);
        const glm::dvec3 half = slot.bounds.half_extents();
        size += 2.0 * std::max(half.x, half.z) / static_cast<double>(index->size());
    }
    state->index = std::move(*index);
    if (!(options.distance > 0.0)) state->options.distance = size;
    State* const shared = state.get();
    for (unsigned i = 0; i < std::max(1u, options.loaders); ++i)
        state->threads.emplace_back([shared] { shared->run_loader(); });
    return RegionStream(std::move(state));
}

Result<StreamedFrame> RegionStream::follow(const glm::dvec3& eye) {
    State& s = *state_;
    StreamedFrame frame;
    std::unique_lock lock(s.mutex);
    s.plan(eye);
    s.wanted.notify_all();
    const auto asked = Clock::now();
    if (s.options.waits) s.loaded.wait(lock, [&] { return s.failed || s.has_what_is_needed(); });
    if (s.failed) return *s.failed;
    const auto start = Clock::now();
    frame.wait_us = duration<double, std::micro>(start - asked).count();
    auto gone = s.detach_far();
    if (!gone) return gone.error();
    frame.went = gone->size();
    for (const std::uint32_t place : s.arriving()) {
        if (auto done = s.attach(place); !done) return done.error();
        frame.longest_load_ms = std::max(frame.longest_load_ms, s.slots[place].load_ms);
        ++frame.came;
    }
    do {
        if (auto updated = s.world.update(); !updated) return updated.error();
    } while (s.options.waits && s.options.places_occluders && s.world.statistics().occluders_waiting > 0);
    frame.attach_us = duration<double, std::micro>(Clock::now() - start).count();
    frame.attached = s.attached.size();
    if (!gone->empty()) {
        std::move(gone->begin(), gone->end(), std::back_inserter(s.dropped));
        s.wanted.notify_one();
    }
    return frame;
}

void RegionStream::drop(std::unique_ptr<StreamedRegion> region) {
    const std::lock_guard lock(state_->mutex);
    state_->dropped.push_back(std::move(region));
    state_->wanted.notify_one();
}

const World& RegionStream::world() const {
    return state_->world;
}
double RegionStream::distance() const {
    return state_->options.distance;
}
std::span<const bake::RegionFile> RegionStream::index() const {
    return state_->index;
}
Aabb RegionStream::bounds() const {
    Aabb bounds;
    for (const State::Slot& slot : state_->slots) bounds.include(slot.bounds);
    return bounds;
}
std::uint64_t RegionStream::object_count() const {
    std::uint64_t count = 0;
    for (const bake::RegionFile& file : state_->index) count += file.objects;
    return count;
}
std::span<const RegionStream::Attached> RegionStream::attached() const {
    return state_->attached;
}
bool RegionStream::is_coming(std::uint32_t place) const {
    const std::lock_guard lock(state_->mutex);
    const State::Stage stage = state_->slots[place].stage;
    return stage == State::Stage::loading || stage == State::Stage::ready;
}

}  // namespace crofton::pipeline
