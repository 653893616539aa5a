// SPDX-License-Identifier: MIT
// Damaged files of every format: any answer is right but a crash, a hang or a loaded scene that breaks its promises.
#include <doctest/doctest.h>
#include <assets/scene_source.hpp>
#include <error_of.hpp>
#include <random>

#include "test_files.hpp"

using namespace crofton;
using test_files::TemporaryFile;

namespace {

void try_file(const std::string& name, const std::string& contents) {
    const TemporaryFile file(name, contents);
    auto source = assets::load_scene(file.path());
    if (!source) {
        CHECK(error_of(source).message.find(name) != std::string::npos);
        return;
    }
    source->scene.update();
    for (scene::InstanceId i = 0; i < source->scene.instance_count(); ++i)
        if (source->scene.layer_masks()[i] != 0) CHECK(validate(source->scene.world_boxes()[i]).has_value());
}

void fuzz(const std::string& name, const std::string& contents, int trials) {
    std::mt19937 random(12345);
    for (int trial = 0; trial < trials; ++trial) {
        std::string damaged = contents;
        if (trial % 3 == 0) damaged.resize(random() % (contents.size() + 1));
        const int flips = trial % 3 == 0 ? 0 : 1 + static_cast<int>(random() % 4);
        for (int k = 0; k < flips; ++k) {
            char& byte = damaged[random() % damaged.size()];
            byte = trial % 2 == 0 ? static_cast<char>(random() & 255u) : static_cast<char>(byte ^ (1 << random() % 8));
        }
        try_file(name, damaged);
    }
}

}  // namespace

TEST_SUITE("assets/fuzz") {
    TEST_CASE("damaged GLB files give errors, not crashes") {
        fuzz("fuzz.glb",
             test_files::glb(test_files::gltf_json("[{\"mesh\":0,\"children\":[1]},{\"mesh\":0,\"scale\":[2,1,1]}]")),
             4000);
    }

    TEST_CASE("damaged glTF text gives errors, not crashes") {
        fuzz(
            "fuzz.gltf",
            test_files::gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":3",
                                  "\"byteLength\":44,\"uri\":\"data:application/"
                                  "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=\""),
            4000);
    }

    TEST_CASE("damaged OBJ files give errors, not crashes") {
        fuzz("fuzz.obj",
             "o a\nv 0 0 0\nv 1 0 0 1 0 1\nv 0 1 0\nv 0 0 1\nf 1 2 3\nusemtl x\nf -1/2/3 2//1 3/4 1\ng b\nf 1 3 4\n",
             6000);
    }

    TEST_CASE("damaged WAD files give errors, not crashes") {
        fuzz("fuzz.wad", test_files::Wad().file(), 6000);
    }
}
