/* Any text is a model that runs or is refused, and any bytes are a state of it or are refused; the
 * first byte says which, or that places and new bytes of a good model follow. What is read has the
 * checksum that it needs, so that all of it is read. */
#include <stdlib.h>

#include "service/model_export/fmu/saved_state.h"

/* Returns whether it ran. */
static int run_model(const uint8_t* data, size_t size) {
  Model model;
  memset(&model, 0, sizeof model);
  char* const text = malloc(size + 27);
  memcpy(text, data, size);
  snprintf(text + size, 27, "checksum %016llx\n", (unsigned long long)bytes_checksum(data, size));
  const int runs = model_parse(text, size + 26, &model) == NULL;
  if (runs) {
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
  return runs;
}

static const char good_model[] =
    "reident-fmu-model 2\n"
    "digest 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n"
    "period 0x1p-1\norder 2 inputs 2 outputs 1 parameters 2\nstart 0x1p+0 -0x1.8p+1\n"
    "state 0x0p+0 0x1p+0\nA 0x1p-1 0x0p+0 0x1p-3 0x1.cp-1\nB 0x1p+0 0x0p+0 0x0p+0 0x1p+0\n"
    "C 0x1p+0 0x1p-2\nD 0x0p+0 0x1p-4\nu0 0x1p+0 0x0p+0\ny0 0x1.4p+2\n"
    "input 1 p0\ninput 6 p1 abs 0x1p+1 p0 max ^\n";

static void run_changed_model(const uint8_t* data, size_t size) {
  uint8_t text[sizeof good_model - 1];
  memcpy(text, good_model, sizeof text);
  const int is_changed = size >= 3;
  for (; size >= 3; data += 3, size -= 3) text[(data[0] + 256U * data[1]) % sizeof text] = data[2];
  if (!run_model(text, sizeof text) && !is_changed) abort();
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
  else if (data[0] == 'c')
    run_changed_model(data + 1, size - 1);
  else
    run_model(data, size);
  return 0;
}
