// SPDX-License-Identifier: Apache-2.0
#include "toolkit/c/options.hpp"

#include <stdexcept>
#include <string>

namespace cinch::c {
namespace {

constexpr std::uint32_t bit(Method method) { return 1u << static_cast<unsigned>(method); }
// All between, by name: tests/c/symbols_test.py.
static_assert(bit(Method::convex) == CINCH_METHOD_CONVEX && bit(Method::vertices) == CINCH_METHOD_VERTICES);

constexpr int most_passes = 1000; // each takes the time of a bound

Methods methods_of(std::uint32_t bits)
{
    if (bits == 0)
        return Method::best;
    if (bits >= 2 * bit(Method::vertices))
        throw std::invalid_argument("methods: there are none with these bits, " + std::to_string(bits));
    return Methods::where([bits](const MethodInfo& info) { return (bits & bit(info.method)) != 0; });
}

} // namespace

bool flag(std::int32_t value, const char* name)
{
    if (value != 0 && value != 1)
        throw std::invalid_argument(std::string(name) + " is 0 or 1, not " + std::to_string(value));
    return value == 1;
}

int kdop_of(std::int32_t k)
{
    if (k != 0 && !is_kdop(k))
        throw std::invalid_argument("k must be " + kdop_names());
    return k == 0 ? 6 : k;
}

RefitOptions options_of(const cinch_refit_options* options)
{
    if (!options)
        return {};
    RefitOptions out;
    out.methods = methods_of(options->methods);
    out.kdop = kdop_of(options->kdop);
    out.rounding = flag(options->plain, "plain") ? Rounding::plain : Rounding::proven;
    out.precision = flag(options->float64, "float64") ? Precision::float64 : Precision::float32;
    if (options->passes < 0 || options->passes > most_passes)
        throw std::invalid_argument("passes are 1 to " + std::to_string(most_passes) + ", not " +
                                    std::to_string(options->passes));
    out.passes = options->passes == 0 ? 1 : options->passes;
    out.rest_shape = flag(options->oriented, "oriented") ? RestShape::obb : RestShape::aabb;
    out.remember = flag(options->remember, "remember");
    return out;
}

LazyOptions options_of(const cinch_body_options* options, const LazyOptions& defaults)
{
    if (!options)
        return defaults;
    LazyOptions out;
    out.methods = methods_of(options->methods);
    out.kdop = options->kdop == 0 ? defaults.kdop : kdop_of(options->kdop);
    out.precision = flag(options->float64, "float64") ? Precision::float64 : Precision::float32;
    out.rest_shape = flag(options->oriented, "oriented") ? RestShape::obb : RestShape::aabb;
    if (options->update < 0 || options->update > 2)
        throw std::invalid_argument("update is 0, 1 or 2, not " + std::to_string(options->update));
    constexpr Update updates[] = {Update::automatic, Update::lazy, Update::full};
    out.update = updates[options->update];
    out.keep_cut = !flag(options->forget_cut, "forget_cut");
    if (options->lanes != 0 && options->lanes != 4 && options->lanes != 8 && options->lanes != 16)
        throw std::invalid_argument("lanes are 4, 8 or 16");
    out.lanes = options->lanes == 0 ? defaults.lanes : static_cast<std::size_t>(options->lanes);
    return out;
}

CrowdOptions options_of(const cinch_crowd_options* options)
{
    if (!options)
        return {};
    return {options->level, flag(options->plain, "plain") ? Rounding::plain : Rounding::proven};
}

} // namespace cinch::c
