// An independent reader of GLB files: checks the rules of glTF 2.0 that the writer must keep, and gives
// numbers back.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sinew::test {

struct Glb {
    nlohmann::json document;
    std::string binary;
    /// Throws std::runtime_error with the first rule of the container that is broken.
    explicit Glb(const std::string& file);
    /// Every number of a float accessor, element after element.
    std::vector<float> floats(int accessor) const;
    std::vector<std::uint32_t> indices(int accessor) const;
    /// One line for each broken rule of the document; empty = valid.
    std::vector<std::string> problems() const;

  private:
    template <class T>
    std::vector<T> numbers(int accessor) const;
};

} // namespace sinew::test
