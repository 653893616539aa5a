// SPDX-License-Identifier: MIT
#include "mesh_triangles.hpp"

#include <OgreHardwareBufferManager.h>
#include <OgreSubMesh.h>

namespace crofton::ogre {
namespace {

std::vector<Ogre::Vector3> read_positions(const Ogre::VertexData& data) {
    const Ogre::VertexElement* element = data.vertexDeclaration->findElementBySemantic(Ogre::VES_POSITION);
    const Ogre::HardwareVertexBufferSharedPtr buffer = data.vertexBufferBinding->getBuffer(element->getSource());
    std::vector<Ogre::Vector3> positions;
    auto* vertex = static_cast<unsigned char*>(buffer->lock(Ogre::HardwareBuffer::HBL_READ_ONLY));
    for (std::size_t i = 0; i < data.vertexCount; ++i, vertex += buffer->getVertexSize()) {
        float* position = nullptr;
        element->baseVertexPointerToElement(vertex, &position);
        positions.emplace_back(position[0], position[1], position[2]);
    }
    buffer->unlock();
    return positions;
}

void append_triangles(const Ogre::Mesh& mesh, const Ogre::SubMesh& part, std::vector<Ogre::Vector3>& corners) {
    const auto positions = read_positions(part.useSharedVertices ? *mesh.sharedVertexData : *part.vertexData);
    const Ogre::IndexData& data = *part.indexData;
    const auto* words = static_cast<const Ogre::uint16*>(data.indexBuffer->lock(Ogre::HardwareBuffer::HBL_READ_ONLY));
    const auto* longs = reinterpret_cast<const Ogre::uint32*>(words);
    const bool wide = data.indexBuffer->getType() == Ogre::HardwareIndexBuffer::IT_32BIT;
    for (std::size_t i = data.indexStart; i < data.indexStart + data.indexCount; ++i)
        corners.push_back(positions[wide ? longs[i] : words[i]]);
    data.indexBuffer->unlock();
}

}  // namespace

std::vector<Ogre::Vector3> read_triangles(const Ogre::Mesh& mesh) {
    std::vector<Ogre::Vector3> corners;
    for (const Ogre::SubMesh* part : mesh.getSubMeshes()) append_triangles(mesh, *part, corners);
    return corners;
}

}  // namespace crofton::ogre
