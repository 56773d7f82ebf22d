/// \file
/// CompactTable: what the contexts of a compact file begin with, where they would else know nothing.
///
/// A small file ends before its contexts have learnt much. What they learn of other files can be told them at the start: the
/// number of the table stands in the file, whose reader has to have it too. A table is a text, made by tools/compact_table.
#ifndef HMESH_IO_COMPACT_START_TABLE_HPP
#define HMESH_IO_COMPACT_START_TABLE_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/compact/mixer.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// A start table. hmesh/io/compact/photographs.hpp has the one that there is.
struct CompactTable {
    int number = 0;         ///< which one it is, in [1, 6], for files
    const char* text = "";  ///< contexts and their probabilities, as docs/compact.md says; ends with a 0
};

namespace detail {

/// The tables of contexts of a coder.
using ContextTables = std::vector<std::vector<AdaptiveBit>*>;

/// The text of a table: symbols 0 to 89 as the characters from # to ~ but for ? and the backslash, so that it needs no escapes.
/// Contexts are counted through; of each that the table has, symbols say how many are passed over since the one before: the
/// digits of that in base 45, the highest first, with 45 added to all but the last. One more says its probability, in 4ths of the
/// logarithm's unit, with 44 added.
struct TableText {
    static constexpr int base = 45;    ///< half of the symbols
    static constexpr int middle = 44;  ///< the symbol of the probability 1/2

    /// The character of a symbol.
    [[nodiscard]] static constexpr char character(int symbol) noexcept {
        const int code = '#' + symbol;
        return static_cast<char>(code + (code >= '?' ? 1 : 0) + (code + 1 >= '\\' ? 1 : 0));
    }
    /// The symbol of a character; below 0: there is none.
    [[nodiscard]] static constexpr int symbol(char character) noexcept {
        if (character < '#' || character > '~' || character == '?' || character == '\\') return -1;
        return character - '#' - (character > '?' ? 1 : 0) - (character > '\\' ? 1 : 0);
    }
};

/// Gives contexts what a table says of them, one coder after the other in the order of the file.
class StartTable {
  public:
    /// Of a table that outlives it; null: all begin with nothing.
    explicit StartTable(const CompactTable* table) noexcept : at_(table == nullptr ? "" : table->text) { find_next(); }

    /// Gives these, which come next, what the table says.
    void start(const ContextTables& tables) noexcept {
        for (std::vector<AdaptiveBit>* const table : tables) {
            for (; next_ - first_ < table->size(); find_next()) {
                const int symbol = TableText::symbol(*at_++);
                (*table)[next_ - first_] = AdaptiveBit(Logistic::probability(64 * (symbol - TableText::middle)), bits_seen);
                ++next_;
            }
            first_ += table->size();
        }
    }

  private:
    static constexpr std::uint32_t bits_seen = 24;  // more trust loses where a file is of another kind, less where it is not

    // Moves next_ on to the context whose probability is at at_; beyond all where the text ends.
    void find_next() noexcept {
        std::size_t passed = 0;
        for (bool has_more = true; has_more; ++at_) {
            const int symbol = TableText::symbol(*at_);
            if (symbol < 0 || TableText::symbol(at_[1]) < 0) {
                next_ = static_cast<std::size_t>(-1);
                return;
            }
            has_more = symbol >= TableText::base;
            passed = passed * TableText::base + static_cast<std::size_t>(symbol % TableText::base);
        }
        next_ += passed;
    }

    const char* at_;
    std::size_t first_ = 0,  // the number of the first context of the table that comes
        next_ = 0;           // of the next one that the text has
};

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_START_TABLE_HPP
