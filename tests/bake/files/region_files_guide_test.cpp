// SPDX-License-Identifier: MIT
// Scenes split into regions, written, opened again and attached.
#include <doctest/doctest.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <counting_memory.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/bake/region_files.hpp>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <map>
#include <oracle/random_boxes.hpp>
#include <set>
#include <thread>
#include <vector>

#include "../../box_mesh.hpp"

using namespace crofton;
using namespace crofton::bake;

namespace {

// A folder that is gone after the test.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        path_ = (std::filesystem::temp_directory_path() / "crofton-test-XXXXXX").string();
        REQUIRE(mkdtemp(path_.data()) != nullptr);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }

  private:
    std::string path_;
};

// Houses with a yard on one node, by chains of nodes, in a place far from 0.
struct Town {
    scene::Scene scene;
    BakedOccluders occluders;
    std::vector<MeshLook> looks{{.one_sided = true}, {.unlit = true}};

    explicit Town(std::size_t houses) {
        oracle::NearMisses random(15);
        const TriangleMesh house = testing::box_mesh(glm::vec3(-3.0f), glm::vec3(3.0f));
        REQUIRE(scene.add_mesh(house, "house"));
        REQUIRE(scene.add_mesh(testing::box_mesh({-4, -3, -4}, {9, -2.5, 4}), "yard"));
        occluders.kinds.push_back(occlude::find_occluders(house)->occluders);
        const auto street = scene.add_node(scene::kNone, {glm::dmat3(1.0), {5000.0, 10.0, -2000.0}}).value();
        for (std::size_t i = 0; i < houses; ++i) {
            Transform transform;
            const double x = random.number(-100.0, 100.0), z = random.number(-40.0, 40.0);
            transform.linear = glm::dmat3(oracle::random_box(random, {}, 1.0).axes);
            transform.translation = {x, 0.0, z};
            const auto node = scene.add_node(street, transform, i % 7 == 0 ? 5u : ~0u).value();
            REQUIRE(scene.add_instance(node, 0));
            if (i % 2 == 0) REQUIRE(scene.add_instance(node, 1));
            if (i % 3 == 0) occluders.nodes.push_back({node, 0});
        }
        REQUIRE(scene.remove_instance(4));
        scene.update();
    }
    [[nodiscard]] BakeOptions options() const { return {.occluders = &occluders, .looks = looks}; }
};

void write_regions(const Town& town, const SceneRegions& regions, const std::string& folder) {
    std::vector<RegionFile> index;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Vector<std::byte> file = regions.bake(i, town.options()).value();
        index.push_back(regions.region(i));
        index.back().bytes = file.size();
        REQUIRE(write_file(folder + "/" + index.back().name, file));
    }
    REQUIRE(write_file(folder + "/" + kRegionIndexName, bake_region_index(index).value()));
}

}  // namespace

TEST_SUITE("bake/region_files") {
    TEST_CASE("a scene in regions is hit as the scene itself, each instance once, wherever the cells divide it") {
        const Town town(80);
        World single({.pairs = false});
        std::vector<MeshHandle> meshes;
        for (scene::MeshId m = 0; m < 2; ++m)
            meshes.push_back(
                single.add_mesh({.positions = town.scene.mesh(m).positions, .indices = town.scene.mesh(m).indices})
                    .value());
        for (std::uint32_t i = 0; i < town.scene.instance_count(); ++i)
            if (i != 4)
                single
                    .add({.mesh = meshes[town.scene.mesh_of(i)],
                          .transform = town.scene.world(town.scene.node_of(i)),
                          .user = town.scene.mesh_of(i),
                          .layers = town.scene.layer_masks()[i]})
                    .value();
        single.update().value();
        for (const auto& [columns, rows] : {std::pair(1u, 1u), std::pair(3u, 2u), std::pair(40u, 1u)}) {
            const TemporaryFolder folder;
            const SceneRegions regions = SceneRegions::split(town.scene, columns, rows).value();
            CHECK(regions.size() <= std::size_t{columns} * rows);
            CHECK(regions.size() >= (columns == 40 ? 20 : std::size_t{columns} * rows));
            write_regions(town, regions, folder.path());
            World world({.pairs = false});
            std::size_t objects = 0, occluding = 0;
            const Vector<RegionFile> index = open_region_index(folder.path()).value();
            REQUIRE(index.size() == regions.size());
            for (const RegionFile& file : index) {
                const Region region = open_region(folder.path(), file).value();
                CHECK(region.object_count() == file.objects);
                for (int k = 0; k < 3; ++k) {
                    CHECK(std::abs(region.bounds().min[k] - file.bounds.min[k]) < 1e-4);
                    CHECK(std::abs(region.bounds().max[k] - file.bounds.max[k]) < 1e-4);
                }
                objects += region.object_count();
                for (std::uint32_t i = 0; i < region.object_count(); ++i)
                    occluding += !region.occluders_of(region.mesh_of(i)).empty();
                world.attach(region, file.origin).value();
            }
            CHECK(objects == town.scene.instance_count() - 1);
            CHECK(occluding == 27);
            for (int i = 0; i < 4; ++i) world.update().value();
            oracle::NearMisses random(16);
            std::size_t hits = 0;
            for (int n = 0; n < 300; ++n) {
                const double x = random.number(-100.0, 100.0), z = random.number(-40.0, 40.0),
                             u = random.number(-1.0, 1.0), v = random.number(-0.05, 0.05), w = random.number(-1.0, 1.0);
                const Ray ray{{5000.0 + x, 10.0, -2000.0 + z}, {u, v, w}};
                Vector<ObjectHit> found, expected;
                world.raycast_all(ray, found, {n % 2 ? 1u : 2u});
                single.raycast_all(ray, expected, {n % 2 ? 1u : 2u});
                REQUIRE(found.size() == expected.size());
                for (std::size_t h = 0; h < found.size(); ++h) {
                    CHECK(std::abs(found[h].t - expected[h].t) < 1e-8);
                    CHECK(found[h].triangle == expected[h].triangle);
                }
                hits += found.size();
            }
            CHECK(hits > 500);
        }
    }

    TEST_CASE("regions are baked to the same bytes in any order and number, with the looks of their meshes") {
        const Town town(40);
        const SceneRegions regions = SceneRegions::split(town.scene, 4, 4).value();
        std::vector<Vector<std::byte>> serial(regions.size()), parallel(regions.size());
        for (std::size_t i = 0; i < regions.size(); ++i) serial[i] = regions.bake(i, town.options()).value();
        ThreadPool pool(4);
        const SceneRegions again = SceneRegions::split(town.scene, 4, 4).value();
        pool.parallel_for(again.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t i = begin; i < end; ++i) parallel[i] = again.bake(i, town.options()).value();
        });
        std::set<std::string> names;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            CHECK(serial[i] == parallel[i]);
            CHECK(names.insert(regions.region(i).name).second);
            const auto baked = BakedScene::from_memory(serial[i]);
            REQUIRE(baked);
            for (scene::MeshId m = 0; m < baked->mesh_count(); ++m) {
                const MeshView mesh = baked->mesh(m);
                CHECK(mesh.look == town.looks[mesh.name == "house" ? 0 : 1]);
                REQUIRE(baked->clusters(m) != nullptr);
                CHECK(baked->clusters(m)->serialise() ==
                      depth::ClusteredMesh::cut(mesh.positions, mesh.indices).value().serialise());
            }
        }
        CHECK(error_of(SceneRegions::split(town.scene, 0, 1)).code == ErrorCode::out_of_range);
        CHECK(error_of(SceneRegions::split(town.scene, 1, 1025)).code == ErrorCode::out_of_range);
        const scene::Scene empty;
        CHECK(SceneRegions::split(empty, 3, 3).value().size() == 0);
        CHECK(read_region_index(bake_region_index({}).value()).value().empty());
    }

    TEST_CASE("a damaged index and a file that is another are errors when they are opened") {
        const Town town(20);
        const TemporaryFolder folder;
        const SceneRegions regions = SceneRegions::split(town.scene, 2, 1).value();
        write_regions(town, regions, folder.path());
        Vector<RegionFile> index = open_region_index(folder.path()).value();
        REQUIRE(index.size() == 2);
        CHECK(open_region(folder.path(), index[0]).has_value());
        // A region's file in the place of the other, one that is cut, and one that is gone.
        const std::string first = folder.path() + "/" + index[0].name, second = folder.path() + "/" + index[1].name;
        std::filesystem::rename(first, first + ".kept");
        CHECK(!open_region(folder.path(), index[0]));
        std::filesystem::copy_file(second, first);
        CHECK(!open_region(folder.path(), index[0]));
        std::filesystem::remove(first);
        std::filesystem::rename(first + ".kept", first);
        std::filesystem::resize_file(first, index[0].bytes - 64);
        CHECK(error_of(open_region(folder.path(), index[0])).code == ErrorCode::parse);
        index[1].objects += 1;
        CHECK(error_of(open_region(folder.path(), index[1])).code == ErrorCode::parse);
        // Each byte of the index.
        const Vector<std::byte> file = bake_region_index(index).value();
        REQUIRE(read_region_index(file));
        std::size_t refused = 0;
        for (std::size_t i = 0; i < file.size(); ++i) {
            Vector<std::byte> damaged = file;
            damaged[i] ^= std::byte{4};
            refused += !read_region_index(damaged);
        }
        CHECK(refused == file.size());
        for (std::size_t size = 0; size < file.size(); size += 8)
            CHECK(!read_region_index(std::span<const std::byte>(file).first(size)));
        for (const char* name : {"", "..", "../r.crofton", "a/b.crofton", "C:r.crofton", "a\\b.crofton"}) {
            index[1].name = name;
            CHECK(error_of(bake_region_index(index)).item == 1);
        }
        std::filesystem::remove(folder.path() + "/" + kRegionIndexName);
        CHECK(!open_region_index(folder.path()));
    }

    TEST_CASE("a region takes the tree of its file, and builds one where that is for other origins") {
        const Town town(60);
        const SceneRegions regions = SceneRegions::split(town.scene, 2, 2).value();
        REQUIRE(regions.size() == 4);
        for (std::size_t i = 0; i < regions.size(); ++i) {
            BakeOptions options = town.options();
            options.tree = boxtree::Orientation::oriented;
            const Vector<std::byte> file = regions.bake(i, options).value();
            const auto prepared = [&](double max_origin) {
                return prepare_region(BakedScene::from_memory(file).value(), {.region = {.max_origin = max_origin}})
                    .value();
            };
            const Region taken = prepared(RegionOptions().max_origin), built = prepared(2e9);
            // prepare() itself builds along the world's axes alone.
            CHECK(taken.bytes() > built.bytes());
            // The boxes are those of a region that is prepared from a scene that stays.
            const BakedScene scene = BakedScene::from_memory(file).value();
            const Region copied = prepare_region(scene).value();
            CHECK(copied.bytes() == built.bytes());
            CHECK(scene.tree().item_count() == copied.object_count());
            REQUIRE(taken.object_count() == copied.object_count());
            World world({.pairs = false});
            const RegionHandle a = world.attach(taken, {7.0, 0.0, 1e6}).value(),
                               b = world.attach(copied, {7.0, 0.0, 1e6}).value();
            world.update().value();
            for (std::uint32_t item = 0; item < taken.object_count(); ++item) {
                const Obb of_taken = world.box_of(world.object_in(a, item).value()).value(),
                          of_copied = world.box_of(world.object_in(b, item).value()).value();
                CHECK(std::memcmp(&of_taken, &of_copied, sizeof(Obb)) == 0);
            }
        }
    }

    TEST_CASE("each byte of a region's file that is changed is an error when the region is opened") {
        const Town town(6);
        const TemporaryFolder folder;
        write_regions(town, SceneRegions::split(town.scene, 1, 1).value(), folder.path());
        const RegionFile file = open_region_index(folder.path()).value().front();
        const std::string path = folder.path() + "/" + file.name;
        REQUIRE(open_region(folder.path(), file).has_value());
        const MappedFile whole = MappedFile::open(path, {.access = FileAccess::read}).value();
        Vector<std::byte> bytes(whole.bytes().begin(), whole.bytes().end());
        std::size_t refused = 0, tried = 0;
        for (std::size_t i = 0; i < bytes.size(); i += 1 + i % 5) {
            bytes[i] ^= std::byte{16};
            refused += !BakedScene::from_memory(bytes);
            bytes[i] ^= std::byte{16};
            ++tried;
        }
        CHECK(refused == tried);
        CHECK(tried > 2000);
        for (std::size_t size = 0; size < bytes.size(); size += 64)
            CHECK(!BakedScene::from_memory(std::span<const std::byte>(bytes).first(size)));
    }

    TEST_CASE(
        "files that are changed, cut, replaced and deleted change no answer of their regions, while rays are cast") {
        const Town town(40);
        const TemporaryFolder folder;
        write_regions(town, SceneRegions::split(town.scene, 2, 2).value(), folder.path());
        const Vector<RegionFile> index = open_region_index(folder.path()).value();
        REQUIRE(index.size() == 4);
        for (const FileAccess access : {FileAccess::map, FileAccess::read}) {
            const TemporaryFolder copy;
            std::filesystem::copy(folder.path(), copy.path(), std::filesystem::copy_options::recursive);
            World world({.pairs = false});
            for (const RegionFile& file : index) {
                const auto region = open_region(copy.path(), file, {}, {.access = access});
                REQUIRE(region);
                world.attach(*region, file.origin).value();
            }
            world.update().value();
            oracle::NearMisses random(80);
            std::vector<Ray> rays(200);
            for (Ray& ray : rays) {
                const RegionFile& file = index[random.index(4)];
                ray.origin = file.origin + file.bounds.min - 5.0;
                const double u = random.number(0.0, 1.0), v = random.number(0.0, 1.0), w = random.number(0.0, 1.0);
                ray.direction =
                    file.origin + glm::mix(file.bounds.min, file.bounds.max, glm::dvec3(u, v, w)) - ray.origin;
            }
            const auto cast = [&] {
                std::vector<double> found;
                for (const Ray& ray : rays) {
                    const auto hit = world.raycast(ray);
                    found.push_back(hit ? hit->t : -1.0);
                }
                return found;
            };
            const std::vector<double> expected = cast();
            CHECK(std::count(expected.begin(), expected.end(), -1.0) < 150);
            std::atomic<bool> done = false;
            std::atomic<int> wrong = 0, rounds = 0;
            std::thread asks([&] {
                do {
                    wrong += cast() != expected;
                    ++rounds;
                } while (!done);
            });
            const auto path = [&](std::size_t i) { return copy.path() + "/" + index[i].name; };
            {
                std::fstream changed(path(0), std::ios::binary | std::ios::in | std::ios::out);
                for (std::uint64_t i = 0; i < index[0].bytes; ++i) changed.put('\x5a');
            }
            std::filesystem::resize_file(path(1), 0);
            std::filesystem::copy_file(folder.path() + "/" + index[0].name, path(2),
                                       std::filesystem::copy_options::overwrite_existing);
            std::filesystem::remove(path(3));
            for (const int before = rounds; rounds < before + 3;) std::this_thread::yield();
            done = true;
            asks.join();
            CHECK(wrong == 0);
            for (const RegionFile& file : index) CHECK(!open_region(copy.path(), file, {}, {.access = access}));
        }
    }

    TEST_CASE("a file that another program cuts, changes and replaces meanwhile is read as it was, or is an error") {
        const Town town(40);
        const TemporaryFolder folder;
        write_regions(town, SceneRegions::split(town.scene, 1, 1).value(), folder.path());
        const RegionFile file = open_region_index(folder.path()).value().front();
        const std::string path = folder.path() + "/" + file.name;
        const MappedFile whole = MappedFile::open(path, {.access = FileAccess::read}).value();
        const auto box_sum = [](const Region& region) {
            World world({.pairs = false});
            world.attach(region, glm::dvec3(0.0)).value();
            world.update().value();
            Vector<ObjectRef> found;
            world.overlap(Sphere{region.bounds().center(), 40.0}, found);
            double sum = 0.0;
            for (const ObjectRef& ref : found) sum += world.box_of(ref.object)->center.x * double(ref.user + 1);
            return sum;
        };
        const double expected = box_sum(open_region(folder.path(), file).value());
        std::atomic<bool> done = false;
        std::thread writer([&] {
            const auto* const bytes = reinterpret_cast<const char*>(whole.bytes().data());
            const auto size = static_cast<std::streamsize>(whole.bytes().size());
            for (int round = 0; !done; ++round) {
                if (round % 4 == 0) std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size / 3));
                if (round % 4 == 1) std::ofstream(path, std::ios::binary).write(bytes, size);
                if (round % 4 == 2) std::fstream(path, std::ios::binary | std::ios::in | std::ios::out) << "damage";
                if (round % 4 == 3) (void)write_file(path, whole.bytes());
                std::this_thread::sleep_for(std::chrono::microseconds(50 * (round % 7)));
            }
        });
        int opened = 0, refused = 0;
        for (int i = 0; i < 3000 && (opened < 20 || refused < 20); ++i) {
            const auto region = open_region(folder.path(), file, {}, {.access = FileAccess::read});
            if (region) {
                ++opened;
                CHECK(box_sum(*region) == expected);
                continue;
            }
            ++refused;
            CHECK((region.error().code == ErrorCode::io || region.error().code == ErrorCode::parse));
            CHECK(region.error().message.find(path) != std::string::npos);
        }
        done = true;
        writer.join();
        CHECK(opened > 0);
        CHECK(refused > 0);
    }

    TEST_CASE("opening a region stops at whichever question is answered yes, and leaves no memory") {
        const Town town(400);
        const TemporaryFolder folder;
        write_regions(town, SceneRegions::split(town.scene, 1, 1).value(), folder.path());
        const RegionFile file = open_region_index(folder.path()).value().front();
        struct Asked {
            int count = 0, stop_at = 0;
            double share = 0.0;
        };
        const auto open = [&](Asked& asked) {
            BakedRegionOptions options;
            options.region.stop_user = &asked;
            options.region.should_stop = [](void* user, double share) {
                Asked& its = *static_cast<Asked*>(user);
                std::this_thread::sleep_for(std::chrono::milliseconds(6));  // it is asked again after 5
                CHECK(share >= its.share);
                its.share = share;
                return ++its.count == its.stop_at;
            };
            return open_region(folder.path(), file, options);
        };
        Asked all;
        REQUIRE(open(all));
        CHECK(all.count > 20);
        CHECK(all.share <= 1.0);
        for (int stop_at = 1; stop_at <= all.count; stop_at += 1 + all.count / 12) {
            testing::CountingMemory memory;
            {
                Asked asked{.stop_at = stop_at};
                const auto region = open(asked);
                CHECK(error_of(region).code == ErrorCode::cancelled);
                CHECK(asked.count == stop_at);
            }
            CHECK(memory.bytes_in_use() == 0);
        }
    }

    TEST_CASE("the code of docs/large_worlds.md opens a region of a folder") {
        const Town town(30);
        const TemporaryFolder written;
        write_regions(town, SceneRegions::split(town.scene, 2, 2).value(), written.path());
        const std::string folder = written.path();
        const auto fail_loading = [](const std::string& why) { FAIL(why); };

        // Where the regions are; then, on a thread that loads, one that the player comes near.
        const auto index = crofton::bake::open_region_index(folder).value();
        const crofton::bake::RegionFile& near = index.front();
        const auto part = crofton::bake::open_region(folder, near);
        if (!part) return fail_loading(part.error().message);  // the path, and what is damaged

        World world;
        world.attach(*part, near.origin).value();
        std::filesystem::remove_all(folder);
        world.update().value();
        CHECK(world.object_count() == near.objects);
        const glm::dvec3 middle = near.origin + near.bounds.center();
        Vector<ObjectRef> found;
        world.overlap(Sphere{middle, 1000.0}, found);
        CHECK(found.size() == near.objects);
    }
}
