#include "renderer/scene/materials/plastic.h"

#include <utility>
#include <vector>

#include "renderer/math/warp.h"
#include "renderer/scene/refraction.h"

namespace misbench {
namespace {

float mean(Rgb color) { return (color.r + color.g + color.b) / 3; }

// What a base sends out of the coating, times π and the transmittances on both ways: light
// that meets the boundary from inside returns to the base again and again.
Rgb diffuse_through_coating(Rgb reflectance, float internal_reflectance, bool nonlinear,
                            float eta) {
    const auto channel = [&](float r) {
        return r / ((1 - (nonlinear ? r : 1) * internal_reflectance) * eta * eta);
    };
    return {channel(reflectance.r), channel(reflectance.g), channel(reflectance.b)};
}

// How often the specular lobe is chosen where the boundary reflects that much.
float specular_probability(float boundary, Rgb diffuse_reflectance, Rgb specular_reflectance) {
    const float specular = boundary * mean(specular_reflectance);
    const float diffuse = (1 - boundary) * mean(diffuse_reflectance);
    return specular > 0 ? specular / (specular + diffuse) : 0;
}

// Diffuse reflectance of the smooth boundary from inside, within 0.6 % for eta below 2 and 10 %
// below 5.                                                                             [EHR73]
float internal_diffuse_reflectance(float eta) {
    const float x = 1 / eta;
    return 0.6681F + 0.0636F * eta + x * (0.7099F - 1.4399F * x);
}

// Nodes and weights of Gauss and Legendre's rule of n points for [0, 1].
struct QuadratureNode {
    float x;
    double weight;
};
std::vector<QuadratureNode> gauss_legendre(int n) {
    std::vector<QuadratureNode> nodes;
    for (int i = 0; i < n; ++i) {
        // Newton's steps to the roots of P_n, from Tricomi's approximation of them.
        double x = std::cos(M_PI * (i + 0.75) / (n + 0.5));
        double derivative = 0;
        for (int step = 0; step < 5; ++step) {
            double before = 1;
            double p = x;
            for (int k = 2; k <= n; ++k) {
                before = std::exchange(p, ((2 * k - 1) * x * p - (k - 1) * before) / k);
            }
            derivative = n * (x * p - before) / (x * x - 1);
            x -= p / derivative;
        }
        nodes.push_back(
            {static_cast<float>(0.5 + 0.5 * x), 1 / ((1 - x * x) * derivative * derivative)});
    }
    return nodes;
}

// The mean of integrand(visible normal) over what is visible from wo.
template <class Facets, class Integrand>
float mean_over_visible(const Facets& facets, Vec3 wo, const std::vector<QuadratureNode>& nodes,
                        Integrand&& integrand) {
    double sum = 0;
    for (const QuadratureNode& a : nodes) {
        for (const QuadratureNode& b : nodes) {
            const Vec3 h = facets.sample_visible(wo, {a.x, b.x});
            sum += a.weight * b.weight * double{integrand(h)};
        }
    }
    return static_cast<float>(sum);
}

}  // namespace

PlasticMaterial::PlasticMaterial(const Parameters& parameters)
    : parameters_(parameters), internal_reflectance_(internal_diffuse_reflectance(parameters.eta)) {
    set_color(parameters.diffuse_reflectance);
}

void PlasticMaterial::set_color(Rgb color) {
    parameters_.diffuse_reflectance = color;
    base_ = diffuse_through_coating(color, internal_reflectance_, parameters_.nonlinear,
                                    parameters_.eta);
}

float PlasticMaterial::specular_probability(float boundary) const {
    return misbench::specular_probability(boundary, parameters_.diffuse_reflectance,
                                          parameters_.specular_reflectance);
}

BsdfValue PlasticMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    if (wi.z <= 0) return {};
    const float boundary_o = fresnel_dielectric(e.wo.z, parameters_.eta);
    const float boundary_i = fresnel_dielectric(wi.z, parameters_.eta);
    const float cosine = density_cosine_hemisphere(wi.z);
    return {(cosine * (1 - boundary_o) * (1 - boundary_i)) * base_,
            double{(1 - specular_probability(boundary_o)) * cosine}};
}

std::optional<BsdfSample> PlasticMaterial::sample(const Encounter& e, BsdfRandom u) const {
    const float boundary = fresnel_dielectric(e.wo.z, parameters_.eta);
    const float p_specular = specular_probability(boundary);
    if (u.lobe < p_specular) {
        return BsdfSample{.wi = {-e.wo.x, -e.wo.y, e.wo.z},
                          .weight = (boundary / p_specular) * parameters_.specular_reflectance,
                          .pdf = double{p_specular},
                          .is_delta = true};
    }
    const Vec3 wi = warp_cosine_hemisphere(u.direction);
    return sample_of(wi, evaluate(e, wi));
}

RoughPlasticMaterial::RoughPlasticMaterial(const Parameters& parameters) : parameters_(parameters) {
    // The table's cosines are 0, 1/63, …, 1, and the internal reflectance is their plain mean with
    // weights 2 cos θ: the definition of the renderer that images are compared with.
    constexpr float kLast = kTableSize - 1;
    const std::vector<QuadratureNode> nodes = gauss_legendre(32);
    const std::vector<QuadratureNode> more_nodes = gauss_legendre(64);  // across total reflection
    with_microfacets(parameters_.distribution, parameters_.alpha, [&](const auto& facets) {
        for (std::size_t i = 0; i < kTableSize; ++i) {
            const float cos_theta = std::max(1e-6F, static_cast<float>(i) / kLast);
            const Vec3 wo = {std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
            transmittance_[i] = mean_over_visible(facets, wo, nodes, [&](Vec3 h) {
                const std::optional<Vec3> wi = refracted(wo, h, parameters_.eta);
                if (!wi || wi->z >= 0) return 0.0F;
                return (1 - fresnel_dielectric(dot(wo, h), parameters_.eta)) * facets.masking(*wi);
            });
            const float from_inside = mean_over_visible(facets, wo, more_nodes, [&](Vec3 h) {
                const Vec3 wi = mirrored(wo, h);
                if (wi.z <= 0) return 0.0F;
                return fresnel_dielectric(dot(wo, h), 1 / parameters_.eta) * facets.masking(wi);
            });
            internal_reflectance_ += 2 * cos_theta * from_inside / kTableSize;
        }
    });
    set_color(parameters.diffuse_reflectance);
}

void RoughPlasticMaterial::set_color(Rgb color) {
    parameters_.diffuse_reflectance = color;
    base_ = diffuse_through_coating(color, internal_reflectance_, parameters_.nonlinear,
                                    parameters_.eta);
}

float RoughPlasticMaterial::transmittance(float cos_theta) const {
    const float x = cos_theta * (kTableSize - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(x), kTableSize - 2);
    const float t = x - static_cast<float>(i);
    return (1 - t) * transmittance_[i] + t * transmittance_[i + 1];
}

float RoughPlasticMaterial::specular_probability(float transmittance) const {
    return misbench::specular_probability(1 - transmittance, parameters_.diffuse_reflectance,
                                          parameters_.specular_reflectance);
}

BsdfValue RoughPlasticMaterial::evaluate(const Encounter& e, Vec3 wi) const {
    if (wi.z <= 0) return {};
    const Parameters& p = parameters_;
    const Vec3 h = normalized(e.wo + wi);
    const float transmittance_o = transmittance(e.wo.z);
    const float p_specular = specular_probability(transmittance_o);
    const float cosine = density_cosine_hemisphere(wi.z);
    const Rgb diffuse = (cosine * transmittance_o * transmittance(wi.z)) * base_;
    return with_microfacets(p.distribution, p.alpha, [&](const auto& facets) -> BsdfValue {
        const float specular = fresnel_dielectric(dot(wi, h), p.eta) * facets.density(h) *
                               facets.masking(e.wo) * facets.masking(wi) / (4 * e.wo.z);
        const float mirrored_density = 0.25F * facets.visible_density_over_cosine(e.wo, h);
        return {specular * p.specular_reflectance + diffuse,
                double{p_specular * mirrored_density + (1 - p_specular) * cosine}};
    });
}

std::optional<BsdfSample> RoughPlasticMaterial::sample(const Encounter& e, BsdfRandom u) const {
    if (u.lobe >= specular_probability(transmittance(e.wo.z))) {
        const Vec3 wi = warp_cosine_hemisphere(u.direction);
        return sample_of(wi, evaluate(e, wi));
    }
    const Vec3 h = with_microfacets(
        parameters_.distribution, parameters_.alpha,
        [&](const auto& facets) { return facets.sample_visible(e.wo, u.direction); });
    const Vec3 wi = mirrored(e.wo, h);
    return sample_of(wi, evaluate(e, wi));
}

}  // namespace misbench
