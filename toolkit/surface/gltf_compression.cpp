// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_compression.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/surface/gltf_accessor.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

constexpr const char* draco = "KHR_draco_mesh_compression";
constexpr const char* meshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

std::string_view bytes_of(GltfDocument& document, const GltfValue& holder)
{
    const std::string& data = document.buffer(holder["buffer"].index());
    const std::size_t begin = holder.index_or("byteOffset", 0), length = holder["byteLength"].index();
    if (begin > data.size() || length > data.size() - begin)
        holder.fail("reaches past its buffer");
    return std::string_view(data).substr(begin, length);
}

template <class Decode> auto decoded(const GltfValue& place, const char* extension, const Decode& decode)
{
    try {
        return decode();
    } catch (const Decompression::Fault& fault) {
        place.fail("is compressed with " + std::string(extension) +
                   ", and its data cannot be decoded: " + one_line(fault.what()) + "; export it without compression");
    }
}

} // namespace

bool is_decoded(const GltfDocument& document, std::string_view extension)
{
    return document.decompression() && (extension == draco || extension == meshopt[0] || extension == meshopt[1]);
}

DecodedView decoded_view(GltfDocument& document, std::size_t index)
{
    const GltfValue view = document.at("bufferViews", index);
    const auto extensions = view.find("extensions");
    if (!extensions || !document.decompression())
        return {};
    for (const char* name : meshopt) {
        const auto of = extensions->find(name);
        if (!of)
            continue;
        const std::size_t count = (*of)["count"].index(), stride = (*of)["byteStride"].index();
        std::string& bytes = document.decoded_views[index];
        if (!bytes.empty() || count == 0)
            return {&bytes, stride};
        const std::string_view packed = bytes_of(document, *of);
        // A byte of the vertex codec holds four times sixteen bytes of zeros at most; the others hold less.
        if (stride == 0 || stride > 256 || count > (64 * packed.size() + 1024) / stride)
            of->fail("declares " + std::to_string(count) + " elements of " + std::to_string(stride) + " bytes in " +
                     std::to_string(packed.size()));
        const std::string mode = (*of)["mode"].text(), filter = of->text_or("filter", "NONE");
        bytes =
            decoded(*of, name, [&] { return document.decompression()->meshopt(packed, count, stride, mode, filter); });
        return {&bytes, stride};
    }
    return {};
}

std::optional<DecodedPrimitive> decoded_primitive(GltfDocument& document, const GltfValue& primitive)
{
    const auto extensions = primitive.find("extensions");
    const auto of = extensions ? extensions->find(draco) : std::nullopt;
    if (!of || !document.decompression())
        return std::nullopt;
    if (primitive.index_or("mode", 4) != 4)
        primitive.fail("is compressed with " + std::string(draco) +
                       " and no list of triangles, which is not supported");
    const GltfValue view = document.at("bufferViews", (*of)["bufferView"].index()), attributes = (*of)["attributes"];
    std::vector<std::string> names;
    std::vector<std::uint32_t> ids;
    for (const std::string& name : attributes.keys())
        if (name == "POSITION" || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) {
            names.push_back(name);
            ids.push_back(static_cast<std::uint32_t>(attributes[name.c_str()].index()));
        }
    Decompression::Mesh mesh =
        decoded(*of, draco, [&] { return document.decompression()->draco(bytes_of(document, view), ids); });
    DecodedPrimitive out{std::move(mesh.indices), {}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t accessor = primitive["attributes"][names[i].c_str()].index();
        if (document.at("accessors", accessor)["count"].index() != mesh.vertices ||
            mesh.attributes[i].size() != mesh.vertices * (names[i] == "POSITION" ? 3 : 4))
            of->fail("has another number of " + names[i] + " than its accessor");
        if (const double step = step_of_accessor(document, accessor); step > 0)
            for (double& x : mesh.attributes[i])
                x = std::max(x / std::round(1 / step), -1.0); // 255, 65535, ...
        out.attribute[names[i]] = std::move(mesh.attributes[i]);
    }
    return out;
}

} // namespace cinch
