#include "service/satcs/programs.hpp"

int main(int argc, char** argv) {
  return reident::satcs::replay_main(argc, argv);
}
