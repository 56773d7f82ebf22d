// hmesh tests - FuzzText: reads a file that an exporter wrote, and ends the program where it is not as it should be.
#ifndef HMESH_TESTS_FUZZ_FUZZ_TEXT_HPP
#define HMESH_TESTS_FUZZ_FUZZ_TEXT_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "fuzz_input.hpp"

namespace hmesh_test {

class FuzzText {
  public:
    // The text outlives the reader.
    explicit FuzzText(const std::string& text, std::size_t at = 0) noexcept : text_(&text), at_(at) {}

    [[nodiscard]] std::size_t at() const noexcept { return at_; }
    [[nodiscard]] std::size_t left() const noexcept { return text_->size() - at_; }
    [[nodiscard]] char next() const noexcept { return left() > 0 ? (*text_)[at_] : '\0'; }
    void skip(std::size_t count) {
        demand(count <= left(), "the file goes on");
        at_ += count;
    }
    // Whether these words are next; if so they are read.
    [[nodiscard]] bool accept(const char* words) {
        const std::size_t size = std::strlen(words);
        if (text_->compare(at_, size, words) != 0) return false;
        at_ += size;
        return true;
    }
    void expect(const char* words) { demand(accept(words), words); }
    void expect_end() const { demand(left() == 0, "the file ends here"); }
    // To the end of these words.
    std::string until(const char* words) {
        const std::size_t end = text_->find(words, at_);
        demand(end != std::string::npos, words);
        std::string between = text_->substr(at_, end - at_);
        at_ = end + std::strlen(words);
        return between;
    }
    // A finite number in figures, whatever the locale.
    double number() {
        const std::size_t size = text_->find_first_not_of("+-.0123456789eE", at_);
        const std::string figures = text_->substr(at_, size == std::string::npos ? size : size - at_);
        char* end = nullptr;
        const double value = std::strtod(figures.c_str(), &end);
        demand(!figures.empty() && *end == 0 && std::isfinite(value), "a finite number");
        at_ += figures.size();
        return value;
    }
    std::int64_t whole() {
        const double value = number();
        demand(value == std::floor(value) && std::abs(value) < 9007199254740992.0, "a whole number");
        return static_cast<std::int64_t>(value);
    }
    // Of so many bytes, little-endian.
    std::uint32_t word(std::size_t bytes = 4) {
        demand(bytes <= left(), "the file goes on");
        std::uint32_t value = 0;
        for (std::size_t i = bytes; i-- > 0;) value = value << 8U | static_cast<unsigned char>((*text_)[at_ + i]);
        at_ += bytes;
        return value;
    }
    float real() {
        const std::uint32_t bits = word();
        float value = 0;
        std::memcpy(&value, &bits, 4);
        demand(std::isfinite(value), "a finite number");
        return value;
    }

  private:
    const std::string* text_;
    std::size_t at_;
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_TEXT_HPP
