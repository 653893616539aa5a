// A scene's collisions, frame after frame: instances in, contacts out.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/mesh/mesh_mesh.hpp>
#include <crofton/scene/scene.hpp>
#include <memory>
#include <span>

namespace crofton::collide {

struct WorldOptions {
    bool meshes = true;                            // go on to the triangles; false: pairs of boxes are the answer
    bool contacts = true;                          // where triangles meet; false: whether
    bool containment = true;                       // a closed mesh inside another counts as meeting
    std::size_t max_pairs = std::size_t{1} << 24;  // as BroadphaseOptions
};

// Two instances whose meshes meet, or whose boxes do where meshes are not asked for.
struct InstancePair {
    IdPair instances;
    mesh::Containment inside = mesh::Containment::none;  // of first (a) and second (b)
    std::uint32_t first_contact = 0, contact_count = 0;  // in contacts()
};

struct WorldStatistics {
    BroadphaseStatistics boxes;  // by group of axes, early outs
    mesh::MeshStatistics meshes;
    std::uint64_t mesh_pairs_tested = 0;
    std::uint64_t mesh_pairs_hit = 0;
    std::uint32_t trees_built = 0;  // in this update
};

// Meshes are taken as they are under a rotation and translation; under any other transform as their vertices times its
// linear part, rounded to float. A mesh's tree is built when first needed and kept.
class World {
  public:
    explicit World(const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // After scene.update(). Instances collide where their layer masks share a bit and `filters` (empty, or one an
    // instance) agree. Answers are the same with any executor. Errors: as Broadphase::update; an instance whose mesh
    // has no valid triangle, or none after its transform, meets nothing and is listed in rejected().
    Result<void> update(const scene::Scene& scene, std::span<const Filter> filters = {},
                        Executor& executor = serial_executor());

    [[nodiscard]] std::span<const InstancePair> pairs() const;          // ordered by instances
    [[nodiscard]] std::span<const mesh::MeshContact> contacts() const;  // in the world's frame
    [[nodiscard]] std::span<const IdPair> began() const;                // pairs of instances, against the update before
    [[nodiscard]] std::span<const IdPair> stayed() const;
    [[nodiscard]] std::span<const IdPair> ended() const;
    [[nodiscard]] std::span<const std::uint32_t> rejected() const;  // instances, ascending
    [[nodiscard]] const WorldStatistics& statistics() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace crofton::collide
