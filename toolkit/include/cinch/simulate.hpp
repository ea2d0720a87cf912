// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Scenes: simulated bodies on their way through time.

#include "cinch/io.hpp"
