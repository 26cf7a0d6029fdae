// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/python_types.h"

#include "tools/embed/host_types.h"
#include "tools/python/arrays.h"
#include "tools/python/python_session.h"
#include "tools/python/python_value.h"

#include <deque>
#include <functional>
#include <map>
#include <pybind11/stl.h>

namespace sinew::python {

using engine::AttributeInfo;
using engine::Input;
using engine::Limits;
using engine::Output;
using engine::Reads;
using engine::Value;
using engine::Wire;
using engine::WireList;

namespace {

[[noreturn]] void refuse(const std::string& type, const std::string& what, const std::string& hint) {
    throw embed::Misuse("DG128", "node type " + type + ": " + what, hint, {type, ""});
}

template <std::size_t N>
std::array<double, N> exactly(const std::vector<double>& v) {
    if (v.size() != N) throw py::value_error(std::to_string(v.size()) + " numbers where " + std::to_string(N) + " fit");
    std::array<double, N> out{};
    std::copy(v.begin(), v.end(), out.begin());
    return out;
}

std::vector<double> numbers_of(const py::handle& object) {
    return numbers(doubles_of(object, "it is a number or an array of numbers"));
}

/// From what a Python function gives to the type of an output or a default.
template <class T>
T from_python(const py::handle& o) {
    if constexpr (std::is_same_v<T, engine::Vec3>)
        return exactly<3>(numbers_of(o));
    else if constexpr (std::is_same_v<T, engine::Matrix4>)
        return exactly<16>(numbers_of(o));
    else if constexpr (std::is_same_v<T, engine::NumberList>)
        return numbers_of(o);
    else if constexpr (std::is_same_v<T, nodes::Mesh>)
        return o.cast<const NamedMesh&>().mesh;
    else if constexpr (std::is_same_v<T, nodes::MeshList>) {
        nodes::MeshList out;
        for (const py::handle& mesh : o.cast<py::list>()) out.meshes.push_back(mesh.cast<const NamedMesh&>().mesh);
        return out;
    } else
        return o.cast<T>();
}

/// What must be known of a type of value, by the name that engine::ValueTraits gives it.
struct Kind {
    /// An input that a graph file can write, made of its Python description; null where there is none.
    std::function<AttributeInfo(const py::object&, std::string_view name, std::string_view doc, std::string_view unit,
                                std::vector<std::string_view> options)>
        input;
    std::function<AttributeInfo(std::string_view name, std::string_view doc, bool required)> wire;
    std::function<AttributeInfo(std::string_view name, std::string_view doc)> list, output;
    std::function<Value(const Reads&, std::string_view name, bool is_wire)> read;
    std::function<std::vector<Value>(const Reads&, std::string_view name)> read_list;
    std::function<Value(const py::handle&)> make;
};

template <class T>
constexpr bool is_literal = !std::is_same_v<T, nodes::Mesh> && !std::is_same_v<T, nodes::MeshList>;

template <class T>
Kind kind_of() {
    Kind k;
    if constexpr (is_literal<T>)
        k.input = [](const py::object& d, std::string_view name, std::string_view doc, std::string_view unit,
                     std::vector<std::string_view> options) {
            Input<T> input{.name = name};
            input.def = from_python<T>(d.attr("default"));
            input.doc = doc, input.unit = unit, input.options = std::move(options);
            input.keyable = d.attr("keyable").cast<bool>();
            if (!d.attr("min").is_none()) input.limits.min = d.attr("min").cast<double>();
            if (!d.attr("max").is_none()) input.limits.max = d.attr("max").cast<double>();
            return engine::describe(input);
        };
    k.wire = [](std::string_view name, std::string_view doc, bool required) {
        return engine::describe(Wire<T>{.name = name, .doc = doc, .required = required});
    };
    k.list = [](std::string_view name, std::string_view doc) {
        return engine::describe(WireList<T>{.name = name, .doc = doc});
    };
    k.output = [](std::string_view name, std::string_view doc) {
        return engine::describe(Output<T>{.name = name, .doc = doc});
    };
    k.read = [](const Reads& in, std::string_view name, bool is_wire) {
        if constexpr (is_literal<T>)
            if (!is_wire) return Value::of<T>(in[Input<T>{.name = name}]);
        const T* found = in.find(Wire<T>{.name = name});
        return found ? Value::of<T>(*found) : Value();
    };
    k.read_list = [](const Reads& in, std::string_view name) {
        std::vector<Value> out;
        for (const T& v : in[WireList<T>{.name = name}]) out.push_back(Value::of<T>(v));
        return out;
    };
    k.make = [](const py::handle& o) { return Value::of<T>(from_python<T>(o)); };
    return k;
}

const std::map<std::string, Kind>& kinds() {
    static const std::map<std::string, Kind> all{{"bool", kind_of<bool>()},
                                                 {"integer", kind_of<std::int64_t>()},
                                                 {"number", kind_of<double>()},
                                                 {"text", kind_of<std::string>()},
                                                 {"vector", kind_of<engine::Vec3>()},
                                                 {"matrix", kind_of<engine::Matrix4>()},
                                                 {"numbers", kind_of<engine::NumberList>()},
                                                 {"mesh", kind_of<nodes::Mesh>()},
                                                 {"meshes", kind_of<nodes::MeshList>()}};
    return all;
}

/// One attribute as compute needs it.
struct Attribute {
    std::string name;
    const Kind* kind = nullptr;
    enum class Form { literal, wire, list } form = Form::literal;
};

/// A type with all that it points to: the engine keeps views of names and texts.
struct Description {
    std::deque<std::string> texts;
    std::vector<Attribute> inputs, outputs;
    bool uses_time = false;
    std::optional<Kept> function;
    std::shared_ptr<Ending> ending;
    std::string_view keep(std::string text) { return texts.emplace_back(std::move(text)); }
};

const Kind& find_kind(const std::string& type, const py::object& attribute) {
    const auto word = attribute.attr("kind").cast<std::string>();
    const auto it = kinds().find(word);
    if (it != kinds().end()) return it->second;
    std::string known;
    for (const auto& [name, kind] : kinds()) known += (known.empty() ? "" : ", ") + name;
    refuse(type, "there is no kind of value '" + word + "'", "the kinds are " + known);
}

void check_limits(const std::string& type, const std::string& name, const py::object& given) {
    for (const char* limit : {"min", "max"})
        if (const py::object v = given.attr(limit); !v.is_none() && !PyNumber_Check(v.ptr()))
            refuse(type, std::string(limit) + " of " + name + " is no number", "give a number, or leave it out");
    if (!PyBool_Check(given.attr("keyable").ptr()))
        refuse(type, "keyable of " + name + " is neither True nor False", "give one of the two");
}

AttributeInfo add_input(Description& d, const std::string& type, const std::string& name, const py::object& given) {
    const auto form = given.attr("form").cast<std::string>();
    Attribute a{name, &find_kind(type, given)};
    const std::string_view kept = d.keep(name), doc = d.keep(given.attr("doc").cast<std::string>());
    AttributeInfo info;
    if (form == "wire" || form == "list") {
        a.form = form == "wire" ? Attribute::Form::wire : Attribute::Form::list;
        info = form == "wire" ? a.kind->wire(kept, doc, given.attr("required").cast<bool>()) : a.kind->list(kept, doc);
    } else {
        if (!a.kind->input) refuse(type, name + " can only be connected", "declare it with sinew.Wire");
        std::vector<std::string_view> options;
        for (const auto& word : given.attr("options").cast<std::vector<std::string>>()) options.push_back(d.keep(word));
        const std::string_view unit = d.keep(given.attr("unit").cast<std::string>());
        check_limits(type, name, given);
        const auto of_another_kind = [&] {
            refuse(type, "the default of " + name + " is of another kind", "give a value of the kind that it has");
        };
        try {
            info = a.kind->input(given, kept, doc, unit, std::move(options));
        } catch (const py::cast_error&) {
            of_another_kind();
        } catch (const py::type_error&) {
            of_another_kind();
        } catch (const py::value_error& e) {
            refuse(type, "the default of " + name + ": " + e.what(), "give as many as the kind has");
        }
    }
    d.inputs.push_back(std::move(a));
    return info;
}

py::object argument(const Reads& in, const Attribute& a) {
    if (a.form != Attribute::Form::list) {
        const Value v = a.kind->read(in, a.name, a.form == Attribute::Form::wire);
        return v ? to_python(v) : py::none();
    }
    py::list out;
    for (const Value& v : a.kind->read_list(in, a.name)) out.append(to_python(v));
    return out;
}

/// "ZeroDivisionError: division by zero (puff.py, line 12)".
std::string described(const py::error_already_set& e) {
    std::string out =
        py::str(e.type().attr("__name__")).cast<std::string>() + ": " + py::str(e.value()).cast<std::string>();
    py::object trace = e.trace();
    if (!trace || trace.is_none()) return out;
    while (!trace.attr("tb_next").is_none()) trace = trace.attr("tb_next");
    return out + " (" + trace.attr("tb_frame").attr("f_code").attr("co_filename").cast<std::string>() + ", line " +
           py::str(trace.attr("tb_lineno")).cast<std::string>() + ")";
}

py::dict results_of(const Description& d, py::object given) {
    if (py::isinstance<py::dict>(given)) return given;
    if (d.outputs.size() != 1) throw py::type_error("a node of several outputs gives a dict with a value for each");
    py::dict out;
    out[py::str(d.outputs.front().name)] = given;
    return out;
}

/// "of another kind: None in place of a sinew.Mesh".
std::string of_another_kind(const Attribute& a, const py::handle& given) {
    std::string kind = "value";
    for (const auto& [word, known] : kinds())
        if (&known == a.kind) kind = word;
    const std::string wanted = kind == "mesh"      ? "a sinew.Mesh"
                               : kind == "meshes"  ? "a list of sinew.Mesh"
                               : kind == "numbers" ? "a list of numbers"
                               : kind == "integer" ? "an integer"
                                                   : "a " + kind;
    const std::string found =
        given.is_none() ? "None" : "a " + py::str(py::type::handle_of(given).attr("__name__")).cast<std::string>();
    return "what the function returned for the output '" + a.name + "' is of another kind: " + found + " in place of " +
           wanted;
}

void compute(const Description& d, const Reads& in, engine::Writes& out) {
    if (interpreter_goes()) throw engine::Cancelled();
    const py::gil_scoped_acquire lock;
    try {
        py::dict arguments;
        for (const Attribute& a : d.inputs) arguments[py::str(a.name)] = argument(in, a);
        if (d.uses_time) arguments["frame"] = in.frame();
        const py::dict results = results_of(d, d.function->get()(**arguments));
        for (const auto& [name, value] : results) {
            const auto text = py::str(name).cast<std::string>();
            const auto same = [&](const Attribute& a) { return a.name == text; };
            if (std::none_of(d.outputs.begin(), d.outputs.end(), same))
                throw py::key_error("there is no output '" + text + "'");
        }
        for (const Attribute& a : d.outputs) {
            if (!results.contains(a.name)) throw py::key_error("nothing is given for the output '" + a.name + "'");
            const py::object given = results[py::str(a.name)];
            if (given.is_none()) throw py::type_error(of_another_kind(a, given)); // NumPy would make a number of it
            try {
                out.put(a.name, a.kind->make(given));
            } catch (const py::cast_error&) {
                throw py::type_error(of_another_kind(a, given));
            } catch (const py::reference_cast_error&) { // None in a list of meshes
                throw py::type_error(of_another_kind(a, given));
            } catch (const py::type_error&) {
                throw py::type_error(of_another_kind(a, given));
            }
        }
    } catch (const py::error_already_set& e) {
        if (e.matches(py::module_::import("sinew.errors").attr("Cancelled"))) throw engine::Cancelled();
        if (!e.matches(PyExc_Exception)) { // sys.exit and Ctrl-C are no failure of the node
            d.ending->keep(std::current_exception());
            throw engine::Cancelled();
        }
        in.fail({}, "DG127", described(e), "this node type is the host's: repair it there");
    } // the others, with words of their own, become the same (embed::add_host_type)
}

/// A function that cannot be called so fails at each frame; it is told at once.
void check_signature(const std::string& type, const Description& d, const py::object& function) {
    py::list names;
    for (const Attribute& a : d.inputs) names.append(a.name);
    if (d.uses_time) names.append("frame");
    const py::object fault = py::module_::import("sinew.node_types").attr("_signature_fault")(function, names);
    if (!fault.is_none())
        refuse(type, fault.cast<std::string>(),
               "compute is called with a value for each input by its name, and with frame if uses_time");
}

Kept add_described(engine::Registry& registry, const py::object& given, const std::shared_ptr<Ending>& ending) {
    auto d = std::make_shared<Description>();
    d->ending = ending;
    engine::NodeType type;
    const auto name = given.attr("name").cast<std::string>();
    type.name = d->keep(name);
    type.doc = d->keep(given.attr("doc").cast<std::string>());
    type.revision = given.attr("version").cast<std::string>();
    type.uses_time = d->uses_time = given.attr("uses_time").cast<bool>();
    for (const auto& [key, value] : given.attr("inputs").cast<py::dict>())
        type.inputs.push_back(add_input(*d, name, key.cast<std::string>(), py::reinterpret_borrow<py::object>(value)));
    if (d->uses_time && given.attr("inputs").contains("frame"))
        refuse(name, "an input is named frame, as the frame that compute is given", "give the input another name");
    for (const auto& [key, value] : given.attr("outputs").cast<py::dict>()) {
        const auto attribute = py::reinterpret_borrow<py::object>(value);
        Attribute a{key.cast<std::string>(), &find_kind(name, attribute)};
        type.outputs.push_back(a.kind->output(d->keep(a.name), d->keep(attribute.attr("doc").cast<std::string>())));
        d->outputs.push_back(std::move(a));
    }
    check_signature(name, *d, given.attr("compute"));
    d->function.emplace(given.attr("compute"));
    type.compute = [d](const Reads& in, engine::Writes& out) { compute(*d, in, out); };
    embed::add_host_type(registry, std::move(type));
    return *d->function;
}

} // namespace

Kept add_python_type(engine::Registry& registry, const py::object& given, const std::shared_ptr<Ending>& ending) {
    const auto of_another_kind = [&] {
        const std::string name =
            py::str(py::getattr(given, "name", py::type::handle_of(given).attr("__name__"))).cast<std::string>();
        refuse(name, "a part of its declaration is of another kind",
               "name, doc, version, unit and kind are texts, options a list of texts, inputs and outputs dicts of "
               "sinew.Input, Wire, WireList and Output; sinew.node_type makes it");
    };
    try {
        return add_described(registry, given, ending);
    } catch (const py::cast_error&) {
        of_another_kind();
    } catch (const py::error_already_set& e) {
        if (!e.matches(PyExc_AttributeError)) throw;
        of_another_kind();
    }
    throw std::logic_error("a declaration was neither taken nor refused");
}

} // namespace sinew::python
