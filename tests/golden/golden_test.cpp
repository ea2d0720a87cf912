// SPDX-License-Identifier: GPL-3.0-or-later
// The bits of bounds, pairs and simulated frames on fixed scenes: golden.txt has a line for each, a name and a hash of
// what it is of. The same on every target, with every compiler and optimisation. What changes bits on purpose writes
// the file anew: CINCH_GOLDEN=write test_golden.
#include <bit>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>

#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "cinch/collider.hpp"
#include "cinch/refit.hpp"
#include "tests/support.hpp"
#include "toolkit/deform/kernel/targets.hpp"
#include "toolkit/simulate/simulation.hpp"

using namespace cinch;

namespace {

// FNV-1a over the bytes of numbers, least significant first.
class Hash {
public:
    void add(std::uint64_t bits)
    {
        for (int i = 0; i < 8; ++i, bits >>= 8)
            value_ = (value_ ^ (bits & 0xff)) * 0x100000001b3;
    }
    void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
    void add(const AffineMap& map)
    {
        for (const auto& row : map.m)
            for (const double x : row)
                add(x);
    }
    std::string text() const
    {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value_));
        return digits;
    }

private:
    std::uint64_t value_ = 0xcbf29ce484222325;
};

std::map<std::string, std::string> recorded()
{
    std::map<std::string, std::string> all;
    std::ifstream in(CINCH_GOLDEN_FILE);
    for (std::string hash, name; in >> hash && std::getline(in >> std::ws, name);)
        all[name] = hash;
    return all;
}

bool is_writing()
{
    const char* const mode = std::getenv("CINCH_GOLDEN");
    return mode && std::string(mode) == "write";
}

// Compares with golden.txt, or keeps for it.
class Golden {
public:
    void check(const std::string& name, const Hash& hash)
    {
        static std::map<std::string, std::string> all = recorded();
        if (is_writing()) {
            all[name] = hash.text();
            std::ofstream out(CINCH_GOLDEN_FILE);
            for (const auto& [n, h] : all)
                out << h << ' ' << n << '\n';
            return;
        }
        INFO(name << " on " << kernel_target());
        CHECK(all[name] == hash.text());
    }
};

// Multiples of 2^-20, so that no function of the mathematical library has a say.
struct Drawn {
    DeformableSurface surface;
    std::vector<std::vector<AffineMap>> frames;
};

// A bumpy grid over a cube's side, each vertex moved by its nearest nodes of a coarser grid, whose maps turn, shear,
// grow and shift at random.
Drawn drawn(std::size_t side, std::size_t nodes_a_side, std::uint64_t seed, Vec3 at)
{
    std::mt19937_64 random(seed);
    auto uniform = [&](double most) { return most * (static_cast<double>(random() >> 43) * 0x1p-20 - 1); };
    Drawn out;
    TriangleMesh& mesh = out.surface.mesh;
    const double step = 1.0 / static_cast<double>(std::bit_ceil(side));
    for (std::size_t i = 0; i <= side; ++i)
        for (std::size_t j = 0; j <= side; ++j)
            mesh.vertices.push_back(
                at + Vec3(static_cast<double>(i) * step, static_cast<double>(j) * step, uniform(0.0625)));
    for (std::size_t i = 0; i < side; ++i)
        for (std::size_t j = 0; j < side; ++j) {
            const auto v = static_cast<std::uint32_t>(i * (side + 1) + j), w = static_cast<std::uint32_t>(v + side + 1);
            mesh.triangles.push_back({v, v + 1, w});
            mesh.triangles.push_back({v + 1, w + 1, w});
        }
    Influences influences;
    influences.node_count = static_cast<std::uint32_t>(nodes_a_side * nodes_a_side);
    influences.row = {0};
    const double to_nodes = static_cast<double>(nodes_a_side - 1) / static_cast<double>(side);
    for (std::size_t i = 0; i <= side; ++i)
        for (std::size_t j = 0; j <= side; ++j) {
            const double x = static_cast<double>(i) * to_nodes, y = static_cast<double>(j) * to_nodes;
            const auto a = std::min(static_cast<std::size_t>(x), nodes_a_side - 2),
                       b = std::min(static_cast<std::size_t>(y), nodes_a_side - 2);
            const double u = x - static_cast<double>(a), v = y - static_cast<double>(b);
            const double weight[4] = {(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v};
            for (std::size_t c = 0; c < 4; ++c) {
                influences.node.push_back(static_cast<std::uint32_t>((a + c / 2) * nodes_a_side + b + c % 2));
                influences.weight.push_back(weight[c]);
            }
            influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
        }
    out.surface.weights = to_dyadic(influences);
    for (const double strength : {0.0, 0.25, 2.0}) {
        std::vector<AffineMap> maps(influences.node_count, identity_map);
        for (AffineMap& map : maps)
            for (auto& row : map.m)
                for (double& value : row)
                    value += uniform(strength / 4);
        out.frames.push_back(std::move(maps));
    }
    return out;
}

const std::vector<Methods> methods = [] {
    std::vector<Methods> all(all_methods.begin(), all_methods.end());
    all.push_back(Method::local | Method::support);
    return all;
}();

void hash_bounds(Golden& golden, const std::string& scene, const Drawn& body)
{
    const Bvh bvh = build_bvh(body.surface, 4);
    for (const Methods method : methods)
        for (const Precision precision : {Precision::float32, Precision::float64})
            for (const int k : kdops)
                for (const Rounding rounding : {Rounding::proven, Rounding::plain}) {
                    if (rounding == Rounding::plain && k != 6)
                        continue;
                    RefitOptions options{method, k, rounding, precision};
                    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(k));
                    Refitter refitter(bvh, body.surface, options);
                    Hash hash;
                    for (const auto& maps : body.frames) {
                        refitter(maps, supports);
                        for (const double s : supports)
                            hash.add(s);
                    }
                    golden.check("bounds of " + scene + ", " + name_of(method) + ", " +
                                     std::string(name_of(precision)) + ", k = " + std::to_string(k) +
                                     (rounding == Rounding::plain ? ", unproven" : ""),
                                 hash);
                }
    for (const Method method : {Method::eq12, Method::limited}) {
        std::vector<double> supports(bvh.bvs.size() * 6);
        Hash hash;
        for (const auto& maps : body.frames) {
            refit(bvh, body.surface, maps, {method, 6, Rounding::proven, Precision::float32, 1, RestShape::obb},
                  supports);
            for (const double s : supports)
                hash.add(s);
        }
        golden.check("bounds of " + scene + ", " + std::string(name_of(method)) + ", oriented boxes", hash);
    }
    Hash hash;
    Refitter refitter(bvh, body.surface,
                      {Method::best, 6, Rounding::proven, Precision::float32, 3, RestShape::aabb, true});
    std::vector<double> supports(bvh.bvs.size() * 6);
    for (const auto& maps : body.frames) {
        refitter(maps, supports);
        for (const double s : supports)
            hash.add(s);
    }
    golden.check("bounds of " + scene + ", best, 3 passes, remembered", hash);
}

// Runs `test` on every instruction set of this machine.
template <class F> void on_every_target(F&& test)
{
    for (const std::string& target : kernel_targets()) {
        REQUIRE(force_kernel_target(target));
        test();
    }
    force_kernel_target("");
}

} // namespace

TEST_CASE("bounds keep their bits")
{
    Golden golden;
    const Drawn few = drawn(12, 3, 1, Vec3(0, 0, 0)), many = drawn(24, 16, 2, Vec3(1000, -20, 3));
    on_every_target([&] {
        hash_bounds(golden, "few nodes", few);
        hash_bounds(golden, "many nodes, far from the origin", many);
    });
}

TEST_CASE("pairs keep their order")
{
    Golden golden;
    const Drawn bodies[] = {drawn(20, 5, 3, Vec3(0, 0, 0)), drawn(20, 5, 4, Vec3(0.25, 0.125, 0)),
                            drawn(9, 4, 5, Vec3(-0.25, 0.25, 0.03125))};
    on_every_target([&] {
        for (const Method method : {Method::best, Method::eq12, Method::vertices})
            for (const Precision precision : {Precision::float32, Precision::float64}) {
                LazyOptions options;
                options.methods = method;
                options.precision = precision;
                Collider collider(options);
                for (const Drawn& body : bodies)
                    collider.add(build_bvh(body.surface, ClusterSize{}), body.surface);
                Hash hash;
                for (std::size_t f = 0; f < bodies[0].frames.size(); ++f) {
                    std::vector<BodyFrame> frames;
                    for (const Drawn& body : bodies)
                        frames.push_back({body.frames[f], {}});
                    collider.update(frames);
                    const auto pairs = collider.pairs();
                    hash.add(std::uint64_t{pairs.size()});
                    for (const TrianglePair& p : pairs) {
                        hash.add(std::uint64_t{p.body_a} << 32 | p.body_b);
                        hash.add(std::uint64_t{p.triangle_a} << 32 | p.triangle_b);
                    }
                }
                golden.check("pairs, " + std::string(name_of(method)) + ", " + std::string(name_of(precision)), hash);
            }
    });
}

TEST_CASE("simulated frames keep their bits")
{
    Golden golden;
    for (const char* const name : {"beam", "brain-pull-65", "fishes", "pile", "sheet", "skin", "twist-180"}) {
        const std::string folder = std::string(CINCH_DATA) + "/scenes", file = folder + "/" + name + ".json";
        std::ifstream in(file);
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        Simulation simulation(parse_scene(text, file, folder), file);
        Hash hash;
        for (int frame = 0; frame < 3; ++frame) {
            for (const StepReport& report : simulation.advance())
                REQUIRE(report.failure.empty());
            for (Simulation::Body& body : simulation.bodies())
                for (const AffineMap& map : body.simulation.frame())
                    hash.add(map);
        }
        golden.check(std::string("three frames of ") + name, hash);
    }
}
