// SPDX-License-Identifier: GPL-3.0-or-later
// Hard steps.
#include <numbers>

#include "cinch/surface.hpp"
#include "experiments/stability/bodies.hpp"
#include "toolkit/simulate/scene.hpp"

namespace cinch {
namespace {

using namespace stability_bodies;

BodySimulation block(double young, Missing missing, double poisson = 0.3)
{
    BodySimulation s = body_in_box({1, 0.6, 0.6}, lattice({1, 0.6, 0.6}, 6, 4, 4));
    add_elastic(s, young, missing, poisson);
    return s;
}

// Five seconds of long implicit steps from a hopeless start, heavily damped: what is left of its energy.
StabilityOutcome relax(BodySimulation s, Missing missing)
{
    s.add(make_mass_damping(8));
    const double start = s.potential();
    int mended = 0;
    StepReport r;
    for (int step = 0; step < 150 && r.failure.empty(); ++step) {
        r = s.advance(1.0 / 30, implicit_steps(1.0 / 30, missing));
        mended += r.projected;
    }
    StabilityOutcome out;
    const double left = s.potential() / start;
    out.pass = r.failure.empty() && is_finite(s) && left < 1e-2;
    out.observed =
        r.failure.empty() ? fmt::format("{:.1e} of the energy left; {} Hessians mended", left, mended) : r.failure;
    if (is_finite(s))
        out.states.push_back(state_of(s));
    return out;
}

StabilityOutcome reflected(Missing missing)
{
    BodySimulation s = block(1e5, missing);
    place(s, Vec3(-1, 1, 1).asDiagonal());
    return relax(std::move(s), missing);
}

StabilityOutcome inverted(Missing missing)
{
    // Every node at a place of another: inside out in a thousand ways.
    BodySimulation s = block(1e5, missing);
    const std::size_t n = s.body().size();
    Field x(4 * n, 0);
    for (std::size_t i = 0; i < n; ++i)
        at(x, i) = s.body().rest[(i * 37 + 11) % n];
    s.place(x, Field(4 * n, 0));
    return relax(std::move(s), missing);
}

StabilityOutcome collapsed(Missing missing)
{
    BodySimulation s = block(1e5, missing);
    // To a needle, turned inside out along z; a thousandth off symmetry, which else would hold it there for ever.
    Field x = moved(s.body(), Vec3(0.9, 1e-3, -1e-3).asDiagonal(), Vec3::Zero());
    for (std::size_t i = 0; i < s.body().size(); ++i)
        at(x, i) += 1e-3 * Vec3(std::sin(12.9 * static_cast<double>(i)), std::sin(78.2 * static_cast<double>(i)),
                                std::sin(37.7 * static_cast<double>(i)));
    s.place(x, Field(x.size(), 0));
    return relax(std::move(s), missing);
}

StabilityOutcome stiff(Missing missing)
{
    StabilityOutcome out;
    out.pass = true;
    int falls = 0;
    for (const double young : {1e3, 1e5, 1e7, 1e9}) {
        BodySimulation s = block(young, missing);
        place(s, Vec3(1.3, 0.8, 1).asDiagonal());
        double energy = s.potential();
        const double start = energy;
        std::string failure;
        bool grew = false;
        for (int step = 0; step < 20 && failure.empty(); ++step) {
            const StepReport r = s.advance(1.0 / 30, implicit_steps(1.0 / 30, missing));
            failure = r.failure;
            grew |= r.kinetic + r.potential > energy + 1e-9 * start;
            energy = r.kinetic + r.potential;
        }
        out.pass &= failure.empty() && !grew;
        falls += failure.empty() && !grew;
        out.states.push_back(state_of(s));
    }
    // The explicit integrator takes as many substeps as it needs.
    BodySimulation s = block(1e7, missing);
    place(s, Vec3(1.05, 1, 1).asDiagonal());
    const StepReport r = s.advance(1.0 / 30, explicit_steps(1.0 / 30));
    out.pass &= r.failure.empty() && r.substeps > 10 && is_finite(s);
    out.observed = fmt::format("falls at {} of 4 stiffnesses to 1e9 Pa; {} substeps", falls, r.substeps);
    return out;
}

StabilityOutcome scripted_turns(Missing missing)
{
    StabilityOutcome out;
    out.pass = true;
    for (const double degrees : {90.0, 180.0}) {
        BodySimulation s = block(1e5, missing);
        std::vector<std::uint32_t> held, led;
        std::vector<Vec3> held_at, led_at;
        for (std::uint32_t i = 0; i < s.body().size(); ++i) {
            const Vec3& p = s.body().rest[i];
            if (std::abs(p[0]) > 0.4) {
                (p[0] < 0 ? held : led).push_back(i);
                (p[0] < 0 ? held_at : led_at).push_back(p);
            }
        }
        s.add(fixed_pin(held, held_at));
        Turning turning;
        turning.axis = Vec3::UnitX();
        turning.rate = degrees * std::numbers::pi / 180 / 0.1; // per step
        s.add(turning_pin(led, led_at, turning));
        const StepReport r = s.advance(0.1, implicit_steps(0.1, missing));
        double off = 0;
        for (std::size_t k = 0; k < led.size(); ++k)
            off = std::max(off, (at(s.positions(), led[k]) - turning.apply(led_at[k], 0.1)).norm());
        out.pass &=
            r.failure.empty() && is_finite(s) && off < 1e-12 && r.substeps >= degrees * std::numbers::pi / 180 / 0.4;
        out.observed += fmt::format("{}{} degrees in {} steps{}", out.observed.empty() ? "" : ", ", degrees, r.substeps,
                                    r.failure.empty() ? "" : ": " + r.failure);
        out.states.push_back(state_of(s));
    }
    return out;
}

StabilityOutcome poisson_limit(Missing missing)
{
    StabilityOutcome out;
    int refused = 0;
    for (const double nu : {0.5, 0.6, -1.0, -2.0})
        try {
            parse_scene(fmt::format(R"({{"duration":1,"bodies":[{{"surface":"santa","nodes":5}}],
                                        "effects":[{{"effect":"elastic","young":1,"poisson":{}}}]}})",
                                    nu),
                        "scene", ".");
        } catch (const InputError&) {
            ++refused;
        }
    BodySimulation s = block(1e5, missing, 0.499);
    place(s, Vec3(1.2, 1, 1).asDiagonal());
    const StepReport r = s.advance(0.5, implicit_steps(1.0 / 60, missing));
    out.pass = refused == 4 && r.failure.empty() && is_finite(s);
    out.observed = fmt::format("{} of 4 refused; 0.499 {}", refused, r.failure.empty() ? "runs" : r.failure);
    out.states.push_back(state_of(s));
    return out;
}

StabilityOutcome no_time(Missing missing)
{
    BodySimulation s = block(1e5, missing);
    place(s, Vec3(1.2, 1, 1).asDiagonal());
    const Field x = s.positions();
    bool same = true;
    int refused = 0;
    for (const Integration& how : {implicit_steps(1.0 / 60, missing), explicit_steps(1.0 / 60)}) {
        s.advance(0, how);
        same &= s.positions() == x && s.time_s() == 0;
        for (const double dt :
             {-0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
            try {
                s.advance(dt, how);
            } catch (const std::invalid_argument&) {
                ++refused;
            }
    }
    StabilityOutcome out;
    out.pass = same && refused == 6;
    out.observed = fmt::format("0 {}; {} of 6 others refused", same ? "changes nothing" : "CHANGES", refused);
    return out;
}

StabilityOutcome all_pinned(Missing missing)
{
    BodySimulation s = block(1e5, missing);
    std::vector<std::uint32_t> all;
    std::vector<Vec3> places;
    for (std::uint32_t i = 0; i < s.body().size(); ++i) {
        all.push_back(i);
        places.push_back(2 * s.body().rest[i]);
    }
    s.add(fixed_pin(all, places));
    const StepReport a = s.advance(0.1, implicit_steps(0.1, missing)), b = s.advance(0.1, explicit_steps(0.1));
    int refused = 0;
    for (const double volume : {0.0, -1.0})
        try {
            discretise(std::vector<Vec3>{Vec3::Zero()}, std::vector<double>{volume}, {});
        } catch (const std::invalid_argument&) {
            ++refused;
        }
    StabilityOutcome out;
    out.pass = a.failure.empty() && b.failure.empty() && a.products == 0 &&
               away(s, 2 * Mat3::Identity(), Vec3::Zero()) == 0 && refused == 2;
    out.observed = fmt::format("{} products, {} m off; {} of 2 masses refused", a.products,
                               away(s, 2 * Mat3::Identity(), Vec3::Zero()), refused);
    out.states.push_back(state_of(s));
    return out;
}

StabilityOutcome stvk_flattened(Missing missing)
{
    // Where St. Venant-Kirchhoff resists least; volume preservation and the projection carry it.
    BodySimulation s = body_in_box({1, 0.6, 0.6}, lattice({1, 0.6, 0.6}, 6, 4, 4));
    s.add(make_stvk(1e5, 0.3, false));
    s.add(make_volume(1e5));
    if (missing != Missing::hourglass)
        s.add(make_hourglass(s.body(), 1, 1e5));
    place(s, Vec3(1, 1, 0.4).asDiagonal());
    return relax(std::move(s), missing);
}

StabilityOutcome flow_of_needle(Missing missing)
{
    BodySimulation s = block(1e5, missing);
    s.add(make_plasticity({0.01, 1000, 5}));
    place(s, Vec3(1e-3, 1e-3, 1).asDiagonal());
    const StepReport r = s.advance(0.2, implicit_steps(1.0 / 60, missing));
    double off = 0;
    for (const Mat3& p : s.plastic_inverse())
        off = std::max(off, std::abs(p.determinant() - 1));
    StabilityOutcome out;
    out.pass = r.failure.empty() && is_finite(s) && off < 1e-9;
    out.observed = r.failure.empty() ? fmt::format("det F_p off 1 by {:.0e}", off) : r.failure;
    out.states.push_back(state_of(s));
    return out;
}

} // namespace

std::vector<StabilityCase> solver_cases()
{
    return {{"14 reflected start", "relaxes to under 1 % of its energy", reflected},
            {"18 stiff material, long steps", "implicit: energy falls; explicit: substeps", stiff},
            {"19 turned by 90 and 180 degrees a step", "steps of at most 0.4 rad; finite; in place", scripted_turns},
            {"20 inverted start", "relaxes to under 1 % of its energy", inverted},
            {"20 collapsed start", "relaxes to under 1 % of its energy", collapsed},
            {"21 Poisson's ratio to its limits", "0.5 and -1 refused; 0.499 runs", poisson_limit},
            {"33 steps of no time", "0 changes nothing; negative refused", no_time},
            {"34 all pinned, no mass", "no solve, in place; no mass refused", all_pinned},
            {"37 StVK flattened", "relaxes to under 1 % of its energy", stvk_flattened},
            {"38 plastic flow of a needle", "finite; det F_p stays 1", flow_of_needle}};
}

} // namespace cinch
