// What is wrong, where, and what would be right. Bad graph, failed solve, cancel and bug are different types.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// A place in a graph file. `pointer` is an RFC 6901 JSON pointer; line and column count from 1, 0 = unknown.
struct SourceSpot {
    std::string file, pointer;
    int line = 0, column = 0;
    std::vector<SourceSpot> included_by = {}; ///< the places that include the file, the nearest first; empty: none
};

enum class Severity { note, warning, error };

struct Diagnostic {
    Severity severity = Severity::error;
    std::string code; ///< stable: DG0xx document, DG1xx evaluation, FE2xx mesh and set-up, FE3xx solve, IO4xx files
    std::string node, attribute;
    std::optional<SourceSpot> spot;
    std::optional<double> frame;
    std::string message; ///< what is wrong, with the offending value
    std::string hint;    ///< what would be right
};

/// "arm.json:7:25: error [DG011] biceps.youngModulus: …\n  hint: …\n  at /nodes/…"
std::string to_text(const Diagnostic&);
/// A JSON object with the same content.
std::string to_json(const Diagnostic&);

/// The graph is wrong, or a node met input that it cannot use (codes DG, FE2, IO).
class Failure : public std::exception {
  public:
    explicit Failure(std::vector<Diagnostic> diagnostics);
    explicit Failure(Diagnostic diagnostic);
    std::span<const Diagnostic> diagnostics() const { return diagnostics_; }
    const char* what() const noexcept override { return text_.c_str(); }

  private:
    std::vector<Diagnostic> diagnostics_;
    std::string text_;
};

/// The graph is right but a simulation could not go on (codes FE3xx). Frames before it stay in the store.
class SolveFailure : public Failure {
  public:
    using Failure::Failure;
};

/// The host asked to stop. Never stored, never reported as an error.
class Cancelled : public std::exception {
  public:
    const char* what() const noexcept override { return "cancelled"; }
};

/// One row per code that the program can emit: what it means and what to do; feeds docs/errors and a test.
struct CodeInfo {
    std::string_view code, title, remedy;
};
std::span<const CodeInfo> all_codes();

/// The candidate nearest to `word` by edit distance, or empty if none is near; for "did you mean".
std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

} // namespace sinew::engine
