// SPDX-License-Identifier: MIT
// The built-in office: three storeys of rooms along a corridor, full of furniture.
#include <numbers>

#include "assets/office_furniture.hpp"
#include "assets/scene_maker.hpp"

namespace crofton::assets {
namespace office {
namespace {

constexpr double kLength = 48.0, kDepth = 30.0, kRoom = 2.8, kStorey = 3.2, kWall = 0.16;
constexpr int kStoreys = 3, kRooms = 10;
// The corridor's sides, along x; small rooms lie behind the first, one large one before the second.
constexpr double kSouth = 14.0, kNorth = 16.4;
constexpr double kPi = std::numbers::pi;

// A hole in a wall: where along it, and from which height to which.
struct Hole {
    double from, to, low, high;
};

// Along x at z, or along z at x, on the floor y = 0.
void add_wall(MeshBuilder& b, bool along_x, double at, double from, double to, std::span<const Hole> holes,
              const glm::vec3& color) {
    const auto piece = [&](double a, double c, double low, double high) {
        if (c - a < 1e-6 || high - low < 1e-6) return;
        const double half = 0.5 * kWall;
        if (along_x)
            b.box({a, low, at - half}, {c, high, at + half}, color);
        else
            b.box({at - half, low, a}, {at + half, high, c}, color);
    };
    double done = from;
    for (const Hole& hole : holes) {
        piece(done, hole.from, 0.0, kRoom);
        piece(hole.from, hole.to, 0.0, hole.low);
        piece(hole.from, hole.to, hole.high, kRoom);
        done = hole.to;
    }
    piece(done, to, 0.0, kRoom);
}

std::vector<Hole> windows(double from, double to, double width, double gap) {
    std::vector<Hole> holes;
    for (double x = from + gap; x + width <= to - 0.3; x += width + gap) holes.push_back({x, x + width, 0.85, 2.3});
    return holes;
}

struct Furniture {
    std::vector<scene::MeshId> desks, chairs, screens, lamps, shelves, cabinets, plants, sofas, mugs, boards;
    scene::MeshId computer, table, bin, printer, kitchen, light, door;
};

Furniture make_furniture(town::Library& library) {
    Furniture f;
    const auto some = [&](int count, auto make) {
        std::vector<scene::MeshId> result;
        for (int k = 0; k < count; ++k) result.push_back(make(library));
        return result;
    };
    f.desks = some(3, make_desk);
    f.chairs = some(4, make_chair);
    f.screens = some(4, make_screen);
    f.lamps = some(2, make_desk_lamp);
    f.shelves = some(6, make_bookshelf);
    f.cabinets = some(2, make_cabinet);
    f.plants = some(4, make_plant);
    f.sofas = some(3, make_sofa);
    f.mugs = some(3, make_mug);
    f.boards = some(3, make_whiteboard);
    f.computer = make_computer(library);
    f.table = make_meeting_table(library);
    f.bin = make_bin(library);
    f.printer = make_printer(library);
    f.kitchen = make_kitchen(library);
    f.light = make_ceiling_light(library);
    f.door = make_door(library);
    return f;
}

class Storey {
  public:
    Storey(SceneMaker& maker, const Furniture& furniture, double y) : maker_(maker), f_(furniture), y_(y) {}

    void add() {
        add_shell();
        for (int room = 0; room < kRooms; ++room) add_room(room);
        add_open_plan();
        for (double x = 2.0; x < kLength; x += 4.0) place(f_.light, x, kRoom, 0.5 * (kSouth + kNorth), 0.0);
        for (const double x : {6.0, 20.0, 34.0}) place(any(f_.plants), x, 0.0, kNorth - 0.35, 0.0);
        place(f_.printer, 27.0, 0.0, kSouth + 0.45, 0.0);
    }

  private:
    void place(scene::MeshId mesh, double x, double y, double z, double turn) {
        maker_.place(mesh, {x, y_ + y, z}, turn);
    }
    scene::MeshId any(const std::vector<scene::MeshId>& list) {
        return list[static_cast<std::size_t>(maker_.library.pick(static_cast<int>(list.size())))];
    }
    // Each wall is a mesh of its own.
    void wall(bool along_x, double at, double from, double to, std::span<const Hole> holes, const glm::vec3& color) {
        MeshBuilder b;
        b.frame.translation = {0.0, y_, 0.0};
        add_wall(b, along_x, at, from, to, holes, color);
        maker_.place(b, "wall");
    }

    void add_shell() {
        const glm::vec3 paint = srgb(226, 224, 216), outside = srgb(190, 182, 168);
        MeshBuilder floor, ceiling;
        floor.box({0.0, y_ - 0.2, 0.0}, {kLength, y_, kDepth}, srgb(116, 118, 122));
        maker_.place(floor, "floor");
        ceiling.box({0.0, y_ + kRoom, 0.0}, {kLength, y_ + kStorey - 0.2, kDepth}, srgb(238, 238, 234));
        maker_.place(ceiling, "ceiling");
        const auto long_side = windows(0.0, kLength, 1.9, 0.5), short_side = windows(0.0, kDepth, 1.9, 0.9);
        wall(true, 0.5 * kWall, 0.0, kLength, long_side, outside);
        wall(true, kDepth - 0.5 * kWall, 0.0, kLength, long_side, outside);
        wall(false, 0.5 * kWall, kWall, kDepth - kWall, short_side, outside);
        wall(false, kLength - 0.5 * kWall, kWall, kDepth - kWall, short_side, outside);
        std::vector<Hole> doors, ways;
        for (int room = 0; room < kRooms; ++room) doors.push_back({4.8 * room + 0.6, 4.8 * room + 1.6, 0.0, 2.1});
        for (const double x : {8.0, 24.0, 40.0}) ways.push_back({x - 1.2, x + 1.2, 0.0, 2.4});
        wall(true, kSouth - 0.5 * kWall, kWall, kLength - kWall, doors, paint);
        wall(true, kNorth + 0.5 * kWall, kWall, kLength - kWall, ways, paint);
        for (int room = 1; room < kRooms; ++room)
            wall(false, 4.8 * room, kWall, kSouth - kWall, {}, room % 3 == 0 ? srgb(176, 196, 200) : paint);
        // A second row of rooms behind the first, each entered from it.
        for (int room = 0; room < kRooms; ++room) {
            const double x = 4.8 * room;
            const Hole door{x + 3.2, x + 4.2, 0.0, 2.1};
            wall(true, 7.0, x + (room == 0 ? kWall : 0.5 * kWall), x + 4.8 - (room == 9 ? kWall : 0.5 * kWall),
                 {&door, 1}, paint);
        }
    }

    void add_desk(double x, double z, double turn) {
        auto& library = maker_.library;
        const Transform frame = standing({x, y_, z}, turn);
        const auto on = [&](scene::MeshId mesh, const glm::dvec3& at, double own_turn) {
            maker_.place(mesh, frame * standing(at, own_turn));
        };
        on(any(f_.desks), {}, 0.0);
        // One draw after the other: in which order arguments are computed is left to the compiler.
        const double shifted = 0.1 * library.random.uniform(), skewed = 0.2 * library.random.uniform() - 0.1;
        on(any(f_.screens), {shifted, 0.74, -0.1}, skewed);
        const double aside = 0.3 * library.random.uniform() - 0.15, back = 0.3 * library.random.uniform(),
                     swivel = kPi + 1.2 * library.random.uniform() - 0.6;
        on(any(f_.chairs), {aside, 0.0, 0.65 + back}, swivel);
        on(f_.computer, {-0.5, 0.0, -0.1}, 0.0);
        const double lamp_turn = 2.0 * library.random.uniform(), mug_turn = 6.0 * library.random.uniform();
        if (library.chance(0.5)) on(any(f_.lamps), {-0.6, 0.74, -0.2}, lamp_turn);
        if (library.chance(0.6)) on(any(f_.mugs), {0.5, 0.74, 0.1}, mug_turn);
        if (library.chance(0.4)) on(f_.bin, {-0.95, 0.0, 0.3}, 0.0);
    }

    void add_room(int room) {
        auto& library = maker_.library;
        const double x = 4.8 * room, middle = x + 2.4;
        place(f_.door, x + 1.58, 0.0, kSouth - kWall, kPi - 0.5 * kPi * library.random.uniform());
        place(f_.light, middle, kRoom, 10.5, 0.0);
        place(f_.light, middle, kRoom, 3.5, 0.0);
        if (room % 4 == 1) {
            place(f_.table, middle, 0.0, 10.4, 0.5 * kPi);
            for (const double z : {9.3, 10.4, 11.5})
                for (const double side : {-1.0, 1.0})
                    place(any(f_.chairs), middle + 0.95 * side, 0.0, z, side < 0.0 ? 0.5 * kPi : -0.5 * kPi);
            place(any(f_.boards), x + 0.5 * kWall, 0.0, 10.4, 0.5 * kPi);
        } else {
            add_desk(middle - 0.9, 9.0, 0.0);
            add_desk(middle + 0.9, 11.6, kPi);
            for (const double z : {9.4, 10.5}) place(any(f_.shelves), x + 0.08 + 0.18, 0.0, z, 0.5 * kPi);
            place(any(f_.cabinets), x + 4.35, 0.0, 13.2, -0.5 * kPi);
        }
        place(f_.door, x + 4.18, 0.0, 7.0 - 0.5 * kWall, kPi - 0.5 * kPi * library.random.uniform());
        if (room == 4) {
            place(f_.kitchen, middle, 0.0, 0.5, 0.0);
            for (const double z : {3.0, 5.0}) place(any(f_.sofas), x + 0.6, 0.0, z, 0.5 * kPi);
        } else {
            add_desk(middle, 2.2, 0.0);
            for (const double z : {1.2, 2.4, 3.6}) place(any(f_.shelves), x + 4.54, 0.0, z, -0.5 * kPi);
            if (library.chance(0.7)) place(any(f_.plants), x + 0.5, 0.0, 6.2, 0.0);
            place(any(f_.cabinets), x + 0.4, 0.0, 4.6, 0.5 * kPi);
        }
    }

    // Desks in islands of four on both sides of an aisle at z = 23; across it at x = 8, 24, 40.
    void add_open_plan() {
        auto& library = maker_.library;
        for (const double x : {12.0, 16.0, 20.0, 28.0, 32.0, 36.0, 44.0, 4.0})
            for (const double z : {19.6, 26.4}) {
                for (const double side : {-0.82, 0.82}) {
                    add_desk(x + side, z + 0.42, 0.0);
                    add_desk(x + side, z - 0.42, kPi);
                }
                MeshBuilder screen;
                screen.frame.translation = {x, y_, z};
                screen.box({-1.6, 0.6, -0.015}, {1.6, 1.15, 0.015},
                           library.chance(0.5) ? srgb(96, 120, 110) : srgb(150, 120, 90));
                maker_.place(screen, "desk screen");
                place(f_.light, x, kRoom, z, 0.0);
            }
        for (const double x : {6.0, 18.0, 30.0, 42.0})
            for (const double z : {21.9, 24.4}) {
                MeshBuilder column;
                column.frame.translation = {x, y_, z};
                column.box({-0.2, 0.0, -0.2}, {0.2, kRoom, 0.2}, srgb(210, 208, 200));
                maker_.place(column, "column");
            }
        for (const double x : {14.0, 26.0, 38.0}) {
            place(any(f_.plants), x, 0.0, 21.9, 0.0);
            place(any(f_.cabinets), x, 0.0, 17.0, 0.0);
        }
        for (const double x : {11.0, 13.0, 29.5, 31.5}) place(any(f_.shelves), x, 0.0, kNorth + kWall + 0.18, 0.0);
        for (const double x : {22.0, 26.5}) place(any(f_.sofas), x, 0.0, 29.3, kPi);
    }

    SceneMaker& maker_;
    const Furniture& f_;
    double y_;
};

Result<SceneSource> make(const LoadOptions& options) {
    SceneMaker maker("office", options);
    const Furniture furniture = make_furniture(maker.library);
    for (int storey = 0; storey < kStoreys; ++storey) Storey(maker, furniture, kStorey * storey).add();
    MeshBuilder ground;
    ground.box({-60.0, -0.6, -60.0}, {kLength + 60.0, -0.2, kDepth + 60.0}, srgb(120, 140, 96));
    maker.place(ground, "ground");
    // On the middle storey: along the corridor, through the large room, and back.
    const double eye = kStorey + 1.65, corridor = 0.5 * (kSouth + kNorth);
    return maker.take({{1.5, eye, corridor},
                       {40.0, eye, corridor},
                       {40.0, eye, 23.0},
                       {8.0, eye, 23.0},
                       {8.0, eye, corridor},
                       {23.0, eye, corridor}});
}

}  // namespace
}  // namespace office

Result<SceneSource> make_office(const LoadOptions& options) {
    return office::make(options);
}

}  // namespace crofton::assets
