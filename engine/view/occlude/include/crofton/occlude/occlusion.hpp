// SPDX-License-Identifier: MIT
// Occlusion culling of a view: chooses occluders, draws them into a depth buffer, and tests boxes against it.
#pragma once
#include <array>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::occlude {

// ---- Views for occlusion ----

// A view for occlusion. It maps x to (column, row, w, z) = rows · (x − origin, 1). The ray through x is the point
// (column / w, row / w) of the window [−1, 1]². z / w decreases along each ray.
//
// In a perspective view `origin` is the eye, exactly; the first three rows then have no fourth number and z is 1. In a
// parallel view w is 1.
struct OcclusionView {
    Frustum frustum;
    glm::dvec3 origin{0.0};
    std::array<std::array<double, 4>, 4> rows{};
    bool perspective = true;
    double least_w = 0.0;      // w of all points in the view is above it
    double near_radius = 0.0;  // no point of the near face is farther from the eye; perspective only
    double eye_error = 0.0;    // the eye is within this of `origin`
};

// Returns the view of a camera. Errors: as frustum_of(Camera).
[[nodiscard]] Result<OcclusionView> occlusion_view_of(const Camera& camera);

// Returns the view of a matrix, as frustum_of(matrix): perspective, parallel, off-centre, with an oblique near plane,
// reversed, with an infinite far.
//
// The eye is computed from the matrix and rounded once; it is exact if the matrix takes positions relative to the eye.
// A w that varies by a share of 1e-12 over the frustum counts as constant: a parallel view. Errors: as
// frustum_of(matrix); unsupported: no near plane; a w that is not constant, and no eye.
[[nodiscard]] Result<OcclusionView> occlusion_view_of(const glm::dmat4& to_clip, DepthRange depth,
                                                      const glm::dvec3& origin = glm::dvec3(0.0));

// ---- Choose occluders for a view ----

// The eyes that must not use an occluder: by the piece that contains it, and by that piece's open sides.
struct EyeLimits {
    Aabb left_out_within;  // around FoundOccluder::piece_bounds; empty: none
    // The sides of piece_bounds, which are not along the axes if the mesh is turned. An eye in left_out_within that is
    // beyond one of them may use the occluder. None where left_out_within is all.
    std::array<Plane, 6> piece_sides{};
    std::uint32_t piece_side_count = 0;
    // The eye must be on the inner side of all these planes (FoundOccluder::eyes_within).
    std::array<Plane, 6> planes{};
    std::uint32_t plane_count = 0;
};

// Tests whether everything that the occluder hides from this camera is hidden by the piece that contains it.
//
// That holds if the eye keeps the limits and is farther away than any point of its near plane. For a parallel view: if
// the piece is wholly beyond the near plane, and no open side faces the view. Conservative where rounding cannot
// decide. Requires a valid camera.
[[nodiscard]] bool may_use(const EyeLimits& limits, const Camera& camera);
[[nodiscard]] bool may_use(const EyeLimits& limits, const OcclusionView& view);

// An occluder's projected size, and the eyes that must not use it, in world coordinates.
struct OccluderCandidate {
    glm::dvec3 center{0.0};
    double radius = 0.0;        // of a sphere around the center that contains the occluder
    glm::vec3 half_size{0.0f};  // of its bounds along the world's axes, around the center; 0: those of the sphere
    // Seen along a unit direction d, it covers the area Σ |dot(d, areas[k])|. For a box, areas[k] is the area of the
    // faces across axis k times the axis. For a patch, areas[0] is its area times its normal; the others are 0.
    std::array<glm::vec3, 3> areas{};
    bool front_only = false;  // hides only where dot(d, areas[0]) < 0
    std::uint32_t edges = 12;
    std::uint32_t layers = ~0u;  // of the object that it belongs to: only views that draw the object may use it
    EyeLimits limits;
};

[[nodiscard]] OccluderCandidate candidate_of(const Obb& box);
// Returns the candidate of an occluder of a mesh under `transform`.
//
// A convex body counts as a cube of its surface area. A patch counts by its mean normal, and only by its front if all
// triangles have nearly that normal. If the mean is shorter than nine tenths, as for a closed mesh, it counts as a box
// with the patch's mean shadows along the axes.
[[nodiscard]] OccluderCandidate candidate_of(const FoundOccluder& found, const Transform& transform);

// Candidates by id, stored for vector kernels. Ids are 0, 1, 2, … in the order of add(), which takes as long however
// many there are.
class OccluderCandidates {
  public:
    OccluderCandidates();
    ~OccluderCandidates();
    OccluderCandidates(OccluderCandidates&&) noexcept;
    OccluderCandidates& operator=(OccluderCandidates&&) noexcept;

    // Errors leave everything unchanged: non_finite, out_of_range (coordinates beyond 1e15), with `item` the id.
    [[nodiscard]] Result<std::uint32_t> add(const OccluderCandidate& candidate);
    [[nodiscard]] Result<void> set(std::uint32_t id, const OccluderCandidate& candidate);
    void reserve(std::size_t count);
    void clear();
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] std::uint32_t layers(std::uint32_t id) const;

  private:
    friend struct CandidateStorage;
    struct Data;
    Owner<Data> data_;
};

struct ChooseBudget {
    std::uint32_t max_occluders = 256;
    std::uint32_t max_edges = (std::numeric_limits<std::uint32_t>::max)();
    // The least share of the sphere of directions, 4π, that an occluder must cover (parallel views: of the picture's
    // area); others are skipped. 2e-5 is about ten pixels of 640 × 360 at 60°.
    float least_cover = 2e-5f;
    // The bounds of the objects that may be hidden. If set, the space behind an occluder counts: the length that the
    // ray from the eye through its center continues in these bounds. So ground with nothing below is worth nothing, and
    // of two walls that look alike the nearer one is worth more.
    //
    // 25 rays are used instead, through the part of the picture where the occluder and these bounds overlap, if the
    // occluder looks large (its sphere's radius is more than a quarter of its distance, or an eighth of a parallel
    // view's picture) or nothing is behind its center: the lower part of a tall wall hides low objects. If empty,
    // occluders that cover the same area are worth the same.
    Aabb objects = {};
    std::uint32_t layer_mask = ~0u;  // only candidates that share a layer with it
};

// The chosen occluders. Keeps its memory from frame to frame.
struct OccluderChoice {
    Vector<std::uint32_t> ids;  // those worth most first; of equal worth, the lower id first

    Vector<std::uint64_t> order;  // scratch
};

// Chooses the candidates that are worth most to the view, each considered alone.
//
// The worth is the projected area over the squared distance (in a parallel view: over the picture's area), times the
// length behind. If objects are spread evenly with density n and mean shadow A, a solid angle ω with a length L behind
// hides n·A·L·ω of their solid angles on average. Any choice gives right answers; a better one hides more. Returns the
// same ids on any instruction set. Allocates nothing once `choice` and the candidates have been as large. Errors: as
// validate(Camera).
[[nodiscard]] Result<void> choose_occluders(const OccluderCandidates& candidates, const Camera& camera,
                                            const ChooseBudget& budget, OccluderChoice& choice);
void choose_occluders(const OccluderCandidates& candidates, const OcclusionView& view, const ChooseBudget& budget,
                      OccluderChoice& choice);

// The depth buffer of a view's occluders: a pixel's depth is never nearer than the occluders are anywhere in the pixel.

struct BufferSize {
    std::uint32_t width = 640, height = 360;  // pixels; 8 to 4096 each
};
// Errors: out_of_range.
[[nodiscard]] Result<void> validate(const BufferSize& size);

struct DrawStatistics {
    std::uint64_t pieces_drawn = 0;     // boxes, convex shapes, connected pieces of meshes, if the view meets them
    std::uint64_t triangles_drawn = 0;  // of meshes, surfaces, and bodies that cross the near plane
};

// A depth buffer of occluders. A pixel is covered if occluders cover its whole closed square.
//
// Its depth is then not nearer than the farthest point of the nearest surface over that square; docs/notes/occlude.md
// has the proof. Const functions may run on any number of threads at once.
class OcclusionBuffer {
  public:
    // Creates a buffer. Errors: as validate(BufferSize).
    [[nodiscard]] static Result<OcclusionBuffer> create(const BufferSize& size = {});
    ~OcclusionBuffer();
    OcclusionBuffer(OcclusionBuffer&&) noexcept;
    OcclusionBuffer& operator=(OcclusionBuffer&&) noexcept;

    // Draws all enabled occluders and replaces the previous picture. The bits are the same for any executor and
    // instruction set. Allocates nothing once it has drawn as much.
    void draw(const OccluderSet& occluders, const OcclusionView& view, Executor& executor = serial_executor());
    // Draws only these occluders, if they are enabled. Many views may draw from one set at once. Requires ids of the
    // set, each once.
    void draw(const OccluderSet& occluders, std::span<const OccluderId> chosen, const OcclusionView& view,
              Executor& executor = serial_executor());

    // Returns true only if no point of the box is visible: each ray of the view that hits the box hits an occluder
    // before it. Returns false if the box is outside the view, comes before the near plane, or is not finite.
    [[nodiscard]] bool hides(const Obb& box) const;
    // Sets bit i % 64 of word i / 64 to hides(boxes[i]). Requires one bit for each box.
    void find_hidden(std::span<const Obb> boxes, std::span<std::uint64_t> hidden,
                     Executor& executor = serial_executor()) const;
    // Lists the occluders that hide a box, ascending; the list is empty if the box is not hidden.
    //
    // If one occluder alone hides the box, it is the nearest such. Otherwise the list has occluders of two kinds: those
    // whose depth is stored in a pixel of the rectangle around the box's picture, and those that cover a pixel there
    // and have the box behind all of their faces. Slow and allocating: it draws each occluder again.
    void hidden_by(const Obb& box, Vector<OccluderId>& ids) const;

    [[nodiscard]] BufferSize size() const;
    [[nodiscard]] const OcclusionView& view() const;
    [[nodiscard]] const DrawStatistics& statistics() const;
    // Returns z / w of the view in column x and row y, counted from the left and from the bottom. If the pixel is not
    // covered, it is kUncovered, which is less than that of any visible point.
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const;
    static constexpr float kUncovered = -3e38f;
    // Reads the nearness of all pixels, row by row from the bottom. Requires width · height numbers.
    void read(std::span<float> nearness) const;
    [[nodiscard]] std::uint64_t count_covered() const;  // visits all pixels

    struct Data;
    [[nodiscard]] const Data& data() const { return *data_; }  // for the module's own kernels

  private:
    OcclusionBuffer();
    void draw(const OccluderSet& occluders, const OccluderId* chosen, std::size_t count, const OcclusionView& view,
              Executor& executor);
    Owner<Data> data_;
};

// ---- Find visible items ----

// cull's verdicts, and `occluded`: in the view, but hidden.
enum class Verdict : std::uint8_t { outside, straddling, inside, occluded };

struct VisibleStatistics {
    std::uint64_t nodes_tested = 0;   // bounds of nodes and leaves
    std::uint64_t nodes_outside = 0;  // outside the picture
    std::uint64_t nodes_hidden = 0;   // behind occluders: nothing below them was tested
    std::uint64_t items_tested = 0;
    std::uint64_t items_hidden = 0;  // behind occluders, in leaves that are not; some may be outside as well
};

// The visible items. Keep it from frame to frame: once it has grown to the largest answer, queries allocate nothing.
class VisibleSet {
  public:
    // Returns the ids, ascending; each is inside or straddling.
    [[nodiscard]] std::span<const boxtree::ItemId> ids() const { return {ids_.data(), size_}; }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return visible_.verdicts(); }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t inside_count() const { return visible_.inside_count(); }
    [[nodiscard]] const VisibleStatistics& statistics() const { return statistics_; }

  private:
    friend class VisibleQuery;
    Vector<boxtree::ItemId> ids_, candidates_, stack_;
    Vector<std::uint32_t> places_;
    Vector<Obb> boxes_;
    Vector<std::uint64_t> bits_;
    cull::VisibleSet visible_;
    VisibleStatistics statistics_;
    ResetOnMove<std::size_t> size_;
};

struct VisibleOptions {
    std::uint32_t layer_mask = ~std::uint32_t{0};
    cull::CullMode mode = cull::CullMode::exact;
    const cull::DrawLimits* limits = nullptr;            // skips items that are too small or too far
    std::span<const std::uint64_t> candidate_mask = {};  // as cull::CullOptions::candidate_mask
    bool mask_moving = false;                            // as cull::CullOptions::mask_moving
};

// Finds the items that cull::find_visible() finds in the buffer's view, without those that the buffer hides. An item is
// hidden if its box is hidden, or the bound of a node above it. Requires a buffer that has been drawn.
void find_visible(const boxtree::BoxTree& tree, const OcclusionBuffer& buffer, VisibleSet& visible,
                  const VisibleOptions& options = {});
// Tests static and moving items together. Requires the tree that `moving` was updated with.
void find_visible(const boxtree::BoxTree& resting, const cull::MovingBoxes& moving, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options = {});
// Tests a list: item i is boxes[i] with layer mask layer_masks[i], or in all layers if that span is empty.
void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options = {});

// The verdicts of a list. Bit i % 64 of word i / 64 belongs to bound i.
struct OcclusionBits {
    cull::VerdictBits frustum;  // as if there were no occluders
    Vector<std::uint64_t> occluded;

    [[nodiscard]] Verdict verdict(std::size_t i) const {
        if (occluded[i / 64] >> (i % 64) & 1) return Verdict::occluded;
        return static_cast<Verdict>(frustum.verdict(i));
    }
};

// Tests every bound of a list. Pass the `bounds` that the set was given.
void find_visible(const cull::BoxSet& set, std::span<const Obb> bounds, const OcclusionBuffer& buffer,
                  OcclusionBits& bits, cull::CullMode mode = cull::CullMode::exact,
                  Executor& executor = serial_executor());

}  // namespace crofton::occlude
