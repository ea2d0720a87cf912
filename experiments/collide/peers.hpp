// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to collide/: peers, each there only if its Debian package was when the program was built.
#pragma once

#include "experiments/collide/backend.hpp"

namespace cinch {

std::unique_ptr<Backend> make_embree(const CollideScene& scene);
std::unique_ptr<Backend> make_fcl(const CollideScene& scene);
std::unique_ptr<Backend> make_bullet(const CollideScene& scene);
std::unique_ptr<Backend> make_tinybvh(const CollideScene& scene);
std::unique_ptr<Backend> make_cgal(const CollideScene& scene);

} // namespace cinch
