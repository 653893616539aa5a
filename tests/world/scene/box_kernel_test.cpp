// SPDX-License-Identifier: MIT
// The scene's boxes against transformed_box() bit for bit and against exact arithmetic, on every instruction set.
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <box_kernel.hpp>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <cstring>
#include <limits>
#include <random>

#include "oracle/exact_images.hpp"

using namespace crofton;
using namespace crofton::scene;

namespace {

struct Random {
    std::mt19937 engine;
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    glm::dvec3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    glm::dmat3 rotation() {
        return glm::mat3_cast(
            glm::normalize(glm::dquat((*this)(0.1, 1.0), (*this)(-1.0, 1.0), (*this)(-1.0, 1.0), (*this)(-1.0, 1.0))));
    }
};

TriangleMesh random_mesh(Random& random) {
    TriangleMesh mesh;
    const glm::dvec3 size = random.vector(std::pow(10.0, random(-2.0, 2.0)));
    const glm::dvec3 offset = random.vector(std::pow(10.0, random(-2.0, 4.0)));
    const glm::dmat3 turn = random(0.0, 1.0) < 0.5 ? glm::dmat3(1.0) : random.rotation();
    const bool flat = random(0.0, 1.0) < 0.3;
    for (int i = 0; i < 9; ++i) {
        glm::dvec3 p = random.vector(1.0) * size;
        if (flat) p.z = 0.0;
        mesh.positions.emplace_back(turn * p + offset);
        mesh.indices.push_back(static_cast<std::uint32_t>(i));
    }
    return mesh;
}

// All that engines and their mistakes make of a place: rigid, scaled, mirrored, uneven, sheared, flat, far, nearly
// perpendicular, nearly nothing, near the limits of numbers.
Transform random_transform(Random& random, int kind) {
    Transform t{random.rotation(), random.vector(std::pow(10.0, random(-1.0, 8.0)))};
    switch (kind % 12) {
        case 1:
            t.linear *= std::pow(10.0, random(-3.0, 3.0));
            break;
        case 2:
            t.linear[0] *= -1.0;
            break;
        case 3:
            t.linear[1] *= random(0.2, 5.0);
            break;
        case 4:
            t.linear = t.linear * glm::dmat3(2, 0, 0, 0, 1, 0, 0, 0, 1) * random.rotation();
            break;
        case 5:
            t.linear[2] *= 0.0;
            break;
        case 6:
            t.linear *= 0.0;
            break;
        case 7:
            t.linear[0] += t.linear[1] * random(-3e-7, 3e-7);
            break;
        case 8:
            t.linear[2] *= std::pow(10.0, random(-14.0, -10.0));
            break;
        case 9:
            t.linear *= std::pow(10.0, random(-310.0, -70.0));
            break;
        case 10:
            t.linear *= std::pow(10.0, random(12.0, 14.9));
            break;
        case 11:
            t.translation = random.vector(1e15);
            break;
        default:
            break;
    }
    return t;
}

Scene random_scene(std::uint32_t seed, int count) {
    Random random{std::mt19937(seed)};
    Scene scene;
    for (int m = 0; m < 20; ++m) (void)scene.add_mesh(random_mesh(random)).value();
    for (int i = 0; i < count; ++i) {
        NodeId node = scene.add_node(kNone, random_transform(random, i)).value();
        if (i % 3 == 0) node = scene.add_node(node, random_transform(random, i / 3)).value();
        (void)scene.add_instance(node, static_cast<MeshId>(i % 20)).value();
    }
    return scene;
}

}  // namespace

TEST_SUITE("scene/box_kernel") {
    TEST_CASE(
        "all boxes are those of transformed_box, bit for bit, on every instruction set and any number of threads") {
        ThreadPool pool(3);
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CAPTURE(hwy::TargetName(rest & -rest));
            for (const int count : {1, 2, 3, 31, 33, 1000, 6000}) {
                Scene scene = random_scene(static_cast<std::uint32_t>(count), count);
                UpdateStatistics statistics;
                if (count % 2 == 0)
                    statistics = scene.update(pool);
                else
                    statistics = scene.update();
                std::uint32_t invalid = 0;
                for (InstanceId i = 0; i < scene.instance_count(); ++i) {
                    const Transform& world = scene.world(scene.node_of(i));
                    const auto box =
                        transformed_box(world, scene.mesh_box(scene.mesh_of(i)), measure::minimal_perimeter());
                    const Obb expected = box ? *box : Obb();
                    CHECK(std::memcmp(&scene.world_boxes()[i], &expected, sizeof expected) == 0);
                    CHECK(scene.layer_masks()[i] == (box && !maps_to_point(world) ? ~0u : 0u));
                    invalid += box ? 0 : 1;
                }
                CHECK(statistics.instances_invalid == invalid);
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    // A lane that is not done costs a scene time, though its box is the same.
    TEST_CASE("a kernel does every box of its kind and no flat one, whatever the lanes held before") {
        Random random{std::mt19937(5)};
        const double weights[3] = {0.0, 0.0, 1.0};
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CAPTURE(hwy::TargetName(rest & -rest));
            for (std::size_t count = 1; count <= kBoxesAtOnce; ++count)
                for (const bool sheared : {false, true})
                    for (const double stale : {0.0, 1.0}) {
                        BoxBlock block;
                        std::fill(std::begin(block.done), std::end(block.done), stale);
                        for (std::size_t k = 0; k < count; ++k) {
                            Transform t{random.rotation(), random.vector(10.0)};
                            if (sheared) t.linear[1] += 0.5 * t.linear[0];
                            if (k % 5 == 4) t.linear[2] = glm::dvec3(0.0);
                            const Obb box{random.vector(1.0), glm::mat3(1.0f), {1.0f, 2.0f, 3.0f}};
                            const auto* const from = reinterpret_cast<const std::byte*>(&t);
                            const auto* const shape = reinterpret_cast<const std::byte*>(&box);
                            std::memcpy(block.center[k], shape, 24);
                            for (std::size_t part = 0; part < 3; ++part) {
                                std::memcpy(block.world[part][k], from + 32 * part, 32);
                                std::memcpy(block.shape[part][k], shape + 24 + 16 * part, 16);
                            }
                        }
                        if (sheared)
                            transform_sheared_boxes(block, count, weights);
                        else
                            transform_boxes(block, count);
                        for (std::size_t k = 0; k < count; ++k) CHECK(block.done[k] == (k % 5 == 4 ? 0.0 : 1.0));
                    }
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("boxes contain the exact image of every vertex, decided in exact arithmetic") {
        Scene scene = random_scene(77, 6000);
        scene.update();
        std::size_t checked = 0;
        for (InstanceId i = 0; i < scene.instance_count(); ++i) {
            const Transform& world = scene.world(scene.node_of(i));
            double size = 0.0;
            for (int k = 0; k < 3; ++k) size = std::max(size, glm::length(world.linear[k]));
            if (!(size > 1e-60 || size == 0.0)) continue;  // products beyond the range of exact expansions
            if (!transformed_box(world, scene.mesh_box(scene.mesh_of(i)), measure::minimal_perimeter())) continue;
            for (const glm::vec3& p : scene.mesh(scene.mesh_of(i)).positions)
                CHECK(testing::contains_exact_image(scene.world_boxes()[i], world, glm::dvec3(p)));
            ++checked;
        }
        CHECK(checked > 5000);
    }
}
