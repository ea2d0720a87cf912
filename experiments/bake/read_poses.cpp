// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/read_poses.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

using Json = nlohmann::json;

constexpr JsonFields::Range degrees{0, 180, false, "degrees from 0 to 180"};
constexpr JsonFields::Range angle{-360, 360, false, "degrees from -360 to 360"};

double radians(double x) { return x * (std::numbers::pi / 180); }

// Turns the bone to the middle of its angles.
void turn(Bone& bone, const Vec3& axis, double by)
{
    double greatest = 0; // squares must neither vanish nor overflow
    for (const double x : bone.rotation)
        greatest = std::max(greatest, std::abs(x));
    Eigen::Quaterniond now = Eigen::Quaterniond::Identity(); // as 0 is
    if (greatest > 0)
        now = Eigen::Quaterniond(bone.rotation[3] / greatest, bone.rotation[0] / greatest, bone.rotation[1] / greatest,
                                 bone.rotation[2] / greatest)
                  .normalized();
    const Eigen::Quaterniond to = now * Eigen::Quaterniond(Eigen::AngleAxisd(by, axis));
    bone.rotation = {to.x(), to.y(), to.z(), to.w()};
}

// `bone`: none for the others.
PoseLimit limit_of(JsonFields fields, Bone* bone)
{
    PoseLimit out;
    out.move = fields.number("move", JsonFields::not_negative(), 0);
    const Json* const turned = fields.find("degrees");
    if (turned && turned->is_array()) {
        if (!bone)
            fields.complain("degrees", "is one angle where there is no one bone");
        if (turned->size() != 2)
            fields.fail("degrees", "two angles, from and to", *turned);
        const double from = fields.number_of("degrees/0", (*turned)[0], angle),
                     to = fields.number_of("degrees/1", (*turned)[1], angle);
        if (from > to)
            fields.complain("degrees", "begins behind its end");
        if (bone->is_matrix)
            fields.complain("degrees", "are of a bone that the file gives a matrix: one angle, about any axis");
        turn(*bone, fields.direction("axis"), radians((from + to) / 2));
        out.angle = radians((to - from) / 2);
    } else if (turned) {
        out.angle = radians(fields.number_of("degrees", *turned, degrees));
    }
    out.angle *= 1 + 0x1p-40; // the middle was rounded
    fields.finish();
    return out;
}

} // namespace

std::vector<PoseLimit> read_poses(const std::string& file, Character& character)
{
    std::ifstream in(file);
    if (!in || std::filesystem::is_directory(file))
        throw InputError::in_file(file, std::filesystem::exists(file) ? "cannot be read" : "no such file");
    std::stringstream text;
    text << in.rdbuf();
    Json root;
    try {
        root = Json::parse(text.str());
    } catch (const Json::parse_error& error) {
        throw InputError::at_byte(file, error.byte, "is no JSON");
    }
    JsonFields fields(root, file, "");
    PoseLimit others;
    if (const Json* of = fields.find("others"))
        others = limit_of(JsonFields(*of, file, "/others"), nullptr);
    std::vector<PoseLimit> out(character.bones.size(), others);
    if (const Json* bones = fields.find("bones")) {
        if (!bones->is_object())
            fields.fail("bones", "an object of bones by their names", *bones);
        for (const auto& [name, of] : bones->items()) {
            bool found = false;
            for (std::size_t i = 0; i < out.size(); ++i)
                if (character.bones[i].name == name) {
                    out[i] = limit_of(JsonFields(of, file, "/bones/" + name), &character.bones[i]);
                    found = true;
                }
            if (found)
                continue;
            std::string known;
            for (const Bone& bone : character.bones)
                known += (known.empty() ? "" : ", ") + bone.name;
            throw InputError::in_file(file, fmt::format("{} has no bone '{}'; it has {}", character.file,
                                                        JsonFields::printable(name), known));
        }
    }
    fields.finish();
    return out;
}

} // namespace cinch
