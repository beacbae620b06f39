// How much an output moves in a step around a swap, over the larger of the two models' own, for
// seeds 1 to PAIRS of tests/support/version_pairs.hpp. Prints one number a line.
//   reident_jump_bench PAIRS
#include <cstdio>
#include <cstdlib>

#include "tests/support/swap_jump.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: reident_jump_bench PAIRS\n");
    return 2;
  }
  const std::uint64_t pairs = std::strtoull(argv[1], nullptr, 10);
  for (std::uint64_t seed = 1; seed <= pairs; ++seed)
    std::printf("%.6f\n", reident::test::swap_in_mid_run(seed).jump);
}
