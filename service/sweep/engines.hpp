// How the engines of a site are given the tasks of a sweep. An engine places and repeats them; what
// a task does is `reident sweep FOLDER --task N` and `--judge N` on any machine that sees the
// folder.
#pragma once

#include <string>
#include <vector>

#include "service/sweep/plan.hpp"

namespace reident::sweep {

/// Numbers as the option --array of Slurm's sbatch takes them, such as "0-3,7". They ascend.
std::string array_of(const std::vector<std::size_t>& numbers);

/// Submits the tasks without a result to Slurm as two job arrays, the second of which begins when
/// the first has ended: a spacecraft whose candidates failed keeps no other. sbatch takes further
/// options from its environment (SBATCH_PARTITION and others). Returns the ids of the jobs. Throws
/// std::runtime_error where sbatch fails.
std::vector<std::string> submit_to_slurm(const Plan& plan);

/// Returns a Kubernetes manifest of two indexed Jobs of the image; the second one is suspended.
/// Throws std::invalid_argument where an archive is outside of the folder, which is all that the
/// pods mount.
std::string kubernetes_manifest(const Plan& plan, const std::string& image);

}  // namespace reident::sweep
