// reident_identification_bench: reident's side of the comparison with other tools.
#include <cstdio>
#include <exception>

#include "tests/bench/identification/modes.hpp"

int main(int argc, char** argv) {
  CLI::App app("Measures reident's identification on files of samples");
  app.require_subcommand(1);
  reident::bench::add_generate(app);
  reident::bench::add_identify(app);
  reident::bench::add_score(app);
  reident::bench::add_subspace(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reident_identification_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
