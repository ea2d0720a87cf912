// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/paper_figures.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

namespace cinch {
namespace {

constexpr PaperFigure figures[] = {
    // Time of one bound of the whole brain, by vertices and simulation nodes.
    {"Table 1", "3.5K", "65", 15, "µs"},
    {"Table 1", "3.5K", "225", 35, "µs"},
    {"Table 1", "3.5K", "509", 90, "µs"},
    {"Table 1", "3.5K", "optimal", 2000, "µs"},
    {"Table 1", "30K", "65", 18, "µs"},
    {"Table 1", "30K", "225", 48, "µs"},
    {"Table 1", "30K", "509", 100, "µs"},
    {"Table 1", "30K", "optimal", 17200, "µs"},
    {"Table 1", "145K", "65", 18, "µs"},
    {"Table 1", "145K", "225", 46, "µs"},
    {"Table 1", "145K", "509", 100, "µs"},
    {"Table 1", "145K", "optimal", 82500, "µs"},
    // Per body; scenes as they are numbered.
    {"Table 2", "1", "vertices", 2857, ""},
    {"Table 2", "1", "nodes", 115, ""},
    {"Table 2", "2", "vertices", 2857, ""},
    {"Table 2", "2", "nodes", 550, ""},
    {"Table 2", "3", "vertices", 45682, ""},
    {"Table 2", "3", "nodes", 115, ""},
    {"Table 2", "4", "vertices", 45682, ""},
    {"Table 2", "4", "nodes", 550, ""},
    {"Table 2", "5", "vertices", 2857, ""},
    {"Table 2", "5", "nodes", 115, ""},
    {"Table 2", "6", "vertices", 2857, ""},
    {"Table 2", "6", "nodes", 550, ""},
    {"Table 2", "7", "vertices", 45682, ""},
    {"Table 2", "7", "nodes", 115, ""},
    {"Table 2", "8", "vertices", 45682, ""},
    {"Table 2", "8", "nodes", 550, ""},
    // Per frame: full bottom-up update of AABB trees, and spatial hashing.
    {"Table 3", "1, 2", "refit", 37.1, "ms"},
    {"Table 3", "1, 2", "query", 2.12, "ms"},
    {"Table 3", "1, 2", "total", 39.3, "ms"},
    {"Table 3", "1, 2", "hash load", 28.29, "ms"},
    {"Table 3", "1, 2", "hash query", 41.63, "ms"},
    {"Table 3", "1, 2", "hash total", 70.0, "ms"},
    {"Table 3", "3, 4", "refit", 575.7, "ms"},
    {"Table 3", "3, 4", "query", 5.89, "ms"},
    {"Table 3", "3, 4", "total", 581.6, "ms"},
    {"Table 3", "3, 4", "hash load", 479.6, "ms"},
    {"Table 3", "3, 4", "hash query", 1264.5, "ms"},
    {"Table 3", "3, 4", "hash total", 1744.1, "ms"},
    {"Table 3", "5, 6", "refit", 37.9, "ms"},
    {"Table 3", "5, 6", "query", 2.48, "ms"},
    {"Table 3", "5, 6", "total", 40.4, "ms"},
    {"Table 3", "5, 6", "hash load", 28.91, "ms"},
    {"Table 3", "5, 6", "hash query", 44.32, "ms"},
    {"Table 3", "5, 6", "hash total", 73.2, "ms"},
    {"Table 3", "7, 8", "refit", 569.7, "ms"},
    {"Table 3", "7, 8", "query", 8.84, "ms"},
    {"Table 3", "7, 8", "total", 578.6, "ms"},
    {"Table 3", "7, 8", "hash load", 484.2, "ms"},
    {"Table 3", "7, 8", "hash query", 1430.5, "ms"},
    {"Table 3", "7, 8", "hash total", 1914.7, "ms"},
    // Per frame: the paper's method, and its gain over the full update.
    {"Table 4", "1", "refit", 1.83, "ms"},
    {"Table 4", "1", "query", 5.72, "ms"},
    {"Table 4", "1", "total", 7.55, "ms"},
    {"Table 4", "1", "gain", 5.2, ""},
    {"Table 4", "1", "OBB refit", 2.82, "ms"},
    {"Table 4", "1", "OBB query", 7.82, "ms"},
    {"Table 4", "1", "OBB total", 10.64, "ms"},
    {"Table 4", "1", "OBB gain", 3.7, ""},
    {"Table 4", "2", "refit", 2.36, "ms"},
    {"Table 4", "2", "query", 5.60, "ms"},
    {"Table 4", "2", "total", 7.97, "ms"},
    {"Table 4", "2", "gain", 4.9, ""},
    {"Table 4", "2", "OBB refit", 4.05, "ms"},
    {"Table 4", "2", "OBB query", 8.48, "ms"},
    {"Table 4", "2", "OBB total", 12.53, "ms"},
    {"Table 4", "2", "OBB gain", 3.1, ""},
    {"Table 4", "3", "refit", 4.54, "ms"},
    {"Table 4", "3", "query", 16.6, "ms"},
    {"Table 4", "3", "total", 21.1, "ms"},
    {"Table 4", "3", "gain", 27.5, ""},
    {"Table 4", "3", "OBB refit", 6.85, "ms"},
    {"Table 4", "3", "OBB query", 21.89, "ms"},
    {"Table 4", "3", "OBB total", 28.74, "ms"},
    {"Table 4", "3", "OBB gain", 20.3, ""},
    {"Table 4", "4", "refit", 5.77, "ms"},
    {"Table 4", "4", "query", 18.7, "ms"},
    {"Table 4", "4", "total", 24.5, "ms"},
    {"Table 4", "4", "gain", 23.7, ""},
    {"Table 4", "4", "OBB refit", 8.48, "ms"},
    {"Table 4", "4", "OBB query", 25.37, "ms"},
    {"Table 4", "4", "OBB total", 33.85, "ms"},
    {"Table 4", "4", "OBB gain", 17.2, ""},
    {"Table 4", "5", "refit", 3.38, "ms"},
    {"Table 4", "5", "query", 10.0, "ms"},
    {"Table 4", "5", "total", 13.4, "ms"},
    {"Table 4", "5", "gain", 3.0, ""},
    {"Table 4", "5", "OBB refit", 3.89, "ms"},
    {"Table 4", "5", "OBB query", 10.27, "ms"},
    {"Table 4", "5", "OBB total", 14.17, "ms"},
    {"Table 4", "5", "OBB gain", 2.9, ""},
    {"Table 4", "6", "refit", 3.26, "ms"},
    {"Table 4", "6", "query", 9.28, "ms"},
    {"Table 4", "6", "total", 12.5, "ms"},
    {"Table 4", "6", "gain", 3.2, ""},
    {"Table 4", "6", "OBB refit", 5.41, "ms"},
    {"Table 4", "6", "OBB query", 13.00, "ms"},
    {"Table 4", "6", "OBB total", 18.42, "ms"},
    {"Table 4", "6", "OBB gain", 2.2, ""},
    {"Table 4", "7", "refit", 6.87, "ms"},
    {"Table 4", "7", "query", 24.5, "ms"},
    {"Table 4", "7", "total", 31.4, "ms"},
    {"Table 4", "7", "gain", 18.4, ""},
    {"Table 4", "7", "OBB refit", 7.91, "ms"},
    {"Table 4", "7", "OBB query", 26.98, "ms"},
    {"Table 4", "7", "OBB total", 34.89, "ms"},
    {"Table 4", "7", "OBB gain", 16.6, ""},
    {"Table 4", "8", "refit", 8.23, "ms"},
    {"Table 4", "8", "query", 29.3, "ms"},
    {"Table 4", "8", "total", 37.5, "ms"},
    {"Table 4", "8", "gain", 15.4, ""},
    {"Table 4", "8", "OBB refit", 11.39, "ms"},
    {"Table 4", "8", "OBB query", 38.6, "ms"},
    {"Table 4", "8", "OBB total", 49.99, "ms"},
    {"Table 4", "8", "OBB gain", 11.6, ""},
    // Radius of the root over that of the optimal AABB, 509 simulation nodes.
    {"Fig. 1", "root", "ratio", 2, ""},
    {"Fig. 5", "root", "mean", 1.5, ""},
    {"Fig. 5", "root", "max", 2.5, ""},
    {"Fig. 5", "root", "spheres", 68, ""},
    // 24 fishes of 8K vertices and 96 simulation nodes each.
    {"Fig. 7", "fishes", "refit", 5.3, "ms"},
    {"Fig. 7", "fishes", "query", 26.3, "ms"},
    {"Fig. 7", "fishes", "full refit", 401.7, "ms"},
    {"Fig. 7", "fishes", "full query", 16.6, "ms"},
    {"Fig. 7", "fishes", "gain", 12, ""},
};

} // namespace

const PaperFigure& paper_figure(std::string_view place, std::string_view row, std::string_view column)
{
    const auto found = std::find_if(std::begin(figures), std::end(figures), [&](const PaperFigure& f) {
        return f.place == place && f.row == row && f.column == column;
    });
    if (found == std::end(figures))
        throw std::out_of_range("the paper has no figure in " + std::string(place) + ", row " + std::string(row) +
                                ", column " + std::string(column));
    return *found;
}

} // namespace cinch
