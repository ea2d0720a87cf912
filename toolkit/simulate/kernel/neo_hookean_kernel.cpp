// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/kernel/neo_hookean_kernel.hpp"

// As the kernels of the bounds: targets with fused multiply-add, and portable code that calls fma().
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/simulate/kernel/neo_hookean_kernel.cpp"
#include <hwy/foreach_target.h>

#include "toolkit/deform/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// Four nodes at a time: a Quad holds one entry of their matrices.
void add_neo_hookean_stress(double mu, double lambda, double alpha, const double* volume, std::size_t count, const double* deformation, double* stress)
{
    const Quad one = Quad::all(1);
    for (std::size_t first = 0; first < count; first += 4) {
        const std::size_t lanes = count - first < 4 ? count - first : 4;
        HWY_ALIGN double volumes[4] = {};
        for (std::size_t lane = 0; lane < lanes; ++lane)
            volumes[lane] = volume[first + lane];
        Quad f[9], cofactor[9];
        for (std::size_t c = 0; c < 3; ++c) {
            Quad node[4];
            for (std::size_t lane = 0; lane < 4; ++lane)
                node[lane] = lane < lanes ? Quad::load(deformation + 12 * (first + lane) + 4 * c) : Quad::zero();
            transpose(node);
            for (std::size_t r = 0; r < 3; ++r)
                f[3 * c + r] = node[r];
        }
        Quad square = f[0] * f[0];
        for (std::size_t k = 1; k < 9; ++k)
            square = square + f[k] * f[k];
        for (std::size_t c = 0; c < 3; ++c) { // column c is the cross product of the two that follow
            const Quad *a = f + 3 * ((c + 1) % 3), *b = f + 3 * ((c + 2) % 3);
            for (std::size_t r = 0; r < 3; ++r)
                cofactor[3 * c + r] = a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3];
        }
        const Quad determinant = (f[0] * cofactor[0] + f[1] * cofactor[1]) + f[2] * cofactor[2];
        const Quad v = Quad::load(volumes);
        const Quad along = v * Quad::all(mu) * (one - one / (square + one)), across = v * Quad::all(lambda) * (determinant - Quad::all(alpha));
        for (std::size_t c = 0; c < 3; ++c) {
            Quad node[4] = {Quad::zero(), Quad::zero(), Quad::zero(), Quad::zero()};
            for (std::size_t r = 0; r < 3; ++r)
                node[r] = along * f[3 * c + r] + across * cofactor[3 * c + r];
            transpose(node);
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                double* column = stress + 12 * (first + lane) + 4 * c;
                (Quad::load(column) - node[lane]).store(column);
            }
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(add_neo_hookean_stress);

void add_neo_hookean_stress(double mu, double lambda, double alpha, std::span<const double> volume, const MatrixField& deformation,
                            MatrixField& stress) noexcept
{
    HWY_DYNAMIC_DISPATCH(add_neo_hookean_stress)(mu, lambda, alpha, volume.data(), volume.size(), deformation.data(), stress.data());
}

} // namespace cinch
#endif
