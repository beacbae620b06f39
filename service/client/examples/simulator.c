/* Runs the approved model of a battery discharge regulator on made-up currents, once a second.
 *   simulator [STEPS [DOMAIN [PARTITION]]] */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <threads.h>

#include <reident/client.h>

int main(int argc, char** argv) {
  const int steps = argc > 1 ? atoi(argv[1]) : 60;
  const char* equipment[] = {"BDR"};
  reident_options options;
  reident_options_init(&options);
  if (argc > 2) options.domain = (uint32_t)atoi(argv[2]);
  if (argc > 3) options.partition = argv[3];
  options.spacecraft = "CBERS-4";
  options.equipment = equipment, options.equipment_count = 1;
  reident_client* client = reident_client_open(&options);
  const reident_signal in[] = {{"I_BDRIN1", "A"}, {"I_BDRIN2", "A"}}, out = {"I_BDROUT", "A"};
  reident_runner* bdr = NULL;
  if (client) bdr = reident_runner_open(client, "CBERS-4", "BDR", in, 2, &out, 1);
  if (!bdr) return fprintf(stderr, "%s\n", reident_last_error()), 1;
  for (int k = 0; k < steps; ++k) {
    const double u[] = {1 + 0.01 * (k % 50), 0.5};
    double y;
    const bool has_model = (reident_step(bdr, u, &y) & REIDENT_NO_MODEL) == 0;
    reident_event event = {.size = sizeof event};
    while (reident_next_event(client, &event, 0) == 1)
      printf("%s: %s\n", event.equipment, event.text);
    reident_runner_state state = {.size = sizeof state};
    reident_runner_get_state(bdr, &state);
    if (!has_model) printf("step %d: no model yet\n", k);
    if (has_model) printf("step %d: version %" PRId64 ", I_BDROUT %.4f A\n", k, state.version, y);
    thrd_sleep(&(struct timespec){.tv_sec = 1}, NULL);
  }
  reident_client_close(client);
}
