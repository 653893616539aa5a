// SPDX-License-Identifier: MIT
// The finished sets as sections of a .crofton file.
#include <algorithm>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/pvs/pvs.hpp>
#include <string_view>

#include "pair_coder.hpp"

namespace crofton::pvs {
namespace {

struct Head {
    double low[3] = {}, high[3] = {};  // of a grid
    std::uint32_t counts[3] = {};      // 0: boxes or convex cells, in a section of their own
    std::uint32_t objects = 0;
    double epsilon = 1.0, confidence = 0.0;
    std::uint64_t geometry = 0;
};
static_assert(sizeof(Head) == 88);

Error damaged(const char* what, std::uint64_t item = kNoItem) {
    return fail(ErrorCode::parse, item, {"potentially visible sets: ", what});
}

Result<Cells> cells_from(const Head& head, std::span<const Aabb> boxes, std::span<const ConvexCell> convex) {
    if (!convex.empty()) return Cells::convex(convex);
    if (!boxes.empty()) return Cells::boxes(boxes);
    const glm::dvec3 low(head.low[0], head.low[1], head.low[2]), high(head.high[0], head.high[1], head.high[2]);
    return Cells::grid({low, high}, {head.counts[0], head.counts[1], head.counts[2]});
}

glm::uvec3 rows_of(const Cells& cells) {
    return cells.is_grid() ? cells.counts() : glm::uvec3(static_cast<std::uint32_t>(cells.size()), 1, 1);
}

std::string_view name_of(const bake::Section& section) {
    const auto end = std::find(std::begin(section.name), std::end(section.name), '\0');
    return {section.name, static_cast<std::size_t>(end - section.name)};
}

constexpr const char* kConvex = "pvs_hull";
constexpr std::size_t kMostSections = 6;

bool has_convex(const bake::Reader& reader) {
    const auto sections = reader.sections();
    return std::any_of(sections.begin(), sections.end(),
                       [](const bake::Section& section) { return name_of(section) == kConvex; });
}

}  // namespace

struct PvsFile {
    static void add(const Pvs& pvs, bake::Writer& writer) {
        Head head;
        for (int k = 0; k < 3 && pvs.cells_.is_grid(); ++k) {
            head.low[k] = pvs.cells_.bounds().min[k];
            head.high[k] = pvs.cells_.bounds().max[k];
            head.counts[k] = pvs.cells_.counts()[k];
        }
        head.objects = pvs.objects_;
        head.geometry = pvs.geometry_;
        head.epsilon = pvs.epsilon_, head.confidence = pvs.confidence_;
        Vector<Aabb> boxes;
        Vector<ConvexCell> convex;
        for (std::size_t c = 0; c < pvs.cells_.size() && !pvs.cells_.is_grid(); ++c)
            pvs.cells_.is_convex() ? convex.push_back(pvs.cells_.corners(c)) : boxes.push_back(pvs.cells_.box(c));
        PairStates pairs{rows_of(pvs.cells_), pvs.objects_, {}};
        for (std::size_t c = 0; c < pvs.kinds_.size(); ++c)
            for (std::uint32_t o = 0; o < pvs.objects_; ++o)
                pairs.states.push_back(pvs.is_baked(o) ? static_cast<std::uint8_t>(pvs.state(c, o)) : 0);
        const Vector<std::byte> code = encode(pairs);
        writer.add("pvs_head", std::span<const Head>(&head, 1));
        writer.add("pvs_box", std::span<const Aabb>(boxes));
        if (!convex.empty()) writer.add(kConvex, std::span<const ConvexCell>(convex));
        writer.add("pvs_kind", std::span<const CellKind>(pvs.kinds_));
        writer.add("pvs_from", std::span<const std::uint64_t>(pvs.baked_));
        writer.add("pvs_pair", std::span<const std::byte>(code));
    }

    static Result<Pvs> read(const bake::Reader& reader, const ReadLimits& limits) {
        const auto head = reader.section<Head>("pvs_head");
        const auto boxes = reader.section<Aabb>("pvs_box");
        const auto kinds = reader.section<CellKind>("pvs_kind");
        const auto baked = reader.section<std::uint64_t>("pvs_from");
        const auto code = reader.section<std::byte>("pvs_pair");
        if (!head) return head.error();
        if (!boxes) return boxes.error();
        if (!kinds) return kinds.error();
        if (!baked) return baked.error();
        if (!code) return code.error();
        if (head->size() != 1) return damaged("not one header");
        std::span<const ConvexCell> convex;
        if (has_convex(reader)) {
            const auto section = reader.section<ConvexCell>(kConvex);
            if (!section) return section.error();
            convex = *section;
        }
        auto cells = cells_from(head->front(), *boxes, convex);
        if (!cells) return damaged(cells.error().message.c_str(), cells.error().item);
        Pvs pvs;
        pvs.cells_ = std::move(*cells);
        pvs.objects_ = head->front().objects;
        pvs.geometry_ = head->front().geometry;
        pvs.epsilon_ = head->front().epsilon, pvs.confidence_ = head->front().confidence;
        if (kinds->size() != pvs.cells_.size() || baked->size() != pvs.words())
            return damaged("sections are not as long as the header says");
        const std::uint64_t all = std::uint64_t{pvs.cells_.size()} * pvs.objects_;
        if (all > most_pairs(code->size())) return damaged("too few bytes for its pairs");
        if (all > limits.pairs)
            return fail(ErrorCode::out_of_range, kNoItem,
                        {"potentially visible sets: ", all, " pairs of a cell and an object, where the limit is ",
                         limits.pairs, " (ReadLimits::pairs)"});
        for (std::size_t c = 0; c < kinds->size(); ++c)
            if ((*kinds)[c] > CellKind::open) return damaged("a cell of no known kind", c);
        pvs.kinds_.assign(kinds->begin(), kinds->end());
        pvs.baked_.assign(baked->begin(), baked->end());
        PairStates pairs{rows_of(pvs.cells_), pvs.objects_, {}};
        decode(*code, pairs);
        fill(pvs, pairs);
        return pvs;
    }

  private:
    static void fill(Pvs& pvs, const PairStates& pairs) {
        const std::size_t words = pvs.words();
        pvs.seen_.assign(pvs.cells_.size() * words, 0);
        pvs.open_.assign(pvs.cells_.size() * words, 0);
        for (std::size_t c = 0; c < pvs.cells_.size(); ++c) {
            if (pvs.kinds_[c] == CellKind::solid || pvs.kinds_[c] == CellKind::unknown) continue;
            std::uint64_t *seen = pvs.seen_.data() + c * words, *open = pvs.open_.data() + c * words;
            for (std::uint32_t o = 0; o < pvs.objects_; ++o) {
                const std::uint8_t state = pvs.is_baked(o) ? pairs.states[c * pvs.objects_ + o] : 2;
                seen[o / 64] |= std::uint64_t{state == 2} << (o % 64);
                open[o / 64] |= std::uint64_t{state != 0} << (o % 64);
            }
        }
    }
};

Result<Vector<std::byte>> Pvs::to_file(std::span<const std::byte> scene_file) const {
    return crofton::detail::recover([&]() -> Result<Vector<std::byte>> {
        bake::Writer writer;
        if (!scene_file.empty()) {
            const auto reader = bake::Reader::open(scene_file);
            if (!reader) return reader.error();
            if (reader->sections().size() + kMostSections > bake::kMaxSections)
                return fail(ErrorCode::out_of_range, kNoItem, "the scene file has no room for more sections");
            for (const bake::Section& section : reader->sections()) {
                if (name_of(section).substr(0, 4) == "pvs_")
                    return fail(ErrorCode::invalid_argument, kNoItem, "the scene file has visible sets already");
                writer.copy(section, scene_file);
            }
        }
        PvsFile::add(*this, writer);
        return writer.finish();
    });
}

Result<Pvs> Pvs::from_memory(std::span<const std::byte> file, const ReadLimits& limits) {
    return crofton::detail::recover([&]() -> Result<Pvs> {
        const auto reader = bake::Reader::open(file);
        if (!reader) return reader.error();
        return PvsFile::read(*reader, limits);
    });
}

Result<Pvs> Pvs::open(const std::string& path, const ReadLimits& limits) {
    return crofton::detail::recover([&]() -> Result<Pvs> {
        const auto file = bake::MappedFile::open(path);
        if (!file) return file.error();
        auto pvs = from_memory(file->bytes(), limits);
        if (!pvs) return fail(pvs.error().code, pvs.error().item, {path, ": ", pvs.error().message});
        return pvs;
    });
}

}  // namespace crofton::pvs
