// SPDX-License-Identifier: MIT
// The built-in hall: an engine of about 10^6 triangles in a few large meshes, and the building around it.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/scene_maker.hpp"

namespace crofton::assets {
namespace hall {
namespace {

constexpr double kLength = 44.0, kWidth = 26.0, kHeight = 12.0;  // inside, along x, z, y
constexpr double kPi = std::numbers::pi;
constexpr int kCylinders = 8;
constexpr double kBore = 0.85, kPitch = 2.3;  // of the cylinders
constexpr double kBed = 0.9;                  // height of what the engine stands on
constexpr double kShaft = 2.1;                // height of its shafts

// y of a solid of revolution becomes x.
Transform lying(const glm::dvec3& at) {
    return {glm::dmat3(0, -1, 0, 1, 0, 0, 0, 0, 1), at};
}

// `count` heads around a circle, pointing up.
void add_bolts(MeshBuilder& b, double radius, double y, int count, double size, const glm::vec3& color) {
    const Transform frame = b.frame;
    const std::array<glm::dvec2, 6> head{glm::dvec2(0.0, 0.0),      {size, 0.0},
                                         {size, 0.7 * size},        {0.85 * size, 0.85 * size},
                                         {0.45 * size, 1.3 * size}, {0.0, 1.3 * size}};
    for (int k = 0; k < count; ++k) {
        const double angle = 2.0 * kPi * k / count;
        b.frame = frame * Transform{glm::dmat3(1.0), {radius * std::cos(angle), y, radius * std::sin(angle)}};
        b.lathe(head, 12, color);
    }
    b.frame = frame;
}

// A tower with cooling fins, flanges and a domed head.
void add_cylinder(MeshBuilder& b, const glm::dvec3& foot) {
    const glm::vec3 iron = srgb(86, 104, 96), steel = srgb(176, 178, 182), brass = srgb(190, 150, 70);
    b.frame = Transform{glm::dmat3(1.0), foot};
    std::vector<glm::dvec2> profile{{0.0, 0.0}, {kBore + 0.15, 0.0}, {kBore + 0.15, 0.15}, {kBore, 0.2}};
    constexpr int kFins = 44;
    for (int k = 0; k < kFins; ++k) {
        const double y = 0.3 + 2.6 * k / kFins, thick = 2.6 / kFins;
        for (const glm::dvec2 p :
             {glm::dvec2(-0.06, 0.0), {0.05, 0.15}, {0.06, 0.3}, {0.06, 0.5}, {0.05, 0.65}, {-0.06, 0.8}})
            profile.push_back({kBore - 0.05 + p.x, y + thick * p.y});
    }
    profile.push_back({kBore + 0.12, 3.0});
    profile.push_back({kBore + 0.12, 3.2});
    for (int k = 0; k <= 12; ++k) {
        const double angle = 0.5 * kPi * k / 12;
        profile.push_back({k == 12 ? 0.0 : kBore * std::cos(angle), 3.2 + 0.5 * std::sin(angle)});
    }
    b.lathe(profile, 80, iron);
    add_bolts(b, kBore + 0.06, 3.2, 28, 0.05, steel);
    add_bolts(b, kBore + 0.1, 0.15, 32, 0.045, steel);
    // A valve chest with a wheel on top.
    constexpr glm::dvec2 kStem[] = {{0.0, 3.6}, {0.06, 3.6}, {0.06, 4.1}, {0.03, 4.12}, {0.0, 4.12}};
    b.lathe(kStem, 24, steel);
    std::vector<glm::dvec2> rim;
    for (int k = 0; k < 20; ++k) {
        const double angle = 2.0 * kPi * k / 20;
        rim.push_back({0.34 + 0.035 * std::cos(angle), 4.08 + 0.035 * std::sin(angle)});
    }
    b.lathe(rim, 60, brass, true);
    for (int k = 0; k < 5; ++k) {
        const double angle = 2.0 * kPi * k / 5;
        const glm::dvec3 out(std::cos(angle), 0.0, std::sin(angle));
        const std::array spoke{0.02 * out + glm::dvec3(0, 4.08, 0), 0.33 * out + glm::dvec3(0, 4.08, 0)};
        b.pipe(spoke, 0.015, 10, brass);
    }
}

// A line through these points, its corners rounded.
std::vector<glm::dvec3> rounded(std::span<const glm::dvec3> corners, double radius) {
    std::vector<glm::dvec3> line{corners.front()};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const glm::dvec3 from = corners[i] + radius * glm::normalize(corners[i - 1] - corners[i]),
                         to = corners[i] + radius * glm::normalize(corners[i + 1] - corners[i]);
        constexpr int kSteps = 24;
        for (int k = 0; k <= kSteps; ++k) {
            const double t = static_cast<double>(k) / kSteps;
            line.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corners[i] + t * t * to);
        }
    }
    line.push_back(corners.back());
    return line;
}

void add_pipes(MeshBuilder& b, town::Library& library) {
    static const std::array paints = {srgb(160, 70, 50), srgb(180, 140, 60), srgb(70, 100, 140), srgb(150, 152, 156)};
    b.frame = Transform{};
    for (int side = 0; side < 2; ++side)
        for (int c = 0; c < kCylinders; ++c)
            for (int k = 0; k < 4; ++k) {
                const double s = side == 0 ? 1.0 : -1.0, x = kPitch * (c - 0.5 * (kCylinders - 1)) + 0.32 * (k - 1.5),
                             out = 1.9 + 0.28 * k, top = 3.0 + 0.45 * k, end = -9.6 + 0.25 * k;
                const double shade = library.random.uniform(0.85, 1.1);
                const glm::vec3 paint = scaled(paints[static_cast<std::size_t>(library.pick(4))], shade);
                const std::array corners{glm::dvec3(x, kBed + 2.2 + 0.2 * k, 0.7 * s),
                                         glm::dvec3(x, kBed + 2.2 + 0.2 * k, out * s),
                                         glm::dvec3(x, top + 2.6, out * s), glm::dvec3(end, top + 2.6, out * s),
                                         glm::dvec3(end, 0.3, out * s)};
                b.pipe(rounded(corners, 0.22), 0.045 + 0.01 * k, 28, paint);
            }
}

void add_gears(MeshBuilder& b) {
    const glm::vec3 steel = srgb(168, 170, 174), bronze = srgb(150, 112, 64);
    struct Wheel {
        double x, y, z, radius;
        int teeth;
    };
    constexpr Wheel kWheels[] = {
        {10.4, kShaft, 0.0, 1.5, 90}, {10.4, kShaft, 2.25, 0.7, 42}, {10.4, kShaft, -2.25, 0.7, 42},
        {10.4, 4.2, 0.0, 0.55, 33},   {10.9, 4.2, 0.0, 1.1, 66},     {10.9, 4.2, 1.7, 0.55, 33},
        {10.9, 4.2, -1.7, 0.55, 33},  {11.4, kShaft, 2.25, 1.2, 72}, {11.4, kShaft, -2.25, 1.2, 72}};
    for (const Wheel& w : kWheels) {
        // Wheels of seven plates side by side, as herringbones are cut.
        for (int plate = 0; plate < 7; ++plate) {
            b.frame = lying({w.x + 0.05 * plate, w.y, w.z}) * standing({}, 0.012 * std::abs(plate - 3));
            b.gear(w.teeth, w.radius, 0.08, 0.12, 0.049, w.teeth > 50 ? steel : bronze);
        }
        b.frame = lying({w.x - 0.3, w.y, w.z});
        constexpr glm::dvec2 kAxle[] = {{0.0, 0.0}, {0.11, 0.0}, {0.11, 1.0}, {0.0, 1.0}};
        b.lathe(kAxle, 48, steel);
        b.frame = lying({w.x + 0.35, w.y, w.z});
        add_bolts(b, 0.5 * w.radius, 0.0, 16, 0.03, steel);
    }
}

void add_flywheel(MeshBuilder& b) {
    const glm::vec3 red = srgb(150, 52, 44), steel = srgb(170, 172, 176);
    b.frame = lying({-11.6, 2.9, 0.0});
    std::vector<glm::dvec2> rim;
    for (int k = 0; k < 40; ++k) {
        const double angle = 2.0 * kPi * k / 40;
        rim.push_back({2.5 + 0.22 * std::cos(angle), 0.3 + 0.3 * std::sin(angle)});
    }
    b.lathe(rim, 360, red, true);
    b.gear(180, 2.72, 0.07, 2.6, 0.1, steel);
    constexpr glm::dvec2 kHub[] = {{0.0, -0.4}, {0.35, -0.4}, {0.42, -0.3}, {0.42, 0.9}, {0.35, 1.0}, {0.0, 1.0}};
    b.lathe(kHub, 96, red);
    for (int k = 0; k < 8; ++k) {
        const double angle = 2.0 * kPi * k / 8;
        const glm::dvec3 out(std::cos(angle), 0.0, std::sin(angle));
        std::array<glm::dvec3, 24> spoke;
        for (std::size_t i = 0; i < spoke.size(); ++i) {
            const double t = static_cast<double>(i) / 23.0;
            spoke[i] = (0.35 + 2.0 * t) * out + glm::dvec3(0.0, 0.3 + 0.08 * std::sin(kPi * t), 0.0);
        }
        b.pipe(spoke, 0.12, 32, red);
    }
    add_bolts(b, 0.3, 1.0, 20, 0.035, steel);
}

void add_generator(MeshBuilder& b) {
    const glm::vec3 paint = srgb(70, 100, 120), copper = srgb(170, 98, 60);
    b.frame = lying({12.6, 2.3, 0.0});
    std::vector<glm::dvec2> profile{{0.0, 0.0}, {1.3, 0.0}, {1.5, 0.2}};
    constexpr int kRibs = 60;
    for (int k = 0; k < kRibs; ++k) {
        const double y = 0.3 + 3.4 * k / kRibs, thick = 3.4 / kRibs;
        for (const glm::dvec2 p :
             {glm::dvec2(1.5, 0.1), {1.58, 0.2}, {1.6, 0.35}, {1.6, 0.5}, {1.58, 0.65}, {1.5, 0.75}})
            profile.push_back({p.x, y + thick * p.y});
    }
    for (const glm::dvec2 p : {glm::dvec2(1.5, 3.8), {1.2, 4.1}, {0.5, 4.2}, {0.4, 4.9}, {0.0, 4.9}})
        profile.push_back(p);
    b.lathe(profile, 240, paint);
    // Windings show at the end.
    for (int k = 0; k < 36; ++k) {
        const double angle = 2.0 * kPi * k / 36;
        std::array<glm::dvec3, 16> coil;
        for (std::size_t i = 0; i < coil.size(); ++i) {
            const double t = static_cast<double>(i) / 15.0, turn = angle + 0.35 * t, r = 0.62 + 0.3 * std::sin(kPi * t);
            coil[i] = {r * std::cos(turn), 4.1 + 0.35 * std::sin(kPi * t), r * std::sin(turn)};
        }
        b.pipe(coil, 0.04, 16, copper);
    }
    add_bolts(b, 1.4, 0.12, 48, 0.04, srgb(160, 162, 166));
}

void add_bed(MeshBuilder& b) {
    const glm::vec3 concrete = srgb(150, 148, 142), iron = srgb(72, 84, 80), steel = srgb(150, 152, 156);
    b.frame = Transform{};
    b.box({-13.2, 0.0, -3.4}, {18.2, 0.5, 3.4}, concrete);
    b.box({-9.8, 0.5, -1.3}, {9.9, kBed, 1.3}, iron);
    for (const double z : {-1.0, 1.0}) b.box({12.8, 0.5, z - 0.25}, {16.0, 1.2, z + 0.25}, iron);
    for (const double z : {-0.5, 0.5}) {
        b.box({-12.3, 0.5, z - 0.2}, {-11.9, 2.9, z + 0.2}, iron);
        b.box({-10.6, 0.5, z - 0.2}, {-10.2, 2.9, z + 0.2}, iron);
    }
    b.frame = lying({-12.4, 2.9, 0.0});
    constexpr glm::dvec2 kLong[] = {{0.0, 0.0}, {0.14, 0.0}, {0.14, 2.6}, {0.0, 2.6}};
    b.lathe(kLong, 64, steel);
    b.frame = Transform{};
    for (int k = 0; k < 40; ++k) {
        const double x = -9.4 + 0.48 * k;
        for (const double z : {-1.2, 1.2}) {
            b.frame = Transform{glm::dmat3(1.0), {x, kBed, z}};
            add_bolts(b, 0.05, 0.0, 3, 0.035, steel);
        }
    }
}

void add_building(SceneMaker& maker) {
    const double x1 = 0.5 * kLength, z1 = 0.5 * kWidth;
    const glm::vec3 brick = srgb(150, 96, 78), steel = srgb(96, 110, 112);
    MeshBuilder floor;
    floor.box({-x1 - 0.4, -0.3, -z1 - 0.4}, {x1 + 0.4, 0.0, z1 + 0.4}, srgb(136, 134, 128));
    maker.place(floor, "floor");
    MeshBuilder ground;
    ground.box({-80.0, -0.9, -80.0}, {80.0, -0.3, 80.0}, srgb(112, 122, 90));
    maker.place(ground, "ground");
    for (const double s : {-1.0, 1.0}) {
        // Tall windows between pillars.
        MeshBuilder side;
        const double z = s * (z1 + 0.2);
        side.box({-x1, 0.0, z - 0.2}, {x1, 1.4, z + 0.2}, brick);
        side.box({-x1, 8.6, z - 0.2}, {x1, kHeight, z + 0.2}, brick);
        for (int k = 0; k <= 11; ++k) {
            const double x = -x1 + kLength * k / 11.0;
            side.box({std::max(x - 0.6, -x1), 1.4, z - 0.2}, {std::min(x + 0.6, x1), 8.6, z + 0.2}, brick);
        }
        maker.place(side, "long wall");
        MeshBuilder end;
        const double x = s * (x1 + 0.2);
        end.box({x - 0.2, 0.0, -z1}, {x + 0.2, kHeight, -2.5}, brick);
        end.box({x - 0.2, 0.0, 2.5}, {x + 0.2, kHeight, z1}, brick);
        end.box({x - 0.2, 5.0, -2.5}, {x + 0.2, kHeight, 2.5}, brick);
        maker.place(end, "end wall");
        MeshBuilder rail;
        rail.box({-x1, 8.9, s * (z1 - 0.9) - 0.15}, {x1, 9.3, s * (z1 - 0.9) + 0.15}, srgb(170, 130, 40));
        maker.place(rail, "crane rail");
    }
    MeshBuilder roof;
    roof.box({-x1 - 0.4, kHeight, -z1 - 0.4}, {x1 + 0.4, kHeight + 0.3, z1 + 0.4}, srgb(180, 178, 170));
    maker.place(roof, "roof");
    MeshBuilder truss;
    for (int k = 0; k < 13; ++k) {
        const double z0 = -z1 + kWidth * k / 13.0, middle = z0 + 1.0, z2 = z0 + 2.0;
        for (const auto& line : {std::array{glm::dvec3(0, 10.4, z0), glm::dvec3(0, 11.8, middle)},
                                 std::array{glm::dvec3(0, 11.8, middle), glm::dvec3(0, 10.4, z2)}})
            truss.pipe(line, 0.06, 10, steel);
    }
    truss.box({-0.1, 10.3, -z1}, {0.1, 10.5, z1}, steel);
    truss.box({-0.1, 11.7, -z1}, {0.1, 11.9, z1}, steel);
    const scene::MeshId trusses = maker.library.add(truss, "truss");
    for (int k = 1; k < 11; ++k) maker.place(trusses, {-x1 + kLength * k / 11.0, 0.0, 0.0});
    MeshBuilder lamp;
    constexpr glm::dvec2 kShade[] = {{0.0, -0.5},  {0.3, -0.6}, {0.45, -0.6}, {0.2, -0.3},
                                     {0.05, -0.2}, {0.05, 0.0}, {0.0, 0.0}};
    lamp.lathe(kShade, 32, srgb(60, 80, 70));
    const scene::MeshId lamps = maker.library.add(lamp, "lamp");
    for (int k = 1; k < 11; ++k)
        for (const double z : {-6.5, 0.0, 6.5}) maker.place(lamps, {-x1 + kLength * k / 11.0, 10.3, z});
}

// Adds small things: barrels, crates, workbenches, a rail around the engine.
void add_clutter(SceneMaker& maker) {
    auto& library = maker.library;
    MeshBuilder barrel;
    constexpr glm::dvec2 kBarrel[] = {{0.0, 0.0},  {0.28, 0.0},   {0.3, 0.02}, {0.3, 0.28}, {0.315, 0.3}, {0.3, 0.32},
                                      {0.3, 0.56}, {0.315, 0.58}, {0.3, 0.6},  {0.3, 0.86}, {0.28, 0.88}, {0.0, 0.88}};
    barrel.lathe(kBarrel, 32, srgb(60, 90, 130));
    const scene::MeshId barrels = library.add(barrel, "barrel");
    MeshBuilder crate;
    crate.box({-0.5, 0.0, -0.5}, {0.5, 0.9, 0.5}, srgb(160, 124, 80));
    for (const double x : {-0.5, 0.4})
        for (const double z : {-0.53, 0.5}) crate.box({x, 0.0, z}, {x + 0.1, 0.9, z + 0.03}, srgb(130, 98, 60));
    const scene::MeshId crates = library.add(crate, "crate");
    MeshBuilder bench;
    bench.box({-1.2, 0.8, -0.4}, {1.2, 0.88, 0.4}, srgb(150, 116, 78));
    for (const double x : {-1.1, 1.0})
        for (const double z : {-0.35, 0.25}) bench.box({x, 0.0, z}, {x + 0.1, 0.8, z + 0.1}, srgb(90, 92, 96));
    for (int k = 0; k < 9; ++k) {
        const double x = -1.0 + 0.24 * k;
        const std::array tool{glm::dvec3(x, 0.9, -0.2), glm::dvec3(x + 0.03, 0.91, 0.05),
                              glm::dvec3(x + 0.1, 0.9, 0.12)};
        bench.pipe(tool, 0.018, 10, srgb(140, 142, 146));
    }
    const scene::MeshId benches = library.add(bench, "workbench");
    MeshBuilder rail;
    for (const double y : {0.55, 1.05}) {
        const std::array bar{glm::dvec3(0.0, y, 0.0), glm::dvec3(2.0, y, 0.0)};
        rail.pipe(bar, 0.025, 12, srgb(196, 160, 40));
    }
    for (const double x : {0.0, 1.0}) {
        const std::array post{glm::dvec3(x, 0.0, 0.0), glm::dvec3(x, 1.08, 0.0)};
        rail.pipe(post, 0.03, 12, srgb(196, 160, 40));
    }
    const scene::MeshId rails = library.add(rail, "rail");
    for (int k = 0; k < 16; ++k)
        for (const double z : {-4.0, 4.0}) maker.place(rails, {-13.8 + 2.0 * k, 0.0, z});
    for (int k = 0; k < 60; ++k) {
        const double x = library.random.uniform(-20.5, 20.5), s = library.chance(0.5) ? 1.0 : -1.0,
                     z = s * library.random.uniform(9.6, 12.2), turn = library.random.uniform(0.0, 6.28);
        maker.place(library.chance(0.6) ? barrels : crates, {x, 0.0, z}, turn);
    }
    for (int k = 0; k < 8; ++k)
        maker.place(benches, {-17.5 + 5.0 * k, 0.0, k % 2 == 0 ? 8.6 : -8.6}, k % 2 == 0 ? kPi : 0.0);
}

Result<SceneSource> make(const LoadOptions& options) {
    SceneMaker maker("hall", options);
    add_building(maker);
    add_clutter(maker);
    MeshBuilder cylinders, pipes, gears, wheel, generator, bed;
    for (int c = 0; c < kCylinders; ++c) add_cylinder(cylinders, {kPitch * (c - 0.5 * (kCylinders - 1)), kBed, 0.0});
    add_pipes(pipes, maker.library);
    add_gears(gears);
    add_flywheel(wheel);
    add_generator(generator);
    add_bed(bed);
    maker.place(cylinders, "engine: cylinders");
    maker.place(pipes, "engine: pipes");
    maker.place(gears, "engine: gears");
    maker.place(wheel, "engine: flywheel");
    maker.place(generator, "engine: generator");
    maker.place(bed, "engine: bed");
    constexpr double kEye = 1.7;
    return maker.take({{-16.5, kEye, 6.5},
                       {18.5, kEye, 6.5},
                       {19.8, kEye, 0.0},
                       {18.5, kEye, -6.5},
                       {-16.5, kEye, -6.5},
                       {-16.5, kEye, 5.0}});
}

}  // namespace
}  // namespace hall

Result<SceneSource> make_hall(const LoadOptions& options) {
    return hall::make(options);
}

}  // namespace crofton::assets
