// The bytes of ContactMemory: how many contacts, those, how many couplings, those.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_memory.h"

#include "solver/error.h"
#include "solver/terms/contact/contact.h"

#include <cstdint>
#include <cstring>
#include <span>

namespace sinew::solver {

namespace {

template <class T>
void append(const std::vector<T>& items, std::vector<std::byte>& bytes) {
    const std::uint64_t count = items.size();
    const auto* first = reinterpret_cast<const std::byte*>(&count);
    bytes.insert(bytes.end(), first, first + sizeof count);
    first = reinterpret_cast<const std::byte*>(items.data());
    bytes.insert(bytes.end(), first, first + items.size() * sizeof(T));
}

template <class T>
void take(std::span<const std::byte>& bytes, std::vector<T>& items) {
    std::uint64_t count = 0;
    if (bytes.size() >= sizeof count) std::memcpy(&count, bytes.data(), sizeof count);
    if (bytes.size() < sizeof count || count > (bytes.size() - sizeof count) / sizeof(T))
        throw Error("IO403", "the contacts of a saved simulation state end too early");
    bytes = bytes.subspan(sizeof count);
    items.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes.data(), count * sizeof(T));
    bytes = bytes.subspan(count * sizeof(T));
}

} // namespace

void keep_contacts(const ContactMemory& contacts, TermMemory& memory) {
    std::vector<std::byte> bytes;
    append(contacts.contacts, bytes);
    append(contacts.couplings, bytes);
    memory.bytes = std::move(bytes);
}

ContactMemory contacts_kept(const std::vector<TermMemory>& memories) {
    ContactMemory out;
    const TermMemory* memory = find_memory(memories, contact_type.name);
    if (!memory || memory->bytes.empty()) return out;
    std::span<const std::byte> bytes = memory->bytes;
    take(bytes, out.contacts);
    take(bytes, out.couplings);
    if (!bytes.empty()) throw Error("IO403", "the contacts of a saved simulation state have bytes left over");
    return out;
}

} // namespace sinew::solver
