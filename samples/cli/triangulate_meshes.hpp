// The planar patches of a file's meshes, triangulated anew.
#pragma once
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <string>

namespace crofton::cli {

struct MeshRun {
    std::string file, method_name;
    triangulate::Method method = triangulate::Method::minimum_weight;
    std::string json, out;
    double seconds = 10.0;
    double tolerance = -1.0;  // negative: a millionth of each mesh's size
    bool no_indices = false;
};

// `tolerance`, or where it is negative a millionth of the mesh's size.
[[nodiscard]] double patch_tolerance(const TriangleMesh& mesh, double tolerance);

// Exit status; prints a table unless the JSON goes to stdout.
[[nodiscard]] Result<int> run_meshes(const MeshRun& run);

}  // namespace crofton::cli
