// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/read_value.h"

#include "engine/connection_meant.h"
#include "engine/file_sequence.h"
#include "engine/format/typed_text.h"
#include "engine/format/value_meant.h"
#include "engine/near_file.h"
#include "engine/text.h"
#include "engine/units.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace sinew::engine {

namespace {

namespace fs = std::filesystem;

// 3 mm shall be the double nearest to 0.003: a division by 1000 is, a product with 1e-3 often is not.
double converted(double v, double factor) {
    const double inverse = std::round(1 / factor);
    if (factor < 1 && std::abs(1 / factor - inverse) < 1e-9 * inverse) return v / inverse;
    return v * factor;
}

class BindingReader {
  public:
    BindingReader(const Graph& graph, const AttributeInfo& input, const std::string& folder,
                  std::vector<Problem>& problems)
        : graph_(graph)
        , input_(input)
        , folder_(folder)
        , files_(graph.files())
        , problems_(problems)
        , before_(problems.size()) {}

    std::optional<Binding> read(const Json& json) {
        Binding out = any(json);
        if (problems_.size() > before_) return {};
        return out;
    }

  private:
    void problem(std::string_view code, std::string message, std::string hint = {}, std::string below = {}) {
        Problem p;
        p.diagnostic.code = code;
        p.diagnostic.attribute = input_.name;
        p.diagnostic.message = std::move(message);
        p.diagnostic.hint = std::move(hint);
        p.below = std::move(below);
        problems_.push_back(std::move(p));
    }

    bool is_list_input() const { return input_.kind == AttributeKind::wire_list; }

    Binding any(const Json& json) {
        if (const auto* object = json.as<Json::Object>()) return from_object(json, *object);
        const auto* list = json.as<Json::List>();
        if (is_list_input() && list) return connections(*list);
        if (input_.kind == AttributeKind::literal)
            return list && is_listed_connection(*list) ? Binding(Value()) : literal(json, "", 1);
        const std::string file =
            file_node_form(graph_, input_, named_in(list && list->size() == 1 ? list->front() : json));
        const std::string form = connection_form(list && list->size() == 1 ? list->front() : json);
        if (list)
            problem("DG020", "takes one connection, not a list", file.empty() ? "write " + form : file);
        else
            problem("DG026",
                    "a " + std::string(input_.type_name) + " can only be connected, found " + std::string(json.kind()),
                    !file.empty() ? file : "write " + (is_list_input() ? "[ " + form + " ]" : form));
        return Value();
    }

    /// How the connection that somebody meant is written.
    std::string connection_form(const Json& json) const { return "{ \"from\": " + plug_form(named_in(json)) + " }"; }

    /// "a.out" of "a.out" and { "from": "a.out" }; empty of all else.
    static std::string named_in(const Json& json) {
        const Json* from = json.find("from");
        const auto* text = (from ? *from : json).as<std::string>();
        return text ? *text : "";
    }

    /// The output that somebody meant, in quotes.
    std::string plug_form(const std::string& text) const {
        const std::string meant = text.empty() ? "" : output_meant(graph_, input_, text, true);
        return meant.empty() ? "\"node.output\"" : json_quoted(meant);
    }

    /// Whether the graph has the output that text where a value is expected would name.
    bool names_output(const std::string& text) const {
        return !has_many() && !output_meant(graph_, input_, text, false).empty();
    }

    /// Problems enough: a list may hold a million words, and each would be looked for among all nodes.
    bool has_many() const { return problems_.size() >= before_ + 20; }

    /// [ { "from": … } ] where one connection fits. False: it is none that does.
    bool is_listed_connection(const Json::List& list) {
        const auto is_connection = [&](const Json& one) {
            return one.find("from") && !named_in(one).empty() && names_output(named_in(one));
        };
        constexpr std::size_t most = 20; // beyond that it is a list by mistake of another kind
        if (list.empty() || list.size() > most || !std::all_of(list.begin(), list.end(), is_connection)) return false;
        problem("DG020", "takes one value, not a list of connections",
                "write " + connection_form(list.front()) + (list.size() > 1 ? ", or another one of them" : ""));
        return true;
    }

    // Exactly one of these keys says what the object is.
    Binding from_object(const Json& json, const Json::Object& object) {
        static const std::vector<std::string> kinds = {"from", "value", "keys", "preset"};
        static const std::vector<std::string> all = {"from", "value", "unit", "keys", "interp", "preset", "comment"};
        if (input_.kind == AttributeKind::literal && input_.def.is<Vec3>() && is_by_axis(object)) {
            problem("DG012", "expected a list of numbers, found an object",
                    "write " + axes_form(json, input_.def.as<Vec3>()));
            return Value();
        }
        std::string kind;
        for (const JsonMember& m : object) {
            if (std::find(all.begin(), all.end(), m.key) == all.end()) {
                const std::string meant = other_word(m.key);
                problem("DG007", "unknown key " + json_quoted(m.key),
                        meant.empty() ? name_hint(m.key, all, "keys") : "did you mean " + json_quoted(meant) + "?",
                        pointer_token(m.key));
            } else if (std::find(kinds.begin(), kinds.end(), m.key) != kinds.end()) {
                if (!kind.empty())
                    problem("DG012", "holds both " + json_quoted(kind) + " and " + json_quoted(m.key),
                            "keep one of them", pointer_token(m.key));
                kind = m.key;
            }
        }
        if (problems_.size() > before_) return Value();
        if (kind.empty()) {
            problem("DG012", "expected " + std::string(input_.type_name) +
                                 ", found an object without \"from\", \"value\" or \"keys\"");
            return Value();
        }
        if (json.find("unit") && kind != "value" && kind != "keys")
            problem("DG015", "a unit stands beside \"value\" or \"keys\" only", {}, "/unit");
        if (json.find("interp") && kind != "keys")
            problem("DG017", "\"interp\" stands beside \"keys\" only", {}, "/interp");
        if (kind == "from") return connection(json, "");
        if (input_.kind != AttributeKind::literal) {
            problem("DG026", "a " + std::string(input_.type_name) + " can only be connected",
                    "write { \"from\": \"node.output\" }");
            return Value();
        }
        if (kind == "preset") return preset(*json.find("preset"));
        const double factor = unit(json.find("unit"));
        if (kind == "keys") return curve(json, factor);
        return literal(*json.find("value"), "/value", factor);
    }

    Plug connection(const Json& json, const std::string& below) {
        const Json* from = json.find("from");
        const auto* object = json.as<Json::Object>();
        const bool has_comment = below.empty() && json.find("comment"); // in a list it could not be kept
        if (!from || object->size() != (has_comment ? 2u : 1u)) {
            problem("DG025", "expected a connection, found " + std::string(json.kind()),
                    "write " + connection_form(json), below);
            return {};
        }
        const auto* text = from->as<std::string>();
        const auto plug = text ? parse_plug(*text) : std::nullopt;
        if (!plug)
            problem("DG025", (text ? json_quoted(*text) : std::string(from->kind())) + " does not name an output",
                    "write " + (text ? plug_form(*text) : "\"node.output\""), below + "/from");
        return plug.value_or(Plug{});
    }

    Binding connections(const Json::List& list) {
        std::vector<Plug> out;
        for (std::size_t i = 0; i < list.size(); ++i) out.push_back(connection(list[i], "/" + std::to_string(i)));
        return out;
    }

    double unit(const Json* json) {
        if (!json) return 1;
        has_unit_ = true;
        if (const auto* text = json->as<std::string>()) return unit(*text, "/unit", "");
        problem("DG015", "a unit is text, found " + std::string(json->kind()), {}, "/unit");
        return 1;
    }

    /// \param number that stands before it in the same text, if it does
    double unit(const std::string& text, const std::string& below, const std::string& number) {
        const std::string meant = input_.unit.empty() ? "" : unit_meant(text, input_.unit);
        const std::string hint = meant.empty() ? "usual units here: " + usual_units(input_.unit)
                                               : "write " + json_quoted(number + (number.empty() ? "" : " ") + meant);
        if (input_.unit.empty())
            problem("DG015", "has no unit, found " + json_quoted(text),
                    "write the plain value: a number without a unit, in scene units if it is a length", below);
        else if (!parse_unit(text))
            problem("DG015", "unknown unit " + json_quoted(text), hint, below);
        else if (const auto factor = unit_factor(text, input_.unit))
            return *factor;
        else
            problem("DG015", json_quoted(text) + " does not convert to " + json_quoted(input_.unit), hint, below);
        return 1;
    }

    Binding preset(const Json& json) {
        const auto* named = json.as<std::string>();
        if (!input_.options.empty()) {
            const std::vector<std::string> words(input_.options.begin(), input_.options.end());
            const std::string near = named ? nearest_name(*named, words) : "";
            problem("DG016", "has words instead of presets",
                    "write one without an object" + (near.empty() ? "" : ", " + json_quoted(near)) +
                        "; words: " + listed(words),
                    "/preset");
        } else if (input_.presets.empty())
            problem("DG016", "has no presets", input_.def.is<double>() ? "write a number" : "write the value itself",
                    "/preset");
        else if (const auto* text = json.as<std::string>())
            return Value::of<double>(preset(*text, "/preset"));
        else
            problem("DG016", "unknown preset " + std::string(json.kind()), "presets: " + listed(preset_names()),
                    "/preset");
        return Value();
    }

    bool is_preset(const std::string& name) const {
        return std::any_of(input_.presets.begin(), input_.presets.end(),
                           [&](const Preset& p) { return p.name == name; });
    }

    double preset(const std::string& name, const std::string& below) {
        for (const Preset& p : input_.presets)
            if (name == p.name) return p.value;
        if (!name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) && !names_no_number(name))
            problem("DG016", "unknown preset " + json_quoted(name), preset_hint(name), below);
        else
            problem("DG016", json_quoted(name) + " is neither a number nor a preset", number_form(), below);
        return 0;
    }

    std::string preset_hint(const std::string& name) const {
        const std::vector<std::string> names = preset_names();
        if (const std::string hint = name_hint(name, names, "presets"); !hint.empty()) return hint;
        std::vector<std::string> holding; // "muscle" is a part of several
        for (const std::string& n : names)
            if (name.size() > 2 && lower_case(n).find(lower_case(name)) != std::string::npos)
                holding.push_back(json_quoted(n));
        return holding.empty() || holding.size() > 8 ? number_form() : "did you mean " + listed(holding) + "?";
    }

    /// "NaN", "inf": somebody's program has written it.
    static bool names_no_number(std::string text) {
        if (text.starts_with('-') || text.starts_with('+')) text.erase(0, 1);
        for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return text == "nan" || text == "inf" || text == "infinity";
    }

    /// How numbers are written here.
    std::string number_form() const {
        return "write a finite number" +
               (input_.unit.empty() || input_.unit == "1"
                    ? std::string()
                    : ", or one with its unit; usual here: " + usual_units(input_.unit)) +
               (input_.presets.empty() ? "" : "; or a preset, for example " + json_quoted(input_.presets.front().name));
    }

    std::vector<std::string> preset_names() const {
        std::vector<std::string> out;
        for (const Preset& p : input_.presets) out.emplace_back(p.name);
        return out;
    }

    void wrong_type(const Json& json, const std::string& below, std::string expected = {}, std::string hint = {}) {
        if (expected.empty()) expected = input_.type_name;
        const auto* text = json.as<std::string>();
        const auto* list = json.as<Json::List>();
        if (text && names_output(*text)) hint = "write " + connection_form(json);
        if (hint.empty() && text && !has_many()) hint = file_node_form(graph_, input_, *text);
        if (json.find("from") && !has_many()) hint = "connect the whole input: " + connection_form(json);
        if (hint.empty() && list && list->size() == 1) hint = plain_form(list->front());
        if (hint.empty() && !input_.options.empty())
            hint = "options: " + listed(std::vector<std::string>(input_.options.begin(), input_.options.end()));
        problem("DG012", "expected " + expected + ", found " + std::string(json.kind()), std::move(hint), below);
    }

    std::optional<double> number(const Json& json, const std::string& below, double factor) {
        if (const auto* i = json.as<std::int64_t>()) return converted(static_cast<double>(*i), factor);
        if (const auto* d = json.as<double>()) return converted(*d, factor);
        if (const auto* text = json.as<std::string>()) return number_in(json, *text, below);
        wrong_type(json, below, "number");
        return {};
    }

    static std::string without_quotes(double number) { return "write " + number_text(number) + " without quotes"; }

    /// "30 kPa", or the name of a preset.
    std::optional<double> number_in(const Json& json, const std::string& text, const std::string& below) {
        const auto quantity = parse_quantity(text);
        if (!quantity && !input_.presets.empty() && (is_preset(text) || !names_output(text)))
            return preset(text, below);
        if (!quantity)
            wrong_type(json, below, "number",
                       text.empty() || names_no_number(text) || begins_as_number(text) ? number_form() : "");
        else if (quantity->unit.empty())
            wrong_type(json, below, "number", without_quotes(quantity->number));
        else if (const std::string form = parse_unit(quantity->unit) ? "" : grouped_form(text); !form.empty())
            wrong_type(json, below, "number", form);
        else if (quantity->unit.starts_with(','))
            wrong_type(json, below, "number", decimal_form(text));
        else if (has_unit_)
            problem("DG015", json_quoted(text) + " holds a unit, and \"unit\" stands beside it", "keep one of them",
                    below);
        else
            return converted(quantity->number, unit(quantity->unit, below, number_text(quantity->number)));
        return {};
    }

    /// A number without a unit: frames.
    std::optional<double> plain_number(const Json& json, const std::string& below) {
        const auto* text = json.as<std::string>();
        if (!text) return number(json, below, 1);
        const auto typed = parse_quantity(*text);
        wrong_type(json, below, "number", typed && typed->unit.empty() ? without_quotes(typed->number) : "");
        return {};
    }

    std::optional<std::int64_t> integer(const Json& json, const std::string& below) {
        if (const auto* i = json.as<std::int64_t>()) return *i;
        const auto* d = json.as<double>();
        if (d && *d == std::floor(*d) && std::abs(*d) < 9e15) return static_cast<std::int64_t>(*d);
        const auto* text = json.as<std::string>();
        const auto typed = text ? parse_quantity(*text) : std::nullopt;
        if (d)
            problem("DG012", number_text(*d) + " is not an integer", {}, below);
        else
            wrong_type(json, below, "",
                       typed && typed->unit.empty() ? without_quotes(typed->number)
                       : text                       ? grouped_form(*text)
                                                    : "");
        return {};
    }

    // Reads a list of numbers; a list of lists is read row by row (matrices).
    void numbers(const Json& json, const std::string& below, double factor, bool rows, NumberList& out) {
        const auto* list = json.as<Json::List>();
        if (!list) return wrong_type(json, below, "a list of numbers", list_form(json));
        if (const std::string form = rows ? "" : flat_form(*list); !form.empty()) // once, however many there are
            return problem("DG012", "expected a list of numbers, found a list of lists", form, below);
        for (std::size_t i = 0; i < list->size(); ++i) {
            const std::string place = below + "/" + std::to_string(i);
            if (rows && (*list)[i].as<Json::List>())
                numbers((*list)[i], place, factor, false, out);
            else
                out.push_back(number((*list)[i], place, factor).value_or(0));
        }
    }

    /// How the list that somebody meant by a number or text is written; empty if that cannot be told.
    std::string list_form(const Json& json) const {
        if (input_.def.is<Vec3>()) return vector_form(input_, json);
        const auto* text = json.as<std::string>();
        const NumberList meant = text ? numbers_in(*text) : NumberList();
        const bool fits = input_.def.is<Matrix4>() ? meant.size() == 16 : !meant.empty();
        return fits ? "write " + list_text(meant) : "";
    }

    template <std::size_t N>
    Binding fixed(const Json& json, const std::string& below, double factor) {
        NumberList all;
        numbers(json, below, factor, N == 16, all);
        std::array<double, N> out{};
        if (problems_.size() > before_) return Value();
        if (all.size() != N)
            problem("DG012", "expected " + std::to_string(N) + " numbers, found " + std::to_string(all.size()),
                    N == 16 ? "write four rows of four numbers, or all in one list" : vector_form(input_, json), below);
        std::copy_n(all.begin(), std::min(N, all.size()), out.begin());
        return Value::of<std::array<double, N>>(out);
    }

    Binding literal(const Json& json, const std::string& below, double factor) {
        const Value& kind = input_.def;
        if (const std::string form = input_.keyable ? pairs_form(json) : ""; !form.empty()) {
            wrong_type(json, below, "", "write { \"keys\": " + form + " }");
            return Value();
        }
        if (kind.is<double>()) return Value::of<double>(number(json, below, factor).value_or(0));
        if (kind.is<std::int64_t>()) return Value::of<std::int64_t>(integer(json, below).value_or(0));
        if (kind.is<Vec3>()) return fixed<3>(json, below, factor);
        if (kind.is<Matrix4>()) return fixed<16>(json, below, factor);
        if (kind.is<NumberList>()) {
            NumberList out;
            const auto* text = json.as<std::string>();
            if (json.as<Json::List>() || (text && numbers_in(*text).size() > 1))
                numbers(json, below, factor, false, out);
            else if (const auto one = number(json, below, factor))
                out.push_back(*one);
            return Value::of<NumberList>(std::move(out));
        }
        if (const auto* b = json.as<bool>(); b && kind.is<bool>()) return Value::of<bool>(*b);
        if (const auto* t = json.as<std::string>()) {
            if (kind.is<std::string>()) return Value::of<std::string>(*t);
            if (kind.is<File>()) return file(*t, below);
        }
        if (kind.is<bool>())
            wrong_type(json, below, "true or false", bool_form(json));
        else if (kind.is<std::string>() && input_.options.empty())
            wrong_type(json, below, "", text_form(json));
        else
            wrong_type(json, below, kind.is<File>() ? "the path of a file" : "");
        return Value();
    }

    /// Which file of a folder may be meant.
    std::string file_in(const fs::path& folder) const {
        constexpr std::size_t most = 12;
        std::vector<std::string> inside = files_in(resolved_path(folder.string(), folder_));
        const auto known = readable_endings();
        std::erase_if(inside, [&](const std::string& name) {
            const std::string ending = lower_case(fs::path(name).extension().string());
            return std::find(known.begin(), known.end(), ending) == known.end();
        });
        if (inside.empty() || inside.size() > most) return "name the file in it that is meant";
        for (std::string& name : inside) name = json_quoted((folder / name).generic_string());
        return "name a file in it: " + listed(inside);
    }

    Binding file(const std::string& path, const std::string& below) {
        File out;
        if (path.empty()) return Value::of<File>(out);
        if (const auto fault = file_name_fault(path)) {
            problem(fault->code, fault->message, fault->hint, below);
            return Value::of<File>(out);
        }
        out.path = resolved_path(path, folder_);
        if (const auto fault = files_.refusal(out.path)) { // before anything is asked of the disk
            problem(fault->code, json_quoted(path) + " leads out of the root '" + files_.root().string() + "'",
                    fault->hint, below);
            return Value::of<File>(std::move(out));
        }
        if (names_sequence(out.path)) {
            if (find_sequence(out.path).empty()) {
                const std::string near = fs::path(near_sequence(out.path)).filename().string();
                problem("IO401", "there is no file like " + json_quoted(path),
                        near.empty()
                            ? "looked for " + out.path +
                                  " with numbers for #; relative paths start at the graph's folder"
                            : "did you mean " + json_quoted(fs::path(path).replace_filename(near).generic_string()) +
                                  "? A # stands for each digit of numbers with zeros in front",
                        below);
            }
            return Value::of<File>(std::move(out));
        }
        std::error_code ec;
        const auto status = fs::status(out.path, ec);
        if (!fs::exists(status)) {
            const std::string near = near_file(out.path, readable_endings());
            problem("IO401", "there is no file " + json_quoted(path),
                    near.empty()
                        ? "looked for " + out.path + "; relative paths start at the graph's folder"
                        : "did you mean " + json_quoted(fs::path(path).replace_filename(near).generic_string()) + "?",
                    below);
        }
        if (fs::is_directory(status)) problem("IO402", json_quoted(path) + " is a folder", file_in(path), below);
        return Value::of<File>(std::move(out));
    }

    std::vector<double> keyed(const Json& json, const std::string& below, double factor) {
        if (input_.def.is<Vec3>() || input_.def.is<Matrix4>() || input_.def.is<NumberList>()) {
            NumberList out;
            numbers(json, below, factor, input_.def.is<Matrix4>(), out);
            return out;
        }
        if (const auto* b = json.as<bool>(); b && input_.def.is<bool>()) return {*b ? 1.0 : 0.0};
        if (input_.def.is<bool>()) return wrong_type(json, below, "true or false"), std::vector<double>{0};
        if (input_.def.is<std::int64_t>()) return {static_cast<double>(integer(json, below).value_or(0))};
        if (input_.def.is<std::string>()) return {option(json, below)};
        return {number(json, below, factor).value_or(0)};
    }

    // The number of an option. An unknown word is told here; it stands for the first one from there on.
    double option(const Json& json, const std::string& below) {
        const auto* word = json.as<std::string>();
        if (!word) return wrong_type(json, below, "one of the options"), 0.0;
        const auto at = std::find(input_.options.begin(), input_.options.end(), *word);
        if (at != input_.options.end()) return static_cast<double>(at - input_.options.begin());
        const std::vector<std::string> words(input_.options.begin(), input_.options.end());
        problem("DG014", json_quoted(*word) + " is not an option", name_hint(*word, words, "options"), below);
        return 0;
    }

    void tangents(Key& key, const Json& json, const std::string& below, double factor) {
        const auto* object = json.as<Json::Object>();
        if (!object) return wrong_type(json, below, "{ \"in\": …, \"out\": … }");
        static const std::vector<std::string> known = {"in", "out"};
        for (const JsonMember& m : *object) {
            const std::string place = below + pointer_token(m.key);
            if (m.key == "in")
                key.tangent_in = keyed(m.value, place, factor);
            else if (m.key == "out")
                key.tangent_out = keyed(m.value, place, factor);
            else
                problem("DG007", "unknown key " + json_quoted(m.key), name_hint(m.key, known, "keys"), place);
        }
    }

    Binding curve(const Json& json, double factor) {
        Curve out;
        out.interpolation = input_.is_stepped() ? Interpolation::step : Interpolation::linear;
        if (!input_.keyable) return out; // check_binding says so
        static const std::vector<std::string> words = {"step", "linear", "smooth"};
        if (const Json* interp = json.find("interp")) {
            const auto* text = interp->as<std::string>();
            const auto word = std::find(words.begin(), words.end(), text ? *text : "");
            if (word == words.end())
                problem("DG017", "unknown interpolation " + (text ? json_quoted(*text) : std::string(interp->kind())),
                        interpolation_form(text ? *text : ""), "/interp");
            else
                out.interpolation = static_cast<Interpolation>(word - words.begin());
        }
        const Json& keys = *json.find("keys");
        const auto* list = keys.as<Json::List>();
        if (!list) return wrong_type(keys, "/keys", "a list of [frame, value]", keys_form(keys)), out;
        if (const std::string form = keys_form(keys); !form.empty()) {
            problem("DG017", "a key is [frame, value] or [frame, value, { \"in\": …, \"out\": … }]", form, "/keys");
            return out;
        }
        for (std::size_t i = 0; i < list->size(); ++i) {
            const std::string place = "/keys/" + std::to_string(i);
            const auto* pair = (*list)[i].as<Json::List>();
            if (!pair || pair->size() < 2 || pair->size() > 3) {
                problem("DG017", "a key is [frame, value] or [frame, value, { \"in\": …, \"out\": … }]", {}, place);
                continue;
            }
            Key key;
            key.frame = plain_number((*pair)[0], place + "/0").value_or(0);
            key.value = keyed((*pair)[1], place + "/1", factor);
            if (pair->size() == 3) {
                if (out.interpolation != Interpolation::smooth)
                    problem("DG017", "tangents need \"interp\": \"smooth\"", {}, place + "/2");
                tangents(key, (*pair)[2], place + "/2", factor);
            }
            out.keys.push_back(std::move(key));
        }
        return out;
    }

    const Graph& graph_;
    const AttributeInfo& input_;
    const std::string& folder_;
    const FileAccess& files_;
    std::vector<Problem>& problems_;
    std::size_t before_;
    bool has_unit_ = false; ///< a key "unit" stands beside the value
};

} // namespace

std::optional<Binding> read_binding(const Graph& graph, const AttributeInfo& input, const Json& json,
                                    const std::string& folder, std::vector<Problem>& problems) {
    return BindingReader(graph, input, folder, problems).read(json);
}

const Json& offending_part(const Json& json, const std::string& below) {
    const Json* wrapped = json.find("value");
    if (wrapped && below.rfind("/value", 0) != 0 && &json.nearest(below) == &json) return wrapped->nearest(below);
    return json.nearest(below);
}

std::optional<FileFault> file_name_fault(const std::string& path) {
    if (path.find('\0') == std::string::npos) return {};
    return FileFault{"IO402", json_quoted(path) + " holds a character of code 0, which no name of a file can",
                     "leave out \\u0000"};
}

std::string resolved_path(const std::string& path, const std::string& folder) {
    const fs::path p(path);
    return (p.is_absolute() ? p : fs::path(folder) / p).lexically_normal().generic_string();
}

std::optional<Plug> parse_plug(std::string_view text) {
    const std::size_t dot = text.rfind('.');
    if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size()) return {};
    return Plug{std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

std::string folder_of(const std::string& graph_file) { return fs::path(graph_file).parent_path().generic_string(); }

} // namespace sinew::engine
