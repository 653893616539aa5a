// SPDX-License-Identifier: MIT
// Lines as witnesses beside the visible sets that q3map2 made: `bench_quake3_pvs [--lines N] LEVEL.bsp …`
// A level's leaves come in clusters. Take a stretch of a line that meets neither solid leaves nor surfaces. All
// clusters that it passes see each other, and the sets must say so. bench/quake3_pvs.sh fetches levels and runs this.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <string>
#include <vector>

#include "line_blocks.hpp"
#include "quake3_level.hpp"

namespace {

using namespace crofton;
using Stretch = bench::Quake3Level::Stretch;

// The level's compiler rounds corners of leaves to eighths of a unit. So shorter stretches witness nothing.
constexpr double kShortest = 0.25;

class Comparison {
  public:
    explicit Comparison(const bench::Quake3Level& level) : level_(level), ours_(level.clusters * level.clusters) {}

    void trace(const lines::LineTracer& tracer, const lines::LineSource& source, std::uint64_t blocks) {
        bench::for_each_line(tracer, source, blocks,
                             [&](const Line& line, std::span<const lines::Hit> hits) { follow(line, hits); });
    }

    void print(const std::string& name, std::uint64_t lines) const {
        std::size_t ours = 0, theirs = 0, both = 0, turned = 0;
        for (std::size_t i = 0; i < level_.clusters; ++i)
            for (std::size_t j = 0; j < level_.clusters; ++j) {
                const bool mine = ours_[i * level_.clusters + j] != 0;
                ours += mine;
                theirs += level_.may_see(i, j);
                both += mine && level_.may_see(i, j);
                turned += mine && !level_.may_see(i, j) && level_.may_see(j, i);
            }
        const double pairs = static_cast<double>(level_.clusters) * static_cast<double>(level_.clusters);
        std::printf("| %s | %zu | %zu | %zu | %.0f %% | %zu | %zu | %.1e |\n", name.c_str(), level_.clusters, theirs,
                    ours, 100.0 * static_cast<double>(ours) / static_cast<double>(theirs), ours - both, turned,
                    std::log(pairs / 1e-3) / static_cast<double>(lines));
        std::fflush(stdout);
    }

  private:
    void follow(const Line& line, std::span<const lines::Hit> hits) {
        const double size = 4.0 * glm::length(glm::dvec3(1 << 16));
        double begin = -size;
        for (std::size_t h = 0; h <= hits.size(); ++h) {
            const double end = h < hits.size() ? static_cast<double>(hits[h].t) : size;
            passed_.clear();
            if (end - begin > kShortest) level_.walk(line.point, line.direction, begin, end, passed_);
            std::size_t first = 0;
            for (std::size_t i = 0; i <= passed_.size(); ++i) {
                if (i < passed_.size() && passed_[i].cluster >= 0) continue;
                witness(std::span(passed_).subspan(first, i - first));
                first = i + 1;
            }
            begin = end;
        }
    }

    // All of them see each other.
    void witness(std::span<const Stretch> run) {
        for (const Stretch& a : run)
            for (const Stretch& b : run)
                if (std::min(a.end - a.begin, b.end - b.begin) >= kShortest)
                    ours_[static_cast<std::size_t>(a.cluster) * level_.clusters + static_cast<std::size_t>(b.cluster)] =
                        1;
    }

    const bench::Quake3Level& level_;
    std::vector<std::uint8_t> ours_;  // by pair
    std::vector<Stretch> passed_;
};

std::vector<char> bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int main(int count, char** arguments) {
    std::uint64_t blocks = 2048;
    std::printf(
        "| level | clusters | pairs, q3map2 | pairs, lines | share | not in theirs | of them the other way round | "
        "epsilon |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (int i = 1; i < count; ++i) {
        const std::string path = arguments[i];
        if (path == "--lines" && i + 1 < count) {
            blocks = std::strtoull(arguments[++i], nullptr, 10) / lines::LineSource::kBlock;
            continue;
        }
        const std::vector<char> file = bytes_of(path);
        const auto level = bench::read_quake3_level(std::as_bytes(std::span(file)));
        if (!level) {
            std::fprintf(stderr, "%s: %s\n", path.c_str(), level.error().message.c_str());
            continue;
        }
        const auto tracer = lines::LineTracer::build(level->mesh);
        if (!tracer) {
            std::fprintf(stderr, "%s: %s\n", path.c_str(), tracer.error().message.c_str());
            continue;
        }
        Comparison comparison(*level);
        comparison.trace(*tracer, {tracer->bounds(), lines::LineMethod::walls, 1}, blocks);
        comparison.print(path.substr(path.rfind('/') + 1), blocks * lines::LineSource::kBlock);
    }
    return 0;
}
