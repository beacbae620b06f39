#include "service/model/glossary.hpp"

#include <algorithm>
#include <iterator>

namespace reident {
namespace {

struct Glossary {
  static constexpr GlossaryEntry entries[] = {
      {"approved", "approved",
       "Programs before version 0.2 approved the version at its window; it became champion at "
       "once.",
       ""},
      {"better", "better than the champion",
       "On telemetry that it was not fitted to the version errs less than the champion, with the "
       "configured confidence. It became champion.",
       ""},
      {"bias_unverified", "waits: a sensor may be biased",
       "The version is better than the champion but for what a biased sensor would show too, and "
       "no relation of sensors rules that out.",
       "Look whether a sensor that the reason names reads as much too high or too low as it says; "
       "then 'reident reject', or 'approve' where none does. A declared relation, or bias = "
       "\"approve\", decides such cases without you."},
      {"cannot_follow", "the standby cannot follow",
       "The standby cannot record what the leader of its pair sends, or its registry is another "
       "one.",
       "The text says which: mend its disk, or start it with a copy of the leader's database."},
      {"certificate", "a certificate ends",
       "The service's certificate, or another of its files of security, ends within 30, 7 or 1 "
       "days, has "
       "ended, or was changed and is wrong. Once it has ended, nothing is sent or heard.",
       "'reident security renew' in the site's folder, and copy the member's folder; the service "
       "takes it up while it runs."},
      {"challenger", "challenger",
       "The window gave a model that is sound. Telemetry after its window decides whether it "
       "becomes "
       "champion.",
       ""},
      {"champion_failed", "the champion fails",
       "The champion errs more than a constant at the mean, or than the simulator's own "
       "model, "
       "since the last change.",
       "Look at the equipment; 'reident rollback' or 'withdraw'. on_failure = \"withdraw\" does so "
       "by "
       "itself."},
      {"clock", "a clock is wrong",
       "Telemetry is ahead of this machine's clock by more than max_clock_lead, and no window "
       "follows "
       "it; or the clock is before the last window that was tried.",
       "Correct the clock of this machine or of the source."},
      {"closed_loop", "the inputs follow the outputs",
       "A controller makes the inputs from the outputs, so that the model would be the "
       "controller's, "
       "or the equipment by itself is unstable.",
       "Take what drives the loop, such as its reference, as the input."},
      {"constant_inputs", "the inputs did not move",
       "No input changed in the window, so that nothing shows how outputs follow inputs.",
       "Wait for operation that moves them, or choose other inputs."},
      {"constant_outputs", "the outputs did not move",
       "An output did not change in the window, so that any constant describes it.",
       "Wait for operation that moves it, or leave it out."},
      {"damage", "samples are damaged",
       "Samples were found that cannot be decoded. They were set aside.",
       "'reident verify' lists them; archive their telemetry again, or restore a backup."},
      {"disk", "the disk is full or fails",
       "Telemetry cannot be stored, or hardly any room is left. Sources are held back; nothing is "
       "lost.",
       "Make room, or give the archive a max_size."},
      {"error_above_limit", "error above the limit",
       "The model's error on telemetry that it was not fitted to is above max_mrse.",
       "More inputs, a longer window, or a higher limit. The error is relative to the output's "
       "root "
       "mean square: one that moves around 0 has a larger one than one far from it."},
      {"first_version", "the first version",
       "There was no champion, and the version is good on a whole operating cycle.", ""},
      {"held", "waits: the equipment is held",
       "The version is better than the champion, and an operator holds the equipment.",
       "'reident release', or 'reident reject'."},
      {"implausible", "sensors contradict each other",
       "So much of the window was excluded, because sensors contradict each other or themselves, "
       "that "
       "too little is left.",
       "Find the sensor that the reason names; 'reident export' shows its telemetry. Correct or "
       "remove "
       "a wrong relation."},
      {"insufficient_excitation", "too little excitation",
       "The inputs moved too little, or too alike, to tell the dynamics.",
       "Wait for operation that moves them, or a longer window."},
      {"league_full", "others score better",
       "More versions challenged the champion than are kept, and this one had the least mean "
       "score of those that do not wait for an operator, or of all.",
       ""},
      {"low_coverage", "too much telemetry is missing",
       "Too few ticks of the window have every parameter valid.",
       "Look for gaps with 'reident completeness'; widen hold for slow parameters."},
      {"low_coverage_with_derived", "too much telemetry is missing",
       "Too few ticks of the window have every parameter valid and every derived input finite.",
       "Look for gaps with 'reident completeness'; widen hold for slow parameters."},
      {"no_better_than_mean", "no better than the mean",
       "The best model of the window errs no less than a constant at the mean.",
       "More inputs, or a window in which the outputs move."},
      {"no_continuous_time", "no continuous-time model",
       "The discrete model has no continuous-time counterpart, as with a pole at 0 or below.", ""},
      {"no_gain", "no tracking gain", "No gain of the integral feedback lowers the tracking error.",
       ""},
      {"no_model", "no model", "The identification gave no model; the reason says why.", ""},
      {"no_service", "no service runs",
       "Nobody has the configured database open for writing: no telemetry is archived, no model is "
       "refreshed.",
       "Start reidentd; its log says why it ended."},
      {"no_standby", "no standby",
       "The service leads a pair, and nobody follows it: what it decides has no copy, and nobody "
       "takes over.",
       "Start the other service of the pair."},
      {"no_telemetry", "no telemetry comes",
       "No new sample of the equipment came for longer than its slide.",
       "Look for the source; 'reident completeness' shows what came."},
      {"non_finite", "numbers that are not finite",
       "Samples, or the model made of them, hold numbers that are not finite.",
       "Look at the telemetry of the window with 'reident export'."},
      {"not_better", "not better with confidence",
       "The version's record does not show, with the configured confidence, that it errs less than "
       "the champion.",
       ""},
      {"not_better_than_champion", "not better than the champion",
       "On its own validation part the model errs no less than the champion. The champion stays.",
       ""},
      {"not_better_than_mean", "no better than the mean",
       "On telemetry that it was not fitted to the model errs no less than a constant at the mean.",
       "More inputs, a longer window, or a higher limit."},
      {"not_better_than_simulator", "not better than the simulator",
       "The version is not shown to err less than the simulator's own model.", ""},
      {"not_better_where_validated", "not better than the champion",
       "On its own validation part the model errs no less than the champion. The champion stays.",
       ""},
      {"not_compared", "not compared yet",
       "No block of telemetry since the last change of the equipment has been scored with the "
       "version "
       "and the champion both. It waits for telemetry.",
       ""},
      {"not_covered", "has not met all regimes",
       "There were operating regimes that the version has not met, and what it gains "
       "does "
       "not outweigh that.",
       "Telemetry of those regimes decides by itself; 'reident approve' decides now."},
      {"not_finite", "numbers that are not finite",
       "The model or its run holds numbers that are not finite.", ""},
      {"on_probation", "on probation",
       "Programs before version 0.2 let the version wait for more telemetry.", ""},
      {"overruled", "decisions were overruled",
       "A service of the pair decided without the other one, whose later term holds.",
       "Look at the view overruled_decision of the database, and decide again where it matters."},
      {"simulators_old", "simulators run something old",
       "A simulator has run another version than the champion for half a minute.",
       "'reident simulators --old' says what it refused and why, or what it waits for."},
      {"slower_than_window", "slower than the window",
       "A time constant of the model is as long as the window or longer, which cannot tell it from "
       "an "
       "integrator.",
       "A longer window."},
      {"standby_behind", "the standby is behind",
       "A decision was published before the standby of the pair had it.",
       "Look at the disk and the log of the standby."},
      {"still_validation", "nothing to judge it by",
       "An output keeps one value in the part of the window that judges, as a solar array's "
       "current "
       "does in eclipse.",
       "The next window has another part. Where this happens often, make validation_share larger "
       "or "
       "the window longer."},
      {"telemetry_damaged", "telemetry is damaged",
       "Samples that the attempt needs cannot be decoded any more.",
       "Restore them ('reident verify' lists the damage), then 'reident identify-now'."},
      {"too_few_blocks", "too short a record",
       "A first version needs a whole operating cycle of telemetry that it was not fitted to.", ""},
      {"too_few_samples", "too few samples",
       "The window has too few complete samples for a model of the configured orders.",
       "A longer window, or fewer inputs; look for gaps with 'reident completeness'."},
      {"too_soon", "too soon after the champion",
       "The version is better, and min_interval has not passed since the champion's window.", ""},
      {"two_services", "two services",
       "Another service of the partition has the same name, or keeps one of the same equipment.",
       "Stop one of them, or give it another name, partition or equipment."},
      {"unknown_names", "unknown names",
       "The configuration has names that no telemetry has, or telemetry of a spacecraft comes that "
       "is "
       "not configured.",
       "Correct the names; the text says which one is near."},
      {"unknown_parameter", "unknown parameter",
       "Telemetry has not described a parameter of the equipment yet.",
       "Check its name, or wait for its descriptor."},
      {"unstable", "unstable", "The model is unstable: a run of it grows without bound.", ""},
      {"unvouched", "waits: a sensor may be biased",
       "Programs before version 0.2 let the version wait, because a biased sensor could not be "
       "ruled "
       "out.",
       "'reident approve' or 'reject'."},
      {"waiting", "waits for an operator",
       "Programs before version 0.2 let the version wait for an operator.",
       "'reident approve' or 'reject'."},
      {"waits_for_operator", "waits for an operator",
       "The version is better than the champion, and approval = \"by_hand\" asks for an operator.",
       "'reident approve' or 'reject'; 'reident why' has its record."},
      {"within_margin", "better by too little",
       "The version is better on most blocks, but its error over all of them is not less than the "
       "champion's by the configured margin. The champion stays.",
       ""},
      {"worse_before_change", "errs too much before the change",
       "What a change of the equipment did is as much from either side of it: the champion errs by "
       "it on what follows, and a good version on what came before. This one errs more than twice "
       "as much there, or than another version on both sides. It fits the few days since, or one "
       "mode of operation, and not how the equipment is used.",
       "A later window shows more of it. Where the mode is a parameter, name it in 'regimes'."},
      {"worse_in_regime", "worse in an operating regime",
       "The version is worse than the champion, with confidence, in an operating regime that "
       "this has served.",
       "Windows with more of the regime decide by themselves; 'reident approve' decides now."},
      {"worse_over_regimes", "no better over all regimes",
       "Over the operating regimes since the last change of the equipment, each with its share of "
       "the time, the version errs no less than the champion. It was run on the last cycles of "
       "those that its record does not have.",
       "Telemetry decides by itself, as the share of what is now grows; where the equipment has "
       "changed and no change was found, 'reident approve' decides now."},
  };
};

}  // namespace

std::span<const GlossaryEntry> glossary() {
  return Glossary::entries;
}

const GlossaryEntry* explanation_of(std::string_view code) {
  const auto* found = std::find_if(std::begin(Glossary::entries), std::end(Glossary::entries),
                                   [code](const GlossaryEntry& one) { return one.code == code; });
  return found == std::end(Glossary::entries) ? nullptr : found;
}

}  // namespace reident
