// How values of one type become bytes and come back, for those that are kept on disk. The engine knows no meshes and no
// tets: who brings a value type brings its codec.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/byte_stream.h"
#include "engine/value.h"

#include <functional>
#include <typeindex>

namespace sinew::engine {

struct Codec {
    std::type_index type = std::type_index(typeid(void));
    std::string_view type_name;
    int version = 1; ///< raised when the bytes mean something else; what older versions wrote is then made anew
    std::function<void(const Value&, ByteWriter&)> write;
    /// Throws BadBytes. `like`: null, or a value of this type, of which what is equal may be shared instead of made.
    std::function<Value(ByteReader&, const Value* like)> read;
};

/// The codec of T. read(write(v)) must give the bits of v, and so its digest; the disk store checks that.
template <class T>
Codec make_codec(int version, void (*write)(const T&, ByteWriter&), T (*read)(ByteReader&)) {
    return {std::type_index(typeid(T)), ValueTraits<T>::name, version,
            [write](const Value& v, ByteWriter& out) { write(v.as<T>(), out); },
            [read](ByteReader& in, const Value*) { return Value::of<T>(read(in)); }};
}
/// \param read the same with another value, or null
template <class T>
Codec make_codec(int version, void (*write)(const T&, ByteWriter&), T (*read)(ByteReader&, const T* like)) {
    return {
        std::type_index(typeid(T)), ValueTraits<T>::name, version,
        [write](const Value& v, ByteWriter& out) { write(v.as<T>(), out); },
        [read](ByteReader& in, const Value* like) { return Value::of<T>(read(in, like ? &like->as<T>() : nullptr)); }};
}

} // namespace sinew::engine
