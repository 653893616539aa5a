// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/gltf_patches.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "gltf_asset.hpp"
#include "messages.hpp"
#include "rich_asset.hpp"

using namespace crofton;
using assets::PrimitivePatches;
using test_files::Asset;
using test_files::Json;
using test_files::rich_asset;
using test_files::says;
using test_files::strip_indices;
using test_files::strip_positions;
using test_files::TemporaryFile;

namespace {

struct Done {
    assets::GltfDocument before, after;
    std::vector<PrimitivePatches> outcomes;
};

Done run(const Asset& asset, const assets::PatchSettings& settings = {}) {
    const TemporaryFile file("a.glb", asset.glb());
    const auto document = assets::read_gltf_document(file.path()).value();
    Done done{document, document, {}};
    auto outcomes = assets::retriangulate_patches(done.after, settings).value();
    done.outcomes = std::move(outcomes);
    return done;
}

// Straight from the bytes: tightly packed accessors only.
std::vector<std::uint32_t> indices_of(const assets::GltfDocument& document, std::size_t mesh,
                                      std::size_t primitive = 0) {
    const Json& accessor =
        document
            .root["accessors"][document.root["meshes"][mesh]["primitives"][primitive]["indices"].get<std::size_t>()];
    const Json& view = document.root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t size = accessor["componentType"] == 5125 ? 4 : accessor["componentType"] == 5123 ? 2 : 1;
    std::vector<std::uint32_t> result(accessor["count"].get<std::size_t>(), 0);
    const std::size_t begin = view["byteOffset"].get<std::size_t>() + accessor.value("byteOffset", std::size_t{0});
    for (std::size_t i = 0; i < result.size(); ++i)
        std::memcpy(&result[i], document.buffers[view["buffer"].get<std::size_t>()].data() + begin + i * size, size);
    return result;
}

// Twice the area that each triangle covers, summed: what overlaps counts twice.
double area(const std::vector<float>& xyz, const std::vector<std::uint32_t>& indices) {
    double sum = 0.0;
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        const float *a = &xyz[3 * indices[t]], *b = &xyz[3 * indices[t + 1]], *c = &xyz[3 * indices[t + 2]];
        sum += std::fabs(double{b[0] - a[0]} * double{c[1] - a[1]} - double{b[1] - a[1]} * double{c[0] - a[0]});
    }
    return sum;
}

std::string why(const PrimitivePatches& p) {
    return p.error ? p.error->message : p.left_alone;
}

// Two strips of which the second's place can be damaged.
struct Pair {
    Asset asset;
    Pair() {
        for (int i = 0; i < 2; ++i) {
            const std::size_t positions = asset.accessor(strip_positions(8, static_cast<float>(i)), "VEC3");
            asset.mesh(positions, asset.accessor(strip_indices<std::uint16_t>(8), "SCALAR"));
        }
    }
    Json& damaged() { return asset.root["meshes"][1]["primitives"][0]; }
    // The first is done, the second named and as it was.
    std::string second() {
        const Done done = run(asset);
        REQUIRE(done.outcomes.size() == 2);
        CHECK(done.outcomes[0].report.improved == 1);
        CHECK_FALSE(done.outcomes[0].error.has_value());
        CHECK(done.outcomes[1].report.improved == 0);
        CHECK(done.after.root == done.before.root);
        return why(done.outcomes[1]);
    }
};

}  // namespace

TEST_SUITE("assets/gltf_patches") {
    TEST_CASE("a document without meshes has no outcomes, one of damaged meshes is refused") {
        Asset asset;
        CHECK(run(asset).outcomes.empty());
        const auto refused = [&](const Json& meshes) {
            asset.root["meshes"] = meshes;
            const TemporaryFile file("a.glb", asset.glb());
            auto document = assets::read_gltf_document(file.path()).value();
            return !assets::retriangulate_patches(document, {}).has_value();
        };
        CHECK(refused(7));
        CHECK(refused({7}));
        CHECK(refused({{{"primitives", 7}}}));
        CHECK(refused({{{"primitives", {7}}}}));
    }

    TEST_CASE("a primitive that is damaged or compressed is named and stays as it was, the others are done") {
        SUBCASE("NaN") {
            Pair pair;
            const float nan = std::numeric_limits<float>::quiet_NaN();
            const auto& view = pair.asset.root["bufferViews"][2];
            std::memcpy(pair.asset.binary.data() + view["byteOffset"].get<std::size_t>() + 12, &nan, sizeof nan);
            CHECK(says(pair.second(), "vertex 1"));
        }
        SUBCASE("an index out of range") {
            Pair pair;
            pair.asset.binary[pair.asset.root["bufferViews"][3]["byteOffset"].get<std::size_t>()] = 99;
            CHECK(says(pair.second(), "99"));
        }
        SUBCASE("an accessor that ends beyond its view, or its view beyond its buffer") {
            Pair pair;
            pair.asset.root["accessors"][3]["count"] = 3000;
            CHECK(says(pair.second(), "indices: accessor 3: 3000 elements do not fit"));
            pair.asset.root["bufferViews"][3]["byteLength"] = 1'000'000;
            CHECK(says(pair.second(), "beyond its buffer"));
        }
        SUBCASE("no such accessor, no number, no view, another type, another count") {
            Pair pair;
            pair.damaged()["indices"] = 99;
            CHECK(says(pair.second(), "accessor 99: does not exist"));
            pair.damaged()["indices"] = "3";
            CHECK(says(pair.second(), "names no accessor"));
            pair.damaged()["indices"] = 2;
            CHECK(says(pair.second(), "unsigned scalars"));
            pair.damaged()["indices"] = 3;
            pair.damaged()["attributes"]["TEXCOORD_0"] = 3;
            CHECK(says(pair.second(), "TEXCOORD_0: accessor 3: 48 elements for 18 vertices"));
            pair.damaged()["attributes"] = {{"POSITION", 3}};
            CHECK(says(pair.second(), "three components"));
            pair.damaged()["attributes"] = {{"POSITION", 2}};
            // Zeros without end.
            pair.asset.root["accessors"][2].erase("bufferView");
            pair.asset.root["accessors"][2]["count"] = 4'000'000'000u;
            CHECK(says(pair.second(), "without a buffer view"));
        }
        SUBCASE("indices that are no triangles") {
            Pair pair;
            pair.asset.root["accessors"][3]["count"] = 47;
            CHECK(says(pair.second(), "multiple"));
            pair.asset.root["accessors"][3]["count"] = 0;
            CHECK(says(pair.second(), "holds nothing"));
            pair.asset.root["accessors"][3]["count"] = 48;
            pair.damaged()["mode"] = 9;
            CHECK(says(pair.second(), "mode 9"));
        }
        SUBCASE("compressed") {
            Pair pair;
            pair.asset.root["bufferViews"][3]["extensions"]["EXT_meshopt_compression"]["count"] = 48;
            CHECK(says(pair.second(), "EXT_meshopt_compression"));
            pair.damaged()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 0;
            CHECK(says(pair.second(), "KHR_draco_mesh_compression"));
        }
    }

    TEST_CASE("points, lines, no positions, extensions that may count on triangles: left alone, which is no error") {
        Pair pair;
        pair.damaged()["mode"] = 0;
        CHECK(says(pair.second(), "points"));
        pair.damaged()["mode"] = 3;
        CHECK(says(pair.second(), "lines"));
        pair.damaged().erase("mode");
        pair.damaged()["extensions"]["FB_ngon_encoding"] = Json::object();
        CHECK(says(pair.second(), "FB_ngon_encoding"));
        CHECK_FALSE(run(pair.asset).outcomes[1].error.has_value());
        pair.damaged()["attributes"] = Json::object();
        CHECK(says(pair.second(), "no positions"));
    }

    TEST_CASE("everything but the order of indices is kept to the bit") {
        const Asset asset = rich_asset();
        const Done done = run(asset);
        REQUIRE(done.outcomes.size() == 1);
        CHECK(why(done.outcomes[0]) == "");
        CHECK(done.outcomes[0].report.improved == 1);
        CHECK(done.outcomes[0].report.weight_after < 0.5 * done.outcomes[0].report.weight_before);
        CHECK(done.outcomes[0].triangles_before == 16);
        CHECK(done.outcomes[0].triangles_after == 16);
        CHECK(done.after.root.dump() == asset.root.dump());
        const auto &before = done.before.buffers[0], &after = done.after.buffers[0];
        REQUIRE(before.size() == after.size());
        const Json& view = asset.root["bufferViews"][1];
        const std::size_t begin = view["byteOffset"], end = begin + view["byteLength"].get<std::size_t>();
        for (std::size_t i = 0; i < before.size(); ++i)
            if (i < begin || i >= end) CHECK(before[i] == after[i]);
        const auto old_indices = indices_of(done.before, 0), indices = indices_of(done.after, 0);
        CHECK(std::set(old_indices.begin(), old_indices.end()) == std::set(indices.begin(), indices.end()));
        CHECK(area(strip_positions(8), indices) == area(strip_positions(8), old_indices));
    }

    TEST_CASE("a patch ends where an attribute bends: texture, colour, bones, pose") {
        const auto improved = [](auto change, double tolerance = 1e-4) {
            Asset asset = rich_asset();
            change(asset);
            return run(asset, {{}, -1.0, tolerance, {}}).outcomes[0].report.weight_after;
        };
        const auto offset = [](const Asset& asset, const char* attribute) {
            const Json& primitive = asset.root["meshes"][0]["primitives"][0];
            const std::size_t accessor = primitive["attributes"].contains(attribute)
                                             ? primitive["attributes"][attribute].get<std::size_t>()
                                             : primitive["targets"][0]["POSITION"].get<std::size_t>();
            return asset
                .root["bufferViews"][asset.root["accessors"][accessor]["bufferView"].get<std::size_t>()]["byteOffset"]
                .get<std::size_t>();
        };
        const double best = improved([](Asset&) {});
        // Vertex 4, halfway along the lower side.
        for (const auto& [attribute, bytes] :
             {std::pair("TEXCOORD_0", 8), {"_HEAT", 4}, {"WEIGHTS_0", 16}, {"a target", 12}}) {
            const auto bend = [&, name = attribute, stride = bytes](Asset& asset) {
                const float value = 0.5f;
                std::memcpy(asset.binary.data() + offset(asset, name) + 4 * static_cast<std::size_t>(stride), &value,
                            4);
            };
            CHECK(improved(bend) != best);
            CHECK(improved(bend, std::numeric_limits<double>::infinity()) == best);
        }
        CHECK(improved([&](Asset& asset) { asset.binary[offset(asset, "JOINTS_0") + 4 * 8] = 0; }) != best);
        CHECK(improved([&](Asset& asset) { asset.binary[offset(asset, "COLOR_0") + 4 * 4] = 7; }) != best);
    }

    TEST_CASE("indices of 8, 16 and 32 bits, strips and fans, without indices no triangles share vertices") {
        const auto positions = strip_positions(8);
        const auto check = [&](Asset& asset, std::size_t triangles) {
            const Done done = run(asset);
            CHECK(why(done.outcomes[0]) == "");
            CHECK(done.outcomes[0].report.improved == 1);
            const auto indices = indices_of(done.after, 0);
            CHECK(indices.size() == 3 * triangles);
            CHECK(area(positions, indices) == doctest::Approx(16.0));
            CHECK(std::set(indices.begin(), indices.end()).size() == 18);
            return done.after;
        };
        Asset bytes, words, longs, strip, fan, plain;
        bytes.mesh(bytes.accessor(positions, "VEC3"), bytes.accessor(strip_indices<std::uint8_t>(8), "SCALAR"));
        CHECK(check(bytes, 16).root == bytes.root);
        words.mesh(words.accessor(positions, "VEC3"), words.accessor(strip_indices<std::uint16_t>(8), "SCALAR"));
        CHECK(check(words, 16).root == words.root);
        longs.mesh(longs.accessor(positions, "VEC3"), longs.accessor(strip_indices<std::uint32_t>(8), "SCALAR"));
        CHECK(check(longs, 16).root == longs.root);
        // 0, then along the upper side: a fan has no triangles below, so its corners there are in the strip only.
        fan.mesh(fan.accessor(positions, "VEC3"), 0)["mode"] = 6;
        fan.root["meshes"][0]["primitives"][0].erase("indices");
        const auto as_list = check(fan, 16);
        CHECK(as_list.root["meshes"][0]["primitives"][0]["mode"] == 4);
        std::vector<std::uint16_t> zigzag;
        for (int i = 0; i <= 8; ++i)
            zigzag.insert(zigzag.end(),
                          {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(std::max(17 - i - 3, 9))});
        zigzag.push_back(8);
        strip.mesh(strip.accessor(positions, "VEC3"), strip.accessor(zigzag, "SCALAR"))["mode"] = 5;
        const Done stripped = run(strip);
        CHECK(why(stripped.outcomes[0]) == "");
        if (stripped.outcomes[0].report.improved > 0)
            CHECK(indices_of(stripped.after, 0).size() == 3 * stripped.outcomes[0].triangles_after);
        plain.mesh(plain.accessor(positions, "VEC3"), 0).erase("indices");
        const Done alone = run(plain);
        CHECK(why(alone.outcomes[0]) == "");
        CHECK(alone.outcomes[0].report.patches == 0);
        CHECK(alone.after.root == plain.root);
    }

    TEST_CASE("geometry used twice is done once, indices that others read stay, and new ones are made") {
        Asset asset;
        const std::size_t flat = asset.accessor(strip_positions(8), "VEC3");
        auto bent_positions = strip_positions(8);
        for (std::size_t i = 0; i < bent_positions.size(); i += 3)
            bent_positions[i + 2] =
                bent_positions[i] * bent_positions[i] + 3.0f * bent_positions[i + 1] * bent_positions[i];
        const std::size_t bent = asset.accessor(bent_positions, "VEC3");
        const std::size_t indices = asset.accessor(strip_indices<std::uint16_t>(8), "SCALAR");
        asset.mesh(flat, indices)["material"] = 0;
        asset.mesh(flat, indices)["material"] = 1;
        asset.mesh(bent, indices);
        const Done done = run(asset);
        REQUIRE(done.outcomes.size() == 3);
        CHECK(done.outcomes[0].report.improved == 1);
        CHECK(done.outcomes[1].report.improved == 1);
        CHECK(done.outcomes[1].mesh == 1);
        CHECK(done.outcomes[2].report.improved == 0);
        const auto accessor = [&](std::size_t mesh) {
            return done.after.root["meshes"][mesh]["primitives"][0]["indices"];
        };
        CHECK(accessor(0) == 3);
        CHECK(accessor(1) == 3);
        CHECK(accessor(2) == 2);
        CHECK(done.after.root["meshes"][1]["primitives"][0]["material"] == 1);
        CHECK(indices_of(done.after, 2) == indices_of(done.before, 2));
        CHECK(indices_of(done.after, 0) != indices_of(done.before, 0));
        // So too where another accessor or a picture lies over the same bytes.
        for (const bool picture : {false, true}) {
            Asset over;
            const std::size_t positions_of = over.accessor(strip_positions(8), "VEC3");
            over.mesh(positions_of, over.accessor(strip_indices<std::uint16_t>(8), "SCALAR"));
            if (picture) {
                over.root["bufferViews"].push_back(over.root["bufferViews"][1]);
                over.root["images"] = {{{"bufferView", 2}}};
            } else {
                over.root["accessors"].push_back(over.root["accessors"][1]);
            }
            const Done kept = run(over);
            CHECK(kept.outcomes[0].report.improved == 1);
            CHECK(kept.after.buffers[0].substr(0, over.binary.size()) == over.binary);
            CHECK(kept.after.root["meshes"][0]["primitives"][0]["indices"] != 1);
        }
    }

    TEST_CASE("a patch that overlaps itself is kept as it is, with the reason") {
        std::vector<float> xyz(3, 0.0f);
        std::vector<std::uint8_t> indices;
        for (int i = 0; i <= 12; ++i) {
            const float x[8] = {2, 1, 0, -1, -2, -1, 0, 1}, y[8] = {0, 1, 2, 1, 0, -1, -2, -1};
            xyz.insert(xyz.end(), {x[i % 8], y[i % 8], 0.0f});
        }
        for (std::uint8_t i = 1; i <= 12; ++i) indices.insert(indices.end(), {0, i, static_cast<std::uint8_t>(i + 1)});
        Asset asset;
        asset.mesh(asset.accessor(xyz, "VEC3"), asset.accessor(indices, "SCALAR"));
        const Done done = run(asset);
        CHECK(done.outcomes[0].report.refused == 1);
        CHECK_FALSE(done.outcomes[0].report.results[0].refused.empty());
        CHECK(done.after.buffers == done.before.buffers);
        CHECK(done.after.root == done.before.root);
    }

    TEST_CASE("damaged files give errors or whole files, never crashes") {
        const std::string whole = rich_asset().glb();
        std::mt19937 random(4711);
        for (int trial = 0; trial < 4000; ++trial) {
            std::string damaged = whole;
            for (int flips = 1 + trial % 3; flips > 0; --flips) {
                const std::size_t at = random() % (trial % 2 == 0 ? 3500 : damaged.size());
                damaged[at] =
                    trial % 4 < 2 ? static_cast<char>('0' + random() % 10) : static_cast<char>(random() & 255u);
            }
            const TemporaryFile file("fuzz.glb", damaged);
            auto document = assets::read_gltf_document(file.path());
            if (!document) continue;
            const auto outcomes = assets::retriangulate_patches(*document, {});
            if (!outcomes) continue;
            const auto written = assets::write_glb(*document).value();
            const TemporaryFile out("out.glb", written);
            CHECK(assets::read_gltf_document(out.path()).has_value());
        }
    }
}
