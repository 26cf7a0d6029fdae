// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/json_text.h"

#include "engine/text.h"
#include "engine/units.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <unordered_map>

namespace sinew::engine {

namespace {

struct Stop {}; // the text cannot be read further; the problem has been recorded

class Parser {
  public:
    explicit Parser(std::string_view text)
        : text_(text) {}

    JsonDocument document() {
        try {
            if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3; // a byte order mark is allowed, and nothing else is
            out_.root = value(0);
            space();
            if (at_ < text_.size()) stop("the document ends here, but more text follows");
        } catch (const Stop&) {
        }
        return std::move(out_);
    }

  private:
    [[noreturn]] void stop(std::string message, std::string_view code = "DG001", std::string hint = {}) {
        out_.problems.push_back({code, at_, pointer_, std::move(message), std::move(hint)});
        throw Stop{};
    }

    /// "12 kPa" where that stands without quotes and the letters are what is next; else empty.
    std::string number_with_unit() const {
        constexpr std::size_t most = 16; // letters
        std::size_t end = at_;
        while (end < text_.size() && end - at_ <= most &&
               (std::isalnum(static_cast<unsigned char>(text_[end])) ||
                std::string_view("%/^*-").find(text_[end]) != std::string_view::npos))
            ++end;
        std::size_t last = at_;
        while (last > 0 && text_[last - 1] == ' ') --last;
        std::size_t begin = last;
        while (begin > 0 && std::string_view("+-.0123456789eE").find(text_[begin - 1]) != std::string_view::npos)
            --begin;
        const std::string unit(text_.substr(at_, end - at_));
        const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
        if (begin == last || !(is_digit(text_[begin]) || text_[begin] == '-') || unit.empty() || is_digit(unit[0]) ||
            !parse_unit(unit))
            return {};
        return std::string(text_.substr(begin, last - begin)) + " " + unit;
    }

    /// What ends neither a list nor an object, nor goes on with it, but may begin what comes next.
    [[noreturn]] void no_comma(bool in_list) {
        constexpr std::size_t most = 40; // of a text that is shown
        std::string next, cure;
        const char c = more() ? text_[at_] : '\0';
        if (c == '"') {
            const std::size_t close = text_.substr(0, at_ + most).find_first_of("\"\\\n", at_ + 1);
            const bool is_short = close != std::string_view::npos && text_[close] == '"';
            next = is_short ? json_quoted(text_.substr(at_ + 1, close - at_ - 1)) : "this text";
            const std::size_t after = is_short ? text_.find_first_not_of(" \t\r\n", close + 1) : std::string_view::npos;
            const bool is_key = after != std::string_view::npos && text_[after] == ':';
            cure = in_list && is_key ? "end the list with ] and put a comma before the key " : "put a comma before ";
        } else if (in_list && (c == '{' || c == '[' || c == '-' || std::isalnum(static_cast<unsigned char>(c)))) {
            next = std::string("this ") + c, cure = "put a comma before ";
        }
        const std::string meant = number_with_unit();
        stop(std::string("expected , or ") + (in_list ? "] in a list, " : "} in an object, ") + found(), "DG001",
             meant.empty() ? cure + next
                           : std::string("a number with its unit is written in quotes: ") + json_quoted(meant));
    }

    /// For one that is there already; the text's lines are looked for once.
    void twice(const JsonMember& member, std::size_t first) {
        if (!lines_) lines_.emplace(text_);
        const TextPlace place = lines_->at(first);
        out_.problems.push_back({"DG002", member.key_begin, pointer_,
                                 "the key " + json_quoted(member.key) + " is written twice, first at line " +
                                     std::to_string(place.line) + ", column " + std::to_string(place.column),
                                 "keep one of the two, or give one another name"});
    }

    bool more() const { return at_ < text_.size(); }
    bool is_letter(std::size_t i) const {
        return i < text_.size() && std::isalpha(static_cast<unsigned char>(text_[i]));
    }

    void space() {
        while (more()) {
            const char c = text_[at_];
            if (c == '/')
                comment();
            else if (c == ' ' || c == '\t' || c == '\n' || c == '\r')
                ++at_;
            else
                return;
        }
    }

    void comment() {
        const std::string_view mark = text_.substr(at_, 2);
        if (mark != "//" && mark != "/*") stop("expected // or /* at the begin of a comment, " + found());
        JsonComment out{at_, text_.size()};
        const std::size_t close = text_.find(mark == "//" ? "\n" : "*/", at_ + 2);
        if (close == std::string_view::npos && mark == "/*") stop("a comment is not closed by */");
        if (close != std::string_view::npos) out.end = close + (mark == "/*" ? 2 : 0);
        while (at_ < out.end) {
            const std::size_t length = utf8_length(text_, at_);
            if (length == 0) stop("the text is not UTF-8; save it as UTF-8");
            at_ += length;
        }
        if (mark == "//" && text_[out.end - 1] == '\r') --out.end;
        out_.comments.push_back(out);
    }

    std::string found() const {
        if (!more()) return "the text ends";
        const std::size_t length = std::max<std::size_t>(1, utf8_length(text_, at_));
        return "found " + json_quoted(text_.substr(at_, length));
    }

    Json value(int depth) {
        space();
        if (depth > json_depth_limit)
            stop("more than " + std::to_string(json_depth_limit) + " brackets inside each other", "DG003");
        Json out;
        out.begin = at_;
        if (!more()) stop("a value is missing: the text ends");
        const char c = text_[at_];
        if (c == '{')
            out.data = object(depth);
        else if (c == '[')
            out.data = list(depth);
        else if (c == '"')
            out.data = text();
        else if ((c >= '0' && c <= '9') || (c == '-' && !is_letter(at_ + 1)))
            number(out);
        else if (word("true"))
            out.data = true;
        else if (word("false"))
            out.data = false;
        else if (!word("null"))
            no_value();
        out.end = at_;
        return out;
    }

    /// What other languages write.
    [[noreturn]] void no_value() {
        std::string said; // up to the next mark
        for (std::size_t i = at_; i < text_.size() && said.size() < 20; ++i) {
            const char c = text_[i];
            if (c == ',' || c == ']' || c == '}' || c == ':' || static_cast<unsigned char>(c) <= ' ') break;
            said += c;
        }
        const std::string small = lower_case(said), bare = small.substr(small.find_first_not_of("+-") == 1 ? 1 : 0);
        const auto wrong = [&](const std::string& right) {
            stop("expected a value, found " + json_quoted(said) + "; write " + right);
        };
        for (const char* constant : {"true", "false", "null"})
            if (small == constant) wrong(constant);
        if (small == "none" || small == "undefined") wrong("null");
        if (bare == "nan" || bare == "inf" || bare == "infinity") wrong("a finite number");
        if (small.starts_with('\'')) stop("expected a value, found \"'\"; write text in double quotes");
        if (small.size() > 1 && (small[0] == '.' || small[0] == '+'))
            wrong((small[0] == '.'         ? "0"
                   : bare.starts_with('.') ? "0"
                                           : "") +
                  (small[0] == '.' ? said : said.substr(1)));
        stop("expected a value, " + found());
    }

    /// Goes past a letter if that is next.
    bool skip(char c) {
        if (!more() || text_[at_] != c) return false;
        ++at_;
        return true;
    }

    bool word(std::string_view w) {
        if (text_.substr(at_, w.size()) != w) return false;
        at_ += w.size();
        return true;
    }

    Json::List list(int depth) {
        Json::List out;
        ++at_;
        space();
        if (skip(']')) return out;
        const std::size_t pointer_size = pointer_.size();
        while (true) {
            pointer_ += '/';
            pointer_ += std::to_string(out.size());
            out.push_back(value(depth + 1));
            pointer_.resize(pointer_size);
            space();
            if (skip(']')) return out;
            if (!more() || text_[at_] != ',') no_comma(true);
            ++at_;
            space();
            if (more() && text_[at_] == ']') stop("remove the comma before this ]");
        }
    }

    Json::Object object(int depth) {
        Json::Object out;
        std::unordered_map<std::string, std::size_t> seen; // where each key stands
        ++at_;
        space();
        if (skip('}')) return out;
        const std::size_t pointer_size = pointer_.size();
        while (true) {
            space();
            JsonMember m;
            m.key_begin = at_;
            if (more() && text_[at_] == '}' && !out.empty()) stop("remove the comma before this }");
            if (more() && text_[at_] == '#') stop("a comment begins with //, not with #");
            if (!more() || text_[at_] != '"')
                stop("expected a key in " + std::string(more() && text_[at_] == '\'' ? "double " : "") + "quotes, " +
                     found());
            m.key = text();
            pointer_ += pointer_token(m.key);
            const auto [before, is_new] = seen.try_emplace(m.key, m.key_begin);
            if (!is_new) twice(m, before->second);
            space();
            if (!more() || text_[at_] != ':') stop("expected : after a key, " + found());
            ++at_;
            m.value = value(depth + 1);
            pointer_.resize(pointer_size);
            out.push_back(std::move(m));
            space();
            if (skip('}')) return out;
            if (!more() || text_[at_] != ',') no_comma(false);
            ++at_;
        }
    }

    void digits() {
        if (!more() || text_[at_] < '0' || text_[at_] > '9') stop("expected a digit, " + found());
        while (more() && text_[at_] >= '0' && text_[at_] <= '9') ++at_;
    }

    void number(Json& out) {
        const std::size_t begin = at_;
        bool whole = true, tiny = false;
        if (text_[at_] == '-') ++at_;
        if (more() && text_[at_] == '0') {
            ++at_;
            if (more() && text_[at_] >= '0' && text_[at_] <= '9')
                stop("a number does not begin with 0 and another digit; leave the 0 out");
        } else
            digits();
        if (more() && text_[at_] == '.') whole = false, ++at_, digits();
        if (more() && (text_[at_] == 'e' || text_[at_] == 'E')) {
            whole = false, ++at_;
            tiny = more() && text_[at_] == '-';
            if (more() && (text_[at_] == '+' || text_[at_] == '-')) ++at_;
            digits();
        }
        const char *first = text_.data() + begin, *last = text_.data() + at_;
        std::int64_t i = 0;
        if (whole && text_.substr(begin, at_ - begin) != "-0" && std::from_chars(first, last, i).ec == std::errc()) {
            out.data = i;
            return;
        }
        double d = 0;
        if (std::from_chars(first, last, d).ec == std::errc::result_out_of_range) {
            d = 0; // below the smallest double: zero
            const bool zero = text_.substr(begin, at_ - begin).find_first_of("123456789") == std::string_view::npos;
            if (!tiny && !zero)
                out_.problems.push_back(
                    {"DG027", begin, pointer_, std::string(first, last) + " is too large for a number", {}});
        }
        out.data = d;
    }

    unsigned hex4() {
        unsigned v = 0;
        for (int i = 0; i < 4; ++i, ++at_) {
            const char c = more() ? text_[at_] : '\0';
            if (c >= '0' && c <= '9')
                v = 16 * v + static_cast<unsigned>(c - '0');
            else if (c >= 'a' && c <= 'f')
                v = 16 * v + static_cast<unsigned>(c - 'a') + 10;
            else if (c >= 'A' && c <= 'F')
                v = 16 * v + static_cast<unsigned>(c - 'A') + 10;
            else
                stop("expected four hexadecimal digits after \\u, " + found());
        }
        return v;
    }

    void unicode(std::string& out) {
        unsigned v = hex4();
        if (v >= 0xDC00 && v <= 0xDFFF) stop("\\u escape holds half of a surrogate pair");
        if (v >= 0xD800 && v <= 0xDBFF) {
            if (!word("\\u")) stop("\\u escape holds half of a surrogate pair");
            const unsigned low = hex4();
            if (low < 0xDC00 || low > 0xDFFF) stop("\\u escape holds half of a surrogate pair");
            v = 0x10000 + ((v - 0xD800) << 10) + (low - 0xDC00);
        }
        const auto put = [&](unsigned byte) { out += static_cast<char>(byte); };
        if (v < 0x80)
            put(v);
        else if (v < 0x800)
            put(0xC0 | v >> 6), put(0x80 | (v & 63));
        else if (v < 0x10000)
            put(0xE0 | v >> 12), put(0x80 | (v >> 6 & 63)), put(0x80 | (v & 63));
        else
            put(0xF0 | v >> 18), put(0x80 | (v >> 12 & 63)), put(0x80 | (v >> 6 & 63)), put(0x80 | (v & 63));
    }

    void escape(std::string& out) {
        static constexpr std::string_view from = "\"\\/bfnrt", to = "\"\\/\b\f\n\r\t";
        const char c = more() ? text_[at_] : '\0';
        if (c == 'u') return ++at_, unicode(out);
        const std::size_t i = c == '\0' ? std::string_view::npos : from.find(c);
        if (i == std::string_view::npos) stop("unknown escape in a string, " + found());
        out += to[i];
        ++at_;
    }

    std::string text() {
        std::string out;
        ++at_;
        while (true) {
            if (!more()) stop("a string is not closed");
            const char c = text_[at_];
            if (skip('"')) return out;
            if (static_cast<unsigned char>(c) < 0x20) stop("a string holds a control character or a line break");
            if (c == '\\') {
                ++at_;
                escape(out);
                continue;
            }
            const std::size_t length = utf8_length(text_, at_);
            if (length == 0) stop("the text is not UTF-8; save it as UTF-8");
            out += text_.substr(at_, length);
            at_ += length;
        }
    }

    std::string_view text_;
    std::size_t at_ = 0;
    std::string pointer_;
    std::optional<LineIndex> lines_;
    JsonDocument out_;
};

std::string unescaped(std::string_view token) {
    std::string out;
    for (std::size_t i = 0; i < token.size(); ++i) {
        if (token[i] == '~' && i + 1 < token.size())
            out += token[++i] == '1' ? '/' : '~';
        else
            out += token[i];
    }
    return out;
}

} // namespace

JsonDocument parse_json(std::string_view text) { return Parser(text).document(); }

const Json* Json::find(std::string_view key) const {
    if (const Object* o = as<Object>())
        for (const JsonMember& m : *o)
            if (m.key == key) return &m.value;
    return nullptr;
}

const Json& Json::nearest(std::string_view pointer) const {
    const Json* at = this;
    while (!pointer.empty()) {
        pointer.remove_prefix(1);
        const std::size_t slash = std::min(pointer.find('/'), pointer.size());
        const std::string token = unescaped(pointer.substr(0, slash));
        pointer.remove_prefix(slash);
        const Json* next = at->find(token);
        if (const List* l = at->as<List>()) {
            std::size_t i = 0;
            const auto end = token.data() + token.size();
            if (std::from_chars(token.data(), end, i).ptr == end && i < l->size()) next = &(*l)[i];
        }
        if (!next) break;
        at = next;
    }
    return *at;
}

std::string_view Json::kind() const {
    static constexpr std::string_view kinds[] = {"null", "true or false", "an integer", "a number",
                                                 "text", "a list",        "an object"};
    return kinds[data.index()];
}

LineIndex::LineIndex(std::string_view text)
    : text_(text) {
    starts_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == '\n') starts_.push_back(i + 1);
}

TextPlace LineIndex::at(std::size_t offset) const {
    offset = std::min(offset, text_.size());
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), offset);
    TextPlace out;
    out.line = static_cast<int>(after - starts_.begin());
    const std::size_t start = starts_[static_cast<std::size_t>(out.line) - 1];
    for (std::size_t i = start; i < offset; ++i)
        if ((static_cast<unsigned char>(text_[i]) & 0xC0) != 0x80) ++out.column;
    return out;
}

} // namespace sinew::engine
