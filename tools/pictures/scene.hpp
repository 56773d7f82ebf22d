// tools - draw_scene: a photo-like picture in pure code, for demonstrations, tests and benchmarks that need no file.
//
// A still life by a window, traced at 3 x 3 rays a pixel: smooth shading, sharp edges, soft shadows of an area light,
// some texture. Objects are signed distances inside bounding spheres; wood, cloth and plaster are value noise.
// Deterministic. Units: about 15 cm; x right, y up, z away from the camera. Costs about 15 us a pixel.
#ifndef HMESH_TOOLS_SCENE_HPP
#define HMESH_TOOLS_SCENE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"

namespace tool {
namespace scene {

struct Vec {
    double x = 0, y = 0, z = 0;
};
inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Vec a, Vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec a) { return std::sqrt(dot(a, a)); }
inline double length(double x, double y) { return std::sqrt(x * x + y * y); }
inline Vec normalized(Vec a) { return (1 / length(a)) * a; }
inline double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }
inline double mix(double a, double b, double t) { return a + t * (b - a); }
inline Vec mix(Vec a, Vec b, double t) { return a + t * (b - a); }
// 0 up to a, 1 from b on, smooth between.
inline double step(double a, double b, double x) {
    const double t = clamp((x - a) / (b - a), 0, 1);
    return t * t * (3 - 2 * t);
}
inline double smooth_min(double a, double b, double k) {
    const double h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1);
    return mix(b, a, h) - k * h * (1 - h);
}

// ---- noise ----------------------------------------------------------------------------------------------------------

inline std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c = 0) {
    std::uint32_t h = a * 0x9e3779b1U ^ b * 0x85ebca77U ^ c * 0xc2b2ae3dU;
    h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
    h = (h ^ (h >> 12)) * 0x297a2d39U;
    return h ^ (h >> 15);
}
inline double unit(std::uint32_t h) { return (h + 0.5) / 4294967296.0; }

inline double lattice(double x, double y) {
    return unit(hash(static_cast<std::uint32_t>(static_cast<std::int64_t>(x)),
                     static_cast<std::uint32_t>(static_cast<std::int64_t>(y)), 7));
}
// Value noise in [0, 1], one bump a unit.
inline double noise(double x, double y) {
    const double i = std::floor(x), j = std::floor(y);
    const double u = step(0, 1, x - i), v = step(0, 1, y - j);
    return mix(mix(lattice(i, j), lattice(i + 1, j), u), mix(lattice(i, j + 1), lattice(i + 1, j + 1), u), v);
}
inline double fractal(double x, double y, int octaves) {
    double sum = 0, weight = 0.5;
    for (int k = 0; k < octaves; ++k, weight /= 2, x = 2.03 * x + 17.3, y = 2.03 * y + 9.1) sum += weight * noise(x, y);
    return sum / (1 - weight);  // which stays below 1: the weights' sum is 1 - 2 weight
}

// ---- objects --------------------------------------------------------------------------------------------------------

enum class Surface { table, wall, window, orange, pear, mug, book, cherry, leaf, ball };

struct Object {
    Surface surface;
    Vec center;           // the origin of the object's own coordinates
    double cosine, sine;  // of its turn about the vertical
    Vec middle;           // of the bounding sphere, from the center
    double radius;        // of the bounding sphere
};

inline constexpr Object objects[] = {
    {Surface::book, {-1.35, 0, 0.55}, 0.96, 0.28, {0, 0.14, 0}, 1.42},
    {Surface::mug, {-1.40, 0.27, 0.60}, 0.8, 0.6, {0, 0.65, 0}, 1.18},
    {Surface::pear, {0.28, 0, 0.45}, 1, 0, {0, 0.98, 0}, 1.08},
    {Surface::orange, {1.36, 0, -0.10}, 0.96, 0.28, {0, 0.56, 0}, 0.60},
    {Surface::cherry, {-0.42, 0, -1.12}, 1, 0, {0.1, 0.48, 0.1}, 0.82},
    {Surface::ball, {0.52, 0, -1.42}, 1, 0, {0, 0.23, 0}, 0.24},
    {Surface::leaf, {1.50, 0, -1.55}, 0.88, -0.475, {0, 0.05, 0}, 0.66},
};

inline Vec turned(const Object& object, Vec p) {
    return {object.cosine * p.x + object.sine * p.z, p.y, object.cosine * p.z - object.sine * p.x};
}
inline Vec to_own(const Object& object, Vec p) { return turned(object, p - object.center); }

inline double capsule(Vec p, Vec a, Vec b, double radius) {
    const Vec along = b - a;
    const double t = clamp(dot(p - a, along) / dot(along, along), 0, 1);
    return length(p - a - t * along) - radius;
}
inline double box(Vec p, Vec half, double round) {
    const Vec q{std::abs(p.x) - half.x + round, std::abs(p.y) - half.y + round, std::abs(p.z) - half.z + round};
    const double outside = length(Vec{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
    return outside + std::min(std::max(q.x, std::max(q.y, q.z)), 0.0) - round;
}

inline double mug_distance(Vec p) {
    const double r = length(p.x, p.z);
    const double side = r - (0.60 + 0.03 * p.y), dy = std::abs(p.y - 0.65) - 0.62;
    const double outer = std::min(std::max(side, dy), 0.0) + length(std::max(side, 0.0), std::max(dy, 0.0)) - 0.03;
    const double inner = std::max(side + 0.05, 0.09 - p.y);
    const double shell = -smooth_min(-outer, inner, 0.03);
    const double hx = p.x + 0.66, hy = p.y - 0.66;
    const double handle = std::max(length(length(hx, 0.9 * hy) - 0.32, 0.8 * p.z) - 0.075, r > 0.6 ? -1 : 0.62 - r);
    return smooth_min(shell, handle, 0.05);
}
inline double pear_distance(Vec p) {
    const double body = smooth_min(length(p - Vec{0, 0.62, 0}) - 0.62, length(p - Vec{0.03, 1.36, 0}) - 0.28, 0.42);
    return smooth_min(body, capsule(p, {0.04, 1.6, 0}, {0.14, 1.93, -0.05}, 0.028), 0.05);
}
inline double cherry_distance(Vec p) {
    const double left = length(p - Vec{-0.2, 0.25, 0}) - 0.25 +
                        0.05 * std::exp(-40 * (p.x + 0.2) * (p.x + 0.2) - 40 * p.z * p.z) * step(0.3, 0.5, p.y);
    const double right = length(p - Vec{0.36, 0.23, 0.12}) - 0.23;
    const double stems = std::min(
        std::min(capsule(p, {-0.2, 0.44, 0}, {-0.06, 0.8, 0.1}, 0.014), capsule(p, {-0.06, 0.8, 0.1}, {0.2, 1.16, 0.3}, 0.014)),
        std::min(capsule(p, {0.36, 0.42, 0.12}, {0.34, 0.8, 0.2}, 0.014), capsule(p, {0.34, 0.8, 0.2}, {0.2, 1.16, 0.3}, 0.014)));
    return std::min(std::min(left, right), std::min(stems, length(p - Vec{0.2, 1.17, 0.3}) - 0.035));
}
inline double leaf_distance(Vec p) {
    const double across = length(std::abs(p.z) + 0.42, p.x) - 0.68;  // two arcs that meet at the tips
    const double height = 0.02 + 0.22 * p.x * p.x + 0.5 * p.z * p.z * (1 + p.x) - 0.02 * std::exp(-900 * p.z * p.z);
    const double blade = std::max(across, std::abs(p.y - height) - 0.008);
    return 0.75 * std::min(blade, capsule(p, {0.5, 0.075, 0}, {0.64, 0.02, 0.05}, 0.014));
}

// The signed distance (or a little less) to an object, in its own coordinates.
inline double distance(Surface surface, Vec p) {
    switch (surface) {
        case Surface::book: {
            const double cover = box(p - Vec{0, 0.135, 0}, {1.12, 0.135, 0.8}, 0.03);
            const double pages = box(p - Vec{0.06, 0.135, 0}, {1.2, 0.095, 0.9}, 0.0);
            return std::max(cover, -std::max(pages, -box(p - Vec{0, 0.135, 0}, {1.07, 0.12, 0.75}, 0.0)));
        }
        case Surface::mug: return mug_distance(p);
        case Surface::pear: return 0.9 * pear_distance(p);
        case Surface::orange:
            return length(p - Vec{0, 0.56, 0}) - 0.57 + 0.03 * std::exp(-30 * (p.x * p.x + p.z * p.z)) * step(0.6, 1, p.y);
        case Surface::cherry: return cherry_distance(p);
        case Surface::leaf: return leaf_distance(p);
        default: return length(p - Vec{0, 0.23, 0}) - 0.23;
    }
}

// ---- rays -----------------------------------------------------------------------------------------------------------

struct Hit {
    double t = 1e9;
    Surface surface = Surface::wall;
    const Object* object = nullptr;
};

inline constexpr double wall_z = 3.4;
// The window: a rectangle of light to the left, seen in reflections and never directly.
inline constexpr Vec window_corner{-4.3, 2.5, -0.9}, window_u{0.5, 0, 2.2}, window_v{0, 2.5, 0};

// Finds whether the ray hits the object before `most`; sets it to where.
inline bool meet(const Object& object, Vec from, Vec along, double& most) {
    const Vec m = from - object.center - object.middle;
    const double b = dot(m, along), disc = b * b - dot(m, m) + object.radius * object.radius;
    if (disc <= 0) return false;
    const double root = std::sqrt(disc), end = std::min(most, root - b);
    double t = std::max(1e-3, -b - root);
    if (t >= end) return false;
    const Vec o = to_own(object, from), d = turned(object, along);
    for (int k = 0; k < 160 && t < end; ++k) {
        const double gap = distance(object.surface, o + t * d);
        if (gap < 4e-4) {
            most = t;
            return true;
        }
        t += 0.95 * gap;
    }
    return false;
}

inline bool is_blocked(Vec from, Vec along, double most) {
    for (const Object& object : objects)
        if (meet(object, from, along, most)) return true;
    return false;
}

inline Hit find_hit(Vec from, Vec along) {
    Hit hit;
    if (along.y < 0 && from.y > 1e-4) hit = {-from.y / along.y, Surface::table, nullptr};
    if (const double t = (wall_z - from.z) / along.z; t > 1e-3 && t < hit.t) hit = {t, Surface::wall, nullptr};
    const Vec normal = normalized(cross(window_u, window_v));
    if (const double t = dot(window_corner - from, normal) / dot(along, normal); t > 1e-3 && t < hit.t) {
        const Vec q = from + t * along - window_corner;
        const double u = dot(q, window_u) / dot(window_u, window_u), v = dot(q, window_v) / dot(window_v, window_v);
        if (u > 0 && u < 1 && v > 0 && v < 1) hit = {t, Surface::window, nullptr};
    }
    for (const Object& object : objects)
        if (meet(object, from, along, hit.t)) {
            hit.surface = object.surface;
            hit.object = &object;
        }
    return hit;
}

inline Vec normal_at(const Object& object, Vec p) {
    const double e = 6e-4;
    const auto value = [&](Vec shift) { return distance(object.surface, to_own(object, p + e * shift)); };
    const Vec a{1, -1, -1}, b{-1, -1, 1}, c{-1, 1, -1}, d{1, 1, 1};
    return normalized(value(a) * a + value(b) * b + value(c) * c + value(d) * d);
}

// How much of the surroundings a surface point sees: short steps along the normal and what blocks them.
inline double openness(Vec p, Vec normal) {
    double closed = 0;
    for (int k = 1; k <= 5; ++k) {
        const double h = 0.11 * k;
        const Vec q = p + h * normal;
        double gap = std::min(std::max(q.y, 0.0), wall_z - q.z);
        for (const Object& object : objects) {
            const double bound = length(q - object.center - object.middle) - object.radius;
            gap = std::min(gap, bound > gap ? bound : distance(object.surface, to_own(object, q)));
        }
        closed += std::max(0.0, h - gap) * std::pow(0.62, k);
    }
    return clamp(1 - 1.55 * closed, 0.06, 1);
}

// ---- materials ------------------------------------------------------------------------------------------------------

struct Material {
    Vec color;          // albedo, linear light
    double mirror = 0;  // reflectance at right angles; 0: no reflection
    double gloss = 1;   // how much of the reflection is seen
};

inline Material wood(Vec p, Vec& normal) {
    const double plank = std::floor((p.z + 20.3) / 1.15), seam = std::abs((p.z + 20.3) / 1.15 - plank - 0.5);
    const double shift = 37.0 * plank;
    const double bend = fractal(0.35 * p.x + shift, 0.9 * p.z, 3);
    const double ring = 0.5 + 0.5 * std::sin(26 * (p.z + 0.9 * bend + 0.1 * p.x) + shift);
    const double fiber = fractal(1.1 * p.x + shift, 26 * p.z + 3 * bend, 3);
    Vec color = mix({0.36, 0.19, 0.085}, {0.20, 0.088, 0.036}, clamp(0.5 * ring * ring + 0.75 * fiber - 0.1, 0, 1));
    color = (0.85 + 0.3 * unit(hash(static_cast<std::uint32_t>(static_cast<std::int64_t>(plank)), 3, 1))) * color;
    const double groove = step(0.485, 0.496, seam);
    normal = normalized(normal + Vec{0, 0, (p.z + 20.3) / 1.15 - plank > 0.5 ? -0.25 * groove : 0.25 * groove});
    return {(1 - 0.8 * groove) * color, 0.035, 0.55 * (1 - groove)};
}

// A gingham napkin that lies on the table. False outside of it.
inline bool cloth(Vec p, Vec& normal, Material& out) {
    const double x = p.x - 1.25, z = p.z + 0.05, u = 0.94 * x + 0.34 * z, v = 0.94 * z - 0.34 * x;
    const double wave = 0.015 * std::sin(9 * u) + 0.012 * std::sin(7 * v + 1);
    if (std::abs(u + wave) > 1.5 || std::abs(v - wave) > 0.98) return false;
    const auto stripe = [](double t) {
        const double f = t - std::floor(t);
        return step(0.22, 0.235, f) * (1 - step(0.765, 0.78, f));
    };
    const double both = 0.5 * (stripe(3.1 * u) + stripe(3.1 * v));
    const double weave = 0.93 + 0.14 * noise(75 * u, 75 * v);
    out = {weave * mix({0.76, 0.73, 0.66}, {0.40, 0.035, 0.045}, both), 0, 0};
    const double hem = std::min(1.5 - std::abs(u + wave), 0.98 - std::abs(v - wave));
    if (hem < 0.05) out.color = (hem < 0.008 ? 0.6 : 0.92) * Vec{0.76, 0.73, 0.66};
    const double fold = 0.16 * (fractal(1.7 * u + 5, 1.2 * v + 3, 2) - 0.5) + 0.05 * std::cos(5 * u + 2 * v);
    normal = normalized(normal + Vec{fold, 0, 0.7 * fold});
    return true;
}

inline Material pear(Vec p) {
    const double angle = std::atan2(p.z, p.x);
    if (p.y > 1.66) return {{0.12, 0.07, 0.03}, 0, 0};
    const double blush = step(0.25, 0.95, fractal(1.6 * angle + 20, 1.5 * p.y, 3) * (0.75 - 0.55 * std::cos(angle + 0.6)));
    const double speck = step(0.80, 0.90, noise(28 * angle, 28 * p.y));
    Vec color = mix({0.50, 0.50, 0.06}, {0.52, 0.16, 0.035}, blush);
    color = mix(color, {0.22, 0.26, 0.03}, step(1.2, 1.65, p.y) * 0.5);
    return {mix(color, {0.26, 0.16, 0.04}, 0.45 * speck), 0.035, 0.55};
}

inline Material mug(Vec p) {
    const double r = length(p.x, p.z);
    if (r < 0.597 + 0.03 * p.y && p.y > 0.1) return {{0.78, 0.76, 0.70}, 0.04, 0.8};
    const double angle = std::atan2(p.z, p.x),
                 tooth = std::abs(angle * 14 / 6.283185307 - std::floor(angle * 14 / 6.283185307) - 0.5);
    const bool band = p.y > 0.42 && p.y < 0.86, is_body = r < 0.70;
    if (is_body && band) {
        const bool rim = p.y < 0.455 || p.y > 0.825;
        const bool zigzag = std::abs(p.y - 0.52 - 0.5 * tooth) < 0.045;
        return {rim || zigzag ? Vec{0.72, 0.26, 0.05} : Vec{0.78, 0.76, 0.70}, 0.045, 1};
    }
    return {{0.018, 0.085, 0.155}, 0.045, 1};
}

inline Material book(Vec p) {
    const bool pages = p.y > 0.045 && p.y < 0.225 && (p.x > -1.0) && (std::abs(p.z) > 0.74 || p.x > 1.06);
    if (pages) return {(0.85 + 0.25 * noise(3 * p.x, 130 * p.y)) * Vec{0.66, 0.60, 0.46}, 0, 0};
    const double edge = std::min(1.12 - std::abs(p.x), 0.8 - std::abs(p.z));
    const bool gilt = p.y > 0.26 && ((edge > 0.09 && edge < 0.115) || (edge > 0.14 && edge < 0.15));
    const double grain = 0.88 + 0.24 * noise(60 * p.x, 60 * p.z);
    return {gilt ? Vec{0.62, 0.43, 0.14} : grain * Vec{0.045, 0.15, 0.095}, 0.03, 0.3};
}

inline Material material_at(const Hit& hit, Vec world, Vec& normal) {
    const Vec p = hit.object != nullptr ? to_own(*hit.object, world) : world;
    switch (hit.surface) {
        case Surface::table: {
            Material out;
            return cloth(p, normal, out) ? out : wood(p, normal);
        }
        case Surface::wall: {
            const double plaster = fractal(1.3 * p.x, 1.3 * p.y + 40, 4);
            return {(0.92 + 0.16 * plaster) * Vec{0.20, 0.27, 0.29}, 0, 0};
        }
        case Surface::orange: {
            const double a = std::atan2(p.z, p.x), h = p.y;
            const Vec bump{noise(34 * a, 40 * h) - 0.5, noise(34 * a + 50, 40 * h) - 0.5, noise(34 * a, 40 * h + 50) - 0.5};
            normal = normalized(normal + 0.17 * bump);
            if (length(p.x, p.z) < 0.06 && p.y > 0.9) return {{0.10, 0.13, 0.03}, 0, 0};
            return {mix({0.78, 0.235, 0.012}, {0.70, 0.30, 0.02}, fractal(3 * a, 3 * h, 2)), 0.04, 0.5};
        }
        case Surface::pear: return pear(p);
        case Surface::mug: return mug(p);
        case Surface::book: return book(p);
        case Surface::cherry: {
            const bool fruit = length(p - Vec{-0.2, 0.25, 0}) < 0.262 || length(p - Vec{0.36, 0.23, 0.12}) < 0.242;
            if (!fruit || length(p.x + 0.2, p.z) < 0.02) return {{0.14, 0.19, 0.04}, 0, 0};
            return {{0.30, 0.008, 0.016}, 0.045, 1};
        }
        case Surface::leaf: {
            const double side = std::abs(p.z), vein = std::abs((p.x * 9 + side * 8) - std::floor(p.x * 9 + side * 8) - 0.5);
            const double line = std::max(1 - step(0.006, 0.018, side), 0.5 * (1 - step(0.03, 0.12, vein)));
            return {mix((0.8 + 0.4 * fractal(9 * p.x, 9 * p.z, 3)) * Vec{0.075, 0.19, 0.028}, {0.30, 0.38, 0.12}, line), 0.035,
                    0.35};
        }
        default: return {{0.02, 0.02, 0.022}, 0.72, 1};
    }
}

// ---- light ----------------------------------------------------------------------------------------------------------

// The window as seen in a reflection: sky over hills, behind a cross of bars.
inline Vec window_light(Vec p) {
    const Vec q = p - window_corner;
    const double u = dot(q, window_u) / dot(window_u, window_u), v = dot(q, window_v) / dot(window_v, window_v);
    if (std::abs(u - 0.5) < 0.035 || std::abs(v - 0.55) < 0.03) return {0.5, 0.45, 0.4};
    return v < 0.25 + 0.05 * std::sin(9 * u) ? Vec{5.0, 5.6, 4.6} : mix({15, 14.6, 13.4}, {9, 11.5, 15}, v);
}

// A patch of sun through a second window, on the wall: four panes with soft edges, in [0, 1].
inline double sun_patch(Vec p) {
    const double u = (p.x - 1.02 - 0.30 * (p.y - 2.6)) / 1.7, v = (p.y - 1.55 + 0.12 * p.x) / 2.5;
    const auto pane = [](double t, double low, double high, double soft) {
        return step(low - soft, low + soft, t) * (1 - step(high - soft, high + soft, t));
    };
    return (pane(u, 0.0, 0.44, 0.025) + pane(u, 0.53, 0.97, 0.025)) * (pane(v, 0.0, 0.44, 0.018) + pane(v, 0.51, 0.95, 0.018));
}

// Which of the 36 cells of the window to sample: `count` of them, spread, other ones for each of the 9 rays of a pixel.
struct Samples {
    std::uint32_t seed = 0;
    int ray = 0, count = 4;
};

inline Vec direct_light(Vec p, Vec normal, const Samples& samples) {
    const Vec facing = normalized(cross(window_v, window_u));
    const double area = length(window_u) * length(window_v);
    double sum = 0;
    for (int k = 0; k < samples.count; ++k) {
        const int cell = (samples.ray * 4 + k * 9 * (4 / samples.count) + samples.ray / 9) % 36;
        const int column = cell % 6, row = cell / 6;
        const std::uint32_t h = hash(samples.seed, static_cast<std::uint32_t>(samples.ray), static_cast<std::uint32_t>(k));
        const double u = (column + unit(h)) / 6, v = (row + unit(hash(h, 1))) / 6;
        const Vec to = window_corner + u * window_u + v * window_v - p;
        const double far = length(to);
        const Vec along = (1 / far) * to;
        const double cosine = dot(normal, along), cosine_there = -dot(facing, along);
        if (cosine > 0 && cosine_there > 0 && !is_blocked(p + 3e-3 * normal, along, far))
            sum += cosine * cosine_there * area / (far * far);
    }
    return (sum / samples.count) * Vec{14.2, 13.3, 11.8};
}

inline Vec trace(Vec from, Vec along, const Samples& samples, int depth) {
    const Hit hit = find_hit(from, along);
    const Vec p = from + hit.t * along;
    if (hit.surface == Surface::window) return window_light(p);
    Vec normal = hit.object != nullptr ? normal_at(*hit.object, p) : hit.surface == Surface::table ? Vec{0, 1, 0} : Vec{0, 0, -1};
    const Vec flat = normal;
    const Material material = material_at(hit, p, normal);
    const double open = openness(p, flat);
    Vec light = direct_light(p, normal, samples);
    light = light + open * mix({0.12, 0.08, 0.055}, {0.085, 0.095, 0.115}, 0.5 + 0.5 * normal.y);
    light = light + (open * 0.10 * std::max(0.0, dot(normal, Vec{0.85, 0.25, -0.46}))) * Vec{1.0, 0.72, 0.48};
    if (hit.surface == Surface::wall) light = light + (1.7 * sun_patch(p)) * Vec{1.0, 0.80, 0.52};
    Vec out = material.color * light;
    if (material.mirror > 0 && depth < (material.mirror > 0.5 ? 2 : 1)) {
        const double cosine = clamp(-dot(along, normal), 0, 1);
        const double share = material.gloss * (material.mirror + (1 - material.mirror) * std::pow(1 - cosine, 5));
        const Vec mirrored = along + (-2 * dot(along, normal)) * normal;
        const Samples fewer{samples.seed, samples.ray, 1};
        out = (1 - share) * out + share * trace(p + 3e-3 * flat, mirrored, fewer, depth + 1);
    }
    return out;
}

// Linear light to a stored value in [0, 255]: a soft shoulder, then the sRGB curve.
inline std::uint8_t to_stored(double light) {
    const double x = 1.12 * std::max(light, 0.0);
    const double shown = clamp(x * (2.51 * x + 0.06) / (x * (2.43 * x + 0.80) + 0.10), 0, 1);
    const double stored = shown <= 0.0031308 ? 12.92 * shown : 1.055 * std::pow(shown, 1 / 2.4) - 0.055;
    return hmesh::PixelTraits<std::uint8_t>::from_real(255 * stored);
}

}  // namespace scene

// Draws the scene at width x height px, both at least 1; what is seen is fitted to the height. Rows are pieces of work.
[[nodiscard]] inline hmesh::Image<std::uint8_t, 3> draw_scene(int width = 768, int height = 512,
                                                              const hmesh::ParallelFor& parallel_for = {}) {
    using scene::Vec;
    hmesh::Image<std::uint8_t, 3> image(width, height);
    const Vec eye{0.1, 2.75, -6.6}, aim{0.02, 0.80, 0};
    const Vec ahead = scene::normalized(aim - eye), right = scene::normalized(scene::cross({0, 1, 0}, ahead));
    const Vec up = scene::cross(ahead, right);
    const double pixel = 2 * 0.272 / height;  // the tangent of half the vertical angle of view
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t j) {
        const int y = static_cast<int>(j);
        for (int x = 0; x < width; ++x) {
            const std::uint32_t seed = scene::hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            Vec sum;
            for (int ray = 0; ray < 9; ++ray) {
                const int column = ray % 3, row = ray / 3;
                const double u = (x + (column + 0.5) / 3 - 0.5 * width) * pixel, v = (0.5 * height - y - (row + 0.5) / 3) * pixel;
                const Vec light = scene::trace(eye, scene::normalized(ahead + u * right + v * up), {seed, ray, 4}, 0);
                sum = sum + Vec{std::min(light.x, 3.0), std::min(light.y, 3.0), std::min(light.z, 3.0)};
            }
            std::uint8_t* to = image.pixel(x, y);
            to[0] = scene::to_stored(sum.x / 9);
            to[1] = scene::to_stored(sum.y / 9);
            to[2] = scene::to_stored(sum.z / 9);
        }
    });
    return image;
}

}  // namespace tool

#endif  // HMESH_TOOLS_SCENE_HPP
