/// \file
/// CompactTable: what the contexts of a compact file begin with, where they would else know nothing.
///
/// A small file ends before its contexts have learnt much. What they learn of other files can be told them at the start: the
/// number of the table stands in the file, whose reader has to have it too. A table is a text, made by tools/compact_table; with
/// its number goes how colours are foretold.
#ifndef HMESH_IO_COMPACT_START_TABLE_HPP
#define HMESH_IO_COMPACT_START_TABLE_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/mixer.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

struct CompactHead;
struct CompactBody;
class ArithmeticCoder;

/// The tables of contexts of a coder, and the weights of its mixer.
struct Learnt {
    std::vector<std::vector<AdaptiveBit>*> contexts;
    std::vector<std::int32_t>* weights;
};

}  // namespace detail

/// A start table. hmesh/io/compact/photographs.hpp has those that there are.
struct CompactTable {
    /// Writes or reads a body as files with the table have it: code_body() of some kind.
    using Code = Status(detail::ArithmeticCoder& coder, const detail::CompactHead& head, detail::CompactBody& body,
                        std::size_t most_points, const CompactTable* table, FunctionRef<void(const detail::Learnt&)> hear);

    int number;                           ///< which one it is, in [1, 6], for files
    Code* code;                           ///< how files with it are coded
    const char* contexts = "";            ///< contexts and their probabilities, as docs/compact.md says; ends with a 0
    const char* weights = "";             ///< weights of mixed bits, likewise; may be empty
    const CompactTable* older = nullptr;  ///< another one, whose files are read too where this one is given

    /// That one of these of which a file has the number, or null.
    [[nodiscard]] const CompactTable* find(int wanted) const noexcept {
        const CompactTable* table = this;
        while (table != nullptr && table->number != wanted) table = table->older;
        return table;
    }
};

namespace detail {

/// The text of a table: symbols 0 to 89 as the characters from # to ~ but for ? and the backslash, so that it needs no escapes.
/// Contexts are counted through; of each that the table has, symbols say how many are passed over since the one before: the
/// digits of that in base 45, the highest first, with 45 added to all but the last. One more says its probability, in 4ths of the
/// logarithm's unit, with 44 added. Of the weights all are told, one symbol each: in 64ths, with 24 added.
struct TableText {
    static constexpr int base = 45;    ///< half of the symbols
    static constexpr int middle = 44;  ///< the symbol of the probability 1/2
    static constexpr int none = 24;    ///< the symbol of the weight 0

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

/// What is called with what a coder knows when all is coded.
using HearLearnt = FunctionRef<void(const Learnt&)>;

/// Of files without a table: coders begin with nothing, and nobody hears what they learn.
struct EmptyStart {
    EmptyStart(const CompactTable* /*table*/, HearLearnt /*hear*/) noexcept {}  ///< as StartTable
    template <class Coder>
    void begin(Coder& /*coder*/) noexcept {}  ///< as StartTable
    template <class Coder>
    void end(Coder& /*coder*/) const noexcept {}  ///< as StartTable
};

/// Gives contexts and weights what a table says of them, one coder after the other in the order of the file.
class StartTable {
  public:
    /// Of a table that outlives it. hear(), where set, is called with what each coder knows in the end, in the table's order.
    StartTable(const CompactTable* table, HearLearnt hear) noexcept : at_(table->contexts), weight_(table->weights), hear_(hear) {
        find_next();
    }

    /// Gives a coder, which comes next, what the table says.
    template <class Coder>
    void begin(Coder& coder) {
        start(coder.learnt());
    }
    /// All that the coder codes is coded.
    template <class Coder>
    void end(Coder& coder) const {
        if (hear_) hear_(coder.learnt());
    }

  private:
    static constexpr std::uint32_t bits_seen = 24;  // more trust loses where a file is of another kind, less where it is not

    void start(const Learnt& learnt) noexcept {
        for (std::vector<AdaptiveBit>* const table : learnt.contexts) {
            for (; next_ - first_ < table->size(); find_next()) {
                const int symbol = TableText::symbol(*at_++);
                (*table)[next_ - first_] = AdaptiveBit(Logistic::probability(64 * (symbol - TableText::middle)), bits_seen);
                ++next_;
            }
            first_ += table->size();
        }
        for (std::int32_t& weight : *learnt.weights) {
            const int symbol = TableText::symbol(*weight_);
            if (symbol < 0) break;
            weight = (symbol - TableText::none) * 1024;
            ++weight_;
        }
    }
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

    const char *at_, *weight_;
    HearLearnt hear_;
    std::size_t first_ = 0,  // the number of the first context of the table that comes
        next_ = 0;           // of the next one that the text has
};

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_START_TABLE_HPP
