// What a simulator asks of a version before it runs it.
#pragma once

#include <optional>
#include <string>

#include "service/model/model_version.hpp"

namespace reident {

/// Why the version must not run: a digest that does not match its content, sizes that disagree or
/// numbers that are not finite, an expression that cannot be evaluated, an unstable A, a tracking
/// gain that does not stabilise the model. Empty when it is sound.
std::optional<std::string> damage(const ModelVersion& version);

enum class Succession {
  newer,      // to be run in place of the one that runs
  same,       // the one that runs, published again
  older,      // and not a rollback: to be refused
  different,  // the number that runs with another content: to be refused
};

/// How `version` stands to the one that runs, both of one equipment.
Succession succession(const ModelVersion& version, const ModelVersion& running);

}  // namespace reident
