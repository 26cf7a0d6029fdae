// Numbered files that one text names: "cache/skin.####.obj" is skin.0001.obj, skin.0002.obj …
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>

namespace sinew::engine {

/// Whether the last part of a path has a run of # for numbers and no file has just this name.
bool names_sequence(const std::string& path);

/// The files on disk that such a path names, by number: where it has n #, those with n digits or more, zeros in front
/// only where there are n. Empty: there are none. The path has one run of #; where it has several, the last one stands
/// for the number.
std::map<long long, std::string> find_sequence(const std::string& path);

/// The same path with another count of #, by which the most files are named; empty: by none there is any.
std::string near_sequence(const std::string& path);

} // namespace sinew::engine
