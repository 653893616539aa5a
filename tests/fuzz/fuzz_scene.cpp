// SPDX-License-Identifier: MIT
// Scene files of every format: the first byte says which.
#include <assets/scene_source.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <cstdlib>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crofton;
    static constexpr const char* kExtensions[] = {"glb", "gltf", "obj", "wad"};
    if (size == 0) return 0;
    const std::string path = fuzz::input_file(kExtensions[data[0] % 4], data + 1, size - 1);
    auto source = assets::load_scene(path);
    if (!source) {
        // Whatever is wrong, the message says with which file.
        if (source.error().message.find(path) == std::string::npos) std::abort();
        return 0;
    }
    source->scene.update();
    for (scene::InstanceId i = 0; i < source->scene.instance_count(); ++i)
        if (source->scene.layer_masks()[i] != 0 && !validate(source->scene.world_boxes()[i])) std::abort();
    return 0;
}
