// SPDX-License-Identifier: MIT
// Files whose checksums are right and whose contents are not: one fault each, refused for that fault.
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <error_of.hpp>
#include <limits>

#include <crofton/bake/occluder_sections.hpp>
#include "forge.hpp"

using namespace crofton;
using namespace crofton::bake;
using bake_test::with_element;
using bake_test::with_table;

namespace {

// Section 0 ends within its last 64 bytes, so that padding follows.
Vector<std::byte> two_sections() {
    Writer writer;
    const std::array<std::uint32_t, 5> numbers{1, 2, 3, 4, 5};
    const std::array<char, 3> letters{'a', 'b', 'c'};
    writer.add("numbers", std::span<const std::uint32_t>(numbers));
    writer.add("letters", std::span<const char>(letters));
    return writer.finish();
}

void check_refused(const Vector<std::byte>& file, std::string_view why) {
    const auto reader = Reader::open(file);
    REQUIRE_FALSE(reader);
    INFO(reader.error().message);
    CHECK(error_of(reader).message.find(why) != std::string::npos);
}

// Two meshes on two nodes: a triangle with colours, and a rectangle with a hole.
Vector<std::byte> small_scene() {
    scene::Scene scene;
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    mesh.colors.assign(3, glm::vec3(0.5f));
    REQUIRE(scene.add_mesh(mesh, "triangle"));
    scene::PlanarPolygon polygon;
    polygon.polygon = {{{0, 0}, {6, 0}, {6, 6}, {0, 6}, {1, 1}, {1, 2}, {2, 1}}, {4, 7}};
    const std::array<std::array<std::uint32_t, 3>, 1> triangles{{{0, 1, 2}}};
    REQUIRE(scene.add_polygon(polygon, triangles, "holed"));
    const auto root = scene.add_node(scene::kNone, {}, ~0u);
    const auto child = scene.add_node(*root, {}, ~0u);
    REQUIRE(scene.add_instance(*root, 0));
    REQUIRE(scene.add_instance(*child, 1));
    scene.update();
    auto file = bake::bake(scene).value();
    REQUIRE(BakedScene::from_memory(file));
    return file;
}

// Two nodes; of three kinds one is empty.
BakedOccluders three_kinds() {
    BakedOccluders result;
    occlude::FoundOccluder box, body, patch;
    box.kind = occlude::OccluderKind::walled;
    box.box.half_extents = {1, 2, 3};
    box.eyes_within.max.y = 5.0;
    body.box.half_extents = {1, 1, 1};
    body.piece_bounds = {glm::dvec3(-2.0), glm::dvec3(2.0)};
    body.mean_shadow = 1.5;
    body.gain = 2.5;
    body.edges = 30;
    patch.kind = occlude::OccluderKind::patch;
    patch.sides = occlude::Sides::front;
    patch.surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    patch.surface.indices = {2, 1, 0};
    result.kinds = {{box, body}, {}, {patch}};
    result.nodes = {{1, 2}};
    return result;
}

Vector<std::byte> with_occluders(const BakedOccluders& occluders) {
    scene::Scene scene;
    REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
    REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
    scene.update();
    return bake::bake(scene, serial_executor(), {.occluders = &occluders}).value();
}

void check_scene_refused(const Vector<std::byte>& file, std::string_view why) {
    const auto baked = BakedScene::from_memory(file);
    REQUIRE_FALSE(baked);
    INFO(baked.error().message);
    CHECK(error_of(baked).message.find(why) != std::string::npos);
}

}  // namespace

TEST_SUITE("bake/forged") {
    TEST_CASE("more sections than the limit are refused, as many as it allows are read") {
        const auto with_sections = [](std::uint32_t count) {
            const std::size_t table = sizeof(Header) + count * sizeof(Section);
            Vector<std::byte> file((table + kAlignment - 1) / kAlignment * kAlignment);
            Header header;
            header.file_size = file.size();
            header.section_count = count;
            std::memcpy(file.data(), &header, sizeof header);
            for (std::uint32_t i = 0; i < count; ++i) {
                Section section;
                section.name[0] = static_cast<char>('0' + i);
                section.offset = file.size();
                std::memcpy(file.data() + sizeof header + i * sizeof section, &section, sizeof section);
            }
            bake_test::make_sums_right(file);
            return file;
        };
        CHECK(Reader::open(with_sections(kMaxSections)));
        check_refused(with_sections(kMaxSections + 1), "section count");
    }

    TEST_CASE("partial elements and elements of no size are refused") {
        const Vector<std::byte> file = two_sections();
        REQUIRE(Reader::open(with_table(file, [](Header&, Section*) {})));
        check_refused(with_table(file, [](Header&, Section* s) { s[1].element_size = 2; }), "whole elements");
        check_refused(with_table(file, [](Header&, Section* s) { s[1].element_size = 0; }), "whole elements");
    }

    TEST_CASE("sections elsewhere than where they belong, and bytes hidden between or after them, are refused") {
        const Vector<std::byte> file = two_sections();
        check_refused(with_table(file, [](Header&, Section* s) { s[1].offset = s[0].offset; }), "outside its place");
        check_refused(with_table(file, [](Header&, Section* s) { s[1].size = 65; }), "outside its place");
        Section first, last;
        std::memcpy(&first, file.data() + sizeof(Header), sizeof first);
        std::memcpy(&last, file.data() + sizeof(Header) + sizeof first, sizeof last);
        Vector<std::byte> hidden = file;
        hidden[first.offset + first.size] = std::byte{1};
        check_refused(hidden, "padding");
        hidden = file;
        hidden[last.offset + last.size] = std::byte{1};
        check_refused(hidden, "after the last section");
        hidden = file;
        hidden.resize(file.size() + kAlignment);
        check_refused(with_table(hidden, [&](Header& header, Section*) { header.file_size = hidden.size(); }),
                      "after the last section");
    }

    TEST_CASE("every section's contents are compared with its checksum") {
        for (const std::size_t section : {0u, 1u}) {
            Vector<std::byte> file = two_sections();
            Section where;
            std::memcpy(&where, file.data() + sizeof(Header) + section * sizeof where, sizeof where);
            file[where.offset] ^= std::byte{1};
            check_refused(file, "checksum");
        }
    }

    TEST_CASE("meshes whose arrays, colours, triangles, polygons or boxes are none are refused") {
        const Vector<std::byte> file = small_scene();
        const auto mesh = [&](auto change) { return with_element<MeshRecord>(file, "meshes", 0, change); };
        check_scene_refused(mesh([](MeshRecord& m) { m.first_position = ~std::uint64_t{0}; }), "outside");
        check_scene_refused(mesh([](MeshRecord& m) { m.position_count = 1000; }), "outside");
        check_scene_refused(mesh([](MeshRecord& m) { m.color_count = 2; }), "colours");
        check_scene_refused(mesh([](MeshRecord& m) { m.index_count = 2; }), "triangle");
        check_scene_refused(mesh([](MeshRecord& m) { m.position_count = m.color_count = 2; }), "triangle");
        check_scene_refused(mesh([](MeshRecord& m) { m.polygon = 1; }), "polygon that is not there");
        check_scene_refused(mesh([](MeshRecord& m) { m.box.half_extents.x = -1.0f; }), "no box");
        CHECK(BakedScene::from_memory(mesh([](MeshRecord& m) { m.color_count = 0; })));
    }

    TEST_CASE("rings that descend or end beyond the points are refused") {
        const Vector<std::byte> file = small_scene();
        const auto ring = [&](std::size_t at, std::uint32_t end) {
            return with_element<std::uint32_t>(file, "rings", at, [&](std::uint32_t& e) { e = end; });
        };
        CHECK(BakedScene::from_memory(ring(0, 4)));
        check_scene_refused(ring(1, 3), "ascend");
        check_scene_refused(ring(1, 8), "ascend");
        check_scene_refused(with_element<PolygonRecord>(file, "polygons", 0, [](PolygonRecord& p) { ++p.ring_count; }),
                            "outside");
    }

    TEST_CASE("instances and nodes that name what is not there, half of it, or themselves are refused") {
        const Vector<std::byte> file = small_scene();
        for (const std::size_t at : {0u, 1u}) {
            const auto instance = [&](auto change) {
                return with_element<InstanceRecord>(file, "instance", at, change);
            };
            check_scene_refused(instance([](InstanceRecord& i) { i.mesh = 2; }), "not there");
            check_scene_refused(instance([](InstanceRecord& i) { i.node = 2; }), "not there");
            check_scene_refused(instance([](InstanceRecord& i) { i.mesh = scene::kNone; }), "not there");
            check_scene_refused(instance([](InstanceRecord& i) { i.node = scene::kNone; }), "not there");
        }
        const auto node = [&](std::size_t at, std::uint32_t parent) {
            return with_element<NodeRecord>(file, "nodes", at, [&](NodeRecord& n) { n.parent = parent; });
        };
        check_scene_refused(node(1, 1), "own ancestor");
        check_scene_refused(node(0, 0), "own ancestor");
        check_scene_refused(node(0, 1), "own ancestor");
        check_scene_refused(node(0, 2), "parent that is not there");
        // One instance fewer than the tree has, and one more.
        const auto resized = [&](std::uint64_t by) {
            return with_table(file, [&](const Header& header, Section* sections) {
                for (std::uint32_t i = 0; i < header.section_count; ++i)
                    if (std::string_view(sections[i].name, 8) == "instance") sections[i].size += by;
            });
        };
        check_scene_refused(resized(sizeof(InstanceRecord)), "not over the instances");
    }

    TEST_CASE("occluders come back as they were, also those of an engine's own, and old files have none") {
        const Vector<std::byte> file = with_occluders(three_kinds());
        const auto baked = BakedScene::from_memory(file).value();
        REQUIRE(baked.occluders());
        REQUIRE(baked.occluders()->kinds.size() == 3);
        CHECK(baked.occluders()->kinds[0].size() == 2);
        CHECK(baked.occluders()->kinds[1].empty());
        const occlude::FoundOccluder& box = baked.occluders()->kinds[0][0];
        CHECK(box.kind == occlude::OccluderKind::walled);
        CHECK(box.box.half_extents == glm::vec3(1, 2, 3));
        CHECK(box.eyes_within.max.y == 5.0);
        CHECK(box.eyes_within.min.y == -std::numeric_limits<double>::infinity());
        CHECK(box.piece_bounds.is_empty());
        const occlude::FoundOccluder& body = baked.occluders()->kinds[0][1];
        CHECK(body.mean_shadow == 1.5);
        CHECK(body.gain == 2.5);
        CHECK(body.edges == 30);
        CHECK(body.piece_bounds.min == glm::dvec3(-2.0));
        const occlude::FoundOccluder& patch = baked.occluders()->kinds[2][0];
        CHECK(patch.surface.positions.size() == 3);
        CHECK(patch.surface.indices == Vector<std::uint32_t>{2, 1, 0});
        CHECK(patch.sides == occlude::Sides::front);
        REQUIRE(baked.occluders()->nodes.size() == 1);
        CHECK(baked.occluders()->nodes[0].node == 1);
        CHECK(baked.occluders()->nodes[0].kind == 2);
        CHECK_FALSE(BakedScene::from_memory(small_scene())->occluders());
    }

    TEST_CASE(
        "occluders with numbers that are none, kinds that are not known, or a place that is not theirs are refused") {
        const Vector<std::byte> file = with_occluders(three_kinds());
        const auto record = [&](std::size_t at, auto change) {
            return with_element<OccluderRecord>(file, "occluder", at, change);
        };
        const double nan = std::numeric_limits<double>::quiet_NaN();
        using R = OccluderRecord;
        check_scene_refused(record(0, [](R& r) { r.kind = 4; }), "kind that is not known");
        check_scene_refused(record(0, [](R& r) { r.sides = 2; }), "kind that is not known");
        check_scene_refused(record(0, [](R& r) { r.box.half_extents.x = -1.0f; }), "no box");
        check_scene_refused(record(0, [&](R& r) { r.box.center.x = nan; }), "no box");
        check_scene_refused(record(0, [&](R& r) { r.eyes_within.min.z = nan; }), "bounds are none");
        check_scene_refused(record(0, [](R& r) { std::swap(r.eyes_within.min, r.eyes_within.max); }),
                            "bounds are none");
        check_scene_refused(record(1, [&](R& r) { r.piece_bounds.max.y = nan; }), "bounds are none");
        check_scene_refused(record(1, [](R& r) { r.piece_bounds.min.y = -HUGE_VAL; }), "bounds are none");
        check_scene_refused(record(1, [&](R& r) { r.gain = nan; }), "no measure");
        check_scene_refused(record(1, [](R& r) { r.mean_shadow = -1.0; }), "no measure");
        check_scene_refused(record(1, [](R& r) { r.gain = HUGE_VAL; }), "no measure");
        check_scene_refused(record(1, [](R& r) { r.piece_bounds.min = Aabb().min; }), "bounds are none");
        check_scene_refused(record(2, [](R& r) { r.index_count = 0; }), "no triangles");
        check_scene_refused(record(2, [](R& r) { r.index_count = 2; }), "no mesh");
        check_scene_refused(record(2, [](R& r) { r.index_count = 6; }), "not in their place");
        check_scene_refused(record(2, [](R& r) { r.point_count = 4; }), "not in their place");
        check_scene_refused(record(2, [](R& r) { r.first_point = 1; }), "not in their place");
        check_scene_refused(record(2, [](R& r) { r.first_index = ~0ull; }), "not in their place");
        check_scene_refused(with_element<std::uint32_t>(file, "occindex", 0, [](std::uint32_t& i) { i = 3; }),
                            "no mesh");
        check_scene_refused(
            with_element<glm::vec3>(file, "occpoint", 1, [&](glm::vec3& p) { p.y = static_cast<float>(nan); }),
            "no mesh");
        const auto kind = [&](std::size_t at, auto change) {
            return with_element<OccluderKindRecord>(file, "occkinds", at, change);
        };
        check_scene_refused(kind(2, [](OccluderKindRecord& k) { k.first = 0; }), "follow");
        check_scene_refused(kind(2, [](OccluderKindRecord& k) { k.count = 2; }), "follow");
        const auto node = [&](auto change) { return with_element<OccludingNode>(file, "occnodes", 0, change); };
        check_scene_refused(node([](OccludingNode& n) { n.node = 2; }), "not there");
        check_scene_refused(node([](OccludingNode& n) { n.kind = 3; }), "not there");
        BakedOccluders twice = three_kinds();
        twice.nodes.push_back(twice.nodes[0]);
        scene::Scene scene;
        REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
        REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
        scene.update();
        const auto refused = bake::bake(scene, serial_executor(), {.occluders = &twice});
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).message.find("ascend") != std::string::npos);
        CHECK(error_of(refused).item == 1);
    }

    TEST_CASE("clusters of another mesh or out of their place, and looks that are not known, are refused by mesh") {
        scene::Scene scene;
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
        mesh.indices = {0, 1, 2};
        REQUIRE(scene.add_mesh(mesh, "one triangle"));
        mesh.indices = {0, 1, 2, 2, 1, 3};
        REQUIRE(scene.add_mesh(mesh, "two triangles"));
        scene.update();
        const MeshLook looks[] = {{.one_sided = true}, {}};
        const Vector<std::byte> file = *bake::bake(scene, serial_executor(), {.looks = looks});
        const std::size_t first = BakedScene::from_memory(file)->clusters(0)->serialise().size() / 4;
        const auto end = [&](std::size_t at, std::uint64_t value) {
            return with_element<std::uint64_t>(file, "cluends", at, [&](std::uint64_t& e) { e = value; });
        };
        check_scene_refused(end(0, ~std::uint64_t{0}), "'cluends' does not ascend");
        check_scene_refused(end(0, first - 1), "mesh 0");
        check_scene_refused(end(0, 0), "mesh 1");
        check_scene_refused(end(1, first), "does not end where");
        const auto word = [&](std::size_t at, std::uint32_t value) {
            return with_element<std::uint32_t>(file, "clusters", at, [&](std::uint32_t& w) { w = value; });
        };
        check_scene_refused(word(0, 2), "mesh 0: clusters: the bytes are not as many");
        check_scene_refused(word(first + 1, 1), "mesh 1: clusters");
        check_scene_refused(with_element<MeshRecord>(file, "meshes", 1, [](MeshRecord& m) { m.index_count = 3; }),
                            "mesh 1 has another number of triangles");
        check_scene_refused(with_element<std::uint8_t>(file, "looks", 1, [](std::uint8_t& bits) { bits = 8; }),
                            "look that is not known");
        const auto fewer = with_table(file, [&](const Header& header, Section* sections) {
            for (Section& section : std::span(sections, header.section_count))
                if (std::string_view(section.name, 5) == "looks") section.size = 1;
        });
        check_scene_refused(fewer, "not one for each mesh");
    }

    TEST_CASE("a section that is missing or of other elements is refused by its name, occluders' too") {
        const Vector<std::byte> file = with_occluders(three_kinds());
        const std::array<std::string, 18> names{"meshes",   "position", "colors",   "indices",  "names",    "polygons",
                                                "points",   "rings",    "instance", "nodes",    "tree",     "occluder",
                                                "occkinds", "occnodes", "occpoint", "occindex", "clusters", "cluends"};
        const auto with_section = [&](const std::string& name, auto change) {
            bool found = false;
            auto changed = with_table(file, [&](const Header& header, Section* sections) {
                for (Section& section : std::span(sections, header.section_count)) {
                    char known[9] = {};
                    std::memcpy(known, section.name, 8);
                    if (name != known) continue;
                    found = true;
                    change(section);
                }
            });
            REQUIRE(found);
            return changed;
        };
        for (const std::string& name : names) {
            CAPTURE(name);
            const auto other_elements = with_section(name, [](Section& s) {
                s.element_size = s.element_size > 1 ? 1 : s.size > 1 ? static_cast<std::uint32_t>(s.size) : 3;
            });
            check_scene_refused(other_elements, name);
            const auto missing = with_section(name, [](Section& s) { s.name[0] = 'X'; });
            const auto newer = BakedScene::from_memory(with_section(name, [](Section& s) { ++s.version; }));
            REQUIRE_FALSE(newer);
            CHECK(newer.error().code == ErrorCode::unsupported);
            CHECK(newer.error().message.find("section '" + name + "' is of version ") != std::string::npos);
            if (name == "occluder" || name == "clusters")  // none at all
                CHECK(BakedScene::from_memory(missing).has_value());
            else
                check_scene_refused(missing, name);
        }
    }

    TEST_CASE("a file whose clusters are of the layout before is said to be of another version, not damaged") {
        scene::Scene scene;
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.indices = {0, 1, 2};
        REQUIRE(scene.add_mesh(mesh, "triangle"));
        scene.update();
        const auto old = with_table(*bake::bake(scene), [](const Header& header, Section* sections) {
            for (Section& section : std::span(sections, header.section_count))
                if (std::string_view(section.name, 8) == "clusters") section.version = 0;
        });
        const auto read = BakedScene::from_memory(old);
        REQUIRE_FALSE(read);
        CHECK(read.error().code == ErrorCode::unsupported);
        CHECK(read.error().message.find(
                  "section 'clusters' is of version 0, this library reads version 2: bake it again") !=
              std::string::npos);
    }

    TEST_CASE("a file that is cut before a section begins is refused, though its header says so itself") {
        Vector<std::byte> file = two_sections();
        Section first;
        std::memcpy(&first, file.data() + sizeof(Header), sizeof first);
        file.resize(first.offset + first.size);
        check_refused(with_table(file, [&](Header& header, Section*) { header.file_size = file.size(); }),
                      "section 'letters' lies outside its place");
    }

    TEST_CASE("occluders of several nodes are baked, one with points and no triangles is refused before") {
        BakedOccluders occluders = three_kinds();
        occluders.nodes = {{0, 0}, {1, 2}};
        const auto baked = BakedScene::from_memory(with_occluders(occluders)).value();
        REQUIRE(baked.occluders()->nodes.size() == 2);
        CHECK(baked.occluders()->nodes[0].node == 0);
        CHECK(baked.occluders()->nodes[1].kind == 2);
        occluders.kinds[0][1].surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        scene::Scene scene;
        REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
        REQUIRE(scene.add_node(scene::kNone, {}, ~0u));
        scene.update();
        const auto refused = bake::bake(scene, serial_executor(), {.occluders = &occluders});
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).message.find("no mesh") != std::string::npos);
        CHECK(error_of(refused).item == 1);
    }
}
