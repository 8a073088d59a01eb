// [CK18], [PJH23]: see light_tree.h.
#include "renderer/scene/light_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "renderer/base/check.h"

namespace misbench {
namespace {

constexpr double kPiDouble = std::numbers::pi;

// Marks instead of a rank.
constexpr std::uint32_t kInfinite = ~0U;
constexpr std::uint32_t kNever = ~0U - 1;

// What is added to the bound of a cosine so that it stays one in spite of rounding. A node's axis
// and its cone's cosine and sine are rounded to float, which turns either by less than 2⁻²³ and
// changes their length by as little; where that misleads a comparison of cosines, the two differ
// by no more; merging cones errs by less than 2⁻²⁴. A cosine changes by no more than its angle, so
// all together stay below 2⁻²⁰. The rest is for the renderer's own cosine between a normal and a
// direction, both of float.
constexpr double kCosineSlack = 0x1p-17;

// Twice as many nodes have a 32-bit index.
constexpr std::size_t kMaxLights = std::size_t{1} << 31;
constexpr std::size_t kMaxSlices = 12;
// Below, a cluster is halved by number: bounds the recursion by this and the number's logarithm.
constexpr int kMaxSlicedDepth = 64;

struct Double3 {
    double x = 0, y = 0, z = 0;
};
Double3 to_double(Vec3 v) { return {double{v.x}, double{v.y}, double{v.z}}; }
Vec3 to_float(Double3 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Double3 operator*(double s, Double3 a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(Double3 a) { return std::sqrt(dot(a, a)); }
Double3 cross(Double3 a, Double3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Directions within an angle of an axis.
struct Cone {
    Double3 axis{0, 0, 1};
    double cos = -1, sin = 0;

    static Cone around(Double3 axis, double angle) {
        if (angle >= kPiDouble) return {};
        return {axis, std::cos(angle), std::sin(angle)};
    }
    double angle() const { return std::atan2(sin, cos); }
};

// A cone around two: the smallest one, or all directions where the axes are opposite.
Cone merge(const Cone& a, const Cone& b) {
    if (b.cos < a.cos) return merge(b, a);
    // One inside of the other: θ_d <= θ_a - θ_b, with what rounding leaves between equal ones.
    if (a.cos <= -1 || dot(a.axis, b.axis) >= a.cos * b.cos + a.sin * b.sin - 1e-15) return a;
    const double along = dot(a.axis, b.axis);
    const Double3 off_axis = b.axis - along * a.axis;
    const double across = length(off_axis);
    if (across < 1e-6) return {};
    const double theta = 0.5 * (a.angle() + std::atan2(across, along) + b.angle());
    const double turn = theta - a.angle();
    return Cone::around(std::cos(turn) * a.axis + (std::sin(turn) / across) * off_axis, theta);
}

double squared(double x) { return x * x; }

}  // namespace

// Lights while the hierarchy is built.
struct LightTree::Cluster {
    Vec3 lower, upper;
    Cone normals;
    double cos_emission = 1;  // >= 0
    double power = 0;         // 0: no light at all
    std::uint32_t light = 0;  // of a cluster of one

    static Cluster of(const LightBounds& light, std::uint32_t index, double power_unit);
    void add(const Cluster& other);
    double cost() const;
    Double3 centroid() const { return 0.5 * (to_double(lower) + to_double(upper)); }
    Node node() const;
    // Reorders the lights and returns how many come first; 0 where all have the same centroid.
    static std::size_t partition(std::span<Cluster> lights);
};

LightTree::Cluster LightTree::Cluster::of(const LightBounds& light, std::uint32_t index,
                                          double power_unit) {
    Cluster cluster;
    cluster.lower = light.lower;
    cluster.upper = light.upper;
    cluster.light = index;
    cluster.power = std::max(light.power / power_unit, double{std::numeric_limits<float>::min()});
    const double cos_normals = std::clamp(double{light.cos_normals}, -1.0, 1.0);
    const Double3 axis = to_double(light.axis);
    const double axis_length = length(axis);
    if (axis_length > 0) {
        cluster.normals = {(1 / axis_length) * axis, cos_normals,
                           std::sqrt(1 - squared(cos_normals))};
    }
    cluster.cos_emission = std::clamp(double{light.cos_emission}, 0.0, 1.0);
    // Light beyond the half space around a normal is a half space around some wider normals.
    if (light.cos_emission < 0) {
        const double beyond = std::acos(std::max(-1.0, double{light.cos_emission})) - kPiDouble / 2;
        cluster.normals = Cone::around(cluster.normals.axis, cluster.normals.angle() + beyond);
    }
    return cluster;
}

void LightTree::Cluster::add(const Cluster& other) {
    if (other.power == 0) return;
    if (power == 0) {
        *this = other;
        return;
    }
    lower = min(lower, other.lower);
    upper = max(upper, other.upper);
    normals = merge(normals, other.normals);
    cos_emission = std::min(cos_emission, other.cos_emission);
    power += other.power;
}

// Power × size² × measure of the directions that are lit [CK18], [PJH23 §12.6.3]. The square of
// the diagonal stands in for the surface of [CK18], which is 0 for all lights along a line.
double LightTree::Cluster::cost() const {
    const Double3 size = to_double(upper) - to_double(lower);
    const double theta_o = normals.angle();
    const double theta_w = std::min(theta_o + std::acos(cos_emission), kPiDouble);
    const double solid_angle = 2 * kPiDouble * (1 - normals.cos) +
                               kPiDouble / 2 *
                                   (2 * theta_w * normals.sin - std::cos(theta_o - 2 * theta_w) -
                                    2 * theta_o * normals.sin + normals.cos);
    return power * dot(size, size) * solid_angle;
}

LightTree::Node LightTree::Cluster::node() const {
    const Vec3 centre = to_float(centroid());
    const Double3 to_lower = to_double(centre) - to_double(lower);
    const Double3 to_upper = to_double(upper) - to_double(centre);
    const double radius = std::sqrt(squared(std::max(to_lower.x, to_upper.x)) +
                                    squared(std::max(to_lower.y, to_upper.y)) +
                                    squared(std::max(to_lower.z, to_upper.z)));
    // A point that is chosen on a light is a rounded sum of products of corners.
    constexpr double kEpsilon = double{std::numeric_limits<float>::epsilon()};
    const double rounding = 4 * kEpsilon * double{std::max(max_abs(lower), max_abs(upper))} +
                            double{std::numeric_limits<float>::min()};
    return {.centre = centre,
            .radius = static_cast<float>((1 + kEpsilon) * radius + rounding),
            .axis = to_float(normals.axis),
            .cos_normals = static_cast<float>(normals.cos),
            .sin_normals = static_cast<float>(normals.sin),
            .cos_emission = static_cast<float>(cos_emission),
            .power = static_cast<float>(power),
            .children = 0,
            .split = light};
}

namespace {

using Axes = std::array<double, 3>;
Axes axes(Double3 v) { return {v.x, v.y, v.z}; }

// Equal slices of the room between centroids, across one axis.
struct Slices {
    std::size_t axis = 0;
    double begin = 0, per_length = 0;
    std::size_t n = 0;

    std::size_t of(Double3 centroid) const {
        const double slice = (axes(centroid)[axis] - begin) * per_length;
        return std::min(static_cast<std::size_t>(slice), n - 1);
    }
};

}  // namespace

// Of all planes between slices, the one of least cost, where a thin slice of a long box costs more
// than its halves.                                                   [CK18], [PJH23 §12.6.3]
std::size_t LightTree::Cluster::partition(std::span<Cluster> lights) {
    Axes begin = axes(lights[0].centroid());
    Axes end = begin;
    Vec3 lower = lights[0].lower;
    Vec3 upper = lights[0].upper;
    for (const Cluster& light : lights) {
        const Axes c = axes(light.centroid());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            begin[axis] = std::min(begin[axis], c[axis]);
            end[axis] = std::max(end[axis], c[axis]);
        }
        lower = min(lower, light.lower);
        upper = max(upper, light.upper);
    }
    const Axes extent = axes(to_double(upper) - to_double(lower));
    const double largest_extent = *std::max_element(extent.begin(), extent.end());

    double least_cost = std::numeric_limits<double>::infinity();
    Slices best_slices;
    std::size_t best_plane = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(end[axis] > begin[axis])) continue;
        const std::size_t n = std::min(lights.size(), kMaxSlices);
        const Slices slices{axis, begin[axis], static_cast<double>(n) / (end[axis] - begin[axis]),
                            n};
        std::array<Cluster, kMaxSlices> bins;
        for (const Cluster& light : lights) bins[slices.of(light.centroid())].add(light);
        std::array<Cluster, kMaxSlices> behind;  // all from this slice on
        for (std::size_t i = n; i-- > 1;) {
            behind[i] = bins[i];
            if (i + 1 < n) behind[i].add(behind[i + 1]);
        }
        Cluster before;
        for (std::size_t plane = 1; plane < n; ++plane) {
            if (bins[plane - 1].power == 0) continue;  // parts as the plane before
            before.add(bins[plane - 1]);
            if (behind[plane].power == 0) break;
            const double cost =
                largest_extent / extent[axis] * (before.cost() + behind[plane].cost());
            if (cost < least_cost) {
                least_cost = cost;
                best_slices = slices;
                best_plane = plane;
            }
        }
    }
    if (best_plane == 0) return 0;
    const auto middle = std::partition(lights.begin(), lights.end(), [&](const Cluster& light) {
        return best_slices.of(light.centroid()) < best_plane;
    });
    return static_cast<std::size_t>(middle - lights.begin());
}

LightTree::LightTree(std::span<const LightBounds> lights) : ranks_(lights.size(), kNever) {
    MISBENCH_CHECK(lights.size() < kMaxLights);
    double strongest = 0;
    for (const LightBounds& light : lights) {
        if (!light.is_infinite) strongest = std::max(strongest, light.power);
    }
    std::vector<Cluster> finite;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (!(lights[i].power > 0)) continue;
        if (lights[i].is_infinite) {
            ranks_[i] = kInfinite;
            infinite_.push_back(i);
        } else {
            finite.push_back(Cluster::of(lights[i], i, strongest));
        }
    }
    if (finite.empty()) return;
    nodes_.reserve(2 * finite.size() - 1);
    nodes_.emplace_back();
    build(finite, 0, 0, 0);
}

// Fills in the node and all below it.
LightTree::Cluster LightTree::build(std::span<Cluster> lights, std::size_t node,
                                    std::uint32_t first_rank, int depth) {
    if (lights.size() == 1) {
        ranks_[lights[0].light] = first_rank;
        nodes_[node] = lights[0].node();
        return lights[0];
    }
    std::size_t n_first = 0;
    if (lights.size() > 2 && depth < kMaxSlicedDepth) n_first = Cluster::partition(lights);
    if (n_first == 0) n_first = lights.size() / 2;
    const std::size_t children = nodes_.size();
    nodes_.resize(children + 2);
    const auto split = static_cast<std::uint32_t>(first_rank + n_first);
    Cluster all = build(lights.first(n_first), children, first_rank, depth + 1);
    all.add(build(lights.subspan(n_first), children + 1, split, depth + 1));
    nodes_[node] = all.node();
    nodes_[node].children = static_cast<std::uint32_t>(children);
    nodes_[node].split = split;
    return all;
}

// Φ cos θ' / (d² + r²/3): θ' is the least angle to a normal at which a point of the sphere may send
// light to `from`.                                                  [CK18], [PJH23 §12.6.3]
// From afar that is Φ cos θ' / d²; 3 / r² is the mean of 1 / distance² over a sphere seen from its
// centre. [CK18] and [PJH23] keep d above the size of the box instead, which makes too little of
// the node that the point is in.
//
// d, r  distance of the sphere's centre, its radius
// θ     angle of `from` at the sphere's centre, from the cone's axis
// θ_o   half angle of the cone of normals
// θ_b   half angle of the sphere as seen from `from`;  θ' = max(0, θ - θ_o - θ_b)
double LightTree::Node::importance(Vec3 from) const {
    const Double3 v = to_double(from) - to_double(centre);
    const double d2 = dot(v, v);
    const double r2 = squared(double{radius});
    double cos_theta = 1;
    if (d2 > r2) {
        const double d = std::sqrt(d2);
        const Double3 a = to_double(axis);
        const double along = dot(a, v);  // d cos θ
        if (along < double{cos_normals} * d) {
            // Turn by θ_o: d cos and d sin of θ - θ_o. The cross product is exact near the axis.
            const double across = length(cross(a, v));
            const double x = along * double{cos_normals} + across * double{sin_normals};
            const double y = across * double{cos_normals} - along * double{sin_normals};
            // Turn by θ_b, of which d cos is the length of the tangent and d sin the radius.
            const double tangent = std::sqrt(d2 - r2);
            if (x < tangent) cos_theta = (x * tangent + y * double{radius}) / d2;
        }
    }
    const double bound = cos_theta + kCosineSlack;
    if (bound <= double{cos_emission}) return 0;
    return double{power} * std::min(bound, 1.0) / (d2 + r2 / 3);
}

LightTree::Branches LightTree::branches(const Node& node, Vec3 from) const {
    const Node& first = nodes_[node.children];
    const Node& second = nodes_[node.children + 1];
    double a = first.importance(from);
    double b = second.importance(from);
    if (a + b == 0) {
        a = double{first.power};
        b = double{second.power};
    }
    return {a / (a + b), b / (a + b)};
}

std::optional<LightChoice> LightTree::select(Vec3 from, double u) const {
    constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon() / 2;
    const bool is_reached = reaches(from);
    const std::size_t n_ways = infinite_.size() + (is_reached ? 1 : 0);
    if (n_ways == 0) return std::nullopt;
    double probability = 1 / static_cast<double>(n_ways);
    u *= static_cast<double>(n_ways);
    const std::size_t way = std::min(static_cast<std::size_t>(u), n_ways - 1);
    if (way < infinite_.size()) return LightChoice{infinite_[way], probability};

    // What is left of u after each choice is uniform again.
    u = std::min(u - static_cast<double>(way), kBelowOne);
    const Node* node = nodes_.data();
    while (node->children != 0) {
        const auto [first, second] = branches(*node, from);
        const bool is_first = u < first;
        u = std::min(is_first ? u / first : (u - first) / second, kBelowOne);
        probability *= is_first ? first : second;
        node = &nodes_[node->children + (is_first ? 0 : 1)];
    }
    return LightChoice{node->split, probability};
}

double LightTree::probability(std::uint32_t light, Vec3 from) const {
    const std::uint32_t rank = ranks_[light];
    if (rank == kNever) return 0;
    const bool is_reached = reaches(from);
    if (rank != kInfinite && !is_reached) return 0;
    double probability = 1 / static_cast<double>(infinite_.size() + (is_reached ? 1 : 0));
    if (rank == kInfinite) return probability;
    const Node* node = nodes_.data();
    while (node->children != 0) {
        const auto [first, second] = branches(*node, from);
        const bool is_first = rank < node->split;
        probability *= is_first ? first : second;
        node = &nodes_[node->children + (is_first ? 0 : 1)];
    }
    return probability;
}

}  // namespace misbench
