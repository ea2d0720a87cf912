// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

namespace cinch {

/// What values a field of records can have, of these together.
enum FieldType : unsigned {
    a_text = 1,
    a_count = 2, ///< a whole number from 0 on
    a_number = 4,
    a_signed_number = 8, ///< that may be below 0
    a_flag = 16,
    a_list = 32,
    an_object = 64,
    or_null = 128 ///< where there is no such thing, or it was not measured
};

/// A field that records of some command have; of one name there is one kind.
struct RecordField {
    const char* name;
    unsigned type;
    const char* what; ///< with its unit
};

/// All that any record can have. Written down here alone: what is read is checked by it, and `cinch schema` prints it.
std::span<const RecordField> record_fields();

/// Those that every record has.
std::span<const char* const> required_fields();

/// Empty, or what is wrong with a record: not an object, without what is required, a known field of another type.
std::string fault_of(const nlohmann::ordered_json& record);

/// As JSON Schema (2020-12) of one record. Prints it; returns the exit status.
nlohmann::ordered_json record_schema();
int print_schema();

} // namespace cinch
