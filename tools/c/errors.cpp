// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/c/errors.h"

#include "tools/c/structs.h"

#include <new>
#include <stdexcept>
#include <vector>

namespace sinew::c {

namespace {

struct Errors {
    std::vector<engine::Diagnostic> list;
    std::string text;
};

Errors& errors() {
    static thread_local Errors mine;
    return mine;
}

engine::Diagnostic unforeseen(const char* what) {
    engine::Diagnostic d;
    d.code = "DG129";
    d.message = what;
    d.hint = "this is an error in Sinew; please tell us how it came about";
    return d;
}

engine::Diagnostic no_memory() {
    engine::Diagnostic d;
    d.code = "FE305";
    d.message = "there is not enough memory for it";
    d.hint = "check the counts that were given, or choose fewer tets, faces or frames at once";
    return d;
}

} // namespace

void forget_errors() {
    errors().list.clear();
    errors().text.clear();
}

void keep_errors(std::span<const engine::Diagnostic> diagnostics) {
    errors().list.assign(diagnostics.begin(), diagnostics.end());
    for (const engine::Diagnostic& d : diagnostics) errors().text += to_text(d) + "\n";
}

sinew_status keep_current_exception() noexcept {
    forget_errors();
    sinew_status status = SINEW_INTERNAL;
    const auto tell = [](const engine::Diagnostic& d) { keep_errors({&d, 1}); };
    try {
        try {
            throw;
        } catch (const embed::Misuse& e) {
            status = SINEW_USAGE;
            keep_errors(e.diagnostics());
        } catch (const engine::SolveFailure& e) {
            status = SINEW_SOLVE_FAILED;
            keep_errors(e.diagnostics());
        } catch (const engine::Failure& e) {
            status = SINEW_GRAPH_WRONG;
            keep_errors(e.diagnostics());
        } catch (const engine::Cancelled&) {
            status = SINEW_CANCELLED;
        } catch (const std::bad_alloc&) {
            status = SINEW_GRAPH_WRONG;
            tell(no_memory());
        } catch (const std::length_error&) {
            status = SINEW_GRAPH_WRONG;
            tell(no_memory());
        } catch (const std::exception& e) {
            tell(unforeseen(e.what()));
        } catch (...) {
            tell(unforeseen("something was thrown that is no exception"));
        }
    } catch (...) { // no memory for a message: the status alone has to do
    }
    return status;
}

sinew_diagnostic describe(const engine::Diagnostic& d) {
    sinew_diagnostic out{};
    out.size = sizeof out;
    out.severity = static_cast<sinew_severity>(d.severity);
    out.code = d.code.c_str(), out.node = d.node.c_str(), out.attribute = d.attribute.c_str();
    out.file = d.spot ? d.spot->file.c_str() : "", out.pointer = d.spot ? d.spot->pointer.c_str() : "";
    out.line = d.spot ? d.spot->line : 0, out.column = d.spot ? d.spot->column : 0;
    out.has_frame = d.frame.has_value(), out.frame = d.frame.value_or(0);
    out.message = d.message.c_str(), out.hint = d.hint.c_str();
    return out;
}

} // namespace sinew::c

size_t sinew_error_count(void) { return sinew::c::errors().list.size(); }

const char* sinew_error_text(void) { return sinew::c::errors().text.c_str(); }

sinew_status sinew_error(size_t index, sinew_diagnostic* out) {
    const auto& list = sinew::c::errors().list;
    if (index >= list.size() || !out || out->size <= sizeof(out->size) || out->size > (size_t{1} << 16))
        return SINEW_USAGE;
    sinew::c::write_struct(out, sinew::c::describe(list[index]), "out");
    return SINEW_OK;
}
