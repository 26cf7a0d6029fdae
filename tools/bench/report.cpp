// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/report.h"

#include "tools/bench/table.h"

#include <string_view>

namespace sinew::bench {

namespace {

constexpr std::string_view head =
    "# Benchmarks\n\nMade by `sinew bench report GRAPH… -o docs/benchmarks.md`; with `--only NAMES` it measures some "
    "sections anew and leaves the others. Each says when and where it was measured. Load above the threads used is "
    "other work on the machine: times then vary by a quarter and more. Compare only times of one table.\n";

constexpr std::string_view mark = "\n## ";

} // namespace

std::string with_section(const std::string& page, const Section& section, const Provenance& measured) {
    const std::string text = std::string(mark) + section.title + "\n\n" + section.text + "\n*Measured on " +
                             measured.date + " with Sinew " + measured.version +
                             (measured.quick ? " (`--quick`)" : "") + ": " + measured.machine + ", " +
                             std::to_string(measured.threads) + " thread" + (measured.threads == 1 ? "" : "s") +
                             " if a table says no other number; load average " + number(measured.load_before, 2) +
                             " before and " + number(measured.load_after, 2) + " after.*\n";
    std::string out = page.starts_with("# Benchmarks") ? page : std::string(head);
    std::size_t at = out.find(mark);
    while (at != std::string::npos) {
        const std::size_t next = out.find(mark, at + 1), from = at + mark.size();
        const std::string title = out.substr(from, out.find('\n', from) - from);
        if (title == section.title) return out.replace(at, (next == std::string::npos ? out.size() : next) - at, text);
        if (place_of(title) > place_of(section.title)) return out.insert(at, text);
        at = next;
    }
    return out + text;
}

} // namespace sinew::bench
