// A product of many positive numbers that neither overflows nor underflows: a double times a power
// of two of its own.
#pragma once

#include <cmath>
#include <cstdint>

namespace misbench {

// Real: the type of the significand. Factors are finite and >= 0; a factor of 0 makes the product 0
// for good.
template <class Real>
class ScaledProduct {
 public:
    ScaledProduct() = default;
    explicit ScaledProduct(Real value) { *this *= value; }

    ScaledProduct& operator*=(Real factor) {
        const Real product = significand_ * factor;
        if (product > kLow && product < kHigh) [[likely]] {
            significand_ = product;
        } else {
            multiply_with_care(factor);
        }
        return *this;
    }
    // REQUIRES: at most one of them is itself made by this function.
    friend ScaledProduct operator*(ScaledProduct a, const ScaledProduct& b) {
        a.significand_ *= b.significand_;
        a.exponent_ += b.exponent_;
        return a;
    }

    bool is_zero() const { return significand_ == 0; }
    // The product is significand() · 2^exponent(); the significand is 0 or within the range of its
    // type.
    Real significand() const { return significand_; }
    std::int64_t exponent() const { return exponent_; }

 private:
    // A quarter of the range of exponents on either side: three significands may be multiplied.
    static constexpr Real kHigh = sizeof(Real) == 8 ? Real(0x1p250) : Real(0x1p31);
    static constexpr Real kLow = 1 / kHigh;

    void multiply_with_care(Real factor) {
        int a = 0;
        int b = 0;
        significand_ = std::frexp(significand_, &a) * std::frexp(factor, &b);
        exponent_ = significand_ == 0 ? 0 : exponent_ + a + b;
    }

    Real significand_ = 1;
    std::int64_t exponent_ = 0;
};

}  // namespace misbench
