/// \file
/// PageOptions: how write_pdf() and write_eps() store the mesh in a page.
#ifndef HMESH_IO_PAGE_OPTIONS_HPP
#define HMESH_IO_PAGE_OPTIONS_HPP

#include <cstddef>
#include <vector>

#include "hmesh/core/function_ref.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_pdf() and write_eps(), which hold the mesh as the same stream of bytes.
struct PageOptions {
    /// A compressor that the program brings, since the library has none: it puts the zlib stream (RFC 1950) of `bytes`, such as
    /// zlib's compress2() makes, into `out`, which is empty. It says whether it could; false or an empty `out` is a failure.
    using Deflate = FunctionRef<bool(const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out)>;
    /// Compresses the stream, to about a half: 12 bytes a vertex instead of 21 in PDF. What it refers to must live until the
    /// exporter returns. None: the stream is written as it is.
    Deflate deflate;
    /// Whether a face shares two vertices with the one before it, wherever it can: a third of the size. Faces are then drawn
    /// in another order than the mesh's, which shows only where they overlap. False: each face by itself, in the mesh's order.
    bool strips = true;
    /// PDF, in strips: whether meshes that take poppler long are drawn in up to five parts, those of small and steep faces first,
    /// whose colours are stored as a half to a 16th, in a DeviceN space that multiplies them: io/detail/shading_parts.hpp.
    /// poppler is 2 to 8 times as fast and the file, deflated, 1.6 times as large. Programs that list inks call the components
    /// Red, Green and Blue; false: all is DeviceRGB, as it is in either case of meshes that take poppler less than a second.
    bool parts = true;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_PAGE_OPTIONS_HPP
