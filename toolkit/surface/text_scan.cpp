// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/text_scan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace cinch {

TextScan::TextScan(std::string_view bytes, std::string file, TextSyntax syntax)
    : bytes_(bytes), file_(std::move(file)), syntax_(syntax)
{
    if (bytes_.starts_with("\xef\xbb\xbf"))
        at_ = 3; // a UTF-8 byte order mark
}

void TextScan::fail(const std::string& reason) const { throw InputError::at_line(file_, line_, reason); }

// Length of the line end at `at`, or 0.
static std::size_t line_end(std::string_view bytes, std::size_t at)
{
    if (at >= bytes.size())
        return 0;
    if (bytes[at] == '\n')
        return 1;
    if (bytes[at] == '\r')
        return at + 1 < bytes.size() && bytes[at + 1] == '\n' ? 2 : 1;
    return 0;
}

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

void TextScan::skip_blanks()
{
    for (;;) {
        while (at_ < bytes_.size() && is_blank(bytes_[at_]))
            ++at_;
        if (syntax_.joined_lines && at_ < bytes_.size() && bytes_[at_] == '\\') {
            if (const std::size_t end = line_end(bytes_, at_ + 1)) {
                at_ += 1 + end;
                ++line_;
                continue;
            }
        }
        return;
    }
}

bool TextScan::next_line()
{
    for (;;) {
        if (started_) {
            while (at_ < bytes_.size() && !line_end(bytes_, at_)) { // the rest of this line, comment included
                if (syntax_.joined_lines && bytes_[at_] == '\\' && line_end(bytes_, at_ + 1)) {
                    at_ += 1 + line_end(bytes_, at_ + 1);
                    ++line_;
                    continue;
                }
                ++at_;
            }
            if (const std::size_t end = line_end(bytes_, at_)) {
                at_ += end;
                ++line_;
            }
        }
        started_ = true;
        at_line_end_ = false;
        skip_blanks();
        if (at_ >= bytes_.size())
            return false;
        if (!line_end(bytes_, at_) && !starts_comment(at_))
            return true;
    }
}

std::string_view TextScan::word()
{
    if (at_line_end_)
        return {};
    skip_blanks();
    if (at_ >= bytes_.size() || line_end(bytes_, at_) || starts_comment(at_)) {
        at_line_end_ = true;
        return {};
    }
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !is_blank(bytes_[at_]) && !line_end(bytes_, at_) &&
           !(syntax_.comments_end_words && starts_comment(at_)) &&
           !(syntax_.joined_lines && bytes_[at_] == '\\' && line_end(bytes_, at_ + 1)))
        ++at_;
    return bytes_.substr(begin, at_ - begin);
}

std::string_view TextScan::word_across_lines(std::string_view what)
{
    if (!started_ && !next_line())
        fail("the file ends where " + std::string(what) + " was expected");
    for (;;) {
        if (const std::string_view w = word(); !w.empty())
            return w;
        if (!next_line())
            fail("the file ends where " + std::string(what) + " was expected");
    }
}

std::string printable(std::string_view word)
{
    std::string text;
    for (char c : word.substr(0, 40))
        text += c >= ' ' && c <= '~' ? c : '?';
    return word.size() > 40 ? text + "..." : text;
}

bool is_keyword(std::string_view word, std::string_view keyword)
{
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char a, char b) {
        return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
    });
}

double TextScan::number(std::string_view word, std::string_view what) const
{
    if (word.empty())
        fail("expected " + std::string(what) + ", found the end of the line");
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size() || digits.starts_with('+') ||
        (word.starts_with('+') && digits.starts_with('-')))
        fail("expected " + std::string(what) + ", found '" + printable(word) + "'");
    if (error == std::errc::result_out_of_range) {
        // from_chars reports underflow and overflow alike and stores nothing. The exponent's sign tells them apart
        // in every number that a program writes; without an exponent, overflow takes over 300 digits before the point.
        const std::size_t e = digits.find_first_of("eE");
        const bool tiny =
            e != std::string_view::npos ? e + 1 < digits.size() && digits[e + 1] == '-' : digits.find('.') < 300;
        if (tiny)
            return digits.starts_with('-') ? -0.0 : 0.0;
        fail(std::string(what) + " '" + printable(word) + "' is too large for a double");
    }
    if (!std::isfinite(value))
        fail(std::string(what) + " '" + printable(word) + "' is not finite");
    return value;
}

std::int64_t TextScan::integer(std::string_view word, std::string_view what) const
{
    if (word.empty())
        fail("expected " + std::string(what) + ", found the end of the line");
    std::int64_t value = 0;
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size())
        fail("expected " + std::string(what) + ", found '" + printable(word) + "'");
    return value;
}

Vec3 TextScan::point(std::string_view what)
{
    const double x = number(word(), what), y = number(word(), what), z = number(word(), what);
    return {x, y, z};
}

} // namespace cinch
