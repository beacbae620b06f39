/* Any text is a model that runs or is refused, and any bytes are a state of it or are refused; the
 * first byte says which. What follows has the checksum that it needs, so that all of it is read. */
#include <stdlib.h>

#include "service/model_export/fmu/saved_state.h"

static void run_model(const uint8_t* data, size_t size) {
  Model model;
  memset(&model, 0, sizeof model);
  char* const text = malloc(size + 27);
  memcpy(text, data, size);
  snprintf(text + size, 27, "checksum %016llx\n", (unsigned long long)bytes_checksum(data, size));
  if (model_parse(text, size + 26, &model) == NULL) {
    Run run = {.values = calloc(run_values(&model) + 1, sizeof(double))};
    double* const room = calloc(model.inputs + model.order + 1, sizeof(double));
    run_reset(&model, &run);
    inputs_of(&model, &run, run.values, room);
    tick(&model, room, run_state(&model, &run), run_outputs(&model, &run), room + model.inputs);
    free(room);
    free(run.values);
  }
  model_free(&model);
  free(text);
}

static void read_state(const uint8_t* data, size_t size) {
  Model model = {.period_s = 0.5, .order = 1, .inputs = 1, .outputs = 1, .parameters = 1};
  memset(model.digest, 'd', model_digest_length);
  const size_t whole = saved_size(&model);
  unsigned char* const bytes = calloc(whole, 1);
  memcpy(bytes, saved_mark, 8);
  memcpy(bytes + 8, model.digest, model_digest_length);
  const size_t room = whole - saved_head - 8;
  memcpy(bytes + saved_head, data, size < room ? size : room);
  put_whole(bytes + whole - 8, bytes_checksum(bytes, whole - 8));
  SavedState* const state = saved_new(&model);
  if (saved_read(&model, bytes, whole, state) == NULL) {
    const double tolerance = clock_tolerance(model.period_s, state->run.point_s);
    const Clock clock = clock_after(state->run.clock, 0.7, model.period_s, tolerance);
    if (clock_ticks(clock, tolerance) < 0) abort();
  }
  saved_free(state);
  free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  if (data[0] == 's')
    read_state(data + 1, size - 1);
  else
    run_model(data, size);
  return 0;
}
