// Words and numbers of a text file, with line numbers for messages. Locale independent, no copies.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace sinew::solver {

/// Reads words from text, behind a byte order mark if it begins with one. `\n`, `\r\n` and lone `\r` end a line; a
/// comment runs from the comment character to the end of its line (0 = no comments). Every failure is Error IO403
/// "<file>:<line>: what is wrong", or FE202 for a number that is not finite.
class TextScanner {
  public:
    TextScanner(std::string_view text, std::string file, char comment = '#')
        : text_(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text)
        , file_(std::move(file))
        , comment_(comment) {}

    /// The next word, on whatever line; empty at the end of the text.
    std::string_view word();
    /// The next word if it stands on the current line; empty otherwise.
    std::string_view word_on_line();
    /// The next word without taking it.
    std::string_view peek();
    /// The rest of the current line, without its end; moves to the next line.
    std::string_view rest_of_line();
    bool at_end() { return peek().empty(); }

    /// The next word as a number; `what` names it in the message.
    double number(std::string_view what);
    long long integer(std::string_view what);
    /// A count of things of which each takes at least two bytes of the text that is left (one digit, one
    /// separator); so a count that would ask for more memory than the file justifies is refused first.
    std::size_t count(std::string_view what);
    double to_number(std::string_view word, std::string_view what) const;
    long long to_integer(std::string_view word, std::string_view what) const;

    /// The line of the last word.
    int line() const { return word_line_; }
    std::size_t remaining() const { return text_.size() - at_; }
    [[noreturn]] void fail(const std::string& problem) const;

  private:
    void skip_space(bool over_lines);
    bool end_of_line(std::size_t i) const { return text_[i] == '\n' || text_[i] == '\r'; }
    void next_line();

    std::string_view text_;
    std::string file_;
    char comment_;
    std::size_t at_ = 0;
    int line_ = 1, word_line_ = 1;
};

/// A word fit for a message: cut to 40 characters, unprintable bytes shown as '?'.
std::string printable(std::string_view word);

} // namespace sinew::solver
