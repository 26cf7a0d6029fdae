// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

#include "nodes/subtissues.h"
#include "solver/terms/field/field.h"

namespace sinew::nodes::field {

void read_direction(const Reads& in, const Input<Vec3>& input, double& x, double& y, double& z) {
    const Vec3& d = in[input];
    if (d == Vec3{})
        in.fail(input.name, "FE304", std::string(input.name) + " is zero, so the field has none",
                "Give it a length above 0; only where it points counts.");
    x = d[0], y = d[1], z = d[2];
}

solver::FieldValues read_common(const Reads& in, const Input<double>& magnitude, const Input<double>& attenuation,
                                solver::FieldRest& rest) {
    solver::FieldValues v;
    v.magnitude = in[magnitude];
    v.attenuation = in[attenuation];
    v.reference_distance = in[reference_distance];
    v.max_distance = in[max_distance];
    v.x = in[translate][0], v.y = in[translate][1], v.z = in[translate][2];
    rest.use_max_distance = in[use_max_distance];
    return v;
}

void publish(const Reads& in, Writes& out, const solver::FieldRest& rest, const solver::FieldValues& values) {
    Force f;
    f.type = &solver::field_type;
    const auto all = in[bodies];
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Body& body = all[i];
        if (body.is_bone())
            in.fail(bodies.name, "FE218", in.source_name(bodies.name, i) + " is a bone, which no field moves",
                    "Connect tissues, or none for all of the solver's.");
        refuse_subtissue(in, bodies.name, body, in.source_name(bodies.name, i));
        f.bodies.push_back(id_of(body));
    }
    f.on_all = f.bodies.empty();
    f.rest = std::make_shared<const solver::FieldRest>(rest);
    f.digest = Hasher()
                   .add(static_cast<int>(rest.kind))
                   .add(rest.use_max_distance)
                   .add(rest.component_only)
                   .add(rest.use_direction)
                   .add(rest.invert_attenuation)
                   .add(static_cast<int>(rest.volume))
                   .add(rest.noise_level)
                   .finish();
    f.values.resize(solver::FieldValues::fields().size());
    solver::put_fields(values, f.values);
    out.set(out_force, std::move(f));
}

NodeType node_type(std::string_view name, std::string_view doc, const Input<double>& magnitude,
                   const Input<double>& attenuation, std::initializer_list<AttributeInfo> own,
                   void (*compute)(const Reads&, Writes&)) {
    NodeType type;
    type.name = name;
    type.doc = doc;
    type.inputs = {describe(bodies), describe(magnitude)};
    type.inputs.insert(type.inputs.end(), own);
    type.inputs.insert(type.inputs.end(), {describe(translate), describe(attenuation), describe(reference_distance),
                                           describe(use_max_distance), describe(max_distance)});
    type.outputs = {describe(out_force)};
    type.compute = compute;
    return type;
}

} // namespace sinew::nodes::field
