// What a run warns of before its first step, found once: a run whose frames are all there does not make its tissues
// again only to say the same of them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"
#include "engine/eval/disk_store.h"
#include "engine/evaluator.h"

#include <optional>
#include <string>
#include <vector>

namespace sinew::cli {

class KeptWarnings {
  public:
    /// \param policy where frames are kept, warnings are; elsewhere nothing is
    /// \param nodes that are looked at
    KeptWarnings(const engine::StorePolicy& policy, const engine::Graph& graph, const std::vector<std::string>& nodes);

    /// What was said of the same graph with the same files by the same program. None: it has to be found.
    std::optional<std::vector<engine::Diagnostic>> read() const;
    /// Not what is said of the cache folder itself; and nothing where a file has changed since this was made, so that
    /// it has to be made before the files are read.
    void keep(const std::vector<engine::Diagnostic>& warnings) const;

  private:
    engine::Digest key_now() const;

    const engine::Graph& graph_;
    std::optional<engine::DiskStore> disk_;
    engine::Digest asked_, key_; ///< of all but the files, and of all
};

} // namespace sinew::cli
