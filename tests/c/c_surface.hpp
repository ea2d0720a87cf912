// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>

#include "cinch/cinch.h"
#include "cinch/deform.hpp"
#include "tests/support.hpp"

namespace cinch::test {

/// A handle that is freed at the end.
template <class T> class Handle {
public:
    Handle() = default;
    Handle(Handle&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    Handle& operator=(Handle&& other) noexcept
    {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Handle() { cinch_free(handle_); }
    T* get() const { return handle_; }
    T** out() { return &handle_; }

private:
    T* handle_ = nullptr;
};

/// The same surface, from its arrays.
inline Handle<cinch_surface> c_surface(const DeformableSurface& surface, const std::vector<MorphTarget>& targets = {})
{
    std::vector<std::uint32_t> row = {0}, vertex;
    std::vector<double> displacement;
    for (const MorphTarget& target : targets) {
        vertex.insert(vertex.end(), target.vertex.begin(), target.vertex.end());
        for (const Vec3& d : target.displacement)
            displacement.insert(displacement.end(), d.data(), d.data() + 3);
        row.push_back(static_cast<std::uint32_t>(vertex.size()));
    }
    cinch_surface_arrays in{};
    in.positions = surface.mesh.vertices[0].data();
    in.vertex_count = surface.mesh.vertices.size();
    in.triangles = surface.mesh.triangles[0].data();
    in.triangle_count = surface.mesh.triangles.size();
    in.weight_row = surface.weights.row.data();
    in.weight_node = surface.weights.node.data();
    in.weight = surface.weights.weight.data();
    in.weight_count = surface.weights.weight.size();
    in.node_count = surface.weights.node_count;
    in.target_row = row.data();
    in.target_count = targets.size();
    in.target_vertex = vertex.data();
    in.target_displacement = displacement.data();
    in.displacement_count = vertex.size();
    Handle<cinch_surface> out;
    REQUIRE(cinch_surface_from_arrays(&in, out.out()) == CINCH_OK);
    return out;
}

} // namespace cinch::test
