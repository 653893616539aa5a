// SPDX-License-Identifier: MIT
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace crofton::bullet {
namespace {

constexpr float kHalf = 0.5f;

// As round as sixteen corners are, and flat below and above, so that it can rest.
std::unique_ptr<btConvexHullShape> rock() {
    auto shape = std::make_unique<btConvexHullShape>();
    for (int i = 0; i < 16; ++i) {
        const float angle = 6.2831853f * static_cast<float>(i % 8) / 8.0f, y = i < 8 ? -kHalf : kHalf;
        shape->addPoint(btVector3(kHalf * std::cos(angle), y, kHalf * std::sin(angle)), false);
    }
    shape->setMargin(0.0f);
    shape->recalcLocalAabb();
    return shape;
}

}  // namespace

Scene::Scene(const SceneOptions& options) {
    if (options.with_crofton) {
        auto made = std::make_unique<Configuration>();
        croftons_ = made.get();
        configuration_ = std::move(made);
        broadphase_ = std::make_unique<Broadphase>();
    } else {
        configuration_ = std::make_unique<btDefaultCollisionConfiguration>();
        broadphase_ = std::make_unique<btDbvtBroadphase>();
    }
    dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
    if (options.with_crofton) dispatcher_->setNearCallback(skip_pairs_apart);
    world_ =
        std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), broadphase_.get(), &solver_, configuration_.get());
    world_->setGravity({0, -9.81f, 0});
    world_->setForceUpdateAllAabbs(false);
    world_->getSolverInfo().m_numIterations = options.iterations;

    const int wide = std::max(1, static_cast<int>(std::round(std::cbrt(static_cast<double>(options.count)))));
    shapes_.push_back(
        std::make_unique<btBoxShape>(btVector3(4.0f * static_cast<float>(wide), 1, 4.0f * static_cast<float>(wide))));
    add(*shapes_.back(), 0.0f, {0, -1, 0}, btQuaternion::getIdentity(), true);
    if (options.hulls)
        shapes_.push_back(rock());
    else
        shapes_.push_back(std::make_unique<btBoxShape>(btVector3(kHalf, kHalf, kHalf)));
    btCollisionShape& shape = *shapes_.back();
    std::mt19937 random(1);
    const auto uniform = [&] { return static_cast<float>(random()) * 0x1p-32f; };
    const bool pile = options.arrangement == Arrangement::pile;
    for (int i = 0; i < options.count; ++i) {
        const auto x = static_cast<float>(i % wide) - 0.5f * static_cast<float>(wide - 1),
                   z = static_cast<float>(i / wide % wide) - 0.5f * static_cast<float>(wide - 1),
                   y = static_cast<float>(i / (wide * wide));
        if (!pile) {
            add(shape, 1.0f, {1.2f * x, y + kHalf, 1.2f * z}, btQuaternion::getIdentity(), options.may_sleep);
            continue;
        }
        const float a = uniform(), b = uniform(), c = uniform(), angle = uniform();
        const btQuaternion turn(btVector3(a - 0.5f, b - 0.5f, c + 0.01f).normalized(), 3.0f * angle);
        add(shape, 1.0f, {1.25f * x, 1.6f * y + 1.0f, 1.25f * z}, turn, options.may_sleep);
    }
}

void Scene::add(btCollisionShape& shape, float mass, const btVector3& place, const btQuaternion& turn, bool may_sleep) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0.0f) shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform = btTransform(turn, place);
    info.m_friction = 0.6f;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    if (mass > 0.0f && !may_sleep) bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_->addRigidBody(bodies_.back().get());
}

Scene::~Scene() {
    for (const auto& body : bodies_) world_->removeRigidBody(body.get());
}

void Scene::replace(std::size_t body) {
    world_->removeRigidBody(bodies_[body].get());
    world_->addRigidBody(bodies_[body].get());
}

std::vector<btVector3> Scene::positions() const {
    std::vector<btVector3> positions;
    for (const auto& body : bodies_) positions.push_back(body->getWorldTransform().getOrigin());
    return positions;
}

Stillness Scene::stillness() const {
    Stillness result;
    for (const auto& body : bodies_) {
        const double speed = body->getLinearVelocity().length();
        result.mean_speed += speed / static_cast<double>(bodies_.size());
        result.max_speed = std::max(result.max_speed, speed);
    }
    for (int i = 0; i < dispatcher_->getNumManifolds(); ++i) {
        const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(i);
        result.points += static_cast<std::size_t>(manifold.getNumContacts());
        for (int k = 0; k < manifold.getNumContacts(); ++k)
            result.deepest = std::max(result.deepest, -static_cast<double>(manifold.getContactPoint(k).getDistance()));
    }
    return result;
}

}  // namespace crofton::bullet
