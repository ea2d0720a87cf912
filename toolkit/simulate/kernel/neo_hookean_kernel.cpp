// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/kernel/neo_hookean_kernel.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/simulate/kernel/neo_hookean_kernel.cpp"
#include <hwy/foreach_target.h>

#include "toolkit/deform/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// Four nodes at a time: a Quad holds one entry of their matrices.
void add_neo_hookean_stress(double mu, double lambda, const double* volume, std::size_t count, const double* rotation,
                            const double* strain, double* stress)
{
    const Quad four = Quad::all(4);
    Quad turn[9];
    for (std::size_t k = 0; k < 9; ++k)
        turn[k] = Quad::all(rotation[k]);
    for (std::size_t first = 0; first < count; first += 4) {
        const std::size_t lanes = count - first < 4 ? count - first : 4;
        HWY_ALIGN double volumes[4] = {};
        for (std::size_t lane = 0; lane < lanes; ++lane)
            volumes[lane] = volume[first + lane];
        Quad h[9], cofactor[9];
        for (std::size_t c = 0; c < 3; ++c) {
            Quad node[4];
            for (std::size_t lane = 0; lane < 4; ++lane)
                node[lane] = lane < lanes ? Quad::load(strain + 12 * (first + lane) + 4 * c) : Quad::all(0);
            transpose(node);
            for (std::size_t r = 0; r < 3; ++r)
                h[3 * c + r] = node[r];
        }
        const Quad trace = (h[0] + h[4]) + h[8];
        Quad square = h[0] * h[0];
        for (std::size_t k = 1; k < 9; ++k)
            square = square + h[k] * h[k];
        for (std::size_t c = 0; c < 3; ++c) { // column c is the cross product of the two that follow
            const Quad *a = h + 3 * ((c + 1) % 3), *b = h + 3 * ((c + 2) % 3);
            for (std::size_t r = 0; r < 3; ++r)
                cofactor[3 * c + r] = a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3];
        }
        const Quad determinant = (h[0] * cofactor[0] + h[1] * cofactor[1]) + h[2] * cofactor[2];
        const Quad j = (trace + ((cofactor[0] + cofactor[4]) + cofactor[8])) + determinant;
        const Quad delta = (trace + trace) + square;
        const Quad v = Quad::load(volumes);
        const Quad shear = v * Quad::all(0.75 * mu), along = v * (Quad::all(mu) * delta / (four * (four + delta))),
                   across = v * (Quad::all(lambda) * j);
        Quad p[9];
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < 3; ++r) {
                const std::size_t k = 3 * c + r;
                Quad change = cofactor[k] - h[3 * r + c]; // of the cofactor: tr H I − Hᵀ + cof H
                if (r == c)
                    change = change + trace;
                p[k] = shear * (h[k] - change) + along * h[k] + across * change;
                if (r == c)
                    p[k] = p[k] + (along + across);
            }
        for (std::size_t c = 0; c < 3; ++c) {
            Quad node[4] = {Quad::all(0), Quad::all(0), Quad::all(0), Quad::all(0)};
            for (std::size_t r = 0; r < 3; ++r)
                node[r] = fma(turn[6 + r], p[3 * c + 2], fma(turn[3 + r], p[3 * c + 1], turn[r] * p[3 * c]));
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

void add_neo_hookean_stress(double mu, double lambda, std::span<const double> volume, const Mat3& rotation,
                            const MatrixField& strain, MatrixField& stress) noexcept
{
    HWY_DYNAMIC_DISPATCH(add_neo_hookean_stress)
    (mu, lambda, volume.data(), volume.size(), rotation.data(), strain.data(), stress.data());
}

} // namespace cinch
#endif
