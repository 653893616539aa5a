// SPDX-License-Identifier: MIT
// A city of boxes and spheres under a moving camera and a shadow-casting sun: thousands of entities, some of them
// moving.
#pragma once
#include <OgreCamera.h>
#include <OgreEntity.h>
#include <OgreRoot.h>

#include <cstdint>
#include <vector>

#include "crofton_scene_manager.hpp"

namespace crofton::ogre {

struct CitySize {
    unsigned entities = 3000;
    unsigned moving = 300;
    bool shadows = true;
    double view_distance = 600.0;  // metres; the city has one entity on 144 square metres
};

// An entity in eight is masked out: masks are OGRE's business and must work as ever.
inline constexpr Ogre::uint32 kShown = 1, kHidden = 2;

class City {
  public:
    City(Ogre::Root& root, const CitySize& size);
    ~City();
    City(const City&) = delete;
    City& operator=(const City&) = delete;

    // Moves the moving entities and the camera; the same frame is the same picture.
    void set_frame(unsigned frame);

    [[nodiscard]] SceneManager& manager() { return *manager_; }
    [[nodiscard]] Ogre::Camera& camera() { return *camera_; }
    [[nodiscard]] const std::vector<Ogre::Entity*>& entities() const { return entities_; }

  private:
    void add_entities(const CitySize& size);
    void add_sun(bool shadows);

    Ogre::Root& root_;
    SceneManager* manager_;
    Ogre::Camera* camera_;
    Ogre::SceneNode* camera_node_;
    double half_width_;
    std::vector<Ogre::Entity*> entities_;
    std::vector<Ogre::SceneNode*> moving_;
};

}  // namespace crofton::ogre
