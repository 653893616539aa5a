// SPDX-License-Identifier: MIT
// The meshes of the shared data.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace crofton::testing {

// Returns an empty mesh if the file is missing. Faces are cut into fans.
inline TriangleMesh shared_mesh(const std::string& name) {
    TriangleMesh mesh;
    std::ifstream file(std::string(CROFTON_SHARED_DATA) + "/meshes/" + name + ".obj");
    for (std::string line; std::getline(file, line);) {
        glm::vec3 p;
        if (std::sscanf(line.c_str(), "v %f %f %f", &p.x, &p.y, &p.z) == 3) mesh.positions.push_back(p);
        if (line.rfind("f ", 0) != 0) continue;
        std::vector<std::uint32_t> corner;
        for (std::size_t at = 1; at != std::string::npos && at + 1 < line.size(); at = line.find(' ', at + 1))
            if (line[at + 1] >= '0' && line[at + 1] <= '9')
                corner.push_back(static_cast<std::uint32_t>(std::stoul(line.substr(at + 1)) - 1));
        for (std::size_t i = 2; i < corner.size(); ++i)
            for (const std::uint32_t index : {corner[0], corner[i - 1], corner[i]}) mesh.indices.push_back(index);
    }
    return mesh;
}

}  // namespace crofton::testing
