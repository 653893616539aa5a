// SPDX-License-Identifier: MIT
// Scenes that are split into regions: a .crofton file for each, and an index.
#pragma once
#include <crofton/bake/baked_region.hpp>
#include <crofton/core/memory.hpp>
#include <span>
#include <string>

namespace crofton::bake {

// One region of a world.
struct RegionFile {
    std::string name;        // of its .crofton file, in the index's folder
    glm::dvec3 origin{0.0};  // where it is attached
    Aabb bounds;             // around its objects, relative to the origin
    std::uint64_t objects = 0;
    std::uint64_t bytes = 0;  // of the file
};

class SharedClusters;
struct SharedClustersDeleter {
    void operator()(SharedClusters* clusters) const;
};
using SharedClustersOwner = Owner<SharedClusters, SharedClustersDeleter>;

// Splits a scene into cells of equal size along x and z, as of its last update(). Instances on one node stay together,
// in the cell of the middle of their boxes. Cells without instances have no region.
class SceneRegions {
  public:
    // The scene must live as long as this object. Error: not 1 to 1024 columns and rows (out_of_range).
    [[nodiscard]] static Result<SceneRegions> split(const scene::Scene& scene, std::uint32_t columns,
                                                    std::uint32_t rows);

    [[nodiscard]] std::size_t size() const { return parts_.size(); }
    // As it will be in the index, but for `bytes`. Row by row.
    [[nodiscard]] const RegionFile& region(std::size_t i) const { return parts_[i].file; }
    // Bakes one region, relative to its origin, with the meshes that it uses. Nodes are flat, and polygons are ordinary
    // meshes. The options are for the whole scene: its occluders and its looks. Deterministic; may be called for
    // several regions at once. Errors: as bake().
    [[nodiscard]] Result<Vector<std::byte>> bake(std::size_t i, const BakeOptions& options = {}) const;

  private:
    struct Part {
        RegionFile file;
        Vector<scene::InstanceId> instances;  // ascending
    };
    const scene::Scene* scene_ = nullptr;
    Vector<Part> parts_;
    SharedClustersOwner clusters_;  // of the scene's meshes, which are cut once for all regions
};

// Returns the index of regions as a file. Errors: a name that read_region_index would refuse.
[[nodiscard]] Result<Vector<std::byte>> bake_region_index(std::span<const RegionFile> regions);
// Reads an index that lies in memory. Errors, with the region's place as the item: damage; a name that is empty or
// leads out of the folder; an origin or bounds that are not finite.
[[nodiscard]] Result<Vector<RegionFile>> read_region_index(std::span<const std::byte> file);
// Reads an index: `folder`/index.crofton. Errors name the path.
[[nodiscard]] Result<Vector<RegionFile>> open_region_index(const std::string& folder, const FileOptions& options = {});

inline constexpr const char* kRegionIndexName = "index.crofton";

// Opens and checks a region's file, and prepares the region. Call it on a thread that loads; attach the region at
// `file.origin`. Nothing is read from the file afterwards. Errors: as BakedScene::open and prepare_region; a file of
// other size or with other instances than the index says (parse).
[[nodiscard]] Result<Region> open_region(const std::string& folder, const RegionFile& file,
                                         const BakedRegionOptions& options = {}, const FileOptions& access = {},
                                         Executor& executor = serial_executor());

}  // namespace crofton::bake
