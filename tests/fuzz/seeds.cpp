// SPDX-License-Identifier: MIT
// fuzz_seeds FOLDER: writes what each fuzzer begins with into FOLDER/<fuzzer>/.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/scene/scene.hpp>
#include <samples/assets/test_files.hpp>

#include "fuzz/small_bakes.hpp"

namespace {

using namespace crofton;

class Folder {
  public:
    Folder(const std::string& root, const std::string& fuzzer) : path_(std::filesystem::path(root) / fuzzer) {
        std::filesystem::create_directories(path_);
    }
    void add(const std::string& contents) {
        std::ofstream(path_ / std::to_string(count_++), std::ios::binary) << contents;
    }
    void add(const Vector<std::byte>& bytes) {
        add(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }

  private:
    std::filesystem::path path_;
    int count_ = 0;
};

void write_scenes(Folder out) {
    out.add('\0' +
            test_files::glb(test_files::gltf_json("[{\"mesh\":0,\"children\":[1]},{\"mesh\":0,\"scale\":[2,1,1]}]")));
    out.add('\1' + test_files::gltf_json("[{\"mesh\":0}]", "\"bufferView\":1,\"count\":3",
                                         "\"byteLength\":44,\"uri\":\"data:application/octet-stream;base64,"
                                         "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=\""));
    out.add(
        "\2o a\nv 0 0 0\nv 1 0 0 1 0 1\nv 0 1 0\nv 0 0 1\nvt 0 1\nvn 0 0 1\nf 1 2 3\nusemtl x\nf -1/1/1 2//1 3/1\ng "
        "b\nf 1 3 4 2\n");
    out.add('\3' + test_files::Wad().file());
}

void write_polygons(Folder out) {
    for (const char method : {'\0', '\4', '\10'}) {
        out.add(method + std::string("P a 2\n4 0 0 9 0 9 9 0 9\n3 2 2 4 2 2 4\nP b 1\n3 0 0 1e3 0.5 -7 8\n"));
        out.add(static_cast<char>(method + 1) + std::string("[[[0,0],[9,0],[9,9],[0,9]],[[2,2],[4,2],[2,4]]]"));
        out.add(
            static_cast<char>(method + 2) +
            std::string("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"id\":1,\"properties\":{"
                        "\"name\":\"x\"},"
                        "\"geometry\":{\"type\":\"MultiPolygon\",\"coordinates\":[[[[0,0],[9,0],[9,9],[0,0]]]]}}]}"));
        out.add(static_cast<char>(method + 3) + test_files::Wad().file());
    }
}

std::vector<Obb> boxes(int count) {
    std::vector<Obb> result;
    for (int i = 0; i < count; ++i) {
        Obb& box = result.emplace_back();
        box.center = {i % 5, i / 5 % 5, -i / 25};
        box.half_extents = {0.5f, 0.25f, 0.125f};
    }
    return result;
}

void write_trees(Folder out) {
    for (const int count : {0, 1, 20, 300}) {
        auto tree = *boxtree::BoxTree::build(boxes(count));
        if (count > 10) (void)tree.remove(7);
        out.add(tree.serialise());
    }
}

void write_bakes(Folder out) {
    scene::Scene scene;
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    const auto id = *scene.add_mesh(mesh, "sail");
    for (int i = 0; i < 3; ++i) {
        (void)scene.add_instance(*scene.add_node(scene::kNone, {}, ~0u, "mast"), id);
        scene.update();
        out.add(*bake::bake(scene));
    }
}

// With what the first byte chooses in fuzz_states.
void write_states(Folder out) {
    const auto add = [&](char reader, const Vector<std::byte>& bytes) {
        out.add(reader + std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    };
    pvs::Bake bake = fuzz::small_bake();
    (void)bake.run({.shard = {1, 3}});
    add('\1', *bake.state());
    (void)bake.run();
    add('\1', *bake.state());
    add('\0', *pvs::Pvs::finish(bake)->to_file());
    pvs::ConvexCell cell;
    for (std::size_t i = 0; i < 8; ++i) cell.corners[i] = {i & 1 ? 4.0 : -4.0, i & 2 ? 2.0 : 0.0, i & 4 ? 2.0 : 0.0};
    const Aabb boxes[] = {{{-4.0, 0.0, 0.0}, {1.0, 2.0, 2.0}}, {{-1.0, 0.0, 0.0}, {4.0, 2.0, 2.0}}};
    for (const auto& cells : {*pvs::Cells::convex(std::array{cell, cell}), *pvs::Cells::boxes(boxes)}) {
        auto other = *pvs::Bake::create(fuzz::small_geometry(), cells, {.epsilon = 0.1, .confidence = 0.5});
        (void)other.run();
        add('\0', *pvs::Pvs::finish(other)->to_file());
    }
    for (const std::uint32_t shards : {1u, 3u}) {
        auto light = *radiosity::Bake::create(fuzz::small_patches(), fuzz::small_options(), fuzz::kSmallRuns);
        (void)light.run({.shard = {0, shards}});
        add('\2', *light.state());
    }
    auto solver = *radiosity::Solver::create(fuzz::small_patches(), fuzz::small_options());
    for (int run = 0; run < 2; ++run) {
        solver.run();
        add('\3', solver.checkpoint());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n"), 2;
    const std::string root = argv[1];
    write_scenes({root, "scene"});
    write_polygons({root, "polygons"});
    write_trees({root, "tree"});
    write_bakes({root, "bake"});
    write_states({root, "states"});
    Folder(root, "camera_path")
        .add(std::string("{\"cameras\":[{\"position\":[0,1,2],\"forward\":[0,0,-1],\"up\":[0,1,0],\"fov_y\":60,"
                         "\"near\":0.1,\"far\":100}]}"));
    Folder(root, "capi").add(std::string(256, '\x2a'));
    return 0;
}
