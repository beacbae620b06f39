// What `reident identify` leaves out because a sensor shows a fault (METHOD.md, section 17).
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identification/samples/record.hpp"
#include "service/cli/identify_data.hpp"

namespace reident::cli {

/// Whether a column has more than ten values.
bool is_analog(const identification::Vector& column);

/// Takes the rows at which a column shows a fault out of the record and says which these are, by
/// column and kind.
std::vector<LeftOut> leave_out_faults(identification::Record& record,
                                      const std::vector<std::string>& columns);

/// Returns what was left out for a program, and as sentences for a person: rows are those of the
/// file, whose ticks `data` holds.
nlohmann::ordered_json left_out_json(const IdentifyData& data);
std::vector<std::string> left_out_sentences(const IdentifyData& data);

}  // namespace reident::cli
