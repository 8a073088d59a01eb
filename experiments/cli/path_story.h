// What happened in one pixel of a pass: every sample with its path, densities and weight.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "renderer/paths/pixel_trace.h"

namespace misbench {

using RgbSum = std::array<double, 3>;

// Those that matter most first: not finite, then by weighted value; as they came where equal.
std::vector<KeptSample> by_weighted_value(std::vector<KeptSample> samples);

// Σ weight · value.
RgbSum weighted_sum(std::span<const KeptSample> samples);

std::string rgb_to_text(const RgbSum& rgb);
std::string story_to_text(std::span<const KeptSample> samples, const Scene& scene);

// Numbers that are not finite are the texts "nan", "inf" and "-inf".
nlohmann::ordered_json rgb_to_json(const RgbSum& rgb);
nlohmann::ordered_json story_to_json(std::span<const KeptSample> samples, const Scene& scene);

}  // namespace misbench
