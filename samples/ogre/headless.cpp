// SPDX-License-Identifier: MIT
#include "headless.hpp"

#include <OgreException.h>
#include <OgreLogManager.h>
#include <OgreRenderSystem.h>
#include <OgreResourceGroupManager.h>

namespace crofton::ogre {

Headless::Headless() : log_(std::make_unique<Ogre::LogManager>()) {
    // Quiet: no log file, nothing on the terminal.
    log_->createLog("crofton", true, false, true);
    root_ = std::make_unique<Ogre::Root>("", "", "");
    root_->loadPlugin(CROFTON_OGRE_PLUGINS "/RenderSystem_GL");
    root_->loadPlugin(CROFTON_OGRE_PLUGINS "/Codec_STBI");  // PNG
    Ogre::RenderSystem* system = root_->getRenderSystemByName("OpenGL Rendering Subsystem");
    if (!system) OGRE_EXCEPT(Ogre::Exception::ERR_ITEM_NOT_FOUND, "OGRE's OpenGL renderer is missing", "Headless");
    root_->setRenderSystem(system);
    root_->initialise(false);
    const Ogre::NameValuePairList options{{"hidden", "true"}, {"vsync", "false"}, {"FSAA", "0"}};
    window_ = root_->createRenderWindow("crofton", 640, 360, false, &options);
    window_->setAutoUpdated(false);
    Ogre::ResourceGroupManager& resources = Ogre::ResourceGroupManager::getSingleton();
    resources.addResourceLocation(CROFTON_OGRE_MEDIA "/ShadowVolume", "FileSystem", Ogre::RGN_INTERNAL);
    resources.initialiseAllResourceGroups();
}

Headless::~Headless() {
    window_ = nullptr;
    root_.reset();
}

}  // namespace crofton::ogre
