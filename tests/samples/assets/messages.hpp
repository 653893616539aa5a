// SPDX-License-Identifier: MIT
// What the tests of the loaders ask of error messages.
#pragma once
#include <assets/scene_source.hpp>
#include <string>

namespace test_files {

inline bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

inline std::string message(const crofton::Result<crofton::assets::SceneSource>& source) {
    return source ? "loaded" : source.error().message;
}

}  // namespace test_files
