// SPDX-License-Identifier: MIT
// The built-in interior: a room with a window, a table, chairs, a shelf and a lamp; every face looks into the air.
#include "assets/mesh_builder.hpp"
#include "assets/scene_source.hpp"

namespace crofton::assets {
namespace {

constexpr double kWidth = 5.0, kHeight = 2.7, kDepth = 4.0;

MeshBuilder shell() {
    MeshBuilder b;
    const glm::vec3 wall = srgb(232, 224, 206), red = srgb(190, 92, 74), floor = srgb(164, 120, 82),
                    white = srgb(244, 242, 238);
    b.quad({0, 0, kDepth}, {kWidth, 0, kDepth}, {kWidth, 0, 0}, {0, 0, 0}, floor);
    b.quad({0, kHeight, 0}, {kWidth, kHeight, 0}, {kWidth, kHeight, kDepth}, {0, kHeight, kDepth}, white);
    b.quad({0, 0, 0}, {kWidth, 0, 0}, {kWidth, kHeight, 0}, {0, kHeight, 0}, wall);
    b.quad({0, 0, kDepth}, {0, 0, 0}, {0, kHeight, 0}, {0, kHeight, kDepth}, red);
    b.quad({kWidth, 0, kDepth}, {0, 0, kDepth}, {0, kHeight, kDepth}, {kWidth, kHeight, kDepth}, wall);
    // The wall at x = kWidth around a window, and its reveal.
    const double z0 = 1.1, z1 = 2.9, y0 = 0.9, y1 = 2.3, out = kWidth + 0.3;
    const auto side = [&](double za, double zb, double ya, double yb) {
        b.quad({kWidth, ya, za}, {kWidth, ya, zb}, {kWidth, yb, zb}, {kWidth, yb, za}, wall);
    };
    side(0, z0, 0, y0);
    side(z0, z1, 0, y0);
    side(z1, kDepth, 0, y0);
    side(0, z0, y0, y1);
    side(z1, kDepth, y0, y1);
    side(0, z0, y1, kHeight);
    side(z0, z1, y1, kHeight);
    side(z1, kDepth, y1, kHeight);
    b.quad({kWidth, y0, z1}, {out, y0, z1}, {out, y0, z0}, {kWidth, y0, z0}, white);
    b.quad({kWidth, y1, z0}, {out, y1, z0}, {out, y1, z1}, {kWidth, y1, z1}, white);
    b.quad({kWidth, y0, z0}, {out, y0, z0}, {out, y1, z0}, {kWidth, y1, z0}, white);
    b.quad({kWidth, y1, z1}, {out, y1, z1}, {out, y0, z1}, {kWidth, y0, z1}, white);
    return b;
}

MeshBuilder furniture() {
    MeshBuilder b;
    const glm::vec3 wood = srgb(170, 120, 70), blue = srgb(70, 100, 150), green = srgb(90, 130, 90),
                    dark = srgb(110, 76, 48);
    b.box({1.6, 0.72, 1.3}, {3.4, 0.78, 2.4}, wood);
    for (const double x : {1.7, 3.22})
        for (const double z : {1.4, 2.22}) b.box({x, 0.0, z}, {x + 0.08, 0.72, z + 0.08}, wood);
    for (const double x : {1.9, 2.7}) {
        b.box({x, 0.42, 2.5}, {x + 0.42, 0.46, 2.92}, blue);
        b.box({x, 0.46, 2.88}, {x + 0.42, 0.95, 2.92}, blue);
        for (const double dx : {0.0, 0.37})
            for (const double dz : {0.0, 0.37}) b.box({x + dx, 0.0, 2.5 + dz}, {x + dx + 0.05, 0.42, 2.55 + dz}, dark);
    }
    b.box({0.02, 0.0, 0.3}, {0.4, 1.9, 0.34}, dark);
    b.box({0.02, 0.0, 1.6}, {0.4, 1.9, 1.64}, dark);
    for (int k = 0; k < 5; ++k) b.box({0.02, 0.1 + 0.44 * k, 0.34}, {0.4, 0.13 + 0.44 * k, 1.6}, dark);
    b.box({0.1, 0.57, 0.5}, {0.35, 0.85, 0.7}, green);
    b.box({0.1, 0.57, 0.72}, {0.33, 0.82, 0.8}, srgb(200, 160, 60));
    b.box({0.1, 1.01, 0.9}, {0.35, 1.3, 1.4}, srgb(180, 70, 60));
    b.box({2.3, 0.78, 1.7}, {2.55, 1.0, 1.95}, srgb(230, 226, 220));
    return b;
}

MeshBuilder lamp() {
    MeshBuilder b;
    b.box({2.48, 2.2, 1.83}, {2.52, kHeight - 0.01, 1.87}, srgb(40, 40, 44));
    b.glow({7.0f, 5.6f, 4.0f});
    b.box({2.36, 1.96, 1.71}, {2.64, 2.2, 1.99}, srgb(244, 236, 220));
    return b;
}

}  // namespace

Result<SceneSource> make_room(const LoadOptions& options) {
    SceneSource source{"room", scene::Scene({options.criterion}), {}, {}, {}, {}};
    const auto root = source.scene.add_node(scene::kNone, {}, ~0u, "room");
    if (!root) return root.error();
    for (MeshBuilder part : {shell(), furniture(), lamp()}) {
        source.emission.push_back(part.take_emission());
        const auto id = source.scene.add_mesh(part.take(), "room");
        if (!id) return id.error();
        if (auto added = source.scene.add_instance(*root, *id); !added) return added.error();
    }
    source.walk = {{0.7, 1.6, 3.4}, {4.3, 1.6, 3.4}, {4.3, 1.6, 0.6}, {1.0, 1.6, 0.6}};
    return source;
}

}  // namespace crofton::assets
