// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/schema.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned a_measure = a_number | or_null;

constexpr const char* required[] = {"experiment", "command", "commit", "seed", "cpu"};

constexpr RecordField all_fields[] = {
    // Every record.
    {"experiment", a_text, "the command whose record it is"},
    {"command", a_text, "the command line; without its arguments where rows of any machine were merged"},
    {"version", a_text, "of the program"},
    {"commit", a_text, "that the program was built from; -dirty: and changes of it"},
    {"compiler", a_text, "and its version"},
    {"flags", a_text, "of the compiler"},
    {"cpu", a_text, "the machine; any: rows that are the same on all"},
    {"simd_target", a_text, "instruction set of the kernels; any as above"},
    {"threads", a_count, "used; 0: any number"},
    {"seed", a_count, "of everything random"},
    {"frames_done", a_count, "frames that the record is of"},
    {"frames", a_count, "frames that were wanted"},
    {"complete", a_flag, "whether it is of all that was wanted"},
    {"partial", a_flag, "whether parts of the input are left out"},
    {"missing", a_list, "their names"},
    {"weights_normalised", a_count, "vertices whose weights were changed beyond rounding to make their sum 1"},
    {"largest_weight_change", a_number, "the largest such change of a weight"},
    {"load_report", a_list, "what was said of the input when it was read, a text each"},
    // What it is of.
    {"input", a_text, "shape, file or scene"},
    {"scene", a_text, "of several bodies"},
    {"body", a_text, "of a scene"},
    {"motion", a_text, "scripted motion or clip"},
    {"method", a_text, "of the bounds; several joined by +"},
    {"precision", a_text, "arithmetic of the bounds: float or double"},
    {"kdop", a_count, "directions of a bound"},
    {"passes", a_count, "evaluations of the dual function"},
    {"n", a_count, "simulation nodes"},
    {"nodes", a_count, "simulation nodes of all bodies"},
    {"vertices", a_count, "of the surface"},
    {"triangles", a_count, "of the surface"},
    {"bodies", a_count, "of a scene"},
    {"bvs", a_count, "BVs of the tree or the level"},
    {"level", a_count, "of the BVH, 0: the root"},
    {"bv", a_count, "number of a BV"},
    {"direction", a_signed_number, "of a BV's k-DOP, in the order of axes_of(k); -1: of none in particular"},
    {"frame", a_count, "number of a frame"},
    {"time_s", a_number, "of the frame, seconds"},
    {"neighbours", a_number, "of a simulation node, mean"},
    // Bounds over time.
    {"clip", a_text, "of a character or a file"},
    {"t0", a_number, "begin of an interval of time, s"},
    {"t1", a_number, "its end"},
    {"min", a_list, "least corner of a box"},
    {"max", a_list, "greatest corner"},
    {"supports", a_list, "of a k-DOP, in the order of axes_of(k)"},
    {"statement", a_text, "what is said of a bound"},
    {"time_ratio", a_number, "radius over an interval of time / that of the hull of bounds at instants, mean"},
    {"max_time_ratio", a_number, "the same, greatest"},
    {"leaf_ratio", a_number, "radius over a clip / the truth, mean of the leaves"},
    {"missed_30fps", a_number, "how far the surface leaves the boxes of frames at 30 per second, of its half diagonal"},
    {"missed_keys", a_number, "the same of boxes at key times"},
    {"missed", a_number, "the same of the bounds; 0"},
    {"key_segments", a_count, "intervals between keys"},
    {"intervals", a_count, "of time that a bound was put together from"},
    // Formulas of engines.
    {"formula", a_text, "for the bound of a whole character"},
    {"used_by", a_text, "the engine whose documentation has it"},
    {"instants", a_count, "at which it was tried"},
    {"worst_overflow", a_measure, "how far the surface is beyond the bound, at the worst counterexample"},
    {"worst_share", a_measure, "the same, of the surface's half diagonal"},
    {"worst_time", a_signed_number | or_null, "its time, s"},
    {"worst_vertex", a_count | or_null, "its vertex"},
    {"worst_direction", a_signed_number | or_null, "in the order of axes_of(6); -1: out of a ball"},
    {"centre", a_list | or_null, "of the ball"},
    {"ns_per_box", a_measure, "time of a bound, ns, median over rounds; null: there is one for the clip"},
    {"ns_per_box_low", a_measure, "lower quartile, ns"},
    {"ns_per_box_high", a_measure, "upper quartile, ns"},
    {"ns_per_joint", a_measure, "its time over the number of simulation nodes, ns"},
    {"crowd", a_count, "bodies of it"},
    {"boxes", a_count, "per body"},
    {"ns_per_body", a_measure, "time of a body's boxes, ns, median over rounds"},
    {"ns_per_body_low", a_measure, "lower quartile, ns"},
    {"ns_per_body_high", a_measure, "upper quartile, ns"},
    {"over_engine", a_measure, "time over that of the formula of engines, median over rounds"},
    {"over_engine_low", a_measure, "lower quartile"},
    {"over_engine_high", a_measure, "upper quartile"},
    {"area_ratio", a_measure, "area of a body's boxes over that of the engines' one"},
    {"threads_gain", a_measure, "how many times as fast on all threads as on one"},
    // Figures against targets.
    {"figure", a_text, "what was measured"},
    {"measured", a_text, "its value, as printed; ~: quartiles over 10 % apart"},
    {"target", a_text, "what it should be"},
    {"reached", a_flag | or_null, "whether it is; null: inconclusive"},
    {"verdict", a_text,
     "holds, fails, inconclusive (the target lies between the quartiles) or unknown; of a formula proven, holds (at "
     "all instants), refuted or undecided"},
    // Tightness: ratios are radius (half diagonal) of the bound over the true one.
    {"mean_ratio", a_measure, "bound radius / true radius, mean"},
    {"max_ratio", a_measure, "bound radius / true radius, greatest"},
    {"root_ratio", a_measure, "of the root, mean over frames"},
    {"root_max_ratio", a_measure, "of the root, greatest of the frames"},
    {"width_ratio", a_measure, "summed widths along the axes over the true ones, mean"},
    {"ratio", a_measure, "bound radius / true radius of one BV"},
    {"box_loss", a_signed_number | or_null | a_text,
     "what extrema of rest boxes give away, in true radii; as a text: an exact fraction, of one bound"},
    {"interval_loss", a_signed_number | or_null | a_text, "what weight intervals give away"},
    {"corner_loss", a_signed_number | or_null | a_text, "what the method gives away over the weight space"},
    {"method_loss", a_signed_number | or_null, "corner_loss and rounding_loss"},
    {"rounding_loss", a_signed_number | or_null | a_text, "what rounding gives away"},
    {"total_loss", a_text, "of one bound, an exact fraction"},
    // Times; *_low and *_high are the quartiles of the rounds.
    {"ns_per_bound", a_measure, "time of one BV's bound, ns, median over rounds"},
    {"ns_per_bound_low", a_measure, "lower quartile, ns"},
    {"ns_per_bound_high", a_measure, "upper quartile, ns"},
    {"over_default", a_measure, "time over the default's, median over rounds"},
    {"over_default_low", a_measure, "lower quartile"},
    {"over_default_high", a_measure, "upper quartile"},
    {"project_ns", a_measure, "time to project all transforms, once per frame, ns"},
    {"kind", a_text, "what the default chose for a BV"},
    {"cpu_share", a_number, "of the time that went by, what the measurement had a core for"},
    {"load", a_number, "of the machine, mean over a minute"},
    {"settled", a_flag, "whether the quartiles of ratio_to_double are at most 10 % apart"},
    {"paper_us", a_number, "the paper's, microseconds"},
    {"arithmetic", a_text, "of a contestant"},
    {"guarantee", a_text, "what is known of its error"},
    {"ratio_to_double", a_measure, "time over plain double's of the same method, median over rounds"},
    {"ratio_to_double_low", a_measure, "lower quartile"},
    {"ratio_to_double_high", a_measure, "upper quartile"},
    {"below_exact", a_measure, "share of supports below the exact value"},
    {"worst_below", a_measure, "by how much at most, in widths"},
    {"pareto", a_flag, "nothing else is as fast, as tight and as well proven, beyond the quartiles"},
    {"least_n", a_count, "fewest simulation nodes of the BVs"},
    {"most_n", a_count, "most simulation nodes of the BVs"},
    {"gap_percent", a_signed_number | or_null, "of the dual evaluation to the optimum, % of the width"},
    {"seconds", a_number, "that it took"},
    // Proofs.
    {"rest", a_text | a_list, "shape of rest boxes; of a fuzz case: vertices, hexadecimal floats"},
    {"update", a_text, "whose bounds: lazy, front or full"},
    {"bounds", a_count, "supports compared"},
    {"proven", a_count, "of these"},
    {"violated", a_count | a_flag, "of these; of a formula of an engine, whether it is"},
    {"infinite", a_count, "of the proven ones"},
    {"mean_n", a_measure, "simulation nodes per BV, mean"},
    {"filter_hit_rate", a_measure, "share decided by floating-point filters"},
    {"ladder_compared", a_count, "comparisons of limited <= eq12 <= convex"},
    {"ladder_broken", a_count, "of these, those that do not hold"},
    {"default_compared", a_count, "bounds of best compared with eq12"},
    {"default_above_eq12", a_count, "of these, above it"},
    {"default_clearly_above_eq12", a_count, "by over 1 % of its width"},
    {"packed_bytes", a_count, "what the kernels stream"},
    {"rest_bytes", a_count, "all rest data"},
    {"volume_measured", a_count, "BVs whose exact volumes were compared"},
    {"volume_flat", a_count, "of these, without a volume"},
    {"mean_volume_ratio", a_measure, "of the bound over the true k-DOP"},
    {"max_volume_ratio", a_measure, "the greatest"},
    {"redundant_planes", a_count, "planes of bounds without a facet"},
    {"attribution", a_text, "of what one bound gives away"},
    {"bound", a_text | a_signed_number | or_null,
     "its value, an exact fraction; of a formula, or the radius of a ball"},
    {"violated_statement", a_text, "exact or computed: which vertices lie outside"},
    {"detail", a_text, "of a violation"},
    {"by_methods", a_count, "BVs bounded by the methods"},
    {"merged", a_count, "BVs bounded by their children"},
    {"from_vertices", a_count, "BVs bounded by their vertices"},
    {"left", a_count, "BVs that the query did not need"},
    {"leaf_triangles", a_count, "most triangles per leaf"},
    // Corners of weight spaces.
    {"file", a_text, "of a case"},
    {"feasible", a_flag, "whether the weight space has a point"},
    {"vertex_count", a_text | or_null, "its corners, a whole number of any size"},
    {"vertex_count_reason", a_text, "why there is no count"},
    {"corners_listed", a_count, "corners printed"},
    {"corner", a_list, "one corner, fractions"},
    {"rows", a_list, "of each row of extrema: exact_max, convex, eq12, limited, exact fractions or hexadecimal floats"},
    // Collisions: times on one thread are of the process on a core.
    {"backend", a_text, "a way of finding pairs"},
    {"cold", a_flag, "whether caches were evicted before every frame"},
    {"rounds_done", a_count, "through all frames"},
    {"rounds", a_count, "wanted"},
    {"evaluate_ms", a_number, "all vertices, ms per frame, median"},
    {"update_ms", a_number, "bounds, ms per frame, median"},
    {"query_ms", a_number, "pairs, ms per frame, median"},
    {"total_ms", a_number, "all three, ms per frame, median"},
    {"total_ms_low", a_number, "least of the rounds' medians, ms"},
    {"total_ms_high", a_number, "greatest of the rounds' medians, ms"},
    {"pairs", a_number, "intersecting pairs of triangles per frame, median; of a proof: in all"},
    {"pairs_differing", a_count, "pairs that only one of two backends found"},
    {"pairs_of_frame", a_list, "pairs of each frame"},
    {"total_ms_of_frame", a_list, "total of each frame, ms"},
    {"megabytes_per_body", a_number, "kept besides surfaces and clips"},
    {"gain", a_measure, "time of refit-1 over this one's"},
    {"gain_low", a_measure, "lower quartile"},
    {"gain_high", a_measure, "upper quartile"},
    {"mean_bounds", a_number, "BVs bounded per frame"},
    {"mean_leaves", a_number, "leaves deformed per frame"},
    {"mean_vertices", a_number, "vertices deformed per frame"},
    {"mean_merged", a_number, "BVs merged per frame"},
    {"mean_box_tests", a_number, "pairs of BVs tested per frame"},
    {"mean_leaf_pairs", a_number, "pairs of leaves that overlap per frame"},
    {"mean_triangle_tests", a_number, "pairs of triangles tested per frame"},
    {"share_double", a_number, "of these, decided in double"},
    {"share_exact", a_number, "of these, decided exactly"},
    {"slope", a_text, "what grows with what"},
    {"exponent", a_signed_number | or_null, "of its growth"},
    // Simulation.
    {"effects", a_list, "names of the scene's effects"},
    {"effect", a_text, "one of them"},
    {"calls", a_count, "of the effect"},
    {"steps", a_count, "time steps"},
    {"substeps", a_count, "of explicit steps"},
    {"step", a_number, "seconds"},
    {"step_s", a_number, "longest time step, seconds"},
    {"iterations", a_count, "of Newton's method"},
    {"products", a_count, "of matrix and vector"},
    {"simulation", a_text, "a scene whose accuracy is measured"},
    {"substep", a_text, "a shape whose explicit substeps are timed"},
    {"integrator", a_text, "implicit or explicit"},
    {"ms_per_step", a_measure, "time of a step"},
    {"residual_m_per_s2", a_measure, "acceleration that a step left unsolved"},
    {"acceleration_m_per_s2", a_measure, "the greatest acceleration of that step"},
    {"failure", a_text, "why a step was not solved"},
    {"kinetic_j", a_number, "kinetic energy, J"},
    {"potential_j", a_signed_number, "potential energy, J"},
    {"energy", a_signed_number | or_null | a_text, "of the body, J"},
    {"error", a_measure | a_text, "against the finest step, or what failed"},
    {"seconds_per_simulated_second", a_measure, "time it took"},
    {"us_per_substep", a_number, "time of an explicit substep, microseconds"},
    {"plain_us_per_substep", a_number, "of the plain Eigen version"},
    {"difference_m", a_number, "of positions of the two, m"},
    // Hard cases and fuzzing.
    {"case", a_text, "name of a hard case"},
    {"expected", a_text, "of it"},
    {"observed", a_text, "of it"},
    {"pass", a_flag, "whether that is as expected"},
    {"cases", a_count, "run"},
    {"violations", a_count, "of these"},
    {"family", a_text, "of cases; empty: all"},
    {"shard", a_count, "of a run in shards"},
    {"shards", a_count, "how many"},
    {"index", a_count, "number of a case"},
    {"saved", a_text, "where the shrunk case is"},
    {"fault", a_text, "what is wrong"},
    {"l", a_list, "least weights, hexadecimal floats"},
    {"h", a_list, "greatest weights"},
    {"b", a_list, "rows of extrema"},
    {"weights", a_list, "of each vertex, dense"},
    {"maps", a_list, "transforms of the simulation nodes, row-major"},
    {"trial", a_count, "which methods were tried"},
    // Views and stored results.
    {"view", an_object, "all that a page draws"},
    {"stage", a_text, "an experiment of reproduce"},
    {"what", a_text, "it measures"},
    {"lines", a_count, "of its file"},
    {"status", a_count, "exit status of its command"},
    {"measured_by", a_text, "its command line"},
    {"quick", a_flag, "of a quick run"},
    {"finished", a_text, "when, UTC"},
    {"checksum", a_text, "of all lines before, hexadecimal"},
};

bool fits(const Json& value, unsigned type)
{
    if (value.is_number())
        return (type & a_signed_number) || ((type & a_number) && value.get<double>() >= 0) ||
               ((type & a_count) && value.is_number_unsigned());
    return (value.is_string() && (type & a_text)) || (value.is_boolean() && (type & a_flag)) ||
           (value.is_array() && (type & a_list)) || (value.is_object() && (type & an_object)) ||
           (value.is_null() && (type & or_null));
}

// "a text or null"
std::string words_of(unsigned type)
{
    constexpr std::array<std::pair<unsigned, const char*>, 8> words{{{a_text, "a text"},
                                                                     {a_count, "a count"},
                                                                     {a_number, "a number from 0 on"},
                                                                     {a_signed_number, "a number"},
                                                                     {a_flag, "true or false"},
                                                                     {a_list, "a list"},
                                                                     {an_object, "an object"},
                                                                     {or_null, "null"}}};
    std::string out;
    for (const auto& [one, word] : words)
        if (type & one)
            out += (out.empty() ? "" : " or ") + std::string(word);
    return out;
}

} // namespace

std::span<const RecordField> record_fields() { return all_fields; }

std::span<const char* const> required_fields() { return required; }

std::string fault_of(const Json& record)
{
    if (!record.is_object())
        return "expected a JSON object";
    for (const char* name : required)
        if (!record.contains(name))
            return fmt::format("has no \"{}\", so it cannot be traced", name);
    for (const RecordField& field : all_fields)
        if (const auto value = record.find(field.name); value != record.end() && !fits(*value, field.type)) {
            const std::string found = value->dump(-1, ' ', true, Json::error_handler_t::replace);
            return fmt::format("\"{}\" must be {}, not {}", field.name, words_of(field.type), found.substr(0, 40));
        }
    return "";
}

Json record_schema()
{
    Json properties = Json::object();
    for (const RecordField& field : all_fields) {
        Json types = Json::array();
        for (const auto& [type, name] :
             {std::pair(a_text, "string"), std::pair(a_flag, "boolean"), std::pair(a_list, "array"),
              std::pair(an_object, "object"), std::pair(or_null, "null")})
            if (field.type & type)
                types.push_back(name);
        if (field.type & (a_number | a_signed_number))
            types.push_back("number");
        else if (field.type & a_count)
            types.push_back("integer");
        Json property{{"type", types.size() == 1 ? types[0] : types}, {"description", field.what}};
        if (field.type & (a_number | a_count))
            property["minimum"] = 0;
        properties[field.name] = std::move(property);
    }
    return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"title", "A record of cinch: one line of --json"},
            {"type", "object"},
            {"required", required},
            {"properties", properties},
            {"additionalProperties", false}};
}

int print_schema()
{
    fmt::print("{}\n", record_schema().dump(2));
    return 0;
}

} // namespace cinch
