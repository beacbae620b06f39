// The modes of reident_identification_bench, each a subcommand that prints one JSON object.
#pragma once

#include <filesystem>
#include <vector>

#include <CLI/CLI.hpp>

#include "identification/samples/record.hpp"

namespace reident::bench {

void add_generate(CLI::App& app);
void add_identify(CLI::App& app);  // one-shot, slide and automatic
void add_score(CLI::App& app);
void add_subspace(CLI::App& app);

/// The file of samples as one segment with a period of 1 s. Throws std::runtime_error.
identification::Record read_record(const std::filesystem::path& file);

/// Moduli of the eigenvalues of A, descending: the basis of a state is arbitrary, its poles are
/// not.
std::vector<double> pole_moduli(const identification::Matrix& A);

}  // namespace reident::bench
