// Values that are given and do nothing, since another attribute of the same node, or what is connected, says so.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/options.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace sinew::doubts {

namespace {

/// An attribute, and what of the node switches it off, whatever it is.
struct Idle {
    std::string_view type, attribute, by;
    engine::Value off; ///< of `by`, all the time …
    bool unless;       ///< … or anything else
    std::string cure;
};

const std::vector<Idle>& all() {
    const auto flag = [](bool on) { return engine::Value::of<bool>(on); };
    const auto text = [](const char* word) { return engine::Value::of<std::string>(word); };
    const engine::Value file = engine::Value::of<engine::File>({});
    static const std::vector<Idle> out = [&] {
        std::vector<Idle> idle{
            {"zFiber", "muscleGrowthScale", "enableMuscleGrowth", flag(false), false, "set enableMuscleGrowth to true"},
            {"zFiber", "useLoaForMuscleGrowth", "enableMuscleGrowth", flag(false), false,
             "set enableMuscleGrowth to true"},
            {"zFiber", "excitation", "strength", engine::Value::of<double>(0), false,
             "give it a strength: muscles have 100 to 300 kPa"},
            {"zTissue", "transverseAnisotropy", "material", text("Anisotropic"), true, "set material to Anisotropic"},
            {"zTissue", "compressionResistance", "material", text("Corotational"), false,
             "set material to StVK or NeoHookean"},
            {"zTissue", "compressionResistance", "material", text("LogNeoHookean"), false,
             "set material to StVK or NeoHookean"},
            {"zTissue", "compressionResistance", "material", text("Anisotropic"), false,
             "set material to StVK or NeoHookean"},
            {"zTissue", "contactFriction", "contactSliding", flag(false), false, "set contactSliding to true"},
            {"zBone", "contactFriction", "contactSliding", flag(false), false, "set contactSliding to true"},
            {"zCloth", "contactFriction", "contactSliding", flag(false), false, "set contactSliding to true"},
            {"transform", "trackName", "track", file, false, "name the motion file in track"},
            {"transform", "trackOffset", "track", file, false, "name the motion file in track"},
            {"transform", "trackRate", "track", file, false, "name the motion file in track"},
            {"zSolver", "massDamping", "integrator", text("QuasiStatic"), false, "choose another integrator"},
            {"zSolver", "stiffnessDamping", "integrator", text("QuasiStatic"), false, "choose another integrator"},
            {"zSolver", "contactDamping", "integrator", text("QuasiStatic"), false, "choose another integrator"},
        };
        // Each rule of a node weights has attributes of its own.
        for (const auto& [rule, attributes] : std::initializer_list<std::pair<const char*, std::vector<const char*>>>{
                 {"constant", {"value"}},
                 {"list", {"values"}},
                 {"ramp", {"axis", "start", "end", "smooth"}},
                 {"near", {"otherMesh", "innerDistance", "outerDistance"}},
                 {"sphere", {"center", "radius", "falloff"}},
                 {"file", {"file", "key"}},
                 {"vertices", {"vertices"}},
                 {"faces", {"faces"}}})
            for (const char* attribute : attributes)
                idle.push_back({"weights", attribute, "mode", text(rule), true, std::string("set mode to ") + rule});
        return idle;
    }();
    return out;
}

/// Whether it stands in the node with another value than the default.
bool is_given(const Doubting& d, const std::string& name, std::string_view attribute) {
    const engine::Node& node = *d.graph().find(name);
    if (!node.inputs.contains(attribute)) return false;
    const auto value = d.literal(name, attribute);
    return !value ||
           value->digest() != engine::default_value(*node.type->find_input(attribute), d.graph().timing()).digest();
}

} // namespace

void doubt_idle_values(Doubting& d, const std::string& name) {
    for (const engine::AttributeInfo& info : d.graph().find(name)->type->inputs)
        if (!info.when.empty() && is_given(d, name, info.name) && d.number<bool>(name, info.when) == false)
            d.doubt("FE342", name, info.name, "does nothing while " + std::string(info.when) + " is off",
                    "set " + std::string(info.when) + " to true, or take " + std::string(info.name) + " out");
    for (const Idle& idle : all()) {
        if (d.graph().find(name)->type->name != idle.type || !is_given(d, name, idle.attribute)) continue;
        const auto value = d.literal(name, idle.by);
        if (!value || (value->digest() == idle.off.digest()) == idle.unless) continue;
        std::string what = std::string(idle.by);
        if (const auto* on = value->is<bool>() ? &value->as<bool>() : nullptr)
            what += *on ? " is on" : " is off";
        else if (value->is<std::string>())
            what += " is " + value->as<std::string>();
        else if (value->is<engine::File>())
            what += " names no file";
        else
            what += " is 0";
        d.doubt("FE342", name, idle.attribute, "does nothing while " + what,
                idle.cure + ", or take " + std::string(idle.attribute) + " out");
    }
}

namespace {

/// What bodies or attachments are read for by solvers that something of them does not switch off.
struct ReadBySolvers {
    std::vector<std::pair<std::string_view, std::string_view>> attributes; ///< with the list of zSolver they come by
    bool (*is_off)(const Doubting&, const std::string& solver);
    std::string_view before, after, cure; ///< in words, the solver's name between the two
};

bool is_quasi_static(const Doubting& d, const std::string& solver) {
    const auto integrator = d.literal(solver, "integrator");
    return integrator && integrator->as<std::string>() == nodes::word_of(solver::Integrator::quasi_static);
}

bool has_no_contact(const Doubting& d, const std::string& solver) {
    return d.number<bool>(solver, "collisionDetection") == false;
}

void doubt_read_by_solvers(Doubting& d, const ReadBySolvers& what) {
    struct Reader {
        std::string solver;
        bool reads = false; ///< one of the solvers does
    };
    std::map<std::pair<std::string, std::string_view>, Reader> readers; ///< by node and attribute
    for (const std::string& solver : d.graph().node_names()) {
        const engine::Node* node = d.graph().find(solver);
        if (!node->type || node->type->name != "zSolver") continue;
        const bool is_off = what.is_off(d, solver);
        for (const auto& [list, attribute] : what.attributes)
            for (const engine::Plug& plug : d.plugs(solver, list)) {
                Reader& reader = readers[{plug.node, attribute}];
                reader.solver = solver;
                reader.reads = reader.reads || !is_off;
            }
    }
    for (const auto& [plug, reader] : readers) {
        const auto& [name, attribute] = plug;
        const engine::Node* node = d.graph().find(name);
        if (reader.reads || !node || !node->type || !node->type->find_input(attribute)) continue;
        if (!is_given(d, name, attribute)) continue;
        d.doubt("FE342", name, attribute,
                "does nothing while " + std::string(what.before) + reader.solver + std::string(what.after),
                std::string(what.cure) + ", or take " + std::string(attribute) + " out");
    }
}

} // namespace

void doubt_idle_damping(Doubting& d) {
    doubt_read_by_solvers(d, {{{"bodies", "inertialDamping"}, {"attachments", "damping"}},
                              is_quasi_static,
                              "the integrator of ",
                              " is QuasiStatic, which knows no velocities",
                              "choose another integrator"});
}

void doubt_idle_contact(Doubting& d) {
    doubt_read_by_solvers(d, {{{"bodies", "selfCollisions"},
                               {"bodies", "contactSliding"},
                               {"bodies", "contactStiffness"},
                               {"bodies", "contactFriction"},
                               {"bodies", "collisionSets"}},
                              has_no_contact,
                              "collisionDetection of ",
                              " is off",
                              "set collisionDetection to true"});
}

void doubt_idle_parts(Doubting& d) {
    std::vector<std::string> simulated;
    for (const std::string& name : d.graph().node_names()) {
        const engine::Node* node = d.graph().find(name);
        if (!node->type || node->type->name != "zSolver") continue;
        for (const engine::Plug& plug : d.plugs(name, "bodies")) simulated.push_back(plug.node);
    }
    for (const std::string& part : d.graph().node_names()) {
        const engine::Node* node = d.graph().find(part);
        if (!node->type || node->type->name != "zSubtissue") continue;
        if (std::find(simulated.begin(), simulated.end(), part) != simulated.end()) continue;
        for (const engine::Plug& material : d.plugs(part, "materials"))
            for (const std::string_view attribute : {"pressure", "surfaceTension"})
                if (is_given(d, material.node, attribute))
                    d.doubt("FE342", material.node, attribute,
                            "does nothing on the mesh of " + part + ", which is not among the solver's bodies",
                            "connect " + part + ".outBody to zSolver.bodies beside its tissue");
    }
}

} // namespace sinew::doubts
