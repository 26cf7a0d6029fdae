// Immutable, shared, digested values: what travels on wires and lies in the store.
// Nobody edits a value that another node may hold: a node that edits takes a copy.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

namespace sinew::engine {

using Vec3 = std::array<double, 3>;
/// Row-major 4x4, column vectors: p' = M p.
using Matrix4 = std::array<double, 16>;
using NumberList = std::vector<double>;

/// A file that a graph names. Enters keys by content, never by path.
struct File {
    std::string path; ///< absolute or resolved against the graph file
    Digest content;
};

/// What the engine must know of a type that travels on wires. Specialise for each such type:
///   static constexpr std::string_view name;              // for messages: "mesh", "body"
///   static void hash(Hasher&, const T&);                 // everything that a consumer can see
///   static std::size_t bytes(const T&);                  // memory held, for the store's budget
/// and where a value holds what `hash` leaves out (because simulations are keyed by it and do not read that):
///   static void hash_rest(Hasher&, const T&);            // all that is left out
/// and where simulations read a part of it only while a switch of theirs is on (WireList::aside_when), which `hash`
/// leaves out as well:
///   static void hash_aside(Hasher&, const T&);           // that part
template <class T>
struct ValueTraits;

class Value {
  public:
    Value() = default;
    template <class T>
    static Value of(T v);
    /// Throws std::logic_error naming both types if the value holds another type.
    template <class T>
    const T& as() const;
    template <class T>
    bool is() const {
        return box_ && box_->type == std::type_index(typeid(T));
    }
    explicit operator bool() const { return static_cast<bool>(box_); }
    /// Of an empty value: all zero.
    Digest digest() const { return box_ ? box_->digest : Digest{}; }
    /// Of everything that the value holds; differs from `digest` for types with a ValueTraits::hash_rest.
    Digest whole_digest() const { return box_ ? box_->whole : Digest{}; }
    /// Of the part that stands aside; all zero for types without a ValueTraits::hash_aside.
    Digest aside_digest() const { return box_ ? box_->aside : Digest{}; }
    std::size_t bytes() const { return box_ ? box_->bytes : 0; }
    std::type_index type() const { return box_ ? box_->type : std::type_index(typeid(void)); }
    std::string_view type_name() const { return box_ ? box_->type_name : std::string_view("nothing"); }

  private:
    struct Box {
        std::type_index type;
        std::string_view type_name;
        Digest digest, whole, aside;
        std::size_t bytes;
        explicit Box(std::type_index t)
            : type(t)
            , bytes(0) {}
        virtual ~Box() = default;
    };
    template <class T>
    struct Holder : Box {
        T v;
        explicit Holder(T x)
            : Box(std::type_index(typeid(T)))
            , v(std::move(x)) {
            type_name = ValueTraits<T>::name;
            Hasher h;
            h.add(type_name);
            ValueTraits<T>::hash(h, v);
            digest = whole = h.finish();
            if constexpr (requires { ValueTraits<T>::hash_aside(h, v); }) {
                Hasher part;
                part.add(type_name);
                ValueTraits<T>::hash_aside(part, v);
                aside = part.finish();
                whole = Hasher().add(digest).add(aside).finish();
            }
            if constexpr (requires { ValueTraits<T>::hash_rest(h, v); }) {
                Hasher all;
                all.add(whole);
                ValueTraits<T>::hash_rest(all, v);
                whole = all.finish();
            }
            bytes = sizeof(*this) + ValueTraits<T>::bytes(v);
        }
    };
    [[noreturn]] static void throw_mismatch(std::string_view wanted, std::string_view held);
    std::shared_ptr<const Box> box_;
};

template <class T>
Value Value::of(T v) {
    Value out;
    out.box_ = std::make_shared<const Holder<T>>(std::move(v));
    return out;
}

template <class T>
const T& Value::as() const {
    if (!is<T>()) throw_mismatch(ValueTraits<T>::name, type_name());
    return static_cast<const Holder<T>&>(*box_).v;
}

// ---- the types that a graph file can write as literals ----
#define SINEW_VALUE_TRAITS(T, NAME)                                                                                    \
    template <>                                                                                                        \
    struct ValueTraits<T> {                                                                                            \
        static constexpr std::string_view name = NAME;                                                                 \
        static void hash(Hasher& h, const T& v);                                                                       \
        static std::size_t bytes(const T& v);                                                                          \
    };
SINEW_VALUE_TRAITS(bool, "bool")
SINEW_VALUE_TRAITS(std::int64_t, "integer")
SINEW_VALUE_TRAITS(double, "number")
SINEW_VALUE_TRAITS(std::string, "text")
SINEW_VALUE_TRAITS(Vec3, "vector")
SINEW_VALUE_TRAITS(Matrix4, "matrix")
SINEW_VALUE_TRAITS(NumberList, "numbers")
SINEW_VALUE_TRAITS(File, "file")
#undef SINEW_VALUE_TRAITS

} // namespace sinew::engine
