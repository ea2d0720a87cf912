// SPDX-License-Identifier: GPL-3.0-or-later
// The raw bytes of a case: any weight intervals, extrema, rest positions and transforms that are finite. The toolkit's
// bounds are compared with the exact side; a fault ends the run, and the input is the case.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "experiments/fuzz/fuzz_case.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace {

using namespace cinch;

class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
    std::uint8_t byte()
    {
        if (left_ == 0)
            return 0;
        --left_;
        return *at_++;
    }
    double finite()
    {
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i)
            bits = bits << 8 | byte();
        double x;
        std::memcpy(&x, &bits, sizeof x);
        return std::isfinite(x) ? x : 0;
    }
    double weight() // in [0, 1]
    {
        const double x = std::abs(finite());
        return x <= 1 ? x : 1 / x;
    }

private:
    const std::uint8_t* at_;
    std::size_t left_;
};

FuzzCase case_from(Bytes bytes)
{
    FuzzCase c;
    c.family = "bytes";
    const std::uint8_t kind = bytes.byte();
    const std::size_t n = 1 + kind / 2 % 12;
    if (kind % 2 == 0) {
        c.space.b.resize(1);
        for (std::size_t j = 0; j < n; ++j) {
            const double a = bytes.weight(), b = bytes.weight();
            c.space.l.push_back(std::min(a, b));
            c.space.h.push_back(std::max(a, b));
            c.space.b[0].push_back(bytes.finite());
        }
        return c;
    }
    static constexpr int kdops[] = {6, 14, 18, 26};
    const std::uint8_t shape = bytes.byte();
    c.kdop = kdops[shape % 4];
    for (std::size_t j = 0; j < n; ++j) {
        c.maps.emplace_back();
        for (auto& row : c.maps.back().m)
            for (double& x : row)
                x = bytes.finite();
    }
    for (std::size_t k = 0; k < 1 + shape / 4 % 5u; ++k) {
        c.rest.emplace_back(bytes.finite(), bytes.finite(), bytes.finite());
        std::vector<double> w;
        for (std::size_t j = 0; j < n; ++j)
            w.push_back(bytes.weight());
        w[k % n] += 0x1p-20;
        round_dyadic(w);
        c.weights.push_back(w);
    }
    return c;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const FuzzCase problem = case_from({data, size});
    if (const std::string fault = find_fault(problem, Defect::none); !fault.empty()) {
        std::fprintf(stderr, "%s\n", to_json(problem, fault).c_str());
        std::abort();
    }
    return 0;
}
