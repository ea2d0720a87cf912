// SPDX-License-Identifier: Apache-2.0
#include "cinch/io.hpp"
#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"

using namespace cinch;
using namespace cinch::c;

cinch_status cinch_surface_read(const char* mesh, const char* weights, cinch_surface** surface)
{
    return call([&] {
        given(surface, "surface") = nullptr;
        const std::filesystem::path mesh_file = &given(mesh, "mesh"), weights_file = &given(weights, "weights");
        auto made = std::make_shared<Surface>();
        DeformableSurface all;
        all.mesh = read_mesh(mesh_file).mesh;
        all.weights = to_dyadic(read_weights_text(weights_file, all.mesh.vertices.size()), &made->report);
        made->surface = std::make_shared<const DeformableSurface>(std::move(all));
        made->targets = std::make_shared<const std::vector<MorphTarget>>();
        *surface = put(std::move(made));
    });
}
