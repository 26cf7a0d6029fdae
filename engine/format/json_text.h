// JSON (RFC 8259) with // and /* */ comments into a small tree that remembers where everything stands. Never throws,
// never recurses deeper than its limit, does not depend on the locale; knows nothing of graphs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sinew::engine {

struct JsonMember;

struct Json {
    using List = std::vector<Json>;
    using Object = std::vector<JsonMember>; ///< in file order
    /// null, true/false, integer that fits, any other number, text, list, object
    std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, List, Object> data;
    std::size_t begin = 0, end = 0; ///< byte range in the text

    template <class T>
    const T* as() const {
        return std::get_if<T>(&data);
    }
    const Json* find(std::string_view key) const; ///< of an object; nullptr if absent or no object
    /// The value below an RFC 6901 pointer, or the nearest ancestor that exists.
    const Json& nearest(std::string_view pointer) const;
    /// "a number", "a list" …, for messages.
    std::string_view kind() const;
};

struct JsonMember {
    std::string key;
    std::size_t key_begin = 0;
    Json value;
};

struct JsonProblem {
    std::string_view code; ///< DG001, DG002, DG003, DG027
    std::size_t offset = 0;
    std::string pointer, message, hint;
};

struct JsonComment {
    std::size_t begin = 0, end = 0; ///< byte range in the text, without the line end
};

struct JsonDocument {
    Json root;
    std::vector<JsonComment> comments; ///< in file order
    std::vector<JsonProblem> problems; ///< duplicate keys and the first syntax error; empty = root is complete
};

constexpr int json_depth_limit = 64;

JsonDocument parse_json(std::string_view text);

struct TextPlace {
    int line = 1, column = 1; ///< columns count code points
};

/// Byte offset -> line and column, after one pass over the text.
class LineIndex {
  public:
    explicit LineIndex(std::string_view text);
    TextPlace at(std::size_t offset) const;

  private:
    std::string_view text_;
    std::vector<std::size_t> starts_;
};

} // namespace sinew::engine
