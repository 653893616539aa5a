// SPDX-License-Identifier: MIT
#include "city.hpp"

#include <OgreLight.h>
#include <OgreMaterialManager.h>

#include <cmath>
#include <random>

namespace crofton::ogre {
namespace {

constexpr double kSpacing = 12.0;  // metres of ground an entity has to itself, squared: the density is always the same

}  // namespace

City::City(Ogre::Root& root, const CitySize& size)
    : root_(root), half_width_(0.5 * kSpacing * std::sqrt(static_cast<double>(size.entities))) {
    manager_ = static_cast<SceneManager*>(root.createSceneManager(SceneManagerFactory::kTypeName));
    manager_->setAmbientLight(Ogre::ColourValue(0.3f, 0.3f, 0.3f));
    manager_->setVisibilityMask(kShown);
    add_sun(size.shadows);
    add_entities(size);
    camera_ = manager_->createCamera("camera");
    camera_->setNearClipDistance(0.5f);
    camera_->setFarClipDistance(static_cast<float>(size.view_distance));
    camera_->setFOVy(Ogre::Degree(60.0f));
    camera_->setAspectRatio(16.0f / 9.0f);
    camera_node_ = manager_->getRootSceneNode()->createChildSceneNode();
    camera_node_->attachObject(camera_);
    set_frame(0);
}

City::~City() {
    root_.destroySceneManager(manager_);
}

void City::add_sun(bool shadows) {
    if (shadows) {
        manager_->setShadowTechnique(Ogre::SHADOWTYPE_TEXTURE_MODULATIVE);
        manager_->setShadowTextureSettings(256, 1);
        manager_->setShadowFarDistance(150.0f);
    }
    Ogre::Light* sun = manager_->createLight("sun");
    sun->setType(Ogre::Light::LT_DIRECTIONAL);
    sun->setCastShadows(shadows);
    Ogre::SceneNode* node = manager_->getRootSceneNode()->createChildSceneNode();
    node->setDirection(Ogre::Vector3(-0.4f, -1.0f, -0.3f).normalisedCopy());
    node->attachObject(sun);
}

void City::add_entities(const CitySize& size) {
    std::mt19937 random(1);
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(low + (high - low) * static_cast<double>(random()) / 4294967296.0);
    };
    for (unsigned i = 0; i < size.entities; ++i) {
        const bool moves = i < size.moving;
        Ogre::Entity* entity =
            manager_->createEntity(moves ? Ogre::SceneManager::PT_SPHERE : Ogre::SceneManager::PT_CUBE);
        entity->setVisibilityFlags(i % 8 == 7 ? kHidden : kShown);
        entity->setCastShadows(i % 3 != 0);
        Ogre::SceneNode* node = manager_->getRootSceneNode()->createChildSceneNode();
        node->attachObject(entity);
        // OGRE's prefabs are 100 units wide.
        const Ogre::Vector3 extents(uniform(1, 8), moves ? 2.0f : uniform(2, 30), uniform(1, 8));
        node->setScale(extents / 100.0f);
        node->setOrientation(Ogre::Quaternion(Ogre::Radian(uniform(0, 6.283)), Ogre::Vector3::UNIT_Y));
        node->setPosition(uniform(-half_width_, half_width_), 0.5f * extents.y, uniform(-half_width_, half_width_));
        entities_.push_back(entity);
        if (moves) moving_.push_back(node);
    }
}

void City::set_frame(unsigned frame) {
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        const float phase = 0.1f * static_cast<float>(frame) + static_cast<float>(i);
        moving_[i]->translate(0.3f * std::cos(phase), 0.0f, 0.3f * std::sin(phase));
        moving_[i]->yaw(Ogre::Radian(0.05f));
    }
    const double angle = 0.05 * frame;
    camera_node_->setPosition(static_cast<float>(0.3 * half_width_ * std::cos(angle)), 12.0f,
                              static_cast<float>(0.3 * half_width_ * std::sin(angle)));
    camera_node_->setOrientation(
        Ogre::Quaternion(Ogre::Radian(static_cast<float>(0.9 + 2.3 * angle)), Ogre::Vector3::UNIT_Y) *
        Ogre::Quaternion(Ogre::Degree(-8.0f), Ogre::Vector3::UNIT_X));
}

}  // namespace crofton::ogre
