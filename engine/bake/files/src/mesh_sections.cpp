// SPDX-License-Identifier: MIT
#include "mesh_sections.hpp"

#include <crofton/core/recovery.hpp>

namespace crofton::bake {
namespace {

constexpr std::uint8_t kOneSided = 1, kFlat = 2, kUnlit = 4;

Error bad_section(std::initializer_list<MessagePart> what, std::uint64_t mesh) {
    return fail(ErrorCode::parse, mesh, what);
}

Vector<std::byte> serialised_clusters(const TriangleMesh& mesh) {
    const auto cut = depth::ClusteredMesh::cut(mesh.positions, mesh.indices);
    return cut ? cut->serialise() : Vector<std::byte>();
}

}  // namespace

MeshLook look_of(std::uint8_t bits) {
    return {.one_sided = (bits & kOneSided) != 0, .flat = (bits & kFlat) != 0, .unlit = (bits & kUnlit) != 0};
}

void add_looks(std::span<const MeshLook> looks, std::size_t mesh_count, Writer& writer) {
    Vector<std::uint8_t> bits(mesh_count, std::uint8_t{0});
    for (std::size_t m = 0; m < looks.size(); ++m)
        bits[m] = static_cast<std::uint8_t>((looks[m].one_sided ? kOneSided : 0) | (looks[m].flat ? kFlat : 0) |
                                            (looks[m].unlit ? kUnlit : 0));
    writer.add("looks", std::span<const std::uint8_t>(bits));
}

Result<std::span<const std::uint8_t>> read_looks(const Reader& reader, std::size_t mesh_count) {
    if (!reader.has("looks")) return std::span<const std::uint8_t>();
    const auto looks = reader.section<std::uint8_t>("looks");
    if (!looks) return looks;
    if (looks->size() != mesh_count) return bad_section({"section 'looks' has not one for each mesh"}, kNoItem);
    for (std::size_t m = 0; m < mesh_count; ++m)
        if (((*looks)[m] & ~(kOneSided | kFlat | kUnlit)) != 0)
            return bad_section({"section 'looks': a mesh has a look that is not known"}, m);
    return looks;
}

const Vector<std::byte>& SharedClusters::of(scene::MeshId mesh, const TriangleMesh& triangles) {
    std::call_once(once_[mesh], [&] { serialised_[mesh] = serialised_clusters(triangles); });
    return serialised_[mesh];
}

void add_clusters(const scene::Scene& scene, const KnownClusters& known, Writer& writer, Executor& executor) {
    Vector<Vector<std::byte>> parts(scene.mesh_count());
    detail::recoverable_for(executor, parts.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t m = begin; m < end; ++m) {
            const TriangleMesh& mesh = scene.mesh(static_cast<scene::MeshId>(m));
            parts[m] = known.shared != nullptr ? known.shared->of(known.mesh_of[m], mesh) : serialised_clusters(mesh);
        }
    });
    Vector<std::byte> all;
    Vector<std::uint64_t> ends;
    for (const Vector<std::byte>& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
        ends.push_back(all.size() / 4);
    }
    writer.add_bytes("clusters", all, 4, kClustersVersion);
    writer.add("cluends", std::span<const std::uint64_t>(ends));
}

Result<Vector<std::optional<depth::ClusteredMesh>>> read_clusters(const Reader& reader,
                                                                  std::span<const MeshRecord> meshes) {
    Vector<std::optional<depth::ClusteredMesh>> result;
    if (!reader.has("clusters")) return result;
    const auto words = reader.section<std::uint32_t>("clusters", kClustersVersion);
    if (!words) return words.error();
    const auto ends = reader.section<std::uint64_t>("cluends");
    if (!ends) return ends.error();
    if (ends->size() != meshes.size() || (ends->empty() ? 0 : ends->back()) != words->size())
        return bad_section({"section 'cluends' does not end where 'clusters' does"}, kNoItem);
    result.resize(meshes.size());
    std::uint64_t begin = 0;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        const std::uint64_t end = (*ends)[m];
        if (end < begin || end > words->size()) return bad_section({"section 'cluends' does not ascend"}, m);
        if (end == begin) continue;
        auto cut = depth::ClusteredMesh::deserialise(std::as_bytes(words->subspan(begin, end - begin)));
        if (!cut) return bad_section({"section 'clusters': mesh ", m, ": ", cut.error().message}, m);
        if (cut->triangle_count() * 3 != meshes[m].index_count)
            return bad_section({"section 'clusters': mesh ", m, " has another number of triangles"}, m);
        result[m].emplace(std::move(*cut));
        begin = end;
    }
    return result;
}

}  // namespace crofton::bake
