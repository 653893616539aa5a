// SPDX-License-Identifier: MIT
// What glTF nodes say besides their transforms: instances of their mesh, whether they are seen, morph weights, skins.
#include <doctest/doctest.h>
#include <array>
#include <assets/scene_source.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <random>

#include "gltf_asset.hpp"
#include "messages.hpp"

using namespace crofton;
using test_files::Asset;
using test_files::Json;
using test_files::says;
using test_files::TemporaryFile;

namespace {

using Point3 = std::array<double, 3>;

float number_in(std::mt19937& random, float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) / 16777216.0f);
}

std::vector<float> numbers_in(std::mt19937& random, std::size_t count, float low, float high) {
    std::vector<float> result(count);
    for (float& x : result) x = number_in(random, low, high);
    return result;
}

// As the specification of quaternions has it: v + 2 q × (q × v + w v), of a quaternion of any length.
Point3 turned(const std::array<double, 4>& q, const Point3& v) {
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const auto cross = [](const Point3& a, const Point3& b) {
        return Point3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Point3 axis{q[0], q[1], q[2]}, first = cross(axis, v);
    const Point3 second = cross(axis, {first[0] + q[3] * v[0], first[1] + q[3] * v[1], first[2] + q[3] * v[2]});
    Point3 result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = v[k] + 2.0 * second[k] / square;
    return result;
}

constexpr std::size_t kCorners = 6;
const std::vector<float> kSolid = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 2, 2, -1, 3, 0.5f};
const std::vector<std::uint16_t> kSolidIndices = {0, 2, 1, 0, 1, 3, 1, 2, 4, 3, 5, 4};

Point3 corner(std::size_t v) {
    return {kSolid[3 * v], kSolid[3 * v + 1], kSolid[3 * v + 2]};
}

// One node with a mesh of six vertices and four triangles.
Asset solid() {
    Asset asset;
    const auto positions = asset.accessor(kSolid, "VEC3");
    asset.mesh(positions, asset.accessor(kSolidIndices, "SCALAR"));
    return asset;
}

Result<assets::SceneSource> load_asset(const Asset& asset, const assets::LoadOptions& options = {}) {
    const TemporaryFile file("nodes.glb", asset.glb());
    auto source = assets::load_scene(file.path(), options);
    if (source) source->scene.update();
    return source;
}

// Vertex `v` of an instance in the world.
glm::dvec3 placed(const assets::SceneSource& source, scene::InstanceId i, std::size_t v) {
    return source.scene.world(source.scene.node_of(i)) *
           glm::dvec3(source.scene.mesh(source.scene.mesh_of(i)).positions[v]);
}

void check_near(const glm::dvec3& found, const Point3& expected, double within) {
    for (int k = 0; k < 3; ++k) CHECK(std::abs(found[k] - expected[static_cast<std::size_t>(k)]) <= within);
}

// The only warning of a file that loads, or the message of one that does not.
std::string complaint(const Asset& asset) {
    const auto source = load_asset(asset);
    if (!source) return source.error().message;
    return source->warnings.size() == 1 ? source->warnings[0] : std::to_string(source->warnings.size()) + " warnings";
}

// With instances at accessors that `add` makes.
Asset instanced(const std::function<Json(Asset&)>& add) {
    Asset asset = solid();
    asset.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = add(asset);
    asset.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    return asset;
}

}  // namespace

TEST_SUITE("assets/gltf_nodes") {
    TEST_CASE("instances stand where translation, rotation, scale and the node put them") {
        std::mt19937 random(4618);
        for (int trial = 0; trial < 200; ++trial) {
            CAPTURE(trial);
            const std::size_t count = 1 + random() % 40;
            const int kind = trial % 4;  // of the rotations: floats, bytes, shorts, none
            const bool moves = random() % 4 != 0, scales = random() % 3 != 0 || (!moves && kind == 3);
            const auto translations = numbers_in(random, 3 * count, -50.0f, 50.0f),
                       scale = numbers_in(random, 3 * count, -3.0f, 3.0f);
            std::vector<std::array<double, 4>> turns(count, {0.0, 0.0, 0.0, 1.0});
            std::vector<float> floats;
            std::vector<std::int8_t> bytes;
            std::vector<std::int16_t> shorts;
            for (auto& q : turns) {
                if (kind == 3) break;
                double length = 0.0;
                for (double& x : q) x = static_cast<double>(number_in(random, -1.0f, 1.0f)), length += x * x;
                for (double& x : q) {
                    x /= std::sqrt(length);
                    const double most = kind == 1 ? 127.0 : 32767.0;
                    x = kind == 0 ? static_cast<double>(static_cast<float>(x)) : std::round(x * most) / most;
                    floats.push_back(static_cast<float>(x));
                    bytes.push_back(static_cast<std::int8_t>(std::round(x * 127.0)));
                    shorts.push_back(static_cast<std::int16_t>(std::round(x * 32767.0)));
                }
            }
            Asset asset = instanced([&](Asset& to) {
                Json attributes = {{"_ID", to.accessor(std::vector<float>(count), "SCALAR")}};
                if (moves) attributes["TRANSLATION"] = to.accessor(translations, "VEC3");
                if (scales) attributes["SCALE"] = to.accessor(scale, "VEC3");
                if (kind == 0) attributes["ROTATION"] = to.accessor(floats, "VEC4");
                if (kind == 1) attributes["ROTATION"] = to.accessor(bytes, "VEC4", true);
                if (kind == 2) attributes["ROTATION"] = to.accessor(shorts, "VEC4", true);
                return attributes;
            });
            asset.root["nodes"][0]["translation"] = {100.0, 0.0, -7.0};
            asset.root["nodes"][0]["scale"] = {2.0, 1.0, -1.0};
            asset.root["nodes"][0]["children"] = {1};
            asset.root["nodes"].push_back({{"mesh", 0}});  // a child is there once
            const auto source = load_asset(asset, {.strict = true});
            REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
            REQUIRE(source->scene.instance_count() == count + 1);
            CHECK(source->scene.mesh_count() == 1);
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t v = 0; v < kCorners; ++v) {
                    Point3 p = corner(v);
                    for (std::size_t k = 0; k < 3; ++k) p[k] *= scales ? static_cast<double>(scale[3 * i + k]) : 1.0;
                    p = turned(turns[i], p);
                    for (std::size_t k = 0; k < 3; ++k)
                        p[k] += moves ? static_cast<double>(translations[3 * i + k]) : 0.0;
                    check_near(placed(*source, static_cast<scene::InstanceId>(i), v),
                               {100.0 + 2.0 * p[0], p[1], -7.0 - p[2]}, 2e-5);
                }
        }
    }

    TEST_CASE("attributes that do not fit, and instances that make no sense, are named and left out") {
        const auto add = [](std::size_t translations, std::size_t rotations, float w) {
            return instanced([=](Asset& to) {
                std::vector<float> q(4 * rotations, 0.0f);
                for (std::size_t i = 3; i < q.size(); i += 4) q[i] = i == 3 ? w : 1.0f;
                return Json{{"TRANSLATION", to.accessor(std::vector<float>(3 * translations, 1.0f), "VEC3")},
                            {"ROTATION", to.accessor(q, "VEC4")}};
            });
        };
        CHECK(complaint(add(3, 3, 1.0f)) == "0 warnings");
        CHECK(says(complaint(add(3, 2, 1.0f)),
                   "node 0: EXT_mesh_gpu_instancing: left out: ROTATION: 2 instances, where another attribute has 3"));
        for (const float w : {0.0f, std::nanf(""), INFINITY}) {
            const auto source = load_asset(add(3, 3, w)).value();
            CHECK(source.scene.instance_count() == 2);
            REQUIRE(source.warnings.size() == 1);
            CHECK(says(source.warnings[0],
                       "node 0: EXT_mesh_gpu_instancing: 1 instances left out: instance 0: its rotation"));
        }
        const auto attributes = [](const Json& value) {
            Asset asset = solid();
            asset.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = value;
            return complaint(asset);
        };
        const std::string left_out = "node 0: EXT_mesh_gpu_instancing: left out: ";
        CHECK(says(attributes(5), left_out + "has no attributes"));
        CHECK(says(attributes({{"attributes", Json::object()}}), left_out + "has no attributes"));
        CHECK(says(attributes({{"attributes", {{"TRANSLATION", 99}}}}),
                   left_out + "TRANSLATION: accessor 99: does not exist"));
        CHECK(says(attributes({{"attributes", {{"TRANSLATION", "x"}}}}), left_out + "TRANSLATION: names no accessor"));
        CHECK(says(attributes({{"attributes", {{"SCALE", 1}}}}), left_out + "SCALE: not of 3 components"));
        CHECK(says(attributes({{"attributes", {{"ROTATION", 0}}}}), left_out + "ROTATION: not of 4 components"));
        CHECK(says(attributes({{"attributes", {{"_ID", 99}}}}), left_out + "none of its attributes"));
        // Four billion instances that no bytes stand for, and more than the limit of those that are there.
        Asset huge = instanced([](Asset& to) {
            to.root["accessors"].push_back({{"componentType", 5126}, {"count", 4'000'000'000u}, {"type", "VEC3"}});
            return Json{{"TRANSLATION", to.root["accessors"].size() - 1}};
        });
        CHECK(says(complaint(huge), "--max-triangles"));
        assets::LoadOptions options;
        options.limits.nodes = 20;
        CHECK(says(test_files::message(load_asset(add(21, 21, 1.0f), options)), "--max-nodes"));
        CHECK(
            says(test_files::message(load_asset(add(20, 20, 1.0f), options)), "--max-nodes"));  // with the node itself
        CHECK(load_asset(add(19, 19, 1.0f), options).has_value());
        // Instances that are left out count, too.
        Asset bad = instanced([](Asset& to) {
            return Json{{"ROTATION", to.accessor(std::vector<float>(4 * 11, 0.0f), "VEC4")}};
        });
        CHECK(says(test_files::message(load_asset(bad, options)), "11 instances left out"));
        bad.root["nodes"].push_back(bad.root["nodes"][0]);
        bad.root["scenes"][0]["nodes"] = {0, 1};
        CHECK(says(test_files::message(load_asset(bad, options)), "--max-nodes"));
    }

    TEST_CASE("an invisible node hides all nodes below it, and no others") {
        std::mt19937 random(4619);
        for (int trial = 0; trial < 300; ++trial) {
            CAPTURE(trial);
            Asset asset = solid();
            const std::size_t count = 2 + random() % 20;
            std::vector<bool> shown(count, true);
            Json nodes = Json::array();
            for (std::size_t n = 0; n < count; ++n) {
                nodes.push_back({{"mesh", 0}, {"translation", {n, 0, 0}}});
                if (n > 0) {
                    const std::size_t parent = random() % n;
                    nodes[parent]["children"].push_back(n);
                    nodes[n]["translation"][0] = 0;
                    nodes[n]["translation"][1] = n;
                    shown[n] = shown[parent];
                }
                if (random() % 3 == 0) {
                    const bool visible = n == 0 || random() % 2 == 0;
                    nodes[n]["extensions"]["KHR_node_visibility"]["visible"] = visible;
                    shown[n] = shown[n] && visible;
                }
            }
            asset.root["nodes"] = std::move(nodes);
            asset.root["extensionsUsed"] = asset.root["extensionsRequired"] = {"KHR_node_visibility"};
            const auto source = load_asset(asset, {.strict = true});
            REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
            CHECK(source->scene.instance_count() ==
                  static_cast<std::size_t>(std::count(shown.begin(), shown.end(), true)));
        }
        Asset none = solid();
        none.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
        CHECK(says(complaint(none), "nothing to draw: all nodes with meshes are hidden by KHR_node_visibility"));
        none.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
        CHECK(says(complaint(none), "node 0: KHR_node_visibility: visible is neither true nor false; it is shown"));
    }

    TEST_CASE("morph targets move positions by their weights: the node's, else the mesh's") {
        std::mt19937 random(4620);
        for (int trial = 0; trial < 200; ++trial) {
            CAPTURE(trial);
            Asset asset = solid();
            const std::size_t targets = 1 + random() % 5;
            std::vector<std::vector<float>> moves;
            Json& primitive = asset.root["meshes"][0]["primitives"][0];
            primitive["targets"] = Json::array();
            for (std::size_t t = 0; t < targets; ++t) {
                moves.push_back(numbers_in(random, 3 * kCorners, -9.0f, 9.0f));
                if (t % 3 == 1) {  // one that moves nothing but normals
                    primitive["targets"].push_back({{"NORMAL", asset.accessor(moves.back(), "VEC3")}});
                    std::fill(moves.back().begin(), moves.back().end(), 0.0f);
                } else if (t % 3 == 2) {
                    std::vector<std::int16_t> steps;
                    for (float& x : moves.back()) {
                        steps.push_back(static_cast<std::int16_t>(x * 3000.0f));
                        x = static_cast<float>(steps.back()) / 32767.0f;
                    }
                    primitive["targets"].push_back({{"POSITION", asset.accessor(steps, "VEC3", true)}});
                } else {
                    primitive["targets"].push_back({{"POSITION", asset.accessor(moves.back(), "VEC3")}});
                }
            }
            const auto of_mesh = numbers_in(random, targets, -1.0f, 2.0f),
                       of_node = numbers_in(random, targets, -1.0f, 2.0f);
            if (trial % 4 != 0) asset.root["meshes"][0]["weights"] = of_mesh;
            asset.root["nodes"] = {
                {{"mesh", 0}, {"translation", {5, 0, 0}}}, {{"mesh", 0}, {"weights", of_node}}, {{"mesh", 0}}};
            asset.root["scenes"][0]["nodes"] = {0, 1, 2};
            const auto source = load_asset(asset, {.strict = true});
            REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
            REQUIRE(source->scene.instance_count() == 3);
            CHECK(source->scene.mesh_count() == 2);
            for (std::uint32_t i = 0; i < 3; ++i)
                for (std::size_t v = 0; v < kCorners; ++v) {
                    Point3 p = corner(v);
                    for (std::size_t t = 0; t < targets; ++t)
                        for (std::size_t k = 0; k < 3; ++k) {
                            const float weight = i == 1 ? of_node[t] : trial % 4 != 0 ? of_mesh[t] : 0.0f;
                            p[k] += static_cast<double>(weight) * static_cast<double>(moves[t][3 * v + k]);
                        }
                    if (i == 0) p[0] += 5.0;
                    check_near(placed(*source, i, v), p, 1e-5);
                }
        }
    }

    TEST_CASE("weights and targets that do not fit are named, and their mesh is left out") {
        const auto with = [](const Json& weights, std::size_t vertices = kCorners) {
            Asset asset = solid();
            asset.root["meshes"][0]["primitives"][0]["targets"] = {
                {{"POSITION", asset.accessor(std::vector<float>(3 * vertices, 1.0f), "VEC3")}}};
            asset.root["nodes"][0]["weights"] = weights;
            return complaint(asset);
        };
        CHECK(with({0.5}) == "0 warnings");
        CHECK(with(Json::array()) == "0 warnings");
        CHECK(says(with({0.5, 0.5}), "mesh 0: primitive 0: left out: 2 weights for 1 morph targets"));
        CHECK(says(with({nullptr}), "node 0: mesh 0: left out: weight 0 is no finite number"));
        CHECK(says(with({"1"}), "weight 0 is no finite number"));
        CHECK(says(with(1.0), "its weights are no list"));
        CHECK(says(with({1e300}), "vertex 0"));
        CHECK(says(with({0.5}, 5), "target 0: POSITION: accessor 2: 5 elements for 6 vertices"));
    }

    TEST_CASE("a skinned mesh is where its joints take it, whatever its own node says") {
        std::mt19937 random(4621);
        for (int trial = 0; trial < 200; ++trial) {
            CAPTURE(trial);
            Asset asset = solid();
            const std::size_t joints = 1 + random() % 6, sets = 1 + random() % 2;
            const double far = trial % 5 == 0 ? 1e7 : 0.0;
            // A chain of joints: each below the one before, the first below node 1.
            std::vector<std::array<double, 4>> turns;
            std::vector<Point3> moves;
            Json nodes = {{{"mesh", 0}, {"skin", 0}, {"translation", {1000, 0, 0}}, {"rotation", {1, 0, 0, 0}}},
                          {{"scale", {2, 2, 2}}, {"translation", {far, 0, 0}}}};
            for (std::size_t j = 0; j < joints; ++j) {
                const auto q = numbers_in(random, 4, -1.0f, 1.0f), t = numbers_in(random, 3, -5.0f, 5.0f);
                turns.push_back({q[0], q[1], q[2], q[3]});
                moves.push_back({t[0], t[1], t[2]});
                nodes.push_back({{"rotation", q}, {"translation", t}});
                nodes[j + 1]["children"] = {j + 2};
            }
            asset.root["nodes"] = std::move(nodes);
            asset.root["scenes"][0]["nodes"] = trial % 2 == 0 ? Json{0, 1} : Json{0};  // joints may be of no scene
            // Inverse binds: a scale along each axis and a translation.
            const bool binds = trial % 3 != 0;
            const auto scale = numbers_in(random, 3 * joints, 0.5f, 2.0f),
                       shift = numbers_in(random, 3 * joints, -1.0f, 1.0f);
            std::vector<float> matrices(16 * joints, 0.0f);
            for (std::size_t j = 0; j < joints; ++j) {
                for (std::size_t k = 0; k < 3; ++k) {
                    matrices[16 * j + 5 * k] = scale[3 * j + k];
                    matrices[16 * j + 12 + k] = shift[3 * j + k];
                }
                matrices[16 * j + 15] = 1.0f;
            }
            Json skin = {{"joints", Json::array()}};
            for (std::size_t j = 0; j < joints; ++j) skin["joints"].push_back(j + 2);
            if (binds) skin["inverseBindMatrices"] = asset.accessor(matrices, "MAT4");
            asset.root["skins"] = Json::array({skin});
            std::vector<std::vector<float>> weights;
            std::vector<std::vector<std::uint16_t>> numbers;
            for (std::size_t s = 0; s < sets; ++s) {
                weights.push_back(numbers_in(random, 4 * kCorners, 0.01f, 1.0f));
                for (float& w : weights.back())
                    if (random() % 3 == 0) w = 0.0f;
                weights.back()[4 * (random() % kCorners)] = 1.0f;
                numbers.emplace_back();
                for (std::size_t i = 0; i < 4 * kCorners; ++i)
                    // Where nothing weighs, any number may stand.
                    numbers.back().push_back(weights.back()[i] == 0.0f && s == 1
                                                 ? std::uint16_t{999}
                                                 : static_cast<std::uint16_t>(random() % joints));
                Json& attributes = asset.root["meshes"][0]["primitives"][0]["attributes"];
                attributes["JOINTS_" + std::to_string(s)] = asset.accessor(numbers[s], "VEC4");
                attributes["WEIGHTS_" + std::to_string(s)] = asset.accessor(weights[s], "VEC4");
            }
            const auto source = load_asset(asset, {.strict = true});
            REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
            REQUIRE(source->scene.instance_count() == 1);
            for (std::size_t v = 0; v < kCorners; ++v) {
                Point3 sum{0.0, 0.0, 0.0};
                double total = 0.0;
                for (std::size_t i = 0; i < 4 * sets; ++i) {
                    const auto weight = static_cast<double>(weights[i / 4][4 * v + i % 4]);
                    if (weight == 0.0) continue;
                    const std::size_t joint = numbers[i / 4][4 * v + i % 4];
                    Point3 p = corner(v);
                    for (std::size_t k = 0; k < 3 && binds; ++k)
                        p[k] = static_cast<double>(scale[3 * joint + k]) * p[k] +
                               static_cast<double>(shift[3 * joint + k]);
                    for (std::size_t j = joint + 1; j-- > 0;) {
                        p = turned(turns[j], p);
                        for (std::size_t k = 0; k < 3; ++k) p[k] += moves[j][k];
                    }
                    for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * (2.0 * p[k] + (k == 0 ? far : 0.0));
                    total += weight;
                }
                if (total == 0.0) continue;
                check_near(placed(*source, 0, v), {sum[0] / total, sum[1] / total, sum[2] / total}, 2e-5);
            }
        }
    }

    TEST_CASE("skins that make no sense are named, and their mesh is left out") {
        const auto with = [](const std::function<void(Asset&, Json&)>& change) {
            Asset asset = solid();
            Json& root = asset.root;
            root["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"name", "bone"}, {"children", {2}}}, Json::object()};
            root["scenes"][0]["nodes"] = {0, 1};
            std::vector<float> weights(4 * kCorners, 0.25f);
            const auto w = asset.accessor(weights, "VEC4");
            const auto j = asset.accessor(std::vector<std::uint8_t>(4 * kCorners, 1), "VEC4");
            root["skins"] = {{{"joints", {1, 2}}}};
            Json& attributes = root["meshes"][0]["primitives"][0]["attributes"];
            attributes["JOINTS_0"] = j;
            attributes["WEIGHTS_0"] = w;
            change(asset, attributes);
            return complaint(asset);
        };
        const std::string left_out = "mesh 0: primitive 0: left out: ";
        CHECK(with([](Asset&, Json&) {}) == "0 warnings");
        CHECK(says(with([](Asset& a, Json&) { a.root["nodes"][0]["skin"] = 7; }), left_out + "skin 7: does not exist"));
        CHECK(says(with([](Asset& a, Json&) { a.root["nodes"][0]["skin"] = -1; }), "node 0: mesh 0: left out"));
        CHECK(says(with([](Asset& a, Json&) { a.root["skins"][0] = "x"; }), left_out + "skin 0: has no joints"));
        CHECK(says(with([](Asset& a, Json&) {
                       a.root["skins"][0]["joints"] = {1, 99};
                   }),
                   left_out + "skin 0: joint 1: its node does not exist"));
        CHECK(says(with([](Asset& a, Json&) { a.root["skins"][0]["joints"] = {1, "x"}; }), "skin 0: joint 1"));
        CHECK(says(with([](Asset& a, Json&) {
                       a.root["nodes"][2]["children"] = {1};
                       a.root["scenes"][0]["nodes"] = {0};
                   }),
                   left_out + "skin 0: joint 0: node "));
        CHECK(says(with([](Asset& a, Json&) {
                       a.root["nodes"][1]["scale"] = {1e16, 1, 1};
                       a.root["scenes"][0]["nodes"] = {0};
                   }),
                   left_out + "skin 0: joint 0: node 1: "));
        CHECK(says(with([](Asset& a, Json&) { a.root["skins"][0]["inverseBindMatrices"] = 99; }),
                   left_out + "skin 0: inverseBindMatrices: accessor 99"));
        CHECK(says(with([](Asset& a, Json&) { a.root["skins"][0]["inverseBindMatrices"] = 0; }),
                   left_out + "skin 0: inverseBindMatrices: 6 matrices"));
        CHECK(says(with([](Asset& a, Json&) {
                       std::vector<float> m(16, 0.0f);
                       m[0] = m[5] = m[10] = m[15] = 1.0f;
                       a.root["skins"][0]["inverseBindMatrices"] = a.accessor(m, "MAT4");
                   }),
                   left_out + "skin 0: inverseBindMatrices: 1 matrices for 2 joints"));
        CHECK(says(with([](Asset& a, Json&) {
                       a.root["skins"][0]["inverseBindMatrices"] =
                           a.accessor(std::vector<float>(32, std::nanf("")), "MAT4");
                   }),
                   left_out + "skin 0: inverse bind matrix 0"));
        CHECK(says(with([](Asset&, Json& t) { t.erase("WEIGHTS_0"); }), left_out + "has no WEIGHTS_0"));
        CHECK(says(with([](Asset&, Json& t) { t.erase("JOINTS_0"); }), left_out + "has no JOINTS_0"));
        CHECK(says(with([](Asset&, Json& t) { t["JOINTS_1"] = t["JOINTS_0"]; }), left_out + "has no WEIGHTS_1"));
        CHECK(says(with([](Asset& a, Json& t) {
                       t["JOINTS_0"] = a.accessor(std::vector<std::uint8_t>(4 * kCorners, 2), "VEC4");
                   }),
                   left_out + "vertex 0: joint 2"));
        CHECK(says(with([](Asset& a, Json& t) {
                       t["JOINTS_0"] = a.accessor(std::vector<float>(4 * kCorners, -1.0f), "VEC4");
                   }),
                   left_out + "JOINTS_0: joints must be unsigned"));
        CHECK(says(
            with([](Asset& a, Json& t) { t["JOINTS_0"] = a.accessor(std::vector<std::uint8_t>(4 * 5, 1), "VEC4"); }),
            left_out + "JOINTS_0: accessor"));
        for (const float bad : {std::nanf(""), -0.5f, INFINITY})
            CHECK(says(with([&](Asset& a, Json& t) {
                           std::vector<float> w(4 * kCorners, 0.25f);
                           w[9] = bad;
                           t["WEIGHTS_0"] = a.accessor(w, "VEC4");
                       }),
                       left_out + "WEIGHTS_0: vertex 2 has a weight of"));
        CHECK(with([](Asset& a, Json& t) {
                  t["WEIGHTS_0"] = a.accessor(std::vector<float>(4 * kCorners, 0.0f), "VEC4");
              }) == "0 warnings");
        CHECK(says(with([](Asset&, Json& t) {
                       for (int n = 1; n < 20; ++n) {
                           t["JOINTS_" + std::to_string(n)] = t["JOINTS_0"];
                           t["WEIGHTS_" + std::to_string(n)] = t["WEIGHTS_0"];
                       }
                   }),
                   left_out + "has more than 16 sets"));
        // Instances of a skinned mesh would all be where its joints are.
        CHECK(says(
            with([](Asset& a, Json&) {
                a.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"TRANSLATION", 0}}}};
            }),
            "node 0: EXT_mesh_gpu_instancing of a skinned mesh: shown once"));
    }

    TEST_CASE("positions in bytes and shorts are read as they are meant, normalised or not") {
        // 127, 32767: 1. Padded to four bytes.
        for (const bool normalized : {false, true}) {
            for (const bool bytes : {false, true}) {
                Asset asset;
                const int one = !normalized ? 1 : bytes ? 127 : 32767;
                std::string packed;
                for (const int x : {0, 0, 0, 0, one, 0, 0, 0, 0, one, -one, 0}) {
                    if (bytes)
                        packed += static_cast<char>(x);
                    else
                        packed += test_files::bytes_of(static_cast<std::int16_t>(x));
                }
                const auto view = asset.view(packed);
                asset.root["bufferViews"][view]["byteStride"] = bytes ? 4 : 8;
                asset.root["accessors"].push_back(
                    {{"bufferView", view}, {"componentType", bytes ? 5120 : 5122}, {"count", 3}, {"type", "VEC3"}});
                if (normalized) asset.root["accessors"][0]["normalized"] = true;
                asset.mesh(0, asset.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR"));
                asset.root["nodes"][0]["scale"] = {3, 3, 3};
                asset.root["extensionsUsed"] = asset.root["extensionsRequired"] = {"KHR_mesh_quantization"};
                const auto source = load_asset(asset, {.strict = true});
                REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
                check_near(placed(*source, 0, 1), {3.0, 0.0, 0.0}, 0.0);
                check_near(placed(*source, 0, 2), {0.0, 3.0, -3.0}, 0.0);
            }
        }
    }

    TEST_CASE("a mesh bent in many ways counts as often, and bent alike once") {
        Asset asset = solid();
        asset.root["meshes"][0]["primitives"][0]["targets"] = {
            {{"POSITION", asset.accessor(std::vector<float>(3 * kCorners, 1.0f), "VEC3")}}};
        asset.root["nodes"] = Json::array();
        asset.root["scenes"][0]["nodes"] = Json::array();
        for (int n = 0; n < 100; ++n) {
            asset.root["nodes"].push_back({{"mesh", 0}, {"weights", {n % 10}}});
            asset.root["scenes"][0]["nodes"].push_back(n);
        }
        assets::LoadOptions options;
        options.limits.triangles = 40;
        const auto source = load_asset(asset, options);
        REQUIRE_MESSAGE(source.has_value(), test_files::message(source));
        CHECK(source->scene.mesh_count() == 10);
        options.limits.triangles = 39;
        CHECK(says(test_files::message(load_asset(asset, options)), "--max-triangles"));
    }

    TEST_CASE("a document of which any value is another one is refused by name, or loads what makes sense") {
        // Some of everything that a node can say.
        Asset asset = instanced([](Asset& to) {
            return Json{{"TRANSLATION", to.accessor(std::vector<float>(9, 1.0f), "VEC3")},
                        {"ROTATION", to.accessor(std::vector<float>(12, 0.5f), "VEC4")}};
        });
        asset.mesh(0, 1);
        Json& primitive = asset.root["meshes"][1]["primitives"][0];
        primitive["attributes"]["JOINTS_0"] = asset.accessor(std::vector<std::uint8_t>(4 * kCorners, 1), "VEC4");
        primitive["attributes"]["WEIGHTS_0"] = asset.accessor(std::vector<float>(4 * kCorners, 0.25f), "VEC4");
        primitive["targets"] = {{{"POSITION", asset.accessor(std::vector<float>(3 * kCorners, 1.0f), "VEC3")}}};
        asset.root["skins"] = {{{"joints", {2, 3}}}};
        asset.root["nodes"].push_back({{"mesh", 1}, {"skin", 0}, {"weights", {0.5}}});
        asset.root["nodes"].push_back({{"children", {3}},
                                       {"translation", {1, 2, 3}},
                                       {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}});
        asset.root["nodes"].push_back({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
        asset.root["scenes"][0]["nodes"] = {0, 1, 2};
        REQUIRE(load_asset(asset, {.strict = true})->scene.instance_count() == 4);
        const Json flat = asset.root.flatten();
        const Json others[] = {nullptr,
                               -1,
                               0,
                               1,
                               2,
                               3,
                               5126,
                               0.5,
                               1e300,
                               4294967295u,
                               18446744073709551615u,
                               "x",
                               true,
                               false,
                               Json::array(),
                               Json::object(),
                               {0},
                               {{"x", 0}}};
        std::size_t loaded = 0, refused = 0;
        for (const auto& item : flat.items())
            for (const Json& other : others) {
                Asset changed = asset;
                changed.root[Json::json_pointer(item.key())] = other;
                CAPTURE(item.key());
                CAPTURE(other.dump());
                const auto source = load_asset(changed);
                loaded += source.has_value();
                refused += !source;
                if (!source) CHECK(says(source.error().message, "nodes.glb: "));
                for (scene::InstanceId i = 0; source && i < source->scene.instance_count(); ++i)
                    if (source->scene.layer_masks()[i] != 0)
                        CHECK(validate(source->scene.world_boxes()[i]).has_value());
            }
        CHECK(loaded > 1000);
        CHECK(refused > 100);
    }

    TEST_CASE("faces of primitives without normals are flat, of those with them they are not") {
        Asset asset = solid();
        const auto positions = asset.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
        asset.root["meshes"][0]["primitives"].push_back(asset.root["meshes"][0]["primitives"][0]);
        asset.root["meshes"][0]["primitives"][1]["attributes"]["NORMAL"] = positions;
        asset.root["meshes"][0]["primitives"].push_back(asset.root["meshes"][0]["primitives"][0]);
        const auto source = load_asset(asset).value();
        CHECK(source.flat == std::vector<std::uint8_t>{1, 0, 1});
    }
}
