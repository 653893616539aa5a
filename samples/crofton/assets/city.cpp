// SPDX-License-Identifier: MIT
// A city composed from a folder of parts: square tiles of road and building, and what stands on them, as glTF files
// that are known by their names. Parts look as KayKit's "City Builder Bits" do: a road leads along z, a road that
// branches off leads to +x, a building's front looks to +z, lamps and traffic lights reach to −x, cars drive to +z.
#include <algorithm>
#include <filesystem>
#include <numbers>

#include "assets/file.hpp"
#include "assets/scene_maker.hpp"

namespace crofton::assets {
namespace city {
namespace {

namespace fs = std::filesystem;

constexpr int kBlocks = 6;                    // along a side
constexpr int kLines = 4;                     // tiles from one street to the next
constexpr int kTiles = kBlocks * kLines + 1;  // along a side
constexpr double kTileMetres = 12.0;
constexpr double kEyeHeight = 1.7;
// On a pavement, in tiles from the middle of the street: lamps at the kerb, people, what stands at the houses.
constexpr double kLamps = 0.33, kWalk = 0.385, kThings = 0.47;
constexpr double kPi = std::numbers::pi;

// A file's meshes, each where it stands in the part's frame.
struct Part {
    std::vector<std::pair<scene::MeshId, Transform>> meshes;
    Aabb bounds;
};
using PartList = std::vector<Part>;

class City {
  public:
    City(SceneMaker& maker, const fs::path& folder, const LoadOptions& options)
        : maker_(maker), folder_(folder), options_(options) {}

    // Reads the parts. Errors: a part's; no road or no building among them.
    Result<void> read() {
        std::vector<std::string> names;
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(folder_, error)) {
            const std::string kind = extension(entry.path().string());
            if (kind == "gltf" || kind == "glb") names.push_back(entry.path().filename().string());
        }
        if (error) return fail(ErrorCode::io, kNoItem, folder_.string() + ": " + error.message());
        std::sort(names.begin(), names.end());  // a folder has no order
        for (const std::string& name : names) {
            PartList* list = list_for(fs::path(name).stem().string());
            if (list == nullptr) continue;
            auto part = read_part((folder_ / name).string());
            if (!part) return part.error();
            list->push_back(std::move(*part));
        }
        if (roads_.empty() || buildings_.empty())
            return fail(ErrorCode::empty, kNoItem,
                        folder_.string() + ": a city needs parts road_straight and building_…, as .gltf or .glb");
        tile_ = roads_[0].bounds.max.x - roads_[0].bounds.min.x;
        kerb_ = roads_[0].bounds.max.y;
        return {};
    }

    void compose() {
        for (int j = 0; j < kTiles; ++j)
            for (int i = 0; i < kTiles; ++i) {
                const bool along_z = i % kLines == 0, along_x = j % kLines == 0;
                if (along_z && along_x)
                    add_junction(i, j);
                else if (along_z || along_x)
                    add_road(i, j, along_z);
                else
                    add_plot(i, j);
            }
    }

    // In the parts' lengths.
    [[nodiscard]] double tile() const { return tile_; }
    // On the pavement around the four blocks in the middle.
    [[nodiscard]] std::vector<glm::dvec3> walk() const {
        const int middle = kTiles / 2, low = middle - kLines, high = middle + kLines;
        const double eye = kerb_ + kEyeHeight * tile_ / kTileMetres;
        const glm::dvec3 a = at(low, low, kWalk, kWalk), b = at(high, low, -kWalk, kWalk),
                         c = at(high, high, -kWalk, -kWalk), d = at(low, high, kWalk, -kWalk);
        std::vector<glm::dvec3> result{a, b, c, d};
        for (glm::dvec3& place : result) place.y = eye;
        return result;
    }

  private:
    PartList* list_for(const std::string& name) {
        const auto begins = [&](const char* text) { return name.rfind(text, 0) == 0; };
        if (name == "road_straight") return &roads_;
        if (name == "road_straight_crossing") return &crossings_;
        if (name == "road_junction") return &junctions_;
        if (name == "road_tsplit") return &branches_;
        if (name == "road_corner") return &corners_;
        if (begins("road_") || name.find("_withoutBase") != name.npos) return nullptr;
        if (begins("building_")) return &buildings_;
        if (begins("base")) return &bases_;
        if (begins("car_")) return &cars_;
        if (begins("streetlight")) return &lamps_;
        if (begins("trafficlight")) return &lights_;
        if (begins("bush") || begins("tree")) return &plants_;
        return &props_;
    }

    Result<Part> read_part(const std::string& file) {
        LoadOptions options = options_;
        auto source = load_gltf(file, options);
        if (!source) return source.error();
        source->scene.update();
        Part part;
        for (scene::InstanceId i = 0; i < source->scene.instance_count(); ++i) {
            const scene::MeshId from = source->scene.mesh_of(i);
            const Transform& world = source->scene.world(source->scene.node_of(i));
            const TriangleMesh& mesh = source->scene.mesh(from);
            for (const glm::vec3& p : mesh.positions) part.bounds.include(world * glm::dvec3(p));
            const scene::MeshId id = maker_.add(mesh, fs::path(file).stem().string());
            if (from >= source->one_sided.size() || source->one_sided[from] == 0) maker_.show_both_sides(id);
            part.meshes.emplace_back(id, world);
        }
        return part;
    }

    // The middle of a tile, and so many tiles beside it.
    [[nodiscard]] glm::dvec3 at(int i, int j, double x = 0.0, double z = 0.0) const {
        return {tile_ * (i - kTiles / 2 + x), 0.0, tile_ * (j - kTiles / 2 + z)};
    }

    void place(const Part& part, const Transform& where) {
        for (const auto& [mesh, local] : part.meshes) maker_.place(mesh, where * local);
    }
    // One of the list, or nothing where it is empty; `x`, `z`: in tiles from the middle of tile (i, j).
    void place(const PartList& list, int i, int j, double x, double z, double turn, double y = 0.0) {
        if (list.empty()) return;
        const auto which = static_cast<std::size_t>(maker_.library.pick(static_cast<int>(list.size())));
        place(list[which], standing(at(i, j, x, z) + glm::dvec3(0.0, y, 0.0), turn));
    }
    [[nodiscard]] const PartList& or_roads(const PartList& list) const { return list.empty() ? roads_ : list; }

    void add_junction(int i, int j) {
        const bool left = i == 0, right = i == kTiles - 1, near = j == kTiles - 1, far = j == 0;
        const PartList& branch = branches_.empty() ? or_roads(junctions_) : branches_;
        if ((left || right) && (near || far))
            place(corners_.empty() ? branch : corners_, i, j, 0.0, 0.0,
                  left ? (far ? 0.0 : 0.5 * kPi) : (far ? -0.5 * kPi : kPi));
        else if (left || right)
            place(branch, i, j, 0.0, 0.0, left ? 0.0 : kPi);
        else if (near || far)
            place(branch, i, j, 0.0, 0.0, far ? -0.5 * kPi : 0.5 * kPi);
        else
            place(or_roads(junctions_), i, j, 0.0, 0.0, 0.0);
        if (left || right || near || far) return;
        for (int k = 0; k < 4; ++k) {
            const double x = k == 0 || k == 3 ? kLamps : -kLamps, z = k < 2 ? kLamps : -kLamps;
            place(lights_, i, j, x, z, 0.5 * kPi * k, kerb_);
        }
    }

    void add_road(int i, int j, bool along_z) {
        auto& library = maker_.library;
        const double turn = along_z ? 0.0 : 0.5 * kPi;
        const int along = along_z ? j % kLines : i % kLines;
        const bool beside_junction = along == 1 || along == kLines - 1;
        place(beside_junction && !crossings_.empty() ? crossings_ : roads_, i, j, 0.0, 0.0, turn);
        // Across and along the road; turned by a quarter, +x becomes −z and +z becomes +x.
        const auto on = [&](const PartList& list, double across, double forward, double own_turn, double y) {
            place(list, i, j, along_z ? across : forward, along_z ? forward : -across, turn + own_turn, y);
        };
        const double side = (i + j) % 2 == 0 ? 1.0 : -1.0;
        on(lamps_, kLamps * side, 0.1, side > 0.0 ? 0.0 : kPi, kerb_);
        // They keep to the right, and stand where the road is not crossed.
        for (const double lane : {-1.0, 1.0})
            if (!beside_junction && library.chance(0.7))
                on(cars_, 0.13 * lane, library.random.uniform(-0.25, 0.25), lane < 0.0 ? 0.0 : kPi, wheel_height());
        for (const double s : {-1.0, 1.0}) {
            if (library.chance(0.35)) on(plants_, kThings * s, library.random.uniform(-0.4, -0.1), 0.0, kerb_);
            if (library.chance(0.30)) {
                const double forward = library.random.uniform(0.15, 0.4);
                on(props_, kThings * s, forward, s > 0.0 ? -0.5 * kPi : 0.5 * kPi, kerb_);
            }
        }
    }

    // A building that looks to the nearest street, or a yard in a block's middle.
    void add_plot(int i, int j) {
        auto& library = maker_.library;
        const int x = i % kLines, z = j % kLines, last = kLines - 1;
        if (x > 1 && x < last && z > 1 && z < last) {
            place(bases_, i, j, 0.0, 0.0, 0.0);
            for (int k = 0; k < 9; ++k) {
                const double dx = library.random.uniform(-0.42, 0.42), dz = library.random.uniform(-0.42, 0.42),
                             turn = library.random.uniform(0.0, 2.0 * kPi);
                place(k % 3 == 0 ? props_ : plants_, i, j, dx, dz, turn, kerb_);
            }
            return;
        }
        const double turn = z == 1 && x != 1 && x != last      ? kPi
                            : z == last && x != 1 && x != last ? 0.0
                            : x == 1                           ? -0.5 * kPi
                                                               : 0.5 * kPi;
        place(buildings_, i, j, 0.0, 0.0, turn);
    }

    // A car's frame is above what it stands on.
    [[nodiscard]] double wheel_height() const {
        return cars_.empty() ? 0.0 : kerb_ - std::min(0.0, cars_[0].bounds.min.y);
    }

    SceneMaker& maker_;
    fs::path folder_;
    LoadOptions options_;
    PartList roads_, crossings_, junctions_, branches_, corners_, buildings_, bases_, cars_, lamps_, lights_, plants_,
        props_;
    double tile_ = 1.0, kerb_ = 0.0;
};

}  // namespace
}  // namespace city

bool holds_city_parts(const std::string& folder) {
    using namespace city;
    std::error_code ignored;
    for (const char* name : {"road_straight.gltf", "road_straight.glb"})
        if (fs::is_regular_file(fs::path(folder) / name, ignored)) return true;
    return false;
}

Result<SceneSource> make_city(const std::string& folder, const LoadOptions& options) {
    using namespace city;
    const std::string name = fs::path(folder).lexically_normal().filename().string();
    SceneMaker maker(name.empty() ? "city" : name, options);
    City made(maker, folder, options);
    if (auto read = made.read(); !read) return read.error();
    maker.scale(kTileMetres / made.tile());
    made.compose();
    return maker.take(made.walk());
}

}  // namespace crofton::assets
