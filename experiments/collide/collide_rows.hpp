// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to collide/: what was measured on a scene, as rows that are kept and as records.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/collide/collide_tables.hpp"

namespace cinch {

/// All of it, and back.
nlohmann::ordered_json to_json(const SceneResult& result);
SceneResult scene_result_of(const nlohmann::ordered_json& row);

/// The record of one backend on it.
nlohmann::ordered_json record(const SceneResult& result, const Measured& measured, bool cold);

} // namespace cinch
