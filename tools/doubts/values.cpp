// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

namespace sinew::doubts {

namespace {

/// Softer than brain by far [Pa]; what people write who mean kPa.
constexpr double least_modulus = 100;
/// The densest bone has 2e10 and a little more [Pa].
constexpr double largest_modulus = 3e10;
/// [m/s^2]: the sun has 274.
constexpr double largest_gravity = 300;
/// Lungs have 250, the heaviest metals 23,000 [kg/m^3].
constexpr double least_density = 50, largest_density = 25000;
/// Of a length: what grows or shrinks by more is no growth.
constexpr double largest_growth = 10;
/// What is meant for the earth's gravity [m/s^2].
constexpr double earthly_from = 5, earthly_to = 15;
/// Heavier than a lead apron [kg/m^2].
constexpr double heaviest_sheet = 20;
/// Of the weight of a cloth: a hurricane pushes a light one so.
constexpr double strongest_push = 200, g = 9.8; // [m/s^2]
/// A hundredth of what muscles have [Pa].
constexpr double least_strength = 1000;

/// The largest that a number is at any of its keys, without its sign; 0 where it is connected.
double largest_ever(const Doubting& d, const std::string& node, std::string_view attribute) {
    double out = 0;
    for (const double v : all_values(d, node, attribute)) out = std::max(out, std::abs(v));
    return out;
}

/// The first of all values that is such; nothing if none is.
std::optional<double> any_value(const Doubting& d, const std::string& node, std::string_view attribute,
                                const std::function<bool(double)>& is_such) {
    const std::vector<double> all = all_values(d, node, attribute);
    const auto first = std::ranges::find_if(all, is_such);
    return first == all.end() ? std::nullopt : std::optional(*first);
}

/// Whether a field is a force per volume that is as strong wherever its bodies are.
bool reaches_everywhere(const Doubting& d, const std::string& field) {
    const engine::AttributeInfo* info = d.graph().find(field)->type->find_input("magnitude");
    return info && info->unit == "N/m^3" && d.graph().find(field)->type->name != "volumeAxisField" &&
           d.number<bool>(field, "useMaxDistance") == false && d.number<double>(field, "attenuation") == 0.0;
}

/// The stiffness of a layer that is such, at any of its keys, and that no preset has.
std::optional<double> odd_modulus(Doubting& d, const std::string& name, const std::function<bool(double)>& is_odd) {
    const auto is_such = [&](double modulus) {
        const auto presets = d.graph().find(name)->type->find_input("youngsModulus")->presets;
        const bool is_named = std::ranges::any_of(presets, [&](const auto& p) { return p.value == modulus; });
        return is_odd(modulus) && !is_named;
    };
    if (const auto modulus = any_value(d, name, "youngsModulus", is_such)) return modulus;
    if (const auto material = d.value<nodes::Material>({name, "outMaterial"}))
        if (is_such(material->values.youngs_modulus)) return material->values.youngs_modulus;
    return {};
}

void stiffness_of_material(Doubting& d, const std::string& name) {
    if (const auto soft = odd_modulus(d, name, [](double v) { return v < least_modulus; }))
        d.doubt("FE263", name, "youngsModulus",
                engine::number_text(*soft) + " Pa is softer than any flesh; brain has 500 Pa, a muscle 12 kPa",
                "if kilopascals are meant, write \"" + engine::number_text(*soft) + " kPa\"");
    if (const auto stiff = odd_modulus(d, name, [](double v) { return v > largest_modulus; }))
        d.doubt("FE263", name, "youngsModulus",
                engine::number_text(*stiff) +
                    " Pa is stiffer than any tissue; bone has 14 GPa, a tendon 1 GPa, a muscle 12 kPa",
                "youngsModulus is in pascals: a muscle has 12000; what hardly gives at all is better a zBone");
}

void weight_of_material(Doubting& d, const std::string& name) {
    const auto density =
        any_value(d, name, "massDensity", [](double v) { return v > 0 && (v < least_density || v > largest_density); });
    if (!density) return;
    if (*density < least_density)
        d.doubt("FE323", name, "massDensity",
                engine::number_text(*density) + " kg/m^3 is lighter than any flesh; water has 1000, a lung 250",
                "if grams a cubic centimetre are meant, write \"" + engine::number_text(*density) + " g/cm^3\"");
    else
        d.doubt("FE323", name, "massDensity",
                rough(*density, 4) + " kg/m^3 is heavier than any metal; water has 1000, flesh 1060",
                "massDensity is in kg/m^3, whatever the scene's scale: 1060");
}

void rest_scale_of_material(Doubting& d, const std::string& name) {
    const auto scale = d.number<double>(name, "restScale");
    if (!scale || (*scale <= largest_growth && *scale >= 1 / largest_growth)) return;
    d.doubt("FE344", name, "restScale",
            engine::number_text(*scale) + " makes it rest at " + rough(*scale) + " times its length",
            "it is a factor of lengths: 0.8 is a fifth shorter; for a scene in other units there is zSolver.scale");
}

/// What of a layer a tissue and a cloth do not read.
constexpr std::array<std::string_view, 4> of_tissues{"youngsModulus", "poissonsRatio", "massDensity",
                                                     "volumeConservation"};
constexpr std::array<std::string_view, 4> of_cloths{"tensileStiffness", "shearStiffness", "bendStiffness",
                                                    "clothMassDensity"};

} // namespace

void doubt_material(Doubting& d, const std::string& name) {
    stiffness_of_material(d, name);
    weight_of_material(d, name);
    rest_scale_of_material(d, name);
}

void doubt_unread_values(Doubting& d) {
    struct Readers {
        bool tissue = false, cloth = false;
        std::string first;
    };
    std::map<std::string, Readers> materials;
    for (const std::string& body : d.graph().node_names()) {
        const engine::Node* node = d.graph().find(body);
        if (!node->type || !node->type->find_input("materials")) continue;
        for (const engine::Plug& plug : d.plugs(body, "materials")) {
            Readers& r = materials[plug.node];
            (node->type->name == "zCloth" ? r.cloth : r.tissue) = true;
            if (r.first.empty()) r.first = body;
        }
    }
    for (const auto& [name, readers] : materials) {
        if (readers.tissue == readers.cloth || engine::is_included(name)) continue; // a library's may serve others
        const std::string body = readers.cloth ? "cloth" : "tissue";
        std::string read;
        for (const std::string_view a : readers.cloth ? of_cloths : of_tissues)
            read += (read.empty() ? "" : ", ") + std::string(a);
        for (const std::string_view attribute : readers.cloth ? of_tissues : of_cloths)
            if (d.graph().find(name)->inputs.contains(attribute))
                d.doubt("FE327", name, attribute,
                        "only " + body + " is made of it (" + readers.first + "), which does not read " +
                            std::string(attribute),
                        "a " + body + " goes by " + read);
    }
}

void doubt_fiber(Doubting& d, const std::string& name) {
    // 0: a direction and no pull
    const auto strength = any_value(d, name, "strength", [](double v) { return v > 0 && v < least_strength; });
    if (!strength) return;
    d.doubt("FE324", name, "strength", engine::number_text(*strength) + " Pa hardly pulls; muscles have 100 to 300 kPa",
            "if kilopascals are meant, write \"" + engine::number_text(*strength) + " kPa\"");
}

void doubt_passive_muscles(Doubting& d, const std::vector<std::string>& nodes) {
    std::vector<std::string> fibers; // that are read
    for (const std::string& body : nodes) {
        const engine::Node* node = d.graph().find(body);
        if (!node || !node->type || !node->type->find_input("fibers")) continue;
        for (const engine::Plug& plug : d.plugs(body, "fibers"))
            if (d.graph().find(plug.node)->type_name == "zFiber" && d.once("fiber", plug.node))
                fibers.push_back(plug.node);
    }
    for (const std::string& name : fibers) {
        const bool pulls = d.number<double>(name, "excitation") != 0.0 || !d.plugs(name, "lineOfAction").empty(),
                   grows = d.number<bool>(name, "enableMuscleGrowth").value_or(true),
                   directs = d.number<double>(name, "strength") == 0.0;
        if (pulls || grows || directs) return;
    }
    // Fibres may be there for the direction of an anisotropic flesh.
    for (const std::string& name : nodes)
        if (const engine::Node* node = d.graph().find(name); node && node->type && node->type->name == "zTissue" &&
                                                             d.number<double>(name, "transverseAnisotropy") != 1.0)
            return;
    if (!fibers.empty())
        d.doubt("FE329", fibers.front(), "excitation",
                fibers.size() == 1 ? "its muscle never pulls: it has no excitation and no line of action"
                                   : "no muscle of the scene ever pulls: none of its " + std::to_string(fibers.size()) +
                                         " zFibers has an excitation or a line of action",
                "key excitation from 0 to 1, or connect a zLineOfAction; \"strength\": 0 says that fibres are a "
                "direction alone");
}

namespace {

/// What all that has mass falls with at the start [m/s^2], and the input that gave it its direction.
struct Falling {
    engine::Vec3 gravity{};
    std::string node, attribute;
    bool is_sum = false;
};

std::optional<Falling> falling(const Doubting& d, const std::string& solver) {
    const auto gravity = d.at_start<engine::Vec3>(solver, "gravity");
    if (!gravity) return {};
    Falling out{.gravity = *gravity, .node = solver, .attribute = "gravity"};
    for (const engine::Plug& plug : d.plugs(solver, "forces")) {
        if (d.graph().find(plug.node)->type_name != "gravityField") continue;
        const auto magnitude = d.number<double>(plug.node, "magnitude");
        const auto direction = d.at_start<engine::Vec3>(plug.node, "direction");
        if (!magnitude || !direction) return {};
        const double length = std::hypot((*direction)[0], (*direction)[1], (*direction)[2]);
        for (std::size_t i = 0; i < 3 && length > 0; ++i) out.gravity[i] += *magnitude * (*direction)[i] / length;
        out.is_sum = *gravity != engine::Vec3{} || out.node != solver;
        out.node = plug.node, out.attribute = *magnitude < 0 ? "magnitude" : "direction";
    }
    return out;
}

void gravity_upwards(Doubting& d, const Falling& f) {
    const engine::Vec3& g = f.gravity;
    const double size = std::hypot(g[0], g[1], g[2]);
    const bool along_y = g[1] == size, along_z = g[2] == size;
    if (size < earthly_from || size > earthly_to || !(along_y || along_z)) return;
    const std::string up = along_y ? "y" : "z";
    d.doubt("FE322", f.node, f.attribute,
            (f.is_sum ? "with it the sum of gravity points along +" : "points along +") + up + ": where " + up +
                " is up, whatever is free goes up",
            "what falls along " + up + " has " + (along_y ? "[0, -9.8, 0]" : "[0, 0, -9.8]"));
}

} // namespace

void doubt_gravity(Doubting& d, const std::string& solver) {
    if (const auto all = falling(d, solver)) gravity_upwards(d, *all);
    std::vector<engine::Vec3> all;
    if (const engine::Curve* curve = d.keys(solver, "gravity"))
        for (const engine::Key& key : curve->keys) all.push_back({key.value[0], key.value[1], key.value[2]});
    else if (const auto gravity = d.number<engine::Vec3>(solver, "gravity"))
        all.push_back(*gravity);
    const auto size_of = [](const engine::Vec3& v) { return std::hypot(v[0], v[1], v[2]); };
    const auto found = std::ranges::find_if(all, [&](const auto& v) { return size_of(v) > largest_gravity; });
    if (found == all.end()) return;
    const engine::Vec3& g = *found;
    const double size = size_of(g);
    std::string cure;
    for (const double part : g) cure += (cure.empty() ? "[" : ", ") + engine::number_text(part / size * 9.8 + 0.0);
    d.doubt("FE322", solver, "gravity", rough(size) + " m/s^2 is " + rough(size / 9.8) + " times the earth's",
            "gravity is in m/s^2, whatever the scene's scale: " + cure + "]");
}

void doubt_weight_of_cloth(Doubting& d, const std::string& cloth) {
    for (const engine::Plug& layer : d.plugs(cloth, "materials")) {
        if (d.graph().find(layer.node)->type_name != "zMaterial") continue;
        const auto density = any_value(d, layer.node, "clothMassDensity", [](double v) { return v > heaviest_sheet; });
        if (density && d.once("FE336", layer.node))
            d.doubt("FE336", layer.node, "clothMassDensity",
                    engine::number_text(*density) + " kg/m^2 is heavier than any cloth; cotton has 0.2",
                    "it is mass by area: a sheet of skin 2 mm thick has 2.2");
    }
}

void doubt_fields_on_cloth(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    std::vector<nodes::BodyId> ids;
    for (const Member& m : members) ids.push_back(id_of(m.body));
    for (const engine::Plug& plug : d.plugs(solver, "forces")) {
        const auto force = d.value<nodes::Force>(plug);
        if (!force || !reaches_everywhere(d, plug.node)) continue;
        const double magnitude = largest_ever(d, plug.node, "magnitude");
        for (std::size_t i = 0; i < members.size(); ++i) {
            const std::string& cloth = members[i].name;
            const bool acts = force->on_all || std::ranges::any_of(force->bodies, [&](const nodes::BodyId& id) {
                                  return find_body(ids, id) == static_cast<int>(i);
                              });
            if (!members[i].body.is_cloth() || !acts) continue;
            double density = 0; // of the heaviest layer
            for (const engine::Plug& layer : d.plugs(cloth, "materials"))
                density = std::max(density, largest_ever(d, layer.node, "clothMassDensity"));
            const double weight = g * density;
            if (weight == 0 || magnitude < strongest_push * weight) continue;
            d.doubt("FE338", plug.node, "magnitude",
                    engine::number_text(magnitude) + " pushes " + cloth + " by " +
                        engine::rough_text(magnitude / weight, 2) +
                        " times its weight: on a cloth it is a force per area [N/m^2]",
                    std::string(force->on_all ? "list in its bodies what it is meant for, and give " + cloth
                                              : "give " + cloth) +
                        " a field of its own: " + engine::rough_text(weight, 2) + " is its weight");
            break; // once a field
        }
    }
}

} // namespace sinew::doubts
