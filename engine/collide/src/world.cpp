#include <algorithm>
#include <cmath>
#include <crofton/collide/world.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "pair_list.hpp"

namespace crofton::collide {
namespace {

// The tree of a mesh, or of an instance whose transform is no rigid motion.
struct Body {
    mesh::MeshTree tree;
    glm::dmat3 linear{1.0};  // that the vertices were multiplied by
    std::uint64_t revision = 0;
    bool built = false, usable = false;
};

bool is_rotation(const glm::dmat3& m) {
    const glm::dmat3 gram = glm::transpose(m) * m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(gram[i][j] - (i == j ? 1.0 : 0.0)) <= 1e-7)) return false;
    return true;
}

void build(const TriangleMesh& mesh, std::uint64_t revision, const glm::dmat3& linear, Body& body) {
    body.built = true;
    body.revision = revision;
    body.linear = linear;
    Result<mesh::MeshTree> tree = [&] {
        if (linear == glm::dmat3(1.0)) return mesh::MeshTree::build(mesh);
        TriangleMesh turned;
        turned.indices = mesh.indices;
        turned.positions.reserve(mesh.positions.size());
        for (const glm::vec3& p : mesh.positions) turned.positions.push_back(glm::vec3(linear * glm::dvec3(p)));
        return mesh::MeshTree::build(turned);
    }();
    body.usable = tree.has_value();
    if (tree) body.tree = std::move(*tree);
}

struct Outcome {
    bool hit = false;
    mesh::Containment inside = mesh::Containment::none;
    std::uint32_t worker = 0, begin = 0, count = 0;
};

struct Worker {
    Vector<mesh::MeshContact> found, all;
    mesh::MeshStatistics statistics;
};

}  // namespace

struct World::State {
    WorldOptions options;
    WorldStatistics statistics;
    Broadphase broadphase;
    Vector<Filter> filters;
    Vector<Body> by_mesh, by_instance;
    Vector<Outcome> outcomes;
    Vector<Worker> workers;
    Vector<InstancePair> pairs;
    Vector<mesh::MeshContact> contacts;
    Vector<IdPair> now, before, began, stayed, ended;
    Vector<std::uint32_t> rejected;

    Body& prepare(const scene::Scene& scene, std::uint32_t instance);
    [[nodiscard]] const Body& body_of(const scene::Scene& scene, std::uint32_t instance) const;
    void test_meshes(const scene::Scene& scene, Executor& executor);
    void test_pair(const scene::Scene& scene, const IdPair& pair, std::uint32_t worker, Outcome& outcome);
    void gather();
};

World::World(const WorldOptions& options) : state_(std::make_unique<State>()) {
    state_->options = options;
    state_->broadphase = Broadphase({.exact_boxes = true, .max_pairs = options.max_pairs});
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::span<const InstancePair> World::pairs() const {
    return state_->pairs;
}
std::span<const mesh::MeshContact> World::contacts() const {
    return state_->contacts;
}
std::span<const IdPair> World::began() const {
    return state_->began;
}
std::span<const IdPair> World::stayed() const {
    return state_->stayed;
}
std::span<const IdPair> World::ended() const {
    return state_->ended;
}
std::span<const std::uint32_t> World::rejected() const {
    return state_->rejected;
}
const WorldStatistics& World::statistics() const {
    return state_->statistics;
}

Body& World::State::prepare(const scene::Scene& scene, std::uint32_t instance) {
    const scene::MeshId mesh = scene.mesh_of(instance);
    const glm::dmat3& linear = scene.world(scene.node_of(instance)).linear;
    const bool rigid = is_rotation(linear);
    Body& body = rigid ? by_mesh[mesh] : by_instance[instance];
    const glm::dmat3 wanted = rigid ? glm::dmat3(1.0) : linear;
    if (!body.built || body.linear != wanted || body.revision != scene.mesh_revision(mesh)) {
        build(scene.mesh(mesh), scene.mesh_revision(mesh), wanted, body);
        ++statistics.trees_built;
    }
    return body;
}

const Body& World::State::body_of(const scene::Scene& scene, std::uint32_t instance) const {
    return is_rotation(scene.world(scene.node_of(instance)).linear) ? by_mesh[scene.mesh_of(instance)]
                                                                    : by_instance[instance];
}

void World::State::test_pair(const scene::Scene& scene, const IdPair& pair, std::uint32_t worker_index,
                             Outcome& outcome) {
    Worker& worker = workers[worker_index];
    const auto pose_of = [&](std::uint32_t instance) {
        const scene::Transform& world = scene.world(scene.node_of(instance));
        return RigidTransform{is_rotation(world.linear) ? world.linear : glm::dmat3(1.0), world.translation};
    };
    const Body &a = body_of(scene, pair.first), &b = body_of(scene, pair.second);
    outcome = {};
    if (!a.usable || !b.usable) return;
    const RigidTransform pose_a = pose_of(pair.first), b_to_a = relative(pose_a, pose_of(pair.second));
    if (options.contacts) {
        mesh::contacts(a.tree, b.tree, b_to_a, worker.found, &worker.statistics);
        outcome = {!worker.found.empty(), mesh::Containment::none, worker_index,
                   static_cast<std::uint32_t>(worker.all.size()), static_cast<std::uint32_t>(worker.found.size())};
        for (mesh::MeshContact contact : worker.found) {
            contact.segment = {transform(pose_a, contact.segment.begin), transform(pose_a, contact.segment.end)};
            contact.normal = pose_a.rotation * contact.normal;
            worker.all.push_back(contact);
        }
    } else {
        outcome.hit = intersects(a.tree, b.tree, b_to_a, &worker.statistics);
    }
    if (!outcome.hit && options.containment) {
        outcome.inside = containment_of_disjoint(a.tree, b.tree, b_to_a);
        outcome.hit = outcome.inside != mesh::Containment::none;
    }
}

void World::State::test_meshes(const scene::Scene& scene, Executor& executor) {
    const std::span<const IdPair> candidates = broadphase.pairs();
    for (const IdPair& pair : candidates)
        for (const std::uint32_t instance : {pair.first, pair.second})
            if (!prepare(scene, instance).usable) rejected.push_back(instance);
    outcomes.resize(candidates.size());
    executor.parallel_for(candidates.size(), 4, [&](std::size_t begin, std::size_t end, unsigned worker) {
        for (std::size_t i = begin; i < end; ++i) test_pair(scene, candidates[i], worker, outcomes[i]);
    });
    for (const Worker& worker : workers) {
        statistics.meshes.box_tests += worker.statistics.box_tests;
        statistics.meshes.triangle_tests += worker.statistics.triangle_tests;
        statistics.meshes.exact_tests += worker.statistics.exact_tests;
    }
    statistics.mesh_pairs_tested = candidates.size();
}

// In the order of the pairs, whoever tested them.
void World::State::gather() {
    const std::span<const IdPair> candidates = broadphase.pairs();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (!options.meshes) {
            pairs.push_back({candidates[i]});
            continue;
        }
        const Outcome& outcome = outcomes[i];
        if (!outcome.hit) continue;
        pairs.push_back({candidates[i], outcome.inside, static_cast<std::uint32_t>(contacts.size()), outcome.count});
        if (outcome.count > 0) {
            const auto from = workers[outcome.worker].all.begin() + outcome.begin;
            contacts.insert(contacts.end(), from, from + outcome.count);
        }
    }
}

Result<void> World::update(const scene::Scene& scene, std::span<const Filter> filters, Executor& executor) {
    State& s = *state_;
    const std::size_t count = scene.instance_count();
    if (!filters.empty() && filters.size() != count)
        return fail(ErrorCode::invalid_argument, filters.size(), "world: filters and instances differ in number");
    s.statistics = {};
    s.pairs.clear();
    s.contacts.clear();
    s.rejected.clear();
    std::swap(s.now, s.before);
    s.now.clear();
    // An instance's own layers and partners, within the bits that its node allows.
    s.filters.resize(count);
    const std::span<const std::uint32_t> masks = scene.layer_masks();
    for (std::size_t i = 0; i < count; ++i) {
        const Filter own = filters.empty() ? Filter{~0u, ~0u} : filters[i];
        s.filters[i] = {own.layers & masks[i], own.collides_with & masks[i]};
    }
    s.by_mesh.resize(scene.mesh_count());
    s.by_instance.resize(count);
    s.workers.resize(std::max<std::size_t>(s.workers.size(), executor.concurrency()));
    for (Worker& worker : s.workers) {
        worker.all.clear();
        worker.statistics = {};
    }
    if (auto result = s.broadphase.update(scene.world_boxes(), s.filters, executor); !result) return result;
    s.rejected.assign(s.broadphase.rejected().begin(), s.broadphase.rejected().end());
    if (s.options.meshes) s.test_meshes(scene, executor);
    s.gather();
    std::sort(s.rejected.begin(), s.rejected.end());
    s.rejected.erase(std::unique(s.rejected.begin(), s.rejected.end()), s.rejected.end());
    for (const InstancePair& pair : s.pairs) s.now.push_back(pair.instances);
    compare_pairs(s.before, s.now, s.began, s.stayed, s.ended);
    s.statistics.boxes = s.broadphase.statistics();
    s.statistics.mesh_pairs_hit = s.options.meshes ? s.pairs.size() : 0;
    return {};
}

}  // namespace crofton::collide
