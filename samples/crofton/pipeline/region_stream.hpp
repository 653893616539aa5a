// SPDX-License-Identifier: MIT
// A folder of regions as a world: those near the eye are prepared on threads that load, attached, and detached again.
#pragma once
#include <crofton/bake/region_files.hpp>
#include <crofton/crofton.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "frame_statistics.hpp"
#include "region_sets.hpp"

namespace crofton::pipeline {

// Whether a folder has an index of regions.
[[nodiscard]] bool holds_regions(const std::string& folder);

// A mesh as it is drawn. Regions of one world that have equal meshes share it.
struct RegionDrawMesh {
    TriangleMesh mesh;
    bake::MeshLook look;
    std::shared_ptr<const depth::ClusteredMesh> clusters =
        std::make_shared<const depth::ClusteredMesh>();  // empty if it was baked without
};

// A region, and what its objects draw: object i has the mesh meshes[mesh_of[i]], or none (kNoIndex).
struct StreamedRegion {
    Region region;
    std::vector<std::shared_ptr<const RegionDrawMesh>> meshes;
    std::vector<std::uint32_t> mesh_of;
    std::vector<Transform> transforms;       // relative to the region's origin
    std::vector<std::uint32_t> hidden;       // objects that no view sees, ascending
    std::shared_ptr<const RegionSets> sets;  // nullptr: none were baked, or they are not asked for
};

struct RegionStreamOptions {
    double distance = 0.0;  // regions within it are attached; 0: the size of an average region
    // Objects have their meshes, with clusters; else bounds alone, as views without occlusion need them,
    // which are loaded several times as fast.
    bool meshes = false;
    // A frame waits for the regions within the distance and attaches all of them: what is seen then depends on the eye
    // alone. Otherwise it attaches at most one, once that is prepared.
    bool waits = true;
    bool places_occluders = false;  // with `meshes`: objects have occluders; with `waits`: waits until all are placed
    unsigned loaders = 1;           // threads
    std::uint64_t largest_file = std::uint64_t{64} << 30;
    bool sets = false;  // regions have their visible sets, where there are some
};

// Regions are numbered as in the index.
class RegionStream {
  public:
    // Reads the index and starts the threads. Errors: as open_region_index; a folder without regions.
    [[nodiscard]] static Result<RegionStream> open(const std::string& folder, const RegionStreamOptions& options);
    ~RegionStream();
    RegionStream(RegionStream&&) noexcept;
    RegionStream& operator=(RegionStream&&) noexcept;

    // Attaches and detaches what an eye at this place needs, and updates the world. A region is detached beyond 1.25
    // times the distance. Errors: a region's file that is missing, damaged or another.
    [[nodiscard]] Result<StreamedFrame> follow(const glm::dvec3& eye);

    // A thread that loads frees it, so that no frame does.
    void drop(std::unique_ptr<StreamedRegion> region);

    [[nodiscard]] const World& world() const;
    [[nodiscard]] double distance() const;
    [[nodiscard]] std::span<const bake::RegionFile> index() const;
    [[nodiscard]] Aabb bounds() const;  // of all regions, in the world
    [[nodiscard]] std::uint64_t object_count() const;

    struct Attached {
        std::uint32_t first_object = 0;  // index in the World of the region's object 0
        std::uint32_t place = 0;
        const StreamedRegion* region = nullptr;
        RegionHandle handle = {};
    };
    // By first_object, ascending.
    [[nodiscard]] std::span<const Attached> attached() const;
    // Whether a thread loads the region, or it waits to be attached.
    [[nodiscard]] bool is_coming(std::uint32_t place) const;

  private:
    struct State;
    explicit RegionStream(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace crofton::pipeline
