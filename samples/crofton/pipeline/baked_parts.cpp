// SPDX-License-Identifier: MIT
#include "baked_parts.hpp"

#include <algorithm>
#include <crofton/bake/container.hpp>

namespace crofton::pipeline {
namespace {

Error of_another_scene(const char* what, std::uint64_t item = kNoItem) {
    return fail(ErrorCode::invalid_argument, item,
                std::string("was baked of another scene (") + what +
                    "): bake this one, with the same --map, --seed and --instances");
}

// Occluders lie within these meshes, on these nodes: all must be the same. Where nodes stand does not matter.
Result<void> check_same(const bake::BakedScene& baked, const scene::Scene& scene) {
    if (baked.mesh_count() != scene.mesh_count() || baked.instances().size() != scene.instance_count() ||
        baked.nodes().size() != scene.node_count())
        return of_another_scene("it has another number of meshes, nodes or instances");
    for (scene::MeshId i = 0; i < scene.mesh_count(); ++i) {
        const bake::MeshView mesh = baked.mesh(i);
        const TriangleMesh& own = scene.mesh(i);
        if (!std::equal(mesh.positions.begin(), mesh.positions.end(), own.positions.begin(), own.positions.end()) ||
            !std::equal(mesh.indices.begin(), mesh.indices.end(), own.indices.begin(), own.indices.end()))
            return of_another_scene("a mesh differs", i);
    }
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (baked.instances()[i].mesh != scene.mesh_of(i) || baked.instances()[i].node != scene.node_of(i))
            return of_another_scene("an instance differs", i);
    return {};
}

Result<BakedParts> parts_of(std::span<const std::byte> file, const scene::Scene& scene,
                            const assets::ReadLimits& limits) {
    const auto reader = bake::Reader::open(file);
    if (!reader) return reader.error();
    BakedParts parts;
    if (reader->has("occluder")) {
        const auto baked = bake::BakedScene::from_memory(file);
        if (!baked) return baked.error();
        if (auto same = check_same(*baked, scene); !same)
            parts.left_out.push_back(std::move(same.error()));
        else
            parts.occluders = std::make_shared<const SceneOccluders>(scene_occluders_from(scene, *baked->occluders()));
    }
    if (reader->has("pvs_head")) {
        auto sets = pvs::Pvs::from_memory(file, {.pairs = limits.bytes});  // a byte each
        if (!sets) return sets.error();
        if (!is_baked_of(*sets, scene))
            parts.left_out.push_back(of_another_scene("its visible sets are of other triangles or places"));
        else
            parts.pvs = std::make_shared<const pvs::Pvs>(std::move(*sets));
    }
    if (!parts.occluders && !parts.pvs && parts.left_out.empty())
        return fail(ErrorCode::empty, kNoItem,
                    "has neither occluders ('crofton bake' writes them) nor potentially visible sets ('crofton pvs')");
    return parts;
}

}  // namespace

bool same_parts(const scene::Scene& a, const scene::Scene& b) {
    if (a.mesh_count() != b.mesh_count() || a.instance_count() != b.instance_count() ||
        a.node_count() != b.node_count())
        return false;
    for (scene::MeshId i = 0; i < a.mesh_count(); ++i)
        if (a.mesh(i).positions != b.mesh(i).positions || a.mesh(i).indices != b.mesh(i).indices) return false;
    for (scene::InstanceId i = 0; i < a.instance_count(); ++i)
        if (a.mesh_of(i) != b.mesh_of(i) || a.node_of(i) != b.node_of(i)) return false;
    return true;
}

bool is_baked_of(const pvs::Pvs& pvs, const scene::Scene& scene) {
    if (pvs.object_count() != scene.instance_count()) return false;
    std::vector<scene::InstanceId> moving;
    for (scene::InstanceId i = 0; i < pvs.object_count(); ++i)
        if (!pvs.is_baked(i)) moving.push_back(i);
    const auto geometry = pvs::geometry_of(scene, moving);
    return geometry && pvs::fingerprint_of(*geometry) == pvs.geometry_fingerprint();
}

Result<BakedParts> load_baked_parts(const std::string& path, const scene::Scene& scene,
                                    const assets::ReadLimits& limits) {
    const auto file = bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = limits.bytes});
    if (!file) return file.error();
    auto parts = parts_of(file->bytes(), scene, limits);
    if (!parts) return fail(parts.error().code, parts.error().item, {path, ": ", parts.error().message});
    for (Error& error : parts->left_out) error.message = path + ": " + std::string(error.message);
    return parts;
}

}  // namespace crofton::pipeline
