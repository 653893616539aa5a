// SPDX-License-Identifier: MIT
// Convex shapes, meshes and surfaces, against rays through their triangles.
#include <doctest/doctest.h>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <oracle/occlusion_scenes.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

struct Surface {
    std::vector<Triangle> triangles;  // in the world
    bool two_sided = false;
};

struct ShapeScene {
    OcclusionScene view;
    occlude::OccluderSet set;
    std::vector<Surface> surfaces;
};

TriangleMesh sphere(std::uint32_t around, std::uint32_t up, Random& random, double rough) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= up; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double a = 6.283185307 * i / around, b = 3.141592654 * j / up;
            const double r = j == 0 || j == up ? 1.0 : 1.0 + rough * random.uniform(-1, 1);
            mesh.positions.push_back(
                j == 0    ? glm::vec3(0, 0, 1)
                : j == up ? glm::vec3(0, 0, -1)
                          : glm::vec3(r * std::sin(b) * std::cos(a), r * std::sin(b) * std::sin(a), r * std::cos(b)));
        }
    for (std::uint32_t j = 0; j < up; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t p = j * around + i, q = j * around + (i + 1) % around;
            for (const std::uint32_t k : {p, p + around, q, q, p + around, q + around}) mesh.indices.push_back(k);
        }
    return mesh;
}

TriangleMesh sheet(std::uint32_t side, Random& random, double rough) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= side; ++j)
        for (std::uint32_t i = 0; i <= side; ++i)
            mesh.positions.push_back(
                glm::vec3(2.0 * i / side - 1.0, 2.0 * j / side - 1.0, rough * random.uniform(-1, 1)));
    for (std::uint32_t j = 0; j < side; ++j)
        for (std::uint32_t i = 0; i < side; ++i) {
            if (random.uniform() < 0.1) continue;  // a hole
            const std::uint32_t p = j * (side + 1) + i;
            for (const std::uint32_t k : {p, p + 1, p + side + 2, p, p + side + 2, p + side + 1})
                mesh.indices.push_back(k);
        }
    return mesh;
}

// A convex polygon in triangles of one corner, or in a strip, that bulges by `rough` of its size.
TriangleMesh polygon(Random& random, double rough) {
    TriangleMesh mesh;
    const std::size_t corners = 3 + pick(random, 9);
    std::vector<double> angles;
    for (std::size_t i = 0; i < corners; ++i) angles.push_back(6.283185307 * random.uniform());
    std::sort(angles.begin(), angles.end());
    for (const double angle : angles) {
        const double z = rough * random.uniform(-1, 1);
        mesh.positions.push_back(glm::vec3(std::cos(angle), std::sin(angle), z));
    }
    for (std::uint32_t k = 0; k + 2 < corners; ++k) {
        const auto last = static_cast<std::uint32_t>(corners) - 1;
        const std::uint32_t fan[3] = {0, k + 1, k + 2};
        const std::uint32_t low = k / 2, high = last - k / 2;
        const std::uint32_t strip[3] = {k % 2 ? low + 1 : low, k % 2 ? high - 1 : low + 1, high};
        mesh.indices.insert(mesh.indices.end(), rough > 0.0 ? strip : fan, (rough > 0.0 ? strip : fan) + 3);
    }
    return mesh;
}

// Prisms, whose sides are two triangles in one plane exactly.
std::vector<glm::vec3> prism(Random& random) {
    std::vector<glm::vec3> points;
    const std::size_t corners = 3 + pick(random, 6);
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 6.283185307 * random.uniform();
        const glm::vec2 p(std::round(64.0 * std::cos(angle)) / 64.0, std::round(64.0 * std::sin(angle)) / 64.0);
        for (const float z : {-0.5f, 0.75f}) points.emplace_back(p, z);
    }
    return points;
}

Transform place_at(Random& random, const glm::dvec3& at) {
    Transform transform;
    const double scale = random.uniform(0.5, 4.0);
    transform.linear = scale * sampling::rotation(random.point<3>());
    transform.linear[0] *= random.uniform(0.3, 2.0);
    if (pick(random, 3) == 0) transform.linear[1] *= -1.0;  // a reflection
    transform.translation = at;
    return transform;
}

void add_surface(ShapeScene& scene, std::span<const glm::vec3> points, std::span<const std::uint32_t> indices,
                 const Transform& transform, bool two_sided) {
    const bool mirrored = glm::determinant(transform.linear) < 0.0;
    scene.surfaces.emplace_back();
    Surface& surface = scene.surfaces.back();
    surface.two_sided = two_sided;
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        glm::dvec3 p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = transform * glm::dvec3(points[indices[t + k]]);
        if (mirrored) std::swap(p[1], p[2]);
        surface.triangles.push_back({p[0], p[1], p[2]});
    }
}

void add_random_shape(ShapeScene& scene, Random& random, const glm::dvec3& at, std::size_t kind) {
    const Transform transform = place_at(random, at);
    if (kind == 0) {
        std::vector<glm::vec3> points;
        const std::size_t count = 4 + pick(random, 30);
        for (std::size_t i = 0; i < count; ++i) points.push_back(glm::vec3(sampling::direction(random.point<2>())));
        const auto hull = *convex_hull(points);
        if (hull.rank < 3) return;
        CHECK(scene.set.place(*scene.set.add_convex(points), transform));
        add_surface(scene, points, hull.triangles, transform, false);
    } else if (kind == 1) {
        const TriangleMesh mesh = sphere(24, 12, random, 0.2);
        CHECK(scene.set.place(*scene.set.add_mesh(mesh), transform));
        add_surface(scene, mesh.positions, mesh.indices, transform, false);
    } else if (kind == 4) {
        const std::vector<glm::vec3> points = prism(random);
        const auto hull = *convex_hull(points);
        if (hull.rank < 3) return;
        CHECK(scene.set.place(*scene.set.add_convex(points), transform));
        add_surface(scene, points, hull.triangles, transform, false);
    } else {
        constexpr double kRough[] = {0.0, 1e-7, 1e-5, 0.9e-3, 1.1e-3};  // to both sides of what counts as flat
        const TriangleMesh mesh = kind == 5 ? polygon(random, kRough[pick(random, 5)])
                                            : sheet(kind == 2 ? 8 : 2, random, kind == 2 ? 0.1 : 0.0);
        if (mesh.indices.empty()) return;
        const bool both = pick(random, 2) == 0;
        CHECK(scene.set.place(*scene.set.add_surface(mesh, both ? occlude::Sides::both : occlude::Sides::front),
                              transform));
        add_surface(scene, mesh.positions, mesh.indices, transform, both);
    }
}

// Whether the ray meets a front before t = 1, or a hair behind.
bool meets_front(const oracle::WitnessRay& ray, const std::vector<Surface>& surfaces) {
    const Ray line{ray.from, ray.to - ray.from, 1.0 + 1e-12};
    for (const Surface& surface : surfaces)
        for (const Triangle& triangle : surface.triangles) {
            const auto t = mesh::raycast(line, triangle);
            if (!t || *t < ray.t_near * (1.0 - 1e-9)) continue;
            const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
            if (surface.two_sided || glm::dot(normal, line.direction) < 0.0) return true;
        }
    return false;
}

}  // namespace

TEST_SUITE("occlude/shapes") {
    TEST_CASE("no ray passes a pixel that convex shapes, meshes or surfaces cover") {
        Random random(11);
        std::size_t covered[6] = {}, rays = 0;
        for (int trial = 0; trial < 120; ++trial) {
            CAPTURE(trial);
            ShapeScene scene;
            scene.view.camera = camera_at(random, 0.0);
            scene.view.size = trial % 2 ? occlude::BufferSize{120, 72} : occlude::BufferSize{61, 47};
            const std::size_t kind = static_cast<std::size_t>(trial) % 6;
            for (std::size_t i = 0; i < 3; ++i)
                add_random_shape(scene, random, point_in_view(random, scene.view.camera, 0.5 + 12.0 * random.uniform()),
                                 kind);
            auto buffer = *occlude::OcclusionBuffer::create(scene.view.size);
            buffer.draw(scene.set, *occlude::occlusion_view_of(scene.view.camera));
            std::size_t passed = 0;
            for (std::uint32_t y = 0; y < scene.view.size.height; ++y)
                for (std::uint32_t x = 0; x < scene.view.size.width; ++x) {
                    const float nearness = buffer.nearness(x, y);
                    if (nearness < -1e38f) continue;
                    ++covered[kind];
                    for (int i = 0; i < 2; ++i) {
                        const double u = i == 0 ? random.uniform() : pick(random, 2) ? 1e-6 : 1.0 - 1e-6;
                        const double v = i == 0 ? random.uniform() : pick(random, 2) ? 1e-6 : 1.0 - 1e-6;
                        const auto ray =
                            ray_through(scene.view, x + u, y + v, distance_of(scene.view.camera, nearness));
                        passed += !meets_front(ray, scene.surfaces);
                        ++rays;
                    }
                }
            CHECK(passed == 0);
        }
        MESSAGE("covered by convex shapes " << covered[0] << ", meshes " << covered[1] << ", surfaces " << covered[2]
                                            << ", squares " << covered[3] << ", prisms " << covered[4] << ", polygons "
                                            << covered[5] << "; " << rays << " rays");
        for (const std::size_t count : covered) CHECK(count > 2'000);
    }

    // A speck beside the polygon makes two pieces of it, which are drawn triangle by triangle.
    TEST_CASE("a convex polygon covers as many pixels as its triangles") {
        Random random(12);
        std::size_t as_one = 0, by_triangles = 0, not_as_one = 0;
        for (int trial = 0; trial < 200; ++trial) {
            OcclusionScene scene;
            scene.camera = camera_at(random, 0.0);
            scene.size = {160, 90};
            const Transform transform = place_at(random, point_in_view(random, scene.camera, 6.0));
            TriangleMesh mesh = polygon(random, 1e-5);
            for (const bool speck : {false, true}) {
                if (speck) {
                    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
                    for (const float x : {0.0f, 1e-6f, 0.0f})
                        mesh.positions.emplace_back(x, x == 0.0f ? 1e-6f * float(mesh.positions.size() - first) : 0.0f,
                                                    -0.01f);
                    for (std::uint32_t k = 0; k < 3; ++k) mesh.indices.push_back(first + k);
                }
                occlude::OccluderSet set;
                REQUIRE(set.place(*set.add_surface(mesh, occlude::Sides::both), transform));
                auto buffer = *occlude::OcclusionBuffer::create(scene.size);
                buffer.draw(set, *occlude::occlusion_view_of(scene.camera));
                (speck ? by_triangles : as_one) += buffer.count_covered();
                not_as_one += !speck && buffer.statistics().triangles_drawn > 0;  // with slivers, or at the near plane
            }
        }
        MESSAGE("covered as one polygon " << as_one << ", by triangles " << by_triangles);
        CHECK(by_triangles > 50'000);
        CHECK(not_as_one < 10);
        CHECK(as_one * 1000 >= by_triangles * 995);
    }

    TEST_CASE("a mesh covers its inside without seams") {
        Random random(12);
        occlude::OccluderSet set;
        Transform transform;
        transform.translation = {0.0, 0.0, -4.0};
        REQUIRE(set.place(*set.add_mesh(sphere(48, 24, random, 0.0)), transform));
        Camera camera;
        camera.aspect = 1.0;
        auto buffer = *occlude::OcclusionBuffer::create({200, 200});
        buffer.draw(set, *occlude::occlusion_view_of(camera));
        // The sphere's picture is a disc of radius tan(asin(1/4)), less what the polyhedron lacks; a pixel and a half
        // are lost at the rim at most.
        const double radius =
            std::tan(std::asin(0.25)) / std::tan(0.5 * camera.fov_y) * 100.0 * std::cos(3.15 / 24) - 1.5;
        std::size_t gaps = 0, inside = 0;
        for (std::uint32_t y = 0; y < 200; ++y)
            for (std::uint32_t x = 0; x < 200; ++x) {
                if (std::hypot(x + 0.5 - 100.0, y + 0.5 - 100.0) > radius) continue;
                ++inside;
                gaps += buffer.nearness(x, y) < -1e38f;
            }
        CHECK(inside > 3'000);
        CHECK(gaps <= inside / 500);
    }
}
