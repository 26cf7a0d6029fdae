// Words of a command line against a command's declaration. Anything undeclared is an error with the nearest
// name.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/command.h"
#include "tools/embed/most_threads.h"

#include <climits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>

namespace sinew::cli {

/// The command line is wrong: exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

class Arguments {
  public:
    /// `--flag value`, `--flag=value`, `-f value`, `--` before words that start with a dash. Throws
    /// UsageError.
    Arguments(const Command& command, std::span<const std::string> words);

    bool has(std::string_view flag) const { return flags_.contains(flag); }
    /// Of a flag that was given; the last one if it was repeated.
    std::optional<std::string> value(std::string_view flag) const;
    std::vector<std::string> values(std::string_view flag) const;
    /// Throws UsageError unless the value is a whole number from `least` to `most`.
    int whole_number(std::string_view flag, int otherwise, int least, int most = INT_MAX) const;
    std::vector<double> numbers(std::string_view flag, std::vector<double> otherwise) const; ///< "24,40"
    std::optional<std::string> operand(std::size_t index) const;
    /// All operands from `first` on.
    std::vector<std::string> operands_from(std::size_t first) const;
    bool wants_help() const { return help_; }

  private:
    std::map<std::string, std::vector<std::string>, std::less<>> flags_;
    std::vector<std::string> operands_;
    bool help_ = false;
};

/// Splits at every `separator`; "" gives one empty word.
std::vector<std::string> split(std::string_view text, char separator);
/// The whole of `text` as a number, or nothing.
std::optional<int> to_int(std::string_view text);
std::optional<double> to_number(std::string_view text);
/// Bytes of "500MB", "2 GB", "1.5GiB", "4096 B", in letters of any case; nothing for what is no size, is negative or
/// has no unit.
std::optional<double> to_bytes(std::string_view text);
/// "23.5 GB"
std::string rounded_bytes(double bytes);
using embed::most_threads;

/// "1", "1-24", "1,64,128" or "1-4,8": frames in this order, without repeats. Throws UsageError.
std::vector<int> parse_frames(std::string_view text);
/// " Did you mean 'x'?" or "".
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

} // namespace sinew::cli
