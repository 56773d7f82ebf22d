// turned - photographs as cameras store them: turned DIRECTORY writes 1.jpg to 8.jpg, one for each of Exif's orientations.
//
// 48 x 32 px as they are stored, each quarter of another colour: upright they are eight different pictures.
#include <cstdio>
#include <string>
#include <vector>

#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"

namespace {

tool::Picture quarters() {
    tool::Picture picture{48, 32, 3, {}};
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            for (const int sample : {x < 24 ? 200 : 60, y < 16 ? 180 : 40, (x < 24) == (y < 16) ? 90 : 150})
                picture.samples.push_back(static_cast<std::uint8_t>(sample));
    return picture;
}

bool write(const std::string& name, char orientation) {
    std::string jpeg;
    if (!tool::write_jpeg(quarters(), 95, hmesh::kit::append_to(jpeg))) return false;
    // A segment of 34 bytes, in it a table of one entry: tag 274, one number of 16 bits.
    std::string exif("\xff\xe1\0\42Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\0\0\0\0\0\0\0", 36);
    exif[29] = orientation;
    jpeg.insert(2, exif);
    tool::OutputFile file(name);
    return file.open() && file(jpeg.data(), jpeg.size()) && file.commit();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: turned DIRECTORY\n");
        return 2;
    }
    for (char k = 1; k <= 8; ++k)
        if (!write(std::string(argv[1]) + "/" + std::to_string(int{k}) + ".jpg", k)) return 1;
    return 0;
}
