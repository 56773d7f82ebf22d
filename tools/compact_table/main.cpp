// compact-table - learns the start table number 2 from compact files: compact-table [FILE.hmc...] > photographs.hpp
//
// Reads files that begin with that table, which has to say nothing as yet: without files it is made so. Sums up the bits that
// each context has seen; those that have seen enough come into the table with their share of ones, and so do all weights.
// scripts/train_table makes the files from photographs.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <hmesh/io/compact.hpp>
#include <hmesh/io/compact/photographs.hpp>

#include "readers/image_file.hpp"

namespace {

namespace detail = hmesh::detail;

constexpr std::size_t most_bytes = 12000;  // of both texts: twice as many save 0.1 % more

// What the files say of a context.
struct Share {
    double ones = 0, bits = 0;
};
// What they say of all, one file as much as another of its size.
struct Lesson {
    std::vector<Share> contexts;
    std::vector<double> weights;  // sums of what they became
    double files = 0;
};

// Adds what the contexts of a file have seen. Exit status of the program, 0 to go on.
int add(const char* path, Lesson& lesson) {
    std::vector<unsigned char> file;
    if (const std::string why = tool::read_file(path, file); !why.empty()) {
        std::fprintf(stderr, "compact-table: %s\n", why.c_str());
        return 1;
    }
    const hmesh::CompactTable& table = hmesh::compact_photographs;
    const hmesh::CompactMesh checked = hmesh::read_compact(file.data(), file.size(), {}, &table);
    if (!checked.status) {
        std::fprintf(stderr, "compact-table: %s: %s\n", path, hmesh::message(checked.status).c_str());
        return 1;
    }
    detail::ByteReader in(file.data() + detail::compact_checked, file.size() - detail::compact_checked);
    detail::CompactHead head;
    detail::CompactBody body;
    std::size_t at = 0, weight = 0;
    const double share = 1 / std::sqrt(static_cast<double>(file.size()));  // large files would drown small ones
    const auto learn = [&](const detail::Learnt& learnt) {
        for (const std::vector<detail::AdaptiveBit>* const contexts : learnt.contexts) {
            if (lesson.contexts.size() < at + contexts->size()) lesson.contexts.resize(at + contexts->size());
            for (const detail::AdaptiveBit& context : *contexts) {
                // A context that has seen n bits has the probability (ones + 1/4) / (n + 1/2).
                const double bits = context.seen();
                lesson.contexts[at].ones += share * (context.p16() / 65536.0 * (bits + 0.5) - 0.25);
                lesson.contexts[at].bits += share * bits;
                ++at;
            }
        }
        if (lesson.weights.size() < weight + learnt.weights->size()) lesson.weights.resize(weight + learnt.weights->size());
        for (const std::int32_t value : *learnt.weights) lesson.weights[weight++] += value;
    };
    hmesh::Status status = detail::get_head(in, head);
    detail::ArithmeticCoder coder(in.next(), in.left());
    if (status) status = table.code(coder, head, body, checked.mesh.vertex_count() + 4, &table, learn);
    if (!status) std::fprintf(stderr, "compact-table: %s: %s\n", path, hmesh::message(status).c_str());
    ++lesson.files;
    return status ? 0 : 1;
}

// The contexts that have seen at least so many bits.
std::string contexts_of(const Lesson& lesson, double least_bits, int& count) {
    std::string text;
    int passed = 0;
    count = 0;
    for (const Share& share : lesson.contexts) {
        if (share.bits < least_bits) {
            ++passed;
            continue;
        }
        const double p = (share.ones + 0.4) / (share.bits + 0.8);
        const double level = std::round(4 * std::log(p / (1 - p)));
        constexpr double far = detail::TableText::middle;
        std::string digits;
        for (int left = passed; left > 0 || digits.empty(); left /= detail::TableText::base) {
            const int more = digits.empty() ? 0 : detail::TableText::base;
            digits.insert(digits.begin(), detail::TableText::character(left % detail::TableText::base + more));
        }
        text += digits;
        text += detail::TableText::character(static_cast<int>(std::fmax(-far, std::fmin(far, level)) + far));
        passed = 0;
        ++count;
    }
    return text;
}
// All weights, each its mean over the files.
std::string weights_of(const Lesson& lesson) {
    constexpr double none = detail::TableText::none, last = 2 * detail::TableText::base - 1;
    std::string text;
    for (const double sum : lesson.weights) {
        const double symbol = std::round(sum / lesson.files / 1024) + none;
        text += detail::TableText::character(static_cast<int>(std::fmax(0, std::fmin(last, symbol))));
    }
    return text;
}

void print(const std::string& text) {
    constexpr std::size_t line = 120;
    if (text.empty()) std::printf("    \"\",\n");
    for (std::size_t at = 0; at < text.size(); at += line)
        std::printf("    \"%s\"%s\n", text.substr(at, line).c_str(), at + line < text.size() ? "" : ",");
}

}  // namespace

int main(int argc, char** argv) {
    Lesson lesson;
    for (int i = 1; i < argc; ++i)
        if (const int failed = add(argv[i], lesson); failed != 0) return failed;
    int count = 0;
    const std::string weights = weights_of(lesson);
    std::string contexts = contexts_of(lesson, 0.1, count);
    for (double least = 0.1; contexts.size() + weights.size() > most_bytes; least *= 1.02)
        contexts = contexts_of(lesson, least, count);
    std::printf(R"(/// \file
/// compact_photographs: what contexts of compact files begin with, learnt from files of photographs.
///
/// Generated by tools/compact_table from %d files: do not edit. It has %d contexts, each with two characters or more, and all
/// weights, and stands in a header of its own, for programs that only read and write files without it.
#ifndef HMESH_IO_COMPACT_PHOTOGRAPHS_HPP
#define HMESH_IO_COMPACT_PHOTOGRAPHS_HPP

#include "hmesh/io/compact/body.hpp"
#include "hmesh/io/compact/colors/foretelling.hpp"
#include "hmesh/io/compact/photographs_1.hpp"
#include "hmesh/io/compact/start_table.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// The start table number 2, for CompactOptions::table, CompactImageOptions::table and read_compact(), which reads those of
/// number 1 with it too: %zu bytes.
inline constexpr CompactTable compact_photographs{
    2, &detail::code_body<detail::StartTable, detail::AreaForetelling>,
)",
                argc - 1, count, contexts.size() + weights.size());
    print(contexts);
    print(weights);
    std::printf(R"(    &compact_photographs_1};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_PHOTOGRAPHS_HPP
)");
    return std::ferror(stdout) != 0 || std::fflush(stdout) != 0 ? 1 : 0;
}
