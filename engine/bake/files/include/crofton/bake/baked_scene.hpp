// SPDX-License-Identifier: MIT
// A scene as a file that is used where it lies.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
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

// `map`: pages come from the file when they are used. Nobody may shorten or change the file meanwhile: reading what was
// cut off ends the program (SIGBUS on POSIX). Replacing it, as write_file does, is safe.
// `read`: the file is copied into memory first; what then happens to it does no harm.
enum class FileAccess : std::uint8_t { map, read };

struct FileOptions {
    FileAccess access = FileAccess::map;              // where files cannot be mapped they are read
    std::uint64_t largest = std::uint64_t{64} << 30;  // bytes; a larger file is refused (out_of_range)
};

// Read-only.
class MappedFile {
  public:
    // Errors name the path and the system's reason. Folders, pipes, devices and a path with a zero byte are refused.
    [[nodiscard]] static Result<MappedFile> open(const std::string& path, const FileOptions& options = {});
    ~MappedFile();
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;

    // Aligned to 64 bytes at least.
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  private:
    MappedFile(std::span<const std::byte> bytes, bool mapped) : bytes_(bytes), mapped_(mapped) {}
    std::span<const std::byte> bytes_;
    bool mapped_ = false;
};

// ---- Baked scenes ----

// What the sections hold; `first` and `count` are ranges of the sections positions, colors, indices, names, points
// (of polygons) and rings.
struct MeshRecord {
    Obb box;  // in the mesh's own frame
    std::uint64_t first_position = 0, first_color = 0, first_index = 0;
    std::uint32_t position_count = 0, color_count = 0, index_count = 0;
    std::uint32_t first_name = 0, name_size = 0;
    std::uint32_t polygon = scene::kNone;  // its PolygonRecord, if it is a triangulated polygon
};
struct InstanceRecord {  // both kNone where the instance was removed; its layer mask is 0 then
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

// What hides others, found at build time (occlude::find_occluders). Nodes with the same meshes are of one kind, whose
// occluders are in the node's frame and within what the node's instances draw together.
struct OccludingNode {
    scene::NodeId node = scene::kNone;
    std::uint32_t kind = 0;
};
struct BakedOccluders {
    Vector<Vector<occlude::FoundOccluder>> kinds;
    Vector<OccludingNode> nodes;  // ascending, each once; others hide nothing
};

// The scene as of its last update(), and what hides others where it is given. Deterministic. Errors: what
// BoxTree::build refuses; more than 2^32 − 1 name bytes; occluders that BakedScene would refuse (item: the occluder,
// counted through all kinds).
[[nodiscard]] Result<Vector<std::byte>> bake(const scene::Scene& scene, Executor& executor = serial_executor(),
                                             boxtree::Orientation tree = boxtree::Orientation::aligned,
                                             const BakedOccluders* occluders = nullptr);

struct MeshView {
    std::string_view name;
    Obb box;
    std::span<const glm::vec3> positions, colors;
    std::span<const std::uint32_t> indices;
};
// The rings around a mesh whose triangles are a triangulation: triangle corners are indices into `points`.
struct PolygonView {
    std::span<const glm::dvec2> points;
    std::span<const std::uint32_t> ring_ends;
    glm::dvec3 origin, u, v;
};

// Spans point into the file and live as long as this. Const calls from any thread.
class BakedScene {
  public:
    // Maps the file, or reads it, and checks it whole. Errors name the path and what is damaged, too large, of another
    // version or byte order. A mapped file must not be shortened or changed meanwhile: see FileAccess.
    [[nodiscard]] static Result<BakedScene> open(const std::string& path, Executor& executor = serial_executor(),
                                                 const FileOptions& options = {});
    // From memory that starts at a multiple of 64 and outlives this.
    [[nodiscard]] static Result<BakedScene> from_memory(std::span<const std::byte> file,
                                                        Executor& executor = serial_executor());

    [[nodiscard]] std::size_t mesh_count() const { return meshes_.size(); }
    [[nodiscard]] MeshView mesh(scene::MeshId mesh) const;
    [[nodiscard]] std::optional<PolygonView> polygon(scene::MeshId mesh) const;
    [[nodiscard]] std::span<const InstanceRecord> instances() const { return instances_; }
    [[nodiscard]] std::span<const NodeRecord> nodes() const { return nodes_; }
    // None: the file was baked without, and they can be found again. Copied from the file, each number checked; that
    // they lie within the meshes is for who baked them to know.
    [[nodiscard]] const std::optional<BakedOccluders>& occluders() const { return occluders_; }
    // Over the instances: item i is instance i; its boxes() and layer masks are theirs. Yours to change.
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
    std::optional<BakedOccluders> occluders_;
    std::optional<boxtree::BoxTree> tree_;
};

// ---- Write files atomically ----

// Writes `bytes` to PATH.partial, flushes them to the disk, and renames that file to PATH. Then it flushes the folder,
// where the system can: the new file outlives a power cut. A full disk, a crash or a killed process leaves the old file
// as it was. A PATH.partial left behind is used up by the next write to PATH. Who has the old file open or mapped keeps
// its contents, since the new file is another inode. Writers of one path wait for each other; the last one wins. A link
// stays a link, permissions stay, and what is no regular file (a pipe, /dev/null) is written to directly. Errors name
// the path and the system's reason. A zero byte in the path is refused.
[[nodiscard]] Result<void> write_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace crofton::bake
