// SPDX-License-Identifier: MIT
// A glTF asset's planar patches triangulated anew; everything else about it stays as it is.
#pragma once
#include <crofton/triangulate/triangulate.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

struct PatchSettings {
    triangulate::TriangulateOptions triangulation;
    double tolerance = -1.0;            // from a patch's plane; negative: a millionth of each mesh's size
    double attribute_tolerance = 1e-4;  // how far attributes may leave one linear function of the position; see below
    // Returning false leaves the rest as it is.
    std::function<bool(std::size_t done, std::size_t of)> progress = {};
};

// The result for one primitive of a mesh.
struct PrimitivePatches {
    std::size_t mesh = 0, primitive = 0;  // by number in the file
    std::string name;                     // of the mesh
    std::string left_alone;               // why no patches were looked for; empty where they were
    std::optional<Error> error;           // what is wrong with it, so that it stays as it was
    std::size_t vertices = 0, triangles_before = 0, triangles_after = 0;
    triangulate::PatchReport report;
    Vector<std::uint32_t> indices;  // its triangles, as they are now
    double microseconds = 0.0;
};

// Each primitive's planar patches, triangulated anew where that makes them lighter, in the order of the file. Nothing
// but indices changes: in place where no one else reads those bytes, else in a new accessor; strips and fans that
// change become plain triangles. Primitives of the same geometry are done once. A patch ends at a seam (vertices of
// their own) and where an attribute leaves the linear function of the position that it is on the patch's first triangle
// by more than `attribute_tolerance` in the attribute's units (integers: at least half a step); displacements of
// positions by morph targets by `tolerance`. Joints and weights must be constant. So what is drawn stays the same, in
// every pose. An infinite `attribute_tolerance` leaves only seams. Primitives that cannot be read say why and stay.
// Errors: meshes or primitives that are no lists of objects.
[[nodiscard]] Result<std::vector<PrimitivePatches>> retriangulate_patches(GltfDocument& document,
                                                                          const PatchSettings& settings);

}  // namespace crofton::assets
