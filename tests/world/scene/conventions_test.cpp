// SPDX-License-Identifier: MIT
// What docs/conventions.md says of left-handed engines, other up axes and other units.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <random>

using namespace crofton;
using namespace crofton::scene;

namespace {

const glm::dmat3 kMirrorZ(glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1));

struct Random {
    std::mt19937 engine;
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    glm::dvec3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    Transform place() {
        const glm::dquat turn(1.0, (*this)(-1.0, 1.0), (*this)(-1.0, 1.0), (*this)(-1.0, 1.0));
        return {glm::mat3_cast(glm::normalize(turn)), vector(9.0)};
    }
};

TriangleMesh tetrahedron() {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 3}};
    mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    return mesh;
}

// Six times the volume, positive where triangles are counter-clockwise from outside.
double signed_volume(const TriangleMesh& mesh, const Transform& place) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) { return place * glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
        sum += glm::dot(corner(0), glm::cross(corner(1), corner(2)));
    }
    return sum;
}

// The least signed distance of a point from the planes.
double depth_in(const Frustum& frustum, const glm::dvec3& point) {
    double least = 1e300;
    for (const Plane& plane : frustum.view())
        least = std::min(least, glm::dot(plane.normal, point - frustum.origin) + plane.offset);
    return least;
}

// Left-handed, as Direct3D has it: x right, y up, +z forward; a perspective with depths 0 to 1.
glm::dmat4 left_handed_clip(double fov_y, double aspect, double near, double far) {
    const double scale = 1.0 / std::tan(0.5 * fov_y), depth = far / (far - near);
    return {{scale / aspect, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, depth, 1}, {0, 0, -near * depth, 0}};
}

}  // namespace

TEST_SUITE("scene/conventions") {
    TEST_CASE(
        "a mirrored world has mirrored boxes, each right-handed, and triangles that are seen from the other side") {
        Random random{std::mt19937(2)};
        Scene plain, mirrored;
        const MeshId mesh = plain.add_mesh(tetrahedron()).value();
        (void)mirrored.add_mesh(tetrahedron()).value();
        const NodeId root = mirrored.add_node(kNone, {kMirrorZ, {}}).value();
        for (int i = 0; i < 200; ++i) {
            const Transform place = random.place();
            (void)plain.add_instance(plain.add_node(kNone, place).value(), mesh).value();
            (void)mirrored.add_instance(mirrored.add_node(root, place).value(), mesh).value();
        }
        plain.update();
        mirrored.update();
        for (InstanceId i = 0; i < plain.instance_count(); ++i) {
            const Obb &a = plain.world_boxes()[i], &b = mirrored.world_boxes()[i];
            CHECK(b.center == kMirrorZ * a.center);
            CHECK(glm::determinant(b.axes) > 0.0f);
            CHECK(edge_sum(b) == doctest::Approx(edge_sum(a)).epsilon(1e-6));
            for (int trial = 0; trial < 20; ++trial) {
                const glm::dvec3 point = a.center + random.vector(3.0);
                Obb smaller = a, larger = a;
                smaller.half_extents *= 1.0f - 1e-5f;
                larger.half_extents *= 1.0f + 1e-5f;
                if (contains(smaller, point)) CHECK(contains(b, kMirrorZ * point));
                if (!contains(larger, point)) CHECK_FALSE(contains(b, kMirrorZ * point));
            }
            CHECK(signed_volume(plain.mesh(mesh), plain.world(plain.node_of(i))) > 0.0);
            CHECK(signed_volume(plain.mesh(mesh), mirrored.world(mirrored.node_of(i))) < 0.0);
        }
    }

    TEST_CASE("a left-handed matrix gives the frustum that the mirrored camera has in the mirrored world") {
        Camera camera;  // looks along −z
        camera.near_distance = 0.5;
        camera.far_distance = 50.0;
        const Frustum right = frustum_of(camera).value();
        const Frustum left =
            frustum_of(left_handed_clip(camera.fov_y, camera.aspect, camera.near_distance, camera.far_distance),
                       DepthRange::zero_to_one)
                .value();
        Random random{std::mt19937(3)};
        int inside = 0;
        for (int i = 0; i < 20000; ++i) {
            const glm::dvec3 point = random.vector(40.0);
            const double here = depth_in(right, point), there = depth_in(left, kMirrorZ * point);
            CHECK(std::abs(here - there) < 1e-9);
            inside += here > 0.0 ? 1 : 0;
        }
        CHECK(inside > 500);
    }

    TEST_CASE("a Camera given left-handed vectors sees the same shape, and only its left and right change places") {
        Camera camera;
        camera.forward = {0.0, 0.0, 1.0};
        camera.near_distance = 0.5;
        camera.far_distance = 50.0;
        const Frustum ours = frustum_of(camera).value();
        const Frustum theirs =
            frustum_of(left_handed_clip(camera.fov_y, camera.aspect, camera.near_distance, camera.far_distance),
                       DepthRange::zero_to_one)
                .value();
        const std::size_t same_as[] = {1, 0, 2, 3, 4, 5};
        for (std::size_t i = 0; i < 6; ++i) {
            CHECK(glm::length(ours.planes[i].normal - theirs.planes[same_as[i]].normal) < 1e-12);
            CHECK(std::abs(ours.planes[i].offset - theirs.planes[same_as[i]].offset) < 1e-9);
        }
    }

    TEST_CASE("any axis is up: a turned world has the turned frustum") {
        // z up: y and z change places by a quarter turn about x, (x, y, z) ↦ (x, −z, y).
        const glm::dmat3 z_up(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, -1, 0));
        Camera camera, turned;
        turned.forward = z_up * camera.forward;
        turned.up = z_up * camera.up;
        CHECK(turned.up == glm::dvec3(0, 0, 1));
        const Frustum a = frustum_of(camera).value(), b = frustum_of(turned).value();
        for (std::size_t i = 0; i < 6; ++i) CHECK(glm::length(z_up * a.planes[i].normal - b.planes[i].normal) < 1e-15);
    }

    TEST_CASE("units are the caller's: lengths times a power of two give the same bits, scaled") {
        Random random{std::mt19937(4)};
        for (int i = 0; i < 2000; ++i) {
            Obb box;
            box.center = random.vector(3.0);
            box.axes = glm::mat3(random.place().linear);
            box.half_extents = glm::abs(glm::vec3(random.vector(2.0)));
            Transform place = random.place();
            if (i % 2 == 0) place.linear[1] *= random(0.2, 4.0);
            const Obb metres = transformed_box(place, box, measure::minimal_perimeter()).value();
            box.center *= 128.0;
            box.half_extents *= 128.0f;
            place.translation *= 128.0;
            Obb small = transformed_box(place, box, measure::minimal_perimeter()).value();
            small.center /= 128.0;
            small.half_extents /= 128.0f;
            CHECK(std::memcmp(&metres, &small, sizeof small) == 0);
        }
    }
}
