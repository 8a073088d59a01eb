// Light from infinitely far around the scene: a lat-long map, importance sampled.
//
// Local frame of the map: +Y up is the top row; the angle φ of a column is measured from +X
// towards +Z: u = φ / 2π, v = θ / π with θ from +Y.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/math/discrete_distribution.h"
#include "renderer/math/vec.h"

namespace misbench {

// The pixels of an image file, any that TextureImage reads, as linear radiance; 8- and 16-bit files
// are decoded from sRGB. Throws NotFound or InvalidArgument: file, reason; a pixel that is negative
// or not finite is one.
Image read_radiance_map(const std::filesystem::path& file);

struct EnvironmentDescription {
    // One pixel: constant radiance.
    std::shared_ptr<const Image> radiance{};
    enum class Filter : std::uint8_t {
        Nearest,   // a pixel covers its rectangle of u and v
        Bilinear,  // columns at pixel centres, around the seam; the first and last row are the
                   // poles
    };
    Filter filter = Filter::Nearest;
    // Columns are the world's directions of the map's axes: orthonormal, maybe mirrored.
    Transform to_world{};
};

class Environment {
 public:
    // Throws InvalidArgument where the radiance adds up to more than a number holds.
    // REQUIRES: description.radiance, of one pixel or more, none negative.
    explicit Environment(const EnvironmentDescription& description);

    // Radiance that arrives from direction w (unit, from the scene outwards).
    Rgb radiance(Vec3 w) const;

    struct Sample {
        Vec3 w;          // unit, from the scene outwards
        Rgb radiance;    // from there
        double pdf = 0;  // solid angle measure, > 0
    };
    // In proportion to luminance × solid angle of the map's cells, uniform by solid angle in a
    // cell. A cell is a pixel; for Bilinear the rectangle between four neighbouring pixels.
    // Radiance and pdf are those of the chosen cell. They are radiance(w) and pdf(w) too, unless
    // rounding w to floats carries it over the border of the cell.
    // A float has too few digits for large maps: the share of a cell that 24 of them make 1 / n
    // likely is wrong by n / 2²⁴.
    // REQUIRES: is_lit(); 0 <= u_row, u_column < 1.
    Sample sample(double u_row, double u_column) const;
    // Of sample() choosing w, solid angle measure.
    double pdf(Vec3 w) const;

    // Some direction has radiance above 0.
    bool is_lit() const;
    // ∫ radiance dω over the sphere: what a point in the open receives from all sides, W/m².
    Rgb total() const;
    bool is_constant() const;
    std::size_t n_bytes() const;

 private:
    // A place on the map: a cell, and where in it, in [0, 1]: s along φ, t along θ.
    struct Place {
        std::size_t row = 0;
        std::size_t column = 0;
        float s = 0;
        float t = 0;
    };
    struct Corners {
        Rgb top_left, top_right, bottom_left, bottom_right;
    };

    Place place_of(Vec3 w) const;
    Vec3 world_direction(double cos_theta, double sin_theta, double phi) const;
    Rgb pixel(std::size_t row, std::size_t column) const;
    Corners corners(std::size_t row, std::size_t column) const;
    Rgb radiance_at(const Place& place) const;
    double pdf_of_cell(std::size_t row, std::size_t column) const;
    // Mean over the cell's solid angle.
    double mean_luminance(std::size_t row, std::size_t column) const;
    double solid_angle(std::size_t row) const;  // of one cell

    std::shared_ptr<const Image> image_;
    EnvironmentDescription::Filter filter_;
    std::array<std::array<double, 3>, 3> to_world_{};  // rows of the rotation

    std::size_t n_columns_;  // of cells
    std::size_t n_rows_;
    std::vector<double> bottom_share_;  // of the lower pixels in a cell's mean, for every row

    DiscreteDistribution rows_;
    std::vector<DiscreteDistribution> columns_;  // for every row that is lit
    Rgb total_;
    double inverse_total_luminance_ = 0;  // 0: not lit
};

}  // namespace misbench
