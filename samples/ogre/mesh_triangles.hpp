// SPDX-License-Identifier: MIT
// The triangles of an OGRE mesh, read back from its buffers.
#pragma once
#include <OgreMesh.h>
#include <OgreVector.h>

#include <vector>

namespace crofton::ogre {

[[nodiscard]] std::vector<Ogre::Vector3> read_triangles(const Ogre::Mesh& mesh);  // three corners each

}  // namespace crofton::ogre
