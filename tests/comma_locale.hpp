// hmesh tests - CommaLocale: for its lifetime, numbers that streams print have a comma before decimals and groups of three
// digits, and those of the C library a comma too where such a locale is installed.
#ifndef HMESH_TESTS_COMMA_LOCALE_HPP
#define HMESH_TESTS_COMMA_LOCALE_HPP

#include <clocale>
#include <cstring>
#include <locale>
#include <string>

namespace hmesh_test {

class CommaLocale {
  public:
    CommaLocale() : c_before_(std::setlocale(LC_ALL, nullptr)) {
#if defined(__cpp_rtti) || defined(_CPPRTTI)  // else the standard library cannot tell what a facet is, and crashes
        std::locale::global(std::locale(std::locale::classic(), new Comma));
#endif
        for (const char* name :
             {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "pt_BR.UTF-8", "German_Germany.1252", "C.UTF-8"})
            if (std::setlocale(LC_ALL, name) != nullptr) break;
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;
    ~CommaLocale() {
        std::locale::global(before_);
        std::setlocale(LC_ALL, c_before_.c_str());
    }

    [[nodiscard]] static bool is_known_to_c() { return std::strcmp(std::localeconv()->decimal_point, ",") == 0; }

  private:
    struct Comma : std::numpunct<char> {
        [[nodiscard]] char do_decimal_point() const override { return ','; }
        [[nodiscard]] std::string do_grouping() const override { return "\3"; }
    };

    std::string c_before_;
    std::locale before_;  // a copy of the global one
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_COMMA_LOCALE_HPP
