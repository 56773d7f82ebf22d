/// \file
/// The frame of a PDF file: objects one after the other, and where each begins.
#ifndef HMESH_IO_DETAIL_PDF_FILE_HPP
#define HMESH_IO_DETAIL_PDF_FILE_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/sink.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A file of objects one after the other, numbered from 1, and the table of where each begins.
class PdfFile {
  public:
    /// Begins a file in a sink, whose callable outlives this object.
    explicit PdfFile(Sink sink) noexcept : writer_(sink) {
        writer_.text("%PDF-1.4\n%\xe2\xe3\xcf\xd3\n");  // 4 bytes above 127 say that the file is binary
    }
    PdfFile(const PdfFile&) = delete;
    PdfFile& operator=(const PdfFile&) = delete;

    /// Begins an object and its dictionary, whose entries are for the caller to put. At most 32 objects.
    Writer& begin_object() {
        HMESH_ASSERT(objects_ < offsets_.size());
        offsets_[objects_++] = writer_.position();
        writer_.decimal(static_cast<std::int64_t>(objects_));
        writer_.text(" 0 obj\n<< ");
        return writer_;
    }
    /// Ends an object without a stream, its dictionary by `more`.
    void end_object(const char* more = "") {
        writer_.text(more);
        writer_.text(" >>\nendobj\n");
    }
    /// Ends the object's dictionary and puts its stream.
    void end_object(const unsigned char* bytes, std::size_t size) {
        writer_.text("\n/Length ");
        writer_.decimal(static_cast<std::int64_t>(size));
        writer_.text(" >>\nstream\n");
        writer_.bytes(bytes, size);
        writer_.text("\nendstream\nendobj\n");
    }
    /// Ends the file, with the numbers of its catalog and of the object that says who made it.
    [[nodiscard]] Status finish(int root, int info) {
        const std::int64_t table = writer_.position();
        const auto entries = static_cast<std::int64_t>(objects_ + 1);
        writer_.text("xref\n0 ");
        writer_.decimal(entries);
        writer_.text("\n0000000000 65535 f \n");
        for (std::size_t i = 0; i < objects_; ++i) {
            std::int64_t first_digit = 1000000000;  // of 10
            for (; first_digit > 1 && offsets_[i] < first_digit; first_digit /= 10) writer_.text("0");
            writer_.decimal(offsets_[i]);
            writer_.text(" 00000 n \n");
        }
        writer_.text("trailer\n<< /Size ");
        writer_.decimal(entries);
        writer_.text(" /Root ");
        writer_.decimal(root);
        writer_.text(" 0 R /Info ");
        writer_.decimal(info);
        writer_.text(" 0 R >>\nstartxref\n");
        writer_.decimal(table);
        writer_.text("\n%%EOF\n");
        return writer_.finish();
    }

  private:
    Writer writer_;
    std::array<std::int64_t, 32> offsets_{};
    std::size_t objects_ = 0;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_PDF_FILE_HPP
