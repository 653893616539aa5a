// SPDX-License-Identifier: MIT
#include "assets/gltf_patches.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "assets/gltf_primitive.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// Primitives of one geometry: what is found in one holds for all.
struct Group {
    struct Member {
        std::size_t mesh, primitive;
    };
    std::vector<Member> members;
    PrimitivePatches outcome;
    int mode = kGltfTriangles;
    std::size_t index_accessor = kNoNumber;
    bool index_accessor_shared = false;  // with another group
};

std::string geometry_of(const Json& primitive) {
    std::string key;
    for (const char* part : {"mode", "indices", "attributes", "targets", "extensions"}) {
        const Json* value = member(primitive, part);
        key += value ? value->dump() : "-";
        key += '\n';
    }
    return key;
}

void append_index(std::string& bytes, std::uint32_t index, std::size_t size) {
    for (std::size_t b = 0; b < size; ++b) bytes.push_back(static_cast<char>(index >> (8 * b) & 0xFFu));
}

// Finds the accessors whose bytes no other accessor and no view uses.
class OwnBytes {
  public:
    explicit OwnBytes(const GltfDocument& document) : document_(document) {
        const Json *accessors = member(document.root, "accessors"), *views = member(document.root, "bufferViews");
        own_.assign(accessors && accessors->is_array() ? accessors->size() : 0, true);
        std::vector<bool> seen(views && views->is_array() ? views->size() : 0, false);
        for (std::size_t a = 0; a < own_.size(); ++a) add_accessor(a, accessors->at(a), seen);
        for (std::size_t v = 0; v < seen.size(); ++v)
            if (!seen[v]) add_view(views->at(v));
        mark();
    }

    [[nodiscard]] bool operator()(std::size_t accessor) const { return accessor < own_.size() && own_[accessor]; }

  private:
    struct Extent {
        const unsigned char *begin, *end;
        std::size_t accessor;
    };

    void add_accessor(std::size_t number, const Json& accessor, std::vector<bool>& seen) {
        own_[number] = false;
        if (member(accessor, "sparse") || !member(accessor, "bufferView")) return;
        std::string unused;
        const auto elements = accessor_elements(document_, number, std::nullopt, unused);
        if (!elements) return;
        own_[number] = true;
        const std::size_t element =
            component_size(elements->component_type) * static_cast<std::size_t>(elements->components);
        extents_.push_back(
            {elements->data, elements->data + (elements->count - 1) * elements->stride + element, number});
        seen[accessor.at("bufferView").get<std::size_t>()] = true;
    }

    void add_view(const Json& view) {
        const auto buffer = whole_number(view, "buffer", kNoNumber), offset = whole_number(view, "byteOffset", 0),
                   length = whole_number(view, "byteLength", 0);
        if (!buffer || !offset || !length || *buffer >= document_.buffers.size()) return;
        const std::string& bytes = document_.buffers[*buffer];
        const std::size_t begin = std::min(*offset, bytes.size());
        const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
        extents_.push_back({data + begin, data + begin + std::min(*length, bytes.size() - begin), kNoNumber});
    }

    void mark() {
        const std::less<const unsigned char*> before;
        std::sort(extents_.begin(), extents_.end(),
                  [&](const Extent& a, const Extent& b) { return before(a.begin, b.begin); });
        const Extent* furthest = nullptr;
        for (const Extent& e : extents_) {
            if (furthest && before(e.begin, furthest->end)) {
                take(e.accessor);
                take(furthest->accessor);
            }
            if (!furthest || before(furthest->end, e.end)) furthest = &e;
        }
    }

    void take(std::size_t accessor) {
        if (accessor != kNoNumber) own_[accessor] = false;
    }

    const GltfDocument& document_;
    std::vector<bool> own_;
    std::vector<Extent> extents_;
};

constexpr const char* kNotReached = "was not done before the interruption";

class PatchRun {
  public:
    PatchRun(GltfDocument& document, const PatchSettings& settings) : document_(document), settings_(settings) {}

    Result<std::vector<PrimitivePatches>> run() {
        if (auto done = gather(); !done) return done.error();
        const OwnBytes own(document_);
        bool go_on = true;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            if (!go_on) {
                groups_[g].outcome.left_alone = kNotReached;
                continue;
            }
            if (auto done = solve(groups_[g]); !done) return done.error();
            if (settings_.progress) go_on = settings_.progress(g + 1, groups_.size());
        }
        std::vector<PrimitivePatches> result(count_);
        for (Group& group : groups_) {
            if (group.outcome.report.improved > 0) write(group, own(group.index_accessor));
            for (const Group::Member& m : group.members) {
                PrimitivePatches& outcome = result[first_[m.mesh] + m.primitive];
                outcome = group.outcome;
                outcome.mesh = m.mesh;
                outcome.primitive = m.primitive;
                if (const Json* name = member(mesh(m.mesh), "name"); name && name->is_string())
                    outcome.name = name->get<std::string>();
            }
        }
        return result;
    }

  private:
    [[nodiscard]] Json& mesh(std::size_t number) { return document_.root["meshes"][number]; }
    [[nodiscard]] Json& primitive(const Group::Member& m) { return mesh(m.mesh)["primitives"][m.primitive]; }

    Result<void> gather() {
        const auto bad = [](std::size_t m, const std::string& why) {
            return fail(ErrorCode::parse, m, "mesh " + std::to_string(m) + ": " + why);
        };
        std::map<std::string, std::size_t> known;
        const Json* meshes = member(document_.root, "meshes");
        if (!meshes) return {};
        if (!meshes->is_array()) return fail(ErrorCode::parse, kNoItem, "its meshes are no list");
        for (std::size_t m = 0; m < meshes->size(); ++m) {
            first_.push_back(count_);
            const Json* primitives = member(meshes->at(m), "primitives");
            if (!primitives || !primitives->is_array()) return bad(m, "its primitives are no list");
            for (std::size_t p = 0; p < primitives->size(); ++p, ++count_) {
                const Json& json = primitives->at(p);
                if (!json.is_object()) return bad(m, "primitive " + std::to_string(p) + " is no object");
                const auto [entry, added] = known.try_emplace(geometry_of(json), groups_.size());
                if (added) groups_.emplace_back();
                groups_[entry->second].members.push_back({m, p});
                if (added) note_accessors(json, entry->second);
            }
        }
        return {};
    }

    void note_accessors(const Json& primitive, std::size_t group) {
        const auto number = [](const Json& json) { return as_whole_number(json).value_or(kNoNumber); };
        if (const Json* indices = member(primitive, "indices")) {
            const auto [user, first] = users_.try_emplace(number(*indices), group);
            if (!first) groups_[user->second].index_accessor_shared = groups_[group].index_accessor_shared = true;
        }
        const Json *attributes = member(primitive, "attributes"), *targets = member(primitive, "targets");
        if (attributes && attributes->is_object())
            for (const Json& accessor : *attributes) vertex_accessors_.insert(number(accessor));
        for (std::size_t i = 0; targets && targets->is_array() && i < targets->size(); ++i)
            for (const Json& accessor : targets->at(i)) vertex_accessors_.insert(number(accessor));
    }

    // Only `cancelled` ends the whole; other errors are the group's own.
    Result<void> solve(Group& group) {
        PrimitivePatches& outcome = group.outcome;
        const Json& json = primitive(group.members[0]);
        outcome.left_alone = reason_to_leave(json);
        if (!outcome.left_alone.empty()) return {};
        auto geometry = read_primitive(document_, json, {settings_.tolerance, settings_.attribute_tolerance});
        if (!geometry) {
            outcome.error = geometry.error();
            return {};
        }
        group.mode = geometry->mode;
        group.index_accessor = geometry->index_accessor;
        outcome.vertices = geometry->mesh.positions.size();
        outcome.triangles_before = outcome.triangles_after = geometry->triangles_in_file;
        triangulate::PatchOptions options;
        options.tolerance = geometry->position_tolerance;
        options.values = geometry->values;
        options.triangulation = settings_.triangulation;
        const auto start = Clock::now();
        auto report = triangulate::retriangulate_planar_patches(geometry->mesh, options);
        outcome.microseconds = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
        if (!report && report.error().code == ErrorCode::cancelled) {
            outcome.left_alone = kNotReached;
            return {};
        }
        if (!report) {
            outcome.error = report.error();
            return {};
        }
        outcome.report = std::move(*report);
        if (outcome.report.improved > 0) outcome.triangles_after = geometry->mesh.triangle_count();
        outcome.indices = std::move(geometry->mesh.indices);
        return {};
    }

    void write(const Group& group, bool own_bytes) {
        const auto& indices = group.outcome.indices;
        int type = *std::max_element(indices.begin(), indices.end()) < 0xFFFFu ? kGltfUnsignedShort : kGltfUnsignedInt;
        std::string unused;
        if (group.index_accessor != kNoNumber) {
            // It was read before, so it is there.
            const auto old = accessor_elements(document_, group.index_accessor, std::nullopt, unused);
            type = old->component_type;
            if (own_bytes && !group.index_accessor_shared && !vertex_accessors_.contains(group.index_accessor) &&
                group.mode == kGltfTriangles)
                return overwrite(*old, indices);
        }
        std::string bytes;
        for (const std::uint32_t index : indices) append_index(bytes, index, component_size(type));
        const std::size_t accessor =
            append_accessor(document_, bytes, indices.size(), type, "SCALAR", kGltfIndexTarget);
        for (const Group::Member& m : group.members) {
            Json& json = primitive(m);
            json["indices"] = accessor;
            if (json.contains("mode")) json["mode"] = static_cast<int>(kGltfTriangles);
        }
    }

    void overwrite(const Elements& old, const Vector<std::uint32_t>& indices) {
        std::string bytes;
        for (std::string& buffer : document_.buffers) {
            const auto* begin = reinterpret_cast<const unsigned char*>(buffer.data());
            const std::less<const unsigned char*> before;
            if (before(old.data, begin) || !before(old.data, begin + buffer.size())) continue;
            const auto offset = static_cast<std::size_t>(old.data - begin);
            for (std::size_t i = 0; i < indices.size(); ++i) {
                bytes.clear();
                append_index(bytes, indices[i], component_size(old.component_type));
                buffer.replace(offset + i * old.stride, bytes.size(), bytes);
            }
            return;
        }
    }

    GltfDocument& document_;
    const PatchSettings& settings_;
    std::vector<Group> groups_;
    std::vector<std::size_t> first_;            // primitive of each mesh
    std::map<std::size_t, std::size_t> users_;  // index accessor → its first group
    std::set<std::size_t> vertex_accessors_;
    std::size_t count_ = 0;
};

}  // namespace

Result<std::vector<PrimitivePatches>> retriangulate_patches(GltfDocument& document, const PatchSettings& settings) {
    return PatchRun(document, settings).run();
}

}  // namespace crofton::assets
