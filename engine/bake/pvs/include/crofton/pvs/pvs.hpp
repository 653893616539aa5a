// SPDX-License-Identifier: MIT
// Potentially visible sets: what can be seen from each cell, found by uniform lines before the game runs.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/scene/scene.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>

namespace crofton::pvs {

// Where eyes may be.

inline constexpr std::uint32_t kNoCell = ~std::uint32_t{0};

// The hull of eight points in world coordinates, of which some may be equal: a prism over a triangle or a quadrangle,
// say.
struct ConvexCell {
    std::array<glm::dvec3, 8> corners{};
};

struct BoxVoxels;

// Closed and convex, in world coordinates: a grid, or boxes or convex cells of the caller's, which may overlap.
class Cells {
  public:
    // `counts` equal boxes along each axis that fill `bounds`; cell (x, y, z) is x + counts.x · (y + counts.y · z).
    // Errors: bounds that are empty, not finite or flat along any axis; a count of 0; more than 2^24 cells.
    [[nodiscard]] static Result<Cells> grid(const Aabb& bounds, const glm::uvec3& counts);
    // Errors, item the box: empty, not finite, or without an area; none at all; more than 2^24.
    [[nodiscard]] static Result<Cells> boxes(std::span<const Aabb> boxes);

    // Errors, item the cell: not finite, or without a volume; none at all; more than 2^24.
    [[nodiscard]] static Result<Cells> convex(std::span<const ConvexCell> cells);

    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] Aabb box(std::size_t cell) const;  // around the cell
    [[nodiscard]] ConvexCell corners(std::size_t cell) const;
    [[nodiscard]] double surface(std::size_t cell) const;  // area
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] bool is_grid() const { return boxes_.empty(); }
    [[nodiscard]] bool is_convex() const { return !corners_.empty(); }  // made by `convex`
    // Of a convex cell: it is where all of these are at least 0, relative to its corner 0. Unit normals.
    [[nodiscard]] std::span<const Plane> planes(std::size_t cell) const;
    [[nodiscard]] const glm::uvec3& counts() const { return counts_; }  // of a grid; 0 otherwise
    // The cell that holds the point, of several the lowest; kNoCell: none does. A grid takes a few operations. Cells of
    // the caller's are listed in voxels, about one for each.
    [[nodiscard]] std::uint32_t find(const glm::dvec3& point) const;

  private:
    Aabb bounds_;
    glm::uvec3 counts_{0};
    Vector<Aabb> boxes_;  // of cells that are no grid
    std::shared_ptr<const BoxVoxels> voxels_;
    // Of convex cells:
    Vector<ConvexCell> corners_;
    Vector<double> surfaces_;
    Vector<Plane> planes_;
    Vector<std::uint32_t> plane_ends_;
};

// ---- Geometry to bake ----

// Triangles of objects, relative to `origin`: choose it near them, so that floats are fine enough.
struct BakeGeometry {
    TriangleMesh mesh;
    glm::dvec3 origin{0.0};
    Vector<std::uint32_t> object_of;  // by triangle
    Vector<Obb> boxes;                // by object, in world coordinates: around all that is drawn of it
};
// A scene as of its last update(): objects are its instances. Those that are removed, in no layer or in `moving` have
// no triangles: nothing is said about them, and they are always drawn. Errors: no triangle at all (empty).
[[nodiscard]] Result<BakeGeometry> geometry_of(const scene::Scene& scene,
                                               std::span<const scene::InstanceId> moving = {});
// 64 bits of the triangles, where they are, and whose they are. Boxes do not count.
[[nodiscard]] std::uint64_t fingerprint_of(const BakeGeometry& geometry);

// What lines find.

struct BakeOptions {
    double epsilon = 1e-4;      // of the lines through a cell: a pair that holds more is missed with at most …
    double confidence = 0.999;  // … 1 − confidence, all pairs of all cells together
    std::uint64_t seed = 1;
    // Which sides of triangles are drawn. `both`: lines end at every triangle. `front`: they pass through back faces.
    occlude::Sides sides = occlude::Sides::both;
};

// One of `count` parts of a bake, which may run on different machines.
struct Shard {
    std::uint32_t index = 0, count = 1;
};

struct RunLimits {
    double seconds = std::numeric_limits<double>::infinity();
    std::uint64_t lines = ~std::uint64_t{0};  // at least so many more, unless the shard ends
    Shard shard = {};
    StopCallback should_stop = nullptr;  // what was found by then is kept
    void* user = nullptr;
};

// What a cell is, by the lines that pass through it.
enum class CellKind : std::uint8_t {
    unknown,  // no line has passed yet
    solid,    // inside closed objects throughout, as far as lines tell: no eye belongs there, and its set is empty
    inner,    // lines from it end within the scene
    open,     // the outside is seen from it: the sky of a town, the leak of a level. A few lines that slip between two
              // triangles do not count: see docs/notes/pvs.md
};

// Uniform lines through the cells, with all crossings along each. A gap between two crossings witnesses, for each cell
// that it passes, the objects at both of its ends. Line i is a function of the seed and i. So any executor, order, stop
// and split gives the same bytes.
class Bake {
  public:
    // Errors: epsilon or confidence not within (0, 1); a triangle whose object has no box (item: the triangle); boxes
    // that fail validate(Obb) (item: the object); more than 2^34 pairs or 2^44 lines; as lines::LineTracer::build.
    [[nodiscard]] static Result<Bake> create(const BakeGeometry& geometry, const Cells& cells,
                                             const BakeOptions& options = {});
    ~Bake();
    Bake(Bake&&) noexcept;
    Bake& operator=(Bake&&) noexcept;

    // Traces what is left of a shard, up to the limits. Errors: a shard's index that is not below its count; a count of
    // 0; out of memory. What was found before is kept.
    [[nodiscard]] Result<void> run(const RunLimits& limits = {}, Executor& executor = serial_executor());
    [[nodiscard]] std::uint64_t lines_planned() const;  // for the guarantee
    [[nodiscard]] std::uint64_t lines_done() const;
    [[nodiscard]] bool is_complete() const { return lines_done() == lines_planned(); }
    // What the lines so far promise: no pair that holds more than this share of its cell's lines is missed, with the
    // confidence asked for. Above 1: nothing.
    [[nodiscard]] double epsilon_reached() const;
    [[nodiscard]] bool is_seen(std::size_t cell, std::uint32_t object) const;

    // All that is known, to be stored: the same bytes for the same lines.
    [[nodiscard]] Result<Vector<std::byte>> state() const;
    // Adds what a state of the same bake holds: a checkpoint, a part. Twice is once. Errors: damaged (parse); of
    // another scene, other cells or options (invalid_argument); then nothing has changed. States, here and below, and
    // scene files are in memory that starts at a multiple of 64, as that of bake::MappedFile and Vector.
    [[nodiscard]] Result<void> add_state(std::span<const std::byte> state);

    struct State;
    [[nodiscard]] const State& data() const { return *state_; }  // for the module's own files

  private:
    explicit Bake(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

// Parts of one bake as one: the same bytes as from a single run. Errors: none given; item, the part: damaged, or of
// another bake.
[[nodiscard]] Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states);

// Lines that a state lacks, as shards of `count`: those that must run again. Ascending. Errors: damaged; a count of 0.
[[nodiscard]] Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count);

// ---- Proofs that objects are hidden ----

// An occluder of a mesh that stands under a transform. Boxes and convex bodies prove; patches are left out.
struct PlacedOccluder {
    const occlude::FoundOccluder* occluder = nullptr;
    Transform to_world;
};

struct ProofOptions {
    // No point of a camera's near plane is farther from the eye. Bodies nearer to a cell prove nothing for it, as the
    // near plane may cut them.
    double near_radius = 0.5;
    // Halvings of a cell or an object's box, where no single body hides all of it: more prove more and take longer.
    std::uint32_t halvings = 4;
    // Above 0, what the scene's own triangles hide together is proved too: walls of a level, which are no bodies. So
    // many sides of triangles a question may visit: more prove more. 400 is a good number for levels. Each unseen
    // pair is asked, so it is slow where there are millions. Edges must have equal corners, or meet along an axis.
    std::uint32_t surface_steps = 0;
    // Once it returns true, the pairs that are not proved yet stay unseen, which draws them.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

enum class PairState : std::uint8_t {
    hidden,  // proved: what is opaque meets every segment from the cell to the object. To its box, or with
             // ProofOptions::surface_steps to its triangles
    unseen,  // no line has witnessed it, and no proof was found
    seen,    // a line has witnessed it
};

// What counts as visible. `conservative`: all that is not proved hidden; no pixel is ever wrong. `statistical`: what
// lines have seen; what is missed is below epsilon.
enum class Mode : std::uint8_t { conservative, statistical };

struct PairCounts {
    std::uint64_t hidden = 0, unseen = 0, seen = 0;
    [[nodiscard]] std::uint64_t all() const { return hidden + unseen + seen; }
};

// What a file may ask for. A byte may stand for 16,000 pairs, each of which takes a byte while the file is read.
struct ReadLimits {
    std::uint64_t pairs = std::uint64_t{1} << 30;  // of a cell and an object
};

// The finished sets. Const calls from any thread; none of those asked each frame allocates once `kept` has grown.
class Pvs {
  public:
    // Tries to prove hidden what the lines have not seen. Errors: options out of range; out of memory. Occluders that
    // are flat, or under transforms that are not valid, are left out.
    [[nodiscard]] static Result<Pvs> finish(const Bake& bake, std::span<const PlacedOccluder> occluders = {},
                                            const ProofOptions& options = {}, Executor& executor = serial_executor());

    [[nodiscard]] const Cells& cells() const { return cells_; }
    [[nodiscard]] std::uint32_t object_count() const { return objects_; }
    [[nodiscard]] CellKind kind(std::size_t cell) const { return kinds_[cell]; }
    [[nodiscard]] PairState state(std::size_t cell, std::uint32_t object) const;
    [[nodiscard]] bool is_baked(std::uint32_t object) const;  // false: it had no triangles, and is always drawn
    [[nodiscard]] PairCounts counts() const;                  // of cells that are not solid and objects that were baked
    // fingerprint_of the geometry that was baked. Sets of other triangles hide what is visible: ask before you use
    // them.
    [[nodiscard]] std::uint64_t geometry_fingerprint() const { return geometry_; }
    // Of the bake: see BakeOptions and Bake::epsilon_reached.
    [[nodiscard]] double epsilon() const { return epsilon_; }
    [[nodiscard]] double confidence() const { return confidence_; }

    // The cell to ask for an eye there; kNoCell where none holds it, or one that is solid: then draw everything.
    [[nodiscard]] std::uint32_t find_cell(const glm::dvec3& eye) const;
    // Bit o % 64 of word o / 64: object o may be seen from the cell. Objects that were not baked have theirs set.
    [[nodiscard]] std::span<const std::uint64_t> visible_from(std::uint32_t cell, Mode mode) const;
    // The set of the eye's cell, for CullOptions::candidate_mask. In a view of a World or a tree only what it holds is
    // found, and what moves. Empty, which is everything, where find_cell() says kNoCell.
    [[nodiscard]] std::span<const std::uint64_t> visible_from(const glm::dvec3& eye, Mode mode) const;
    // Keeps of `ids` (what a view has found, with or without occlusion) those that may be seen from the eye, in order.
    // Ids that are not below object_count() are kept: what came later moves. Returns the eye's cell.
    std::uint32_t keep_visible(const glm::dvec3& eye, Mode mode, std::span<const std::uint32_t> ids,
                               Vector<std::uint32_t>& kept) const;

    // A .crofton file of its own, or `scene_file` (by bake::bake) with the sets as further sections. Errors: a scene
    // file that is damaged, or that has such sections already.
    [[nodiscard]] Result<Vector<std::byte>> to_file(std::span<const std::byte> scene_file = {}) const;
    // Errors: as bake::BakedScene::open; a file without such sections (parse); more than the limits (out_of_range).
    [[nodiscard]] static Result<Pvs> open(const std::string& path, const ReadLimits& limits = {});
    // From memory that starts at a multiple of 64; copied.
    [[nodiscard]] static Result<Pvs> from_memory(std::span<const std::byte> file, const ReadLimits& limits = {});

  private:
    friend struct PvsFile;
    [[nodiscard]] std::size_t words() const { return (std::size_t{objects_} + 63) / 64; }

    Cells cells_;
    ResetOnMove<std::uint32_t> objects_;
    std::uint64_t geometry_ = 0;
    double epsilon_ = 1.0, confidence_ = 0.0;
    Vector<CellKind> kinds_;
    Vector<std::uint64_t> baked_;        // by object
    Vector<std::uint64_t> seen_, open_;  // by cell, by object: seen; not proved hidden
};

}  // namespace crofton::pvs
