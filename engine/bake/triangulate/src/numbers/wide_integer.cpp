// SPDX-License-Identifier: MIT
#include "numbers/wide_integer.hpp"

#include <algorithm>
#include <bit>

namespace crofton::triangulate {

WideInteger::WideInteger(std::uint64_t value) {
    limbs_ = {static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(value >> 32)};
    trim();
}

void WideInteger::trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
}

std::size_t WideInteger::bit_count() const {
    return limbs_.empty() ? 0 : 32 * limbs_.size() - static_cast<std::size_t>(std::countl_zero(limbs_.back()));
}

int WideInteger::compare(const WideInteger& other) const {
    if (limbs_.size() != other.limbs_.size()) return limbs_.size() < other.limbs_.size() ? -1 : 1;
    for (std::size_t i = limbs_.size(); i-- > 0;) {
        if (limbs_[i] != other.limbs_[i]) return limbs_[i] < other.limbs_[i] ? -1 : 1;
    }
    return 0;
}

WideInteger& WideInteger::operator+=(const WideInteger& other) {
    limbs_.resize(std::max(limbs_.size(), other.limbs_.size()) + 1, 0);
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
        carry += std::uint64_t{limbs_[i]} + (i < other.limbs_.size() ? other.limbs_[i] : 0u);
        limbs_[i] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
    }
    trim();
    return *this;
}

WideInteger& WideInteger::operator-=(const WideInteger& other) {
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
        const std::uint64_t take = (i < other.limbs_.size() ? other.limbs_[i] : 0u) + borrow;
        borrow = limbs_[i] < take ? 1 : 0;
        limbs_[i] = static_cast<std::uint32_t>(limbs_[i] - take);
    }
    trim();
    return *this;
}

WideInteger WideInteger::operator*(const WideInteger& other) const {
    WideInteger result;
    result.limbs_.assign(limbs_.size() + other.limbs_.size(), 0);
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
        std::uint64_t carry = 0;
        for (std::size_t j = 0; j < other.limbs_.size() || carry != 0; ++j) {
            const std::uint64_t factor = j < other.limbs_.size() ? other.limbs_[j] : 0u;
            carry += result.limbs_[i + j] + limbs_[i] * factor;
            result.limbs_[i + j] = static_cast<std::uint32_t>(carry);
            carry >>= 32;
        }
    }
    result.trim();
    return result;
}

WideInteger WideInteger::operator<<(std::size_t bits) const {
    WideInteger result;
    if (is_zero()) return result;
    result.limbs_.assign(bits / 32 + limbs_.size() + 1, 0);
    const unsigned shift = bits % 32;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
        const std::uint64_t wide = std::uint64_t{limbs_[i]} << shift;
        result.limbs_[bits / 32 + i] |= static_cast<std::uint32_t>(wide);
        result.limbs_[bits / 32 + i + 1] |= static_cast<std::uint32_t>(wide >> 32);
    }
    result.trim();
    return result;
}

// Bit by bit from the top: keeps root² ≤ x and remainder = x − root².
WideInteger WideInteger::square_root(const WideInteger& x, bool& exact) {
    WideInteger root, remainder = x;
    for (std::size_t bit = (x.bit_count() + 1) / 2; bit-- > 0;) {
        // (root + 2^bit)² − root² = root·2^(bit+1) + 2^(2·bit)
        WideInteger step = root << (bit + 1);
        step += WideInteger(1) << (2 * bit);
        if (step.compare(remainder) > 0) continue;
        remainder -= step;
        root += WideInteger(1) << bit;
    }
    exact = remainder.is_zero();
    return root;
}

}  // namespace crofton::triangulate
