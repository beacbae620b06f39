/* An FMU for co-simulation (FMI 2.0 and 3.0) of one identified model, which it reads from its
 * resources. modelDescription.xml says by which version it is called.
 *
 * This is the one file to compile; all else is included:
 *
 *   cc -std=c11 -O2 -ffp-contract=off -fPIC -fvisibility=hidden -shared reident_fmu.c -lm \
 *      -o NAME.so
 */
#include "fmi2_functions.h"
#include "fmi3_functions.h"
#include "fmi3_refused.h"
