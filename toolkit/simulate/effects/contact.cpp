// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/contact.hpp"

#include <cmath>
#include <limits>

#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/contact_points.hpp"
#include "toolkit/simulate/contact_search.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* contact_name = "contact";
const ContactPoints points;

// A contact in a Memory: corners (whole numbers below 2³², which doubles hold), shares, normal, offset and stiffness,
// and 0.
constexpr std::size_t record = 12;

std::size_t count_of(const Memory& memory) { return memory.values.size() / record; }

Contact contact_of(const Memory& memory, std::size_t k)
{
    const double* v = memory.values.data() + record * k;
    auto corner = [&](std::size_t i) { return static_cast<std::uint32_t>(v[i]); };
    return {{corner(0), corner(1), corner(2)}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}, v[9], v[10]};
}

template <class Visit> void each_contact(const Memory& memory, const Visit& visit)
{
    for (std::size_t k = 0; k < count_of(memory); ++k)
        visit(contact_of(memory, k));
}

Vec3 normal_of(const Contact& c) { return Eigen::Map<const Vec3>(c.normal.data()); }

// Of the planes, seen from the reference's.
Vec3 origin_of(const Configuration& at) { return at.reference.relative(at.remembered().reference.origin); }

double depth(const Configuration& at, const Contact& c, const Vec3& origin)
{
    Vec3 p = -origin;
    for (std::size_t i = 0; i < 3; ++i)
        p += c.share[i] * points.place(at, c.corner[i]);
    return c.offset - normal_of(c).dot(p);
}

void push(const Configuration& at, const Contact& c, double size, Forces out)
{
    for (std::size_t i = 0; i < 3; ++i)
        if (c.share[i] > 0)
            points.add_force(at, c.corner[i], c.share[i] * size * normal_of(c), out);
}

template <class Visit> void each_weight(const Configuration& at, const Contact& c, const Visit& visit)
{
    for (std::size_t i = 0; i < 3; ++i)
        points.each_weight(at, c.corner[i],
                           [&](std::uint32_t node, double weight) { visit(node, c.share[i] * weight); });
}

} // namespace

BodyContact::BodyContact() : Effect(contact_name) {}

Memory BodyContact::remembering(std::span<const Contact> contacts, const Vec3& origin)
{
    Memory memory;
    memory.reference.origin = origin;
    for (const Contact& c : contacts) {
        for (const std::uint32_t corner : c.corner)
            memory.values.push_back(corner);
        memory.values.insert(memory.values.end(), c.share.begin(), c.share.end());
        memory.values.insert(memory.values.end(), c.normal.begin(), c.normal.end());
        memory.values.insert(memory.values.end(), {c.offset, c.stiffness, 0});
    }
    return memory;
}

double BodyContact::energy(const Configuration& at) const
{
    const Vec3 origin = origin_of(at);
    double sum = 0;
    each_contact(at.remembered(), [&](const Contact& c) {
        if (const double d = depth(at, c, origin); d > 0)
            sum += 0.5 * c.stiffness * d * d;
    });
    return sum;
}

void BodyContact::add_forces(const Configuration& at, Forces out) const
{
    const Vec3 origin = origin_of(at);
    each_contact(at.remembered(), [&](const Contact& c) {
        if (const double d = depth(at, c, origin); d > 0)
            push(at, c, c.stiffness * d, out);
    });
}

/// Here a point is a contact.
void BodyContact::find_touching(const Configuration& at, bool worst, std::vector<Touch>& touching) const
{
    const Vec3 origin = origin_of(at);
    for (std::size_t k = 0; k < count_of(at.remembered()); ++k)
        if (const Contact c = contact_of(at.remembered(), k); worst || depth(at, c, origin) > 0)
            touching.push_back({k, c.stiffness, 0});
}

void BodyContact::add_product(const Configuration& at, std::span<const Touch> touching, const Field& dx,
                              const MatrixField& dj, Forces out) const
{
    for (const Touch& t : touching) {
        const Contact c = contact_of(at.remembered(), t.point);
        double along = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (c.share[i] > 0)
                along += c.share[i] * normal_of(c).dot(points.change(at, c.corner[i], dx, dj));
        push(at, c, -c.stiffness * along, out);
    }
}

void BodyContact::add_diagonal(const Configuration& at, std::span<const Touch> touching, std::vector<Mat3>& block) const
{
    for (const Touch& t : touching) {
        const Contact c = contact_of(at.remembered(), t.point);
        const Mat3 along = c.stiffness * normal_of(c) * normal_of(c).transpose();
        each_weight(at, c, [&](std::uint32_t node, double weight) { block[node] += weight * weight * along; });
    }
}

/// ω Δt ≤ 1, ω² = k / m by rows: shares and weights sum to 1, and the 4 is for what acts through J. The stiffness that
/// the explicit integrator looks at now and then may be of other contacts.
double BodyContact::longest_step(const Configuration& at) const
{
    std::vector<double> load(at.body.size(), 0);
    each_contact(at.remembered(), [&](const Contact& c) {
        each_weight(at, c, [&](std::uint32_t node, double weight) { load[node] += 4 * weight * c.stiffness; });
    });
    double longest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < load.size(); ++i)
        if (load[i] > 0)
            longest = std::min(longest, std::sqrt(at.body.mass[i] / load[i]));
    return longest;
}

namespace {

EffectPlan read_contact(JsonFields& f)
{
    EffectPlan plan;
    const double stiffness = f.number("stiffness", JsonFields::positive());
    plan.couple = [stiffness](CouplingBuilder& scene) {
        auto search = std::make_unique<ContactSearch>(stiffness);
        for (const CouplingBuilder::Member& body : scene.members()) {
            if (!body.simulation.surface())
                scene.complain("body '" + body.name + "' has no surface to touch others with");
            search->add(body.simulation);
        }
        if (scene.members().size() < 2)
            scene.complain("needs at least two bodies");
        return search;
    };
    return plan;
}

} // namespace

namespace effects {
extern const EffectKind contact{contact_name, read_contact, R"json([{
    "description": "bodies that push each other apart where they overlap",
    "properties": {"stiffness": {"type": "number", "exclusiveMinimum": 0, "description": "Pa/m: pressure per depth"}},
    "required": ["stiffness"],
    "example": {"stiffness": 100}
}])json"};
}

} // namespace cinch
