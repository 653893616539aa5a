// SPDX-License-Identifier: MIT
// Lines as witnesses beside the REJECT lumps of DOOM's levels: `bench_reject_pvs [--lines N] FILE.wad MAP01 …`
// A lump says which pairs of sectors never see each other. Take a stretch of a line that meets no surface, nor passes a
// line of the level without a second side. All sectors above which it passes see each other. bench/reject_pvs.sh
// fetches levels and runs this.
#include <algorithm>
#include <assets/scene_source.hpp>
#include <assets/wad_file.hpp>
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "line_blocks.hpp"

namespace {

using namespace crofton;

constexpr double kUnitsPerMetre = 32.0;
constexpr double kShortest = 0.01;  // metres: shorter stretches witness nothing

// Of level `name`: bit i · sectors + j says that sector i never sees sector j. Empty: there is none.
std::string reject_lump(const std::string& wad, const std::string& name) {
    const auto number = [&](std::size_t at) {
        std::uint32_t n = 0;
        if (at + 4 <= wad.size()) std::memcpy(&n, wad.data() + at, 4);
        return std::size_t{n};
    };
    const std::size_t count = number(4), directory = number(8);
    bool within = false;
    for (std::size_t i = 0; i < count && directory + 16 * (i + 1) <= wad.size(); ++i) {
        const std::size_t entry = directory + 16 * i, begin = number(entry), size = number(entry + 4);
        const std::string lump(wad.data() + entry + 8, strnlen(wad.data() + entry + 8, 8));
        if (size == 0) within = lump == name;
        if (within && lump == "REJECT" && begin <= wad.size()) return wad.substr(begin, size);
    }
    return {};
}

class Comparison {
  public:
    Comparison(const assets::WadLevel& level, std::string reject)
        : level_(level), reject_(std::move(reject)), sectors_(level.sectors.size()), ours_(sectors_ * sectors_) {}

    void trace(const lines::LineTracer& tracer, const lines::LineSource& source, const glm::dvec3& origin,
               std::uint64_t blocks) {
        bench::for_each_line(tracer, source, blocks, [&](const Line& line, std::span<const lines::Hit> hits) {
            if (hits.empty()) return;
            cross_level({line.point + origin, line.direction});
            follow(hits);
        });
    }

    void print(std::uint64_t lines) const {
        std::size_t ours = 0, theirs = 0, rejected = 0, one_way = 0;
        for (std::size_t i = 0; i < sectors_; ++i)
            for (std::size_t j = 0; j < sectors_; ++j) {
                const bool mine = ours_[i * sectors_ + j] != 0;
                ours += mine;
                theirs += !is_rejected(i, j);
                rejected += mine && is_rejected(i, j);
                one_way += mine && is_rejected(i, j) && !is_rejected(j, i);
                if (mine && is_rejected(i, j) && i < j)
                    std::fprintf(stderr, "%s: %zu, %zu\n", level_.name.c_str(), i, j);
            }
        std::printf("| %s | %zu | %zu | %zu | %.0f %% | %zu | %zu | %llu |\n", level_.name.c_str(), sectors_, theirs,
                    ours, 100.0 * static_cast<double>(ours) / static_cast<double>(theirs), rejected, one_way,
                    static_cast<unsigned long long>(lines));
        std::fflush(stdout);
    }

  private:
    static constexpr std::uint32_t kVoid = ~std::uint32_t{0};
    struct Crossing {
        double t = 0.0;
        std::uint32_t before = kVoid, after = kVoid;  // sectors
    };

    [[nodiscard]] bool is_rejected(std::size_t i, std::size_t j) const {
        const std::size_t bit = i * sectors_ + j;
        return static_cast<unsigned char>(reject_[bit / 8]) >> (bit % 8) & 1;
    }
    [[nodiscard]] std::uint32_t sector(std::uint32_t side) const {
        return side == assets::kNoSide ? kVoid : level_.sides[side].sector;
    }

    // Seen from above, x to the right and y = −z up.
    void cross_level(const Line& line) {
        crossings_.clear();
        const double px = line.point.x, py = -line.point.z, dx = line.direction.x, dy = -line.direction.z;
        for (const assets::WadLevel::Line& wall : level_.lines) {
            const auto &from = level_.vertices[wall.from], &to = level_.vertices[wall.to];
            const double ax = from.x / kUnitsPerMetre - px, ay = from.y / kUnitsPerMetre - py;
            const double bx = to.x / kUnitsPerMetre - px, by = to.y / kUnitsPerMetre - py;
            const double a = dx * ay - dy * ax, b = dx * by - dy * bx;  // above 0: on the left of the line
            if ((a < 0.0) == (b < 0.0)) continue;
            const double s = a / (a - b), x = ax + s * (bx - ax), y = ay + s * (by - ay);
            const double t = (x * dx + y * dy) / (dx * dx + dy * dy);
            // Of a wall that runs from the line's right to its left, the left side faces the line's beginning.
            const std::uint32_t left = sector(wall.left), right = sector(wall.right);
            crossings_.push_back(a < b ? Crossing{t, left, right} : Crossing{t, right, left});
        }
        std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& x, const Crossing& y) { return x.t < y.t; });
    }

    void follow(std::span<const lines::Hit> hits) {
        for (std::size_t h = 0; h + 1 < hits.size(); ++h)
            if (hits[h + 1].t - hits[h].t > kShortest)
                witness(static_cast<double>(hits[h].t), static_cast<double>(hits[h + 1].t));
    }

    // All sectors that the level's lines in order put between begin and end, up to the next wall.
    void witness(double begin, double end) {
        run_.clear();
        for (std::size_t c = 0; c + 1 < crossings_.size(); ++c) {
            const double from = std::max(begin, crossings_[c].t), to = std::min(end, crossings_[c + 1].t);
            const bool agree = crossings_[c].after == crossings_[c + 1].before;
            if (crossings_[c].after == kVoid || !agree) {
                if (crossings_[c + 1].t > crossings_[c].t + 1e-9) see();
                continue;
            }
            if (to - from > kShortest) run_.push_back(crossings_[c].after);
        }
        see();
    }
    void see() {
        for (const std::uint32_t a : run_)
            for (const std::uint32_t b : run_) ours_[a * sectors_ + b] = 1;
        run_.clear();
    }

    const assets::WadLevel& level_;
    std::string reject_;
    std::size_t sectors_;
    std::vector<std::uint8_t> ours_;  // by pair
    std::vector<Crossing> crossings_;
    std::vector<std::uint32_t> run_;
};

bool compare(const std::string& path, const std::string& wad, const std::string& map, std::uint64_t blocks) {
    const auto level = assets::read_level(wad, map);
    auto source = assets::load_scene(path, {.map = map});
    if (!level || !source) return false;
    source->scene.update();
    const auto geometry = pvs::geometry_of(source->scene);
    const std::string reject = reject_lump(wad, map);
    if (!geometry || reject.size() * 8 < level->sectors.size() * level->sectors.size()) return false;
    const auto tracer = lines::LineTracer::build(geometry->mesh);
    if (!tracer) return false;
    Comparison comparison(*level, reject);
    comparison.trace(*tracer, {tracer->bounds(), lines::LineMethod::walls, 1}, geometry->origin, blocks);
    comparison.print(blocks * lines::LineSource::kBlock);
    return true;
}

}  // namespace

int main(int count, char** arguments) {
    std::uint64_t blocks = 1024;
    std::string path, wad;
    std::printf(
        "| level | sectors | pairs, REJECT | pairs, lines | share | rejected | of them one way | lines |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (int i = 1; i < count; ++i) {
        const std::string argument = arguments[i];
        if (argument == "--lines" && i + 1 < count) {
            blocks = std::strtoull(arguments[++i], nullptr, 10) / lines::LineSource::kBlock;
        } else if (path.empty()) {
            path = argument;
            std::ifstream file(path, std::ios::binary);
            wad.assign(std::istreambuf_iterator<char>(file), {});
        } else if (!compare(path, wad, argument, blocks)) {
            std::fprintf(stderr, "%s: no such level, or no REJECT lump of the right size\n", argument.c_str());
        }
    }
    return 0;
}
