// Binary PGM files (P5), 8 or 16 bits: the samples as they are, not stretched to the maximum as those of pictures.
#include "readers/bytes.hpp"
#include "readers/pnm_header.hpp"
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
    std::size_t at = 2;
    grid->width = tool::next_number(file, at);
    grid->height = tool::next_number(file, at);
    const int maximum = tool::next_number(file, at);
    if (at >= file.size) return tool::endless_header(file);
    if (grid->width < 1 || grid->height < 1) return "its PNM header has no valid size";
    if (maximum < 1 || maximum > 65535) return "its PNM header has no maximum from 1 to 65535";
    if (!tool::is_space(file.u8(at++))) return "its PNM header does not end in white space";
    grid->maximum = static_cast<std::uint32_t>(maximum);
    grid->offset = static_cast<std::int64_t>(at);
    grid->type = maximum > 255 ? SampleType::u16_big : SampleType::u8;
    grid->no_data = options.no_data;
    if (std::string why = grid->check(); !why.empty()) return why;
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
