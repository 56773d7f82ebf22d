// opengl_offscreen - draws a mesh with OpenGL, without a window, and compares the picture with that of render(): every layout
// that pack_for_gpu() has, in strips and lists, whole and in chunks.
//
//     opengl_offscreen [IMAGE [VERTICES]]
//
// Prints a line for each: bytes a vertex of the mesh and the PSNR of the picture of 8 bits. Exit status 1 where one is below
// 50 dB, 77 where there is no OpenGL 3.3. Without an image it makes one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

#include "opengl_mesh.hpp"

namespace {

using Picture = hmesh::Image<std::uint8_t, 4>;

// A disc with a soft border on a slope of colours, premultiplied: 320 x 240 px.
Picture made_picture() {
    Picture picture(320, 240);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const double distance = std::hypot(x - 150.0, y - 120.0);
            const double alpha = std::clamp((110 - distance) / 20, 0.2, 1.0);
            const double color[] = {0.2 + 0.002 * x, distance < 60 ? 0.8 : 0.3, 0.9 - 0.003 * y};
            for (int k = 0; k < 3; ++k) picture.pixel(x, y)[k] = static_cast<std::uint8_t>(255 * alpha * color[k]);
            picture.pixel(x, y)[3] = static_cast<std::uint8_t>(255 * alpha);
        }
    return picture;
}

// An OpenGL context without a surface. False where there is none.
bool make_context() {
    const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    EGLDisplay display = EGL_NO_DISPLAY;
    if (get_display != nullptr) display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
        display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
        if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) return false;
    }
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return false;
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (eglChooseConfig(display, wanted, &config, 1, &found) == EGL_FALSE || found == 0) return false;
    const EGLint version[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    return context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

// Makes a picture of 8 bits of this size what is drawn into. Pixel (i, j) of the viewport is sampled at its centre, as render()
// samples it.
bool make_target(int width, int height) {
    GLuint target = 0, texture = 0;
    glGenFramebuffers(1, &target);
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    glViewport(0, 0, width, height);
    glDisable(GL_BLEND);
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

// The picture that OpenGL draws, its upper row first.
Picture drawn(const hmesh::GpuBuffers& buffers) {
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    example::OpenglMesh(buffers).draw();
    const int width = buffers.layout.width, height = buffers.layout.height;
    Picture upside_down(width, height), picture(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
    for (int y = 0; y < height; ++y) std::copy_n(upside_down.pixel(0, height - 1 - y), 4 * width, picture.pixel(0, y));
    return picture;
}

// The mesh in grey: its green, and alpha.
hmesh::Mesh gray_of(const hmesh::Mesh& mesh) {
    hmesh::Mesh gray = mesh;
    gray.channels = 2;
    gray.colors.clear();
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        gray.colors.insert(gray.colors.end(), {mesh.colors[4 * v + 1], mesh.colors[4 * v + 3]});
    return gray;
}

// What render() draws, in the range of pixels; grey is three times the same.
hmesh::Image<float, 4> reference_of(const hmesh::Mesh& mesh) {
    hmesh::Image<float, 4> picture(mesh.width, mesh.height);
    const auto held = [](float value) { return std::clamp(value, 0.0F, 255.0F); };
    if (mesh.channels == 4) {
        const auto rendered = hmesh::render<4>(mesh.view());
        std::transform(rendered.image.data(), rendered.image.data() + rendered.image.size(), picture.data(), held);
        return picture;
    }
    const auto rendered = hmesh::render<2>(mesh.view());
    for (std::size_t i = 0; i < rendered.image.size() / 2; ++i)
        for (std::size_t k = 0; k < 4; ++k) picture.data()[4 * i + k] = held(rendered.image.data()[2 * i + (k == 3 ? 1 : 0)]);
    return picture;
}

const char* name(hmesh::GpuFormat format) {
    const char* const names[] = {"float32x2", "unorm16x2", "unorm16x4", "unorm8x2", "unorm8x4"};
    return names[static_cast<int>(format)];
}

// Draws one layout and prints its line. The PSNR.
double compare(const hmesh::Mesh& mesh, const hmesh::GpuOptions& options) {
    const hmesh::GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
    if (!buffers.status) {
        std::fprintf(stderr, "opengl_offscreen: %s\n", hmesh::message(buffers.status).c_str());
        return 0;
    }
    const double psnr = hmesh::psnr(drawn(buffers).view(), reference_of(mesh).view());
    const auto bytes = static_cast<double>(buffers.vertices.size() + buffers.indices.size());
    std::printf("| %d | %s | %s | %s of uint%u | %zu | %.2f | %.2f |\n", mesh.channels, name(options.position),
                name(options.color), options.topology == hmesh::GpuTopology::triangle_strip ? "strips" : "list",
                8 * hmesh::size_of(options.index), buffers.chunks.size(), bytes / static_cast<double>(mesh.vertex_count()), psnr);
    return psnr;
}

// The least PSNR of all layouts.
double compare_all(const hmesh::Mesh& mesh) {
    using hmesh::GpuFormat;
    std::puts("| channels | position | colour | indices | chunks | B/vertex | dB |\n|---|---|---|---|---|---|---|");
    const hmesh::Mesh gray = gray_of(mesh);
    double least = 1e9;
    hmesh::GpuOptions options;
    for (const GpuFormat color : {GpuFormat::unorm8x4, GpuFormat::unorm16x4, GpuFormat::unorm8x2, GpuFormat::unorm16x2})
        for (const GpuFormat position : {GpuFormat::unorm16x2, GpuFormat::float32x2})
            for (const auto topology : {hmesh::GpuTopology::triangle_list, hmesh::GpuTopology::triangle_strip})
                for (const auto index : {hmesh::GpuIndexFormat::uint16, hmesh::GpuIndexFormat::uint32})
                    for (const std::uint32_t chunk : {0U, 300U}) {
                        options = {position, color, hmesh::GpuAlpha::as_stored, topology, index, chunk};
                        least = std::min(least, compare(hmesh::components_of(color) == 2 ? gray : mesh, options));
                    }
    return least;
}

}  // namespace

int main(int argc, char** argv) {
    Picture picture = made_picture();
    hmesh::Options options;
    options.premultiplied = argc < 2;
    options.target = hmesh::Target::vertices(argc > 2 ? std::atoll(argv[2]) : 1500);
    if (argc > 1) {
        int width = 0, height = 0;
        unsigned char* const pixels = stbi_load(argv[1], &width, &height, nullptr, 4);
        if (pixels == nullptr) {
            std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason());
            return 2;
        }
        picture = Picture(width, height);
        std::copy_n(pixels, picture.size(), picture.data());
        stbi_image_free(pixels);
    }
    if (!make_context() || !make_target(picture.width(), picture.height())) {
        std::puts("skipped: there is no OpenGL 3.3");
        return 77;
    }
    std::printf("%s, %s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                reinterpret_cast<const char*>(glGetString(GL_VERSION)));
    const auto result = hmesh::mesh_image(picture.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    if (!result.has_mesh()) {
        std::fprintf(stderr, "opengl_offscreen: %s\n", hmesh::message(result.status).c_str());
        return 2;
    }
    const double least = compare_all(result.mesh);
    std::printf("%zu vertices, at least %.2f dB\n", result.mesh.vertex_count(), least);
    return least >= 50 ? 0 : 1;
}
