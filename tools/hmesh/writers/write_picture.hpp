// tools - writes a picture as PNG, one of the files of a run, and says why not as a sentence.
#ifndef HMESH_TOOLS_WRITERS_WRITE_PICTURE_HPP
#define HMESH_TOOLS_WRITERS_WRITE_PICTURE_HPP

#include <string>

#include "hmesh/core/status.hpp"
#include "terminal/words.hpp"
#include "writers/output_set.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"

namespace tool {

// `drawn`: whether there is a picture.
[[nodiscard]] inline std::string write_picture(OutputSet& files, const std::string& name, const hmesh::Status& drawn,
                                               const Picture& picture) {
    if (!drawn) return "cannot draw '" + name + "': " + in_words(drawn);
    return files.write(name, [&](OutputFile& file) {
        return write_png(picture, file) ? "" : "it has more than 2^30 samples, or there is no memory";
    });
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_WRITE_PICTURE_HPP
