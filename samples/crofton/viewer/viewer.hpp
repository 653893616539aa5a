// SPDX-License-Identifier: MIT
// `crofton view`: a window (or none) onto a scene, its culling and what it costs.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "loaded_scene.hpp"
#include "settings.hpp"

namespace crofton::viewer {

struct ViewerOptions {
    SceneRequest scene;
    Settings settings;
    std::uint32_t width = 1280, height = 720;
    bool window = true;
    float scale = 0.0f;  // of texts and panels; 0: as the window system says
    bool validation = false;
    std::string device;               // part of its name; empty: CROFTON_DEVICE or the best
    std::string camera;               // a path to replay: orbit, street, flight, random or a file; empty: none
    std::string script;               // a file of keys, cameras, switches and pictures
    std::string screenshot;           // taken after the last frame
    std::uint32_t frames = 0;         // quit after so many; 0: when the window is closed or the script ends
    std::string json;                 // statistics of all frames at the end; "-" is stdout
    std::string output_folder = ".";  // for recorded paths, exports and the screenshot key
};

// Runs until closed. Errors: as LoadedScene::load for the first scene (one that is dropped in later is only reported);
// no display, device or driver; files that cannot be read or written.
[[nodiscard]] Result<void> run_viewer(const ViewerOptions& options);

}  // namespace crofton::viewer
