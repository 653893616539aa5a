// SPDX-License-Identifier: MIT
// Where the street leads: inside of what is closed, at a person's height over whatever is below the camera.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "assets/flat_scene.hpp"
#include "assets/scene_source.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/street.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

constexpr double kEye = 1.7;

// Triangles that a test puts together.
struct Model {
    TriangleMesh mesh;

    void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
    }
    // Twelve triangles that look outward, or inward.
    void box(const glm::vec3& low, const glm::vec3& high, bool inward = false) {
        const auto corner = [&](int i) {
            return glm::vec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
        };
        constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        for (const auto& f : kFaces)
            inward ? quad(corner(f[3]), corner(f[2]), corner(f[1]), corner(f[0]))
                   : quad(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]));
    }
    void turn_inside_out() {
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
    void scale(float factor) {
        for (glm::vec3& p : mesh.positions) p *= factor;
    }
    assets::SceneSource source(double unit = 1.0) const {
        assets::SceneSource result;
        result.name = "model";
        result.unit = unit;
        const auto node = result.scene.add_node(scene::kNone, {});
        REQUIRE(result.scene.add_instance(*node, *result.scene.add_mesh(mesh)).has_value());
        result.scene.update();
        return result;
    }
};

// A tube around `middle(t)`, t from 0 to 1, of so many rings and sides, with lids.
template <class Middle>
Model tube(Middle middle, float radius, int rings, int sides) {
    Model model;
    const auto point = [&](int ring, int side) {
        const double t = static_cast<double>(ring) / rings, d = 1e-4;
        const glm::dvec3 along = glm::normalize(middle(t + d) - middle(t - d));
        const glm::dvec3 across = glm::normalize(glm::cross(along, glm::dvec3(0, 1, 0))),
                         up = glm::cross(across, along);
        const double angle = 2.0 * std::numbers::pi * (side + 0.5) / sides;
        return glm::vec3(middle(t) + static_cast<double>(radius) * (std::cos(angle) * across + std::sin(angle) * up));
    };
    for (int ring = 0; ring < rings; ++ring)
        for (int side = 0; side < sides; ++side)
            model.quad(point(ring, side), point(ring, side + 1), point(ring + 1, side + 1), point(ring + 1, side));
    for (const int ring : {0, rings})
        for (int side = 1; side + 1 < sides; side += 1) {
            const int a = ring == 0 ? side + 1 : side, b = ring == 0 ? side : side + 1;
            model.quad(point(ring, 0), point(ring, a), point(ring, b), point(ring, b));
            model.mesh.indices.resize(model.mesh.indices.size() - 3);
        }
    return model;
}

template <class Height>
Model terrain(Height height, float size, int cells) {
    Model model;
    const auto point = [&](int i, int j) {
        const float x = size * static_cast<float>(i) / static_cast<float>(cells),
                    z = size * static_cast<float>(j) / static_cast<float>(cells);
        return glm::vec3(x, static_cast<float>(height(static_cast<double>(x), static_cast<double>(z))), z);
    };
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) model.quad(point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j));
    return model;
}

// Along ±y from p, over all triangles one by one.
double distance_along_y(const TriangleMesh& mesh, const glm::dvec3& p, double sign) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[t]]), b(mesh.positions[mesh.indices[t + 1]]),
            c(mesh.positions[mesh.indices[t + 2]]);
        const auto area = [](const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& w) {
            return (v.x - u.x) * (w.z - u.z) - (v.z - u.z) * (w.x - u.x);
        };
        const double whole = area(a, b, c), wa = area(p, b, c) / whole, wb = area(p, c, a) / whole, wc = 1.0 - wa - wb;
        if (whole == 0.0 || wa < 0.0 || wb < 0.0 || wc < 0.0) continue;
        const double d = sign * (wa * a.y + wb * b.y + wc * c.y - p.y);
        if (d >= 0.0) nearest = std::min(nearest, d);
    }
    return nearest;
}

// All frames of a street through the source.
struct Walked {
    std::vector<glm::dvec3> eyes;
    double least_over_floor = HUGE_VAL, most_over_floor = 0.0, length = 0.0;
    std::string remark;
    std::size_t under_roof = 0;
};

Walked walk_through(const assets::SceneSource& source, std::uint32_t frames = 40) {
    const Aabb focus = focus_of(source.scene);
    const Street street = street_of(source, focus);
    PathOptions options{.kind = "street", .frames = frames};
    street.set(options);
    const auto path = make_camera_path(options, focus, street.walk).value();
    const auto flat = assets::flat_scene(source).value();
    Walked walked;
    walked.remark = street.remark;
    for (const Camera& camera : path.cameras) {
        const double below = distance_along_y(flat.mesh, camera.position, -1.0);
        walked.least_over_floor = std::min(walked.least_over_floor, below);
        walked.most_over_floor = std::max(walked.most_over_floor, below);
        walked.under_roof += std::isfinite(distance_along_y(flat.mesh, camera.position, 1.0));
        if (!walked.eyes.empty()) walked.length += glm::distance(walked.eyes.back(), camera.position);
        walked.eyes.push_back(camera.position);
        CHECK(validate(camera).has_value());
        CHECK(camera.near_distance < 0.5 * below);
    }
    return walked;
}

void check_person(const Walked& walked) {
    CHECK(walked.least_over_floor == doctest::Approx(kEye).epsilon(0.002));
    CHECK(walked.most_over_floor == doctest::Approx(kEye).epsilon(0.002));
    CHECK(walked.remark == "");
}

}  // namespace

TEST_SUITE("pipeline/street") {
    TEST_CASE("a closed room of twelve triangles is walked inside, whichever way they look and wherever it stands") {
        for (const bool inward : {true, false})
            for (const glm::vec3& size : {glm::vec3(8, 3, 5), glm::vec3(40, 6, 30), glm::vec3(3, 2.4f, 3),
                                          glm::vec3(400, 12, 90), glm::vec3(2.5f, 2.2f, 60)})
                for (const glm::vec3& corner : {glm::vec3(0), glm::vec3(-700, 45, 230)}) {
                    CAPTURE(inward);
                    CAPTURE(size.x);
                    CAPTURE(corner.x);
                    Model model;
                    model.box(corner, corner + size, inward);
                    const Walked walked = walk_through(model.source());
                    check_person(walked);
                    CHECK(walked.under_roof == walked.eyes.size());
                    CHECK(walked.length > 0.3 * static_cast<double>(std::max(size.x, size.z)));
                    for (const glm::dvec3& eye : walked.eyes)
                        for (int k = 0; k < 3; ++k) {
                            CHECK(eye[k] > static_cast<double>(corner[k]));
                            CHECK(eye[k] < static_cast<double>(corner[k] + size[k]));
                        }
                }
    }

    TEST_CASE("a tube is walked inside from end to end, straight, bent or rising, whichever way its faces look") {
        const auto straight = [](double t) { return glm::dvec3(60.0 * t, 0.0, 0.0); };
        const auto bent = [](double t) { return glm::dvec3(30.0 * std::sin(2.0 * t), 0.0, 30.0 * std::cos(2.0 * t)); };
        const auto rising = [](double t) { return glm::dvec3(50.0 * t, 12.0 * t, 8.0 * std::sin(3.0 * t)); };
        const auto check = [](Model model, float radius, auto middle) {
            for (int turned = 0; turned < 2; ++turned, model.turn_inside_out()) {
                CAPTURE(turned);
                const Walked walked = walk_through(model.source());
                check_person(walked);
                CHECK(walked.under_roof == walked.eyes.size());
                CHECK(walked.length > 40.0);
                for (const glm::dvec3& eye : walked.eyes) {
                    double nearest = HUGE_VAL;
                    for (int i = 0; i <= 500; ++i) nearest = std::min(nearest, glm::distance(eye, middle(i / 500.0)));
                    CHECK(nearest < static_cast<double>(radius));
                }
            }
        };
        for (const float radius : {1.4f, 2.5f}) {
            CAPTURE(radius);
            check(tube(straight, radius, 40, 24), radius, straight);
            check(tube(bent, radius, 60, 24), radius, bent);
            check(tube(rising, radius, 60, 24), radius, rising);
        }
    }

    TEST_CASE("in a building of several storeys one walks on one of the floors, not on the roof nor around it") {
        for (const bool thick : {true, false})
            for (const bool with_ground : {false, true}) {
                CAPTURE(thick);
                CAPTURE(with_ground);
                Model model;
                const float w = 18, d = 12, h = 3.2f;
                for (int storey = 0; storey < 3; ++storey)
                    model.box({0, h * static_cast<float>(storey), 0},
                              {w, h * static_cast<float>(storey + 1) - 0.25f, d}, true);
                if (thick) model.box({-0.3f, -0.3f, -0.3f}, {w + 0.3f, 3 * h, d + 0.3f});
                if (with_ground)
                    model.quad({-4, -0.31f, -4}, {-4, -0.31f, d + 4}, {w + 4, -0.31f, d + 4}, {w + 4, -0.31f, -4});
                const Walked walked = walk_through(model.source());
                check_person(walked);
                CHECK(walked.under_roof == walked.eyes.size());
                for (const glm::dvec3& eye : walked.eyes) {
                    CHECK(eye.x > 0.0);
                    CHECK(eye.x < 18.0);
                    CHECK(eye.z > 0.0);
                    CHECK(eye.z < 12.0);
                    CHECK(eye.y < 3.0 * 3.2);
                }
            }
    }

    TEST_CASE("over open ground the eye is 1.7 metres up, from a garden to ten kilometres, on plains and hills") {
        for (const float size : {6.0f, 300.0f, 10'000.0f})
            for (const double rise : {0.0, 0.03}) {
                CAPTURE(size);
                CAPTURE(rise);
                const double wave = static_cast<double>(size) / 9.0, high = rise * static_cast<double>(size);
                const Model model = terrain(
                    [&](double x, double z) { return high * std::sin(x / wave) * std::cos(0.7 * z / wave); }, size, 60);
                const Walked walked = walk_through(model.source());
                check_person(walked);
                CHECK(walked.under_roof == 0);
                CHECK(walked.length > 0.5 * static_cast<double>(size));
            }
    }

    TEST_CASE("solid houses on the ground are walked around, not through, at a person's height in any unit") {
        const auto houses = [](double unit) {
            std::mt19937 random(5);
            Model model;
            model.quad({0, 0, 0}, {0, 0, 90}, {90, 0, 90}, {90, 0, 0});
            for (int i = 0; i < 5; ++i)
                for (int j = 0; j < 5; ++j) {
                    const float x = 4.0f + 17.0f * static_cast<float>(i), z = 4.0f + 17.0f * static_cast<float>(j),
                                high = 4.0f + static_cast<float>(random() % 8);
                    model.box({x, 0, z}, {x + 11, high, z + 11});
                }
            model.scale(static_cast<float>(1.0 / unit));
            return model;
        };
        const auto check = [&](double unit, bool is_known) {
            CAPTURE(unit);
            CAPTURE(is_known);
            const Walked walked = walk_through(houses(unit).source(is_known ? unit : 0.0));
            CHECK((walked.remark == "") == (is_known || unit == 1.0));
            if (walked.remark != "") CHECK(walked.remark.find("--unit") != std::string::npos);
            CHECK(walked.under_roof == 0);
            CHECK(walked.length * unit > 60.0);
            for (const glm::dvec3& eye : walked.eyes) CHECK(eye.y * unit == doctest::Approx(kEye).epsilon(1e-3));
        };
        for (const double unit : {1.0, 0.01, 0.001, 0.3048, 0.0254, 1000.0}) check(unit, true);
        for (const double unit : {1.0, 0.01, 0.001}) check(unit, false);  // by the houses' height
    }

    TEST_CASE(
        "if no person fits in, the eye is where a person's is in a room of three metres, and the path reports it") {
        // A toy in metres; then millimetres, centimetres and kilometres: the format does not say so, but rooms do.
        for (const float size : {0.5f, 8'000.0f, 800.0f, 0.008f}) {
            CAPTURE(size);
            Model room;
            const glm::vec3 whole{size, 0.35f * size, 0.75f * size};
            room.box({0, 0, 0}, whole, true);
            room.box(glm::vec3(0.4f, 0.0f, 0.4f) * whole, glm::vec3(0.6f, 0.3f, 0.6f) * whole);
            const Walked walked = walk_through(room.source(size == 0.5f ? 1.0 : 0.0));
            CHECK(walked.remark.find("no place for a person") != std::string::npos);
            CHECK((walked.remark.find("if lengths are metres") == std::string::npos) == (size == 0.5f));
            CHECK(walked.remark.find("by its rooms' height of") != std::string::npos);
            CHECK(walked.under_roof == walked.eyes.size());
            const double eye = 1.7 / 3.0 * static_cast<double>(whole.y);
            CHECK(walked.least_over_floor > 0.99 * eye);
            CHECK(walked.most_over_floor < 1.01 * eye);
        }
        // In the open, nothing tells it.
        Model plate;
        plate.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0});
        const Walked walked = walk_through(plate.source());
        CHECK(walked.remark.find("by the scene's size of 1") != std::string::npos);
        CHECK(walked.most_over_floor < 0.1);
    }

    TEST_CASE("with nothing to walk on the street says so, and cameras are valid all the same") {
        Model ceiling;
        ceiling.quad({0, 3, 0}, {9, 3, 0}, {9, 3, 9}, {0, 3, 9});
        const assets::SceneSource source = ceiling.source();
        const Street street = street_of(source, focus_of(source.scene));
        CHECK(street.walk.empty());
        CHECK(street.remark.find("no floor") != std::string::npos);
        CHECK(make_camera_path({.kind = "street", .frames = 5}, focus_of(source.scene), street.walk).has_value());
    }
}
