// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/certificate_lines.hpp"

#include <nlohmann/json.hpp>

#include "exact/sha256.hpp"

namespace cinch::exact {
namespace {

std::string hash_of_positions(const DeformableSurface& surface)
{
    Sha256 hash;
    for (const Vec3& v : surface.mesh.vertices)
        hash.add(std::span<const double>(v.data(), 3));
    return hash.hex();
}

std::string hash_of_triangles(const DeformableSurface& surface)
{
    Sha256 hash;
    for (const Triangle& t : surface.mesh.triangles)
        hash.add(std::span<const std::uint32_t>(t));
    return hash.hex();
}

std::string hash_of_weights(const DeformableSurface& surface)
{
    Sha256 hash;
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        hash.add(static_cast<std::uint32_t>(row.node.size()));
        hash.add(row.node);
        hash.add(row.weight);
    }
    return hash.hex();
}

} // namespace

std::string escaped(const std::string& text)
{
    return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

std::string as_shown(const std::string& text) { return nlohmann::json::parse(escaped(text)).get<std::string>(); }

void hash_surface(const DeformableSurface& surface, const std::string& method, Line& line, const std::string& targets)
{
    line.raw(",\"sha256\":{\"positions\":\"").raw(hash_of_positions(surface));
    line.raw("\",\"triangles\":\"").raw(hash_of_triangles(surface));
    line.raw("\",\"weights\":\"").raw(hash_of_weights(surface));
    line.raw("\",\"method\":\"").raw(method);
    if (!targets.empty())
        line.raw("\",\"targets\":\"").raw(targets);
    line.raw("\"}");
}

void write_displacements(const MorphTarget& target, Line& line)
{
    line.integers(target.vertex).raw(",\"displacements\":");
    line.array(target.displacement, [&](const Vec3& d) { line.numbers({d.data(), 3}); }).raw("}").end();
}

void write_body(const DeformableSurface& surface, const Bvh& bvh, Line& line)
{
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        line.raw("{\"vertex\":").integer(k).raw(",\"rest\":").numbers({surface.mesh.vertices[k].data(), 3});
        line.raw(",\"nodes\":").integers(row.node).raw(",\"weights\":").numbers(row.weight).raw("}").end();
    }
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t)
        line.raw("{\"triangle\":").integer(t).raw(",\"vertices\":").integers(surface.mesh.triangles[t]).raw("}").end();
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        line.raw("{\"bv\":").integer(i);
        if (bv.is_leaf())
            line.raw(",\"triangles\":").integers(std::span(bvh.triangle).subspan(bv.first_triangle, bv.triangle_count));
        else
            line.raw(",\"children\":[").integer(bv.first_child).raw(",").integer(bv.first_child + 1).raw("]");
        line.raw("}").end();
    }
}

} // namespace cinch::exact
