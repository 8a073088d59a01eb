// JSON as scene files have it (comments, trailing commas and a byte order mark are allowed), read
// so that every error names file and place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench {

// Throws InvalidArgument with file, line and column; NotFound.
nlohmann::json parse_json_file(const std::filesystem::path& file);

// A value and the place it stands at. Everything but the queries throws InvalidArgument where the
// value is not what is asked for. The JSON must outlive its nodes.
class JsonNode {
 public:
    JsonNode(const nlohmann::json& root, const std::filesystem::path& file)
        : JsonNode(&root, file.string(), "") {}

    [[noreturn]] void fail(const std::string& reason) const;

    bool has(const char* key) const;
    bool is_string() const;

    JsonNode operator[](const char* key) const;
    // The elements of an array; none when the key is missing.
    std::vector<JsonNode> list(const char* key) const;

    std::string string() const;
    std::string string_or(const char* key, const std::string& fallback) const;
    bool boolean_or(const char* key, bool fallback) const;
    float number() const;  // finite
    float number_or(const char* key, float fallback) const;
    float fraction_or(const char* key, float fallback) const;  // in [0, 1]
    std::vector<float> numbers(std::size_t multiple_of) const;
    Vec3 vec3() const;
    Vec3 vec3_or(const char* key, Vec3 fallback) const;
    // Whole numbers from 0 to below `end`.
    std::vector<std::uint32_t> indices(std::size_t end) const;

 private:
    JsonNode(const nlohmann::json* value, std::string file, std::string place)
        : value_(value), file_(std::move(file)), place_(std::move(place)) {}

    [[noreturn]] void fail_expecting(const std::string& what) const;
    const nlohmann::json& array() const;
    JsonNode element(std::size_t i) const;

    const nlohmann::json* value_;
    std::string file_;
    std::string place_;
};

}  // namespace misbench
