// PLY: ascii and binary in both byte orders, faces and strips of triangles, with any further elements and properties.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

namespace sinew::solver {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> list_count; ///< type of the count in front of a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

std::size_t bytes_of(Type type) {
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

/// The numbers behind the header, whatever their encoding.
class Source {
  public:
    virtual ~Source() = default;
    virtual double next(Type type, const std::string& what) = 0;
    virtual std::size_t remaining() const = 0;            ///< bytes
    virtual std::size_t least_bytes(Type type) const = 0; ///< that one number takes
    [[noreturn]] virtual void fail(const std::string& problem) const = 0;

    std::size_t next_count(Type type, const std::string& what) {
        const double value = next(type, what);
        if (!(value >= 0) || value != std::floor(value)) fail(what + " is not a count");
        if (value > static_cast<double>(remaining())) fail(what + " is more than the rest of the file can hold");
        return static_cast<std::size_t>(value);
    }
};

class TextSource final : public Source {
  public:
    explicit TextSource(TextScanner& text)
        : text_(text) {}
    double next(Type, const std::string& what) override { return text_.number(what); }
    std::size_t remaining() const override { return text_.remaining(); }
    std::size_t least_bytes(Type) const override { return 1; }
    [[noreturn]] void fail(const std::string& problem) const override { text_.fail(problem); }

  private:
    TextScanner& text_;
};

class BinarySource final : public Source {
  public:
    BinarySource(std::string_view bytes, std::size_t at, bool swap, std::string file)
        : bytes_(bytes)
        , at_(at)
        , swap_(swap)
        , file_(std::move(file)) {}
    double next(Type type, const std::string& what) override {
        switch (type) {
        case Type::int8:
            return take<std::int8_t>(what);
        case Type::uint8:
            return take<std::uint8_t>(what);
        case Type::int16:
            return take<std::int16_t>(what);
        case Type::uint16:
            return take<std::uint16_t>(what);
        case Type::int32:
            return take<std::int32_t>(what);
        case Type::uint32:
            return take<std::uint32_t>(what);
        case Type::float32:
            return take<float>(what);
        default:
            return take<double>(what);
        }
    }
    std::size_t remaining() const override { return bytes_.size() - at_; }
    std::size_t least_bytes(Type type) const override { return bytes_of(type); }
    [[noreturn]] void fail(const std::string& problem) const override {
        throw Error("IO403", file_ + ": byte " + std::to_string(at_) + ": " + problem);
    }

  private:
    template <class T>
    double take(const std::string& what) {
        if (remaining() < sizeof(T)) fail("the file ends where " + what + " should stand");
        char raw[sizeof(T)];
        std::memcpy(raw, bytes_.data() + at_, sizeof(T));
        if (swap_) std::reverse(raw, raw + sizeof(T));
        T value;
        std::memcpy(&value, raw, sizeof(T));
        at_ += sizeof(T);
        return static_cast<double>(value);
    }
    std::string_view bytes_;
    std::size_t at_;
    bool swap_;
    std::string file_;
};

Type parse_type(TextScanner& text) {
    const std::string_view word = text.word_on_line();
    constexpr std::string_view names[8][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < 8; ++i)
        if (word == names[i][0] || word == names[i][1]) return static_cast<Type>(i);
    text.fail("'" + printable(word) + "' is not a PLY number type");
}

struct Header {
    std::string encoding;
    std::vector<Element> elements;
};

Header parse_header(TextScanner& text) {
    if (text.word() != "ply") text.fail("the file does not begin with ply");
    Header header;
    while (true) {
        text.rest_of_line();
        const std::string_view keyword = text.word();
        if (keyword == "end_header") break;
        if (keyword == "comment" || keyword == "obj_info") continue;
        if (keyword == "format") {
            header.encoding = text.word_on_line();
            if (header.encoding != "ascii" && header.encoding != "binary_little_endian" &&
                header.encoding != "binary_big_endian")
                text.fail("'" + printable(header.encoding) + "' is not a PLY encoding");
        } else if (keyword == "element") {
            Element element;
            element.name = text.word_on_line();
            const long long count = text.to_integer(text.word_on_line(), "the number of elements");
            // An element takes at least one byte; one without properties takes none and is refused below.
            if (count < 0 || static_cast<unsigned long long>(count) > text.remaining())
                text.fail("element " + printable(element.name) + " has " + std::to_string(count) +
                          " entries, more than the rest of the file can hold");
            element.count = static_cast<std::size_t>(count);
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty()) text.fail("a property stands before the first element");
            Property property;
            if (TextScanner ahead = text; ahead.word_on_line() == "list") {
                text.word_on_line();
                property.list_count = parse_type(text);
            }
            property.type = parse_type(text);
            property.name = text.word_on_line();
            header.elements.back().properties.push_back(std::move(property));
        } else {
            text.fail(keyword.empty() ? "the header has no end_header"
                                      : "'" + printable(keyword) + "' is not a PLY header line");
        }
    }
    if (header.encoding.empty()) text.fail("the header has no format line");
    return header;
}

void skip(Source& source, const Property& property, const std::string& owner) {
    std::size_t count = 1;
    if (property.list_count)
        count = source.next_count(*property.list_count, "the length of " + property.name + " of " + owner);
    for (std::size_t k = 0; k < count; ++k) source.next(property.type, property.name + " of " + owner);
}

void read_vertices(Source& source, const Element& element, Points& points) {
    points.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
        const std::string owner = "vertex " + std::to_string(i);
        Vec3 p = Vec3::Zero();
        for (const Property& property : element.properties) {
            const int axis = property.name == "x" ? 0 : property.name == "y" ? 1 : property.name == "z" ? 2 : -1;
            if (axis < 0 || property.list_count)
                skip(source, property, owner);
            else
                p[axis] = source.next(property.type, "a coordinate of " + owner);
        }
        points.push_back(p);
    }
}

bool is_corner_list(const Property& property) {
    return property.list_count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void read_faces(Source& source, const Element& element, std::vector<int>& sizes, std::vector<int>& corners) {
    sizes.reserve(element.count);
    for (std::size_t f = 0; f < element.count; ++f) {
        const std::string owner = "face " + std::to_string(f);
        for (const Property& property : element.properties) {
            if (!is_corner_list(property)) {
                skip(source, property, owner);
                continue;
            }
            const std::size_t size = source.next_count(*property.list_count, "the size of " + owner);
            if (size < 3) source.fail(owner + " has " + std::to_string(size) + " corners; it needs at least three");
            sizes.push_back(static_cast<int>(std::min<std::size_t>(size, 2147483647)));
            for (std::size_t k = 0; k < size; ++k) {
                const double v = source.next(property.type, "a vertex number of " + owner);
                if (!(v >= 0) || v != std::floor(v) || v > 2147483646)
                    source.fail("a vertex number of " + owner + " is not a whole number from 0");
                corners.push_back(static_cast<int>(v));
            }
        }
    }
}

/// Strips of triangles: each further vertex makes one with the two before it, every other of them turned round; -1 ends
/// a strip. Triangles that repeat a vertex lead from strip to strip and are no faces.
void read_strips(Source& source, const Element& element, std::vector<int>& sizes, std::vector<int>& corners) {
    for (std::size_t s = 0; s < element.count; ++s) {
        const std::string owner = "strip " + std::to_string(s);
        for (const Property& property : element.properties) {
            if (!is_corner_list(property)) {
                skip(source, property, owner);
                continue;
            }
            const std::size_t size = source.next_count(*property.list_count, "the size of " + owner);
            int before[2] = {-1, -1};
            bool turned = false;
            for (std::size_t k = 0; k < size; ++k) {
                const double v = source.next(property.type, "a vertex number of " + owner);
                if (!(v >= -1) || v != std::floor(v) || v > 2147483646)
                    source.fail("a vertex number of " + owner + " is not a whole number from -1");
                const int at = static_cast<int>(v);
                if (at < 0) {
                    before[0] = before[1] = -1, turned = false;
                    continue;
                }
                if (before[0] >= 0) {
                    if (before[0] != before[1] && before[1] != at && before[0] != at) {
                        sizes.push_back(3);
                        corners.insert(corners.end(), {before[turned ? 1 : 0], before[turned ? 0 : 1], at});
                    }
                    turned = !turned;
                }
                before[0] = before[1], before[1] = at;
            }
        }
    }
}

void require(const TextScanner& text, bool condition, const std::string& problem) {
    if (!condition) text.fail(problem);
}

} // namespace

SurfaceMesh read_ply(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file, 0);
    const Header header = parse_header(text);
    for (const Element& e : header.elements) {
        require(text, !e.properties.empty() || e.count == 0, "element " + printable(e.name) + " has no properties");
        if (e.name == "vertex")
            for (std::string_view axis : {"x", "y", "z"})
                require(text,
                        std::count_if(e.properties.begin(), e.properties.end(),
                                      [&](const Property& p) { return p.name == axis && !p.list_count; }) == 1,
                        "the vertices need one property " + std::string(axis));
        if (e.name == "face" || e.name == "tristrips")
            require(text, std::count_if(e.properties.begin(), e.properties.end(), is_corner_list) == 1,
                    "the " + std::string(e.name == "face" ? "faces" : "strips") + " need one list vertex_indices");
    }

    std::optional<TextSource> as_text;
    std::optional<BinarySource> as_binary;
    Source* source = nullptr;
    if (header.encoding == "ascii") {
        source = &as_text.emplace(text);
    } else {
        text.rest_of_line(); // the numbers begin behind the line end of end_header
        const bool file_is_big = header.encoding == "binary_big_endian";
        const bool swap = file_is_big != (std::endian::native == std::endian::big);
        source = &as_binary.emplace(bytes, bytes.size() - text.remaining(), swap, file);
    }
    Points points;
    std::vector<int> sizes, corners;
    for (const Element& element : header.elements) {
        std::size_t least = 0;
        for (const Property& p : element.properties) least += source->least_bytes(p.list_count.value_or(p.type));
        if (least > 0 && element.count > source->remaining() / least)
            source->fail(std::to_string(element.count) + " entries of " + printable(element.name) +
                         " are more than the rest of the file can hold");
        if (element.name == "vertex" && points.empty()) {
            read_vertices(*source, element, points);
        } else if (element.name == "face") {
            read_faces(*source, element, sizes, corners);
        } else if (element.name == "tristrips") {
            read_strips(*source, element, sizes, corners);
        } else {
            for (std::size_t i = 0; i < element.count; ++i)
                for (const Property& p : element.properties) skip(*source, p, element.name + " " + std::to_string(i));
        }
    }
    return finish_surface(file, std::move(points), std::move(sizes), std::move(corners));
}

} // namespace sinew::solver
