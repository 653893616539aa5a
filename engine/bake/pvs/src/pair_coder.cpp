// SPDX-License-Identifier: MIT
#include "pair_coder.hpp"

#include <algorithm>
#include <bit>

namespace crofton::pvs {
namespace {

// The interval [low, high] of 32-bit numbers shrinks with each decision in proportion to its probability. Leading bytes
// that both ends share are final (Witten, Neal and Cleary, "Arithmetic coding for data compression", 1987).
struct Interval {
    std::uint32_t low = 0, high = ~std::uint32_t{0};

    [[nodiscard]] std::uint32_t split(std::uint32_t probability) const {
        return low + static_cast<std::uint32_t>(std::uint64_t{high - low} * probability >> 16);
    }
    void take(bool bit, std::uint32_t at) { bit ? high = at : low = at + 1; }
    [[nodiscard]] bool is_settled() const { return ((low ^ high) & 0xff000000u) == 0; }
    void shift() { low <<= 8, high = high << 8 | 0xffu; }
};

// The probability of a 1, in 1/65536: the share of ones so far, then of the last few hundred. Stays within [32, 65504].
struct Probability {
    static constexpr std::uint16_t kSlowest = 250;
    std::uint16_t of_one = 32768, seen = 0;

    void learn(bool bit) {
        const std::int64_t error = (bit ? 65536 : 0) - static_cast<std::int32_t>(of_one);
        const std::int64_t step = error * (131072 / (2 * seen + 3)) / 65536;
        of_one = static_cast<std::uint16_t>(std::clamp<std::int64_t>(of_one + step, 32, 65504));
        seen = static_cast<std::uint16_t>(seen + (seen < kSlowest));
    }
};

class Encoder {
  public:
    void put(bool bit, Probability& p) {
        interval_.take(bit, interval_.split(p.of_one));
        p.learn(bit);
        for (; interval_.is_settled(); interval_.shift()) bytes_.push_back(static_cast<std::byte>(interval_.low >> 24));
    }
    Vector<std::byte> finish() {
        for (int i = 0; i < 4; ++i, interval_.low <<= 8) bytes_.push_back(static_cast<std::byte>(interval_.low >> 24));
        return std::move(bytes_);
    }

  private:
    Interval interval_;
    Vector<std::byte> bytes_;
};

class Decoder {
  public:
    explicit Decoder(std::span<const std::byte> bytes) : bytes_(bytes) {
        for (int i = 0; i < 4; ++i) next();
    }
    bool get(Probability& p) {
        const std::uint32_t at = interval_.split(p.of_one);
        const bool bit = code_ <= at;
        interval_.take(bit, at);
        p.learn(bit);
        for (; interval_.is_settled(); interval_.shift()) next();
        return bit;
    }

  private:
    void next() { code_ = code_ << 8 | (at_ < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at_]) : 0u), ++at_; }
    Interval interval_;
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
    std::uint32_t code_ = 0;
};

// The two likest of an object among those before it: how far back each is, 0 for none.
struct Likest {
    std::uint32_t back[2] = {};
};
constexpr unsigned kLikestBits = 9;
constexpr std::uint32_t kFarthest = (1u << kLikestBits) - 1;

// An object's states as two bits a cell, and where they differ from those of the cells before along x or z. There the
// neighbours say little, and the likest objects shall agree.
class Columns {
  public:
    explicit Columns(const PairStates& pairs) : words_(pairs.states.size() / pairs.objects / 64 + 1) {
        columns_.assign(pairs.objects * 3 * words_, 0);
        const std::size_t cells = pairs.states.size() / pairs.objects;
        const std::size_t along_z = std::size_t{pairs.counts.x} * pairs.counts.y;
        for (std::size_t c = 0; c < cells; ++c)
            for (std::uint32_t o = 0; o < pairs.objects; ++o) {
                const std::uint8_t state = pairs.states[c * pairs.objects + o];
                std::uint64_t* word = columns_.data() + std::size_t{o} * 3 * words_ + c / 64;
                const auto before = [&](std::size_t cells_back) {
                    return c < cells_back ? std::uint8_t{0} : pairs.states[(c - cells_back) * pairs.objects + o];
                };
                word[0] |= std::uint64_t{state == 2} << (c % 64);
                word[words_] |= std::uint64_t{state == 1} << (c % 64);
                word[2 * words_] |= std::uint64_t{state != before(1) || state != before(along_z)} << (c % 64);
            }
    }

    [[nodiscard]] Likest likest(std::uint32_t object) const {
        const std::uint64_t* own = column(object);
        std::uint64_t most[2] = {};
        Likest best;
        for (std::uint32_t back = 1; back <= (std::min)(object, kFarthest); ++back) {
            const std::uint64_t* other = column(object - back);
            std::uint64_t agree = 0;
            for (std::size_t w = 0; w < words_; ++w)
                agree += static_cast<std::uint64_t>(
                    std::popcount(own[2 * words_ + w] & ~(own[w] ^ other[w]) & ~(own[words_ + w] ^ other[words_ + w])));
            if (agree > most[0]) {
                most[1] = most[0], best.back[1] = best.back[0];
                most[0] = agree, best.back[0] = back;
            } else if (agree > most[1]) {
                most[1] = agree, best.back[1] = back;
            }
        }
        return best;
    }

  private:
    [[nodiscard]] const std::uint64_t* column(std::uint32_t object) const {
        return columns_.data() + std::size_t{object} * 3 * words_;
    }
    std::size_t words_;
    Vector<std::uint64_t> columns_;
};

// Two decisions a pair, each with the probabilities of its surroundings. These are the object's states in the cells
// before, and those of its likest objects here and before. A surrounding that is new begins with what a coarser one has
// learnt.
class Model {
  public:
    Model(const PairStates& pairs, const Vector<Likest>& likest)
        : pairs_(pairs), likest_(likest), seen_(kFine), unseen_(kFine), coarse_seen_(kCoarse), coarse_unseen_(kCoarse) {
        const std::size_t layer = std::size_t{pairs.counts.x} * pairs.counts.y;
        const std::size_t cells[4] = {1, pairs.counts.x, layer, layer + 1};
        for (int k = 0; k < 4; ++k) back_[k] = static_cast<std::ptrdiff_t>(cells[k] * pairs.objects);
    }

    // decide(bit, probability) returns the bit: the given one when coding, the one read when decoding.
    template <class Decide>
    std::uint8_t pass(std::size_t cell, std::uint32_t object, std::uint8_t state, Decide&& decide) {
        const std::size_t around = surroundings(cell, object);
        const auto ask = [&](bool bit, Vector<Probability>& fine, Vector<Probability>& coarse) {
            Probability &narrow = fine[around], &wide = coarse[around % kCoarse];
            if (narrow.seen == 0) narrow.of_one = wide.of_one;
            const bool decided = decide(bit, narrow);
            wide.learn(decided);
            return decided;
        };
        if (ask(state == 2, seen_, coarse_seen_)) return 2;
        return ask(state == 1, unseen_, coarse_unseen_) ? 1 : 0;
    }

  private:
    static constexpr std::size_t kCoarse = 1 << 10, kFine = 1 << 18;

    // Nine states in base 4, 3 for none; the lower five are the coarse surroundings.
    [[nodiscard]] std::size_t surroundings(std::size_t cell, std::uint32_t object) const {
        const std::size_t x = cell % pairs_.counts.x, rest = cell / pairs_.counts.x;
        const bool has_x = x > 0, has_y = rest % pairs_.counts.y > 0, has_z = rest / pairs_.counts.y > 0;
        const std::uint8_t* own = pairs_.states.data() + cell * pairs_.objects + object;
        const Likest& likest = likest_[object];
        const std::uint8_t* first = own - likest.back[0];
        const bool has_first = likest.back[0] > 0;
        const auto state = [](bool there, const std::uint8_t* at, std::ptrdiff_t back) -> std::size_t {
            return there ? at[-back] : 3;
        };
        const std::size_t coarse = state(has_x, own, back_[0]) | state(has_y, own, back_[1]) << 2 |
                                   state(has_z, own, back_[2]) << 4 | state(has_x && has_z, own, back_[3]) << 6 |
                                   state(has_first, first, 0) << 8;
        const bool has_across = has_z && x + 1 < pairs_.counts.x;
        return coarse | state(has_across, own, back_[2] - back_[0]) << 10 |
               state(likest.back[1] > 0, own, static_cast<std::ptrdiff_t>(likest.back[1])) << 12 |
               state(has_first && has_x, first, back_[0]) << 14 | state(has_first && has_z, first, back_[2]) << 16;
    }

    const PairStates& pairs_;
    const Vector<Likest>& likest_;
    Vector<Probability> seen_, unseen_, coarse_seen_, coarse_unseen_;
    std::ptrdiff_t back_[4] = {};  // to the cell before along x, y, z, and along both x and z
};

}  // namespace

Vector<std::byte> encode(const PairStates& pairs) {
    Encoder encoder;
    const std::size_t cells = pairs.objects == 0 ? 0 : pairs.states.size() / pairs.objects;
    Vector<Likest> likest(pairs.objects);
    if (cells > 0) {
        const Columns columns(pairs);
        for (std::uint32_t o = 0; o < pairs.objects; ++o) {
            likest[o] = columns.likest(o);
            for (const std::uint32_t back : likest[o].back)
                for (unsigned bit = kLikestBits; bit-- > 0;) {
                    Probability even;
                    encoder.put(back >> bit & 1, even);
                }
        }
    }
    Model model(pairs, likest);
    for (std::size_t c = 0; c < cells; ++c)
        for (std::uint32_t o = 0; o < pairs.objects; ++o)
            model.pass(c, o, pairs.states[c * pairs.objects + o], [&](bool bit, Probability& p) {
                encoder.put(bit, p);
                return bit;
            });
    return encoder.finish();
}

void decode(std::span<const std::byte> bytes, PairStates& pairs) {
    Decoder decoder(bytes);
    const std::size_t cells = std::size_t{pairs.counts.x} * pairs.counts.y * pairs.counts.z;
    pairs.states.assign(cells * pairs.objects, 0);
    Vector<Likest> likest(pairs.objects);
    for (std::uint32_t o = 0; o < pairs.objects && cells > 0; ++o)
        for (std::uint32_t& back : likest[o].back) {
            for (unsigned bit = kLikestBits; bit-- > 0;) {
                Probability even;
                back = 2 * back + decoder.get(even);
            }
            back = (std::min)(back, o);  // damaged bytes may say more
        }
    Model model(pairs, likest);
    for (std::size_t c = 0; c < cells; ++c)
        for (std::uint32_t o = 0; o < pairs.objects; ++o)
            pairs.states[c * pairs.objects + o] =
                model.pass(c, o, 0, [&](bool, Probability& p) { return decoder.get(p); });
}

std::uint64_t most_pairs(std::size_t bytes) {
    return (std::uint64_t{bytes} + 1) * 8 * 2000;
}

}  // namespace crofton::pvs
