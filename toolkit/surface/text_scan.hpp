// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "cinch/surface.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// What a format makes of characters other than blanks and line ends.
struct TextSyntax {
    char comment = 0;                ///< a word that starts with this character ends its line; 0 for none
    bool comments_end_words = false; ///< the same within a word: "1#note" is the word "1"
    bool joined_lines = false;       ///< a backslash before the line end joins the next line (OBJ)
};

/// Walks over a text file in memory, line by line and word by word, and knows where it stands.
/// Lines end at LF, CR LF or a lone CR. Words are separated by blanks.
class TextScan {
public:
    TextScan(std::string_view bytes, std::string file, TextSyntax syntax = {});

    /// Goes to the next line that has a word; false at the end of the file.
    bool next_line();
    /// The next word of this line; empty at its end.
    std::string_view word();
    /// The next word, going on to following lines if need be; at the end of the file, an error that says what is
    /// missing.
    std::string_view word_across_lines(std::string_view what);

    std::size_t line() const { return line_; }
    std::size_t bytes_left() const { return static_cast<std::size_t>(bytes_.size() - at_); }
    std::size_t byte() const { return at_; }

    /// A finite decimal number. Too large for a double, NaN and infinity are errors; too small becomes 0 or subnormal.
    double number(std::string_view word, std::string_view what) const;
    std::int64_t integer(std::string_view word, std::string_view what) const;
    /// Three finite coordinates from this line.
    Vec3 point(std::string_view what);

    [[noreturn]] void fail(const std::string& reason) const;

private:
    void skip_blanks();
    bool starts_comment(std::size_t at) const { return syntax_.comment && bytes_[at] == syntax_.comment; }

    std::string_view bytes_;
    std::string file_;
    TextSyntax syntax_;
    std::size_t at_ = 0;   // the next byte to read
    std::size_t line_ = 1; // of bytes_[at_]
    bool at_line_end_ = false;
    bool started_ = false;
};

/// A word for an error message: printable ASCII only, cut after 40 characters.
std::string printable(std::string_view word);

/// Whether a word is this keyword, which is in lower case, in any case.
bool is_keyword(std::string_view word, std::string_view keyword);

} // namespace cinch
