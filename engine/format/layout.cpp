// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/layout.h"

#include "engine/format/json_text.h"

#include <algorithm>

namespace sinew::engine {

namespace {

/// An entry of an object or a list.
struct Item {
    std::size_t begin;    ///< of its key, or of its value in a list
    std::string_view key; ///< as it is written, with its quotes; empty in a list
    const Json* value = nullptr;
};

std::size_t characters(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

class Layout {
  public:
    explicit Layout(std::string_view text)
        : text_(text)
        , doc_(parse_json(text)) {}

    std::string document() {
        std::string out;
        for (const JsonComment& c : comments(0, doc_.root.begin)) out += comment_text(c) + "\n";
        out += broken(doc_.root, 0, true);
        const auto behind = comments(doc_.root.end, text_.size());
        for (const JsonComment& c : behind)
            out += (&c == &behind.front() && same_line(doc_.root.end, c.begin) ? " " : "\n") + comment_text(c);
        return out + "\n";
    }

  private:
    // ---- the text ----

    std::string_view raw(std::size_t begin, std::size_t end) const { return text_.substr(begin, end - begin); }

    bool same_line(std::size_t a, std::size_t b) const { return raw(a, b).find('\n') == std::string_view::npos; }

    std::string comment_text(const JsonComment& c) const {
        std::string_view text = raw(c.begin, c.end);
        while (text.ends_with(' ') || text.ends_with('\t') || text.ends_with('\r')) text.remove_suffix(1);
        return std::string(text);
    }

    std::vector<JsonComment> comments(std::size_t from, std::size_t to) const {
        const auto before = [](const JsonComment& c, std::size_t place) { return c.begin < place; };
        const auto first = std::lower_bound(doc_.comments.begin(), doc_.comments.end(), from, before);
        return {first, std::lower_bound(first, doc_.comments.end(), to, before)};
    }

    bool has_comments(std::size_t from, std::size_t to) const { return !comments(from, to).empty(); }

    std::size_t string_end(std::size_t begin) const {
        std::size_t at = begin + 1;
        while (text_[at] != '"') at += text_[at] == '\\' ? 2 : 1;
        return at + 1;
    }

    std::vector<Item> items(const Json& json) const {
        std::vector<Item> out;
        if (const auto* object = json.as<Json::Object>())
            for (const JsonMember& m : *object)
                out.push_back({m.key_begin, raw(m.key_begin, string_end(m.key_begin)), &m.value});
        if (const auto* list = json.as<Json::List>())
            for (const Json& e : *list) out.push_back({e.begin, {}, &e});
        return out;
    }

    static bool is_object(const Json& json) { return json.as<Json::Object>() != nullptr; }
    static bool is_container(const Json& json) { return is_object(json) || json.as<Json::List>(); }

    static std::string head(const Item& item) {
        return item.key.empty() ? std::string() : std::string(item.key) + ": ";
    }

    /// A list that begins with an object has blanks inside its brackets, as objects have.
    static bool is_airy(const Json& json, const std::vector<Item>& all) {
        return is_object(json) || (!all.empty() && is_object(*all.front().value));
    }

    // ---- on one line ----

    std::string flat(const Json& json) const {
        if (!is_container(json)) return std::string(raw(json.begin, json.end));
        const std::vector<Item> all = items(json);
        std::string out;
        for (const Item& item : all) out += (out.empty() ? "" : ", ") + head(item) + flat(*item.value);
        const std::string blank = is_airy(json, all) && !all.empty() ? " " : "";
        return (is_object(json) ? "{" : "[") + blank + out + blank + (is_object(json) ? "}" : "]");
    }

    /// Whether its author, or a comment, wants it on lines of its own.
    bool wants_lines(const Json& json) const {
        if (!is_container(json)) return false;
        if (has_comments(json.begin, json.end)) return true;
        const std::vector<Item> all = items(json);
        if (all.empty()) return false;
        if (is_object(json) && !same_line(json.begin, all.front().begin)) return true;
        if (!is_object(json) && is_object(*all.front().value))
            for (std::size_t i = 1; i < all.size(); ++i)
                if (!same_line(all[i - 1].value->end, all[i].begin)) return true;
        return std::any_of(all.begin(), all.end(), [&](const Item& item) { return wants_lines(*item.value); });
    }

    // ---- on several ----

    static std::string line(std::size_t indent) { return "\n" + std::string(indent, ' '); }

    /// \param indent of the line on which it begins
    /// \param column at which it begins
    std::string text_of(const Json& json, std::size_t indent, std::size_t column) const {
        if (!wants_lines(json)) {
            std::string one = flat(json);
            if (!is_container(json) || column + characters(one) + 1 <= layout_width) return one;
        }
        const std::vector<Item> all = items(json);
        if (all.empty() || has_comments_between(json, all)) return broken(json, indent, false);
        if (is_object(json)) {
            std::string out = hugged(json, all, indent, column);
            return out.empty() ? broken(json, indent, false) : out;
        }
        if (!is_object(*all.front().value)) return filled(all, indent, column);
        std::string out = "[ ";
        for (const Item& item : all)
            out += &item == &all.front() ? text_of(*item.value, indent + 2, column + 2)
                                         : "," + line(indent + 2) + text_of(*item.value, indent + 2, indent + 2);
        return out + " ]";
    }

    bool has_comments_between(const Json& json, const std::vector<Item>& all) const {
        std::size_t at = json.begin;
        for (const Item& item : all) {
            if (has_comments(at, item.value->begin)) return true;
            at = item.value->end;
        }
        return has_comments(at, json.end);
    }

    /// { "type": "zBone", "inputs": {
    ///         … a level deeper, as if all stood on lines of its own
    ///       } }
    /// Empty where it cannot be written so.
    std::string hugged(const Json& json, const std::vector<Item>& all, std::size_t indent, std::size_t column) const {
        const Item& last = all.back();
        if (all.size() < 2 || !is_object(*last.value) || items(*last.value).empty()) return {};
        if (!same_line(json.begin, all.front().begin)) return {};
        std::string out = "{ ";
        for (const Item& item : all) {
            if (&item == &last) break;
            if (wants_lines(*item.value)) return {};
            out += head(item) + flat(*item.value) + ", ";
        }
        out += head(last);
        if (column + characters(out) + 1 > layout_width) return {};
        return out + broken(*last.value, indent + 2, false) + " }";
    }

    /// As many entries a line as fit.
    std::string filled(const std::vector<Item>& all, std::size_t indent, std::size_t column) const {
        std::string out = "[";
        std::size_t at = column + 1;
        for (const Item& item : all) {
            const bool is_last = &item == &all.back();
            std::string entry =
                wants_lines(*item.value) ? text_of(*item.value, indent + 2, indent + 2) : flat(*item.value);
            const std::size_t length = characters(entry);
            if (&item != &all.front()) {
                if (at + 1 + length + (is_last ? 2 : 1) > layout_width)
                    out += line(indent + 2), at = indent + 2;
                else
                    out += " ", ++at;
            }
            out += entry + (is_last ? "" : ",");
            at += length + 1;
        }
        return out + "]";
    }

    /// Each entry on a line of its own, with the comments around it.
    std::string broken(const Json& json, std::size_t indent, bool is_root) const {
        const std::vector<Item> all = items(json);
        const char *open = is_object(json) ? "{" : "[", *close = is_object(json) ? "}" : "]";
        std::string out = open;
        std::size_t at = json.begin + 1; // behind what has been written
        const std::string new_line = line(indent + 2);
        bool is_first = true;
        const auto own_line = [&](std::size_t begin, const std::string& text) {
            if (!is_first && has_blank_line(at, begin)) out += "\n";
            out += new_line + text;
            is_first = false;
        };
        for (const Item& item : all) {
            const bool is_last = &item == &all.back();
            for (const JsonComment& c : comments(at, item.value->begin)) {
                own_line(c.begin, comment_text(c));
                at = c.end;
            }
            std::string text = head(item);
            const std::size_t column = indent + 2 + characters(text);
            const bool lists_all =
                is_root && (item.key == "\"nodes\"" || item.key == "\"includes\"") && !items(*item.value).empty();
            text += lists_all && is_object(*item.value) ? broken(*item.value, indent + 2, false)
                                                        : text_of(*item.value, indent + 2, column);
            own_line(std::max(at, item.begin), text + (is_last ? "" : ","));
            at = item.value->end;
            // What stands behind it on its line stays there.
            const std::size_t next = is_last ? json.end : (&item + 1)->begin;
            for (const JsonComment& c : comments(at, next)) {
                if (!same_line(at, c.begin)) break;
                out += " " + comment_text(c);
                at = c.end;
            }
        }
        for (const JsonComment& c : comments(at, json.end)) {
            own_line(c.begin, comment_text(c));
            at = c.end;
        }
        if (out.size() == 1) return out + close;
        return out + line(indent) + close;
    }

    bool has_blank_line(std::size_t from, std::size_t to) const {
        const std::string_view between = raw(from, to);
        return std::count(between.begin(), between.end(), '\n') > 1;
    }

    std::string_view text_;
    JsonDocument doc_;
};

} // namespace

std::string laid_out(std::string_view text) { return Layout(text).document(); }

} // namespace sinew::engine
