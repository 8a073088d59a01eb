#include "renderer/scene/microfacets.h"

namespace misbench {
namespace {

constexpr float kInvSqrtPi = 0.56418958354775628695F;

// erf⁻¹ to single precision by two polynomials in -log(1 - x²).                           [Gil10]
//
// [Gil10]  M. Giles, Approximating the erfinv function, 2010.
constexpr std::array kErfInverseCentral = {2.81022636e-08F,  3.43273939e-07F, -3.5233877e-06F,
                                           -4.39150654e-06F, 0.00021858087F,  -0.00125372503F,
                                           -0.00417768164F,  0.246640727F,    1.50140941F};
constexpr std::array kErfInverseTail = {-0.000200214257F, 0.000100950558F, 0.00134934322F,
                                        -0.00367342844F,  0.00573950773F,  -0.0076224613F,
                                        0.00943887047F,   1.00167406F,     2.83297682F};
float erf_inverse(float x) {
    const float w = -std::log((1 - x) * (1 + x));
    const bool central = w < 5;
    const auto& coefficients = central ? kErfInverseCentral : kErfInverseTail;
    const float t = central ? w - 2.5F : std::sqrt(w) - 3;
    float p = 0;
    for (const float c : coefficients) p = c + p * t;
    return p * x;
}

// The slope x, along wo, of a visible normal where alpha is 1: its density is proportional to
// max(0, 1 - x tan θ) exp(-x²). Solves with z = erf x for
//     1 + z + tan θ exp(-x²) / √π = u (the same at x = cot θ)
// by Newton's steps from the solution at grazing angles.                                  [Jak14]
float sample_visible_slope(float tan_theta, float u) {
    const float cot_theta = 1 / tan_theta;
    const float z_max = std::erf(cot_theta);
    const float target =
        u * (1 + z_max + kInvSqrtPi * tan_theta * std::exp(-cot_theta * cot_theta));
    float z = z_max - (1 + z_max) * std::erf(std::sqrt(-std::log(u)));
    for (int step = 0; step < 3; ++step) {
        z = std::clamp(z, -1 + 0x1p-24F, 1 - 0x1p-24F);
        const float x = erf_inverse(z);
        const float excess = 1 + z + kInvSqrtPi * tan_theta * std::exp(-x * x) - target;
        z -= excess / (1 - x * tan_theta);
    }
    z = std::clamp(z, -1 + 0x1p-24F, std::min(z_max, 1 - 0x1p-24F));
    return erf_inverse(z);
}

}  // namespace

Vec3 Beckmann::sample_visible(Vec3 wo, Vec2 u) const {
    // Away from 0 and 1, whose slopes are infinite.
    const auto inner = [](float v) { return std::clamp(v, 0x1p-24F, 1 - 0x1p-24F); };
    const float sin_wo = std::sqrt(wo.x * wo.x + wo.y * wo.y);
    const float along = sample_visible_slope(alpha * std::max(sin_wo / wo.z, 1e-6F), inner(u.x));
    const float across = erf_inverse(2 * inner(u.y) - 1);
    const Vec2 azimuth = sin_wo > 0 ? Vec2{wo.x / sin_wo, wo.y / sin_wo} : Vec2{1, 0};
    return normalized({-alpha * (azimuth.x * along - azimuth.y * across),
                       -alpha * (azimuth.y * along + azimuth.x * across), 1});
}

float Beckmann::visible_density_over_cosine(Vec3 wo, Vec3 h) const {
    const float a = cot_over_alpha(wo);
    // 1 + Λ(wo), which is 1 to a float's precision where a is large.                 [Hei14 (66)]
    const float visible = a > 4 ? 1 : 0.5F * (1 + std::erf(a) + kInvSqrtPi * std::exp(-a * a) / a);
    return density(h) / (visible * wo.z);
}

}  // namespace misbench
