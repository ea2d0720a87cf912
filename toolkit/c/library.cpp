// SPDX-License-Identifier: Apache-2.0
// What belongs to no handle: the version, the arithmetic, axes, and arrays in other forms.
#include <cfenv>
#include <cmath>
#include <vector>

#include "cinch/collider.hpp"
#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/options.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

thread_local std::vector<std::fenv_t> before; // of cinch_begin_default_arithmetic()

void convert(const float* from, std::int32_t layout, std::size_t map, AffineMap& to)
{
    const std::size_t row = layout == CINCH_LAYOUT_COLUMNS_16 ? 1 : 4,
                      column = layout == CINCH_LAYOUT_COLUMNS_16 ? 4 : 1;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            to.m[r][c] = static_cast<double>(from[r * row + c * column]);
    if (layout == CINCH_LAYOUT_ROWS_12)
        return;
    for (std::size_t c = 0; c < 4; ++c)
        if (from[3 * row + c * column] != (c < 3 ? 0.0f : 1.0f))
            throw std::invalid_argument("the last row of map " + std::to_string(map) + " is not 0 0 0 1");
}

} // namespace

const char* cinch_version(void) { return CINCH_VERSION; }

uint32_t cinch_parts(void) { return CINCH_C_PARTS; }

cinch_status cinch_check_arithmetic(void) { return call(require_default_arithmetic); }

cinch_status cinch_begin_default_arithmetic(void)
{
    return call([] {
        std::fenv_t now;
        std::fegetenv(&now);
        before.push_back(now);
        std::fesetenv(FE_DFL_ENV);
    });
}

cinch_status cinch_end_default_arithmetic(void)
{
    return call([] {
        if (before.empty())
            throw std::logic_error("cinch_end_default_arithmetic: nothing was begun on this thread");
        std::fesetenv(&before.back());
        before.pop_back();
    });
}

cinch_status cinch_axes(int32_t kdop, int32_t* axes, size_t count)
{
    return call([&] {
        const auto all = axes_of(kdop_of(kdop));
        const auto out = array_of<std::array<std::int32_t, 3>>(axes, count, all.size(), "axes");
        std::copy(all.begin(), all.end(), out.begin());
    });
}

cinch_status cinch_maps_from_floats(const float* from, int32_t layout, double* maps, size_t count)
{
    return call([&] {
        if (layout < CINCH_LAYOUT_ROWS_12 || layout > CINCH_LAYOUT_COLUMNS_16)
            throw std::invalid_argument("there is no layout " + std::to_string(layout));
        const std::size_t size = layout == CINCH_LAYOUT_ROWS_12 ? 12 : 16;
        const auto in = array<float>(from, times(count, size), "from");
        const auto out = array<AffineMap>(maps, count, "maps");
        for (std::size_t i = 0; i < count; ++i)
            convert(&in[i * size], layout, i, out[i]);
    });
}

cinch_status cinch_boxes_of(const double* supports, int32_t kdop, double* boxes, size_t count)
{
    return call([&] {
        const auto k = static_cast<std::size_t>(kdop_of(kdop));
        const auto in = array<double>(supports, times(count, k), "supports");
        const auto out = array<Aabb>(boxes, count, "boxes");
        for (std::size_t i = 0; i < count; ++i)
            out[i] = Dop(in.subspan(i * k, k)).aabb();
    });
}

cinch_status cinch_swept(const double* first, const double* last, double* supports, size_t count)
{
    return call([&] {
        swept(array<double>(first, count, "first"), array<double>(last, count, "last"),
              array<double>(supports, count, "supports"));
    });
}
