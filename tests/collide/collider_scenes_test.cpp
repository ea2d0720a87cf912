// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes that are shipped, simulated for some frames, and the reference meshes.
#include <map>

#include <catch2/catch.hpp>

#include "tests/collide/random_bodies.hpp"
#include "tests/support.hpp"
#include "toolkit/simulate/simulation.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

struct Tested {
    LazyOptions options;
    ClusterSize leaf{16, 16};
};

LazyOptions lazy(Methods methods, int kdop, Precision precision = Precision::float32)
{
    LazyOptions options;
    options.methods = methods;
    options.kdop = kdop;
    options.precision = precision;
    options.update = Update::lazy;
    return options;
}

std::vector<Tested> some_options()
{
    std::vector<Tested> all;
    all.push_back({{}, {16, 16}});
    all.push_back({lazy(Method::best, 14), {16, 16}});
    all.push_back({lazy(Method::linear, 26, Precision::float64), {8, 8}});
    all.push_back({lazy(Method::eq12, 18), {1, 3}});
    all.push_back({{}, {4, 4}});
    all[3].options.lanes = 4;
    all[4].options.keep_cut = false;
    all[4].options.lanes = 4;
    all.push_back({{}, {16, 16}});
    all[5].options.update = Update::full;
    return all;
}

// Every option on every frame; returns how many pairs there were in all.
std::size_t check_all(const Bodies& bodies, const std::vector<Tested>& all = some_options())
{
    const std::vector<Pairs> truth = bodies.truth();
    std::size_t pairs = 0;
    for (const Pairs& some : truth)
        pairs += some.size();
    std::map<std::pair<std::size_t, bool>, std::vector<Bvh>>
        trees_of; // by the size of leaves, and whether boxes will do
    for (const Tested& tested : all) {
        const bool boxes = tested.options.methods.within(box_methods);
        std::vector<Bvh>& trees = trees_of[{tested.leaf.triangles, boxes}];
        if (trees.empty())
            trees = bodies.trees(tested.leaf, boxes ? RestDetail::boxes : RestDetail::inner);
        Collider collider(tested.options);
        for (std::size_t b = 0; b < trees.size(); ++b)
            collider.add(trees[b], bodies.surface[b]);
        for (std::size_t f = 0; f < bodies.frame.size(); ++f) {
            collider.update(bodies.frame[f]);
            const Pairs found = sorted(collider.pairs());
            INFO(name_of(tested.options.methods)
                 << ", k " << tested.options.kdop << ", leaves of " << tested.leaf.triangles << ", frame " << f << ": "
                 << difference(truth[f], found));
            REQUIRE((found == truth[f]));
        }
    }
    return pairs;
}

// Frames [first, last) in steps.
Bodies simulated(const std::string& scene, std::size_t first, std::size_t last, std::size_t step)
{
    const std::string folder = std::string(CINCH_DATA) + "/scenes";
    Simulation simulation(parse_scene(read_bytes(folder + "/" + scene + ".json"), scene, folder), scene);
    Bodies out;
    for (const Simulation::Body& body : simulation.bodies())
        out.surface.push_back(*body.simulation.surface());
    for (std::size_t f = 0; f < last; ++f) {
        if (f >= first && (f - first) % step == 0) {
            std::vector<Maps> maps;
            for (Simulation::Body& body : simulation.bodies())
                maps.push_back(body.simulation.frame());
            out.add_frame(maps);
        }
        for (const StepReport& report : simulation.advance())
            REQUIRE(report.failure.empty());
    }
    return out;
}

// A body of one scene against itself as it was before.
Bodies against_its_past(const Bodies& bodies)
{
    Bodies out;
    out.surface = {bodies.surface[0], bodies.surface[0]};
    for (std::size_t f = 1; f < bodies.frame.size(); ++f)
        out.add_frame({bodies.maps[f][0], bodies.maps[f - 1][0]});
    return out;
}

} // namespace

// Whose trees are soon built.
const Tested simple{lazy(Method::eq12, 6), {16, 16}};
// By default some of the frames and options; above a share of 1 many; little below.
const bool thorough = test_share() > 1, quick = test_share() < 1;

TEST_CASE("small rings and fish: pairs of brute force on frames of all of the motion")
{
    std::size_t pairs = 0;
    const auto options = some_options();
    for (const char* scene : {"santa-ring-1", "santa-ring-2", "santa-ring-5", "santa-ring-6"}) {
        INFO(scene);
        const bool alternatives = std::string(scene) == "santa-ring-5";
        const bool slow = std::string(scene) == "santa-ring-2" || std::string(scene) == "santa-ring-6"; // to simulate
        pairs += check_all(simulated(scene, 0,
                                     quick               ? 2
                                     : slow && !thorough ? 30
                                                         : 91,
                                     thorough ? 3 : 9),
                           thorough       ? options
                           : alternatives ? std::vector{options[0], options[3]}
                                          : std::vector{options[0]});
        if (quick)
            return;
    }
    CHECK(pairs > 10000);
    CHECK(check_all(simulated("fishes", 80, 121, thorough ? 5 : 20), thorough ? options : std::vector{simple}) > 200);
}

TEST_CASE("large rings: pairs of brute force")
{
    if (quick)
        return;
    std::size_t pairs = 0;
    for (const char* scene : {"santa-ring-7", "santa-ring-3", "santa-ring-4", "santa-ring-8"}) {
        INFO(scene);
        pairs += check_all(simulated(scene, 0, 22, 7),
                           thorough ? std::vector{some_options()[0], simple} : std::vector{simple});
        if (!thorough)
            break;
    }
    CHECK(pairs > 10000);
}

TEST_CASE("scenes of one body: pairs of brute force with itself some time before")
{
    const auto options = some_options();
    for (const char* scene : {"beam", "sheet", "skin", "twist-180", "brain-pull-65", "brain-pull-225", "brain-pull"}) {
        INFO(scene);
        CHECK(check_all(against_its_past(simulated(scene, 0, quick ? 25 : 61, 12)),
                        thorough ? options : std::vector{options[0]}) > (quick ? 50u : 100u));
        if (!thorough && std::string(scene) == (test_share() < 0.1 ? "sheet" : "brain-pull-65"))
            break;
    }
}

TEST_CASE("a brain through a fish, and a folded brain through its coarse form: pairs of brute force")
{
    const auto folder = shared("meshes");
    if (!folder || quick)
        return;
    auto mesh = [&](const char* name) {
        TriangleMesh m = read_mesh(*folder / name).mesh;
        centre_and_scale(m, 1);
        return m;
    };
    const auto random_poses = [](Bodies& bodies, std::uint64_t seed, int frames, double strength) {
        Dice dice(seed);
        for (int f = 0; f < frames; ++f) {
            std::vector<Maps> maps;
            for (const DeformableSurface& s : bodies.surface)
                maps.push_back(around(dice, s.weights.node_count, dice.rotation(), 0.4 * dice.point(), strength));
            bodies.add_frame(maps);
        }
    };
    Bodies small;
    small.surface.push_back(soft(mesh("brain_conte69_lh_3500.off"), 65));
    small.surface.push_back(soft(mesh("fish_blub_7106.obj"), 40));
    random_poses(small, 41, 6, 0.03);
    CHECK(check_all(small, thorough ? some_options()
                                    : std::vector{some_options()[0], some_options()[2], some_options()[4]}) > 1000);
    Bodies large;
    large.surface.push_back(soft(mesh("brain_conte69_lh_30000.ply"), 200));
    large.surface.push_back(soft(mesh("fish_blub_8000.off"), 60));
    large.surface.push_back(soft(mesh("brain_fsaverage5_pial_lh_10242.ply"), 80));
    random_poses(large, 42, thorough ? 40 : 4, 0.01);
    CHECK(check_all(large, {thorough ? some_options()[0] : simple}) > 5000);

    // At rest on top of each other: 3500 of the vertices are near the others' surface everywhere.
    Bodies folded;
    folded.surface.push_back(rigid(read_mesh(*folder / "brain_conte69_lh_3500.off").mesh));
    folded.surface.push_back(rigid(read_mesh(*folder / "brain_conte69_lh_32492.ply").mesh));
    folded.add_frame({Maps(1, identity_map), Maps(1, identity_map)});
    folded.add_frame({Maps(1, identity_map), Maps(1, moved_by({0.5, 0, 0}))});
    CHECK(check_all(folded, {some_options()[0]}) > 10000);
}

TEST_CASE("a captured kick, given by its vertices, through itself at other times: pairs of brute force")
{
    const auto folder = shared("meshes");
    if (!folder || quick)
        return;
    Bodies bodies;
    std::vector<Positions> pose;
    for (const char* name :
         {"kick_000.ply", "kick_020.ply", "kick_040.ply", "kick_060.ply", "kick_080.ply", "kick_100.ply"}) {
        const TriangleMesh mesh = read_mesh(*folder / "sequence" / name).mesh;
        pose.push_back(mesh.vertices);
        if (bodies.surface.empty())
            bodies.surface.assign(3, rigid(mesh));
    }
    for (std::size_t f = 0; f < pose.size(); ++f) {
        std::vector<Positions> three{pose[f], pose[(f + 1) % 6],
                                     pose[f]}; // one of them beside itself, and for a frame in the same place
        for (Vec3& x : three[2])
            x += (f == 3 ? 0.0 : 0.05) * Vec3(1, 0.2, 0.7);
        bodies.add_positions(three);
    }
    CHECK(check_all(bodies, thorough ? some_options() : std::vector{some_options()[0], some_options()[1]}) > 10000);
}

TEST_CASE("meshes with holes, points, segments, self-intersections: through each other, pairs of brute force")
{
    const auto folder = shared("meshes");
    if (!folder || quick)
        return;
    Bodies bodies;
    for (const char* name : {"nasty_spider.obj", "nasty_wuson.off", "nasty_cycloidal.ply", "nasty_spider.obj"}) {
        TriangleMesh mesh = read_mesh(*folder / name).mesh;
        centre_and_scale(mesh, 1);
        bodies.surface.push_back(soft(std::move(mesh), 20));
    }
    Dice dice(43);
    for (int f = 0; f < 6; ++f) {
        std::vector<Maps> maps;
        for (int b = 0; b < 4; ++b)
            maps.push_back(around(dice, 20, dice.rotation(), 0.3 * dice.point(), f % 2 ? 0.05 : 0));
        if (f >= 4)
            maps[3] = maps[0]; // in the same place
        bodies.add_frame(maps);
    }
    CHECK(check_all(bodies, thorough ? some_options() : std::vector{some_options()[0], some_options()[4]}) > 10000);
}

TEST_CASE("characters that dance through each other: pairs of brute force")
{
    const auto folder = shared("meshes");
    if (!folder || quick)
        return;
    Bodies bodies;
    std::vector<Clip> clips;
    std::vector<double> size;
    for (const std::string name : {"CesiumMan", "Fox", "RiggedFigure", "robot"}) {
        DeformableSurface s{read_mesh(*folder / "skin" / (name + ".rest.off")).mesh, {}};
        s.weights = to_dyadic(read_weights_text(*folder / "skin" / (name + ".weights.txt"), s.mesh.vertices.size()));
        clips.push_back(read_clips_text(*folder / "skin" / (name + ".frames.txt"), s.weights.node_count)[0]);
        size.push_back(extent(s.mesh).longest_half);
        bodies.surface.push_back(std::move(s));
    }
    for (std::size_t f = 0; f < 20; ++f) {
        std::vector<Maps> maps;
        for (std::size_t b = 0; b < 4; ++b) {
            maps.push_back(clips[b].frame(3 * f % clips[b].frame_count()));
            for (AffineMap& map : maps.back()) // all as large as the man
                for (auto& row : map.m)
                    for (double& x : row)
                        x *= size[0] / size[b];
        }
        bodies.add_frame(maps);
    }
    CHECK(check_all(bodies) > 1000);
}
