// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/embed/host_types.h"

#include "tools/embed/session.h"

#include <new>
#include <stdexcept>

namespace sinew::embed {

namespace {

constexpr const char* cure = "this node type is the host's: repair it there";

/// What the exception at work says, of whom there is one to name; Failure and Cancelled go on.
std::string words_of_host(const std::string& who = {}) {
    try {
        throw;
    } catch (const engine::Failure&) {
        throw;
    } catch (const engine::Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        return who.empty() ? e.what() : who + ": " + e.what();
    } catch (...) {
        return (who.empty() ? "it" : who) + " threw something that is no std::exception";
    }
}

template <class Call>
auto told(const engine::Reads& in, Call&& call) {
    try {
        return call();
    } catch (const std::bad_alloc&) {
        in.fail({}, "FE305", "there is not enough memory for it", "Choose fewer tets, faces or frames at once.");
    } catch (...) {
        in.fail({}, "DG127", words_of_host(), cure);
    }
}

[[noreturn]] void fail_without_node(std::string message) {
    engine::Diagnostic d;
    d.code = "DG127", d.message = std::move(message), d.hint = cure;
    throw engine::Failure(std::move(d));
}

/// As above where there is no node to name: `what` it does, and with which type.
template <class Call>
auto told_of(const std::string& what, Call&& call) {
    try {
        return call();
    } catch (...) {
        fail_without_node(words_of_host(what));
    }
}

engine::NodeType with_errors_told(engine::NodeType type) {
    if (type.compute)
        type.compute = [compute = type.compute](const engine::Reads& in, engine::Writes& out) {
            told(in, [&] { compute(in, out); });
        };
    if (!type.simulation) return type;
    const engine::SimulationFunctions plain = *type.simulation;
    auto wrapped = std::make_shared<engine::SimulationFunctions>(plain);
    wrapped->initial = [plain](const engine::Reads& in) { return told(in, [&] { return plain.initial(in); }); };
    wrapped->advance = [plain](const engine::Value& before, std::span<const engine::SubstepReads> substeps) {
        return told(substeps.back().end, [&] { return plain.advance(before, substeps); });
    };
    wrapped->publish = [plain](const engine::Value& state, const engine::Reads& in, engine::Writes& out) {
        told(in, [&] { plain.publish(state, in, out); });
    };
    const std::string name(type.name);
    wrapped->save = [plain, name](const engine::Value& state) {
        return told_of("saving a state of " + name, [&] { return plain.save(state); });
    };
    wrapped->load = [plain, name](std::span<const std::byte> bytes) {
        return told_of("loading a state of " + name, [&] { return plain.load(bytes); });
    };
    type.simulation = std::move(wrapped);
    return type;
}

} // namespace

void add_host_type(engine::Registry& registry, engine::NodeType type) {
    const std::string name(type.name);
    if (type.revision.empty())
        throw Misuse("DG128", "node type " + name + ": has no revision",
                     "give it one, and another one whenever its code gives other results", {name, ""});
    try {
        registry.add(with_errors_told(std::move(type)));
    } catch (const std::logic_error& e) {
        throw Misuse("DG128", e.what(), "change the declaration", {name, ""});
    }
}

} // namespace sinew::embed
