#include "hmesh/io/svg.hpp"

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace {

using hmesh::SvgOptions;
using hmesh_test::two_faces;

using Kind = SvgOptions::Kind;

SvgOptions of_kind(Kind kind) {
    SvgOptions options;
    options.kind = kind;
    return options;
}

std::string written(const hmesh::MeshView& mesh, const SvgOptions& options) {
    std::string text;
    REQUIRE(hmesh::write_svg(mesh, hmesh::kit::append_to(text), options));
    return text;
}

constexpr std::array<Kind, 3> kinds = {Kind::gradient, Kind::exact, Kind::flat};

// Faces that share no corner, of any shape from fat to a hundredth of a pixel thin, in any colours.
hmesh::Mesh random_faces(int channels, int count, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = mesh.height = 100, mesh.peak = 255;
    for (int f = 0; f < count; ++f) {
        const double angle = 6.3 * random.uniform(), size = std::exp2(1 + 5 * random.uniform());
        const double width = size * std::exp2(-8 * random.uniform());
        const double x = 100 * random.uniform(), y = 100 * random.uniform();
        const std::array<std::array<double, 2>, 3> corners = {{{0, 0}, {size, 0}, {size * random.uniform(), width}}};
        for (const auto& [along, across] : corners) {
            const double at_x = x + along * std::cos(angle) - across * std::sin(angle);
            const double at_y = y + along * std::sin(angle) + across * std::cos(angle);
            for (const double at : {at_x, at_y}) mesh.positions.push_back(static_cast<float>(std::round(at * 256) / 256));
        }
        const double range = f % 3 == 0 ? 3 : 255;
        for (int k = 0; k < 3 * channels; ++k) mesh.colors.push_back(static_cast<float>(random.uniform() * range));
        const auto first = static_cast<std::uint32_t>(3 * f);
        mesh.faces.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

// --- a reader of what is written, by the SVG format alone ---

using Rgb = std::array<double, 3>;

struct Gradient {
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    std::vector<double> offsets;
    std::vector<Rgb> colors;

    [[nodiscard]] Rgb at(double x, double y) const {
        const double dx = x2 - x1, dy = y2 - y1;
        const double t = ((x - x1) * dx + (y - y1) * dy) / (dx * dx + dy * dy);
        if (t <= offsets.front()) return colors.front();
        for (std::size_t i = 1; i < offsets.size(); ++i)
            if (t <= offsets[i]) {
                const double share = (t - offsets[i - 1]) / (offsets[i] - offsets[i - 1]);
                Rgb color{};
                for (std::size_t k = 0; k < 3; ++k) color[k] = colors[i - 1][k] + share * (colors[i][k] - colors[i - 1][k]);
                return color;
            }
        return colors.back();
    }
};

std::string attribute(const std::string& tag, const std::string& name) {
    const std::size_t at = tag.find(' ' + name + "=\"");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 3;
    return tag.substr(begin, tag.find('"', begin) - begin);
}

Rgb color_of(const std::string& hex) {
    REQUIRE(hex.size() == 7);
    Rgb color{};
    for (std::size_t k = 0; k < 3; ++k) color[k] = std::stoi(hex.substr(1 + 2 * k, 2), nullptr, 16);
    return color;
}

// A face's paint, in the order of the file.
struct Paint {
    Gradient gradient;
    std::vector<double> points;  // x, y by turns
    std::string group;           // attributes of the last <g>
};

std::vector<Paint> read_svg(const std::string& text) {
    std::map<std::string, Gradient> gradients;
    std::vector<Paint> paints;
    std::string id, group;
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
        const std::string tag = text.substr(at, text.find('>', at) - at);
        const std::string name = tag.substr(1, tag.find_first_of(" />", 2) - 1);
        if (name == "g") group = tag;
        if (name == "linearGradient") {
            id = attribute(tag, "id");
            REQUIRE(gradients.count(id) == 0);
            Gradient& gradient = gradients[id];
            const std::string other = attribute(tag, "xlink:href");
            if (!other.empty()) {
                REQUIRE(gradients.count(other.substr(1)) == 1);
                gradient = gradients[other.substr(1)];
            } else {
                REQUIRE(attribute(tag, "gradientUnits") == "userSpaceOnUse");
            }
            if (!attribute(tag, "x1").empty()) {
                gradient.x1 = std::stod(attribute(tag, "x1")), gradient.y1 = std::stod(attribute(tag, "y1"));
                gradient.x2 = std::stod(attribute(tag, "x2")), gradient.y2 = std::stod(attribute(tag, "y2"));
            }
            if (tag.back() != '/' && !other.empty()) gradient.offsets.clear(), gradient.colors.clear();
        }
        if (name == "stop") {
            gradients[id].offsets.push_back(std::stod(attribute(tag, "offset")));
            gradients[id].colors.push_back(color_of(attribute(tag, "stop-color")));
        }
        if (name == "path" && attribute(tag, "fill").size() > 4) {
            Paint paint;
            const std::string fill = attribute(tag, "fill");
            if (fill[0] == '#') {
                paint.gradient.x2 = 1;
                paint.gradient.offsets = {0};
                paint.gradient.colors = {color_of(fill)};
            } else {
                const std::string of = fill.substr(5, fill.size() - 6);
                REQUIRE(fill == "url(#" + of + ")");
                REQUIRE(gradients.count(of) == 1);
                paint.gradient = gradients[of];
            }
            const std::string outline = attribute(tag, "d");
            REQUIRE(outline.front() == 'M');
            REQUIRE(outline.back() == 'z');
            const char* from = outline.c_str() + 1;
            for (char* end = nullptr; *from != 'z'; from = end) paint.points.push_back(std::strtod(from, &end));
            REQUIRE(paint.points.size() == 6);
            paint.group = group;
            paints.push_back(paint);
        }
    }
    return paints;
}

// --- faces ---

struct Face {
    std::array<double, 3> x{}, y{};
    std::array<Rgb, 3> color{};
};

Face face_of(const hmesh::Mesh& mesh, std::size_t f) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t v = mesh.faces[f][k];
        face.x[k] = static_cast<double>(mesh.positions[2 * v]);
        face.y[k] = static_cast<double>(mesh.positions[2 * v + 1]);
        for (std::size_t c = 0; c < 3; ++c) face.color[k][c] = static_cast<double>(mesh.colors[3 * v + c]);
    }
    return face;
}

double squared(const Rgb& a, const Rgb& b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

// The mean over the face of the squared error of a paint, from samples spread evenly.
double mean_error(const Face& face, const Gradient& gradient) {
    constexpr int n = 24;
    double sum = 0;
    int samples = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j)
            for (int upper = 0; upper < (i + j < n - 1 ? 2 : 1); ++upper) {  // centres of n^2 small triangles
                const double b = (i + (upper != 0 ? 2 : 1) / 3.0) / n, c = (j + (upper != 0 ? 2 : 1) / 3.0) / n, a = 1 - b - c;
                Rgb color{};
                for (std::size_t k = 0; k < 3; ++k) color[k] = a * face.color[0][k] + b * face.color[1][k] + c * face.color[2][k];
                const double x = a * face.x[0] + b * face.x[1] + c * face.x[2], y = a * face.y[0] + b * face.y[1] + c * face.y[2];
                sum += squared(color, gradient.at(x, y));
                ++samples;
            }
    return sum / samples;
}

// The least mean squared error that any gradient along (dx, dy) has, whatever its stops: what varies along the chords.
double least_error(const Face& face, double dx, double dy) {
    std::array<double, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = face.x[k] * dx + face.y[k] * dy;
    const auto [low, high] = std::minmax({t[0], t[1], t[2]});
    double sum = 0, lengths = 0;
    constexpr int slices = 60;
    for (int i = 0; i < slices; ++i) {
        const double level = low + (high - low) * (i + 0.5) / slices;
        std::vector<Rgb> ends;
        std::vector<double> along;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t l = (k + 1) % 3;
            if ((t[k] < level) == (t[l] < level)) continue;
            const double share = (level - t[k]) / (t[l] - t[k]);
            Rgb color{};
            for (std::size_t c = 0; c < 3; ++c) color[c] = face.color[k][c] + share * (face.color[l][c] - face.color[k][c]);
            ends.push_back(color);
            const double x = face.x[k] + share * (face.x[l] - face.x[k]), y = face.y[k] + share * (face.y[l] - face.y[k]);
            along.push_back(x * dy - y * dx);
        }
        REQUIRE(ends.size() == 2);
        const double length = std::abs(along[0] - along[1]);
        sum += length * squared(ends[0], ends[1]) / 12;
        lengths += length;
    }
    return sum / lengths;
}

void check_refused(const hmesh::MeshView& mesh, hmesh::Errc code) {
    for (const Kind kind : kinds) {
        std::string text;
        const hmesh::Status status = hmesh::write_svg(mesh, hmesh::kit::append_to(text), of_kind(kind));
        CHECK(status.code == code);
        CHECK(std::strlen(status.what) > 0);
        CHECK(text.empty());
    }
}

const std::string head =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"3\" "
    "height=\"2\" viewBox=\"0 0 3 2\" shape-rendering=\"crispEdges\">\n"
    "<!-- made by hmesh " HMESH_VERSION_STRING " -->\n";

// Red rises by 10 a px to the right, green from the diagonal to the lower left corner, held to 255; blue is full.
hmesh::Mesh golden_mesh() {
    hmesh::Mesh mesh = two_faces(3, 30);
    mesh.positions[7] = 1.50390625F;
    mesh.colors = {0, 0, 255, 30, 0, 255, 30, 0, 255, 0, 300, 255};
    return mesh;
}

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes, in each kind") {
    const hmesh::Mesh mesh = golden_mesh();
    CHECK(written(mesh.view(), of_kind(Kind::flat)) ==
          head + "<path fill=\"#1400ff\" d=\"M0 0 3 0 3 2z\"/>\n<path fill=\"#0a55ff\" d=\"M0 0 3 2 0 1.504z\"/>\n</svg>\n");
    CHECK(written(mesh.view(), of_kind(Kind::gradient)) ==
          head + R"svg(<linearGradient id="a" gradientUnits="userSpaceOnUse" x1="3" y1="0.67" x2="0" y2="0.67">)svg"
                 R"svg(<stop offset="0" stop-color="#1e00ff"/>)svg"
                 R"svg(<stop offset="1" stop-color="#0000ff"/></linearGradient>)svg"
                 R"svg(<path fill="url(#a)" d="M0 0 3 0 3 2z"/>
<linearGradient id="b" gradientUnits="userSpaceOnUse" x1="1.2387" y1="0.8136" x2="0.5322" y2="1.8624">)svg"
                 R"svg(<stop offset="0" stop-color="#1e00ff"/><stop offset="0.0137" stop-color="#0f02ff"/>)svg"
                 R"svg(<stop offset="1" stop-color="#00ffff"/></linearGradient>)svg"
                 R"svg(<path fill="url(#b)" d="M0 0 3 2 0 1.504z"/>
</svg>
)svg");
    CHECK(written(mesh.view(), of_kind(Kind::exact)) == head +
                                                            R"svg(<g style="isolation:isolate">
<g style="mix-blend-mode:screen">
<linearGradient id="_r" gradientUnits="userSpaceOnUse">)svg"
                                                            R"svg(<stop offset="0" stop-color="#000000"/>)svg"
                                                            R"svg(<stop offset="1" stop-color="#ff0000"/></linearGradient>
<linearGradient id="a" xlink:href="#_r" x1="0" y1="0.667" x2="25.5" y2="0.667"/>)svg"
                                                            R"svg(<path fill="url(#a)" d="M0 0 3 0 3 2z"/>
<linearGradient id="b" xlink:href="#_r" x1="0" y1="1.168" x2="25.5" y2="1.168"/>)svg"
                                                            R"svg(<path fill="url(#b)" d="M0 0 3 2 0 1.504z"/>
</g>
<g style="mix-blend-mode:screen">
<linearGradient id="_g" gradientUnits="userSpaceOnUse">)svg"
                                                            R"svg(<stop offset="0" stop-color="#000000"/>)svg"
                                                            R"svg(<stop offset="1" stop-color="#00ff00"/></linearGradient>
<path fill="#000000" d="M0 0 3 0 3 2z"/>
<linearGradient id="c" xlink:href="#_g" x1="1.2314" y1="0.8209" x2="0.5373" y2="1.8621">)svg"
                                                            R"svg(<stop offset="0" stop-color="#000000"/>)svg"
                                                            R"svg(<stop offset="1" stop-color="#00ff00"/></linearGradient>)svg"
                                                            R"svg(<path fill="url(#c)" d="M0 0 3 2 0 1.504z"/>
</g>
<g style="mix-blend-mode:screen">
<linearGradient id="_b" gradientUnits="userSpaceOnUse">)svg"
                                                            R"svg(<stop offset="0" stop-color="#000000"/>)svg"
                                                            R"svg(<stop offset="1" stop-color="#0000ff"/></linearGradient>
<path fill="#0000ff" d="M0 0 3 0 3 2z"/>
<path fill="#0000ff" d="M0 0 3 2 0 1.504z"/>
</g>
</g>
</svg>
)svg");
}

TEST_CASE("the wireframe is every edge once, over the faces") {
    SvgOptions options = of_kind(Kind::flat);
    options.wireframe = true;
    const std::string with = written(two_faces(3, 30).view(), options);
    const std::string lines =
        "<path fill=\"none\" stroke=\"#fff\" stroke-opacity=\".5\" vector-effect=\"non-scaling-stroke\" "
        "shape-rendering=\"auto\" d=\"M0 0 3 0 3 2 0 2M0 0 3 2M0 0 0 2\"/>\n</svg>\n";
    const std::string without = written(two_faces(3, 30).view(), of_kind(Kind::flat));
    CHECK(with == without.substr(0, without.size() - 7) + lines);
}

TEST_CASE("in the exact kind every corner has its colour, within a step of 8 bits") {
    const hmesh::Mesh mesh = random_faces(3, 300, 1);
    const std::vector<Paint> paints = read_svg(written(mesh.view(), of_kind(Kind::exact)));
    REQUIRE(paints.size() == 3 * mesh.face_count());
    double worst = 0;
    int steep = 0;
    for (std::size_t i = 0; i < paints.size(); ++i) {
        const std::size_t channel = i / mesh.face_count();
        const Face face = face_of(mesh, i % mesh.face_count());
        CHECK(paints[i].group == "<g style=\"mix-blend-mode:screen\"");
        for (std::size_t k = 0; k < 3; ++k) {
            const Rgb color = paints[i].gradient.at(face.x[k], face.y[k]);
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(color[c] - (c == channel ? face.color[k][c] : 0)));
            CHECK(std::abs(paints[i].points[2 * k] - face.x[k]) <= 0.0005 + 1e-9);
            CHECK(std::abs(paints[i].points[2 * k + 1] - face.y[k]) <= 0.0005 + 1e-9);
        }
        // Beyond a steep face, where viewers may take a pixel from, its channel goes on no further than its corners.
        const Gradient& gradient = paints[i].gradient;
        const double length = std::hypot(gradient.x2 - gradient.x1, gradient.y2 - gradient.y1);
        if (gradient.offsets.size() < 2 || length * (gradient.offsets.back() - gradient.offsets.front()) >= 1.9) continue;
        ++steep;
        const auto [least, most] = std::minmax({face.color[0][channel], face.color[1][channel], face.color[2][channel]});
        CHECK(std::abs(gradient.colors.front()[channel] - least) <= 0.5 + 1e-9);
        CHECK(std::abs(gradient.colors.back()[channel] - most) <= 0.5 + 1e-9);
    }
    CHECK(worst <= 1);
    CHECK(steep > 20);
}

TEST_CASE("faces thousands of times as long as wide have their colours too, also where viewers count 65536ths") {
    hmesh::kit::Random random(5);
    hmesh::Mesh mesh;
    mesh.channels = 1;
    mesh.width = 65536, mesh.height = 8, mesh.peak = 255;
    for (std::uint32_t v = 0; v < 3000; v += 3) {
        const auto length = static_cast<float>(std::exp2(3 + 13 * random.uniform()));
        const auto width = static_cast<float>(std::exp2(3 * random.uniform()));
        const auto top = length * static_cast<float>(random.uniform());
        mesh.positions.insert(mesh.positions.end(), {0, 0, length, 0, top, width});
        for (int k = 0; k < 3; ++k) mesh.colors.push_back(static_cast<float>(255 * random.uniform()));
        mesh.faces.push_back({v, v + 1, v + 2});
    }
    const std::vector<Paint> paints = read_svg(written(mesh.view(), of_kind(Kind::exact)));
    REQUIRE(paints.size() == mesh.face_count());
    double worst = 0, worst_held = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const Gradient& gradient = paints[v / 3].gradient;
        Gradient held = gradient;
        const auto hold = [](double& value) { value = std::round(value * 65536) / 65536; };
        for (double* const end : {&held.x1, &held.y1, &held.x2, &held.y2}) hold(*end);
        for (double& offset : held.offsets) hold(offset);
        const auto x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
        const auto color = static_cast<double>(mesh.colors[v]);
        worst = std::max(worst, std::abs(gradient.at(x, y)[0] - color));
        worst_held = std::max(worst_held, std::abs(held.at(x, y)[0] - color));
    }
    CHECK(worst <= 1);
    CHECK(worst_held <= 1.5);
}

TEST_CASE("the gradient kind is as good as any gradient of any direction, and never worse than flat") {
    const hmesh::Mesh mesh = random_faces(3, 60, 2);
    const std::vector<Paint> gradients = read_svg(written(mesh.view(), of_kind(Kind::gradient)));
    const std::vector<Paint> flats = read_svg(written(mesh.view(), of_kind(Kind::flat)));
    REQUIRE(gradients.size() == mesh.face_count());
    REQUIRE(flats.size() == mesh.face_count());
    constexpr double rounding = 1.2;  // 0.5 for colours off by up to 1/2, 0.7 for third stops that are left out
    double sum = 0, flat_sum = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const Face face = face_of(mesh, f);
        const double error = mean_error(face, gradients[f].gradient), flat = mean_error(face, flats[f].gradient);
        CHECK(error <= flat + rounding);
        // Directions are spread evenly over what the face sees, not over the plane, in which a needle's are crowded.
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 90; ++i) {
            const double angle = 3.14159265358979 * i / 90, b = std::cos(angle), c = std::sin(angle);
            const double bx = face.x[1] - face.x[0], by = face.y[1] - face.y[0];
            const double cx = face.x[2] - face.x[0], cy = face.y[2] - face.y[0];
            const double area = bx * cy - by * cx;
            least = std::min(least, least_error(face, (b * cy - c * by) / area, (c * bx - b * cx) / area));
        }
        CHECK(error <= 1.02 * least + rounding);
        sum += error;
        flat_sum += flat;
    }
    CHECK(sum < 0.5 * flat_sum);
}

TEST_CASE("offsets rise and all that is written is a number, for colours within and outside of the range") {
    hmesh::Mesh mesh = random_faces(3, 100, 3);
    for (float& value : mesh.colors) value = 3 * value - 255;  // held to [0, 255]
    for (const Kind kind : kinds) {
        const std::string text = written(mesh.view(), of_kind(kind));
        CHECK(text.find("nan") == std::string::npos);
        CHECK(text.find("inf") == std::string::npos);
        for (const Paint& paint : read_svg(text))
            for (std::size_t i = 1; i < paint.gradient.offsets.size(); ++i)
                CHECK(paint.gradient.offsets[i] >= paint.gradient.offsets[i - 1]);
    }
}

TEST_CASE("faces without area and faces of one colour are painted plainly") {
    hmesh::Mesh line = two_faces(3, 30), one_color = line;
    line.positions = {1, 3, 2, 5, 3, 7, 4, 9};
    std::fill(one_color.colors.begin(), one_color.colors.end(), 77.0F);
    for (const hmesh::Mesh& mesh : {line, one_color})
        for (const Kind kind : kinds) {
            const std::string text = written(mesh.view(), of_kind(kind));
            CHECK(text.find("fill=\"url") == std::string::npos);
            CHECK(read_svg(text).size() == (kind == Kind::exact ? 6 : 2));
        }
}

TEST_CASE("one channel is grey, by one gradient that is exact, without blending") {
    hmesh::Mesh mesh = random_faces(1, 100, 4);
    const std::string text = written(mesh.view(), of_kind(Kind::gradient));
    CHECK(text == written(mesh.view(), of_kind(Kind::exact)));
    CHECK(text.find("<g") == std::string::npos);
    const std::vector<Paint> paints = read_svg(text);
    REQUIRE(paints.size() == mesh.face_count());
    for (std::size_t f = 0; f < paints.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = mesh.faces[f][k];
            const auto x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
            const Rgb color = paints[f].gradient.at(x, y);
            for (const double value : color) CHECK(std::abs(value - static_cast<double>(mesh.colors[v])) <= 1);
        }
}

TEST_CASE("alpha is a mask of grey faces, left out where all is opaque") {
    hmesh::Mesh mesh = two_faces(4, 30);
    for (const Kind kind : kinds) {
        const std::string text = written(mesh.view(), of_kind(kind));
        const std::size_t begin = text.find("<mask"), end = text.find("</mask>\n<g mask=\"url(#_m)\">\n");
        REQUIRE(begin != std::string::npos);
        REQUIRE(end != std::string::npos);
        const std::vector<Paint> alpha = read_svg(text.substr(begin, end - begin));
        REQUIRE(alpha.size() == 2);
        if (kind == Kind::flat) CHECK(alpha[0].gradient.colors == std::vector<Rgb>{{100, 100, 100}});
        else
            for (std::size_t k = 0; k < 3; ++k)
                for (const double value : alpha[0].gradient.at(alpha[0].points[2 * k], alpha[0].points[2 * k + 1]))
                    CHECK(std::abs(value - (90 + 10 * static_cast<double>(k))) <= 1);
    }
    hmesh::Mesh opaque = two_faces(3, 30);
    for (std::size_t v = 0; v < 4; ++v) {
        mesh.colors[4 * v + 3] = 255;
        for (std::size_t k = 0; k < 3; ++k) opaque.colors[3 * v + k] = mesh.colors[4 * v + k];
    }
    for (const Kind kind : kinds) CHECK(written(mesh.view(), of_kind(kind)) == written(opaque.view(), of_kind(kind)));
}

TEST_CASE("under the mask are the faces as they are without alpha, and all that is begun is ended") {
    const hmesh::Mesh mesh = two_faces(4, 30);  // straight colours
    const std::string faces = written(two_faces(3, 30).view(), of_kind(Kind::flat)).substr(head.size());
    const std::string text = written(mesh.view(), of_kind(Kind::flat)), begin = "<mask id=\"_m\" maskUnits=\"userSpaceOnUse\" ";
    CHECK(text.substr(0, head.size() + begin.size()) == head + begin);
    const std::size_t end = text.find("</mask>\n");
    REQUIRE(end != std::string::npos);
    CHECK(text.find("x=\"0\" y=\"0\" width=\"3\" height=\"2\">\n") == head.size() + begin.size());
    CHECK(text.substr(end) == "</mask>\n<g mask=\"url(#_m)\">\n" + faces.substr(0, faces.size() - 7) + "</g>\n</svg>\n");
}

TEST_CASE("colours multiplied by alpha are divided by it, and corners without alpha bring no fringe") {
    hmesh::Mesh mesh = two_faces(4, 30);
    mesh.colors = {100, 50, 0, 127.5F, 0, 0, 0, 0, 200, 100, 0, 255, 0, 0, 0, 0};
    mesh.premultiplied = true;
    const std::string text = written(mesh.view(), of_kind(Kind::flat));
    const std::vector<Paint> paints = read_svg(text.substr(text.find("</mask>")));
    REQUIRE(paints.size() == 2);
    for (const Paint& paint : paints) CHECK(paint.gradient.colors == std::vector<Rgb>{{200, 100, 0}});
}

TEST_CASE("the bytes do not depend on the locale") {
    const hmesh::Mesh mesh = random_faces(3, 20, 5);
    for (const Kind kind : kinds)
        hmesh_test::check_locale_makes_no_difference(mesh.view(), [=](const hmesh::MeshView& view, hmesh::Sink sink) {
            return hmesh::write_svg(view, sink, of_kind(kind));
        });
}

TEST_CASE("a sink that refuses after some bytes gets no more and is reported, wherever that is") {
    const hmesh::Mesh mesh = random_faces(3, 12, 6);
    SvgOptions options = of_kind(Kind::exact);
    options.wireframe = true;
    const std::size_t size = written(mesh.view(), options).size();
    REQUIRE(size > 4096);
    for (std::size_t k = 0; k <= size; k += k < 4200 ? 41 : 977) {
        std::size_t taken = 0;
        int refusals = 0;
        const hmesh::Status status = hmesh::write_svg(
            mesh.view(),
            [&](const void*, std::size_t bytes) {
                const bool fits = taken + bytes <= k;
                if (fits) taken += bytes;
                else ++refusals;
                return fits;
            },
            options);
        if (static_cast<bool>(status) != (k == size) || refusals != (k == size ? 0 : 1) || taken > k) FAIL("k = ", k);
        if (k < size && (status.code != hmesh::Errc::write_failed || status.value != static_cast<double>(taken))) FAIL("k = ", k);
    }
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const hmesh::Mesh good = two_faces(3, 30);
    check_refused(hmesh::MeshView{}, hmesh::Errc::invalid_argument);
    for (const float bad : {nan, infinity, -infinity}) {
        hmesh::Mesh mesh = good;
        mesh.positions[7] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite);
        mesh = good;
        mesh.colors[11] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite);
    }
    hmesh::Mesh mesh = good;
    mesh.faces[1][2] = 4;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.width = 0;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.height = -1;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.peak = 0;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    check_refused(two_faces(5, 30).view(), hmesh::Errc::invalid_argument);
}

TEST_CASE("a kind that is none of those known is refused") {
    for (const int bad : {3, 255}) {
        std::string text;
        const hmesh::Status status =
            hmesh::write_svg(two_faces(3, 30).view(), hmesh::kit::append_to(text), of_kind(static_cast<Kind>(bad)));
        CHECK(status.code == hmesh::Errc::invalid_argument);
        CHECK(status.value == bad);
        CHECK(text.empty());
    }
}

TEST_CASE("a mesh of nothing shows nothing, and nothing is drawn where there are no faces") {
    for (const Kind kind : {Kind::gradient, Kind::exact, Kind::flat}) {
        hmesh::SvgOptions options;
        options.kind = kind;
        options.wireframe = true;
        const auto write = [&](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_svg(mesh, sink, options); };
        hmesh_test::check_empty_meshes(write, [](const hmesh_test::Bytes& bytes) {
            const std::string text = hmesh_test::as_text(bytes);
            CHECK(text.find("</svg>\n") == text.size() - 7);
            CHECK(text.find("d=\"\"") == std::string::npos);  // an outline of nothing, which some programs refuse
        });
        for (const int channels : {3, 4}) {
            hmesh::Mesh opaque = hmesh_test::two_faces(channels);
            for (std::size_t v = 0; v < 4 && channels == 4; ++v) opaque.colors[4 * v + 3] = 255;
            opaque.faces.pop_back();
            options.wireframe = false;
            const std::string text = hmesh_test::as_text(hmesh_test::exported(opaque.view(), write));
            CHECK(text.find("<mask") == std::string::npos);
            std::size_t paths = 0;
            for (std::size_t at = 0; (at = text.find("<path", at)) != std::string::npos; ++at) ++paths;
            CHECK(paths == (kind == Kind::exact ? 3U : 1U));  // of the one face
        }
    }
}
