// SPDX-License-Identifier: MIT
#include <crofton/bake/baked_region.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <utility>

namespace crofton::bake {
namespace {

constexpr std::uint32_t kNone = scene::kNone;

// The kind of occluders that each instance has; kNone: none.
Vector<std::uint32_t> occluders_of_instances(const BakedScene& scene, const BakedRegionOptions& options) {
    const std::span<const InstanceRecord> instances = scene.instances();
    const std::span<const std::uint32_t> layers = scene.tree().layer_masks();
    Vector<std::uint32_t> kinds(instances.size(), kNone);
    if (!scene.occluders() || !options.occluders) return kinds;
    Vector<std::uint32_t> of_node(scene.nodes().size(), kNone), first(scene.nodes().size(), kNone);
    for (const OccludingNode& occluding : scene.occluders()->nodes) of_node[occluding.node] = occluding.kind;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const scene::NodeId node = instances[i].node;
        if (node == kNone || of_node[node] == kNone) continue;
        if (first[node] == kNone) {
            first[node] = i;
            kinds[i] = of_node[node];
        } else if (layers[i] != layers[first[node]]) {
            kinds[first[node]] = kNone;
        }
    }
    return kinds;
}

// The region's meshes: one for each mesh of the scene, and each set of occluders that it is used with.
class Meshes {
  public:
    Meshes(const BakedScene& scene, const BakedRegionOptions& options)
        : scene_(scene), options_(options), places_(scene.mesh_count()), boxes_(scene.mesh_count()) {}

    // The place of a mesh with a kind of occluders, or without.
    [[nodiscard]] std::uint32_t place_of(scene::MeshId mesh, std::uint32_t kind) {
        for (const auto& [known, place] : places_[mesh])
            if (known == kind) return place;
        const auto place = static_cast<std::uint32_t>(meshes_.size());
        places_[mesh].emplace_back(kind, place);
        const MeshView view = scene_.mesh(mesh);
        boxes_[mesh] = view.box;
        RegionMesh& added = meshes_.emplace_back();
        added.mesh.positions = view.positions;
        added.mesh.indices = view.indices;
        added.mesh.box = &boxes_[mesh];
        added.mesh.triangles = options_.triangles;
        added.mesh.precut = scene_.clusters(mesh);
        added.mesh.clusters = added.mesh.precut != nullptr;
        added.mesh.one_sided = view.look.one_sided;
        if (kind != kNone) added.occluders = scene_.occluders()->kinds[kind];
        return place;
    }
    [[nodiscard]] std::span<const RegionMesh> all() const { return meshes_; }

  private:
    const BakedScene& scene_;
    const BakedRegionOptions& options_;
    Vector<Vector<std::pair<std::uint32_t, std::uint32_t>>> places_;  // by mesh: kind, place
    Vector<Obb> boxes_;                                               // by mesh, of those that are used
    Vector<RegionMesh> meshes_;
};

Result<Region> prepare(const BakedScene& scene, boxtree::BoxTree* tree, const BakedRegionOptions& options,
                       Executor& executor) {
    return detail::recover([&]() -> Result<Region> {
        constexpr double kChecked = 0.2;  // of the time
        const RegionOptions& asked = options.region;
        detail::PartOfStop checking{asked.should_stop, asked.stop_user, 0.0, kChecked};
        detail::PartOfStop preparing{asked.should_stop, asked.stop_user, kChecked, 1.0};
        if (tree != nullptr && !options.trust_contents)
            if (auto valid = tree->validate(detail::PartOfStop::ask, &checking); !valid)
                return valid.error().code == ErrorCode::cancelled
                           ? detail::cancelled("region")
                           : fail(ErrorCode::parse, valid.error().item, {"stored ", valid.error().message});
        const std::span<const InstanceRecord> instances = scene.instances();
        const std::span<const std::uint32_t> layers = scene.tree().layer_masks();
        const Vector<std::uint32_t> kinds = occluders_of_instances(scene, options);
        Meshes meshes(scene, options);
        constexpr std::size_t kBetweenQuestions = 4096;
        detail::StopSignal stop(detail::PartOfStop::ask, &checking);
        Vector<RegionObject> objects;
        objects.reserve(instances.size());
        for (std::uint32_t i = 0; i < instances.size(); ++i) {
            if (i % kBetweenQuestions == 0 && stop.is_raised(1.0)) return detail::cancelled("region");
            RegionObject& object = objects.emplace_back();
            object.user = i;
            object.layers = layers[i];
            object.collides_with = options.collides_with;
            if (instances[i].mesh == kNone) {
                object.bound = Obb();
                object.layers = 0;
                continue;
            }
            object.mesh = meshes.place_of(instances[i].mesh, kinds[i]);
            object.transform = scene.nodes()[instances[i].node].world;
        }
        RegionOptions prepared = options.region;
        prepared.should_stop = detail::PartOfStop::ask;
        prepared.stop_user = &preparing;
        prepared.meshes = meshes.all();
        prepared.built = tree;
        return Region::prepare(objects, prepared, executor);
    });
}

}  // namespace

Result<Region> prepare_region(const BakedScene& scene, const BakedRegionOptions& options, Executor& executor) {
    return prepare(scene, nullptr, options, executor);
}

Result<Region> prepare_region(BakedScene&& scene, const BakedRegionOptions& options, Executor& executor) {
    return prepare(scene, &scene.tree(), options, executor);
}

}  // namespace crofton::bake
