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
void put(const std::vector<T>& items, std::byte*& to) {
    const std::uint64_t count = items.size();
    std::memcpy(to, &count, sizeof count);
    to += sizeof count;
    if (count > 0) std::memcpy(to, static_cast<const void*>(items.data()), count * sizeof(T));
    to += count * sizeof(T);
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
    std::byte* to = memory.bytes
                        .rewrite(2 * sizeof(std::uint64_t) + contacts.contacts.size() * sizeof(KeptContact) +
                                 contacts.couplings.size() * sizeof(CoupledCarriers))
                        .data();
    put(contacts.contacts, to);
    put(contacts.couplings, to);
}

void contacts_kept(const std::vector<TermMemory>& memories, ContactMemory& out) {
    out.contacts.clear(), out.couplings.clear();
    const TermMemory* memory = find_memory(memories, contact_type.name);
    if (!memory || memory->bytes.empty()) return;
    std::span<const std::byte> bytes = memory->bytes;
    take(bytes, out.contacts);
    take(bytes, out.couplings);
    if (!bytes.empty()) throw Error("IO403", "the contacts of a saved simulation state have bytes left over");
}

} // namespace sinew::solver
