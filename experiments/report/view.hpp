// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cinch/bounds.hpp"

namespace cinch {

/// What a view shows, and how it begins.
struct ViewRequest {
    std::string scene;       ///< a shipped scene's name or a path; whatever load_inputs takes
    std::string title;       ///< empty: the scene's name
    std::string text;        ///< what there is to see, one sentence or two
    std::size_t frames = 60; ///< at most, evenly spread over the clip
    std::size_t levels = 8;  ///< of the BVH that are kept, the root's first
    int kdop = 6;            ///< greatest k on offer: 6 has 6; 14 has 6, 14; 18 has 6, 18; 26 all four
    std::vector<Method> methods = tightest_first(all_methods.without(Method::vertices));
    int bits = 16;         ///< of the grid that positions are rounded to; 8 to 16
    std::size_t nodes = 0; ///< simulation nodes, where they are sampled; 0: as usual
    std::uint64_t seed = 0;
    bool partial = false;                  ///< of a character: what is modelled, see InputOptions
    std::string weights, transforms, clip; ///< see InputOptions

    bool swept = false; ///< of a clip's intervals, for all of their times, first of all; the frames with morph targets

    std::vector<std::string> formulas; ///< of engines, for the root: names of engine_formulas()

    Method method = Method::best; ///< shown first
    std::size_t level = 3;
    double time = 1;               ///< of the clip's length: the frame
    std::string surface = "solid"; ///< or "glass", "hidden"
    bool show_nodes = false, show_bounds = true;
    bool formula_first = false;          ///< the first of `formulas`, in place of `method`
    double azimuth = 35, elevation = 20; ///< degrees; of the camera, from +x towards +y, and up
};

/// One JSON object: surfaces, frames, simulation nodes, bounds by every method and intersecting triangles, as integers
/// on a grid (grid.hpp), packed (pack.hpp). The bounds contain the vertices on the grid, exactly. Ctrl-C, where it is
/// caught, leaves out methods that are not done yet; before there is one, Interrupted is thrown. Throws InputError for
/// what cannot be loaded or has vertices that are not finite.
nlohmann::ordered_json make_view(const ViewRequest& request);

/// The <section> elements with their data, before them style and script (three.js in-lined once). No network.
std::string view_sections(std::span<const nlohmann::ordered_json> views);
/// A page with nothing else. `note`: why these are not all, first of all.
std::string view_page(std::span<const nlohmann::ordered_json> views, const std::string& note = {});

/// Whether three.js was there when the program was built; if not, the sections say so.
bool has_three();

/// The views of the report: Fig. 1, Fig. 6, Fig. 7.
std::vector<ViewRequest> report_views();

} // namespace cinch
