// SPDX-License-Identifier: MIT
// The same for crofton::bake.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>

int main() {
    const crofton::Polygon square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {4}};
    const auto triangles = crofton::triangulate::triangulate(square);
    bool good = triangles && triangles->triangles.size() == 2;
    good = good && !crofton::bake::BakedScene::from_memory({}).has_value();
    good = good && !crofton::pvs::Pvs::open("").has_value();
    std::printf("crofton::bake: %s\n", good ? "answers" : "is wrong");
    return good ? 0 : 1;
}
