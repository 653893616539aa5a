// The float filter over blocks of box pairs: what kernel files and the code around them share.
#pragma once
#include <crofton/collide/box_block.hpp>

namespace crofton::collide {

// One bit a pair: surely separated by which group of axes (the first that applies), surely meeting; the rest is open.
struct BlockVerdict {
    std::uint32_t face_a = 0, face_b = 0, edges = 0, hit = 0;
};

// `verdicts[i]` for pair of blocks i. `relative`: b's centres are offsets from a's, which are then not read.
void filter_blocks(const BoxBlock* a, const BoxBlock* b, std::size_t count, bool relative, BlockVerdict* verdicts);

// Fills deviation[] from axes[].
void measure_deviation(BoxBlock& block);

}  // namespace crofton::collide
