// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "experiments/report/provenance.hpp"
#include "experiments/verify.hpp"
#include "toolkit/deform/motion.hpp"
#include "toolkit/surface/input_error.hpp"

namespace {

using namespace cinch;

constexpr int bad_input = 2;

void add_input(CLI::App& command, InputOptions& o)
{
    command.add_option("INPUT", o.input,
                       fmt::format("a shape ({}), a mesh (.obj, .off, .ply, .stl) or a skinned character (.glb, .gltf)", fmt::join(shape_names(), ", ")))
        ->capture_default_str();
    command.add_option("--nodes", o.nodes, "simulation nodes sampled in the volume [the paper's number for a shape, 100 for a mesh]")->check(CLI::Range(1, 100000));
    command.add_option("--support", o.support, "reach of a simulation node, in fill distances [2]")->check(CLI::Range(1e-3, 1e3));
    command.add_option("--motion", o.motion, fmt::format("scripted motion: {} [strong]", motion_names));
    command.add_option("--weights", o.weights, "weights of a mesh's vertices, as text: 'V J', then per vertex 'n j1 w1 ... jn wn'");
    command.add_option("--transforms", o.transforms,
                       "transforms of the nodes, as text: the number of clips; per clip 'name K J', then K lines of a time and J row-major 3x4 matrices");
    command.add_option("--clip", o.clip, "which clip of a character or of --transforms [the first]");
    command.add_option("--fps", o.fps, "frames per second sampled from a character's clip [30]")->check(CLI::Range(1e-3, 1e6));
    command.add_option("--frames", o.frames, "how many frames, evenly spread, the last one included [4 scripted, else all]")->check(CLI::Range(1, 1000000));
    command.add_option("--seed", o.seed, "seed of everything random")->capture_default_str();
}

template <class Enum> CLI::CheckedTransformer one_of(std::map<std::string, Enum> names) { return CLI::CheckedTransformer(std::move(names)); }

#ifdef CINCH_EXACT
void add_verify(CLI::App& app, VerifyOptions& o)
{
    CLI::App& command = *app.add_subcommand("verify", "prove every bound of every BV, direction and frame in exact arithmetic");
    add_input(command, o.input);
    std::map<std::string, Method> methods;
    for (std::size_t i = 0; i < method_names.size(); ++i)
        methods.emplace(method_names[i], static_cast<Method>(i));
    command.add_option("--method", o.method, "convex, eq12, limited or vertices [limited]")->transform(one_of(methods))->option_text("NAME");
    command.add_option("--kdop", o.kdop, "directions of the bounds: 6, 14, 18 or 26")->check(CLI::IsMember({6, 14, 18, 26}))->capture_default_str();
    command.add_option("--leaf", o.leaf, "most triangles per leaf")->check(CLI::Range(1, 1000000))->capture_default_str();
    command.add_option("--threads", o.threads, "threads [all cores]")->check(CLI::Range(1, 1024));
    command.add_flag("--json", o.json, "JSON Lines on standard output and nothing else");
    command.add_option("--sabotage", o.sabotage,
                       "for tests: damage the bounds, to see that it is found: no-rounding (drop the error terms), swap-interval (swap one l and h), "
                       "lower-h (lower one h by 2^-53)")
        ->transform(one_of<Sabotage>({{"no-rounding", Sabotage::no_rounding}, {"swap-interval", Sabotage::swap_interval}, {"lower-h", Sabotage::lower_h}}))
        ->option_text("KIND");
    command.footer("Examples:\n"
                   "  cinch verify                                     the 30,000-vertex brain, 509 simulation nodes\n"
                   "  cinch verify hand.ply --nodes 200 --kdop 14      a mesh of yours under the standard motion\n"
                   "  cinch verify robot.glb --clip Robot_Dance        a skinned character\n"
                   "  cinch verify rest.off --weights w.txt --transforms t.txt --json\n"
                   "\n"
                   "Text form of weights and transforms ('#' starts a comment):\n"
                   "  weights     first line 'V J'; then per vertex 'n j1 w1 ... jn wn' (node from 0, weight >= 0, normalised on load)\n"
                   "  transforms  number of clips; per clip 'name K J', then K lines 'time' and J x 12 numbers: the row-major 3x4\n"
                   "              matrix of every node. Vertex k moves to the sum of w_j M_j (x, y, z, 1).\n"
                   "\n"
                   "Exit status: 0 all proven, 1 a bound violated, 2 bad usage or input, 130 interrupted (results so far are printed).");
}
#endif

} // namespace

int main(int argc, char** argv)
{
    CLI::App app{"cinch: tight, proven bounding volumes for surfaces deformed by few simulation nodes", "cinch"};
    app.require_subcommand(1);
    app.set_version_flag("--version", describe(provenance(0, 0)).substr(0, describe(provenance(0, 0)).find(',')));
    app.footer("'cinch COMMAND --help' says more, with examples.");
    VerifyOptions verify_options;
#ifdef CINCH_EXACT
    add_verify(app, verify_options);
#endif
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands([&](const CLI::App* s) { return s->get_name() == argv[1]; }).empty()) {
        fmt::print(stderr, "cinch: unknown command '{}' (see 'cinch --help')\n", argv[1]);
        return bad_input;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) { // --help, --version
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "cinch: {} (see 'cinch --help')\n", error.what());
        return bad_input;
    }
    try {
#ifdef CINCH_EXACT
        if (app.got_subcommand("verify"))
            return verify(verify_options);
#endif
    } catch (const InputError& error) {
        fmt::print(stderr, "cinch: {}\n", error.what());
        return bad_input;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "cinch: out of memory\n");
        return bad_input;
    }
    return 0;
}
