#include <chrono>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/output/table.hpp"
#include "service/cli/verb.hpp"
#include "service/security/material.hpp"
#include "service/security/roles.hpp"
#include "service/security/site.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli::security_verb {
namespace {

using nlohmann::ordered_json;
using security::Member;
using security::Site;

constexpr std::int64_t day = 86'400'000'000'000;

struct Arguments {
  std::string folder, organisation = "reident", role, name;
  std::vector<std::string> partitions = {"operations", "operations/*"};
  std::string validity = duration_text(security::usual_validity);
  bool all = false;
  bool json = false;
};

std::int64_t validity_of(const Arguments& arguments) {
  const auto validity = parse_duration(arguments.validity);
  if (!validity || *validity <= 0)
    throw security::Error(
        fmt::format("'{}' is no time that a certificate can be valid for; use one such as 365d",
                    arguments.validity));
  return *validity;
}

std::string left_text(std::int64_t end, std::int64_t now) {
  return end <= now ? "ended" : fmt::format("{} days", (end - now) / day);
}

int init(const Arguments& arguments) {
  const Site site = Site::init(arguments.folder, arguments.organisation, utc_now());
  fmt::print(
      "{} has the authorities of {}, valid until {}. Keep it where no program of the domain "
      "runs, with a copy; 'reident security grant {} ROLE NAME' makes a member's folder.\n",
      arguments.folder, arguments.organisation, time_text(site.end()), arguments.folder);
  return exit_done;
}

int grant(const Arguments& arguments) {
  const auto folder = Site(arguments.folder)
                          .grant(arguments.role, arguments.name, arguments.partitions,
                                 validity_of(arguments), utc_now());
  fmt::print(
      "{} is for {} {} in the partitions {}: give it to the machine and the user of the "
      "program\n",
      folder.string(), arguments.role, arguments.name, joined(arguments.partitions));
  return exit_done;
}

int renew(const Arguments& arguments) {
  if (arguments.all == !arguments.name.empty())
    throw security::Error("renew takes the name of a member, or --all");
  Site site(arguments.folder);
  std::vector<std::string> names;
  for (const Member& member : site.members())
    if (arguments.all ? !member.revoked : member.name == arguments.name)
      names.push_back(member.name);
  if (!arguments.all) names = {arguments.name};
  for (const std::string& name : names)
    fmt::print("{} has a new certificate\n",
               site.renew(name, validity_of(arguments), utc_now()).string());
  return exit_done;
}

int revoke(const Arguments& arguments) {
  const std::size_t count = Site(arguments.folder).revoke(arguments.name, utc_now());
  fmt::print("{} certificates of {} are revoked{}\n", count, arguments.name,
             count == 0 ? ": it had none that is valid"
                        : fmt::format("; give {}/revoked.pem to every member's folder: programs "
                                      "take it up while they run",
                                      arguments.folder));
  return exit_done;
}

ordered_json member_json(const Member& member, std::int64_t now) {
  return {{"name", member.name},
          {"role", member.role},
          {"partitions", member.partitions},
          {"end", time_text(member.end)},
          {"days_left", (member.end - now) / day},
          {"revoked", member.revoked}};
}

int show(const Arguments& arguments) {
  const Site site(arguments.folder);
  const std::int64_t now = utc_now();
  if (arguments.json) {
    ordered_json object = {{"end", time_text(site.end())}, {"members", ordered_json::array()}};
    for (const Member& member : site.members())
      object["members"].push_back(member_json(member, now));
    fmt::print("{}\n", object.dump(2));
    return exit_done;
  }
  fmt::print("authorities until {} ({})\n", time_text(site.end()), left_text(site.end(), now));
  Table table({{"member"}, {"role"}, {"until"}, {"left"}, {"partitions"}});
  for (const Member& member : site.members())
    table.add({member.name, member.role, time_text(member.end),
               member.revoked ? "revoked" : left_text(member.end, now), joined(member.partitions)});
  fmt::print("{}", table.text(terminal_width()));
  return exit_done;
}

int check(const Arguments& arguments) {
  const std::int64_t now = utc_now();
  const auto read = security::read_material(arguments.folder, now);
  const auto* mistakes = std::get_if<std::vector<std::string>>(&read);
  const auto* material = std::get_if<security::Material>(&read);
  if (arguments.json) {
    ordered_json object = {{"valid", mistakes == nullptr},
                           {"mistakes", mistakes ? *mistakes : std::vector<std::string>()}};
    if (material) {
      object["role"] = material->role;
      object["name"] = material->name;
      object["partitions"] = material->partitions;
      object["end"] = time_text(material->end);
      object["days_left"] = (material->end - now) / day;
    }
    fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
    return mistakes ? exit_impossible : exit_done;
  }
  if (mistakes) {
    for (const std::string& mistake : *mistakes) print_error("{}", mistake);
    return exit_impossible;
  }
  fmt::print("{} {} until {} ({}) in the partitions {}\n", material->role, material->name,
             time_text(material->end), left_text(material->end, now), joined(material->partitions));
  const std::string warning = security::end_warning(*material, now);
  if (!warning.empty()) fmt::print("{}\n", warning);
  return exit_done;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  const auto work = std::make_shared<int (*)(const Arguments&)>(nullptr);
  command.require_subcommand(1);
  const auto action = [&](const char* name, const char* purpose, const char* folder,
                          int (*carry_out)(const Arguments&)) {
    CLI::App* one = command.add_subcommand(name, purpose);
    one->add_option("folder", arguments->folder, folder)->required();
    one->callback([work, carry_out] { *work = carry_out; });
    return one;
  };
  const auto add_validity = [&](CLI::App* one) {
    one->add_option("--valid", arguments->validity, "how long the certificate is valid")
        ->type_name("TIME")
        ->capture_default_str();
  };
  constexpr const char* site = "folder of the site's authorities";
  action("init", "Make the two authorities of a site", site, init)
      ->add_option("--organisation", arguments->organisation, "name of the site, in each subject")
      ->capture_default_str();
  CLI::App* granting = action("grant", "Make the folder of a new member", site, grant);
  granting->add_option("role", arguments->role, security::role_names())->required();
  granting
      ->add_option("name", arguments->name,
                   "name of the member; an operator's is the name in decisions")
      ->required();
  granting
      ->add_option("--partition", arguments->partitions,
                   "partitions that it may use; * and ? stand for any text and any character")
      ->capture_default_str();
  add_validity(granting);
  CLI::App* renewing = action("renew", "Give a member a new certificate and key", site, renew);
  renewing->add_option("name", arguments->name, "name of the member");
  renewing->add_flag("--all", arguments->all, "every member that is not revoked");
  add_validity(renewing);
  action("revoke", "Shut a member out", site, revoke)
      ->add_option("name", arguments->name, "name of the member")
      ->required();
  for (CLI::App* one : {action("show", "List the members of a site", site, show),
                        action("check", "Check a member's folder", "folder of a member", check)})
    one->add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Example:\n  reident security init site && reident security grant site operator ana\n"
      "Exit status: 2 when it cannot be done, or the folder has a mistake.");
  return [arguments, work] {
    try {
      return (*work)(*arguments);
    } catch (const security::Error& error) {
      return refuse({error.what()});
    }
  };
}

const VerbRegistration registered(
    {"security", "Make, renew, revoke and check the certificates of a secured domain",
     WorksOn::files, declare});

}  // namespace
}  // namespace reident::cli::security_verb
