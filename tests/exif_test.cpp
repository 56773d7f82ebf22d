#include "readers/exif.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

TEST_CASE("pictures are turned upright from all eight orientations") {
    // Stored so that the upright one reads ABC above DEF: its first row is the top, top, bottom, bottom, left side, right side,
    // right side, left side, beginning left, right, right, left, top, top, bottom, bottom.
    struct Stored {
        unsigned orientation;
        int width;
        const char* pixels;
    };
    const Stored cases[] = {{1, 3, "ABCDEF"}, {2, 3, "CBAFED"}, {3, 3, "FEDCBA"}, {4, 3, "DEFABC"},
                            {5, 2, "ADBECF"}, {6, 2, "CFBEAD"}, {7, 2, "FCEBDA"}, {8, 2, "DAEBFC"}};
    for (const Stored& stored : cases) {
        CAPTURE(stored.orientation);
        const std::string letters = stored.pixels;
        for (const int channels : {1, 3}) {
            std::vector<int> samples;
            for (const char letter : letters)
                for (int c = 0; c < channels; ++c) samples.push_back(letter + 100 * c);
            int width = stored.width, height = 6 / stored.width;
            tool::turn_upright(stored.orientation, channels, width, height, samples);
            CHECK(width == 3);
            CHECK(height == 2);
            REQUIRE(samples.size() == 6 * static_cast<std::size_t>(channels));
            for (std::size_t k = 0; k < samples.size(); ++k) {
                const auto c = static_cast<int>(k) % channels;
                CHECK(samples[k] == "ABCDEF"[k / static_cast<std::size_t>(channels)] + 100 * c);
            }
        }
    }
}
