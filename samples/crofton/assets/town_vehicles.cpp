// SPDX-License-Identifier: MIT
// Cars, vans, buses and lorries with trailers, driving toward +x.
#include <array>

#include "assets/town_library.hpp"

namespace crofton::assets::town {
namespace {

const glm::vec3 kTyre = srgb(28, 28, 30), kGlass = srgb(44, 56, 68), kChrome = srgb(180, 184, 188);

void add_wheel(MeshBuilder& b, double x, double z, double radius) {
    const double side = z > 0.0 ? 1.0 : -1.0;
    b.tube({x, radius, z - side * 0.22}, {x, radius, z}, radius, radius, 10, kTyre, true);
    b.tube({x, radius, z}, {x, radius, z + side * 0.01}, radius, 0.0, 10, kTyre, true);
    b.tube({x, radius, z}, {x, radius, z + side * 0.03}, 0.55 * radius, 0.0, 6, kChrome, true);
}

void add_lights(MeshBuilder& b, double front, double back, double y, double half_width) {
    for (const double s : {-1.0, 1.0}) {
        const double z = s * (half_width - 0.24);
        b.box({front - 0.05, y - 0.08, z - 0.15}, {front + 0.02, y + 0.08, z + 0.15}, srgb(250, 244, 220));
        b.box({back - 0.02, y - 0.06, z - 0.16}, {back + 0.05, y + 0.08, z + 0.16}, srgb(178, 24, 20));
    }
}

// Lower body and cabin as swept profiles, the cabin's windows as its sides.
scene::MeshId make_car(Library& library, const glm::vec3& paint, double length, double cabin_back, double cabin_front) {
    MeshBuilder b;
    const double f = 0.5 * length, w = 1.74;
    const std::array<glm::dvec2, 8> body = {{{-f, 0.32},
                                             {f - 0.1, 0.28},
                                             {f, 0.45},
                                             {f - 0.04, 0.68},
                                             {cabin_front + 0.5, 0.86},
                                             {cabin_back - 0.35, 0.9},
                                             {-f + 0.05, 0.84},
                                             {-f - 0.02, 0.5}}};
    b.sweep(body, w, paint, scaled(paint, 0.94));
    const std::array<glm::dvec2, 4> cabin = {
        {{cabin_back - 0.3, 0.88}, {cabin_front + 0.45, 0.86}, {cabin_front - 0.25, 1.38}, {cabin_back + 0.1, 1.40}}};
    b.sweep(cabin, w - 0.28, kGlass, kGlass);
    b.box({cabin_back + 0.02, 1.385, -0.5 * w + 0.16}, {cabin_front - 0.2, 1.45, 0.5 * w - 0.16}, paint);
    const double middle = 0.5 * (cabin_back + cabin_front);
    for (const double s : {-1.0, 1.0})
        b.box({middle - 0.05, 0.86, s * (0.5 * w - 0.15) - 0.02}, {middle + 0.05, 1.4, s * (0.5 * w - 0.15) + 0.02},
              paint);
    for (const double x : {-0.62 * f, 0.62 * f})
        for (const double z : {-0.5 * w - 0.01, 0.5 * w + 0.01}) add_wheel(b, x, z, 0.32);
    add_lights(b, f, -f, 0.62, 0.5 * w);
    return library.add(b, "car");
}

scene::MeshId make_van(Library& library, const glm::vec3& paint) {
    MeshBuilder b;
    const std::array<glm::dvec2, 6> body = {
        {{-2.6, 0.35}, {2.55, 0.35}, {2.65, 0.95}, {1.95, 1.2}, {1.45, 2.15}, {-2.6, 2.2}}};
    b.sweep(body, 1.95, paint, scaled(paint, 0.95));
    for (const double s : {-1.0, 1.0})
        b.quad({s * 0.0 + 0.55, 1.25, s * 0.985}, {s > 0 ? 1.75 : 0.55, s > 0 ? 1.25 : 1.95, s * 0.985},
               {1.40, 1.95, s * 0.985}, {s > 0 ? 0.55 : 1.75, s > 0 ? 1.95 : 1.25, s * 0.985}, kGlass);
    b.quad({1.97, 1.24, 0.8}, {1.97, 1.24, -0.8}, {1.52, 2.06, -0.8}, {1.52, 2.06, 0.8}, kGlass);
    for (const double x : {-1.6, 1.7})
        for (const double z : {-0.99, 0.99}) add_wheel(b, x, z, 0.36);
    add_lights(b, 2.64, -2.6, 0.75, 0.97);
    return library.add(b, "van");
}

scene::MeshId make_bus(Library& library, const glm::vec3& paint) {
    MeshBuilder b;
    b.box({-5.5, 0.35, -1.25}, {5.5, 1.25, 1.25}, paint);
    b.box({-5.45, 1.25, -1.22}, {5.45, 2.55, 1.22}, kGlass);
    b.box({-5.5, 2.55, -1.25}, {5.5, 2.95, 1.25}, srgb(238, 234, 224));
    for (int k = 0; k <= 6; ++k)
        for (const double s : {-1.0, 1.0})
            b.box({-5.5 + 1.8 * k, 1.25, s * 1.23 - 0.02}, {-5.3 + 1.8 * k, 2.55, s * 1.23 + 0.02}, paint);
    for (const double x : {-3.4, 3.6})
        for (const double z : {-1.27, 1.27}) add_wheel(b, x, z, 0.48);
    add_lights(b, 5.5, -5.5, 0.8, 1.25);
    return library.add(b, "bus");
}

scene::MeshId make_lorry(Library& library, const glm::vec3& paint) {
    MeshBuilder b;
    const std::array<glm::dvec2, 5> cab = {{{-0.9, 0.5}, {1.2, 0.5}, {1.25, 1.3}, {0.95, 2.7}, {-0.9, 2.75}}};
    b.frame.translation = {2.0, 0.0, 0.0};
    b.sweep(cab, 2.3, paint, scaled(paint, 0.95));
    b.quad({1.27, 1.45, 1.0}, {1.27, 1.45, -1.0}, {1.02, 2.5, -1.0}, {1.02, 2.5, 1.0}, kGlass);
    for (const double s : {-1.0, 1.0}) b.box({-0.1, 1.5, s * 1.15 - 0.02}, {0.85, 2.4, s * 1.15 + 0.02}, kGlass);
    add_lights(b, 1.24, -0.9, 0.8, 1.15);
    b.frame.translation = {};
    b.box({-2.6, 0.55, -0.5}, {1.2, 0.85, 0.5}, srgb(50, 52, 54));
    for (const double x : {-1.9, 2.4})
        for (const double z : {-1.15, 1.15}) add_wheel(b, x, z, 0.48);
    return library.add(b, "lorry");
}

scene::MeshId make_trailer(Library& library, const glm::vec3& paint) {
    MeshBuilder b;
    b.box({-7.6, 1.05, -1.25}, {0.3, 3.4, 1.25}, paint);
    b.box({-7.6, 0.75, -0.6}, {0.3, 1.05, 0.6}, srgb(50, 52, 54));
    for (const double x : {-6.4, -5.3})
        for (const double z : {-1.2, 1.2}) add_wheel(b, x, z, 0.48);
    return library.add(b, "trailer");
}

}  // namespace

std::vector<Vehicle> make_vehicles(Library& library) {
    const std::array paints = {srgb(176, 40, 36), srgb(40, 74, 130),  srgb(226, 226, 222), srgb(52, 56, 60),
                               srgb(70, 110, 84), srgb(214, 168, 56), srgb(146, 150, 156)};
    std::vector<Vehicle> result;
    for (const glm::vec3& paint : paints) {
        result.push_back({make_car(library, paint, 4.4, -1.3, 0.55), scene::kNone, 0.0});                // saloon
        result.push_back({make_car(library, scaled(paint, 0.85), 3.7, -1.35, 0.5), scene::kNone, 0.0});  // hatchback
        result.push_back({make_car(library, scaled(paint, 1.05), 4.6, -1.95, 0.6), scene::kNone, 0.0});  // estate
    }
    result.push_back({make_van(library, srgb(232, 230, 224)), scene::kNone, 0.0});
    result.push_back({make_van(library, srgb(206, 150, 40)), scene::kNone, 0.0});
    result.push_back({make_bus(library, srgb(186, 46, 40)), scene::kNone, 0.0});
    result.push_back({make_lorry(library, srgb(52, 88, 140)), make_trailer(library, srgb(220, 222, 220)), 1.9});
    result.push_back({make_lorry(library, srgb(170, 60, 40)), make_trailer(library, srgb(120, 140, 150)), 1.9});
    return result;
}

scene::MeshId make_street(Library& library, double length, double width) {
    MeshBuilder b;
    const glm::vec3 asphalt = srgb(92, 92, 94), paint = srgb(216, 214, 206);
    const double h = 0.5 * width, y = 0.02;
    b.quad({0, 0, h}, {length, 0, h}, {length, 0, -h}, {0, 0, -h}, asphalt);
    const auto mark = [&](double x0, double x1, double z0, double z1) {
        b.quad({x0, y, z1}, {x1, y, z1}, {x1, y, z0}, {x0, y, z0}, paint);
    };
    for (const double end : {1.0, length - 4.0})
        for (int k = 0; k < 7; ++k) mark(end, end + 3.0, -h + 0.35 + 1.02 * k, -h + 0.9 + 1.02 * k);
    const int dashes = static_cast<int>((length - 12.0) / 4.0);
    for (int k = 0; k < dashes; ++k) {
        const double x = 6.0 + (k + 0.25) * (length - 12.0) / dashes;
        mark(x, x + 2.0, -0.07, 0.07);
    }
    return library.add(b, "street");
}

}  // namespace crofton::assets::town
