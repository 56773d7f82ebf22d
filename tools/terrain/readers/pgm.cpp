// Binary PGM files (P5), 8 or 16 bits: the samples as they are, not stretched to the maximum as those of pictures.
#include "readers/bytes.hpp"
#include "readers/plain_layout.hpp"
#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {

std::string open_pgm(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    auto grid = std::make_unique<GridFile>();
    std::vector<unsigned char> beginning;
    if (std::string why = grid->open(path); !why.empty()) return why;
    if (std::string why = grid->begin(1 << 16, beginning); !why.empty()) return why;
    const tool::Bytes file{beginning.data(), beginning.size()};
    if (!file.says(0, "P5")) return "it is no binary PGM file, which begins with P5";
    tool::PlainLayout layout;
    if (std::string why = tool::read_pnm_layout(file, layout); !why.empty()) return why;
    grid->width = layout.width;
    grid->height = layout.height;
    grid->maximum = layout.maximum;
    grid->offset = static_cast<std::int64_t>(layout.first);
    grid->type = layout.sample_bytes == 1 ? SampleType::u8 : SampleType::u16_big;
    grid->no_data = options.no_data;
    if (std::string why = grid->check(); !why.empty()) return why;
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
