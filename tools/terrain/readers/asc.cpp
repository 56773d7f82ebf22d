// Esri ASCII grids: six words with a number each, then the heights as text, the first row in the north. xllcorner is the corner
// of an area of which the height is the mean, xllcenter its centre.
#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <limits>

#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/grid_memory.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {
namespace {

// The file a piece at a time: it may be some gigabytes of text.
class Words {
  public:
    explicit Words(const std::string& path) : file_(std::fopen(path.c_str(), "rb"), std::fclose) {}
    [[nodiscard]] bool is_open() const noexcept { return file_ != nullptr; }
    [[nodiscard]] bool has_failed() const noexcept { return std::ferror(file_.get()) != 0; }

    // The next word; null at the end. Valid until the next call. One of more than 511 letters ends in dots there, as no number
    // does: the rest may be an exponent.
    [[nodiscard]] const char* next() {
        int c = get();
        while (c == ' ' || (c >= '\t' && c <= '\r')) c = get();
        if (c == EOF) return nullptr;
        std::size_t n = 0;
        for (; c != EOF && c != ' ' && !(c >= '\t' && c <= '\r'); c = get())
            if (n + 1 < sizeof word_) word_[n++] = static_cast<char>(c);
            else std::fill_n(word_ + n - 3, 3, '.');
        word_[n] = '\0';
        return word_;
    }

  private:
    int get() {
        if (at_ == end_) {
            end_ = std::fread(buffer_.data(), 1, buffer_.size(), file_.get());
            at_ = 0;
            if (end_ == 0) return EOF;
        }
        return static_cast<unsigned char>(buffer_[at_++]);
    }

    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16U);
    std::size_t at_ = 0, end_ = 0;
    char word_[512] = {};
};

bool parse(const char* text, double& value) {
    char* end = nullptr;
    value = std::strtod(text, &end);
    return end != text && *end == '\0';
}

std::string lower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
    return text;
}

// What the words of the head say.
struct Head {
    double columns = 0, rows = 0, x = 0, y = 0, step_x = 0, step_y = 0;
    bool has_x = false, has_y = false, is_center_x = false, is_center_y = false;
    std::optional<double> no_data;
};

// Reads the head and leaves the first height in `word`.
std::string read_head(Words& words, const char*& word, Head& head) {
    for (word = words.next(); word != nullptr; word = words.next()) {
        const std::string key = lower(word);
        if (key.empty() || ((key[0] < 'a' || key[0] > 'z') || key == "nan" || key == "inf")) break;
        const char* const text = words.next();
        double value = 0;
        if (text == nullptr || !parse(text, value)) return "its " + key + " has no number";
        if (key == "ncols") head.columns = value;
        else if (key == "nrows") head.rows = value;
        else if (key == "xllcorner" || key == "xllcenter") head.x = value, head.has_x = true;
        else if (key == "yllcorner" || key == "yllcenter") head.y = value, head.has_y = true;
        else if (key == "cellsize") head.step_x = head.step_y = value;
        else if (key == "dx") head.step_x = value;
        else if (key == "dy") head.step_y = value;
        else if (key == "nodata_value") head.no_data = value;
        else return "it is no Esri ASCII grid: its head has '" + key + "'";
        head.is_center_x = head.is_center_x || key == "xllcenter";
        head.is_center_y = head.is_center_y || key == "yllcenter";
    }
    const auto is_count = [](double n) { return n >= 1 && n <= INT_MAX && n <= std::floor(n); };
    if (!is_count(head.columns) || !is_count(head.rows)) return "its head has no ncols and nrows of 1 or more";
    if (!(head.step_x > 0) || !(head.step_y > 0) || !std::isfinite(head.step_x) || !std::isfinite(head.step_y))
        return "its head has no cellsize above 0";
    if (!std::isfinite(head.x) || !std::isfinite(head.y)) return "its head has a corner that is not finite";
    return {};
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_projected(const std::string& key) { return is_one_of(key, {"projcs", "projcrs", "projectedcrs"}); }

bool is_geographic(const std::string& key) {
    return is_one_of(key, {"geogcs", "geogcrs", "geographiccrs", "geodcrs", "geodeticcrs"});
}

// What well-known text of version 1 or 2 says of metres: the ellipsoid, the unit of the map, and whether that is an angle of so
// many `radians`.
class Wkt {
  public:
    Wkt(const std::string& text, Georeference& place) : place_(place) {
        std::string word;
        for (std::size_t at = 0; at < text.size(); ++at) {
            const char c = text[at];
            if (c == '"') {
                at = std::min(text.find('"', at + 1), text.size());
            } else if (c == '[' || c == '(') {
                open_.push_back({lower(word), 0});
                has_projection_ = has_projection_ || is_projected(open_.back().key);
                has_degrees_ = has_degrees_ || is_geographic(open_.back().key);
                word.clear();
            } else if (c == ',' || c == ']' || c == ')') {
                double value = 0;
                if (!open_.empty() && parse(word.c_str(), value)) take(value);
                word.clear();
                if (c != ',' && !open_.empty()) open_.pop_back();
            } else if (c != ' ' && !(c >= '\t' && c <= '\r')) {
                word += c;
            }
        }
        place.is_geographic = has_degrees_ && !has_projection_;
    }

    double radians = 0;  // 0: no unit of angles is said

  private:
    struct Open {
        std::string key;
        int numbers;
    };

    void take(double value) {
        const std::string& key = open_.back().key;
        const auto around = [&](std::size_t steps) {
            return open_.size() > steps ? open_[open_.size() - 1 - steps].key : std::string();
        };
        const int number = ++open_.back().numbers;
        if (key == "spheroid" || key == "ellipsoid") {
            if (number == 1 && value > 0) place_.semi_major = value;
            if (number == 2 && value >= 0) place_.inverse_flattening = value;
        } else if (key.size() >= 4 && key.compare(key.size() - 4, 4, "unit") == 0 && number == 1 && value > 0) {
            // In version 2 axes may have units of their own: that of heights, if there is one, is the last.
            const std::string of = around(around(1) == "axis" ? 2 : 1);
            if (!has_unit_ && (is_projected(of) || of == "local_cs")) place_.unit = value, has_unit_ = true;
            if (radians == 0 && key != "lengthunit" && is_geographic(of)) radians = value;
        }
    }

    Georeference& place_;
    std::vector<Open> open_;
    bool has_projection_ = false, has_degrees_ = false, has_unit_ = false;
};

}  // namespace

std::string read_prj(std::string path, Georeference& place) {
    if (path.size() < 4) return {};
    std::ifstream file(path.replace(path.size() - 4, 4, ".prj"), std::ios::binary);
    if (!file.is_open()) file.open(path.replace(path.size() - 4, 4, ".PRJ"), std::ios::binary);
    place.crs.assign(std::istreambuf_iterator<char>(file), {});
    if (place.crs.size() > 65536) place.crs.clear();
    while (!place.crs.empty() && (place.crs.back() == '\n' || place.crs.back() == '\r')) place.crs.pop_back();
    if (lower(place.crs.substr(0, 10)) == "projection") return "its '" + path + "' is one of ArcInfo, no WKT: GDAL reads that";
    const double radians = Wkt(place.crs, place).radians;
    if (place.is_geographic) place.make_degrees(radians);
    return {};
}

std::string open_asc(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    errno = 0;
    Words words(path);
    if (!words.is_open()) return std::strerror(errno);
    Head head;
    const char* word = nullptr;
    if (std::string why = read_head(words, word, head); !why.empty()) return words.has_failed() ? std::strerror(errno) : why;
    auto grid = std::make_unique<GridMemory>();
    grid->width = static_cast<int>(head.columns);
    grid->height = static_cast<int>(head.rows);
    grid->reader = "hmesh";
    grid->no_data = options.no_data ? options.no_data : head.no_data;
    // No word of the head is believed before as many heights are there.
    const std::int64_t count = static_cast<std::int64_t>(grid->width) * grid->height;
    for (; word != nullptr && static_cast<std::int64_t>(grid->heights.size()) < count; word = words.next()) {
        double value = 0;
        if (!parse(word, value))
            return "row " + std::to_string(static_cast<std::int64_t>(grid->heights.size()) / grid->width) + " has '" + word +
                   "', which is no number";
        const bool is_none = is_no_data(value, grid->no_data) || !std::isfinite(static_cast<float>(value));
        grid->heights.push_back(is_none ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value));
        if (!is_none) grid->rounding = std::max(grid->rounding, std::fabs(value - static_cast<double>(grid->heights.back())));
    }
    if (words.has_failed()) return std::strerror(errno);
    if (static_cast<std::int64_t>(grid->heights.size()) < count)
        return "the file ends before its last height (" + std::to_string(grid->heights.size()) + " of " + std::to_string(count) +
               ")";
    // Without a corner the northern one is at 0, 0, as GDAL has it: cells have their size all the same.
    const bool has_corner = head.has_x && head.has_y;
    const double west = has_corner ? head.x + (head.is_center_x ? 0 : 0.5) * head.step_x : 0.5 * head.step_x;
    const double north = has_corner ? head.y + (head.rows - (head.is_center_y ? 1 : 0.5)) * head.step_y : -0.5 * head.step_y;
    grid->place.is_known = true;
    grid->place.transform = {west, head.step_x, 0, north, 0, -head.step_y};
    if (std::string why = read_prj(path, grid->place); !why.empty()) return why;
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
