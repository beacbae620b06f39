// The programs that publish files and simulated telemetry. Their command lines are compiled in one
// unit: to instantiate CLI11 costs five seconds in each.
#pragma once

namespace reident::satcs {

/// satcs-replay: the rows of a file. Returns the exit status.
int replay_main(int argc, char** argv);

/// satcs-reference: the reference spacecraft. Returns the exit status.
int reference_main(int argc, char** argv);

}  // namespace reident::satcs
