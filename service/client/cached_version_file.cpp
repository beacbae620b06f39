#include "service/client/cached_version_file.hpp"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>

#include "service/client/version_check.hpp"
#include "service/model/model_fields.hpp"
#include "service/model/model_json.hpp"
#include "service/support/sha256.hpp"

namespace reident {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t file_format = 1;
// Bound of a file's size: an order of 200 with as many inputs takes 3 MB.
constexpr std::uintmax_t max_file_bytes = 64U << 20U;

Unusable damaged(std::string reason) {
  return {Unusable::Kind::damaged, std::move(reason)};
}

std::variant<std::string, Unusable> text_of(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return Unusable{Unusable::Kind::absent, "there is no such file"};
  if (error) return Unusable{Unusable::Kind::foreign, error.message() + "; check its permissions"};
  if (status.type() != std::filesystem::file_type::regular)
    return Unusable{Unusable::Kind::foreign, "it is no regular file; remove it"};
  if (std::filesystem::file_size(file, error) > max_file_bytes && !error)
    return damaged("it is larger than " + std::to_string(max_file_bytes >> 20U) + " MiB");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream) {
    const std::string reason = std::generic_category().message(errno);
    return Unusable{Unusable::Kind::foreign, reason + "; check its permissions"};
  }
  text << stream.rdbuf();
  if (stream.bad()) return Unusable{Unusable::Kind::foreign, "the disk could not read it"};
  return std::move(text).str();
}

std::string hash_of(const Json& kept) {
  return sha256_hex(kept.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Throws Json::exception and std::invalid_argument where a field is missing or wrong.
CachedVersion decode(const Json& json) {
  CachedVersion kept;
  visit_fields(kept.version, [&json](const Field& field, auto& member) {
    const std::string key(field.name);
    if (field.presence != Presence::optional || json.contains(key)) json.at(key).get_to(member);
  });
  kept.published = json.at("published_ns").get<std::int64_t>();
  kept.received = json.at("received_ns").get<std::int64_t>();
  kept.version.model = equipment_model_from_json(json.at("model").dump());
  return kept;
}

}  // namespace

std::string kept_version_text(const CachedVersion& kept, const std::string& partition) {
  Json json = {{"partition", partition}};
  visit_fields(kept.version, [&json](const Field& field, const auto& member) {
    if (field.presence != Presence::optional || !is_absent(member))
      json[std::string(field.name)] = member;
  });
  json["published_ns"] = kept.published;
  json["received_ns"] = kept.received;
  json["model"] = to_json(kept.version.model);
  const Json file = {{"format", file_format}, {"sha256", hash_of(json)}, {"kept", json}};
  return file.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::variant<CachedVersion, Unusable> read_kept_version(const std::filesystem::path& file,
                                                        const std::string& partition) {
  const auto text = text_of(file);
  if (const auto* unusable = std::get_if<Unusable>(&text)) return *unusable;
  // What is nested deeper is left out, and then the content does not match: to write it out again
  // for its SHA-256 takes a call for each level.
  constexpr int most_levels = 32;
  const Json json = Json::parse(
      std::get<std::string>(text),
      [](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
        return depth < most_levels;
      },
      false);
  if (json.is_discarded() || !json.is_object())
    return damaged("it is truncated, or not JSON that a program of ours wrote");
  try {
    if (const auto format = json.at("format").get<std::int64_t>(); format > file_format)
      return Unusable{Unusable::Kind::foreign, "its format is " + std::to_string(format) +
                                                   " and this program knows " +
                                                   std::to_string(file_format) + "; update it"};
    const Json& kept = json.at("kept");
    if (json.at("sha256").get<std::string>() != hash_of(kept))
      return damaged("its content does not match its SHA-256");
    if (kept.at("partition").get<std::string>() != partition)
      return damaged("it was kept for another partition");
    CachedVersion version = decode(kept);
    if (version.version.number < 1) return damaged("its number is not above 0");
    if (const auto reason = damage(version.version)) return damaged(*reason);
    return version;
  } catch (const Json::exception& error) {
    return damaged(error.what());
  } catch (const std::invalid_argument& error) {
    return damaged(error.what());
  }
}

}  // namespace reident
