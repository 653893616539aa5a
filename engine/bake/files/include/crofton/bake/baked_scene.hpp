// SPDX-License-Identifier: MIT
// Baked scenes: files that are used in place.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/scene/scene.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace crofton::bake {

// ---- Mapped files ----

// How a file is accessed.
//
// - `map`: pages are read from the file when they are used. Nobody may shorten or change the file meanwhile: reading a
//   missing part ends the program (SIGBUS on POSIX). Replacing the file, as write_file does, is safe.
// - `read`: the file is copied into memory first. Later changes to it do no harm.
enum class FileAccess : std::uint8_t { map, read };

struct FileOptions {
    FileAccess access = FileAccess::map;              // files that cannot be mapped are read
    std::uint64_t largest = std::uint64_t{64} << 30;  // bytes; a larger file is refused (out_of_range)
};

// A read-only file.
class MappedFile {
  public:
    // Opens a file. Errors name the path and the system's reason. Folders, pipes, devices and a path with a zero byte
    // are refused.
    [[nodiscard]] static Result<MappedFile> open(const std::string& path, const FileOptions& options = {});
    ~MappedFile();
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;

    // The contents, aligned to 64 bytes at least.
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  private:
    MappedFile(std::span<const std::byte> bytes, bool mapped) : bytes_(bytes), mapped_(mapped) {}
    std::span<const std::byte> bytes_;
    bool mapped_ = false;
};

// ---- Baked scenes ----

// Records of the sections. `first_…` and `…_count` are ranges of the sections positions, colors, indices, names, points
// (of polygons) and rings.
struct MeshRecord {
    Obb box;  // in the mesh's own frame
    std::uint64_t first_position = 0, first_color = 0, first_index = 0;
    std::uint32_t position_count = 0, color_count = 0, index_count = 0;
    std::uint32_t first_name = 0, name_size = 0;
    std::uint32_t polygon = scene::kNone;  // its PolygonRecord, if it is a triangulated polygon
};
struct InstanceRecord {  // both kNone if the instance was removed; its layer mask is then 0
    scene::MeshId mesh = scene::kNone;
    scene::NodeId node = scene::kNone;
};
struct NodeRecord {
    Transform world;
    scene::NodeId parent = scene::kNone;
    std::uint32_t reserved = 0;
};
struct PolygonRecord {
    glm::dvec3 origin{0.0}, u{0.0}, v{0.0};  // as in scene::PlanarPolygon
    std::uint64_t first_point = 0, first_ring = 0;
    std::uint32_t point_count = 0, ring_count = 0;
};
static_assert(sizeof(MeshRecord) == 120 && sizeof(NodeRecord) == 104 && sizeof(PolygonRecord) == 96);

// A node that hides others by occluders found at build time (occlude::find_occluders). Nodes with the same meshes are
// of one kind. The kind's occluders are in the node's frame, and lie within what the node's instances draw together.
struct OccludingNode {
    scene::NodeId node = scene::kNone;
    std::uint32_t kind = 0;
};
struct BakedOccluders {
    Vector<Vector<occlude::FoundOccluder>> kinds;
    Vector<OccludingNode> nodes;  // ascending, each once; others hide nothing
};

// How a mesh is meant to be drawn, as far as its triangles do not say it.
struct MeshLook {
    bool one_sided = false;  // back faces are not seen
    bool flat = false;       // each face has its own normal
    bool unlit = false;      // its colours are light already
    friend bool operator==(const MeshLook&, const MeshLook&) = default;
};

struct BakeOptions {
    boxtree::Orientation tree = boxtree::Orientation::aligned;
    const BakedOccluders* occluders = nullptr;  // nullptr: the file has none
    std::span<const MeshLook> looks{};          // by mesh; meshes beyond the end have the default look
    // Cuts each mesh into clusters (depth::ClusteredMesh), so that the program that opens it need not. The file then
    // has about as many bytes of clusters as of positions and indices.
    bool clusters = true;
    // For a file that becomes a region: its RegionOptions::max_origin. The tree's boxes are those that the region's
    // objects then have, a little wider than the instances', so that the region takes the tree as it is. 0: the
    // instances' boxes.
    double region_max_origin = 0.0;
};

// Bakes the scene as of its last update() into a file. Deterministic. Meshes that ClusteredMesh::cut refuses are baked
// without clusters.
//
// Errors: those of BoxTree::build; more than 2^32 − 1 name bytes; more looks than meshes; occluders that BakedScene
// would refuse (item: the occluder, counted through all kinds).
[[nodiscard]] Result<Vector<std::byte>> bake(const scene::Scene& scene, Executor& executor = serial_executor(),
                                             const BakeOptions& options = {});

struct MeshView {
    std::string_view name;
    Obb box;
    std::span<const glm::vec3> positions, colors;
    std::span<const std::uint32_t> indices;
    MeshLook look;  // the default where the file was baked without
};
// The rings around a mesh whose triangles are a triangulation. Triangle corners are indices into `points`.
struct PolygonView {
    std::span<const glm::dvec2> points;
    std::span<const std::uint32_t> ring_ends;
    glm::dvec3 origin, u, v;
};

// A baked scene. Spans point into the file and live as long as this object. Const calls from any thread.
class BakedScene {
  public:
    // Maps or reads the file, and checks all of it.
    //
    // Errors name the path and say what is damaged, too large, of another version or byte order. A mapped file must not
    // be shortened or changed meanwhile: see FileAccess.
    [[nodiscard]] static Result<BakedScene> open(const std::string& path, Executor& executor = serial_executor(),
                                                 const FileOptions& options = {});
    // Uses a file in memory. The memory starts at a multiple of 64 and outlives this object. The error is `cancelled`
    // if the callback asks to stop.
    [[nodiscard]] static Result<BakedScene> from_memory(std::span<const std::byte> file,
                                                        Executor& executor = serial_executor(),
                                                        StopCallback should_stop = nullptr, void* stop_user = nullptr);

    [[nodiscard]] std::size_t mesh_count() const { return meshes_.size(); }
    [[nodiscard]] MeshView mesh(scene::MeshId mesh) const;
    [[nodiscard]] std::optional<PolygonView> polygon(scene::MeshId mesh) const;
    [[nodiscard]] std::span<const InstanceRecord> instances() const { return instances_; }
    [[nodiscard]] std::span<const NodeRecord> nodes() const { return nodes_; }
    // Returns the occluders, or none if the file was baked without them; they can then be found again. Each number is
    // copied from the file and checked. Occluders are not checked to lie within the meshes; the baker must ensure it.
    [[nodiscard]] const std::optional<BakedOccluders>& occluders() const { return occluders_; }
    // Returns the mesh's clusters; nullptr if it was baked without. They are copied from the file and checked: each box
    // contains its triangles.
    [[nodiscard]] const depth::ClusteredMesh* clusters(scene::MeshId mesh) const;
    // Returns the tree over the instances: item i is instance i, with its box and layer mask. You may change the tree.
    [[nodiscard]] boxtree::BoxTree& tree() { return *tree_; }
    [[nodiscard]] const boxtree::BoxTree& tree() const { return *tree_; }

  private:
    [[nodiscard]] Result<void> check_meshes() const;
    [[nodiscard]] Result<void> check_instances() const;
    std::optional<MappedFile> file_;
    std::span<const MeshRecord> meshes_;
    std::span<const InstanceRecord> instances_;
    std::span<const NodeRecord> nodes_;
    std::span<const PolygonRecord> polygons_;
    std::span<const glm::vec3> positions_, colors_;
    std::span<const std::uint32_t> indices_, rings_;
    std::span<const glm::dvec2> points_;
    std::span<const char> names_;
    std::span<const std::uint8_t> looks_;
    Vector<std::optional<depth::ClusteredMesh>> clusters_;  // by mesh; empty: none
    std::optional<BakedOccluders> occluders_;
    std::optional<boxtree::BoxTree> tree_;
};

// ---- Write files atomically ----

// When a file is flushed to the disk.
//
// now: before it takes its place, which waits for the disk. later: by flush_files(), which you call once for many
// files. Until then a power cut may leave a file empty or cut; reading a .crofton file detects this by its checksums.
enum class Flush : std::uint8_t { now, later };

// Writes a file atomically: writes `bytes` to PATH.partial, flushes them to the disk, renames that file to PATH, and
// flushes the folder if the system can. The new file then survives a power cut.
//
// A full disk, a crash or a killed process leaves the old file unchanged. The next write to PATH reuses a PATH.partial
// left behind. Processes that have the old file open or mapped keep its contents, because the new file is another
// inode. Writers of one path wait for each other; the last one wins. A link stays a link, and permissions stay. If PATH
// is not a regular file (a pipe, /dev/null), it is written to directly. Errors name the path and the system's reason. A
// zero byte in the path is refused.
[[nodiscard]] Result<void> write_file(const std::string& path, std::span<const std::byte> bytes,
                                      Flush flush = Flush::now);
// Flushes files that were written with Flush::later, and their folders. Errors name the path and the system's reason;
// the other files are flushed all the same.
[[nodiscard]] Result<void> flush_files(std::span<const std::string> paths);

}  // namespace crofton::bake
