// What the codes of outcomes, reasons and alarms mean, in plain words, and what to do about each.
#pragma once

#include <span>
#include <string_view>

namespace reident {

struct GlossaryEntry {
  std::string_view code;
  std::string_view words;    // for a line of a list: "too few samples"
  std::string_view meaning;  // one or two sentences
  std::string_view remedy;   // what to do; empty where nothing is to be done
};

/// All entries, in alphabetical order of their codes.
std::span<const GlossaryEntry> glossary();

/// The entry of a code; null where it is none.
const GlossaryEntry* explanation_of(std::string_view code);

}  // namespace reident
