// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_extensions.hpp"

#include <algorithm>

#include "toolkit/surface/gltf_compression.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

// Modelled wherever they are allowed: quantised positions are read as any integers are; hidden nodes are not drawn;
// pointers at nodes are channels; instances are meshes.
constexpr std::string_view modelled_when_required[] = {"KHR_mesh_quantization", "KHR_node_visibility",
                                                       "KHR_animation_pointer", "VRMC_vrm", "EXT_mesh_gpu_instancing"};

constexpr std::string_view harmless_beginnings[] = {
    "KHR_materials_", "EXT_materials_", "ADOBE_materials_", "VRMC_materials_", "KHR_texture_",
    "EXT_texture_",   "MSFT_texture_",  "MSFT_packing_",    "KHR_lights_",     "EXT_lights_",
    "KHR_xmp",        "KHR_audio",      "MSFT_audio_"};

constexpr std::string_view harmless[] = {"AGI_stk_metadata",
                                         "CESIUM_primitive_outline",
                                         "EXT_feature_metadata",
                                         "EXT_instance_features",
                                         "EXT_mesh_features",
                                         "EXT_mesh_manifold",
                                         "EXT_mesh_primitive_edge_visibility",
                                         "EXT_structural_metadata",
                                         "FB_ngon_encoding",
                                         "GODOT_single_root",
                                         "KHR_environment_map",
                                         "KHR_node_hoverability",
                                         "KHR_node_selectability",
                                         "MOZ_lightmap"};

void refuse_compression(const std::string& name, const GltfValue& place)
{
    if (name.find("compression") != std::string::npos)
        place.fail("is compressed with " + one_line(name) + ", which is not supported; export it without compression");
}

} // namespace

void Missing::add(const std::string& what, const std::string& place)
{
    auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.what == what; });
    if (entry == entries_.end())
        entry = entries_.insert(entries_.end(), {what, place, {}});
    entry->places.insert(place);
}

std::vector<std::string> Missing::names() const
{
    std::vector<std::string> out;
    for (const Entry& e : entries_) {
        const std::string more = e.places.size() > 1 ? " and " + std::to_string(e.places.size() - 1) + " more" : "";
        out.push_back(e.what + (e.first.empty() ? "" : " (" + e.first + more + ")"));
    }
    return out;
}

bool is_harmless_extension(std::string_view name)
{
    if (name.find("displacement") != std::string_view::npos) // of a material moves vertices
        return false;
    auto begins = [&](std::string_view beginning) { return name.starts_with(beginning); };
    return std::any_of(std::begin(harmless_beginnings), std::end(harmless_beginnings), begins) ||
           std::find(std::begin(harmless), std::end(harmless), name) != std::end(harmless);
}

namespace {

template <class Modelled> void note(const GltfValue& value, Missing& missing, const Modelled& is_modelled)
{
    const auto extensions = value.find("extensions");
    if (!extensions)
        return;
    for (const std::string& name : extensions->keys()) {
        if (is_modelled(name))
            continue;
        refuse_compression(name, value);
        if (!is_harmless_extension(name))
            missing.add("the extension " + one_line(name), value.named());
    }
}

} // namespace

void note_extensions(const GltfValue& value, Missing& missing, std::initializer_list<std::string_view> modelled)
{
    note(value, missing,
         [&](const std::string& name) { return std::find(modelled.begin(), modelled.end(), name) != modelled.end(); });
}

void note_compressed(const GltfDocument& document, const GltfValue& value, Missing& missing)
{
    note(value, missing, [&](const std::string& name) { return is_decoded(document, name); });
}

namespace {

// Whether a VRM 0 file has springs.
bool swings(const GltfValue& root)
{
    const auto extensions = root.find("extensions");
    const auto vrm = extensions ? extensions->find("VRM") : std::nullopt;
    const auto secondary = vrm ? vrm->find("secondaryAnimation") : std::nullopt;
    const auto springs = secondary ? secondary->find("boneGroups") : std::nullopt;
    return springs && springs->size() > 0;
}

} // namespace

void note_extensions_of_file(const GltfDocument& document, Missing& missing)
{
    const GltfValue root = document.root();
    if (const auto required = root.find("extensionsRequired"))
        for (std::size_t i = 0; i < required->size(); ++i) {
            const std::string& name = (*required)[i].text();
            if (is_decoded(document, name))
                continue;
            refuse_compression(name, root);
            if (!is_harmless_extension(name) && !(name == "VRM" && !swings(root)) &&
                std::find(std::begin(modelled_when_required), std::end(modelled_when_required), name) ==
                    std::end(modelled_when_required))
                missing.add("the extension " + one_line(name), "required");
        }
    // What VRM says of a file is for an application that poses it; hair and clothes that swing move by themselves.
    if (swings(root))
        note_extensions(root, missing, {"VRMC_vrm"});
    else
        note_extensions(root, missing, {"VRMC_vrm", "VRM"});
}

} // namespace cinch
