// The bytes of ContactMemory: how many contacts, those, how many couplings, those, how many pairs, those.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_memory.h"

#include "solver/term/memory_bytes.h"
#include "solver/terms/contact/contact.h"

namespace sinew::solver {

void keep_contacts(const ContactMemory& contacts, TermMemory& memory) {
    const std::size_t size =
        size_in_memory(contacts.contacts) + size_in_memory(contacts.couplings) + size_in_memory(contacts.pairs);
    std::byte* to = memory.bytes.rewrite(size).data();
    put_in_memory(contacts.contacts, to);
    put_in_memory(contacts.couplings, to);
    put_in_memory(contacts.pairs, to);
}

void contacts_kept(const std::vector<TermMemory>& memories, ContactMemory& out) {
    out.contacts.clear(), out.couplings.clear(), out.pairs.clear();
    const TermMemory* memory = find_memory(memories, contact_type.name);
    if (!memory || memory->bytes.empty()) return;
    std::span<const std::byte> bytes = memory->bytes;
    take_from_memory(bytes, out.contacts, "contacts");
    take_from_memory(bytes, out.couplings, "contacts");
    take_from_memory(bytes, out.pairs, "contacts");
    if (!bytes.empty()) throw Error("IO403", "the contacts of a saved simulation state have bytes left over");
}

} // namespace sinew::solver
