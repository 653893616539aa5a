// SPDX-License-Identifier: MIT
// An OGRE scene manager that asks Crofton which objects a camera sees; the rest of OGRE notices nothing.
#pragma once
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>

#include <crofton/crofton.hpp>
#include <vector>

#include "node_occluders.hpp"

namespace crofton::ogre {

class SceneManager;

// Tells its manager whenever the box around its objects may have changed.
class SceneNode final : public Ogre::SceneNode {
  public:
    SceneNode(SceneManager& manager);
    SceneNode(SceneManager& manager, const Ogre::String& name);
    ~SceneNode() override;
    void _updateBounds() override;

  private:
    friend class SceneManager;
    void setInSceneGraph(bool in_graph) override;

    SceneManager& manager_;
    ObjectHandle occluder_;   // what its entity hides other things with, while the manager asks for it
    ObjectHandle object_;     // the box around what is attached, in the manager's World
    bool unbounded_ = false;  // in the manager's list of nodes that every camera sees
};

// Where the time of the last _findVisibleObjects went, in microseconds.
struct FindTimes {
    double cull = 0.0;   // the frustum against the objects' boxes
    double total = 0.0;  // with filling OGRE's render queue
};

class SceneManager final : public Ogre::SceneManager {
  public:
    explicit SceneManager(const Ogre::String& name);
    ~SceneManager() override;
    const Ogre::String& getTypeName() const override;

    // True hands the search back to OGRE, for comparison.
    void use_ogre_culling(bool use) { use_ogre_culling_ = use; }
    // True: pictures leave out what solid entities hide (is_solid). Shadow textures show all casters as ever. Say so
    // before the scene is built, or all nodes are looked at again; from then on occluders follow their nodes. A
    // material that becomes transparent later is noticed when its node next changes.
    void use_occlusion(bool use);
    // Return the World's figures for the last picture; none for views without a depth buffer of ours, such as mirrors.
    [[nodiscard]] OcclusionStatistics occlusion_statistics() const { return visible_.occlusion_statistics(); }
    [[nodiscard]] const FindTimes& find_times() const { return find_times_; }
    // Objects with a box that the last search of ours saw.
    [[nodiscard]] std::size_t visible_nodes() const { return visible_.size(); }

    void _findVisibleObjects(Ogre::Camera* camera, Ogre::VisibleObjectsBoundsInfo* bounds,
                             bool only_shadow_casters) override;

    // The half-spaces that OGRE itself tests with, their stored floats taken as they are.
    [[nodiscard]] static Frustum frustum_of(const Ogre::Camera& camera);

  private:
    friend class SceneNode;
    Ogre::SceneNode* createSceneNodeImpl() override;
    Ogre::SceneNode* createSceneNodeImpl(const Ogre::String& name) override;
    void bounds_changed(SceneNode& node);
    void forget(SceneNode& node);
    void make_unbounded(SceneNode& node);
    void update_world();
    void follow_occluder(SceneNode& node);
    void forget_occluder(SceneNode& node);
    [[nodiscard]] bool hides_as_drawn(SceneNode& node);
    void find_visible(const Ogre::Camera& camera, bool only_shadow_casters);
    void queue_object(Ogre::MovableObject& object, Ogre::Camera* camera, Ogre::VisibleObjectsBoundsInfo* bounds,
                      bool only_shadow_casters);
    void queue_objects(SceneNode& node, Ogre::Camera* camera, Ogre::VisibleObjectsBoundsInfo* bounds,
                       bool only_shadow_casters);

    World world_{{.pairs = false}};
    ViewResult visible_;
    bool world_changed_ = true;  // since its last update
    unsigned long updated_frame_ = 0;
    std::vector<SceneNode*> unbounded_;  // hold skies and the like
    OccluderMeshes occluder_meshes_{world_};
    Vector<OccluderRef> drawn_occluders_;
    bool use_ogre_culling_ = false, use_occlusion_ = false, follows_occluders_ = false;
    FindTimes find_times_;
};

class SceneManagerFactory final : public Ogre::SceneManagerFactory {
  public:
    static constexpr const char* kTypeName = "CroftonSceneManager";
    Ogre::SceneManager* createInstance(const Ogre::String& name) override { return OGRE_NEW SceneManager(name); }
    void destroyInstance(Ogre::SceneManager* manager) override { OGRE_DELETE manager; }

  private:
    void initMetaData() const override;
};

}  // namespace crofton::ogre
