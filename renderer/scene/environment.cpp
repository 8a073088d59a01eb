// θ    angle from the map's +Y, 0 on top; φ angle from +X towards +Z
// Δθ   height of a row of cells, Δφ width of a column of cells
//
// Nearest: cell (r, c) is pixel (r, c), its upper left corner at θ = r Δθ, φ = c Δφ.
// Bilinear: cell (r, c) lies between pixels (r, c) and (r + 1, c + 1), its upper left corner at
// θ = r Δθ, φ = (c + ½) Δφ; there is a row of cells fewer than of pixels.
//
// All angles are double: a cell of a large map is not much larger than the steps of float.
#include "renderer/scene/environment.h"

#include <cmath>
#include <numbers>
#include <string>

#include "renderer/base/error.h"
#include "renderer/scene/texture.h"

namespace misbench {
namespace {

constexpr double kPiDouble = std::numbers::pi;

// Above 0 wherever the radiance is: the luminance of the smallest floats is rounded to 0.
double positive_luminance(Rgb radiance) {
    return std::max(double{luminance(radiance)}, radiance == Rgb{} ? 0.0 : 0x1p-149);
}

// The part of the lower edge's value in the mean of a function that is linear in θ from one edge
// of a row to the other: with h = Δθ/2 and θ_m the middle,
// ∫ (½ + x/Δθ) sin(θ_m + x) dx / ∫ sin(θ_m + x) dx, x from -h to h.
double bottom_share(double theta_middle, double h) {
    return 0.5 + (std::sin(h) - h * std::cos(h)) / (2 * h * std::sin(h) * std::tan(theta_middle));
}

// A sum of colours in double.
struct RgbSum {
    double r = 0, g = 0, b = 0;
    void add(double factor, Rgb color) {
        r += factor * double{color.r};
        g += factor * double{color.g};
        b += factor * double{color.b};
    }
};

std::size_t cell_at(double position, std::size_t n) {
    return std::min(static_cast<std::size_t>(position), n - 1);
}

}  // namespace

Image read_radiance_map(const std::filesystem::path& file) {
    const TextureImage texture = TextureImage::read(file, TextureImage::Encoding::Srgb);
    Image image(texture.width(), texture.height());
    std::size_t i = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Rgb color = texture.color(x, y);
            for (const float value : {color.r, color.g, color.b}) {
                if (value < 0) {
                    throw Error(Errc::InvalidArgument,
                                "radiance map '" + file.string() + "': pixel (" +
                                    std::to_string(x) + ", " + std::to_string(y) +
                                    ") has the negative value " + std::to_string(value));
                }
                image.rgb[i++] = value;
            }
        }
    }
    return image;
}

Environment::Environment(const EnvironmentDescription& description)
    : image_(description.radiance),
      filter_(description.filter),
      n_columns_(static_cast<std::size_t>(image_->width)),
      n_rows_(static_cast<std::size_t>(image_->height)) {
    // Between the poles of a single row there is one row of cells.
    if (filter_ == EnvironmentDescription::Filter::Bilinear && n_rows_ > 1) --n_rows_;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            to_world_[i][k] = double{description.to_world.rows[i][k]};
        }
    }
    const double h = kPiDouble / (2 * static_cast<double>(n_rows_));
    for (std::size_t row = 0; row < n_rows_; ++row) {
        bottom_share_.push_back(bottom_share(h * static_cast<double>(2 * row + 1), h));
    }

    RgbSum total;
    double total_luminance = 0;
    std::vector<double> row_weights(n_rows_);
    std::vector<double> weights(n_columns_);
    columns_.resize(n_rows_);
    for (std::size_t row = 0; row < n_rows_; ++row) {
        const double omega = solid_angle(row);
        const double bottom = bottom_share_[row];
        double sum = 0;
        for (std::size_t column = 0; column < n_columns_; ++column) {
            weights[column] = omega * mean_luminance(row, column);
            sum += weights[column];
            const Corners c = corners(row, column);
            for (const Rgb color : {c.top_left, c.top_right}) {
                total.add(omega * (1 - bottom) / 2, color);
            }
            for (const Rgb color : {c.bottom_left, c.bottom_right}) {
                total.add(omega * bottom / 2, color);
            }
        }
        row_weights[row] = sum;
        total_luminance += sum;
        if (sum > 0) columns_[row] = DiscreteDistribution(weights);
    }
    total_ = {static_cast<float>(total.r), static_cast<float>(total.g),
              static_cast<float>(total.b)};
    if (!std::isfinite(max_channel(total_))) {
        throw Error(Errc::InvalidArgument,
                    "environment: its radiance adds up to more than a number holds");
    }
    if (total_luminance > 0) {
        rows_ = DiscreteDistribution(row_weights);
        inverse_total_luminance_ = 1 / total_luminance;
    }
}

Rgb Environment::radiance(Vec3 w) const {
    return is_constant() ? pixel(0, 0) : radiance_at(place_of(w));
}

Environment::Sample Environment::sample(double u_row, double u_column) const {
    // Choose a row of cells, then a cell in it.
    const std::uint32_t row = rows_.select(u_row).index;
    const std::uint32_t column = columns_[row].select(u_column).index;
    const double v = rows_.rest(u_row, row);
    const double s = columns_[row].rest(u_column, column);

    // Choose a direction uniform by solid angle in the cell: uniform in cos θ and in φ.
    const double height = kPiDouble / static_cast<double>(n_rows_);
    const double theta0 = height * static_cast<double>(row);
    const double cos0 = std::cos(theta0);
    const double cos1 = std::cos(theta0 + height);
    const double cos_theta = cos0 + v * (cos1 - cos0);
    const double sin_theta = std::sqrt((1 - cos_theta) * (1 + cos_theta));
    const double offset = filter_ == EnvironmentDescription::Filter::Bilinear ? 0.5 : 0;
    const double phi = 2 * kPiDouble * (static_cast<double>(column) + offset + s) /
                       static_cast<double>(n_columns_);
    const double t = (std::atan2(sin_theta, cos_theta) - theta0) / height;
    const Place place{row, column, static_cast<float>(s),
                      static_cast<float>(std::clamp(t, 0.0, 1.0))};
    return {world_direction(cos_theta, sin_theta, phi), radiance_at(place),
            pdf_of_cell(row, column)};
}

double Environment::pdf(Vec3 w) const {
    if (is_constant()) return pdf_of_cell(0, 0);
    const Place place = place_of(w);
    return pdf_of_cell(place.row, place.column);
}

bool Environment::is_lit() const { return inverse_total_luminance_ > 0; }
Rgb Environment::total() const { return total_; }
bool Environment::is_constant() const { return image_->n_pixels() == 1; }

std::size_t Environment::n_bytes() const {
    std::size_t n = sizeof *this + image_->rgb.size() * sizeof(float) +
                    bottom_share_.size() * sizeof(double) + rows_.n_bytes();
    for (const DiscreteDistribution& columns : columns_) n += sizeof columns + columns.n_bytes();
    return n;
}

Environment::Place Environment::place_of(Vec3 w) const {
    const auto local = [&](std::size_t axis) {
        return to_world_[0][axis] * double{w.x} + to_world_[1][axis] * double{w.y} +
               to_world_[2][axis] * double{w.z};
    };
    const double x = local(0);
    const double y = local(1);
    const double z = local(2);
    // Unlike acos, the arc tangent is exact near the poles too.
    const double theta = std::atan2(std::sqrt(x * x + z * z), y);
    const double phi = std::atan2(z, x);
    const double v = theta / kPiDouble * static_cast<double>(n_rows_);
    double u = phi / (2 * kPiDouble) * static_cast<double>(n_columns_);
    if (filter_ == EnvironmentDescription::Filter::Bilinear) u -= 0.5;
    if (u < 0) u += static_cast<double>(n_columns_);
    Place place;
    place.row = cell_at(v, n_rows_);
    place.column = cell_at(u, n_columns_);
    place.s = static_cast<float>(u - static_cast<double>(place.column));
    place.t = static_cast<float>(v - static_cast<double>(place.row));
    return place;
}

Vec3 Environment::world_direction(double cos_theta, double sin_theta, double phi) const {
    const double x = sin_theta * std::cos(phi);
    const double z = sin_theta * std::sin(phi);
    const auto world = [&](const std::array<double, 3>& row) {
        return static_cast<float>(row[0] * x + row[1] * cos_theta + row[2] * z);
    };
    return {world(to_world_[0]), world(to_world_[1]), world(to_world_[2])};
}

Rgb Environment::pixel(std::size_t row, std::size_t column) const {
    const float* rgb = &image_->rgb[3 * (row * n_columns_ + column)];
    return {rgb[0], rgb[1], rgb[2]};
}

Environment::Corners Environment::corners(std::size_t row, std::size_t column) const {
    if (filter_ == EnvironmentDescription::Filter::Nearest) {
        const Rgb color = pixel(row, column);
        return {color, color, color, color};
    }
    const std::size_t right = column + 1 == n_columns_ ? 0 : column + 1;
    const std::size_t below = image_->height == 1 ? row : row + 1;
    return {pixel(row, column), pixel(row, right), pixel(below, column), pixel(below, right)};
}

Rgb Environment::radiance_at(const Place& place) const {
    if (filter_ == EnvironmentDescription::Filter::Nearest) return pixel(place.row, place.column);
    const Corners c = corners(place.row, place.column);
    return lerp(place.t, lerp(place.s, c.top_left, c.top_right),
                lerp(place.s, c.bottom_left, c.bottom_right));
}

double Environment::pdf_of_cell(std::size_t row, std::size_t column) const {
    return mean_luminance(row, column) * inverse_total_luminance_;
}

double Environment::mean_luminance(std::size_t row, std::size_t column) const {
    if (filter_ == EnvironmentDescription::Filter::Nearest) {
        return positive_luminance(pixel(row, column));
    }
    const Corners c = corners(row, column);
    const double bottom = bottom_share_[row];
    return (1 - bottom) / 2 * (positive_luminance(c.top_left) + positive_luminance(c.top_right)) +
           bottom / 2 * (positive_luminance(c.bottom_left) + positive_luminance(c.bottom_right));
}

double Environment::solid_angle(std::size_t row) const {
    // Δφ (cos θ - cos(θ + Δθ)), without cancellation near the poles.
    const double h = kPiDouble / (2 * static_cast<double>(n_rows_));
    return 2 * kPiDouble / static_cast<double>(n_columns_) * 2 *
           std::sin(h * static_cast<double>(2 * row + 1)) * std::sin(h);
}

}  // namespace misbench
