// Some headers, the single headers, then headers again: whichever comes first, nothing is defined twice or missing. The program
// links, so nothing is defined in two of its translation units either.
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/methods/baselines/adams.hpp"

#include "../../single_include/hmesh.hpp"
#include "../../single_include/hmesh_paper.hpp"

#include "hmesh/hmesh.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/paper.hpp"

std::size_t size_as_svg(const hmesh::MeshView& mesh);  // alone.cpp

std::size_t size_as_svg(const hmesh::MeshView& mesh) {
    std::size_t sum = 0;
    const auto sink = [&sum](const void*, std::size_t size) {
        sum += size;
        return true;
    };
    return hmesh::write_svg(mesh, sink) ? sum : 0;
}
