// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/json_fields.hpp"
#include "toolkit/simulate/scene.hpp"

namespace cinch {

/// The parts of a scene, each with its schema, JSON. See parse_scene.
SceneBody read_body(const JsonFields::Json& json, const std::string& file, const std::string& folder,
                    std::size_t index);
extern const char* const body_schema;

/// Where the field is missing: steps as long as a frame.
Integration read_integration(JsonFields& scene, double frame_s);
extern const char* const integrator_schema;

} // namespace cinch
