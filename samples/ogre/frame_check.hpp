// SPDX-License-Identifier: MIT
// What each culling put into OGRE's render queue, and whether anything that can be seen is missing from it.
#pragma once
#include <OgreRenderQueue.h>

#include <map>
#include <vector>

#include "city.hpp"

namespace crofton::ogre {

// Writes down every renderable that is queued, pass by pass: a frame has one pass per shadow texture and one for the
// picture.
class QueueRecorder final : public Ogre::RenderQueue::RenderableListener, public Ogre::SceneManager::Listener {
  public:
    struct Pass {
        const Ogre::Camera* camera = nullptr;
        bool shadows = false;
        Frustum frustum;                              // the camera's, at that moment
        std::vector<const Ogre::Renderable*> queued;  // sorted
        FindTimes times;
    };

    explicit QueueRecorder(SceneManager& manager);
    ~QueueRecorder() override;

    // The passes since the last call.
    [[nodiscard]] std::vector<Pass> take();

  private:
    bool renderableQueued(Ogre::Renderable* renderable, Ogre::uint8, Ogre::ushort, Ogre::Technique**,
                          Ogre::RenderQueue*) override;
    void preFindVisibleObjects(Ogre::SceneManager*, Ogre::SceneManager::IlluminationRenderStage,
                               Ogre::Viewport* viewport) override;
    void postFindVisibleObjects(Ogre::SceneManager*, Ogre::SceneManager::IlluminationRenderStage,
                                Ogre::Viewport*) override;

    SceneManager& manager_;
    std::vector<Pass> passes_;
};

struct FrameCheck {
    std::size_t ogre = 0, crofton = 0;  // renderables queued
    std::size_t not_in_ogre = 0;        // queued by Crofton's culling and not by OGRE's: should be none
    std::size_t missing = 0;  // OGRE's frustum sees a vertex, or a triangle meets it, and Crofton did not queue it
};

// The triangles of each mesh, read back from OGRE's buffers once.
class MeshTriangles {
  public:
    [[nodiscard]] const std::vector<Ogre::Vector3>& of(const Ogre::Mesh& mesh);  // three corners a triangle

  private:
    std::map<const Ogre::Mesh*, std::vector<Ogre::Vector3>> corners_;
};

// Compares one pass, drawn both ways. Entities masked out and, in shadow passes, those that cast none are not expected.
[[nodiscard]] FrameCheck check_pass(City& city, const QueueRecorder::Pass& ogre, const QueueRecorder::Pass& crofton,
                                    MeshTriangles& meshes);

}  // namespace crofton::ogre
