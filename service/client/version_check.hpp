// What a simulator asks of a version before it runs it (idl/README.md, "What a receiver refuses",
// and service/DESIGN.md, "Simulators"). Nothing here throws for what a version holds.
#pragma once

#include <optional>
#include <string>

#include "service/model/model_version.hpp"

namespace reident {

/// Why the version must not run: a digest that does not match its content, sizes that disagree or
/// numbers that are not finite, an expression that cannot be evaluated, an unstable A, a tracking
/// gain that does not stabilise the model. Empty when it is sound. Stability takes the eigenvalues
/// of an n x n matrix: call it on a thread that may wait.
std::optional<std::string> damage(const ModelVersion& version);

enum class Succession {
  newer,      // to be run in place of the one that runs
  same,       // the one that runs, published again
  older,      // and not a rollback: to be refused
  different,  // the number that runs with another content: to be refused
};

/// Returns how `version` stands to the one that runs, both of one equipment. Numbers, digests and
/// the mark of a rollback decide; clocks do not.
Succession succession(const ModelVersion& version, const ModelVersion& running);

}  // namespace reident
