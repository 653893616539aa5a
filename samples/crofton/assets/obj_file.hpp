// SPDX-License-Identifier: MIT
// Wavefront OBJ: v (with optional colours or weight), vt, vn, f (any polygon, concave ones and keyholes too), o, g,
// usemtl with Kd, Ke and map_Kd of a material library. Faces may come before their vertices. Lines may end in LF, CR LF
// or CR, continue after "\" and end in a comment. Curves, surfaces, lines and points are not read.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <vector>

#include "assets/read_limits.hpp"

namespace crofton::assets {

struct ObjFile {
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    // The faces between one o, g or usemtl and the next.
    struct Part {
        std::string name;
        glm::vec3 color{0.62f, 0.6f, 0.56f};  // linear
        glm::vec3 emission{0.0f};             // Ke, as it stands
        std::string material;                 // as its library has it
        std::string texture;                  // map_Kd's file, as it stands; empty: none
        std::vector<std::uint32_t> indices;   // three a triangle, into positions
        // As many as indices, into texcoords and normals; kNone where the corner has none, both empty where none has.
        std::vector<std::uint32_t> texcoord_indices, normal_indices;
    };
    std::vector<glm::dvec3> positions;  // in the file's order, used by faces or not; finite
    // What floats of the faces' vertices should be relative to: 0, unless the faces are far out.
    glm::dvec3 origin{0.0};
    std::vector<glm::vec3> colors;      // one a position; negative red where the file gives none
    std::vector<glm::vec2> texcoords;   // v upwards, as in the file
    std::vector<glm::vec3> normals;     // of any length
    std::vector<Part> parts;            // at least one; any may be without faces
    std::vector<std::string> warnings;  // material libraries, texture coordinates and normals that are not there
    // Faces that cross themselves or have no area, and so are fans; the first line whose keyword is none.
    std::vector<std::string> odd_lines;
    // Names the first line whose keyword is none, for messages of what is missing then; "; line …", or empty.
    std::string unknown_line;
    ReadLimits limits;             // that it was read with
    std::uint64_t bytes_read = 0;  // with its libraries, within limits.bytes
};

struct ObjOptions {
    double largest = std::numeric_limits<float>::max();  // coordinate; larger where the caller computes in doubles
    ReadLimits limits = {};
    bool leave_out = false;  // lines that make no sense become warnings, and faces with such vertices are left out
};

// Errors name the file, the line and the reason: numbers that are none, NaN or too large, faces of fewer than three
// corners or with vertices that are not there, a limit; files that are no text, or UTF-16. Material libraries are read
// from below the file's folder only.
[[nodiscard]] Result<ObjFile> read_obj(const std::string& path, const ObjOptions& options = {});

}  // namespace crofton::assets
