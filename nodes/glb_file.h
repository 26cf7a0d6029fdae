// The container of binary glTF 2.0 (Khronos specification): its description and the numbers that accessors point at.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>

namespace sinew::nodes {

/// Where the numbers of an accessor lie: every one of them within the file.
struct GlbNumbers {
    const char* first;
    std::size_t count, stride; ///< of elements, [bytes] from one to the next
    std::size_t component;     ///< glTF's componentType
    std::size_t size;          ///< of a component [bytes]
};

/// A count or an index of the description, which JSON may spell as anything: solver::Error IO403 where it is no whole
/// number from 0 on. `name`: what it is, for the message.
std::size_t whole(const nlohmann::json& number, std::string_view name);
/// The same of a key of an object that may be missing.
std::size_t whole(const nlohmann::json& object, const char* key, std::size_t otherwise);

class GlbFile {
  public:
    /// Reads the chunks of `bytes`, which must outlive this. Throws solver::Error IO403 with the reason, without the
    /// file's name, and nlohmann::json::exception where the description is no JSON.
    explicit GlbFile(std::string_view bytes);
    const nlohmann::json& document() const { return document_; }
    /// Of an accessor with elements of `type` ("VEC3") and `width` components. Nothing is allocated. Throws
    /// solver::Error IO403, IO404 (sparse, or in another file) and nlohmann::json::exception.
    GlbNumbers numbers(std::size_t accessor, std::string_view type, std::size_t width) const;

  private:
    nlohmann::json document_;
    std::string_view binary_;
};

} // namespace sinew::nodes
