// sdl_window - shows an image as a mesh in a window that can be made any size: sdl_window IMAGE [VERTICES]
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include <SDL2/SDL.h>
#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

#include "opengl_mesh.hpp"

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: sdl_window IMAGE [VERTICES]\n");
        return 2;
    }
    int width = 0, height = 0;
    unsigned char* pixels = stbi_load(argv[1], &width, &height, nullptr, 3);
    if (pixels == nullptr) {
        std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason());
        return 1;
    }
    hmesh::Options options;
    if (argc == 3) options.target = hmesh::Target::vertices(std::atoll(argv[2]));
    const hmesh::ImageView<std::uint8_t, 3> image{pixels, width, height};
    const auto result = hmesh::mesh_image(image, options, hmesh::Annealed{hmesh::Effort::draft});
    stbi_image_free(pixels);
    const hmesh::GpuBuffers buffers = hmesh::pack_for_gpu(result.mesh.view());
    if (!result.has_mesh() || !buffers.status) {
        std::fprintf(stderr, "%s\n", hmesh::message(result.has_mesh() ? buffers.status : result.status).c_str());
        return 1;
    }

    SDL_Init(SDL_INIT_VIDEO);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
    SDL_GL_SetAttribute(SDL_GL_MULTISAMPLEBUFFERS, 1);
    SDL_GL_SetAttribute(SDL_GL_MULTISAMPLESAMPLES, 4);
    SDL_Window* const window = SDL_CreateWindow("hmesh", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height,
                                                SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    SDL_GLContext context = window == nullptr ? nullptr : SDL_GL_CreateContext(window);
    if (context == nullptr) {
        std::fprintf(stderr, "sdl_window: %s\n", SDL_GetError());
        return 1;
    }
    {
        const example::OpenglMesh mesh(buffers);
        for (bool is_open = true; is_open;) {
            int wide = 0, high = 0;
            SDL_GL_GetDrawableSize(window, &wide, &high);
            glViewport(0, 0, wide, high);
            mesh.draw();
            SDL_GL_SwapWindow(window);
            SDL_Event event;
            SDL_WaitEvent(&event);
            is_open = event.type != SDL_QUIT && !(event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_ESCAPE);
        }
    }
    SDL_GL_DeleteContext(context);
    SDL_DestroyWindow(window);
    SDL_Quit();
    return 0;
}
