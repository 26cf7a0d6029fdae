// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/node_type.h"

#include <stdexcept>

namespace sinew::engine {

const Value& Reads::keep(Value v) const {
    kept_.push_back(std::make_unique<Value>(std::move(v)));
    return *kept_.back();
}

void Reads::warn(std::string_view attribute, std::string_view code, std::string message, std::string hint) const {
    Diagnostic d;
    d.severity = Severity::warning;
    d.code = code;
    d.attribute = attribute;
    d.message = std::move(message);
    d.hint = std::move(hint);
    source_->report(std::move(d));
}

void Reads::fail(std::string_view attribute, std::string_view code, std::string message, std::string hint) const {
    Diagnostic d;
    d.code = code;
    d.attribute = attribute;
    d.message = std::move(message);
    d.hint = std::move(hint);
    source_->fail(std::move(d));
    throw std::logic_error("a ReadSource returned from fail()");
}

void Writes::put(std::string_view output, Value v) {
    for (auto& [name, value] : values_)
        if (name == output) throw std::logic_error("output \"" + std::string(output) + "\" was written twice");
    values_.emplace_back(output, std::move(v));
}

namespace {
const AttributeInfo* find_attribute(const std::vector<AttributeInfo>& all, std::string_view name) {
    for (const AttributeInfo& a : all)
        if (a.name == name) return &a;
    return nullptr;
}
} // namespace

const AttributeInfo* NodeType::find_input(std::string_view attribute) const {
    return find_attribute(inputs, attribute);
}
const AttributeInfo* NodeType::find_output(std::string_view attribute) const {
    return find_attribute(outputs, attribute);
}

} // namespace sinew::engine
