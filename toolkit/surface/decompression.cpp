// SPDX-License-Identifier: Apache-2.0
// The decoders of Draco and meshoptimizer.
#include <cmath>
#include <cstring>

#include <draco/compression/decode.h>
#include <meshoptimizer.h>

#include "cinch/io.hpp"

namespace cinch {
namespace {

using Fault = Decompression::Fault;

template <class T> void read_raw(const draco::PointAttribute& from, std::size_t points, std::vector<double>& out)
{
    const auto components = static_cast<std::size_t>(from.num_components());
    std::vector<T> value(components);
    out.reserve(points * components);
    for (std::size_t i = 0; i < points; ++i) {
        from.GetValue(from.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i))), value.data());
        for (const T x : value) {
            if (!std::isfinite(static_cast<double>(x)))
                throw Fault("a number that is not finite");
            out.push_back(static_cast<double>(x));
        }
    }
}

// As stored, whatever they stand for.
std::vector<double> raw_numbers(const draco::PointAttribute& from, std::size_t points)
{
    std::vector<double> out;
    switch (from.data_type()) {
    case draco::DT_INT8:
        read_raw<std::int8_t>(from, points, out);
        break;
    case draco::DT_UINT8:
        read_raw<std::uint8_t>(from, points, out);
        break;
    case draco::DT_INT16:
        read_raw<std::int16_t>(from, points, out);
        break;
    case draco::DT_UINT16:
        read_raw<std::uint16_t>(from, points, out);
        break;
    case draco::DT_INT32:
        read_raw<std::int32_t>(from, points, out);
        break;
    case draco::DT_UINT32:
        read_raw<std::uint32_t>(from, points, out);
        break;
    case draco::DT_FLOAT32:
        read_raw<float>(from, points, out);
        break;
    default:
        throw Fault("an attribute of a type that glTF does not have");
    }
    return out;
}

Decompression::Mesh draco_mesh(std::string_view bytes, std::span<const std::uint32_t> ids)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        throw Fault(decoded.status().error_msg_string());
    const draco::Mesh& mesh = *decoded.value();
    Decompression::Mesh out;
    out.vertices = mesh.num_points();
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& p : mesh.face(f)) {
            if (p.value() >= mesh.num_points())
                throw Fault("a vertex index out of range");
            out.indices.push_back(p.value());
        }
    for (const std::uint32_t id : ids) {
        const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
        if (!attribute)
            throw Fault("there is no attribute " + std::to_string(id) + " in it");
        for (draco::PointIndex p(0); p < mesh.num_points(); ++p)
            if (attribute->mapped_index(p).value() >= attribute->size())
                throw Fault("an attribute with fewer values than vertices");
        out.attributes.push_back(raw_numbers(*attribute, mesh.num_points()));
    }
    return out;
}

std::string meshopt_view(std::string_view bytes, std::size_t count, std::size_t stride, const std::string& mode,
                         const std::string& filter)
{
    std::string out(count * stride, '\0');
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    int fault = 0;
    if (mode == "ATTRIBUTES") {
        if (stride % 4 != 0 || stride == 0 || stride > 256)
            throw Fault("a stride of " + std::to_string(stride) + " bytes");
        fault = meshopt_decodeVertexBuffer(out.data(), count, stride, data, bytes.size());
    } else if (mode == "TRIANGLES" || mode == "INDICES") {
        if ((stride != 2 && stride != 4) || (mode == "TRIANGLES" && count % 3 != 0))
            throw Fault(std::to_string(count) + " indices of " + std::to_string(stride) + " bytes");
        void* to = out.data();
        fault = mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(to, count, stride, data, bytes.size())
                                    : meshopt_decodeIndexSequence(to, count, stride, data, bytes.size());
    } else {
        throw Fault("the unknown mode " + mode);
    }
    if (fault)
        throw Fault("fault " + std::to_string(fault) + " of the decoder of " + mode);
    if (filter == "NONE")
        return out;
    // The filters take four elements at a time.
    out.resize((count + 3) / 4 * 4 * stride, '\0');
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(out.data(), (count + 3) / 4 * 4, stride);
    else if (filter == "QUATERNION" && stride == 8)
        meshopt_decodeFilterQuat(out.data(), (count + 3) / 4 * 4, stride);
    else if (filter == "EXPONENTIAL" && stride % 4 == 0)
        meshopt_decodeFilterExp(out.data(), (count + 3) / 4 * 4, stride);
    else
        throw Fault("the filter " + filter + " over a stride of " + std::to_string(stride) + " bytes");
    out.resize(count * stride);
    return out;
}

} // namespace

const Decompression& decompression()
{
    static constexpr Decompression both{draco_mesh, meshopt_view};
    return both;
}

} // namespace cinch
