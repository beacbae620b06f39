// The registry's rows in the order of their recording, for the services of a pair: what one
// records, the other adds to its own database, with the same ids.
//
// Positions count the rows from 1 without a hole. The journal of a registry that is of no pair is
// empty; its first term gives a position to every row that there is. service/DESIGN.md, "A pair of
// services", has the rules that terms follow.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/database/database.hpp"
#include "storage/types/journal.hpp"

namespace reident::storage {

/// The journal in a database; what is not const needs one that is opened for writing. Every
/// function may throw Error where the file or the disk refuses, and nothing is changed then.
class Journal {
 public:
  /// The database must outlive the journal.
  explicit Journal(Database& database);

  /// Ascending; the last one is that of the rows that are recorded now.
  std::vector<Term> terms() const;
  /// Position of the last row; 0 before the first term.
  std::int64_t last() const;
  /// Whether the registry has rows and no term.
  bool is_of_no_pair() const;

  /// Begins a term, whose number is above those of all others.
  void begin_term(std::int64_t number, const std::string& service, Time now);

  /// Whether `service` may record in this registry without a pair: it has no term, or the last one
  /// is its own.
  bool is_of(const std::string& service) const;
  /// Begins a term of the service, where the last one is another's: what is recorded from now on is
  /// of no term that the other one of a former pair has.
  void leave_pair(const std::string& service, Time now);

  /// Rows after a position: as many as `bytes` hold, and one at least where there is one.
  JournalPart part(std::int64_t after, std::size_t bytes) const;

  /// Adds rows that another service recorded, to a journal that ends at `part.after`, or beyond
  /// it: then those that are there already are left out. Returns the ids of the attempts among
  /// those added. Throws Error (failed) where they do not follow or cannot be added; Error
  /// (corrupt) where they are none.
  std::vector<std::int64_t> apply(const JournalPart& part);

  /// Moves the rows of this journal after the position `end` to the table `overruled`: the other
  /// service has recorded others in a later term.
  void overrule(std::int64_t end, Time now);
  /// Adds to the table `overruled` what `service` recorded from `part.after` on, in the term
  /// `term` and later ones, and had to give up.
  void keep_overruled(const JournalPart& part, std::int64_t term, const std::string& service,
                      Time now);
  /// Term of the row at a position that exists.
  std::int64_t term_at(std::int64_t position) const;

  struct Overruled {
    std::int64_t decisions = 0;  // about champions, holds, and commands
    std::string service;         // whose, of the last one
  };
  /// What was overruled since a time; absent where nothing was.
  std::optional<Overruled> overruled_since(Time time) const;

 private:
  Database& database_;
};

}  // namespace reident::storage
