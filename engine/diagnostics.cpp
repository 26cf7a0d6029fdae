// Rendering of diagnostics, and the search for the name that was meant.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"

#include "engine/text.h"

#include <algorithm>
#include <cctype>

namespace sinew::engine {

namespace {

std::string_view word(Severity s) {
    switch (s) {
    case Severity::note:
        return "note";
    case Severity::warning:
        return "warning";
    case Severity::error:
        break;
    }
    return "error";
}

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Edit distance with swaps of neighbours (optimal string alignment), letters compared without case.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

/// "body" and "bodies", "fiber" and "fibers", "mesh" and "meshes".
bool is_plural(std::string_view one, std::string_view several) {
    if (one.empty() || several.size() <= one.size() || !several.ends_with('s')) return false;
    const std::string_view more = several.substr(one.size());
    if (several.starts_with(one) && (more == "s" || more == "es")) return true;
    return one.ends_with('y') && several.ends_with("ies") &&
           several.substr(0, several.size() - 3) == one.substr(0, one.size() - 1);
}

std::string all_texts(std::span<const Diagnostic> diagnostics) {
    std::string out;
    for (const Diagnostic& d : diagnostics) out += (out.empty() ? "" : "\n") + to_text(d);
    return out;
}

} // namespace

std::string to_text(const Diagnostic& d) {
    std::string out;
    if (d.spot) {
        out += shown_text(d.spot->file);
        if (d.spot->line > 0) out += ":" + std::to_string(d.spot->line) + ":" + std::to_string(d.spot->column);
        if (!out.empty()) out += ": ";
    }
    out += std::string(word(d.severity)) + " [" + d.code + "] ";
    if (!d.node.empty())
        out += shown_text(d.node + (d.attribute.empty() ? "" : "." + d.attribute)) + ": ";
    else if (!d.attribute.empty())
        out += shown_text(d.attribute) + ": ";
    out += shown_text(d.message, true);
    if (d.frame) out += " (frame " + number_text(*d.frame) + ")";
    if (!d.hint.empty()) out += "\n  hint: " + shown_text(d.hint, true);
    if (d.spot && !d.spot->pointer.empty()) out += "\n  at " + shown_text(d.spot->pointer);
    if (d.spot)
        for (const SourceSpot& s : d.spot->included_by)
            out += "\n  included by " + shown_text(s.file) + ":" + std::to_string(s.line) + ":" +
                   std::to_string(s.column) + " at " + shown_text(s.pointer);
    return out;
}

std::string to_json(const Diagnostic& d) {
    std::string out = "{\"severity\": " + json_quoted(word(d.severity)) + ", \"code\": " + json_quoted(d.code);
    if (!d.node.empty()) out += ", \"node\": " + json_quoted(d.node);
    if (!d.attribute.empty()) out += ", \"attribute\": " + json_quoted(d.attribute);
    if (d.spot) {
        out += ", \"file\": " + json_quoted(d.spot->file) + ", \"pointer\": " + json_quoted(d.spot->pointer);
        if (d.spot->line > 0)
            out += ", \"line\": " + std::to_string(d.spot->line) + ", \"column\": " + std::to_string(d.spot->column);
        std::string chain;
        for (const SourceSpot& s : d.spot->included_by)
            chain += (chain.empty() ? "{\"file\": " : ", {\"file\": ") + json_quoted(s.file) +
                     ", \"pointer\": " + json_quoted(s.pointer) + ", \"line\": " + std::to_string(s.line) +
                     ", \"column\": " + std::to_string(s.column) + "}";
        if (!chain.empty()) out += ", \"included_by\": [" + chain + "]";
    }
    if (d.frame) out += ", \"frame\": " + number_text(*d.frame);
    out += ", \"message\": " + json_quoted(d.message);
    if (!d.hint.empty()) out += ", \"hint\": " + json_quoted(d.hint);
    return out + "}";
}

Failure::Failure(std::vector<Diagnostic> diagnostics)
    : diagnostics_(std::move(diagnostics))
    , text_(all_texts(diagnostics_)) {}

Failure::Failure(Diagnostic diagnostic)
    : Failure(std::vector<Diagnostic>{std::move(diagnostic)}) {}

std::string nearest_name(std::string_view word, std::span<const std::string> candidates) {
    if (word.empty() || word.size() > 100) return {}; // very long words are not worth the square cost below
    // What is right but for capitals, then what is one of several or several of one.
    const std::string small = lower_case(word);
    for (const std::string& c : candidates)
        if (lower_case(c) == small) return c;
    for (const std::string& c : candidates)
        if (is_plural(small, lower_case(c)) || is_plural(lower_case(c), small)) return c;
    // A third of the letters may be wrong: "youngModulus" finds "youngsModulus", "foo" does not find "bar".
    const std::size_t allowed = std::max<std::size_t>(1, word.size() / 3);
    std::size_t best = allowed + 1;
    std::string out;
    for (const std::string& c : candidates) {
        const std::size_t gap = c.size() > word.size() ? c.size() - word.size() : word.size() - c.size();
        if (gap > allowed || c.size() < 2) continue;
        const std::size_t d = distance(word, c);
        if (d < best) best = d, out = c;
    }
    return out;
}

} // namespace sinew::engine
