// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "toolkit/surface/input_error.hpp"

namespace cinch {
namespace {

class AccessorReader {
public:
    AccessorReader(const tinygltf::Model& model, int index, const std::string& file)
        : model_(model), file_(file), name_("accessor " + std::to_string(index))
    {
        if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
            fail("does not exist");
        accessor_ = &model.accessors[static_cast<std::size_t>(index)];
    }

    std::vector<double> read(std::size_t components)
    {
        const int count = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor_->type));
        if (count <= 0 || static_cast<std::size_t>(count) != components)
            fail("has " + std::to_string(count) + " components, expected " + std::to_string(components));
        std::size_t total_bytes = 0;
        for (const auto& buffer : model_.buffers)
            total_bytes += buffer.data.size();
        if (accessor_->count > total_bytes)
            fail("declares " + std::to_string(accessor_->count) + " elements, more than the file's buffers have bytes");
        std::vector<double> out(accessor_->count * components, 0.0);
        if (accessor_->bufferView >= 0)
            copy(accessor_->bufferView, accessor_->byteOffset, accessor_->componentType, accessor_->normalized, components, true, out);
        else if (!accessor_->sparse.isSparse && accessor_->count > 0)
            fail("has no data (no buffer view)");
        if (accessor_->sparse.isSparse)
            substitute(components, out);
        return out;
    }

private:
    [[noreturn]] void fail(const std::string& reason) const { throw InputError::in_file(file_, name_ + " " + reason); }

    void substitute(std::size_t components, std::vector<double>& out) const
    {
        const auto& sparse = accessor_->sparse;
        if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > accessor_->count || sparse.indices.byteOffset < 0 ||
            sparse.values.byteOffset < 0)
            fail("has a sparse part that does not fit it");
        const auto count = static_cast<std::size_t>(sparse.count);
        std::vector<double> at(count), values(count * components);
        copy(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), sparse.indices.componentType, false, 1, false, at);
        copy(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), accessor_->componentType, accessor_->normalized,
             components, false, values);
        for (std::size_t i = 0; i < count; ++i) {
            if (!(at[i] >= 0 && at[i] < static_cast<double>(accessor_->count)))
                fail("has a sparse index out of range");
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * components), components,
                        out.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(at[i]) * components));
        }
    }

    // out.size() / components elements from a buffer view.
    void copy(int view_index, std::size_t offset, int type, bool normalized, std::size_t components, bool strided, std::vector<double>& out) const
    {
        if (view_index < 0 || static_cast<std::size_t>(view_index) >= model_.bufferViews.size())
            fail("refers to buffer view " + std::to_string(view_index) + ", which does not exist");
        const auto& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
        if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
            fail("refers to buffer " + std::to_string(view.buffer) + ", which does not exist");
        const auto& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
        const int bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
        if (bytes <= 0)
            fail("has an unknown component type " + std::to_string(type));
        const std::size_t size = static_cast<std::size_t>(bytes), element = size * components;
        const std::size_t stride = strided && view.byteStride > 0 ? view.byteStride : element;
        const std::size_t count = out.size() / components;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail("lies in a buffer view that reaches past its buffer");
        if (count > 0 && (stride > view.byteLength || offset > view.byteLength || element > view.byteLength - offset ||
                          (count - 1) > (view.byteLength - offset - element) / stride))
            fail("reaches past its buffer view");
        const unsigned char* first = data.data() + view.byteOffset + offset;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < components; ++c)
                out[i * components + c] = component(first + i * stride + c * size, type, normalized);
    }

    template <class T> static double load(const unsigned char* at)
    {
        T value;
        std::memcpy(&value, at, sizeof value);
        return static_cast<double>(value);
    }

    double component(const unsigned char* at, int type, bool normalized) const
    {
        switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: return normalized ? std::max(load<std::int8_t>(at) / 127, -1.0) : load<std::int8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return normalized ? load<std::uint8_t>(at) / 255 : load<std::uint8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_SHORT: return normalized ? std::max(load<std::int16_t>(at) / 32767, -1.0) : load<std::int16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return normalized ? load<std::uint16_t>(at) / 65535 : load<std::uint16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return load<std::uint32_t>(at);
        case TINYGLTF_COMPONENT_TYPE_FLOAT: {
            const double value = load<float>(at);
            if (!std::isfinite(value))
                fail("holds a number that is not finite");
            return value;
        }
        default: fail("has an unsupported component type " + std::to_string(type));
        }
    }

    const tinygltf::Model& model_;
    const std::string& file_;
    std::string name_;
    const tinygltf::Accessor* accessor_ = nullptr;
};

} // namespace

std::vector<double> read_accessor(const tinygltf::Model& model, int index, std::size_t components, const std::string& file)
{
    return AccessorReader(model, index, file).read(components);
}

} // namespace cinch
