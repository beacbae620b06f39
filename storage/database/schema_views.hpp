// The views of a database file. Private to schema.cpp.
#pragma once

#include <string_view>

namespace reident::storage::schema {

inline constexpr std::string_view notice_views = R"sql(
CREATE VIEW alarm_now AS
  SELECT code, spacecraft, equipment, text,
         (SELECT min(time) FROM alarm AS own
          WHERE own.code = last.code AND own.spacecraft = last.spacecraft
            AND own.equipment = last.equipment AND own.kind = 'raise'
            AND own.id > coalesce((SELECT max(id) FROM alarm AS cleared
                                   WHERE cleared.code = last.code
                                     AND cleared.spacecraft = last.spacecraft
                                     AND cleared.equipment = last.equipment
                                     AND cleared.kind = 'clear'), 0)) AS since,
         coalesce((SELECT actor FROM alarm AS seen
                   WHERE seen.code = last.code AND seen.spacecraft = last.spacecraft
                     AND seen.equipment = last.equipment AND seen.kind = 'acknowledge'
                     AND seen.id > last.id ORDER BY id DESC LIMIT 1), '') AS acknowledged_by
  FROM alarm AS last
  WHERE kind = 'raise'
    AND id = (SELECT max(id) FROM alarm AS other
              WHERE other.code = last.code AND other.spacecraft = last.spacecraft
                AND other.equipment = last.equipment AND other.kind <> 'acknowledge');

CREATE VIEW simulator_now AS
  SELECT name AS simulator, spacecraft, equipment, version, offered, refused, reason, mode,
         from_cache, since, host, process, program_version, time
  FROM simulator AS last
  WHERE is_there
    AND id = (SELECT max(id) FROM simulator AS other
              WHERE other.name = last.name AND other.spacecraft = last.spacecraft
                AND other.equipment = last.equipment);
)sql";

inline constexpr std::string_view series_view = R"sql(
CREATE VIEW telemetry_series AS
  SELECT series.spacecraft,
         coalesce(parameter.name, CAST(series.parameter AS TEXT)) AS parameter,
         iif(origin, 'simulated', 'real') AS origin, nullif(unit, '') AS unit, samples, first_time,
         last_time
  FROM series
  LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft
                      AND parameter.id = series.parameter;
)sql";

inline constexpr std::string_view telemetry_views = R"sql(
-- Sequence numbers are kept with the highest bit inverted (SCHEMA.md).
CREATE VIEW telemetry_source AS
  SELECT spacecraft, name AS source, iif(origin, 'simulated', 'real') AS origin, frames, samples,
         duplicates, conflicts, late, non_finite, out_of_order, restarts,
         iif(missing >= 0, missing, printf('%llu', missing)) AS missing,
         iif(highest_sequence < 0, highest_sequence + 9223372036854775807 + 1,
             printf('%llu', highest_sequence - 9223372036854775807 - 1)) AS last_sequence
  FROM source;

CREATE VIEW telemetry_gap AS
  SELECT spacecraft, name AS source, iif(origin, 'simulated', 'real') AS origin, run,
         iif(first < 0, first + 9223372036854775807 + 1,
             printf('%llu', first - 9223372036854775807 - 1)) AS first,
         iif(last < 0, last + 9223372036854775807 + 1,
             printf('%llu', last - 9223372036854775807 - 1)) AS last,
         time_before, time_after
  FROM sequence_gap JOIN source ON source.id = sequence_gap.source;

CREATE VIEW telemetry_late AS
  SELECT series.spacecraft,
         coalesce(parameter.name, CAST(series.parameter AS TEXT)) AS parameter,
         iif(origin, 'simulated', 'real') AS origin, begin_time, end_time
  FROM late_range JOIN series ON series.id = late_range.series
  LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft
                      AND parameter.id = series.parameter;
)sql";

inline constexpr std::string_view hole_view = R"sql(
CREATE VIEW telemetry_hole AS
  SELECT series.spacecraft,
         coalesce(parameter.name, CAST(series.parameter AS TEXT)) AS parameter,
         iif(origin, 'simulated', 'real') AS origin, begin_time, end_time,
         strftime('%Y-%m-%dT%H:%M:%S',
                  begin_time / 1000000000 - (begin_time % 1000000000 < 0), 'unixepoch')
           || printf('.%09dZ', (begin_time % 1000000000 + 1000000000) % 1000000000) AS begin_utc,
         strftime('%Y-%m-%dT%H:%M:%S',
                  end_time / 1000000000 - (end_time % 1000000000 < 0), 'unixepoch')
           || printf('.%09dZ', (end_time % 1000000000 + 1000000000) % 1000000000) AS end_utc
  FROM sample_gap JOIN series ON series.id = sample_gap.series
  LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft
                      AND parameter.id = series.parameter;
)sql";

inline constexpr std::string_view removal_view = R"sql(
CREATE VIEW telemetry_removed AS
  SELECT series.spacecraft,
         coalesce(parameter.name, CAST(series.parameter AS TEXT)) AS parameter,
         iif(origin, 'simulated', 'real') AS origin, begin_time, end_time, removal.samples, cause,
         time
  FROM removal JOIN series ON series.id = removal.series
  LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft
                      AND parameter.id = series.parameter;
)sql";

inline constexpr std::string_view lineage_view = R"sql(
-- Each version with the champion that it was judged against: the one before its approval, or else
-- before its first decision.
CREATE VIEW lineage AS
  SELECT spacecraft, equipment, version,
         (SELECT before.version FROM decision AS before
          WHERE before.id = (SELECT max(id) FROM decision AS earlier
                             WHERE earlier.spacecraft = own.spacecraft
                               AND earlier.equipment = own.equipment
                               AND earlier.kind IN ('approve', 'roll_back')
                               AND earlier.id < own.id)
            AND NOT EXISTS (SELECT 1 FROM decision AS withdrawal
                            WHERE withdrawal.spacecraft = own.spacecraft
                              AND withdrawal.equipment = own.equipment
                              AND withdrawal.version = before.version
                              AND withdrawal.kind = 'withdraw'
                              AND withdrawal.id < own.id)) AS parent
  FROM decision AS own
  WHERE id = (SELECT coalesce(min(iif(kind = 'approve', id, NULL)), min(id)) FROM decision AS any
              WHERE any.spacecraft = own.spacecraft AND any.equipment = own.equipment
                AND any.version = own.version);
)sql";

inline constexpr std::string_view registry_views = R"sql(
CREATE VIEW model_version AS
  SELECT version.spacecraft, version.equipment, number AS version, attempt, window_begin,
         window_end, attempt.time AS created,
         CASE WHEN EXISTS (SELECT 1 FROM decision AS other
                           WHERE other.spacecraft = version.spacecraft
                             AND other.equipment = version.equipment AND other.version = number
                             AND kind = 'withdraw') THEN 'withdrawn'
              WHEN number = (SELECT other.version FROM decision AS other
                             WHERE other.spacecraft = version.spacecraft
                               AND other.equipment = version.equipment
                               AND kind IN ('approve', 'roll_back')
                             ORDER BY id DESC LIMIT 1) THEN 'approved'
              ELSE (SELECT CASE kind WHEN 'reject' THEN 'rejected' WHEN 'wait' THEN 'waiting'
                                     ELSE 'superseded' END
                    FROM decision AS other
                    WHERE other.spacecraft = version.spacecraft
                      AND other.equipment = version.equipment AND other.version = number
                    ORDER BY id DESC LIMIT 1) END AS status,
         (SELECT parent FROM lineage
          WHERE lineage.spacecraft = version.spacecraft AND lineage.equipment = version.equipment
            AND lineage.version = number) AS parent,
         digest, model_json, samples_digest, provenance_json
  FROM version JOIN attempt ON attempt.id = version.attempt;

CREATE VIEW champion AS
  SELECT spacecraft, equipment, version,
         (SELECT time FROM decision
          WHERE decision.spacecraft = model_version.spacecraft
            AND decision.equipment = model_version.equipment
            AND decision.version = model_version.version
            AND kind IN ('approve', 'roll_back')
          ORDER BY id DESC LIMIT 1) AS since,
         window_begin, window_end, digest, model_json
  FROM model_version WHERE status = 'approved';

CREATE VIEW history AS
  SELECT attempt.id AS attempt, attempt.spacecraft, attempt.equipment, window_begin, window_end,
         cause, attempt.time, outcome, attempt.reason, version.number AS version,
         (SELECT kind || ' by ' || actor FROM decision
          WHERE decision.spacecraft = attempt.spacecraft
            AND decision.equipment = attempt.equipment AND decision.version = version.number
          ORDER BY id DESC LIMIT 1) AS last_decision
  FROM attempt LEFT JOIN version ON version.attempt = attempt.id;

CREATE VIEW hold_now AS
  SELECT spacecraft, equipment, actor, reason, time AS since
  FROM hold AS last
  WHERE kind = 'hold'
    AND id = (SELECT max(id) FROM hold AS other WHERE other.spacecraft = last.spacecraft
                                                  AND other.equipment = last.equipment);
)sql";

inline constexpr std::string_view reason_view = R"sql(
-- Why windows and versions came to what they did: attempts, then the gate's later decisions. JSON
-- that cannot be read has no code.
CREATE VIEW gate_reason AS
  SELECT attempt.spacecraft, attempt.equipment, version.number AS version, attempt.time,
         'attempt' AS of, outcome AS code
  FROM attempt LEFT JOIN version ON version.attempt = attempt.id
  UNION ALL
  SELECT spacecraft, equipment, version, time, kind,
         CASE WHEN json_valid(evidence_json)
              THEN json_extract(evidence_json, '$.reasons[#-1].code') END
  FROM decision WHERE actor = 'gate' AND evidence_json <> '';
)sql";

}  // namespace reident::storage::schema
