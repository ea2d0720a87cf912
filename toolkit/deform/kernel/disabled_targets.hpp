// SPDX-License-Identifier: Apache-2.0
// Before <hwy/foreach_target.h> in every kernel: the same instruction sets for all.
#pragma once

// Targets without fused multiply-add would have to emulate it at great cost; what is left is AVX2 and up, NEON, and
// portable code. Targets with vectors of unknown length cannot hold them in arrays.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// The portable code is lane by lane for every compiler.
#define HWY_BROKEN_EMU128 1
