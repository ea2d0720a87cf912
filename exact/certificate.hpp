// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "exact/verifier.hpp"

namespace cinch::exact {

/// Takes one line, without its end. Called in order.
using LineSink = std::function<void(std::string_view)>;

/// A certificate is JSON Lines that carry everything needed to prove the bounds again without this program; doubles are
/// hexadecimal floats. First {"certificate":"cinch 1", counts, method, weight_space (are there λ?), kdop}; per vertex {"vertex", "rest", "nodes",
/// "weights"}; per BV {"bv", "triangles": vertex triples, for leaves, or "children", "centre", "half", "nodes", "l", "h"}.
void certify_rest(const DeformableSurface& surface, const Bvh& bvh, Methods methods, int kdop, std::size_t frames, const LineSink& line,
                  RestShape shape = RestShape::aabb);

/// Per frame {"frame", "maps": 12 numbers per simulation node}; then per BV {"frame", "bv", "bounds", "lambda"}, k of each, in the
/// order of the k-DOP's directions. D(λ) ≤ bound proves a direction; λ is "p/q" where no double will do, only for the box_methods, other bounds are proven by the vertices alone.
void certify_frame(std::size_t frame, std::span<const AffineMap> maps, Methods methods, int kdop, std::span<const double> supports,
                   const FrameVerdict& verdict, const LineSink& line, RestShape shape = RestShape::aabb);

} // namespace cinch::exact
