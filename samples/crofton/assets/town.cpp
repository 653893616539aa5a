// SPDX-License-Identifier: MIT
// The built-in town: a grid of streets, blocks of several kinds, traffic.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "assets/scene_source.hpp"
#include "assets/town_blocks.hpp"

namespace crofton::assets {
namespace {

using namespace town;

constexpr std::uint32_t kDefaultInstances = 3000;
constexpr std::uint32_t kMaxInstances = 16'000'000;
constexpr double kInstancesPerBlock = 245.0;  // vehicles and country included, measured on the default town
constexpr double kVehiclesPerBlock = 12.0;
constexpr double kTurn = 0.4;       // of the whole town against the axes, as towns do
constexpr double kEyeHeight = 2.3;  // over the heads of those who walk there too

Grid make_grid(Library& library, int columns, int rows) {
    Grid grid;
    const auto lines = [&](std::vector<double>& result, int blocks, int least, int step) {
        double at = 0.0;
        result.push_back(at);
        for (int k = 0; k < blocks; ++k) result.push_back(at += kStreet + least + step * library.pick(3));
        for (double& line : result) line -= 0.5 * at;
    };
    lines(grid.x_lines, columns, 52, 6);
    lines(grid.z_lines, rows, 42, 5);
    return grid;
}

Block block_at(const Grid& grid, std::size_t i, std::size_t j) {
    return {grid.x_lines[i] + 0.5 * kStreet, grid.x_lines[i + 1] - 0.5 * kStreet, grid.z_lines[j] + 0.5 * kStreet,
            grid.z_lines[j + 1] - 0.5 * kStreet};
}

void fill_blocks(Builder& builder, Library& library, const Grid& grid) {
    const std::size_t columns = grid.x_lines.size() - 1, rows = grid.z_lines.size() - 1;
    for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < columns; ++i) {
            const Block block = block_at(grid, i, j);
            // The middle of the town is always its market; a park and a building site are never far.
            const std::size_t number = j * columns + i, middle = (rows / 2) * columns + columns / 2;
            if (number == middle)
                builder.add_market(block);
            else if (number % 11 == 2)
                builder.add_building_site(block);
            else if (number % 9 == 8 || library.chance(0.02))
                builder.add_park(block);
            else
                builder.add_terraces(block);
            builder.add_street_furniture(block);
        }
}

Loop random_loop(Library& library, const Grid& grid) {
    const int columns = static_cast<int>(grid.x_lines.size()) - 1, rows = static_cast<int>(grid.z_lines.size()) - 1;
    const int i = library.pick(columns), j = library.pick(rows);
    const int wide = 1 + library.pick(std::min(4, columns - i)), deep = 1 + library.pick(std::min(4, rows - j));
    const auto at = [](const std::vector<double>& lines, int k) { return lines[static_cast<std::size_t>(k)]; };
    return {at(grid.x_lines, i), at(grid.x_lines, i + wide), at(grid.z_lines, j), at(grid.z_lines, j + deep),
            library.chance(0.5)};
}

std::vector<Driver> add_traffic(Builder& builder, Library& library, const Grid& grid, int count) {
    const auto vehicles = make_vehicles(library);
    std::vector<Driver> drivers;
    for (int k = 0; k < count; ++k) {
        // Few buses and lorries among many cars.
        const int kinds = static_cast<int>(vehicles.size()), cars = kinds - 5;
        const Vehicle& vehicle =
            vehicles[static_cast<std::size_t>(library.chance(0.15) ? cars + library.pick(5) : library.pick(cars))];
        Driver driver;
        driver.loop = random_loop(library, grid);
        driver.start = library.random.uniform(0.0, driver.loop.length());
        driver.speed = library.random.uniform(6.0, 13.0);
        driver.hitch = vehicle.hitch;
        driver.node = builder.place(Parts{vehicle.mesh}, pose(driver, 0.0));
        if (vehicle.trailer != scene::kNone)
            driver.trailer = builder.place(Parts{vehicle.trailer}, trailer_pose(driver, 0.0));
        drivers.push_back(driver);
    }
    return drivers;
}

std::vector<scene::InstanceId> instances_on(const scene::Scene& scene, std::vector<scene::NodeId> nodes) {
    std::sort(nodes.begin(), nodes.end());
    std::vector<scene::InstanceId> result;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (std::binary_search(nodes.begin(), nodes.end(), scene.node_of(i))) result.push_back(i);
    return result;
}

// Around the blocks in the town's middle, on the pavement.
std::vector<glm::dvec3> make_walk(const Grid& grid, const Transform& root) {
    const std::size_t i = (grid.x_lines.size() - 1) / 2, j = (grid.z_lines.size() - 1) / 2;
    const std::size_t i0 = i > 0 ? i - 1 : 0, j0 = j > 0 ? j - 1 : 0;
    const std::size_t i1 = std::min(i + 1, grid.x_lines.size() - 1), j1 = std::min(j + 1, grid.z_lines.size() - 1);
    const double inside = 0.5 * kCarriageway + 0.5 * kSidewalk;
    const double x0 = grid.x_lines[i0] + inside, x1 = grid.x_lines[i1] - inside;
    const double z0 = grid.z_lines[j0] + inside, z1 = grid.z_lines[j1] - inside;
    std::vector<glm::dvec3> result;
    for (const glm::dvec2& p : {glm::dvec2(x0, z1), glm::dvec2(x1, z1), glm::dvec2(x1, z0), glm::dvec2(x0, z0)})
        result.push_back(root * glm::dvec3(p.x, kKerb + kEyeHeight, p.y));
    return result;
}

}  // namespace

Result<SceneSource> make_town(const LoadOptions& options) {
    const std::uint32_t wanted = options.instances == 0 ? kDefaultInstances : options.instances;
    if (wanted > kMaxInstances)
        return fail(ErrorCode::out_of_range, wanted,
                    "town: at most " + std::to_string(kMaxInstances) + " instances, not " + std::to_string(wanted));
    SceneSource source{"town", scene::Scene({options.criterion}), {}, {}, {}, {}};
    const Transform turn = *from_trs({}, glm::angleAxis(kTurn, glm::dvec3(0, 1, 0)), glm::dvec3(1.0));
    const auto root = source.scene.add_node(scene::kNone, turn, ~0u, "town");
    if (!root) return root.error();
    const double blocks = std::max(1.0, std::round(wanted / kInstancesPerBlock));
    const int columns = static_cast<int>(std::ceil(std::sqrt(blocks))),
              rows = static_cast<int>(std::lround(blocks / columns));
    Library library(source.scene, options.seed);
    const Grid grid = make_grid(library, columns, std::max(1, rows));
    Builder builder(source.scene, library, *root);
    builder.add_streets(grid);
    fill_blocks(builder, library, grid);
    builder.add_countryside(grid);
    auto drivers = add_traffic(builder, library, grid, static_cast<int>(std::lround(kVehiclesPerBlock * blocks)));
    if (!builder.status()) return builder.status().error();
    if (!library.status()) return library.status().error();

    struct Crane {
        scene::NodeId node;
        Transform start;
    };
    std::vector<Crane> cranes;
    std::vector<scene::NodeId> moving;
    for (const scene::NodeId jib : builder.jibs()) {
        cranes.push_back({jib, source.scene.local(jib)});
        moving.push_back(jib);
    }
    for (const Driver& driver : drivers) {
        moving.push_back(driver.node);
        if (driver.trailer != scene::kNone) moving.push_back(driver.trailer);
    }
    source.movers = instances_on(source.scene, std::move(moving));
    source.walk = make_walk(grid, turn);
    source.emission = std::move(library.emission);
    // Poses of valid drivers are valid transforms, so the results need no look.
    source.motion = [drivers = std::move(drivers), cranes = std::move(cranes)](scene::Scene& scene,
                                                                               std::uint32_t frame) {
        const double seconds = frame / 60.0;
        for (const Driver& driver : drivers) {
            (void)scene.set_local(driver.node, pose(driver, seconds));
            if (driver.trailer != scene::kNone) (void)scene.set_local(driver.trailer, trailer_pose(driver, seconds));
        }
        for (const Crane& crane : cranes)
            (void)scene.set_local(
                crane.node,
                crane.start * *from_trs({}, glm::angleAxis(0.12 * seconds, glm::dvec3(0, 1, 0)), glm::dvec3(1.0)));
    };
    source.one_sided.assign(source.scene.mesh_count(), 1);  // where both sides show, both are built
    return source;
}

}  // namespace crofton::assets
