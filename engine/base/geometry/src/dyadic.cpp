// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/geometry/dyadic.hpp>

namespace crofton {

Dyadic::Dyadic(double value) {
    if (value == 0.0) return;
    int binary_exponent = 0;
    const double fraction = std::frexp(std::fabs(value), &binary_exponent);
    const auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    const int lowest = binary_exponent - 53;
    const int shift = ((lowest % 32) + 32) % 32;
    sign_ = value < 0.0 ? -1 : 1;
    exponent_ = (lowest - shift) / 32;
    limbs_[0] = static_cast<std::uint32_t>(mantissa << shift);
    limbs_[1] = static_cast<std::uint32_t>((mantissa << shift) >> 32);
    limbs_[2] = shift == 0 ? 0 : static_cast<std::uint32_t>(mantissa >> (64 - shift));
    count_ = 3;
    trim();
}

double Dyadic::scaled(int exponent) const {
    double top = 0.0;
    for (std::uint32_t i = count_; i-- > (count_ > 3 ? count_ - 3 : 0);)
        top += std::ldexp(static_cast<double>(limbs_[i]), 32 * (exponent_ + static_cast<std::int32_t>(i)) - exponent);
    return sign_ < 0 ? -top : top;
}

void Dyadic::copy(const Dyadic& other) {
    sign_ = other.sign_;
    exponent_ = other.exponent_;
    count_ = other.count_;
    std::copy_n(other.limbs_.begin(), count_, limbs_.begin());
}

void Dyadic::trim() {
    while (count_ > 0 && limbs_[count_ - 1] == 0) --count_;
    std::uint32_t zeros = 0;
    while (zeros < count_ && limbs_[zeros] == 0) ++zeros;
    if (zeros > 0) {
        std::copy(limbs_.begin() + zeros, limbs_.begin() + count_, limbs_.begin());
        count_ -= zeros;
        exponent_ += static_cast<std::int32_t>(zeros);
    }
    if (count_ == 0) sign_ = 0, exponent_ = 0;
}

std::uint32_t Dyadic::limb_at(std::int32_t position) const {
    const std::int32_t index = position - exponent_;
    return index >= 0 && index < static_cast<std::int32_t>(count_) ? limbs_[static_cast<std::uint32_t>(index)] : 0;
}

int Dyadic::compare_magnitudes(const Dyadic& a, const Dyadic& b) {
    const std::int32_t top_a = a.exponent_ + static_cast<std::int32_t>(a.count_);
    const std::int32_t top_b = b.exponent_ + static_cast<std::int32_t>(b.count_);
    if (top_a != top_b) return top_a < top_b ? -1 : 1;
    for (std::int32_t p = top_a - 1; p >= std::min(a.exponent_, b.exponent_); --p)
        if (a.limb_at(p) != b.limb_at(p)) return a.limb_at(p) < b.limb_at(p) ? -1 : 1;
    return 0;
}

Dyadic Dyadic::add_magnitudes(const Dyadic& a, const Dyadic& b) {
    Dyadic sum;
    sum.sign_ = 1;
    sum.exponent_ = std::min(a.exponent_, b.exponent_);
    const std::int32_t top =
        std::max(a.exponent_ + static_cast<std::int32_t>(a.count_), b.exponent_ + static_cast<std::int32_t>(b.count_));
    CROFTON_ASSERT(top - sum.exponent_ < static_cast<std::int32_t>(kMaxLimbs),
                   "Dyadic: inputs beyond the documented range");
    std::uint64_t carry = 0;
    for (std::int32_t p = sum.exponent_; p < top; ++p) {
        carry += std::uint64_t{a.limb_at(p)} + b.limb_at(p);
        sum.limbs_[sum.count_++] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
    }
    sum.limbs_[sum.count_++] = static_cast<std::uint32_t>(carry);
    sum.trim();
    return sum;
}

Dyadic Dyadic::subtract_magnitudes(const Dyadic& larger, const Dyadic& smaller) {
    Dyadic difference;
    difference.sign_ = 1;
    difference.exponent_ = std::min(larger.exponent_, smaller.exponent_);
    const std::int32_t top = larger.exponent_ + static_cast<std::int32_t>(larger.count_);
    CROFTON_ASSERT(top - difference.exponent_ < static_cast<std::int32_t>(kMaxLimbs),
                   "Dyadic: inputs beyond the documented range");
    std::uint64_t borrow = 0;
    for (std::int32_t p = difference.exponent_; p < top; ++p) {
        const std::uint64_t step = std::uint64_t{larger.limb_at(p)} - smaller.limb_at(p) - borrow;
        difference.limbs_[difference.count_++] = static_cast<std::uint32_t>(step);
        borrow = step >> 63;
    }
    difference.trim();
    return difference;
}

Dyadic Dyadic::operator-() const {
    Dyadic result(*this);
    result.sign_ = -result.sign_;
    return result;
}

Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.sign_ == 0) return b;
    if (b.sign_ == 0) return a;
    if (a.sign_ == b.sign_) {
        Dyadic sum = Dyadic::add_magnitudes(a, b);
        sum.sign_ = a.sign_;
        return sum;
    }
    const int order = Dyadic::compare_magnitudes(a, b);
    if (order == 0) return {};
    Dyadic difference = order > 0 ? Dyadic::subtract_magnitudes(a, b) : Dyadic::subtract_magnitudes(b, a);
    difference.sign_ = order > 0 ? a.sign_ : b.sign_;
    return difference;
}

Dyadic operator-(const Dyadic& a, const Dyadic& b) {
    return a + (-b);
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic product;
    if (a.sign_ == 0 || b.sign_ == 0) return product;
    CROFTON_ASSERT(a.count_ + b.count_ <= Dyadic::kMaxLimbs, "Dyadic: inputs beyond the documented range");
    product.sign_ = a.sign_ * b.sign_;
    product.exponent_ = a.exponent_ + b.exponent_;
    product.count_ = a.count_ + b.count_;
    std::fill_n(product.limbs_.begin(), product.count_, 0u);
    for (std::uint32_t i = 0; i < a.count_; ++i) {
        std::uint64_t carry = 0;
        for (std::uint32_t j = 0; j < b.count_; ++j) {
            carry += std::uint64_t{a.limbs_[i]} * b.limbs_[j] + product.limbs_[i + j];
            product.limbs_[i + j] = static_cast<std::uint32_t>(carry);
            carry >>= 32;
        }
        product.limbs_[i + b.count_] = static_cast<std::uint32_t>(carry);
    }
    product.trim();
    return product;
}

}  // namespace crofton
