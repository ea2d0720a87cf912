// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "toolkit/surface/gltf_compression.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

enum class Component { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

std::size_t bytes_of(Component type)
{
    return type == Component::int8 || type == Component::uint8     ? 1
           : type == Component::int16 || type == Component::uint16 ? 2
                                                                   : 4;
}

// What 1 is stored as; 0 for types that are not normalised.
double one_of(Component type)
{
    switch (type) {
    case Component::int8:
        return 127;
    case Component::uint8:
        return 255;
    case Component::int16:
        return 32767;
    case Component::uint16:
        return 65535;
    default:
        return 0;
    }
}

Component component_of(const GltfValue& holder)
{
    const GltfValue value = holder["componentType"];
    const std::size_t type = value.index();
    if (type < 5120 || type > 5126 || type == 5124)
        value.fail("is " + std::to_string(type) + ", which is no component type of glTF 2.0");
    return static_cast<Component>(type);
}

std::size_t components_of(const GltfValue& accessor)
{
    const std::string& type = accessor["type"].text();
    for (const auto& [name, count] :
         {std::pair("SCALAR", 1), {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}})
        if (type == name)
            return static_cast<std::size_t>(count);
    accessor.fail("has the unknown type '" + printable(type) + "'");
}

template <class T> double load(const char* at)
{
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

double component(const char* at, Component type)
{
    switch (type) {
    case Component::int8:
        return load<std::int8_t>(at);
    case Component::uint8:
        return load<std::uint8_t>(at);
    case Component::int16:
        return load<std::int16_t>(at);
    case Component::uint16:
        return load<std::uint16_t>(at);
    case Component::uint32:
        return load<std::uint32_t>(at);
    case Component::float32:
        return load<float>(at);
    }
    return 0;
}

class AccessorReader {
public:
    AccessorReader(GltfDocument& document, std::size_t index, Missing& missing)
        : document_(document), missing_(missing), accessor_(document.at("accessors", index))
    {
    }

    std::vector<double> read(std::size_t components)
    {
        note_extensions(accessor_, missing_);
        if (const std::size_t found = components_of(accessor_); found != components)
            accessor_.fail("has " + std::to_string(found) + " components, expected " + std::to_string(components));
        const std::size_t count = accessor_["count"].index();
        const auto view = accessor_.index_of("bufferView");
        const DecodedView unpacked = view ? decoded_view(document_, *view) : DecodedView{};
        if (count > std::max<std::uintmax_t>(document_.bytes(), unpacked.bytes ? unpacked.bytes->size() : 0))
            accessor_.fail("declares " + std::to_string(count) + " elements, more than the file's buffers have bytes");
        std::vector<double> out(count * components, 0.0); // what a file gives no data for is zero
        const Component type = component_of(accessor_);
        if (view)
            copy(*view, accessor_.index_or("byteOffset", 0), type, normalized(), components, true, out);
        if (const auto sparse = accessor_.find("sparse"))
            substitute(*sparse, type, components, out);
        return out;
    }

private:
    bool normalized() const { return accessor_.truth_or("normalized", false); }

    void substitute(const GltfValue& sparse, Component type, std::size_t components, std::vector<double>& out)
    {
        const GltfValue indices = sparse["indices"], values = sparse["values"];
        for (const GltfValue& part : {sparse, indices, values})
            note_extensions(part, missing_);
        const std::size_t count = sparse["count"].index(), all = out.size() / components;
        if (count > all)
            accessor_.fail("has a sparse part of " + std::to_string(count) + " elements, more than the " +
                           std::to_string(all) + " it has");
        std::vector<double> at(count), value(count * components);
        copy(indices["bufferView"].index(), indices.index_or("byteOffset", 0), component_of(indices), false, 1, false,
             at);
        copy(values["bufferView"].index(), values.index_or("byteOffset", 0), type, normalized(), components, false,
             value);
        for (std::size_t i = 0; i < count; ++i) {
            if (!(at[i] >= 0 && at[i] < static_cast<double>(all)))
                accessor_.fail("has a sparse index out of range");
            std::copy_n(value.begin() + static_cast<std::ptrdiff_t>(i * components), components,
                        out.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(at[i]) * components));
        }
    }

    // out.size() / components elements from a buffer view.
    void copy(std::size_t view_index, std::size_t offset, Component type, bool normalized, std::size_t components,
              bool strided, std::vector<double>& out)
    {
        const GltfValue view = document_.at("bufferViews", view_index);
        note_compressed(document_, view, missing_);
        const std::size_t buffer = view["buffer"].index();
        note_compressed(document_, document_.at("buffers", buffer), missing_);
        const DecodedView unpacked = decoded_view(document_, view_index);
        const std::string& data = unpacked.bytes ? *unpacked.bytes : document_.buffer(buffer);
        const std::size_t begin = unpacked.bytes ? 0 : view.index_or("byteOffset", 0),
                          length = unpacked.bytes ? data.size() : view["byteLength"].index();
        const std::size_t size = bytes_of(type), element = size * components, count = out.size() / components;
        const std::size_t declared = unpacked.bytes ? unpacked.stride : view.index_or("byteStride", 0),
                          stride = strided && declared > 0 ? declared : element;
        if (begin > data.size() || length > data.size() - begin)
            accessor_.fail("lies in " + view.place() + ", which reaches past its buffer");
        if (count > 0 &&
            (offset > length || element > length - offset || (count - 1) > (length - offset - element) / stride))
            accessor_.fail("reaches past " + view.place());
        const double one = normalized ? one_of(type) : 0;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < components; ++c) {
                const double x = component(data.data() + begin + offset + i * stride + c * size, type);
                if (!std::isfinite(x))
                    accessor_.fail("holds a number that is not finite");
                out[i * components + c] = one > 0 ? std::max(x / one, -1.0) : x;
            }
    }

    GltfDocument& document_;
    Missing& missing_;
    GltfValue accessor_;
};

} // namespace

std::vector<double> read_accessor(GltfDocument& document, std::size_t index, std::size_t components, Missing& missing)
{
    return AccessorReader(document, index, missing).read(components);
}

double step_of_accessor(const GltfDocument& document, std::size_t index)
{
    const GltfValue accessor = document.at("accessors", index);
    const double one = accessor.truth_or("normalized", false) ? one_of(component_of(accessor)) : 0;
    return one > 0 ? 1 / one : 0;
}

} // namespace cinch
