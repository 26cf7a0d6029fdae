// What those who doubt read a graph by, and where they say it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/curve.h"
#include "engine/evaluator.h"
#include "nodes/values.h"
#include "tools/doubts/doubts.h"

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace sinew::doubts {

class Doubting {
  public:
    /// \param frame the first that the graph simulates, at which values are read
    Doubting(std::shared_ptr<const engine::Graph> graph, engine::Evaluator& evaluator, Look look, double frame,
             std::stop_token stop, std::shared_ptr<engine::Failures> failures);

    const engine::Graph& graph() const { return *graph_; }
    Look look() const { return look_; }

    /// A warning at the attribute's place in the file.
    void doubt(std::string_view code, const std::string& node, std::string_view attribute, std::string message,
               std::string hint);
    /// Of a body, or of what it is made from.
    bool has_said(std::string_view code, const std::string& body) const;
    /// Whether it is the first time that this is asked of a node: what several read is told once.
    bool once(std::string_view what, const std::string& node);
    /// All that was said.
    std::vector<engine::Diagnostic> take() { return std::move(out_); }

    /// Empty where it cannot be had.
    template <class T>
    std::optional<T> value(const engine::Plug& plug) {
        return value<T>(plug, frame_);
    }
    template <class T>
    std::optional<T> value(const engine::Plug& plug, double frame) {
        try {
            const engine::Value v = evaluator_.pull({graph_, plug, frame, stop_, failures_});
            if (v.is<T>()) return v.as<T>();
        } catch (const engine::Failure&) {
        }
        return {};
    }

    /// What it is at all frames of the timing (of a single one: at all times): a literal, the value that keys give
    /// there throughout, or the default if nothing stands there. Empty if keys change it, if it is connected, or if
    /// there is no such input.
    std::optional<engine::Value> literal(const std::string& node, std::string_view attribute) const;
    template <class T>
    std::optional<T> number(const std::string& node, std::string_view attribute) const {
        if (const auto v = literal(node, attribute); v && v->is<T>()) return v->as<T>();
        return {};
    }

    /// Null where it is not keyed.
    const engine::Curve* keys(const std::string& node, std::string_view attribute) const {
        const auto& inputs = graph_->find(node)->inputs;
        const auto it = inputs.find(attribute);
        return it == inputs.end() ? nullptr : std::get_if<engine::Curve>(&it->second);
    }

    /// The same of vectors and matrices, with the value that keys give at the start.
    template <class T>
    std::optional<T> at_start(const std::string& node, std::string_view attribute) const {
        const engine::Curve* curve = keys(node, attribute);
        if (!curve) return number<T>(node, attribute);
        if constexpr (std::is_same_v<T, engine::Matrix4>) return curve->matrix_at(frame_);
        const std::vector<double> numbers = curve->at(frame_);
        T out{};
        if (numbers.size() != out.size()) return {};
        std::copy(numbers.begin(), numbers.end(), out.begin());
        return out;
    }

    /// The connections at an input, in order.
    std::vector<engine::Plug> plugs(const std::string& node, std::string_view attribute) const;
    /// The file that a body's mesh comes from, in small letters; empty: from none.
    std::string file_of(const std::string& body) const;

  private:
    std::shared_ptr<const engine::Graph> graph_;
    engine::Evaluator& evaluator_;
    Look look_;
    double frame_;
    std::stop_token stop_;
    std::shared_ptr<engine::Failures> failures_;
    std::vector<engine::Diagnostic> out_;
    std::set<std::pair<std::string, std::string>> asked_;
};

/// A number, at each of its keys where it is keyed; none where it is connected.
std::vector<double> all_values(const Doubting& d, const std::string& node, std::string_view attribute);
/// "1.2", two digits of it.
std::string rough(double value, int digits = 2);
/// Longest side of the box around the points.
double extent(const solver::Points& points);
inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

} // namespace sinew::doubts
