// SPDX-License-Identifier: MIT
// Set-ups that break other occlusion cullers.
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <crofton/core/executor.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <oracle/edges.hpp>
#include <oracle/occlusion_scenes.hpp>
#include <oracle/witness_rays.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

Obb box_of(const glm::dvec3& center, const glm::vec3& half) {
    Obb box;
    box.center = center;
    box.half_extents = half;
    return box;
}

occlude::OcclusionBuffer picture(const std::vector<Obb>& occluders, const occlude::OcclusionView& view,
                                 occlude::BufferSize size) {
    auto buffer = *occlude::OcclusionBuffer::create(size);
    buffer.draw(set_of(occluders), view);
    return buffer;
}

constexpr occlude::BufferSize kSizes[] = {{64, 36}, {320, 180}, {640, 360}, {1000, 700}};

}  // namespace

TEST_SUITE("occlude/hard cases") {
    TEST_CASE("an object seen through a gap between two occluders stays visible, however narrow the gap") {
        for (const auto& size : kSizes)
            for (const double gap : {1e-6, 1e-4, 1e-2, 0.1}) {
                const std::vector<Obb> walls = {box_of({-5.0 - 0.5 * gap, 0.0, -10.0}, {5.0f, 5.0f, 0.1f}),
                                                box_of({5.0 + 0.5 * gap, 0.0, -10.0}, {5.0f, 5.0f, 0.1f})};
                const auto buffer = picture(walls, *occlude::occlusion_view_of(Camera{}), size);
                CHECK(!buffer.hides(box_of({0.0, 0.0, -20.0}, {1.0f, 1.0f, 1.0f})));
                CHECK(buffer.hides(box_of({5.0, 0.0, -20.0}, {1.0f, 1.0f, 1.0f})));
            }
    }

    TEST_CASE("two large boxes that touch hide what is behind each, at any offset") {
        for (const double offset : {0.0, 1e4, 1e7})
            for (const auto& size : kSizes) {
                Camera camera;
                camera.position = offset_of(offset);
                const std::vector<Obb> walls = {
                    box_of(camera.position + glm::dvec3(-512.0, 0.0, -600.0), {512.0f, 512.0f, 64.0f}),
                    box_of(camera.position + glm::dvec3(512.0, 0.0, -600.0), {512.0f, 512.0f, 64.0f})};
                const auto buffer = picture(walls, *occlude::occlusion_view_of(camera), size);
                CHECK(buffer.hides(box_of(camera.position + glm::dvec3(100.0, 0.0, -800.0), {20.0f, 20.0f, 20.0f})));
                CHECK(buffer.hides(box_of(camera.position + glm::dvec3(-100.0, 0.0, -800.0), {20.0f, 20.0f, 20.0f})));
            }
    }

    TEST_CASE("an opening at the picture's edge shows what is behind it") {
        const Camera camera;
        const double edge = 10.0 * std::tan(0.5 * camera.fov_y) * camera.aspect;  // of the picture, ten metres away
        for (const auto& size : kSizes)
            for (const double opening : {1e-9, 1e-6, 1e-3}) {
                // The wall ends just before the picture does; the object stands in the opening, and beyond it.
                const std::vector<Obb> walls = {box_of({edge - opening - 50.0, 0.0, -10.1}, {50.0f, 50.0f, 0.1f})};
                const auto buffer = picture(walls, *occlude::occlusion_view_of(camera), size);
                CHECK(!buffer.hides(box_of({2.0 * edge, 0.0, -20.0}, {0.5f, 0.5f, 0.5f})));
                CHECK(buffer.hides(box_of({0.0, 0.0, -20.0}, {0.5f, 0.5f, 0.5f})));
            }
    }

    TEST_CASE("a box whose silhouette is the picture's rim, to the last digit, covers nothing") {
        // Seen from beside, a box's far edge is drawn on the rim; all of the rest lies beyond it. Where the box is just
        // not left out, its silhouette is the rim but for a few roundings. Its axes in any order, on either side.
        std::size_t drawn = 0;
        for (unsigned trial = 0; trial < 240; ++trial) {
            const occlude::BufferSize size{320 + 8 * (trial % 100), 256};
            Camera camera;
            camera.fov_y = 0.8 + 1e-3 * trial;
            camera.aspect = 1.25;
            const auto view = *occlude::occlusion_view_of(camera);
            const double half_width = 0.5 + 0.01 * (trial % 37), far = 10.0 + 0.37 * (trial % 50);
            Obb box;
            const glm::vec3 half(half_width, 1.0, 3.0);
            const int first = static_cast<int>(trial) % 3, step = trial % 2 ? 1 : 2;
            for (int k = 0; k < 3; ++k) {
                const int j = (first + step * k) % 3;
                box.axes[k] = glm::vec3(0.0f);
                box.axes[k][j] = trial / 6 >> k & 1 ? -1.0f : 1.0f;
                box.half_extents[k] = half[j];
            }
            auto buffer = *occlude::OcclusionBuffer::create(size);
            const double side = trial / 48 % 2 ? -1.0 : 1.0;
            const auto is_drawn = [&](double x) {
                box.center = {side * x, 0.0, 3.0 - far};
                buffer.draw(set_of({box}), view);
                return buffer.statistics().pieces_drawn > 0;
            };
            double in = half_width, out = 1e3;
            for (double x = 0.5 * (in + out); in < x && x < out; x = 0.5 * (in + out)) (is_drawn(x) ? in : out) = x;
            for (int n = 0; n < 8; ++n, in = std::nextafter(in, 0.0)) {
                if (!is_drawn(in)) continue;
                ++drawn;
                REQUIRE(buffer.count_covered() == 0);
                REQUIRE(!buffer.hides(box_of({side * (in - half_width + 3.0), 0.0, -4.0 * far}, glm::vec3(0.5f))));
            }
        }
        CHECK(drawn > 500);
    }

    TEST_CASE("an eye inside an occluder sees through it, and past it") {
        const std::vector<Obb> around = {box_of({0.0, 0.0, 0.0}, {2.0f, 2.0f, 2.0f})};
        const std::vector<Obb> both = {around[0], box_of({0.0, 0.0, -10.0}, {2.0f, 2.0f, 0.5f})};
        const auto view = *occlude::occlusion_view_of(Camera{});
        const Obb object = box_of({0.0, 0.0, -15.0}, {0.5f, 0.5f, 0.5f});
        CHECK(!picture(around, view, {320, 180}).hides(object));
        CHECK(picture(both, view, {320, 180}).hides(object));
    }

    TEST_CASE("an occluder through the near plane hides by what lies beyond, and by that alone") {
        Camera camera;
        camera.near_distance = 1.0;
        // A wall along the left side of the view, from behind the eye to far ahead.
        const std::vector<Obb> walls = {box_of({-2.0, 0.0, -20.0}, {0.5f, 3.0f, 40.0f})};
        const auto buffer = picture(walls, *occlude::occlusion_view_of(camera), {640, 360});
        CHECK(buffer.hides(box_of({-6.0, 0.0, -20.0}, {0.5f, 0.5f, 0.5f})));
        CHECK(!buffer.hides(box_of({0.0, 0.0, -20.0}, {0.5f, 0.5f, 0.5f})));
        // A wall whose front lies before the near plane: the picture shows what is behind.
        const std::vector<Obb> near_wall = {box_of({0.0, 0.0, -1.0}, {3.0f, 3.0f, 0.5f})};
        CHECK(!picture(near_wall, *occlude::occlusion_view_of(camera), {640, 360})
                   .hides(box_of({0.0, 0.0, -5.0}, {0.5f, 0.5f, 0.5f})));
    }

    TEST_CASE("boxes about the near plane, tilted any way, cover no more than what is drawn of them") {
        Random random(25);
        std::size_t covered = 0, passed = 0;
        for (int trial = 0; trial < 1500; ++trial) {
            OcclusionScene scene;
            scene.camera = camera_at(random, 0.0);
            scene.size = {24, 16};
            const double close = scene.camera.near_distance;
            for (int i = 0; i < 3; ++i) {
                const glm::dvec3 at = point_in_view(random, scene.camera, close * random.uniform(0.5, 1.5));
                scene.occluders.push_back(box_at(random, at, 0.1 * close, 2.0 * close));
            }
            const auto buffer = picture(scene.occluders, *occlude::occlusion_view_of(scene.camera), scene.size);
            for (std::uint32_t y = 0; y < scene.size.height; ++y)
                for (std::uint32_t x = 0; x < scene.size.width; ++x) {
                    const float nearness = buffer.nearness(x, y);
                    if (nearness < -1e38f) continue;
                    ++covered;
                    const double u = random.uniform(), v = random.uniform();
                    const auto ray = ray_through(scene, x + u, y + v, distance_of(scene.camera, nearness));
                    passed += oracle::is_free(ray, scene.occluders);
                }
        }
        CHECK(covered > 10'000);
        CHECK(passed == 0);
    }

    TEST_CASE("tiles seen in parallel, edge to edge, hide what each is above") {
        Camera camera;
        camera.position = {0.0, 50.0, 0.0};
        camera.forward = {0.0, -1.0, 0.0};
        camera.up = {0.0, 0.0, -1.0};
        camera.projection = Projection::orthographic;
        camera.height = 16.0;
        camera.aspect = 1.0;
        std::vector<Obb> tiles;
        for (int x = -8; x < 8; ++x)
            for (int z = -8; z < 8; ++z)
                if ((x + z) % 5 != 0) tiles.push_back(box_of({x + 0.5, 10.0, z + 0.5}, {0.5f, 0.1f, 0.5f}));
        const auto buffer = picture(tiles, *occlude::occlusion_view_of(camera), {256, 256});
        for (int x = -8; x < 8; ++x)
            for (int z = -8; z < 8; ++z) {
                const bool hidden = buffer.hides(box_of({x + 0.5, 0.0, z + 0.5}, {0.3f, 1.0f, 0.3f}));
                CHECK(hidden == ((x + z) % 5 != 0));
            }
        CHECK(!buffer.hides(box_of({0.5, 12.0, -3.5}, {0.3f, 1.0f, 0.3f})));  // above the tiles
    }

    TEST_CASE("beams far longer than the picture, as far out behind a wall as they count as hidden, are hidden") {
        Random random(26);
        int close = 0;
        for (int trial = 0; trial < 200; ++trial) {
            OcclusionScene scene;
            scene.camera = camera_at(random, 0.0);
            scene.camera.projection = Projection::orthographic;
            scene.camera.height = 64.0;
            scene.camera.aspect = 1.0;
            scene.size = {64, 64};
            const glm::dmat3 view_to_world = glm::transpose(world_to_view_rotation(scene.camera));
            const auto view = *occlude::occlusion_view_of(scene.camera);
            // The left half of the picture, up to where the last column just counts as covered.
            const double column = 32.0;
            const auto wall_to = [&](double x) {
                Obb wall = box_of(ray_through(scene, x, 32.0, 10.0).to, {50.0f, 50.0f, 1.0f});
                wall.axes = glm::mat3(view_to_world);
                wall.center -= 50.0 * view_to_world[0];
                return wall;
            };
            double less = 0.0, more = 0.1;
            while (more - less > 1e-6) {
                const double middle = 0.5 * (less + more);
                (picture({wall_to(column + middle)}, view, scene.size).nearness(31, 32) < -1e38f ? less : more) =
                    middle;
            }
            const std::vector<Obb> walls = {wall_to(column + more + 1e-5)};
            const auto buffer = picture(walls, view, scene.size);
            // Upright, nearly, and behind the wall but for its right side.
            const double slope = random.uniform(-1e-4, 1e-4);
            const glm::dvec3 up = glm::normalize(view_to_world[1] + slope * view_to_world[0]);
            const glm::dvec3 right = glm::cross(up, view_to_world[2]);
            Obb beam = box_of(ray_through(scene, column, 32.0, 30.0).to,
                              {4.0f, static_cast<float>(random.uniform(1e4, 4e4)), 0.0f});
            beam.axes = glm::mat3(glm::dmat3(right, up, view_to_world[2]));
            beam.center -= 4.0 * right - random.uniform(-0.9, 0.9) * double(beam.half_extents.y) * up;
            // Where its right side passes the picture's middle, to doubles.
            const auto side = [&] {
                const glm::dvec3 edge = beam.center + 4.0 * glm::dvec3(beam.axes[0]), along(beam.axes[1]);
                const glm::dvec3 to_middle = ray_through(scene, column, 32.0, 30.0).to - edge;
                return edge + glm::dot(to_middle, view_to_world[1]) / glm::dot(along, view_to_world[1]) * along;
            };
            const glm::dvec3 center = beam.center;
            const auto is_hidden_at = [&](double x) {
                beam.center = center;
                beam.center +=
                    glm::dot(ray_through(scene, x, 32.0, 30.0).to - side(), view_to_world[0]) * view_to_world[0];
                return buffer.hides(beam);
            };
            REQUIRE(is_hidden_at(column - 2.5));
            REQUIRE(!is_hidden_at(column + 0.1));
            const double last = oracle::edge_between(column - 2.5, column + 0.1, is_hidden_at).first;
            CHECK(is_hidden_at(last));
            CHECK(!oracle::is_free(ray_to(scene.camera, side() - 1e-7 * view_to_world[0]), walls));
            close += last > column - 0.2;
        }
        CHECK(close > 50);
    }

    TEST_CASE("matrices of any kind give the answers of the camera that they come from") {
        Random random(21);
        for (int trial = 0; trial < 20; ++trial) {
            OcclusionScene scene = random_scene(random, 0.0, 200);
            const auto set = set_of(scene.occluders);
            auto from_camera = *occlude::OcclusionBuffer::create(scene.size),
                 from_matrix = *occlude::OcclusionBuffer::create(scene.size);
            from_camera.draw(set, *occlude::occlusion_view_of(scene.camera));
            std::size_t differ = 0;
            for (const DepthRange depth :
                 {DepthRange::reversed_zero_to_one, DepthRange::zero_to_one, DepthRange::minus_one_to_one}) {
                Camera camera = scene.camera;
                if (camera.projection == Projection::perspective && trial % 2) camera.far_distance = HUGE_VAL;
                const glm::dmat4 matrix = view_to_clip(camera, depth) * glm::dmat4(world_to_view_rotation(camera));
                from_matrix.draw(set, *occlude::occlusion_view_of(matrix, depth, camera.position));
                for (const Obb& object : scene.objects) {
                    const bool hidden = from_matrix.hides(object);
                    differ += hidden != from_camera.hides(object);
                    if (!hidden) continue;
                    for (int n = 0; n < 6; ++n) {
                        const glm::dvec3 point = point_of(random, object);
                        CHECK(!(is_in_view(from_matrix.view().frustum, point) &&
                                oracle::is_free(ray_to(scene.camera, point), scene.occluders)));
                    }
                }
            }
            CHECK(differ <= 2);  // rows of the matrix are rounded otherwise
        }
    }

    TEST_CASE("a mirrored picture hides the same") {
        Random random(22);
        const OcclusionScene scene = random_scene(random, 0.0, 100);
        Camera camera = scene.camera;
        camera.projection = Projection::perspective;
        const glm::dmat4 matrix = view_to_clip(camera) * glm::dmat4(world_to_view_rotation(camera));
        glm::dmat4 mirror(1.0);
        mirror[0][0] = -1.0;
        const auto straight =
            picture(scene.occluders,
                    *occlude::occlusion_view_of(matrix, DepthRange::reversed_zero_to_one, camera.position), {160, 96});
        const auto mirrored = picture(
            scene.occluders,
            *occlude::occlusion_view_of(mirror * matrix, DepthRange::reversed_zero_to_one, camera.position), {160, 96});
        std::size_t covered = 0, differ = 0;
        for (std::uint32_t y = 0; y < 96; ++y)
            for (std::uint32_t x = 0; x < 160; ++x) {
                const bool a = straight.nearness(x, y) > -1e38f;
                covered += a;
                differ += a != (mirrored.nearness(159 - x, y) > -1e38f);
            }
        CHECK(covered > 100);
        CHECK(differ <= 2);
    }

    TEST_CASE("slivers by the thousand cover no pixel that they do not fill") {
        std::vector<Obb> slivers;
        Random random(23);
        for (int i = 0; i < 20'000; ++i)
            slivers.push_back(box_of({random.uniform(-8, 8), 0.0, -10.0 - random.uniform()}, {1e-4f, 6.0f, 1e-4f}));
        const auto buffer = picture(slivers, *occlude::occlusion_view_of(Camera{}), {320, 180});
        for (std::uint32_t x = 0; x < 320; ++x) CHECK(buffer.nearness(x, 90) < -1e38f);
    }

    TEST_CASE("the occluder that hides is named") {
        const std::vector<Obb> walls = {box_of({0.0, 0.0, -5.0}, {0.5f, 0.5f, 0.5f}),
                                        box_of({0.0, 0.0, -10.0}, {4.0f, 4.0f, 0.5f}),
                                        box_of({0.0, 0.0, -30.0}, {4.0f, 4.0f, 0.5f})};
        const auto buffer = picture(walls, *occlude::occlusion_view_of(Camera{}), {640, 360});
        Vector<occlude::OccluderId> ids;
        buffer.hidden_by(box_of({2.5, 0.0, -14.0}, {0.5f, 0.5f, 0.5f}), ids);
        CHECK(ids == Vector<occlude::OccluderId>{1});
        buffer.hidden_by(box_of({0.0, 0.0, -14.0}, {2.0f, 2.0f, 0.5f}), ids);
        CHECK(ids == Vector<occlude::OccluderId>{1});
        buffer.hidden_by(box_of({2.5, 0.0, -8.0}, {0.5f, 0.5f, 0.5f}), ids);
        CHECK(ids.empty());
        const std::vector<Obb> overlapping = {box_of({-1.5, 0.0, -10.0}, {2.0f, 4.0f, 0.5f}),
                                              box_of({1.5, 0.0, -11.0}, {2.0f, 4.0f, 0.5f})};
        const auto both = picture(overlapping, *occlude::occlusion_view_of(Camera{}), {640, 360});
        both.hidden_by(box_of({0.0, 0.0, -14.0}, {2.0f, 2.0f, 0.5f}), ids);
        CHECK(ids == Vector<occlude::OccluderId>{0, 1});
    }

    TEST_CASE("a box just within the silhouette of one body is hidden, whatever the buffer's size") {
        // The wall ends at 0.3 of the distance, and the boxes begin at 18.9: there at 5.67.
        const std::vector<Obb> walls = {box_of({0.0, 0.0, -10.5}, {3.0f, 3.0f, 0.5f})};
        for (const occlude::BufferSize size : {occlude::BufferSize{64, 36}, {640, 360}}) {
            const auto buffer = picture(walls, *occlude::occlusion_view_of(Camera{}), size);
            for (const double side : {-1.0, 1.0}) {
                CHECK(buffer.hides(box_of({side * 5.569, 0.0, -19.0}, {0.1f, 0.1f, 0.1f})));
                CHECK(!buffer.hides(box_of({side * 5.572, 0.0, -19.0}, {0.1f, 0.1f, 0.1f})));
            }
            // Close behind a wall that slants away, one pixel of which reaches far back.
            const std::vector<Obb> floor = {box_of({0.0, -2.0, -60.0}, {50.0f, 0.5f, 50.0f})};
            const auto slanting = picture(floor, *occlude::occlusion_view_of(Camera{}), size);
            CHECK(slanting.hides(box_of({0.0, -1.61, -40.0}, {0.1f, 0.1f, 0.1f})));
            CHECK(!slanting.hides(box_of({0.0, -1.59, -40.0}, {0.1f, 0.1f, 0.1f})));
        }
    }

    TEST_CASE("every instruction set and number of threads gives the same bits") {
        ThreadPool pool(3);
        Random random(24);
        for (int trial = 0; trial < 6; ++trial) {
            const OcclusionScene scene = random_scene(random, trial % 2 ? 1e6 : 0.0, 1000);
            const auto set = set_of(scene.occluders);
            const auto view = *occlude::occlusion_view_of(scene.camera);
            const std::size_t words = (scene.objects.size() + 63) / 64;
            auto reference = *occlude::OcclusionBuffer::create({333, 201});
            reference.draw(set, view);
            std::vector<std::uint64_t> expected(words), hidden(words);
            reference.find_hidden(scene.objects, expected);
            const auto compare = [&](Executor& executor) {
                auto buffer = *occlude::OcclusionBuffer::create({333, 201});
                buffer.draw(set, view, executor);
                std::size_t differ = 0;
                for (std::uint32_t y = 0; y < 201; ++y)
                    for (std::uint32_t x = 0; x < 333; ++x) differ += buffer.nearness(x, y) != reference.nearness(x, y);
                CHECK(differ == 0);
                buffer.find_hidden(scene.objects, hidden, executor);
                CHECK(hidden == expected);
            };
            compare(pool);
            for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                CAPTURE(hwy::TargetName(rest & -rest));
                compare(serial_executor());
            }
            hwy::SetSupportedTargetsForTest(0);
        }
    }

    TEST_CASE(
        "a matrix of a camera very far from the origin is perspective, and one whose w grows sideways is refused") {
        const glm::dvec3 eye(1e13, 3e12, -7e13);
        for (const double factor : {1.0, 1e-13, 1e13}) {
            glm::dmat4 matrix = glm::perspectiveRH_ZO(1.0, 1.5, 1e7, 1e15);
            for (int r = 0; r < 4; ++r)
                matrix[3][r] -= matrix[0][r] * eye.x + matrix[1][r] * eye.y + matrix[2][r] * eye.z;
            const auto view = occlude::occlusion_view_of(factor * matrix, DepthRange::zero_to_one);
            REQUIRE(view.has_value());
            CHECK(view->perspective);
            CHECK(glm::length(view->origin - eye) <= view->eye_error + 0.02);
            const auto buffer =
                picture({box_of(eye - glm::dvec3(0.0, 0.0, 1e8), {5e7f, 5e7f, 1e6f})}, *view, {320, 180});
            CHECK(buffer.hides(box_of(eye - glm::dvec3(2e8, 0.0, 1e9), {1e8f, 1e8f, 1e6f})));
            CHECK(!buffer.hides(box_of(eye - glm::dvec3(5.2e8, 0.0, 1e9), {1e8f, 1e8f, 1e6f})));
        }
        glm::dmat4 sideways = glm::orthoRH_ZO(-10.0, 10.0, -10.0, 10.0, 1.0, 100.0);
        sideways[0][3] = 0.05;
        const auto refused = occlude::occlusion_view_of(sideways, DepthRange::zero_to_one);
        REQUIRE(!refused.has_value());
        CHECK(refused.error().code == ErrorCode::unsupported);
    }
}
