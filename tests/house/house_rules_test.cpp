// The rules of the house (docs/concepts/house.md): who may include whom, what libraries must not do.
// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

struct SourceFile {
    std::string path; // from the project's root, with '/'
    std::vector<std::string> lines;
};

std::vector<SourceFile> sources(const std::vector<std::string>& rooms) {
    std::vector<SourceFile> out;
    const fs::path root = SINEW_SOURCE_DIR;
    for (const std::string& room : rooms)
        for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            SourceFile f;
            f.path = fs::relative(entry.path(), root).generic_string();
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);) f.lines.push_back(line);
            out.push_back(std::move(f));
        }
    REQUIRE(out.size() > 10);
    return out;
}

/// Lines of `files` that match `forbidden`, but for files whose path starts with one of `allowed`.
std::string offenders(const std::vector<SourceFile>& files, const std::string& forbidden,
                      const std::vector<std::string>& allowed = {}) {
    const std::regex pattern(forbidden);
    std::ostringstream out;
    for (const SourceFile& f : files) {
        bool exempt = false;
        for (const std::string& prefix : allowed) exempt = exempt || f.path.rfind(prefix, 0) == 0;
        if (exempt) continue;
        for (std::size_t i = 0; i < f.lines.size(); ++i)
            if (std::regex_search(f.lines[i], pattern)) out << f.path << ":" << i + 1 << ": " << f.lines[i] << "\n";
    }
    return out.str();
}

std::string text_of(const std::string& path) {
    std::ifstream in(fs::path(SINEW_SOURCE_DIR) / path);
    REQUIRE(in);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Everything in `text` that the first group of `pattern` takes, with how often.
std::map<std::string, int> matches(const std::string& text, const std::string& pattern) {
    std::map<std::string, int> out;
    const std::regex regex(pattern);
    for (std::sregex_iterator m(text.begin(), text.end(), regex), end; m != end; ++m) ++out[(*m)[1]];
    return out;
}

} // namespace

TEST_CASE("engine and solver never include each other, nodes or tools") {
    CHECK(offenders(sources({"engine"}), R"(#\s*include\s*[<"](solver|nodes|tools|tests)/)") == "");
    CHECK(offenders(sources({"solver"}), R"(#\s*include\s*[<"](engine|nodes|tools|tests)/)") == "");
}

TEST_CASE("includes name files from the project's root, so that the rules above see them") {
    CHECK(offenders(sources({"engine", "solver", "nodes", "tools", "tests"}), R"(#\s*include\s*"\.\.?/)") == "");
}

TEST_CASE("nodes do not include tools, and nothing includes tests") {
    CHECK(offenders(sources({"nodes"}), R"(#\s*include\s*[<"](tools|tests)/)") == "");
    CHECK(offenders(sources({"tools"}), R"(#\s*include\s*[<"]tests/)") == "");
}

TEST_CASE("CGAL, SuiteSparse and JSON stay in their rooms") {
    const auto all = sources({"engine", "solver", "nodes", "tools"});
    CHECK(offenders(all, R"(#\s*include\s*<CGAL/)", {"solver/meshing/"}) == "");
    CHECK(offenders(all, R"(#\s*include\s*<(suitesparse/)?(cholmod|umfpack|SuiteSparse|amd|colamd)|openblas_|cblas)",
                    {"solver/linear/"}) == "");
    CHECK(offenders(sources({"solver"}), R"(nlohmann)") == "");
    CHECK(offenders(sources({"engine"}), R"(#\s*include\s*<Eigen)") == "");
}

TEST_CASE("libraries never print") {
    CHECK(offenders(sources({"engine", "solver", "nodes"}), R"(std::(cout|cerr|clog)|\b(f?printf|puts)\s*\()") == "");
}

TEST_CASE("files that graphs name are opened through one door") {
    const std::string opens = R"(\b(ifstream|ofstream|fstream|fopen|FILE)\b|::open\()";
    CHECK(offenders(sources({"nodes"}), opens) == "");
    // The door, what is written, and what Sinew keeps under names of its own.
    CHECK(offenders(sources({"engine"}), opens,
                    {"engine/file_access.", "engine/atomic_file.", "engine/eval/disk_store.",
                     "engine/eval/frame_store.", "engine/memory_limit."}) == "");
    // Readers take bytes; what opens by itself serves tools and tests.
    CHECK(offenders(sources({"nodes"}), R"(solver::read_(surface|tets)\()") == "");
}

TEST_CASE("no unfinished work hides behind a word") {
    CHECK(offenders(sources({"engine", "solver", "nodes", "tools"}), R"(\b(TODO|FIXME|XXX|HACK)\b)") == "");
}

TEST_CASE("every source names its licence in its first lines, on a line of its own") {
    std::ostringstream missing;
    for (const SourceFile& f : sources({"engine", "solver", "nodes", "tools", "tests"})) {
        bool found = false;
        for (std::size_t i = 0; i < f.lines.size() && i < 10; ++i)
            found = found || f.lines[i] == "// SPDX-License-Identifier: GPL-3.0-or-later";
        if (!found) missing << f.path << "\n";
    }
    CHECK(missing.str() == "");
}

TEST_CASE("what a docstring says of a parameter begins a line") {
    CHECK(offenders(sources({"engine", "solver", "nodes", "tools", "tests"}), R"(//.*[^ /].*[\\@](param|return)\b)",
                    {"tests/house/"}) == "");
}

TEST_CASE("no source is longer than 600 lines") {
    for (const SourceFile& f : sources({"engine", "solver", "nodes", "tools", "tests"})) {
        INFO(f.path);
        CHECK(f.lines.size() <= 600);
    }
}

TEST_CASE("sources are formatted as .clang-format says") {
    const std::string root = SINEW_SOURCE_DIR;
    const std::string command =
        "cd '" + root +
        "' && find engine nodes solver tests tools -name '*.cpp' -o -name '*.h' | "
        "grep -v node_modules | xargs clang-format --dry-run --Werror 2>&1 | grep -E 'error|not found' | head -20";
    FILE* out = popen(command.c_str(), "r");
    REQUIRE(out);
    std::string found;
    char line[512];
    while (std::fgets(line, sizeof line, out)) found += line;
    pclose(out);
    CHECK(found == "");
}

TEST_CASE("node types are registered by name, not by static initialisers") {
    CHECK(offenders(sources({"engine", "nodes"}),
                    R"(^\s*(static|inline)\s+[^(]*\b(registrar|registration|register_\w+)\b.*[={])") == "");
}

TEST_CASE("no mutable globals") {
    // The one exception is the lock around METIS, which draws from the C library's own global random numbers.
    CHECK(offenders(sources({"engine", "solver", "nodes"}),
                    R"(^\s*(static|thread_local)\s+(?!const\b|constexpr\b)[^()]*[;={])",
                    {"solver/linear/cholmod_threads.cpp"}) == "");
}

TEST_CASE("every folder of a room is named in the room's README, and what the README names is there") {
    for (const std::string room : {"engine", "solver", "nodes", "tools"}) {
        const std::string readme = text_of(room + "/README.md");
        const fs::path root = fs::path(SINEW_SOURCE_DIR) / room;
        for (const auto& entry : fs::directory_iterator(root)) {
            if (!entry.is_directory()) continue;
            INFO(room << "/README.md does not say what " << entry.path().filename() << " is for");
            CHECK(readme.find("`" + entry.path().filename().string() + "/") != std::string::npos);
        }
        std::set<std::string> files;
        for (const SourceFile& f : sources({room, "tests"})) files.insert(fs::path(f.path).filename().string());
        for (const auto& [name, count] : matches(readme, "`([a-z_/]+(/|[.]h|[.]cpp))`")) {
            INFO(room << "/README.md names " << name << ", which is not there");
            CHECK((fs::exists(root / name) || fs::exists(fs::path(SINEW_SOURCE_DIR) / name) || files.contains(name)));
        }
    }
}

TEST_CASE("every diagnostic code in a source is in the table, and every one in the table is given somewhere") {
    const std::string code = "\"((DG|FE|IO)[0-9][0-9][0-9])\"";
    const auto known = matches(text_of("engine/codes.cpp"), "[{]" + code);
    CHECK(known.size() > 80);
    std::set<std::string> given;
    for (const SourceFile& f : sources({"engine", "solver", "nodes", "tools"})) {
        if (f.path == "engine/codes.cpp") continue;
        for (const std::string& line : f.lines)
            for (const auto& [name, count] : matches(line, code)) {
                INFO(f.path << " gives " << name << ", which engine/codes.cpp does not explain");
                CHECK(known.contains(name));
                given.insert(name);
            }
    }
    for (const auto& [name, count] : known) {
        INFO(name << " is in engine/codes.cpp, but nothing gives it");
        CHECK(count == 1);
        CHECK(given.contains(name));
    }
}

TEST_CASE("links and paths in the documentation lead somewhere") {
    const fs::path root = SINEW_SOURCE_DIR;
    std::vector<fs::path> pages{"README.md"};
    for (const char* folder : {"docs", "engine", "solver", "nodes", "tools", "graphs", "tests"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const std::string path = fs::relative(entry.path(), root).generic_string();
            if (entry.path().extension() == ".md" && path.find("node_modules") == std::string::npos)
                pages.push_back(path);
        }
    CHECK(pages.size() > 15);
    for (const fs::path& page : pages) {
        const std::string text = text_of(page.generic_string());
        for (const auto& [link, count] : matches(text, "\\]\\(([^)#:]+)(#[^)]*)?\\)")) {
            INFO(page.generic_string() << " links to " << link);
            CHECK(fs::exists(root / page.parent_path() / link));
        }
        // Words in capitals stand for names of the reader's own.
        for (const auto& [path, count] :
             matches(text, "`((docs|graphs|tools|tests|nodes|solver|engine)/[a-zA-Z0-9_/.-]+)`")) {
            if (std::regex_search(path, std::regex("[A-Z]{3}")) && path.find("README") == std::string::npos) continue;
            INFO(page.generic_string() << " names " << path);
            CHECK(fs::exists(root / path));
        }
    }
}
