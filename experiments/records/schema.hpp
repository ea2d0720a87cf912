// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace cinch {

/// JSON Schema (2020-12) of one record, record.schema.json: all that any record can have, of one name one kind. Written
/// down there alone: what is read is checked by it, and `cinch schema` prints it.
const nlohmann::ordered_json& record_schema();

/// Empty, or what is wrong with a record: not an object, without what is required, a known field of another type. Of
/// JSON Schema it knows what record.schema.json has: types, and a minimum of 0.
std::string fault_of(const nlohmann::ordered_json& record);

/// Prints the schema; returns the exit status.
int print_schema();

} // namespace cinch
