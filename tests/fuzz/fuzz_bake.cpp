// SPDX-License-Identifier: MIT
// Baked scenes whose checksums are right, whatever they hold: an adversary would have made them so, too.
#include <crofton/bake/baked_region.hpp>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/crofton.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstring>

#include "mend_checksums.hpp"
#include "use_tree.hpp"

namespace {

using namespace crofton;

// Reads every byte that the views lead to.
void read_all(const bake::BakedScene& scene) {
    unsigned sum = 0;
    const auto read = [&](auto span) {
        for (const std::byte byte : std::as_bytes(span)) sum += static_cast<unsigned>(byte);
    };
    for (scene::MeshId m = 0; m < scene.mesh_count(); ++m) {
        const bake::MeshView mesh = scene.mesh(m);
        read(std::span(mesh.name));
        read(mesh.positions);
        read(mesh.colors);
        for (const std::uint32_t i : mesh.indices)
            if (i >= mesh.positions.size()) std::abort();
        if (const depth::ClusteredMesh* const cut = scene.clusters(m)) {
            Vector<std::uint32_t> permuted(mesh.indices.size());
            cut->permute(mesh.indices, permuted);
            const depth::DepthObject object{cut, glm::mat4(0.01f)};
            depth::DepthCuller culler;
            if (!culler.find_visible(std::span(&object, 1), {.width = 16, .height = 16})) std::abort();
        }
        if (const auto polygon = scene.polygon(m)) {
            read(polygon->points);
            for (const std::uint32_t end : polygon->ring_ends)
                if (end > polygon->points.size()) std::abort();
        }
    }
    for (const bake::InstanceRecord& instance : scene.instances())
        if (instance.mesh != scene::kNone && instance.mesh >= scene.mesh_count()) std::abort();
    read(scene.nodes());
    volatile unsigned seen = sum;
    (void)seen;
}

// Attaches the scene as a region, and asks each object and the whole. What was checked loses no object of a view.
void ask_region(bake::BakedScene&& scene, bool trust_contents) {
    const std::span<const std::uint32_t> masks = scene.tree().layer_masks();
    const Vector<std::uint32_t> layers(masks.begin(), masks.end());
    bake::BakedRegionOptions options;
    options.trust_contents = trust_contents;
    const auto region = bake::prepare_region(std::move(scene), options);
    if (!region) return;
    World world;
    const auto handle = world.attach(*region, {1000.0, 0.0, 0.5});
    if (!handle) return;
    (void)world.add({.bound = Sphere{region->bounds().min + glm::dvec3(1000.0, 0.0, 0.5), 1.0}});
    if (!world.update()) std::abort();
    Camera camera;
    camera.position = {998.0, 0.0, 0.0};
    camera.forward = {1.0, 0.0, 0.0};
    ViewResult visible;
    std::size_t in_view = 0;
    for (std::uint32_t i = 0; i < region->object_count(); ++i)
        if (layers[i] != 0)
            in_view += cull::classify(*frustum_of(camera), *world.box_of(*world.object_in(*handle, i))) !=
                       cull::Verdict::outside;
    for (const auto order : {cull::ResultOrder::tree, cull::ResultOrder::ascending})
        if (world.view({.camera = camera, .order = order}, visible)) {
            std::size_t of_region = 0;
            for (std::size_t i = 0; i < visible.size(); ++i) {
                if (!world.contains(visible[i].object)) std::abort();
                of_region += visible[i].object.index >= kFirstRegionIndex ? 1 : 0;
            }
            if (!trust_contents && of_region != in_view) std::abort();
        }
    (void)world.raycast({camera.position, camera.forward});
    Vector<ObjectRef> found;
    world.overlap(Sphere{{1000.0, 0.0, 0.0}, 2.0}, found);
    for (std::uint32_t i = 0; i < region->object_count(); ++i)
        if (!world.box_of(*world.object_in(*handle, i))) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Vector<std::byte> file(size);
    if (size > 0) std::memcpy(file.data(), data, size);
    fuzz::mend_checksums(file);
    auto scene = bake::BakedScene::from_memory(file);
    if (!scene) return 0;
    read_all(*scene);
    fuzz::query(scene->tree());
    ask_region(std::move(*scene), true);
    scene = bake::BakedScene::from_memory(file);
    ask_region(std::move(*scene), false);
    return 0;
}
