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
class Shape;
}  // namespace convex

// Handles of objects, nodes and meshes: an index, which is reused, and a generation, which differs for each use.

inline constexpr std::uint32_t kNoIndex = ~std::uint32_t{0};
// Indices of regions' objects (World::attach) begin here. They are consecutive within a region.
inline constexpr std::uint32_t kFirstRegionIndex = 0x80000000u;

// Indices of a World's own objects are dense, so you may use them to index your own arrays: they are less than the
// largest number that existed at once, including objects removed since the last update. An object's index is reused
// after the next update. Nodes share their indices with the objects that have a transform or no node.
//
// A handle is stale after its object, node or mesh was removed. Calls with a stale handle, or with a handle of another
// World, fail with ErrorCode::stale_handle. Each World of the process starts with other generations, the first World
// with 1. Generations are never 0, so {0, 0} is always invalid. A generation returns after 2^32 - 1 removals of one
// index; the first generations of n Worlds are at least 2^32 / 3 n apart.
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
using RegionHandle = Handle<struct RegionTag>;  // of a region at one origin

// ---- Views of the caller's memory ----

// Reads `size` values of type T in the caller's memory, `stride` bytes apart: a span, or a member of an array of
// structs.
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

// Reads points of three floats or three doubles each, at any alignment.
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

// Reads indices of 16 or 32 bits.
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

// A mesh in its own frame. World copies what it needs.
//
// A triangle has three indices (a, b, c); without indices, three consecutive positions are a triangle. Its outside is
// the side to which cross(b − a, c − a) points. Seen from there, triangles are counter-clockwise in right-handed
// coordinates and clockwise in left-handed ones.
struct MeshDescription {
    PointsView positions = {};
    IndicesView indices = {};
    // True: rays and contacts test the triangles. False: they test the mesh's box, which saves memory and time.
    bool triangles = true;
    // True: calls World::find_occluders with default options. The occluders hide other objects, so set it for opaque
    // meshes only. Takes a second or more for 100,000 triangles.
    bool occluders = false;
    // True: views that ask for a picture list the mesh's triangles, in clusters (World::clusters_of). These read the
    // World's own positions and indices: they add a tenth to a quarter to the mesh's memory.
    bool clusters = false;
    // With clusters: those of this mesh that were cut before, as BakedScene::clusters() has them, or nullptr to cut the
    // mesh. They are copied without what they hold or were lent. Error: they are of another mesh; after permuted
    // indices were lent to them that is the permuted one.
    const depth::ClusteredMesh* precut = nullptr;
    // With clusters: set it if the renderer drops back faces; they are then not listed. Mirrored objects list both
    // sides.
    bool one_sided = false;
    // The mesh's box, if you have it from Scene::mesh_box or BakedScene::mesh, or nullptr to fit one, which takes most
    // of the time. Error: it does not contain a vertex.
    const Obb* box = nullptr;
};

struct NodeDescription {
    NodeHandle parent = {};      // null: none
    Transform transform = {};    // relative to the parent
    std::uint32_t layers = ~0u;  // an object is in the layers that it and all nodes above it share
};

enum class BoundKind : std::uint8_t { none, box, aligned_box, sphere };

// A bound without a mesh.
struct Bound {
    BoundKind kind = BoundKind::none;
    Obb box;              // for a sphere: the cube around it
    double radius = 0.0;  // of a sphere

    Bound() = default;
    Bound(const Obb& oriented) : kind(BoundKind::box), box(oriented) {}
    Bound(const Aabb& aligned);  // rounded outward to an Obb; World rejects an empty one
    Bound(const Sphere& sphere);
};

// Describes an object: a mesh or a shape, which `transform` places under `node` or in the world, or a bound in world
// coordinates.
struct ObjectDescription {
    MeshHandle mesh = {};
    NodeHandle node = {};
    std::optional<Transform> transform = {};  // none: the node's own
    Bound bound = {};
    // As World::set_shape. An object may have only a shape: its box is the shape's, and set_transform moves it. The box
    // of infinite ground is then a point, so views seldom list it.
    const convex::Shape* shape = nullptr;
    std::uint64_t user = 0;      // returned with every answer
    std::uint32_t layers = ~0u;  // views and queries ask for layers
    // Two objects can collide if each one's `layers` share a bit with the other's `collides_with`.
    std::uint32_t collides_with = ~0u;
    // For an object with a mesh. False: it hides nothing, for example because it is drawn transparent.
    bool occludes = true;
    // For an object with a mesh. True: the mesh's occluders hide other objects, but no answer contains this object. Use
    // it if your objects are bounds. The occluders must lie within drawn surfaces of the same layers.
    bool only_occludes = false;
    bool hidden = false;  // as World::set_hidden, from the start
};

// Controls how a view leaves out objects that other objects hide.
struct OcclusionOptions {
    occlude::BufferSize size = {480, 270};  // pixels of the depth buffer; more find more, but take longer
    std::uint32_t max_occluders = 256;      // draws at most this many: those that hide most in this view
    float least_cover = 2e-5f;              // smallest part of the sphere of directions that a drawn occluder covers
    bool list_occluded = false;             // also lists hidden objects, which takes a second query
};

// A view by your engine's own matrix, which takes world positions, relative to `origin`, to clip space. matrix_of
// (crofton/geometry/camera.hpp) makes a dmat4 of the engine's sixteen numbers.
struct ViewMatrix {
    glm::dmat4 to_clip{1.0};
    DepthRange depth = DepthRange::reversed_zero_to_one;
    glm::dvec3 origin{0.0};
};

class ViewResult;

// The answer to a camera's view, for the view of a light that casts shadows on it.
struct ShadowReceivers {
    // The answer to the camera's view, which had a picture; not the one that the light's answer goes to. It holds until
    // an update changes something, an object or a mesh is removed, or a mesh is replaced.
    const ViewResult* seen = nullptr;
    float radius = 1.0f;  // as depth::DepthReceivers::radius
};

// Describes a view for World::view.
struct ViewRequest {
    // The view volume: set a camera, a matrix or a volume.
    std::optional<Camera> camera = {};
    std::optional<ViewMatrix> matrix = {};
    // Any convex volume, such as that of a shadow. A volume has no eye. For occlusion, set a camera or a matrix as
    // well; objects are then tested against the volume instead of the camera's frustum.
    std::optional<Frustum> volume = {};

    std::uint32_t layers = ~0u;  // lists objects that share a layer with these
    // If set, leaves out objects that others hide, but never a visible one (docs/occlude.md). An object's occluders are
    // used if the view draws the object: it is not hidden, is in one of `layers` and within `limits`.
    std::optional<OcclusionOptions> occlusion = {};
    // If set, lists the triangles without which this picture would change (docs/depth.md), for objects whose mesh has
    // MeshDescription::clusters. Other objects are listed if their boxes may be visible. Objects whose `occludes` is
    // false hide nothing. For a camera, `picture->depth` is the depth range of the renderer's projection. Cannot be
    // combined with `occlusion`.
    std::optional<depth::PictureView> picture = {};
    // If set, `picture` is the shadow map of a light, whose camera or matrix the request has, and the view lists only
    // the triangles without which a shadow on what a camera sees would change (docs/depth.md#shadow-maps).
    std::optional<ShadowReceivers> receivers = {};
    // Leaves out objects that are too small or too far. Must live until the call returns. The limits by item and the
    // hysteresis are for the World's own objects; regions' objects have neither.
    const cull::DrawLimits* limits = nullptr;
    // A baked visible set (docs/pvs.md). If not empty, the object with index i is listed only if bit i % 64 of word
    // i / 64 is set. Objects beyond its end are tested as usual, and so are objects that have moved since their first
    // update or that reuse the index of another object.
    std::span<const std::uint64_t> candidate_mask = {};
    cull::ResultOrder order = cull::ResultOrder::ascending;
    cull::CullMode mode = cull::CullMode::exact;
};

// Limits rays, overlaps, nearest objects and casts to some of the objects.
struct QueryFilter {
    std::uint32_t layers = ~0u;  // finds objects that share a layer with this mask
    // Finds none of these, for example the object that asks and what it carries. Each object that comes into question
    // is compared with all of them, so pass a few, and use layers for many. A stale handle has no effect.
    std::span<const ObjectHandle> ignored = {};
};

}  // namespace crofton
