// SPDX-License-Identifier: MIT
// OGRE with a small hidden window and the fixed-function renderer: enough to draw, count and read back.
#pragma once
#include <OgreRenderWindow.h>
#include <OgreRoot.h>

#include <memory>
#include <string>

namespace crofton::ogre {

// Throws Ogre::Exception where there is no display or no OpenGL.
class Headless {
  public:
    Headless();
    ~Headless();
    Headless(const Headless&) = delete;
    Headless& operator=(const Headless&) = delete;

    [[nodiscard]] Ogre::Root& root() { return *root_; }
    [[nodiscard]] Ogre::RenderWindow& window() { return *window_; }

  private:
    std::unique_ptr<Ogre::LogManager> log_;
    std::unique_ptr<Ogre::Root> root_;
    Ogre::RenderWindow* window_ = nullptr;
};

}  // namespace crofton::ogre
