// SPDX-License-Identifier: Apache-2.0
#include "cinch/collider.hpp"

#include "toolkit/collide/collider_parts.hpp"

namespace cinch {
namespace {

BodyId add_own(Collider::Parts& parts, Bvh&& bvh, const DeformableSurface& surface, const LazyOptions& own,
               std::span<const MorphTarget> targets = {})
{
    if (own.methods.within(kernel_methods)) // then the tree copies what it needs of its BVH
        return parts.add(bvh, nullptr, surface, own, targets);
    auto kept = std::make_unique<const Bvh>(std::move(bvh));
    const Bvh& there = *kept;
    return parts.add(there, std::move(kept), surface, own, targets);
}

// With the leaf size and rest data that queries want.
BodyId add_built(Collider::Parts& parts, const DeformableSurface& surface, const LazyOptions& own,
                 std::span<const MorphTarget> targets = {})
{
    const RestDetail detail = need(own.methods, RestNeed::local) ? RestDetail::inner : RestDetail::boxes;
    return add_own(parts, build_bvh(surface, ClusterSize{own.lanes, own.lanes}, detail), surface, own, targets);
}

} // namespace

Collider::Collider(const LazyOptions& options) : parts_(std::make_unique<Parts>(options)) {}
Collider::~Collider() = default;
Collider::Collider(Collider&&) noexcept = default;
Collider& Collider::operator=(Collider&&) noexcept = default;

BodyId Collider::add(const DeformableSurface& surface) { return add_built(*parts_, surface, parts_->options()); }
BodyId Collider::add(const DeformableSurface& surface, const LazyOptions& own)
{
    return add_built(*parts_, surface, own);
}
BodyId Collider::add(const DeformableSurface& surface, std::span<const MorphTarget> targets)
{
    return add_built(*parts_, surface, parts_->options(), targets);
}
BodyId Collider::add(const Bvh& bvh, const DeformableSurface& surface)
{
    return parts_->add(bvh, nullptr, surface, parts_->options());
}
BodyId Collider::add(Bvh&& bvh, const DeformableSurface& surface)
{
    return add_own(*parts_, std::move(bvh), surface, parts_->options());
}
BodyId Collider::add(const Bvh& bvh, const DeformableSurface& surface, const LazyOptions& own)
{
    return parts_->add(bvh, nullptr, surface, own);
}

void Collider::remove(BodyId body) { parts_->remove(body); }
std::span<const BodyId> Collider::bodies() const { return parts_->ids(); }
void Collider::set_filter(std::function<bool(BodyId, BodyId)> wanted) { parts_->set_filter(std::move(wanted)); }
void Collider::update(std::span<const BodyFrame> frames) { parts_->update(frames); }
bool Collider::find(Query query, const Sink& sink) { return parts_->find(query, sink); }

std::vector<TrianglePair> Collider::pairs()
{
    std::vector<TrianglePair> all;
    find(Query::pairs, [&](std::span<const TrianglePair> some) {
        all.insert(all.end(), some.begin(), some.end());
        return true;
    });
    return all;
}

bool Collider::any()
{
    return find(Query::any, [](std::span<const TrianglePair>) { return false; });
}

const std::vector<BodyId>& Collider::unknown() const { return parts_->unknown(); }
const QueryCounts& Collider::counts() const { return parts_->counts(); }
std::size_t Collider::bytes() const { return parts_->bytes(); }

} // namespace cinch
