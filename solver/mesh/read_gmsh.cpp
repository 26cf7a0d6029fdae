// Gmsh .msh files: formats 1, 2.x and 4.1; text, and from 2 on binary.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <unordered_map>

namespace sinew::solver {
namespace {

/// Vertices of each element type, from 1; and whether it is a solid.
struct Kind {
    int vertices;
    bool is_solid;
};
constexpr std::array<Kind, 32> kinds{
    {{0, false},  {2, false},  {3, false}, {4, false}, {4, true},  {8, true},   {6, true},   {5, true},
     {3, false},  {6, false},  {9, false}, {10, true}, {27, true}, {18, true},  {14, true},  {1, false},
     {8, false},  {20, true},  {15, true}, {13, true}, {9, false}, {10, false}, {12, false}, {15, false},
     {15, false}, {21, false}, {4, false}, {5, false}, {6, false}, {20, true},  {35, true},  {56, true}}};
constexpr int linear_tet = 4;

/// Numbers written as words.
class TextSource {
  public:
    TextSource(std::string_view bytes, const std::string& file)
        : text_(bytes, file, 0)
        , file_(file) {}
    /// The next word, which should be "$Name"; empty at the end.
    std::string_view section() { return text_.word(); }
    void skip_to(const std::string& end) {
        while (!text_.at_end())
            if (text_.word() == end) return;
        fail("the file ends before " + end);
    }
    void expect(const std::string& end) {
        if (const std::string_view w = text_.word(); w != end)
            fail("'" + printable(w) + "' stands where " + end + " should");
    }
    long long number32(const char* what) { return text_.integer(what); }
    long long number64(const char* what) { return text_.integer(what); }
    double real(const char* what) { return text_.number(what); }
    long long line_number(const char* what) { return text_.integer(what); }
    std::size_t remaining() const { return text_.remaining(); }
    /// Where the last word stood, and that as the begin of a message.
    std::size_t place() const { return static_cast<std::size_t>(text_.line()); }
    std::string where(std::size_t place) const { return file_ + ":" + std::to_string(place) + ": "; }
    [[noreturn]] void fail(const std::string& problem) const { text_.fail(problem); }

  private:
    TextScanner text_;
    std::string file_;
};

/// The same file with numbers as bytes; section names and some counts stay words on lines of their own.
class BinarySource {
  public:
    BinarySource(std::string_view bytes, std::size_t at, std::string file, bool swapped)
        : bytes_(bytes)
        , at_(at)
        , file_(std::move(file))
        , swapped_(swapped) {}
    std::string_view section() {
        while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
        return line();
    }
    void skip_to(const std::string& end) {
        const std::size_t found = bytes_.find(end, at_);
        if (found == std::string_view::npos) fail("the file ends before " + end);
        at_ = found + end.size();
    }
    void expect(const std::string& end) {
        if (const std::string_view w = section(); w != end)
            fail("'" + printable(w) + "' stands where " + end + " should");
    }
    long long number32(const char* what) { return raw<std::int32_t>(what); }
    long long number64(const char* what) {
        const auto value = raw<std::uint64_t>(what);
        if (value > 1ull << 62) fail(std::string(what) + " is too large");
        return static_cast<long long>(value);
    }
    double real(const char* what) {
        const auto value = raw<double>(what);
        if (!std::isfinite(value)) throw Error("FE202", where(at_) + std::string(what) + " is not finite");
        return value;
    }
    /// A number that stands as text on a line.
    long long line_number(const char* what) {
        const std::string_view text = line();
        return TextScanner(text, file_, 0).to_integer(text, what);
    }
    std::size_t remaining() const { return bytes_.size() - at_; }
    std::size_t place() const { return at_; }
    std::string where(std::size_t place) const { return file_ + ": byte " + std::to_string(place) + ": "; }
    [[noreturn]] void fail(const std::string& problem) const { throw Error("IO403", where(at_) + problem); }

  private:
    static bool is_space(char c) { return c == '\n' || c == '\r' || c == ' ' || c == '\t'; }
    std::string_view line() {
        const std::size_t first = at_, end = std::min(bytes_.find('\n', at_), bytes_.size());
        at_ = std::min(end + 1, bytes_.size());
        std::string_view text = bytes_.substr(first, end - first);
        while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
        return text;
    }
    template <class Number>
    Number raw(const char* what) {
        if (remaining() < sizeof(Number)) fail("the file ends where " + std::string(what) + " should stand");
        char copy[sizeof(Number)];
        std::memcpy(copy, bytes_.data() + at_, sizeof copy);
        if (swapped_) std::reverse(copy, copy + sizeof copy);
        at_ += sizeof copy;
        Number value;
        std::memcpy(&value, copy, sizeof copy);
        return value;
    }

    std::string_view bytes_;
    std::size_t at_;
    std::string file_;
    bool swapped_;
};

/// Sections of any version, from either source.
template <class Source>
class GmshReader {
  public:
    GmshReader(Source source, int version, bool is_binary)
        : in_(std::move(source))
        , version_(version)
        , is_binary_(is_binary) {}

    TetMesh read(const std::string& file) {
        bool has_nodes = false, has_elements = false;
        for (std::string_view word = in_.section(); !word.empty(); word = in_.section()) {
            if (word.front() != '$') in_.fail("'" + printable(word) + "' stands where a section ($…) should");
            const std::string name(word.substr(1));
            if (name == "Nodes" || name == "NOD") {
                if (has_nodes) in_.fail("the nodes appear twice");
                has_nodes = true;
                version_ == 4 ? read_node_blocks() : read_nodes();
                in_.expect(name == "NOD" ? "$ENDNOD" : "$EndNodes");
            } else if (name == "Elements" || name == "ELM") {
                if (has_elements) in_.fail("the elements appear twice");
                has_elements = true;
                read_elements();
                in_.expect(name == "ELM" ? "$ENDELM" : "$EndElements");
            } else {
                in_.skip_to("$End" + name);
            }
        }
        if (!has_nodes || !has_elements) in_.fail(has_nodes ? "the file has no elements" : "the file has no nodes");
        std::vector<Tet> tets;
        for (const auto& tags : tet_tags_) {
            Tet t;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto found = vertex_.find(tags[k]);
                if (found == vertex_.end())
                    throw Error("FE203", in_.where(tet_places_[tets.size()]) + "tet " + std::to_string(tets.size()) +
                                             " uses node " + std::to_string(tags[k]) +
                                             ", which the file does not have");
                t[k] = found->second;
            }
            tets.push_back(t);
        }
        return finish_tets(file, std::move(points_), std::move(tets));
    }

  private:
    /// A count that the rest of the file can hold, each thing taking `least` bytes or more.
    std::size_t count(long long n, const char* what, std::size_t least) {
        if (n < 0 || static_cast<unsigned long long>(n) > in_.remaining() / least + 1)
            in_.fail(std::string(what) + " is " + std::to_string(n) + ", which the rest of the file cannot hold");
        return static_cast<std::size_t>(n);
    }
    void add_point(long long tag) {
        Vec3 p;
        for (int d = 0; d < 3; ++d) p[d] = in_.real("a coordinate");
        if (!vertex_.try_emplace(tag, static_cast<int>(points_.size())).second)
            in_.fail("node " + std::to_string(tag) + " appears twice");
        points_.push_back(p);
    }

    void read_nodes() {
        const std::size_t n = count(in_.line_number("the number of nodes"), "the number of nodes", 8);
        for (std::size_t i = 0; i < n; ++i) add_point(in_.number32("a node number"));
    }

    void read_node_blocks() {
        const std::size_t blocks = count(in_.number64("the number of node blocks"), "the number of node blocks", 4);
        for (const char* what : {"the number of nodes", "the least node number", "the largest node number"})
            in_.number64(what);
        for (std::size_t b = 0; b < blocks; ++b) {
            const long long dimension = in_.number32("the dimension of a node block");
            in_.number32("the entity of a node block");
            const long long parametric = in_.number32("whether nodes have parameters");
            if (dimension < 0 || dimension > 3) in_.fail("a node block has dimension " + std::to_string(dimension));
            const std::size_t n = count(in_.number64("the size of a node block"), "the size of a node block", 8);
            std::vector<long long> tags;
            for (std::size_t i = 0; i < n; ++i) tags.push_back(in_.number64("a node number"));
            for (const long long tag : tags) {
                add_point(tag);
                for (long long k = 0; parametric != 0 && k < dimension; ++k) in_.real("a parameter");
            }
        }
    }

    void check_kind(long long kind) {
        if (kind < 1 || kind >= static_cast<long long>(kinds.size()))
            in_.fail("elements of type " + std::to_string(kind) + " are not known");
        if (kinds[static_cast<std::size_t>(kind)].is_solid && kind != linear_tet)
            in_.fail("elements of type " + std::to_string(kind) + " cannot be used; only tets of 4 nodes (type 4) can");
    }
    /// The nodes of one element, kept if it is a tet.
    template <class Next>
    void add_element(long long kind, long long vertices, const Next& next) {
        std::array<long long, 4> tags{};
        for (long long k = 0; k < vertices; ++k) {
            const long long tag = next();
            if (k < 4) tags[static_cast<std::size_t>(k)] = tag;
        }
        if (kind != linear_tet) return;
        tet_tags_.push_back(tags);
        tet_places_.push_back(in_.place());
    }

    void read_elements() {
        if (version_ == 4) return read_element_blocks();
        const std::size_t n = count(in_.line_number("the number of elements"), "the number of elements", 4);
        const auto node = [&] { return in_.number32("a node of an element"); };
        for (std::size_t i = 0; i < n;) {
            // Binary files say type and number of tags once for a run of elements.
            long long kind = 0, run = 1, tags = 0;
            if (is_binary_) {
                kind = in_.number32("an element type");
                run = in_.number32("the size of a run of elements");
                tags = in_.number32("the number of tags");
                if (run < 1 || static_cast<unsigned long long>(run) > n - i)
                    in_.fail("a run of " + std::to_string(run) + " elements does not fit");
                count(tags, "the number of tags", 1);
                check_kind(kind);
            }
            for (long long e = 0; e < run; ++e, ++i) {
                in_.number32("an element number");
                if (!is_binary_) check_kind(kind = in_.number32("an element type"));
                const long long vertices = kinds[static_cast<std::size_t>(kind)].vertices;
                if (version_ == 1) {
                    for (const char* what : {"a physical entity", "an elementary entity"}) in_.number32(what);
                    if (const long long said = in_.number32("the number of nodes of an element"); said != vertices)
                        in_.fail("an element of type " + std::to_string(kind) + " with " + std::to_string(said) +
                                 " nodes");
                } else {
                    if (!is_binary_) count(tags = in_.number32("the number of tags"), "the number of tags", 1);
                    for (long long k = 0; k < tags; ++k) in_.number32("a tag");
                }
                add_element(kind, vertices, node);
            }
        }
    }

    void read_element_blocks() {
        const std::size_t blocks =
            count(in_.number64("the number of element blocks"), "the number of element blocks", 4);
        for (const char* what : {"the number of elements", "the least element number", "the largest element number"})
            in_.number64(what);
        for (std::size_t b = 0; b < blocks; ++b) {
            in_.number32("the dimension of an element block");
            in_.number32("the entity of an element block");
            const long long kind = in_.number32("an element type");
            check_kind(kind);
            const std::size_t n =
                count(in_.number64("the size of an element block"), "the size of an element block", 4);
            for (std::size_t i = 0; i < n; ++i) {
                in_.number64("an element number");
                add_element(kind, kinds[static_cast<std::size_t>(kind)].vertices,
                            [&] { return in_.number64("a node of an element"); });
            }
        }
    }

    Source in_;
    int version_;
    bool is_binary_;
    Points points_;
    std::unordered_map<long long, int> vertex_; ///< by node number
    std::vector<std::array<long long, 4>> tet_tags_;
    std::vector<std::size_t> tet_places_; ///< where the last node of each stands
};

} // namespace

TetMesh read_gmsh(std::string_view bytes, const std::string& file) {
    TextScanner head(bytes, file, 0);
    const std::string_view first = head.word();
    if (first == "$NOD") return GmshReader(TextSource(bytes, file), 1, false).read(file);
    if (first != "$MeshFormat") head.fail("the file begins neither with $MeshFormat nor with $NOD");
    const double version = head.number("the format's version");
    const long long binary = head.integer("whether the file is binary"), word = head.integer("the size of numbers");
    const int family = version >= 2 && version < 3 ? 2 : version == 4.1 ? 4 : 0;
    if (family == 0) head.fail("format " + std::to_string(version) + " cannot be read; save it as 2.2 or 4.1");
    if (binary != 0 && binary != 1) head.fail("the file is neither text (0) nor binary (1)");
    if (word != 8) head.fail("numbers of " + std::to_string(word) + " bytes cannot be read; only 8 can");
    const std::string end = "$EndMeshFormat";
    const std::size_t found = bytes.find(end);
    if (found == std::string_view::npos) head.fail("the file ends before " + end);
    if (binary == 0) {
        TextSource source(bytes, file);
        source.skip_to(end);
        return GmshReader(std::move(source), family, false).read(file);
    }
    // After the line with the version, the number 1 shows the order of the bytes.
    head.rest_of_line();
    const std::size_t one_at = bytes.size() - head.remaining();
    char one[4]{};
    if (one_at + sizeof one <= bytes.size()) std::memcpy(one, bytes.data() + one_at, sizeof one);
    const bool little = one[0] == 1 && one[1] == 0 && one[2] == 0 && one[3] == 0;
    const bool big = one[3] == 1 && one[0] == 0 && one[1] == 0 && one[2] == 0;
    if (!little && !big) head.fail("the number 1 that shows the order of bytes is missing");
    // This program's own order is little-endian (write_mesh.cpp asserts it).
    return GmshReader(BinarySource(bytes, found + end.size(), file, big), family, true).read(file);
}

} // namespace sinew::solver
