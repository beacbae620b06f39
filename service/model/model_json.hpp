// The one codec between the mathematics, the registry's text and the command line's JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "service/model/model_version.hpp"

namespace reident {

/// Returns the model's JSON. Matrices are arrays of rows, vectors arrays; doubles are written so
/// that the same bits come back. Non-finite numbers (a fit of -inf) are written as null and come
/// back as NaN.
nlohmann::ordered_json to_json(const identification::Matrix& matrix);
nlohmann::ordered_json to_json(const identification::Vector& vector);
nlohmann::ordered_json to_json(const EquipmentModel& model);

/// Reads what to_json() wrote, of any earlier version of the program too. Throws
/// std::invalid_argument naming the field that is missing or wrong: sizes have to agree, and
/// expressions to be readable. Fields that it does not know are ignored.
EquipmentModel equipment_model_from_json(const std::string& text);

/// SHA-256, hexadecimal, of the model's canonical encoding (README of idl/): names, units, ranges,
/// period, sample hold, sizes and matrices as little-endian bytes. Whoever receives a version can
/// compute it again from the fields that it received.
std::string model_digest(const EquipmentModel& model);

}  // namespace reident
