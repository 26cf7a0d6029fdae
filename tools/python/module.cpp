// The compiled part of the Python module; tools/python/sinew is the part in Python around it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/check.h"
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/python/arrays.h"
#include "tools/python/python_session.h"
#include "tools/python/python_types.h"
#include "tools/python/python_value.h"

#include <pybind11/stl.h>

namespace sinew::python {

namespace {

using engine::Diagnostic;

/// Raises sinew.errors.NAME(text, diagnostics).
void raise(const char* name, const std::string& text, std::span<const Diagnostic> diagnostics) {
    const py::object type = py::module_::import("sinew.errors").attr(name);
    const py::object error = type(text, std::vector<Diagnostic>(diagnostics.begin(), diagnostics.end()));
    PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const embed::Misuse& e) {
        raise("UsageError", e.what(), e.diagnostics());
    } catch (const engine::SolveFailure& e) {
        raise("SolveError", e.what(), e.diagnostics());
    } catch (const engine::Failure& e) {
        raise("GraphError", e.what(), e.diagnostics());
    } catch (const engine::Cancelled&) {
        raise("Cancelled", "cancelled", {});
    }
}

const char* word_of(engine::Severity s) {
    return s == engine::Severity::error ? "error" : s == engine::Severity::warning ? "warning" : "note";
}

/// What stands in a pickle: severity, code, node, attribute, the spot and those that include it, frame, message, hint.
using PlainSpot = std::tuple<std::string, std::string, int, int>;
using PlainDiagnostic = std::tuple<int, std::string, std::string, std::string, std::vector<PlainSpot>,
                                   std::optional<double>, std::string, std::string>;

PlainDiagnostic to_plain(const Diagnostic& d) {
    std::vector<PlainSpot> spots;
    const auto add = [&](const engine::SourceSpot& s) { spots.emplace_back(s.file, s.pointer, s.line, s.column); };
    if (d.spot) {
        add(*d.spot);
        std::ranges::for_each(d.spot->included_by, add);
    }
    return {static_cast<int>(d.severity), d.code, d.node, d.attribute, std::move(spots), d.frame, d.message, d.hint};
}

Diagnostic from_plain(const PlainDiagnostic& plain) {
    const auto& [severity, code, node, attribute, spots, frame, message, hint] = plain;
    Diagnostic d{.severity = static_cast<engine::Severity>(std::clamp(severity, 0, 2)),
                 .code = code,
                 .node = node,
                 .attribute = attribute,
                 .spot = {},
                 .frame = frame,
                 .message = message,
                 .hint = hint};
    for (const auto& [file, pointer, line, column] : spots) {
        engine::SourceSpot spot{.file = file, .pointer = pointer, .line = line, .column = column};
        if (d.spot)
            d.spot->included_by.push_back(std::move(spot));
        else
            d.spot = std::move(spot);
    }
    return d;
}

void add_diagnostics(py::module_& module) {
    module.def("_diagnostic", &from_plain);
    py::class_<Diagnostic>(module, "Diagnostic", "What is wrong, where, and what would be right.")
        .def_property_readonly(
            "severity", [](const Diagnostic& d) { return word_of(d.severity); }, "\"note\", \"warning\" or \"error\"")
        .def_readonly("code", &Diagnostic::code, "stable: \"DG013\"")
        .def_readonly("node", &Diagnostic::node)
        .def_readonly("attribute", &Diagnostic::attribute)
        .def_property_readonly("file", [](const Diagnostic& d) { return d.spot ? d.spot->file : ""; })
        .def_property_readonly(
            "pointer", [](const Diagnostic& d) { return d.spot ? d.spot->pointer : ""; },
            "place in the graph file, a JSON pointer")
        .def_property_readonly(
            "line", [](const Diagnostic& d) { return d.spot ? d.spot->line : 0; }, "from 1; 0: unknown")
        .def_property_readonly("column", [](const Diagnostic& d) { return d.spot ? d.spot->column : 0; })
        .def_readonly("frame", &Diagnostic::frame)
        .def_readonly("message", &Diagnostic::message, "what is wrong")
        .def_readonly("hint", &Diagnostic::hint, "what would be right")
        // Errors come out of other processes (multiprocessing, concurrent.futures) by this.
        .def("__reduce__",
             [](const Diagnostic& d) {
                 return py::make_tuple(py::module_::import("sinew.errors").attr("_diagnostic"), to_plain(d));
             })
        .def("__str__", [](const Diagnostic& d) { return to_text(d); })
        .def("__repr__", [](const Diagnostic& d) { return "<sinew.Diagnostic " + d.code + ": " + d.message + ">"; });
}

void add_events(py::module_& module) {
    py::class_<Event>(module, "Event", "What goes on, as on_event is told.")
        .def_property_readonly(
            "kind", [](const Event& e) { return std::string(e.kind); },
            "\"progress\", \"stepped\", \"computed\" or \"reused\"")
        .def_readonly("node", &Event::node)
        .def_readonly("frame", &Event::frame)
        .def_readonly("seconds", &Event::seconds, "what a step or node took")
        .def_readonly("done", &Event::done, "progress: 0 to 1")
        .def_readonly("what", &Event::what, "progress: in words");
}

/// Place of a mesh by name, or by number as Python counts.
std::size_t place_of(const embed::Frame& f, const py::object& which) {
    if (py::isinstance<py::str>(which)) {
        const auto name = which.cast<std::string>();
        if (const auto found = f.find(name)) return *found;
        throw py::key_error("there is no mesh '" + name + "'; " + engine::name_hint(name, f.names, "meshes"));
    }
    const auto count = static_cast<py::ssize_t>(f.meshes.size());
    if (!PyIndex_Check(which.ptr())) throw py::type_error("a mesh is found by the name of its body or by its place");
    auto i = which.attr("__index__")().cast<py::ssize_t>();
    if (i < 0) i += count;
    if (i < 0 || i >= count) throw py::index_error("there are " + std::to_string(count) + " meshes");
    return static_cast<std::size_t>(i);
}

NamedMesh mesh_at(const embed::Frame& f, std::size_t i) { return {f.meshes[i], f.names[i]}; }

py::list all_meshes(const embed::Frame& f) {
    py::list out;
    for (std::size_t i = 0; i < f.meshes.size(); ++i) out.append(mesh_at(f, i));
    return out;
}

void add_frames(py::module_& module) {
    using embed::Frame;
    py::class_<Frame>(
        module, "Frame",
        "What one evaluation gave; frame[\"biceps\"] is a mesh by the name of its body, frame[0] by place.")
        .def_readonly("number", &Frame::number)
        .def_property_readonly(
            "plug", [](const Frame& f) { return f.plug.text(); }, "what was evaluated")
        .def_readonly("names", &Frame::names, "of the meshes: the bodies' nodes")
        .def_property_readonly("meshes", &all_meshes)
        .def_property_readonly(
            "value",
            [](const Frame& f) -> py::object {
                if (f.value.is<nodes::Mesh>() || f.value.is<nodes::MeshList>()) return all_meshes(f);
                return to_python(f.value);
            },
            "A number, text or array; the meshes; None for what Python has no word for.")
        .def_property_readonly(
            "report", [](const Frame& f) { return py::module_::import("json").attr("loads")(f.report_json()); },
            "The solver's report of the frame; {} where no solver is involved.")
        .def("__getitem__", [](const Frame& f, const py::object& which) { return mesh_at(f, place_of(f, which)); })
        .def("__contains__", [](const Frame& f, const std::string& name) { return f.find(name).has_value(); })
        .def("__len__", [](const Frame& f) { return f.meshes.size(); })
        .def("__iter__", [](const Frame& f) { return py::iter(py::cast(f.names)); })
        .def("__repr__", [](const Frame& f) {
            return "<sinew.Frame of " + f.plug.text() + ", " + std::to_string(f.meshes.size()) + " meshes>";
        });
}

engine::Plug plug_of(const std::string& node, const std::string& attribute) { return {node, attribute}; }

/// Calls the session without the interpreter's lock.
template <class Call>
auto freely(PythonSession& s, Call&& call) {
    const PythonSession::Free free(s);
    return call();
}

/// Null for an object whose __init__ has not run.
PythonSession* made_session(PyObject* self) {
    const auto v = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder();
    return v.holder_constructed() ? v.value_ptr<PythonSession>() : nullptr;
}

/// Lets Python's garbage collector find sessions that are held by nothing but their own callbacks.
void take_part_in_collection(PyHeapTypeObject* heap_type) {
    PyTypeObject& type = heap_type->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) -> int {
        Py_VISIT(Py_TYPE(self));
        const PythonSession* s = made_session(self);
        return s ? s->traverse(visit, arg) : 0;
    };
    type.tp_clear = [](PyObject* self) -> int {
        if (PythonSession* s = made_session(self)) s->clear();
        return 0;
    };
    // It gives the lock up while it goes; no collection of another thread may find it then.
    type.tp_dealloc = [](PyObject* self) {
        PyObject_GC_UnTrack(self);
        py::detail::pybind11_object_dealloc(self);
    };
}

/// T.__new__(T) makes an object of nothing. pybind11 gives it memory that nobody has written when it is first used;
/// this refuses instead.
template <class T>
void refuse_unmade() {
    py::detail::get_type_info(typeid(T), true)->operator_new = [](std::size_t) -> void* {
        throw py::type_error("the object was made by __new__ alone; Sinew gives such objects, or their class does");
    };
}

using Inputs = std::vector<std::tuple<std::string, std::string, py::object>>;

std::vector<embed::Setting> settings_of(const Inputs& inputs) {
    std::vector<embed::Setting> out;
    for (const auto& [node, attribute, value] : inputs) out.push_back({plug_of(node, attribute), host_value(value)});
    return out;
}

std::unique_ptr<PythonSession> make_session(int threads, std::size_t memory, std::string cache,
                                            std::uintmax_t cache_size, std::string root, py::object on_event,
                                            py::object on_warning, const std::vector<py::object>& node_types) {
    embed::Options options;
    std::vector<Kept> kept;
    const auto ending = std::make_shared<Ending>();
    if (!node_types.empty()) {
        auto registry = std::make_shared<engine::Registry>();
        nodes::register_all(*registry);
        for (const py::object& type : node_types) kept.push_back(add_python_type(*registry, type, ending));
        options.registry = std::move(registry);
    }
    options.threads = threads;
    options.memory_bytes = memory;
    options.cache_folder = std::move(cache);
    if (cache_size > 0) options.cache_bytes = cache_size;
    options.root_folder = std::move(root);
    return std::make_unique<PythonSession>(std::move(options), std::move(on_event), std::move(on_warning),
                                           std::move(kept), ending);
}

/// What an input is now, set or by default: a value, or what a graph file would hold there.
py::object input_of(const engine::Graph& graph, const engine::Plug& plug) {
    const engine::Node* node = graph.find(plug.node);
    if (!node)
        throw embed::Misuse("DG102", "there is no node \"" + plug.node + "\"",
                            engine::name_hint(plug.node, graph.node_names(), "nodes"), plug);
    const engine::AttributeInfo* info = node->type ? node->type->find_input(plug.attribute) : nullptr;
    if (!info && node->type && node->type->find_output(plug.attribute))
        throw embed::Misuse("DG102", "it is an output, which has a value at a frame",
                            "ask evaluate(frame, \"" + plug.text() + "\")", plug);
    if (!info)
        throw embed::Misuse("DG102", "no such input on " + node->type_name,
                            node->type ? engine::input_hint(graph, *node->type, plug.attribute) : std::string(), plug);
    const auto bound = node->inputs.find(plug.attribute);
    if (bound == node->inputs.end() && info->kind != engine::AttributeKind::literal) return py::none();
    const engine::Binding binding =
        bound == node->inputs.end() ? engine::default_value(*info, graph.timing()) : bound->second;
    if (const auto* value = std::get_if<engine::Value>(&binding))
        if (py::object found = to_python(*value); !found.is_none()) return found;
    return py::module_::import("json").attr("loads")(engine::binding_json(*info, binding));
}

void add_sessions(py::module_& module) {
    py::class_<PythonSession>(module, "Core", "What sinew.Session stands on.",
                              py::custom_type_setup(&take_part_in_collection))
        .def(py::init(&make_session), py::arg("threads"), py::arg("memory"), py::arg("cache"), py::arg("cache_size"),
             py::arg("root"), py::arg("on_event"), py::arg("on_warning"), py::arg("node_types"))
        .def("load_file",
             [](PythonSession& s, const std::string& path) {
                 freely(s, [&] { s.session().load_file(path); });
                 s.throw_of_callback();
             })
        .def("load_text",
             [](PythonSession& s, const std::string& text, const std::string& name) {
                 freely(s, [&] { s.session().load_text(text, name); });
                 s.throw_of_callback();
             })
        .def("graph_text",
             [](PythonSession& s) { return freely(s, [&] { return write_graph(*s.session().graph()); }); })
        .def("timing",
             [](PythonSession& s) {
                 const auto t = freely(s, [&] { return s.session().graph()->timing(); });
                 return std::tuple(t.fps, t.start, t.end);
             })
        .def("nodes",
             [](PythonSession& s) {
                 const auto graph = freely(s, [&] { return s.session().graph(); });
                 std::vector<std::pair<std::string, std::string>> out;
                 for (const std::string& name : graph->node_names())
                     out.emplace_back(name, graph->find(name)->type_name);
                 return out;
             })
        .def("get",
             [](PythonSession& s, const std::string& node, const std::string& attribute) {
                 const auto graph = freely(s, [&] { return s.session().graph(); });
                 return input_of(*graph, plug_of(node, attribute));
             })
        .def("set_json",
             [](PythonSession& s, const std::string& node, const std::string& attribute, const std::string& json) {
                 freely(s, [&] { s.session().set_json(plug_of(node, attribute), json); });
             })
        .def("set",
             [](PythonSession& s, const Inputs& inputs) {
                 const auto settings = settings_of(inputs);
                 freely(s, [&] { s.session().set(settings); });
             })
        .def("set_at",
             [](PythonSession& s, double frame, const Inputs& inputs) {
                 const auto settings = settings_of(inputs);
                 freely(s, [&] { s.session().set_at(frame, settings); });
             })
        .def("set_mesh",
             [](PythonSession& s, const std::string& node, double frame, const py::object& given,
                const Ints& face_vertices, const Ints& face_sizes) {
                 const Doubles points = points_array(given);
                 const auto list = [](const auto& a) {
                     return std::span(a.data(), static_cast<std::size_t>(a.size()));
                 };
                 const embed::HostMesh mesh{list(points), list(face_sizes), list(face_vertices)};
                 freely(s, [&] { s.session().set_mesh(node, frame, mesh); });
             })
        .def("evaluate", &PythonSession::evaluate)
        .def("is_ready",
             [](PythonSession& s, double frame, const std::string& plug) {
                 return freely(s, [&] { return s.session().is_ready(frame, plug); });
             })
        .def("explain",
             [](PythonSession& s, double frame, const std::string& plug) {
                 return freely(s, [&] { return s.session().explain(frame, plug).because; });
             })
        .def("cancel", [](PythonSession& s) { freely(s, [&] { s.session().cancel(); }); })
        .def("counts",
             [](PythonSession& s) {
                 const embed::Counts c = s.session().counts();
                 return std::tuple(c.simulated, c.computed, c.reused);
             })
        .def("end", &PythonSession::end)
        .def("take_warnings", &PythonSession::take_warnings);
}

} // namespace

} // namespace sinew::python

PYBIND11_MODULE(_sinew, module) {
    using namespace sinew::python;
    module.doc() = "The compiled part of sinew.";
    module.attr("version") = SINEW_VERSION;
    py::register_exception_translator([](std::exception_ptr thrown) { translate(std::move(thrown)); });
    add_diagnostics(module);
    add_events(module);
    add_meshes(module);
    add_frames(module);
    add_sessions(module);
    refuse_unmade<sinew::engine::Diagnostic>();
    refuse_unmade<Event>();
    refuse_unmade<NamedMesh>();
    refuse_unmade<sinew::embed::Frame>();
    refuse_unmade<PythonSession>();
}
