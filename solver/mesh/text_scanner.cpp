// Words and numbers of a text file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/text_scanner.h"

#include "solver/error.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace sinew::solver {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

template <class Number>
std::errc convert(std::string_view word, Number& value) {
    // from_chars takes no plus sign.
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return end == word.data() + word.size() ? error : std::errc::invalid_argument;
}

template <class Number>
bool parse(std::string_view word, Number& value) {
    return convert(word, value) == std::errc();
}

bool is_out_of_range(std::string_view word) {
    double value = 0;
    return convert(word, value) == std::errc::result_out_of_range;
}

} // namespace

void TextScanner::next_line() {
    if (at_ >= text_.size()) return;
    if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
    ++at_;
    ++line_;
}

void TextScanner::skip_space(bool over_lines) {
    while (at_ < text_.size()) {
        if (is_blank(text_[at_])) {
            ++at_;
        } else if (comment_ != 0 && text_[at_] == comment_) {
            while (at_ < text_.size() && !end_of_line(at_)) ++at_;
        } else if (over_lines && end_of_line(at_)) {
            next_line();
        } else {
            return;
        }
    }
}

std::string_view TextScanner::word_on_line() {
    skip_space(false);
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && !end_of_line(at_) &&
           !(comment_ != 0 && text_[at_] == comment_))
        ++at_;
    word_line_ = line_;
    return text_.substr(first, at_ - first);
}

std::string_view TextScanner::word() {
    skip_space(true);
    return word_on_line();
}

std::string_view TextScanner::peek() {
    const std::size_t at = at_;
    const int line = line_, word_line = word_line_;
    const std::string_view result = word();
    at_ = at, line_ = line, word_line_ = word_line;
    return result;
}

std::string_view TextScanner::rest_of_line() {
    const std::size_t first = at_;
    while (at_ < text_.size() && !end_of_line(at_)) ++at_;
    const std::string_view rest = text_.substr(first, at_ - first);
    word_line_ = line_;
    next_line();
    return rest;
}

double TextScanner::to_number(std::string_view word, std::string_view what) const {
    double value = 0;
    if (word.empty()) fail("the file ends where " + std::string(what) + " should stand");
    if (!parse(word, value)) {
        if (is_out_of_range(word)) {
            // Too small to represent is zero, too large is infinite.
            const std::size_t exponent = word.find_first_of("eE");
            if (exponent != std::string_view::npos && word.substr(exponent + 1, 1) == "-") return 0;
            value = std::numeric_limits<double>::infinity();
        } else {
            fail("'" + printable(word) + "' is not a number; " + std::string(what) + " was expected");
        }
    }
    if (!std::isfinite(value))
        throw Error("FE202", file_ + ":" + std::to_string(word_line_) + ": " + std::string(what) + " is '" +
                                 printable(word) + "', which is not finite");
    return value;
}

long long TextScanner::to_integer(std::string_view word, std::string_view what) const {
    long long value = 0;
    if (word.empty()) fail("the file ends where " + std::string(what) + " should stand");
    if (!parse(word, value))
        fail("'" + printable(word) + "' is not a whole number; " + std::string(what) + " was expected");
    return value;
}

double TextScanner::number(std::string_view what) { return to_number(word(), what); }
long long TextScanner::integer(std::string_view what) { return to_integer(word(), what); }

std::size_t TextScanner::count(std::string_view what) {
    const long long value = integer(what);
    if (value < 0) fail(std::string(what) + " is negative");
    if (static_cast<unsigned long long>(value) > remaining() / 2 + 1)
        fail(std::string(what) + " is " + std::to_string(value) + ", more than the rest of the file can hold");
    return static_cast<std::size_t>(value);
}

void TextScanner::fail(const std::string& problem) const {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))
        throw Error("IO403", file_ + " is text in UTF-16", "save it as UTF-8 or plain ASCII");
    throw Error("IO403", file_ + ":" + std::to_string(word_line_) + ": " + problem);
}

std::string printable(std::string_view word) {
    std::string result;
    for (char c : word.substr(0, 40)) result += c >= 32 && c < 127 ? c : '?';
    if (word.size() > 40) result += "...";
    return result;
}

} // namespace sinew::solver
