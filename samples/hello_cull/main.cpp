// SPDX-License-Identifier: MIT
// A thousand boxes on a plane: which of them does the camera see, and what did the answer cost?
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdio>
#include <vector>

int main() {
    std::vector<crofton::Obb> boxes;
    for (int i = 0; i < 1000; ++i) {
        crofton::Obb box;  // axis-aligned; `axes` would turn it
        box.center = {4.0 * (i % 40) - 78.0, 0.0, -4.0 * (i / 40)};
        box.half_extents = {1.0f, 2.0f, 1.0f};
        boxes.push_back(box);
    }
    const auto tree = crofton::boxtree::BoxTree::build(boxes);
    if (!tree) return std::fprintf(stderr, "%s\n", tree.error().message.c_str()), 1;

    crofton::Camera camera;  // reversed-Z, right-handed; docs/conventions.md
    camera.position = {0.0, 1.8, 5.0};
    crofton::cull::VisibleSet visible;  // keeps its memory: no allocation once warm
    for (int frame = 0; frame < 3; ++frame) {
        camera.position.x += 1.0;
        const auto frustum = crofton::frustum_of(camera);
        if (!frustum) return std::fprintf(stderr, "%s\n", frustum.error().message.c_str()), 1;
        crofton::cull::find_visible(*tree, {.frustum = *frustum}, visible);
        // for (auto id : visible.ids()) draw(objects[id]);
        std::printf("frame %d: %zu of %zu boxes in view, %llu tested\n", frame, visible.size(), boxes.size(),
                    static_cast<unsigned long long>(visible.statistics().boxes_tested));
    }
    return visible.size() > 0 && visible.size() < boxes.size() ? 0 : 1;
}
