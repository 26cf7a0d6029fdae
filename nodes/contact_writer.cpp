// contactWriter: the contacts of a frame as a table; whoever pulls it puts it on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "engine/text.h"
#include "nodes/adapters.h"
#include "nodes/contacts.h"
#include "nodes/options.h"

namespace sinew::nodes {

using namespace engine;

namespace {

/// Numbers of one kind, with a name for each in tables, and one for all in JSON.
struct Column {
    std::string_view json;
    std::vector<std::string_view> csv;
    void (*write)(const solver::ContactPoint&, std::vector<std::string>&);
};

void add_vector(const solver::Vec3& v, std::vector<std::string>& out) {
    for (int c = 0; c < 3; ++c) out.push_back(number_text(v[c]));
}

const std::vector<Column>& columns() {
    using Words = std::vector<std::string>;
    using Contact = solver::ContactPoint;
    static const std::vector<Column> all{
        {"source", {"source"}, [](const Contact& c, Words& out) { out.push_back(std::to_string(c.source)); }},
        {"target", {"target"}, [](const Contact& c, Words& out) { out.push_back(std::to_string(c.target)); }},
        {"point", {"point"}, [](const Contact& c, Words& out) { out.push_back(std::to_string(c.point)); }},
        {"sliding", {"sliding"}, [](const Contact& c, Words& out) { out.emplace_back(c.slides ? "true" : "false"); }},
        {"at", {"x", "y", "z"}, [](const Contact& c, Words& out) { add_vector(c.place, out); }},
        {"normal",
         {"normal_x", "normal_y", "normal_z"},
         [](const Contact& c, Words& out) { add_vector(c.normal, out); }},
        {"depth_m", {"depth_m"}, [](const Contact& c, Words& out) { out.push_back(number_text(c.depth)); }},
        {"force_N",
         {"force_x_N", "force_y_N", "force_z_N"},
         [](const Contact& c, Words& out) { add_vector(c.force, out); }},
    };
    return all;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
    std::string out;
    for (std::size_t i = 0; i < words.size(); ++i) out += (i ? between : "") + words[i];
    return out;
}

std::string as_csv(const ContactList& list) {
    std::vector<std::string> words;
    for (const Column& column : columns()) words.insert(words.end(), column.csv.begin(), column.csv.end());
    std::string out = joined(words, ",") + "\n";
    for (const solver::ContactPoint& c : list.contacts) {
        words.clear();
        for (const Column& column : columns()) column.write(c, words);
        out += joined(words, ",") + "\n";
    }
    return out;
}

std::string as_json(const ContactList& list) {
    std::string out = "{\"contacts\": [";
    for (std::size_t i = 0; i < list.contacts.size(); ++i) {
        std::vector<std::string> entries;
        for (const Column& column : columns()) {
            std::vector<std::string> words;
            column.write(list.contacts[i], words);
            const std::string value = joined(words, ", ");
            entries.push_back("\"" + std::string(column.json) +
                              "\": " + (words.size() > 1 ? "[" + value + "]" : value));
        }
        out += (i ? ",\n  {" : "\n  {") + joined(entries, ", ") + "}";
    }
    return out + (list.contacts.empty() ? "]}\n" : "\n]}\n");
}

const Wire<ContactList> contacts{.name = "contacts", .doc = "The contacts to write: zSolver.outContacts."};
constexpr Option<std::string (*)(const ContactList&)> formats[] = {{"csv", as_csv}, {"json", as_json}};
const Input<std::string> format{
    .name = "format",
    .def = "csv",
    .doc =
        "The kind of file: csv has a line of names and a line a contact, json a list \"contacts\" of objects. Of each: "
        "source and target, the bodies whose point and whose surface it is, by their places in zSolver.bodies, counted "
        "from 0; point, its number among the points of the source; sliding, or else held; where the point is (x, y, z; "
        "at), in scene units; the normal out of the target; depth_m; and force_N, with which the target acts on the "
        "source, friction included.",
    .keyable = false,
    .options = words(formats),
};
const Output<FileContent> out_file{.name = "outFile", .doc = "The file's bytes and ending."};

void compute(const Reads& in, Writes& out) {
    out.set(out_file, FileContent{in[format], meaning(formats, in[format])(in[contacts])});
}

} // namespace

void add_contact_writer(Registry& registry) {
    NodeType type;
    type.name = "contactWriter";
    type.doc = "Makes a table of the contacts of each frame.";
    type.inputs = {describe(contacts), describe(format)};
    type.outputs = {describe(out_file)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
