// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_animation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "toolkit/surface/gltf_accessor.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

constexpr const char* morphing = "morph targets with weights that are not 0";

// What a channel moves: a property of a node, in the words of the core specification; or nothing that can move a
// vertex; or what is not known.
struct Target {
    enum class Kind { node, harmless, unknown } kind = Kind::harmless;
    std::size_t node = 0;
    std::string path;
};

// Pointers at what a plain channel could name are such channels; those at materials, cameras, lights and the like
// move no vertex.
Target target_of_pointer(const std::string& pointer)
{
    std::vector<std::string> steps;
    for (std::size_t at = 0; at < pointer.size();) {
        if (pointer[at] != '/')
            return {Target::Kind::unknown, 0, ""};
        const std::size_t end = std::min(pointer.find('/', at + 1), pointer.size());
        steps.push_back(pointer.substr(at + 1, end - at - 1));
        at = end;
    }
    if (steps.size() < 2)
        return {Target::Kind::unknown, 0, ""};
    for (const char* list : {"materials", "textures", "images", "samplers", "cameras"})
        if (steps[0] == list)
            return {};
    if (steps[0] == "extensions" && is_harmless_extension(steps[1]))
        return {};
    const bool known_node = steps[0] == "nodes" && steps.size() >= 3 && !steps[1].empty() && steps[1].size() < 10 &&
                            std::all_of(steps[1].begin(), steps[1].end(), [](char c) { return c >= '0' && c <= '9'; });
    if (known_node && steps[2] == "extensions" && steps.size() >= 4 && is_harmless_extension(steps[3]))
        return {};
    if (known_node && steps.size() == 3)
        for (const char* path : {"translation", "rotation", "scale", "weights"})
            if (steps[2] == path)
                return {Target::Kind::node, std::stoul(steps[1]), path};
    return {Target::Kind::unknown, 0, ""};
}

class AnimationReader {
public:
    AnimationReader(GltfDocument& document, const GltfSkeleton& skeleton, const std::vector<GltfMorph>& morphs,
                    Morphs with_morphs, const GltfValue& source, Character::Animation& out)
        : document_(document), skeleton_(skeleton), morphs_(morphs), with_morphs_(with_morphs), source_(source),
          out_(out)
    {
    }

    void read()
    {
        note_extensions(source_, missing_);
        const GltfValue channels = source_["channels"];
        for (std::size_t c = 0; c < channels.size(); ++c)
            read_channel(channels[c]);
        for (const GltfMorph& morph : morphs_)
            if (with_morphs_ == Morphs::missing && !morphed_.count(morph.node) && morph.moved_by(morph.weights))
                missing_.add(morphing, document_.at("nodes", morph.node).named());
        if (equal_times_ > 0)
            out_.notes.push_back("clip '" + out_.name + "': " + std::to_string(equal_times_) +
                                 (equal_times_ == 1 ? " key has" : " keys have") +
                                 " the time of the one before; the later one wins");
        out_.missing = missing_.names();
    }

private:
    std::string where(const GltfValue& channel, const Target& target) const
    {
        return "clip '" + out_.name + "', " + channel.place() + " (" + target.path + " of " +
               document_.at("nodes", target.node).named() + ")";
    }

    [[noreturn]] void fail(const std::string& reason) const { throw InputError::in_file(document_.file(), reason); }

    Target target_of(const GltfValue& channel)
    {
        const GltfValue target = channel["target"];
        note_extensions(channel, missing_);
        note_extensions(target, missing_, {"KHR_animation_pointer"});
        const std::string& path = target["path"].text();
        if (path == "pointer") {
            const auto extensions = target.find("extensions");
            const auto extension = extensions ? extensions->find("KHR_animation_pointer") : std::nullopt;
            const std::string pointer = extension ? (*extension)["pointer"].text() : "";
            const Target found = target_of_pointer(pointer);
            if (found.kind == Target::Kind::unknown)
                missing_.add("the animation of " +
                                 (pointer.empty() ? std::string("what no pointer names") : one_line(pointer)),
                             channel.place());
            return found;
        }
        const auto node = target.index_of("node");
        if (path != "translation" && path != "rotation" && path != "scale" && path != "weights") {
            missing_.add("the animation of '" + printable(path) + "'", channel.place());
            return {Target::Kind::unknown, 0, path};
        }
        return node ? Target{Target::Kind::node, *node, path} : Target{}; // one without a node moves nothing
    }

    void read_channel(const GltfValue& channel)
    {
        const Target target = target_of(channel);
        const bool at_node = target.kind == Target::Kind::node;
        const std::uint32_t bone =
            at_node ? (document_.at("nodes", target.node), skeleton_.bone_of(target.node)) : GltfSkeleton::none;
        const auto morph = std::find_if(morphs_.begin(), morphs_.end(),
                                        [&](const GltfMorph& m) { return at_node && m.node == target.node; });
        const bool moves = at_node && (target.path == "weights" ? morph != morphs_.end() : bone != GltfSkeleton::none);
        if (!moves) { // as much of it as is sound belongs to the clip's length
            try {
                extend(times(channel));
            } catch (const InputError&) {
            }
            return;
        }
        if (!animated_.insert({target.node, target.path}).second)
            fail(where(channel, target) + ": is animated twice");
        if (target.path == "weights") {
            morphed_.insert(target.node);
            if (with_morphs_ == Morphs::read) {
                add_weights(channel, target, *morph);
                return;
            }
            extend(times(channel));
            if (morph->moved_by(read_accessor(document_, sampler(channel)["output"].index(), 1, missing_)))
                missing_.add(morphing, document_.at("nodes", target.node).named());
        } else if (!skeleton_.can_animate(bone)) {
            extend(times(channel));
            missing_.add("the animation of a node whose matrix is no translation, rotation and scale",
                         document_.at("nodes", target.node).named());
        } else {
            add_curve(channel, target, bone);
        }
    }

    GltfValue sampler(const GltfValue& channel)
    {
        const GltfValue sampler = source_["samplers"][channel["sampler"].index()];
        note_extensions(sampler, missing_);
        return sampler;
    }

    std::vector<double> times(const GltfValue& channel)
    {
        return read_accessor(document_, sampler(channel)["input"].index(), 1, missing_);
    }

    void extend(const std::vector<double>& times)
    {
        for (const double t : times) {
            out_.first_s = any_time_ ? std::min(out_.first_s, t) : t;
            out_.last_s = any_time_ ? std::max(out_.last_s, t) : t;
            any_time_ = true;
        }
    }

    void add_curve(const GltfValue& channel, const Target& target, std::uint32_t bone)
    {
        Curve curve;
        curve.bone = bone;
        curve.target = target.path == "translation" ? Curve::Target::translation
                       : target.path == "rotation"  ? Curve::Target::rotation
                                                    : Curve::Target::scale;
        const GltfValue from = sampler(channel);
        curve.interpolation = interpolation_of(channel, target);
        curve.time_s = times(channel);
        const std::size_t components = curve.target == Curve::Target::rotation ? 4 : 3;
        const std::vector<double> values = read_accessor(document_, from["output"].index(), components, missing_);
        for (std::size_t i = 0; i < values.size(); i += components) {
            std::array<double, 4> value{};
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), components, value.begin());
            curve.value.push_back(value);
        }
        require_keys(channel, target, curve.interpolation, curve.time_s, curve.value.size());
        out_.curves.push_back(std::move(curve));
    }

    // Weights of a mesh's targets; a scalar for each, key after key.
    void add_weights(const GltfValue& channel, const Target& target, const GltfMorph& morph)
    {
        WeightCurve curve;
        curve.first_target = morph.first_target;
        curve.count = static_cast<std::uint32_t>(morph.targets);
        curve.interpolation = interpolation_of(channel, target);
        curve.time_s = times(channel);
        curve.value = read_accessor(document_, sampler(channel)["output"].index(), 1, missing_);
        if (curve.value.size() % morph.targets != 0)
            fail(where(channel, target) + ": " + std::to_string(curve.value.size()) + " weights for " +
                 std::to_string(morph.targets) + " morph targets");
        require_keys(channel, target, curve.interpolation, curve.time_s, curve.value.size() / morph.targets);
        out_.morphs.push_back(std::move(curve));
    }

    Curve::Interpolation interpolation_of(const GltfValue& channel, const Target& target)
    {
        const std::string name = sampler(channel).text_or("interpolation", "LINEAR");
        if (name == "STEP")
            return Curve::Interpolation::step;
        if (name == "CUBICSPLINE")
            return Curve::Interpolation::cubic_spline;
        if (name != "LINEAR")
            fail(where(channel, target) + ": unknown interpolation '" + printable(name) + "'");
        return Curve::Interpolation::linear;
    }

    // As many values as the keys want, which ascend.
    void require_keys(const GltfValue& channel, const Target& target, Curve::Interpolation interpolation,
                      const std::vector<double>& time_s, std::size_t values)
    {
        const std::size_t per_key = interpolation == Curve::Interpolation::cubic_spline ? 3 : 1;
        if (time_s.empty() || values != per_key * time_s.size())
            fail(where(channel, target) + ": " + std::to_string(time_s.size()) + " keys but " + std::to_string(values) +
                 " values");
        for (std::size_t i = 1; i < time_s.size(); ++i) {
            if (time_s[i] < time_s[i - 1])
                fail(where(channel, target) + ": key times do not ascend, key " + std::to_string(i) +
                     " is earlier than the one before");
            equal_times_ += time_s[i] == time_s[i - 1];
        }
        extend(time_s);
    }

    GltfDocument& document_;
    const GltfSkeleton& skeleton_;
    const std::vector<GltfMorph>& morphs_;
    Morphs with_morphs_;
    GltfValue source_;
    Character::Animation& out_;
    Missing missing_;
    std::set<std::pair<std::size_t, std::string>> animated_;
    std::set<std::size_t> morphed_;
    std::size_t equal_times_ = 0;
    bool any_time_ = false;
};

} // namespace

void read_animations(GltfDocument& document, const GltfSkeleton& skeleton, const std::vector<GltfMorph>& morphs,
                     Morphs with_morphs, Character& out)
{
    std::set<std::string> names;
    for (std::size_t a = 0; a < document.count("animations"); ++a) {
        const GltfValue source = document.at("animations", a);
        Character::Animation animation;
        try {
            animation.name = one_line(source.text_or("name", ""));
            if (animation.name.empty())
                animation.name = "anim" + std::to_string(a);
            if (!names.insert(animation.name).second)
                names.insert(animation.name += "#" + std::to_string(a));
            AnimationReader(document, skeleton, morphs, with_morphs, source, animation).read();
        } catch (const InputError& error) { // of no account unless it is wanted
            animation.fault = error.what();
        }
        out.animations.push_back(std::move(animation));
    }
    out.rest.name = "rest";
    Missing missing;
    for (const GltfMorph& morph : morphs)
        if (with_morphs == Morphs::missing && morph.moved_by(morph.weights))
            missing.add(morphing, document.at("nodes", morph.node).named());
    out.rest.missing = missing.names();
}

} // namespace cinch
