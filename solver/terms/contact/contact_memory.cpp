// The bytes of ContactMemory: how many contacts, those, how many couplings, those, how many pairs, those;
// how many were dropped.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_memory.h"

#include "solver/term/memory_bytes.h"
#include "solver/terms/contact/contact.h"

namespace sinew::solver {

void keep_contacts(const ContactMemory& contacts, TermMemory& memory) {
    const std::size_t size = size_in_memory(contacts.contacts) + size_in_memory(contacts.couplings) +
                             size_in_memory(contacts.pairs) + sizeof contacts.dropped;
    std::byte* to = memory.bytes.rewrite(size).data();
    put_in_memory(contacts.contacts, to);
    put_in_memory(contacts.couplings, to);
    put_in_memory(contacts.pairs, to);
    std::memcpy(to, &contacts.dropped, sizeof contacts.dropped);
}

void contacts_kept(const std::vector<TermMemory>& memories, ContactMemory& out) {
    out.contacts.clear(), out.couplings.clear(), out.pairs.clear(), out.dropped = 0;
    const TermMemory* memory = find_memory(memories, contact_type.name);
    if (!memory || memory->bytes.empty()) return;
    std::span<const std::byte> bytes = memory->bytes;
    take_from_memory(bytes, out.contacts, "contacts");
    take_from_memory(bytes, out.couplings, "contacts");
    take_from_memory(bytes, out.pairs, "contacts");
    if (bytes.size() != sizeof out.dropped)
        throw Error("IO403", "the contacts of a saved simulation state have bytes left over, or too few");
    std::memcpy(&out.dropped, bytes.data(), sizeof out.dropped);
}

} // namespace sinew::solver
