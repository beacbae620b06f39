// What each address of the page's API answers. openapi.json describes the members.
#pragma once

#include "service/config/config.hpp"
#include "service/model/messages.hpp"
#include "service/web/json.hpp"
#include "service/web/query_pool.hpp"

namespace reident::web {

// Each throws BadRequest for a question that cannot be answered, and what readers throw.

/// Each equipment, worst first: its champion, errors, what waits, who holds it; alarms, and the
/// services of the pair. `heard`: the configured service, or those of its pair, as far as they are
/// heard now.
Json overview_view(const Stored& stored, const Config& config,
                   const std::vector<ServiceStatus>& heard);
/// The versions that wait for an operator, with their verdicts.
Json waiting_view(const Stored& stored, const HttpRequest& request);
/// Who runs which version.
Json simulators_view(const Stored& stored, const HttpRequest& request);
/// One equipment: signals, versions with their errors, decisions.
Json equipment_view(const Stored& stored, const HttpRequest& request);
/// One version: verdict, conditions, model, its record against the champion.
Json version_view(const Stored& stored, const HttpRequest& request);
/// What happened to an equipment in a range of telemetry: champions, decisions, what was excluded,
/// changes, and the record of each champion.
Json timeline_view(const Stored& stored, const HttpRequest& request);
/// One parameter in a range, in bins.
Json telemetry_view(const Stored& stored, const HttpRequest& request);
/// The free run of a version over a range, and its errors, in bins.
Json run_view(const Stored& stored, const HttpRequest& request);
/// Decisions about any equipment, the newest first, a page at a time.
Json events_view(const Stored& stored, const HttpRequest& request);
/// What operators ordered and what the service replied, the newest first.
Json commands_view(const Stored& stored, const HttpRequest& request);
/// When no telemetry came, and of which parameters; the longest gaps of the range.
Json gaps_view(const Stored& stored, const HttpRequest& request);
/// Which sensors screening did not believe, since when and until when.
Json excluded_view(const Stored& stored, const HttpRequest& request);
/// The series that are archived.
Json series_view(const Stored& stored, const HttpRequest& request);
/// What came of one parameter and what is missing, day by day.
Json completeness_view(const Stored& stored, const HttpRequest& request);

}  // namespace reident::web
