// SPDX-License-Identifier: MIT
// Inputs of a World: handles, views of the caller's memory, descriptions of objects, requests of views.
#pragma once
#include <array>
#include <compare>
#include <crofton/core/version.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <type_traits>

namespace crofton {

namespace convex {
class Body;
}  // namespace convex

// Names of things in a World: an index that is used again, and a generation that tells its users apart.

inline constexpr std::uint32_t kNoIndex = ~std::uint32_t{0};

// Indices are dense: below the largest number of things that lived at once, so that they may index the caller's own
// arrays. An object's index is free again after the next update; those removed since the last one count as well. Nodes
// share their indices with the objects that have a transform or no node. A handle whose thing has been removed is
// stale: calls that take it fail with ErrorCode::stale_handle. So do calls that are given a handle of another World:
// generations begin elsewhere in each World of the process, 1 in the first. They are never 0, so {0, 0} is no one's
// handle. Generations come back after 2^32 - 1 removals of one index; those of n Worlds lie at least 2^32 / 3 n apart.
template <class Tag>
struct Handle {
    std::uint32_t index = kNoIndex;
    std::uint32_t generation = 0;

    [[nodiscard]] bool is_null() const { return index == kNoIndex; }
    auto operator<=>(const Handle&) const = default;
};

using ObjectHandle = Handle<struct ObjectTag>;
using NodeHandle = Handle<struct NodeTag>;
using MeshHandle = Handle<struct MeshTag>;

// ---- Views of the caller's memory ----

// `size` values of type T in the caller's memory, `stride` bytes apart: a span, or a member of an array of structs.
template <class T>
class Strided {
  public:
    Strided() = default;
    Strided(const T* first, std::size_t size, std::size_t stride = sizeof(T))
        : first_(reinterpret_cast<const std::byte*>(first)), size_(size), stride_(stride) {}
    template <class Range>
    requires std::is_convertible_v<const Range&, std::span<const T>> Strided(const Range& range)
        : Strided(std::span<const T>(range).data(), std::span<const T>(range).size()) {}

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t stride() const { return stride_; }
    [[nodiscard]] const T& operator[](std::size_t i) const { return *reinterpret_cast<const T*>(first_ + i * stride_); }

  private:
    const std::byte* first_ = nullptr;
    std::size_t size_ = 0, stride_ = sizeof(T);
};

// Points of three floats or three doubles each, at any alignment.
class PointsView {
  public:
    PointsView() = default;
    PointsView(const float* first, std::size_t size, std::size_t stride = 3 * sizeof(float))
        : PointsView(first, size, stride, false) {}
    PointsView(const double* first, std::size_t size, std::size_t stride = 3 * sizeof(double))
        : PointsView(first, size, stride, true) {}
    template <class Range>
    requires std::is_convertible_v<const Range&, std::span<const glm::vec3>> PointsView(const Range& range)
        : PointsView(std::span<const glm::vec3>(range).data(), std::span<const glm::vec3>(range).size(),
                     sizeof(glm::vec3), false) {}
    template <class Range>
    requires std::is_convertible_v<const Range&, std::span<const glm::dvec3>> PointsView(const Range& range)
        : PointsView(std::span<const glm::dvec3>(range).data(), std::span<const glm::dvec3>(range).size(),
                     sizeof(glm::dvec3), true) {}

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] glm::vec3 operator[](std::size_t i) const;  // rounded to float

  private:
    PointsView(const void* first, std::size_t size, std::size_t stride, bool is_double)
        : first_(static_cast<const std::byte*>(first)), size_(size), stride_(stride), is_double_(is_double) {}

    const std::byte* first_ = nullptr;
    std::size_t size_ = 0, stride_ = 0;
    bool is_double_ = false;
};

// Indices of 16 or 32 bits.
class IndicesView {
  public:
    IndicesView() = default;
    IndicesView(const std::uint16_t* first, std::size_t size) : short_(first), size_(size) {}
    IndicesView(const std::uint32_t* first, std::size_t size) : long_(first), size_(size) {}
    template <class Range>
    requires std::is_convertible_v<const Range&, std::span<const std::uint16_t>> IndicesView(const Range& range)
        : IndicesView(std::span<const std::uint16_t>(range).data(), std::span<const std::uint16_t>(range).size()) {}
    template <class Range>
    requires std::is_convertible_v<const Range&, std::span<const std::uint32_t>> IndicesView(const Range& range)
        : IndicesView(std::span<const std::uint32_t>(range).data(), std::span<const std::uint32_t>(range).size()) {}

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::uint32_t operator[](std::size_t i) const { return short_ ? short_[i] : long_[i]; }

  private:
    const std::uint16_t* short_ = nullptr;
    const std::uint32_t* long_ = nullptr;
    std::size_t size_ = 0;
};

// A mesh in its own frame; World copies what it needs. Three indices a triangle (a, b, c). Without any, three positions
// are one. Outside is where cross(b − a, c − a) points: triangles are counter-clockwise seen from there
// in right-handed coordinates, clockwise in left-handed ones.
struct MeshDescription {
    PointsView positions = {};
    IndicesView indices = {};
    // Rays and contacts ask the triangles. False spares memory and time: the mesh's box stands for it.
    bool triangles = true;
    // True: World::find_occluders, with its defaults, at once. What is found hides other objects; ask it of opaque
    // meshes alone. A second or more for 100,000 triangles.
    bool occluders = false;
    // True: views that ask for a picture list the mesh's triangles, in clusters (World::clusters_of).
    bool clusters = false;
    // With clusters: the renderer drops back faces, so they are not listed. Of mirrored objects both sides are.
    bool one_sided = false;
};

struct NodeDescription {
    NodeHandle parent = {};      // null: none
    Transform transform = {};    // relative to the parent
    std::uint32_t layers = ~0u;  // of all below: an object is in those that it and all nodes above it have
};

enum class BoundKind : std::uint8_t { none, box, aligned_box, sphere };

// A bound without a mesh.
struct Bound {
    BoundKind kind = BoundKind::none;
    Obb box;              // around the sphere, for a sphere
    double radius = 0.0;  // of a sphere

    Bound() = default;
    Bound(const Obb& oriented) : kind(BoundKind::box), box(oriented) {}
    Bound(const Aabb& aligned);  // rounded outward to an Obb; an empty one is refused
    Bound(const Sphere& sphere);
};

// A mesh or a body, which `transform` places under `node` or in the world; or a bound in the world's coordinates.
struct ObjectDescription {
    MeshHandle mesh = {};
    NodeHandle node = {};
    std::optional<Transform> transform = {};  // none: the node's own
    Bound bound = {};
    // As World::set_body. An object with neither mesh nor bound needs nothing else: its box is the body's, and
    // set_transform moves it. The box of ground without end is a point then, so views seldom list it.
    const convex::Body* body = nullptr;
    std::uint64_t user = 0;      // given back with every answer
    std::uint32_t layers = ~0u;  // views and queries ask for layers
    std::uint32_t collides_with =
        ~0u;  // two objects may be a pair where each one's layers meet what the other's has here
    // For an object with a mesh. False: it hides nothing, as where it is drawn transparent.
    bool occludes = true;
    // For an object with a mesh. True: it is in no answer, and hides what its mesh's occluders hide. An engine whose
    // objects are bounds adds its occluders so; they must lie within what it draws in the same layers.
    bool only_occludes = false;
};

// How a view leaves out what other objects hide.
struct OcclusionOptions {
    occlude::BufferSize size = {480, 270};  // pixels of the depth buffer; more find more and cost more
    std::uint32_t max_occluders = 256;      // at most so many are drawn: those that are worth most to the view
    float least_cover = 2e-5f;              // of the sphere of directions: smaller occluders are not drawn
    bool list_occluded = false;             // also list what is hidden, which costs a second query
};

// An engine's own view: the matrix that takes world positions, relative to `origin`, to clip space. The engine's
// numbers become a dmat4 by matrix_of (crofton/geometry/camera.hpp).
struct ViewMatrix {
    glm::dmat4 to_clip{1.0};
    DepthRange depth = DepthRange::reversed_zero_to_one;
    glm::dvec3 origin{0.0};
};

// A view that World::view answers.
struct ViewRequest {
    // Where the view looks from: set a camera, a matrix or a volume.
    std::optional<Camera> camera = {};
    std::optional<ViewMatrix> matrix = {};
    // Any convex volume, such as a shadow's. It has no eye: for occlusion set a camera or a matrix as well, and objects
    // are tested against the volume instead of theirs.
    std::optional<Frustum> volume = {};

    std::uint32_t layers = ~0u;  // lists objects that share a layer with these
    // If set, objects that others hide are left out: never one that is seen (docs/occlude.md). An object hides with its
    // mesh's occluders if the view draws it: shown, in one of `layers`, within `limits`.
    std::optional<OcclusionOptions> occlusion = {};
    // If set, lists the triangles without which this picture would change, found by the depth of those before them
    // (docs/depth.md). Of objects whose mesh has MeshDescription::clusters; objects that do not `occlude` hide nothing.
    // Others are listed where their boxes may be seen. For a camera, `picture->depth` says how the renderer's
    // projection gives depth. In place of `occlusion`.
    std::optional<depth::PictureView> picture = {};
    // Leaves out what is too small or too far. The caller's, alive for the call.
    const cull::DrawLimits* limits = nullptr;
    // If not empty, bit i % 64 of word i / 64 says whether the object with index i may be seen at all: baked sets
    // (docs/pvs.md). Objects beyond its end may be seen, and so may those that have moved since they were first updated
    // or whose index another object had before. So may new ones until they count as resting, which those of a level
    // that is loaded at once do from the first update on.
    std::span<const std::uint64_t> candidate_mask = {};
    cull::ResultOrder order = cull::ResultOrder::ascending;
    cull::CullMode mode = cull::CullMode::exact;
};

}  // namespace crofton
