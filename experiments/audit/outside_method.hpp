// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace cinch {

struct EngineBound;
struct Instant;
struct TimedBody;

/// A method that is no part of this program: a shell command that reads a surface and its frames from standard input
/// and writes a bound for each to standard output (data/README.md).
struct OutsideMethod {
    std::string name, command;
};

/// "NAME=COMMAND". Throws InputError for others, and for names that rows have already.
OutsideMethod parse_outside(const std::string& text);

/// What the command says of every instant. Throws InputError where it fails, or says less, more or something else.
std::vector<EngineBound> bounds_of(const OutsideMethod& method, const TimedBody& body, const std::string& clip,
                                   const std::vector<Instant>& instants);

} // namespace cinch
