// What lies in a cache folder: which files are Sinew's own, how much they take, and which go where there is no room.
// A user may name any folder, so what others keep in it is neither counted nor touched, whatever it is called.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace sinew::engine {

/// Endings of what is kept: frames of simulations, rows of what plugs hold, outputs, and the warnings of a run, which
/// the command line keeps (tools/cli/kept_warnings.h).
inline constexpr std::string_view frames_ending = ".frame", rows_ending = ".rows", outputs_ending = ".kept",
                                  warnings_ending = ".warnings";

/// What a cache folder holds.
struct DiskUse {
    std::size_t frames = 0, outputs = 0, files = 0; ///< files: of all kinds
    std::uintmax_t bytes = 0;
};
DiskUse disk_use(const std::filesystem::path& folder);

struct Removal {
    DiskUse removed;
    std::size_t left = 0;        ///< files that could not be removed
    std::filesystem::path first; ///< of those, or the folder if it cannot be looked into
    std::string why;             ///< of `first`; empty: nothing is left
};
/// Removes what Sinew keeps in a folder, and the folder where nothing else is in it.
Removal remove_kept(const std::filesystem::path& folder);

/// Removes what was used longest ago until `most` bytes are left, and what killed programs have left unfinished.
/// \param spared files that stay, whatever their age
void make_room(const std::filesystem::path& folder, std::uintmax_t most, const std::set<std::filesystem::path>& spared);

} // namespace sinew::engine
