// SPDX-License-Identifier: MIT
// Blocks of uniform lines, one line after the other with its crossings.
#pragma once
#include <crofton/lines/lines.hpp>
#include <span>

namespace crofton::bench {

// follow(line, its hits in order), of the first `blocks` blocks.
template <class Follow>
void for_each_line(const lines::LineTracer& tracer, const lines::LineSource& source, std::uint64_t blocks,
                   Follow&& follow) {
    Vector<Line> lines;
    lines::LineHits hits;
    for (std::uint64_t block = 0; block < blocks; ++block) {
        source.draw(block, lines);
        tracer.all_hits(lines, hits);
        for (std::size_t i = 0, first = 0; i < lines.size(); ++i) {
            follow(lines[i], std::span<const lines::Hit>(hits.hits).subspan(first, hits.ends[i] - first));
            first = hits.ends[i];
        }
    }
}

}  // namespace crofton::bench
