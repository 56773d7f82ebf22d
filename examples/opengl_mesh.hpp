// opengl_mesh - the buffers of pack_for_gpu() in OpenGL 3.3 core: what opengl_offscreen.cpp and sdl_window.cpp share.
//
// An OpenGL context is current wherever this is used. Functions of OpenGL are linked, as Linux has them; elsewhere a loader such
// as libepoxy or glad brings them.
#ifndef HMESH_EXAMPLES_OPENGL_MESH_HPP
#define HMESH_EXAMPLES_OPENGL_MESH_HPP

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <hmesh/gpu.hpp>

namespace example {

// Positions become px, and px the clip space, y up; colours are passed on as they are stored.
inline const char* const vertex_shader = R"(#version 330 core
layout(location = 0) in vec2 position;
layout(location = 1) in vec4 color;
uniform vec2 scale, offset, size;
uniform bool gray;
out vec4 shade;
void main() {
    vec2 at = (offset + scale * position) / size;
    gl_Position = vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
    shade = gray ? color.rrrg : color;
}
)";
inline const char* const fragment_shader = R"(#version 330 core
in vec4 shade;
out vec4 pixel;
void main() { pixel = shade; }
)";

// A mesh in buffers of the GPU.
class OpenglMesh {
  public:
    explicit OpenglMesh(const hmesh::GpuBuffers& buffers)
        : chunks_(buffers.chunks), layout_(buffers.layout), program_(glCreateProgram()) {
        add_shader(GL_VERTEX_SHADER, vertex_shader);
        add_shader(GL_FRAGMENT_SHADER, fragment_shader);
        glLinkProgram(program_);
        glGenVertexArrays(1, &array_);
        glBindVertexArray(array_);
        glGenBuffers(2, buffers_);
        glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(buffers.vertices.size()), buffers.vertices.data(), GL_STATIC_DRAW);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[1]);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(buffers.indices.size()), buffers.indices.data(),
                     GL_STATIC_DRAW);
        add_attribute(0, layout_.position);
        add_attribute(1, layout_.color);
    }
    OpenglMesh(const OpenglMesh&) = delete;
    OpenglMesh& operator=(const OpenglMesh&) = delete;
    ~OpenglMesh() {
        glDeleteBuffers(2, buffers_);
        glDeleteVertexArrays(1, &array_);
        glDeleteProgram(program_);
    }

    // Fills the viewport with the mesh. Transparent colours are blended if that is enabled.
    void draw() const {
        glUseProgram(program_);
        glUniform2f(uniform("scale"), layout_.scale[0], layout_.scale[1]);
        glUniform2f(uniform("offset"), layout_.offset[0], layout_.offset[1]);
        glUniform2f(uniform("size"), static_cast<float>(layout_.width), static_cast<float>(layout_.height));
        glUniform1i(uniform("gray"), hmesh::components_of(layout_.color.format) == 2 ? 1 : 0);
        const bool is_strip = layout_.topology == hmesh::GpuTopology::triangle_strip;
        (is_strip ? glEnable : glDisable)(GL_PRIMITIVE_RESTART);
        glPrimitiveRestartIndex(layout_.restart);
        glBlendFunc(layout_.premultiplied ? GL_ONE : GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        glBindVertexArray(array_);
        const std::uint32_t index_size = hmesh::size_of(layout_.index);
        for (const hmesh::GpuChunk& chunk : chunks_)
            glDrawElementsBaseVertex(is_strip ? GL_TRIANGLE_STRIP : GL_TRIANGLES, static_cast<GLsizei>(chunk.index_count),
                                     index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
                                     as_pointer(std::size_t{index_size} * chunk.first_index),
                                     static_cast<GLint>(chunk.first_vertex));
    }

  private:
    // Offsets are pointers in OpenGL.
    static const void* as_pointer(std::size_t offset) {
        return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
    }
    [[nodiscard]] GLint uniform(const char* name) const { return glGetUniformLocation(program_, name); }
    void add_shader(GLenum kind, const char* source) const {
        const GLuint shader = glCreateShader(kind);
        glShaderSource(shader, 1, &source, nullptr);
        glCompileShader(shader);
        GLint is_good = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
        if (is_good == 0) std::fprintf(stderr, "a shader does not compile\n");
        glAttachShader(program_, shader);
        glDeleteShader(shader);
    }
    void add_attribute(GLuint location, const hmesh::GpuAttribute& attribute) const {
        const std::uint32_t count = hmesh::components_of(attribute.format), bytes = hmesh::size_of(attribute.format) / count;
        const GLenum type = bytes == 4 ? GL_FLOAT : bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_BYTE;
        glEnableVertexAttribArray(location);
        glVertexAttribPointer(location, static_cast<GLint>(count), type, type == GL_FLOAT ? GL_FALSE : GL_TRUE,
                              static_cast<GLsizei>(layout_.stride), as_pointer(attribute.offset));
    }

    std::vector<hmesh::GpuChunk> chunks_;
    hmesh::GpuLayout layout_;
    GLuint program_, array_ = 0, buffers_[2] = {0, 0};
};

}  // namespace example

#endif  // HMESH_EXAMPLES_OPENGL_MESH_HPP
