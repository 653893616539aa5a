// SPDX-License-Identifier: MIT
#include "pair_coder.hpp"

#include <array>

namespace crofton::pvs {
namespace {

// The interval [low, high] of 32-bit numbers shrinks with each decision in proportion to its probability; leading bytes
// that both ends share are settled (Witten, Neal and Cleary, "Arithmetic coding for data compression", 1987).
struct Interval {
    std::uint32_t low = 0, high = ~std::uint32_t{0};

    [[nodiscard]] std::uint32_t split(std::uint32_t probability) const {
        return low + static_cast<std::uint32_t>(std::uint64_t{high - low} * probability >> 16);
    }
    void take(bool bit, std::uint32_t at) { bit ? high = at : low = at + 1; }
    [[nodiscard]] bool is_settled() const { return ((low ^ high) & 0xff000000u) == 0; }
    void shift() { low <<= 8, high = high << 8 | 0xffu; }
};

// Of a 1, in 1/65536; learns from what it sees. Stays within [31, 65505].
struct Probability {
    std::uint32_t of_one = 32768;
    void learn(bool bit) { bit ? of_one += (65536 - of_one) >> 5 : of_one -= of_one >> 5; }
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

// Two decisions a pair, each with the probabilities of its surroundings: the object's states in the three cells before,
// and that of the object before in the same cell; 3 stands for none.
class Model {
  public:
    explicit Model(const PairStates& pairs) : pairs_(pairs) {}

    // decide(bit, probability) gives the bit: what it is told to code, or what it has read.
    template <class Decide>
    std::uint8_t pass(std::size_t cell, std::uint32_t object, std::uint8_t state, Decide&& decide) {
        const std::size_t around = surroundings(cell, object);
        if (decide(state == 2, seen_[around])) return 2;
        return decide(state == 1, unseen_[around]) ? 1 : 0;
    }

  private:
    [[nodiscard]] std::size_t surroundings(std::size_t cell, std::uint32_t object) const {
        const std::size_t stride[3] = {1, pairs_.counts.x, std::size_t{pairs_.counts.x} * pairs_.counts.y};
        const std::size_t at[3] = {cell % pairs_.counts.x, cell / stride[1] % pairs_.counts.y, cell / stride[2]};
        std::size_t result = object == 0 ? 3 : pairs_.states[cell * pairs_.objects + object - 1];
        for (int k = 0; k < 3; ++k)
            result = 4 * result + (at[k] == 0 ? 3 : pairs_.states[(cell - stride[k]) * pairs_.objects + object]);
        return result;
    }

    const PairStates& pairs_;
    std::array<Probability, 256> seen_, unseen_;
};

}  // namespace

Vector<std::byte> encode(const PairStates& pairs) {
    Encoder encoder;
    Model model(pairs);
    const std::size_t cells = pairs.objects == 0 ? 0 : pairs.states.size() / pairs.objects;
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
    Model model(pairs);
    const std::size_t cells = std::size_t{pairs.counts.x} * pairs.counts.y * pairs.counts.z;
    pairs.states.assign(cells * pairs.objects, 0);
    for (std::size_t c = 0; c < cells; ++c)
        for (std::uint32_t o = 0; o < pairs.objects; ++o)
            pairs.states[c * pairs.objects + o] =
                model.pass(c, o, 0, [&](bool, Probability& p) { return decoder.get(p); });
}

std::uint64_t most_pairs(std::size_t bytes) {
    return (std::uint64_t{bytes} + 1) * 8 * 2000;
}

}  // namespace crofton::pvs
