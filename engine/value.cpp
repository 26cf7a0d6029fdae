// Traits of the types that a graph file can write as literals.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/value.h"

#include <cctype>
#include <filesystem>
#include <stdexcept>

namespace sinew::engine {

void Value::throw_mismatch(std::string_view wanted, std::string_view held) {
    throw std::logic_error("a value that holds " + std::string(held) + " was read as " + std::string(wanted));
}

void ValueTraits<bool>::hash(Hasher& h, const bool& v) { h.add(v); }
std::size_t ValueTraits<bool>::bytes(const bool&) { return 0; }

void ValueTraits<std::int64_t>::hash(Hasher& h, const std::int64_t& v) { h.add(v); }
std::size_t ValueTraits<std::int64_t>::bytes(const std::int64_t&) { return 0; }

void ValueTraits<double>::hash(Hasher& h, const double& v) { h.add(v); }
std::size_t ValueTraits<double>::bytes(const double&) { return 0; }

void ValueTraits<std::string>::hash(Hasher& h, const std::string& v) { h.add(std::string_view(v)); }
std::size_t ValueTraits<std::string>::bytes(const std::string& v) { return v.capacity(); }

void ValueTraits<Vec3>::hash(Hasher& h, const Vec3& v) { h.add_doubles(v); }
std::size_t ValueTraits<Vec3>::bytes(const Vec3&) { return 0; }

void ValueTraits<Matrix4>::hash(Hasher& h, const Matrix4& v) { h.add_doubles(v); }
std::size_t ValueTraits<Matrix4>::bytes(const Matrix4&) { return 0; }

void ValueTraits<NumberList>::hash(Hasher& h, const NumberList& v) { h.add_doubles(v); }
std::size_t ValueTraits<NumberList>::bytes(const NumberList& v) { return v.capacity() * sizeof(double); }

// The extension takes part because readers choose the format by it; the rest of the path never does, so a
// project may be moved to another folder or machine without a frame being lost.
void ValueTraits<File>::hash(Hasher& h, const File& v) {
    std::string extension = std::filesystem::path(v.path).extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    h.add(!v.path.empty()).add(std::string_view(extension)).add(v.content);
}
std::size_t ValueTraits<File>::bytes(const File& v) { return v.path.capacity(); }

} // namespace sinew::engine
