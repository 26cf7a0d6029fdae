// The checks that a binding must pass, whether it came from a file or from an edit.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <string>
#include <vector>

namespace sinew::engine {

/// A diagnostic without its place. `below` points at the offending part inside the input ("/keys/3/1"), for
/// readers that know the text.
struct Problem {
    Diagnostic diagnostic;
    std::string below;
};

/// Type, limits, options, keyframes, and whether the connected plug exists and fits.
std::vector<Problem> check_binding(const Graph& graph, std::string_view node, const NodeType& type,
                                   const AttributeInfo& input, const Binding& binding);

/// Required inputs that are not there, lists with too few connections, names of entries that are not there.
std::vector<Problem> check_required(const Graph& graph, std::string_view node, const Node& n,
                                    std::span<const std::string> names = {});

/// The names that an input with names_entry_of can hold, by place: the nodes connected to the list that what is
/// connected here has one entry for. Empty where nothing with entries is connected.
std::vector<std::string> entry_names(const Graph& graph, const Node& n, const AttributeInfo& input);

/// Why a timing cannot be used: the key that it is about, and what would be right.
struct TimingFault {
    std::string_view key; ///< fps, start or end
    std::string message, hint;
};
std::vector<TimingFault> timing_faults(const Timing& timing);
/// Why a number is no frame, or empty.
std::string frame_fault(double frame);

/// How many frames a simulation can have: a chain of them fits in memory, and nobody films longer.
inline constexpr double farthest_frame = 1e7;

/// Warns of literals that contradict the graph's timing where that is the default (DG031). An error, DG104: a
/// simulation that starts too far before the graph's end.
std::vector<Diagnostic> check_timing(const Graph& graph);

/// What an attribute is, in the first sentence of its documentation: a range alone does not say what is right.
std::string meaning_of(const AttributeInfo& input);

/// "did you mean …?" if one is near, else "known: a, b or c" if there are few, else empty.
std::string name_hint(std::string_view word, std::span<const std::string> candidates, std::string_view known);

/// The same for a node that there is none of: such as are called so in an included graph come first, as that graph's
/// file and overrides of it may have it without the prefix.
/// \param beside the node whose input it is said of, if it is; those of its include are meant before others
std::string node_hint(const Graph& graph, std::string_view name, std::string_view beside = {});

/// The same for an input that a type does not have: near ones, whose it may be, what there is.
std::string input_hint(const Graph& graph, const NodeType& type, std::string_view input);

std::vector<std::string> input_names(const NodeType& type);
std::vector<std::string> output_names(const NodeType& type);

/// Why a node cannot have this name, or empty.
std::string name_fault(std::string_view name);

} // namespace sinew::engine
