// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/bench_common.h"

#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"
#include "tools/cli/writable_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <thread>

namespace sinew::cli {

bench::RunOptions run_options(const Invocation& in) {
    bench::RunOptions o;
    o.quick = in.arguments.has("--quick");
    o.filter = in.arguments.value("--only").value_or("");
    o.stop = in.stop;
    o.say = [&err = in.err](const std::string& text) { err << "measuring " << text << "\n"; };
    return o;
}

std::vector<double> tet_scales(const Invocation& in, const std::vector<double>& usual) {
    std::vector<double> scales = in.arguments.numbers("--sizes", usual);
    for (const double s : scales)
        if (!(s >= 0.01) || !(s <= 100)) throw UsageError("--sizes needs factors from 0.01 to 100.");
    return scales;
}

std::vector<std::string> words(const Invocation& in, std::string_view flag, const std::vector<std::string>& known,
                               std::vector<std::string> otherwise) {
    const auto text = in.arguments.value(flag);
    if (!text) return otherwise;
    std::vector<std::string> out = split(*text, ',');
    for (const std::string& word : out)
        if (std::find(known.begin(), known.end(), word) == known.end())
            throw UsageError(std::string(flag) + ": there is no '" + word + "'." + did_you_mean(word, known));
    if (out.empty()) throw UsageError(std::string(flag) + " needs a list.");
    return out;
}

std::vector<std::string> graph_files(const std::vector<std::string>& paths) {
    std::vector<std::string> out;
    for (const std::string& path : paths) {
        if (!std::filesystem::is_directory(path)) {
            out.push_back(path);
            continue;
        }
        std::vector<std::string> inside;
        for (const auto& entry : std::filesystem::directory_iterator(path))
            if (entry.path().extension() == ".json") inside.push_back(entry.path().string());
        if (inside.empty()) throw UsageError("'" + path + "' has no graph files (*.json) in it.");
        std::sort(inside.begin(), inside.end());
        out.insert(out.end(), inside.begin(), inside.end());
    }
    return out;
}

std::optional<std::filesystem::path> output_folder(const Invocation& in) {
    const auto name = in.arguments.value("--output");
    if (!name) return {};
    check_writable(*name, "--output");
    return *name;
}

int thread_count(const Invocation& in) {
    return in.arguments.whole_number("--threads", static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
                                     1);
}

nlohmann::ordered_json provenance(const std::string& name) {
    return {{"bench", name},
            {"date", today()},
            {"machine", machine_name()},
            {"load", load_average()},
            {"version", SINEW_VERSION}};
}

void print_result(const Invocation& in, const std::string& name, const bench::Table& table,
                  const nlohmann::ordered_json& rows, const std::string& summary, const nlohmann::ordered_json* extra) {
    if (in.arguments.has("--json")) {
        nlohmann::ordered_json line = provenance(name);
        line["summary"] = summary;
        line["rows"] = rows;
        if (extra) line.update(*extra);
        in.out << json_text(line) << std::endl;
    } else {
        if (!table.rows.empty()) in.out << bench::as_text(table);
        in.out << summary << std::endl;
    }
}

} // namespace sinew::cli
