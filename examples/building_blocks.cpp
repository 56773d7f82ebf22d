// building_blocks - from a picture to a mesh and back to a picture, with the parts that methods are made of, one after another:
//
//     pyramid -> points -> half-edge mesh -> moments -> K and its normal equations -> flip queue -> picture
//
// usage: building_blocks OUT.png [IMAGE]        without IMAGE: a picture of its own
//
// It is "Image meshing via hierarchical optimization" in short, less the steps that move vertices (hmesh::Hierarchical has them).
// In the paper's words a picture I has a row for each channel and a column for each pixel, the mesh has colours I(V), and column
// p of the sparse matrix K holds the three barycentric coordinates of pixel p in the triangle that it lies in. So what the mesh
// shows is I(V) K, and the best colours for these triangles solve K K^T I(V)^T = K I^T.
#include <hmesh/paper.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

namespace {

namespace kit = hmesh::kit;
using Picture = hmesh::Image<std::uint8_t, 3>;

// Three balls in front of a wall.
Picture draw_balls(int width, int height) {
    Picture picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double color[3] = {0.8 - 0.3 * y / height, 0.7 - 0.2 * y / height, 0.6 + 0.1 * x / width};
            for (int ball = 0; ball < 3; ++ball) {
                const double u = (x - width * (0.22 + 0.28 * ball)) / (0.18 * height);
                const double v = (y - height * (0.35 + 0.15 * ball)) / (0.18 * height), z = 1 - u * u - v * v;
                const double light = z < 0 ? 1 - 0.5 * std::exp(z) : std::max(0.1, 0.7 * std::sqrt(z) - 0.4 * u - 0.5 * v);
                for (int c = 0; c < 3; ++c) color[c] = (z < 0 ? color[c] : c == ball ? 1 : 0.4) * light;
            }
            for (int c = 0; c < 3; ++c) picture.pixel(x, y)[c] = hmesh::PixelTraits<std::uint8_t>::from_real(255 * color[c]);
        }
    return picture;
}

// One for 50 pixels, as dense as the picture bends (the feature map), by error diffusion.
std::vector<kit::Point> place_points(const kit::ImageSource<3>& image) {
    const hmesh::Image<float, 1> map = kit::feature_map(image);
    std::vector<kit::Point> points;
    for (const std::uint32_t pixel : kit::diffused_points(map.view(), map.size() / 50))
        points.push_back(kit::pixel_vertex(pixel, image.width(), image.height()));
    return points;
}

// Half-edges by example: a walk along the border. A vertex on it leads to its half-edge that has no face.
std::size_t border_edges(const kit::HalfedgeMesh& mesh, kit::Vertex corner) {
    std::size_t count = 1;
    for (kit::Halfedge h = mesh.halfedge(corner); mesh.to_vertex(h) != corner; h = mesh.next(h)) ++count;
    return count;
}

void print_error(int level, const char* step, int count, const kit::ImageMesh<3>& mesh) {
    const double samples = 3.0 * mesh.width() * mesh.height();
    std::printf("  level %d, %5d %-22s %7.3f dB\n", level, count, step, kit::psnr_of_energy(mesh.energy(), samples, 255));
}

// The largest difference between what render() draws and what K says, on the scale of 0 to 255.
double largest_difference(const hmesh::Image<float, 3>& drawn, const kit::ImageMesh<3>& mesh) {
    const Eigen::MatrixXd shown = kit::barycentric_matrix(mesh).transpose() * kit::color_matrix(mesh);  // (I(V) K)^T
    using Samples = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    return (Eigen::Map<const Samples>(drawn.data(), shown.rows(), 3).cast<double>() - shown).cwiseAbs().maxCoeff();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) {
        std::fprintf(stderr, "usage: building_blocks OUT.png [IMAGE]\n");
        return 2;
    }
    Picture picture = draw_balls(320, 224);
    if (argc == 3) {
        int width = 0, height = 0;
        stbi_uc* const pixels = stbi_load(argv[2], &width, &height, nullptr, 3);
        if (pixels == nullptr) {
            std::fprintf(stderr, "building_blocks: %s: %s\n", argv[2], stbi_failure_reason());
            return 1;
        }
        picture = Picture(width, height);
        std::copy_n(pixels, picture.size(), picture.data());
        stbi_image_free(pixels);
    }

    // Level 0 of the pyramid is the picture, level 1 what a bilateral filter leaves of it: edges without texture. The mesh begins
    // as Delaunay's triangulation of points on the coarse level.
    const kit::Pyramid<std::uint8_t, 3> pyramid = kit::make_pyramid(picture.view(), 2);
    const kit::ImageSource<3> coarse(pyramid.level(1));
    const kit::Delaunay delaunay = kit::triangulate(picture.width(), picture.height(), place_points(coarse));
    hmesh::Mesh result = kit::to_mesh(kit::delaunay_mesh(coarse, delaunay), 255);
    const kit::HalfedgeMesh& halfedges = delaunay.topology();
    std::printf("%zu vertices, %zu edges, of which %zu on the border, %zu faces\n", halfedges.vertex_count(),
                halfedges.edge_count(), border_edges(halfedges, kit::Vertex(0)), halfedges.face_count());

    std::printf("PSNR = 10 log10(255^2 / MSE), MSE the mean over pixels and channels of that level:\n");
    for (int level = 1; level >= 0; --level) {
        // An ImageMesh knows the error of each face from the moment table, sums along the rows of the level.
        const kit::MomentTable<3> table(pyramid.level(level), pyramid.level(level).bounds());
        kit::ImageMesh<3> mesh(table, 0, 255);
        if (!mesh.assign(result)) return 1;
        print_error(level, "vertices", static_cast<int>(mesh.vertex_count()), mesh);
        for (int round = 0; round < 2; ++round) {
            // The normal equations follow from the moments, without a product of matrices; conjugate gradients solve them.
            Eigen::MatrixXd colors = kit::color_matrix(mesh);  // where to start
            const kit::PcgReport pcg = kit::solve_pcg(kit::gram_matrix(mesh), kit::image_rhs(mesh), colors);
            kit::set_colors(mesh, colors);
            print_error(level, "iterations for colours", pcg.iterations, mesh);
            // An edge turns where that lowers the error; those come first whose faces have most of it.
            const std::size_t flips = kit::run_flip_queue(mesh);
            print_error(level, "edges turned", static_cast<int>(flips), mesh);
        }
        result = kit::to_mesh(mesh, 255);  // for the next level to begin with, and to be drawn
        if (level > 0) continue;

        const auto [drawn, status] = hmesh::render<3>(result.view());
        const double difference = status ? largest_difference(drawn, mesh) : 255;
        std::printf("drawn: %.3f dB; I(V) K is the same to %.0e\n", hmesh::psnr(picture.view(), drawn.view()), difference);
        if (difference > 1e-3) return 1;  // colours of a Mesh are floats
        const Picture pixels = hmesh::to_pixels<std::uint8_t>(drawn);
        // Not stbi_write_png(), which does not see that a disk is full.
        std::FILE* const file = std::fopen(argv[1], "wb");
        const auto put = [](void* to, void* bytes, int size) {
            std::fwrite(bytes, 1, static_cast<std::size_t>(size), static_cast<std::FILE*>(to));
        };
        if (file == nullptr || stbi_write_png_to_func(put, file, picture.width(), picture.height(), 3, pixels.data(), 0) == 0 ||
            std::fflush(file) != 0 || std::ferror(file) != 0 || std::fclose(file) != 0) {
            std::fprintf(stderr, "building_blocks: cannot write '%s'\n", argv[1]);
            return 1;
        }
    }
    return 0;
}
