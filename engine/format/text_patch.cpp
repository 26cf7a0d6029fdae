// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/text_patch.h"

#include "engine/format/json_text.h"
#include "engine/text.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sinew::engine {

namespace {

std::optional<double> number(const Json& json) {
    if (const auto* i = json.as<std::int64_t>()) return static_cast<double>(*i);
    if (const auto* d = json.as<double>()) return *d;
    return {};
}

/// The same data, however it is spelled.
bool same(const Json& a, const Json& b) {
    if (const auto x = number(a), y = number(b); x && y) return *x == *y;
    if (a.data.index() != b.data.index()) return false;
    if (const auto* x = a.as<Json::List>()) return std::ranges::equal(*x, *b.as<Json::List>(), same);
    if (const auto* x = a.as<Json::Object>())
        return std::ranges::equal(*x, *b.as<Json::Object>(), [](const JsonMember& m, const JsonMember& n) {
            return m.key == n.key && same(m.value, n.value);
        });
    if (const auto* x = a.as<std::string>()) return *x == *b.as<std::string>();
    if (const auto* x = a.as<bool>()) return *x == *b.as<bool>();
    return true; // null
}

/// Whether all that `b` holds, and nothing else but a comment, is in `a`.
bool has_just(const Json& a, const Json::Object& b) {
    const auto& members = *a.as<Json::Object>();
    return members.size() == b.size() + (a.find("comment") ? 1 : 0) &&
           std::ranges::all_of(b, [&](const JsonMember& m) { return m.key != "comment" && a.find(m.key); });
}

/// On one line, as graph files are laid out; numbers and texts as they are spelled.
std::string one_line(const Json& json, std::string_view text) {
    std::string out;
    if (const auto* list = json.as<Json::List>()) {
        for (const Json& entry : *list) out += (out.empty() ? "" : ", ") + one_line(entry, text);
        return "[" + out + "]";
    }
    if (const auto* object = json.as<Json::Object>()) {
        for (const JsonMember& m : *object)
            out += (out.empty() ? " " : ", ") + json_quoted(m.key) + ": " + one_line(m.value, text);
        return out.empty() ? "{}" : "{" + out + " }";
    }
    return std::string(text.substr(json.begin, json.end - json.begin));
}

class Patcher {
  public:
    explicit Patcher(std::string_view text)
        : text_(text)
        , document_(parse_json(text)) {}

    bool is_readable() const { return document_.problems.empty(); }

    /// What stands at an input; nullptr: nothing.
    const Json* value_at(const Plug& input) const {
        const auto [prefix, name] = included_name(input.node);
        const Json* inputs = prefix.empty() ? find({"nodes", name, "inputs"}) : find({"includes", prefix, "overrides"});
        if (!inputs) return nullptr;
        return inputs->find(prefix.empty() ? input.attribute : std::string(name) + "." + input.attribute);
    }

    /// False if there is no such node or include.
    bool put(const Plug& input, const Json& json, std::string_view json_text) {
        if (const Json* there = value_at(input)) return replace(*there, json, json_text), true;
        const auto [prefix, name] = included_name(input.node);
        const std::string value = one_line(json, json_text);
        if (prefix.empty()) {
            const Json* node = find({"nodes", name});
            if (!node || !node->as<Json::Object>()) return false;
            put_below(*node, "inputs", input.attribute, value);
            return true;
        }
        const Json* include = find({"includes", prefix});
        const std::string key = std::string(name) + "." + input.attribute;
        if (!include) return false;
        if (include->as<Json::Object>())
            put_below(*include, "overrides", key, value);
        else
            patches_.push_back({include->begin, include->end,
                                "{ \"file\": " + one_line(*include, text_) + ", \"overrides\": { " + json_quoted(key) +
                                    ": " + value + " } }"});
        return true;
    }

    bool put_key(const Json& keys, int frame, std::string_view value) {
        const auto* list = keys.as<Json::List>();
        if (!list) return false;
        std::size_t place = 0;
        for (; place < list->size(); ++place) {
            const auto* key = (*list)[place].as<Json::List>();
            const auto at = key && key->size() >= 2 ? number((*key)[0]) : std::nullopt;
            if (!at) return false;
            if (*at > frame) break;
            if (*at < frame) continue;
            const JsonDocument json = parse_json(value);
            replace((*key)[1], json.root, value);
            return true;
        }
        insert_entries(keys, *list, place, {"[" + std::to_string(frame) + ", " + std::string(value) + "]"});
        return true;
    }

    std::string patched() {
        std::stable_sort(patches_.begin(), patches_.end(),
                         [](const Patch& a, const Patch& b) { return a.begin < b.begin; });
        std::string out;
        std::size_t at = 0;
        for (const Patch& p : patches_) {
            out += text_.substr(at, p.begin - at);
            out += p.text;
            at = p.end;
        }
        return out += text_.substr(at);
    }

  private:
    struct Patch {
        std::size_t begin, end;
        std::string text;
    };

    const Json* find(std::initializer_list<std::string_view> path) const {
        const Json* at = &document_.root;
        for (const std::string_view key : path)
            if (at) at = at->find(key);
        return at;
    }

    void insert(std::size_t at, std::string text) { patches_.push_back({at, at, std::move(text)}); }

    /// Only what differs. `to` stands in `to_text`.
    void replace(const Json& from, const Json& to, std::string_view to_text) {
        if (same(from, to)) return;
        const auto *object = from.as<Json::Object>(), *to_object = to.as<Json::Object>();
        const auto *list = from.as<Json::List>(), *to_list = to.as<Json::List>();
        if (object && to_object && has_just(from, *to_object)) {
            for (const JsonMember& m : *to_object) replace(*from.find(m.key), m.value, to_text);
        } else if (list && to_list && replace_entries(from, *list, *to_list, to_text)) {
        } else if (const Json* comment = object ? from.find("comment") : nullptr; comment && !to.find("comment")) {
            const std::string kept = ", \"comment\": " + one_line(*comment, text_) + " }";
            std::string value = one_line(to, to_text);
            if (to_object && !to_object->empty())
                value.replace(value.size() - 2, 2, kept);
            else
                value = "{ \"value\": " + value + kept;
            patches_.push_back({from.begin, from.end, std::move(value)});
        } else {
            patches_.push_back({from.begin, from.end, one_line(to, to_text)});
        }
    }

    /// False if entries go away: then the whole list is written.
    bool replace_entries(const Json& whole, const Json::List& from, const Json::List& to, std::string_view to_text) {
        std::size_t front = 0, back = 0;
        const std::size_t least = std::min(from.size(), to.size());
        while (front < least && same(from[front], to[front])) ++front;
        while (back < least - front && same(from[from.size() - 1 - back], to[to.size() - 1 - back])) ++back;
        if (from.size() == to.size()) {
            for (std::size_t i = front; i < from.size() - back; ++i) replace(from[i], to[i], to_text);
            return true;
        }
        if (from.empty() || front + back < from.size()) return false;
        std::vector<std::string> entries;
        for (std::size_t i = front; i < to.size() - back; ++i) entries.push_back(one_line(to[i], to_text));
        insert_entries(whole, from, front, entries);
        return true;
    }

    void insert_entries(const Json& whole, const Json::List& list, std::size_t place,
                        const std::vector<std::string>& entries) {
        std::string between = list.size() > 1 ? blanks_before(list.back().begin) : blanks_before(list.front().begin);
        if (list.size() == 1 && between.find('\n') == std::string::npos) between = " ";
        if (place == list.size()) {
            std::string all;
            for (const std::string& entry : entries) all += (all.empty() ? "" : "," + between) + entry;
            return append(list.back().end, whole, between, all);
        }
        std::string all;
        for (const std::string& entry : entries) all += entry + "," + between;
        insert(list[place].begin, std::move(all));
    }

    /// Blanks and line breaks in front of a place; of several lines the last one.
    std::string blanks_before(std::size_t at) const {
        std::size_t begin = at;
        while (begin > 0 && std::string_view(" \t\r\n").find(text_[begin - 1]) != std::string_view::npos) --begin;
        std::string out(text_.substr(begin, at - begin));
        if (const std::size_t line = out.rfind('\n'); line != std::string::npos)
            out = out.substr(line > 0 && out[line - 1] == '\r' ? line - 1 : line);
        return out;
    }

    /// Behind the last entry or member of `whole`, which ends at `end`, and behind comments that stand on its line.
    void append(std::size_t end, const Json& whole, std::string between, const std::string& what) {
        std::size_t after = end;
        bool to_line_end = false;
        for (const JsonComment& c : document_.comments) {
            if (c.begin < after || c.begin >= whole.end) continue;
            if (text_.substr(after, c.begin - after).find_first_not_of(" \t") != std::string_view::npos) break;
            after = c.end;
            to_line_end = text_[c.begin + 1] == '/';
        }
        if (to_line_end && between.find('\n') == std::string::npos) between = "\n" + indent_at(end);
        insert(end, ",");
        insert(after, between + what);
    }

    /// The blanks that the line begins with.
    std::string indent_at(std::size_t at) const {
        const std::size_t line = text_.rfind('\n', at);
        const std::size_t begin = line == std::string_view::npos ? 0 : line + 1;
        return std::string(text_.substr(begin, text_.find_first_not_of(" \t", begin) - begin));
    }

    void put_below(const Json& holder, const std::string& member, const std::string& key, const std::string& value) {
        const std::string entry = json_quoted(key) + ": " + value;
        if (const Json* there = holder.find(member); there && there->as<Json::Object>())
            add_member(*there, entry);
        else
            add_member(holder, json_quoted(member) + ": { " + entry + " }");
    }

    void add_member(const Json& object, const std::string& entry) {
        const auto& members = *object.as<Json::Object>();
        if (members.empty()) {
            const bool is_closed_at_once = text_[object.begin + 1] == '}';
            return insert(object.begin + 1, " " + entry + (is_closed_at_once ? " " : ""));
        }
        append(members.back().value.end, object, blanks_before(members.back().key_begin), entry);
    }

    std::string_view text_;
    JsonDocument document_;
    std::vector<Patch> patches_;
};

} // namespace

std::optional<std::string> with_input(std::string_view text, const Plug& input, std::string_view json) {
    Patcher patcher(text);
    const JsonDocument value = parse_json(json);
    if (!patcher.is_readable() || !value.problems.empty() || !patcher.put(input, value.root, json)) return {};
    return patcher.patched();
}

std::optional<std::string> with_key(std::string_view text, const Plug& input, int frame, std::string_view value) {
    Patcher patcher(text);
    const Json* there = patcher.is_readable() ? patcher.value_at(input) : nullptr;
    const Json* keys = there ? there->find("keys") : nullptr;
    if (!keys || !parse_json(value).problems.empty() || !patcher.put_key(*keys, frame, value)) return {};
    return patcher.patched();
}

std::optional<std::string> keys_unit(std::string_view text, const Plug& input) {
    const Patcher patcher(text);
    const Json* there = patcher.is_readable() ? patcher.value_at(input) : nullptr;
    const Json* unit = there && there->find("keys") ? there->find("unit") : nullptr;
    const auto* word = unit ? unit->as<std::string>() : nullptr;
    return word ? std::optional(*word) : std::nullopt;
}

} // namespace sinew::engine
