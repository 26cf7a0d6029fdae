// The two ways in which a reader may end.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/byte_stream.h"
#include "engine/diagnostics.h"
#include "solver/error.h"

#include <stdexcept>
#include <string>

namespace sinew::fuzz {

inline void promise(bool kept, const char* what) {
    if (!kept) throw std::logic_error(what);
}

/// Runs `read`. A refusal with a code and words is well, and so are bytes of which no value can be made.
template <class Read>
void refused_or_read(const Read& read) {
    try {
        read();
    } catch (const solver::Error& e) {
        promise(e.code.size() == 5 && *e.what() != 0, "an Error without code or words");
    } catch (const engine::BadBytes& e) {
        promise(*e.what() != 0, "BadBytes without words");
    } catch (const engine::Failure& f) {
        promise(!f.diagnostics().empty(), "a Failure without diagnostics");
        for (const engine::Diagnostic& d : f.diagnostics())
            promise(d.code.size() == 5 && !d.message.empty(), "a Diagnostic without code or words");
    }
}

} // namespace sinew::fuzz
