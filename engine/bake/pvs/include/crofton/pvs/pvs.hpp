// SPDX-License-Identifier: MIT
// Potentially visible sets: the objects visible from each cell, found by uniform lines before the game runs.
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

// Cells that may contain eyes.

inline constexpr std::uint32_t kNoCell = ~std::uint32_t{0};

// A convex cell: the hull of eight points in world coordinates, of which some may be equal, such as a prism over a
// triangle or a quadrangle.
struct ConvexCell {
    std::array<glm::dvec3, 8> corners{};
};

struct BoxVoxels;

// Closed convex cells in world coordinates: a grid, or your own boxes or convex cells, which may overlap.
class Cells {
  public:
    // Makes a grid of `counts` equal boxes along each axis that fill `bounds`. Cell (x, y, z) has index x + counts.x ·
    // (y + counts.y · z). Errors: bounds that are empty, not finite or flat along any axis; a count of 0; more than
    // 2^24 cells.
    [[nodiscard]] static Result<Cells> grid(const Aabb& bounds, const glm::uvec3& counts);
    // Makes cells of boxes. Errors (item: the box): empty, not finite, or without an area; no boxes at all; more than
    // 2^24.
    [[nodiscard]] static Result<Cells> boxes(std::span<const Aabb> boxes);

    // Makes convex cells. Errors (item: the cell): not finite, or without a volume; no cells at all; more than 2^24.
    [[nodiscard]] static Result<Cells> convex(std::span<const ConvexCell> cells);

    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] Aabb box(std::size_t cell) const;  // around the cell
    [[nodiscard]] ConvexCell corners(std::size_t cell) const;
    [[nodiscard]] double surface(std::size_t cell) const;  // area
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] bool is_grid() const { return boxes_.empty(); }
    [[nodiscard]] bool is_convex() const { return !corners_.empty(); }  // made by `convex`
    // The planes of a convex cell, with unit normals. The cell is where all of them are at least 0, relative to its
    // corner 0.
    [[nodiscard]] std::span<const Plane> planes(std::size_t cell) const;
    [[nodiscard]] const glm::uvec3& counts() const { return counts_; }  // of a grid; 0 otherwise
    // Returns the cell that contains the point, the lowest if there are several, or kNoCell. A grid takes a few
    // operations. Your own cells are listed in voxels, about one per cell.
    [[nodiscard]] std::uint32_t find(const glm::dvec3& point) const;

  private:
    Aabb bounds_;
    glm::uvec3 counts_{0};
    Vector<Aabb> boxes_;  // of cells that are no grid
    std::shared_ptr<const BoxVoxels> voxels_;
    // For convex cells:
    Vector<ConvexCell> corners_;
    Vector<double> surfaces_;
    Vector<Plane> planes_;
    Vector<std::uint32_t> plane_ends_;
};

// ---- Geometry to bake ----

// The triangles of objects, relative to `origin`. Choose the origin near them, so that floats are fine enough.
struct BakeGeometry {
    TriangleMesh mesh;
    glm::dvec3 origin{0.0};
    Vector<std::uint32_t> object_of;  // by triangle
    Vector<Obb> boxes;                // by object, in world coordinates: around all that is drawn of it
};
// Returns the geometry of a scene as of its last update(); objects are its instances. Instances that are removed, in no
// layer or in `moving` have no triangles: they are not baked, and always drawn. Errors: no triangle at all (empty).
[[nodiscard]] Result<BakeGeometry> geometry_of(const scene::Scene& scene,
                                               std::span<const scene::InstanceId> moving = {});
// Returns 64 bits that depend on the triangles, their positions and their objects, but not on the boxes.
[[nodiscard]] std::uint64_t fingerprint_of(const BakeGeometry& geometry);

// Bakes: visible objects found by lines.

struct BakeOptions {
    double epsilon = 1e-4;      // of the lines through a cell: a pair that holds more is missed with at most …
    double confidence = 0.999;  // … 1 − confidence, all pairs of all cells together
    std::uint64_t seed = 1;
    // The sides of triangles that you draw. `both`: lines end at every triangle. `front`: lines pass through back
    // faces.
    occlude::Sides sides = occlude::Sides::both;
};

// One of `count` parts of a bake, which may run on different machines.
struct Shard {
    std::uint32_t index = 0, count = 1;
};

struct RunLimits {
    double seconds = std::numeric_limits<double>::infinity();
    std::uint64_t lines = ~std::uint64_t{0};  // traces at least so many more, unless the shard ends
    Shard shard = {};
    StopCallback should_stop = nullptr;  // results so far are kept
    void* user = nullptr;
};

// The kind of a cell, by the lines that pass through it.
enum class CellKind : std::uint8_t {
    unknown,  // no line has passed yet
    solid,    // inside closed objects, by all lines: no eye belongs there, and its set is empty
    inner,    // lines from it end within the scene
    open,     // sees the outside: the sky of a town, the leak of a level. A few lines that slip between two
              // triangles do not count: see docs/notes/pvs.md
};

// Traces uniform lines through the cells, with all crossings along each. A gap between two crossings witnesses, for
// each cell that it passes, the objects at both of its ends. Line i is a function of the seed and i, so any executor,
// order, stop and split gives the same bytes.
class Bake {
  public:
    // Errors: epsilon or confidence not within (0, 1); a triangle whose object has no box (item: the triangle); boxes
    // that fail validate(Obb) (item: the object); more than 2^34 pairs or 2^44 lines; as lines::LineTracer::build.
    [[nodiscard]] static Result<Bake> create(const BakeGeometry& geometry, const Cells& cells,
                                             const BakeOptions& options = {});
    ~Bake();
    Bake(Bake&&) noexcept;
    Bake& operator=(Bake&&) noexcept;

    // Traces the remaining lines of a shard, up to the limits. Errors, which keep the results so far: a shard's index
    // that is not below its count; a count of 0; out of memory.
    [[nodiscard]] Result<void> run(const RunLimits& limits = {}, Executor& executor = serial_executor());
    [[nodiscard]] std::uint64_t lines_planned() const;  // for the guarantee
    [[nodiscard]] std::uint64_t lines_done() const;
    [[nodiscard]] bool is_complete() const { return lines_done() == lines_planned(); }
    // Returns the epsilon that the lines so far guarantee: no pair that has more than this share of its cell's lines is
    // missed, with the given confidence. Above 1, nothing is guaranteed.
    [[nodiscard]] double epsilon_reached() const;
    [[nodiscard]] bool is_seen(std::size_t cell, std::uint32_t object) const;

    // Returns all results so far, to be stored: the same bytes for the same lines.
    [[nodiscard]] Result<Vector<std::byte>> state() const;
    // Adds the results in a state of the same bake, such as a checkpoint or a part. Adding one twice counts once.
    //
    // Errors, which change nothing: a damaged state (parse); a state of another scene, other cells or options
    // (invalid_argument). States, here and below, and scene files must be in memory that starts at a multiple of 64, as
    // that of bake::MappedFile and Vector does.
    [[nodiscard]] Result<void> add_state(std::span<const std::byte> state);

    struct State;
    [[nodiscard]] const State& data() const { return *state_; }  // for the module's own files

  private:
    explicit Bake(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

// Merges parts of one bake into the same bytes as those of a single run. Errors: no parts; a part that is damaged or of
// another bake (item: the part).
[[nodiscard]] Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states);

// Returns the shards of `count` whose lines a state lacks, and which must run again, ascending. Errors: a damaged
// state; a count of 0.
[[nodiscard]] Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count);

// ---- Proofs that objects are hidden ----

// An occluder of a mesh under a transform. Proofs use boxes and convex bodies, not patches.
struct PlacedOccluder {
    const occlude::FoundOccluder* occluder = nullptr;
    Transform to_world;
};

struct ProofOptions {
    // The largest distance of a point of the camera's near plane from the eye. Bodies nearer to a cell prove nothing
    // for it, because the near plane may cut them.
    double near_radius = 0.5;
    // How often a cell or an object's box is halved if no single body hides all of it. More halvings prove more and
    // take longer.
    std::uint32_t halvings = 4;
    // If above 0, proofs also use the scene's own triangles, such as the walls of a level, which are not bodies. It is
    // the number of triangle sides that a proof may visit: more prove more. 400 is a good number for levels. Each
    // unseen pair is tested, so it is slow for millions of pairs. Edges must have equal corners, or meet along an axis.
    std::uint32_t surface_steps = 0;
    // If it returns true, the pairs that are not proved yet stay unseen, so they are drawn.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

enum class PairState : std::uint8_t {
    hidden,  // proved: opaque surfaces meet every segment from the cell to the object's box, or with
             // ProofOptions::surface_steps to its triangles
    unseen,  // no line has found it, and no proof was found
    seen,    // a line has witnessed it
};

// The objects that count as visible. `conservative`: all that are not proved hidden; no pixel is ever wrong.
// `statistical`: those that lines have seen; the missed ones are below epsilon.
enum class Mode : std::uint8_t { conservative, statistical };

struct PairCounts {
    std::uint64_t hidden = 0, unseen = 0, seen = 0;
    [[nodiscard]] std::uint64_t all() const { return hidden + unseen + seen; }
};

// Limits of a file. A byte of the file may stand for 16,000 pairs, each of which takes a byte while the file is read.
struct ReadLimits {
    std::uint64_t pairs = std::uint64_t{1} << 30;  // of a cell and an object
};

// The finished sets. Const calls from any thread. Functions that are called each frame allocate nothing once `kept` has
// grown.
class Pvs {
  public:
    // Tries to prove that the unseen objects are hidden, and returns the sets. Occluders that are flat, or under
    // invalid transforms, are left out. Errors: options out of range; out of memory.
    [[nodiscard]] static Result<Pvs> finish(const Bake& bake, std::span<const PlacedOccluder> occluders = {},
                                            const ProofOptions& options = {}, Executor& executor = serial_executor());

    [[nodiscard]] const Cells& cells() const { return cells_; }
    [[nodiscard]] std::uint32_t object_count() const { return objects_; }
    [[nodiscard]] CellKind kind(std::size_t cell) const { return kinds_[cell]; }
    [[nodiscard]] PairState state(std::size_t cell, std::uint32_t object) const;
    [[nodiscard]] bool is_baked(std::uint32_t object) const;  // false: it has no triangles, and is always drawn
    [[nodiscard]] PairCounts counts() const;                  // of non-solid cells and baked objects
    // fingerprint_of the baked geometry. Sets of other triangles hide visible objects: compare it before you use them.
    [[nodiscard]] std::uint64_t geometry_fingerprint() const { return geometry_; }
    // Those of the bake: see BakeOptions and Bake::epsilon_reached.
    [[nodiscard]] double epsilon() const { return epsilon_; }
    [[nodiscard]] double confidence() const { return confidence_; }

    // Returns the cell to use for an eye, or kNoCell if no cell contains it or the cell is solid: then draw everything.
    [[nodiscard]] std::uint32_t find_cell(const glm::dvec3& eye) const;
    // Returns a bit set: bit o % 64 of word o / 64 is set if object o may be seen from the cell, or was not baked.
    [[nodiscard]] std::span<const std::uint64_t> visible_from(std::uint32_t cell, Mode mode) const;
    // Returns the set of the eye's cell, for CullOptions::candidate_mask: a view of a World or a tree then finds only
    // the objects of the set, and moving objects. It is empty, which means everything, if find_cell() returns kNoCell.
    [[nodiscard]] std::span<const std::uint64_t> visible_from(const glm::dvec3& eye, Mode mode) const;
    // Copies to `kept` those of `ids` (the result of a view, with or without occlusion) that may be seen from the eye,
    // in order. Keeps ids that are not below object_count(), because later objects move. Returns the eye's cell.
    std::uint32_t keep_visible(const glm::dvec3& eye, Mode mode, std::span<const std::uint32_t> ids,
                               Vector<std::uint32_t>& kept) const;

    // Returns a .crofton file of the sets, or `scene_file` (by bake::bake) with the sets as further sections. Errors: a
    // scene file that is damaged or already has such sections.
    [[nodiscard]] Result<Vector<std::byte>> to_file(std::span<const std::byte> scene_file = {}) const;
    // Reads sets from a file. Errors: as bake::BakedScene::open; a file without such sections (parse); more than the
    // limits (out_of_range).
    [[nodiscard]] static Result<Pvs> open(const std::string& path, const ReadLimits& limits = {});
    // Copies sets from a file in memory that starts at a multiple of 64.
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
