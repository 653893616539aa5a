// SPDX-License-Identifier: MIT
// One primitive of a glTF mesh as a triangle mesh with what its vertices carry.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <deque>
#include <string>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

struct PrimitiveGeometry {
    TriangleMesh mesh;  // of a strip or a fan without the triangles that name a vertex twice
    int mode = kGltfTriangles;
    std::size_t index_accessor = kNoNumber;
    std::size_t triangles_in_file = 0;
    std::deque<std::vector<float>> storage;         // of the values
    std::vector<triangulate::VertexValues> values;  // attributes but the positions, and morph targets
    double position_tolerance = 0.0;                // from the plane of a patch
};

// Why a primitive shows no triangles (points, lines, no positions); empty where it may show some.
[[nodiscard]] std::string reason_to_draw_nothing(const nlohmann::ordered_json& primitive);

// Why a primitive's triangles are not to be touched (points, lines, no positions, an extension that may count on
// them); empty where they may be.
[[nodiscard]] std::string reason_to_leave(const nlohmann::ordered_json& primitive);

struct ValueTolerances {
    double position = -1.0;  // negative: a millionth of the mesh's size
    double attribute = 0.0;  // infinite: values are not read
};

// Errors: accessors that cannot be read, name an attribute; compressed primitives.
[[nodiscard]] Result<PrimitiveGeometry> read_primitive(const GltfDocument& document,
                                                       const nlohmann::ordered_json& primitive,
                                                       const ValueTolerances& tolerances);

// `tolerance`, or where it is negative a millionth of the mesh's size.
[[nodiscard]] double patch_tolerance(const TriangleMesh& mesh, double tolerance);

}  // namespace crofton::assets
