// SPDX-License-Identifier: GPL-3.0-or-later
// `verify` alone, without scenes: what experiments/run builds for a first proof, in a fraction of the time.
#include "cinch/surface.hpp"
#include "experiments/command_line.hpp"
#include "experiments/input_scene.hpp"
#include "experiments/verify.hpp"

namespace cinch {

Inputs load_scene(const InputOptions& options)
{
    throw InputError(options.input + ": scenes are in the whole program, 'cinch'");
}

int verify_all_times(const VerifyOptions&)
{
    throw InputError("--times all: bounds over time are in the whole program, 'cinch'");
}

} // namespace cinch

int main(int argc, char** argv)
{
    constexpr cinch::AddCommand commands[] = {cinch::add_verify};
    return cinch::run_program(argc, argv, commands);
}
