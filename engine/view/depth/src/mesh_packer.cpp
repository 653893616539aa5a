// SPDX-License-Identifier: MIT
#include "mesh_packer.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "adjacency.hpp"
#include "patch.hpp"

namespace crofton::depth {

void MeshPacker::add(const ClusteredMesh::PackedBox& box, std::span<const std::uint8_t> corners,
                     std::uint32_t vertices) {
    boxes_.push_back(box);
    set_twins(boxes_.back(), has_twins(corners));
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    triangles_.push_back(static_cast<std::uint8_t>(corners.size() / 3));
    bits_.push_back(static_cast<std::uint8_t>(bits_for(vertices)));
}

void MeshPacker::pack(ClusteredMesh& mesh) const {
    mesh.corner_bits_ = *std::max_element(bits_.begin(), bits_.end());
    Vector<std::uint8_t> counts;
    Vector<std::uint32_t> words;
    std::uint64_t word = 0;
    std::uint32_t filled = 0;
    const std::uint8_t* corner = corners_.data();
    for (std::size_t c = 0; c < boxes_.size(); ++c) {
        if (c % ClusteredMesh::kGroup == 0 && filled != 0)
            words.push_back(static_cast<std::uint32_t>(word)), word = filled = 0;
        const std::uint32_t less = std::min(mesh.corner_bits_ - bits_[c], 3u), bits = mesh.corner_bits_ - less;
        counts.push_back(static_cast<std::uint8_t>((triangles_[c] - 1u) | less << 6));
        for (const std::uint8_t* const end = corner + std::size_t{3} * triangles_[c]; corner != end; ++corner) {
            word |= std::uint64_t{*corner} << filled;
            filled += bits;
            if (filled < 32) continue;
            words.push_back(static_cast<std::uint32_t>(word));
            word >>= 32;
            filled -= 32;
        }
    }
    if (filled != 0) words.push_back(static_cast<std::uint32_t>(word));
    (void)set_lists(mesh, words, boxes_, counts);
}

bool MeshPacker::set_lists(ClusteredMesh& mesh, std::span<const std::uint32_t> words,
                           std::span<const ClusteredMesh::PackedBox> boxes, std::span<const std::uint8_t> counts) {
    Vector<ClusteredMesh::Group> groups;
    std::uint64_t triangle = 0, bit = 0;
    for (std::size_t c = 0; c < counts.size(); ++c) {
        if (c % ClusteredMesh::kGroup == 0 && c != 0) {
            bit = (bit + 31) / 32 * 32;
            groups.push_back({static_cast<std::uint32_t>(triangle), static_cast<std::uint32_t>(bit / 32)});
        }
        const std::uint32_t triangles = (counts[c] & 63u) + 1;
        triangle += triangles;
        bit += std::uint64_t{3} * triangles * (mesh.corner_bits_ - (counts[c] >> 6));
    }
    if (triangle != mesh.triangle_count_ || (bit + 31) / 32 != words.size()) return false;
    mesh.corner_words_ = static_cast<std::uint32_t>(words.size());
    mesh.cluster_count_ = static_cast<std::uint32_t>(counts.size());
    mesh.packed_.resize(words.size_bytes() + boxes.size_bytes() + groups.size() * sizeof(groups[0]) + counts.size());
    std::byte* to = mesh.packed_.data();
    const auto append = [&to](const auto& list) {
        if (list.empty()) return;
        std::memcpy(to, list.data(), list.size() * sizeof(list[0]));
        to += list.size() * sizeof(list[0]);
    };
    append(words), append(boxes), append(groups), append(counts);
    return true;
}

bool MeshPacker::has_twins(std::span<const std::uint8_t> corners) {
    SmallTable<std::array<std::uint8_t, 2>> edges;
    edges.clear();
    std::uint8_t count = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::array key{corners[i], corners[i % 3 == 2 ? i - 2 : i + 1]};
        if (key[0] == key[1] || edges.number_of(key, count) != count) return true;
        ++count;
    }
    return false;
}

}  // namespace crofton::depth
