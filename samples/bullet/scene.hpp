// SPDX-License-Identifier: MIT
// Stacks and piles of bodies in Bullet, on its own collision detection or on Crofton's.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "crofton_broadphase.hpp"
#include "crofton_contacts.hpp"

namespace crofton::bullet {

// `stack`: towers of boxes beside each other. `pile`: boxes at all angles, dropped.
enum class Arrangement { stack, pile };

struct SceneOptions {
    Arrangement arrangement = Arrangement::stack;
    int count = 1000;
    bool hulls = false;      // of 16 vertices each; else boxes
    bool may_sleep = false;  // else Bullet may put nothing to sleep
    int iterations = 10;     // of the solver; Bullet's default
    bool with_crofton = true;
};

// How still the bodies are. Metres and seconds.
struct Stillness {
    double mean_speed = 0.0, max_speed = 0.0;
    double deepest = 0.0;  // overlap of any two bodies
    std::size_t points = 0;
};

class Scene {
  public:
    explicit Scene(const SceneOptions& options);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    void step() { world_->stepSimulation(1.0f / 60.0f, 0); }
    // Takes a body out and puts it back: as bodies come and go.
    void replace(std::size_t body);
    [[nodiscard]] std::vector<btVector3> positions() const;
    [[nodiscard]] Stillness stillness() const;
    [[nodiscard]] PointCounts& counts() { return croftons_->counts(); }
    [[nodiscard]] btDiscreteDynamicsWorld& world() { return *world_; }

  private:
    void add(btCollisionShape& shape, float mass, const btVector3& place, const btQuaternion& turn, bool may_sleep);

    std::unique_ptr<btDefaultCollisionConfiguration> configuration_;
    Configuration* croftons_ = nullptr;  // the same, where Crofton's is used
    std::unique_ptr<btCollisionDispatcher> dispatcher_;
    std::unique_ptr<btBroadphaseInterface> broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

}  // namespace crofton::bullet
