#include "service/satcs/programs.hpp"

int main(int argc, char** argv) {
  return reident::satcs::reference_main(argc, argv);
}
