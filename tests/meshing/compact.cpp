// hmesh tests - compact files. Tests compile these functions too, not optimised; of two inline ones the linker takes
// those of this library.
#include "hmesh/io/compact.hpp"

#include <cstddef>

namespace hmesh_test {

/// A function whose address is told is compiled.
extern hmesh::Status (*const write_compact)(const hmesh::MeshView&, hmesh::Sink,
                                            const hmesh::CompactOptions&) = &hmesh::write_compact;
extern hmesh::CompactMesh (*const read_compact)(const void*, std::size_t, const hmesh::CompactLimits&,
                                                const hmesh::CompactTable*) = &hmesh::read_compact;

}  // namespace hmesh_test
