/* The state of a run, kept in memory or as bytes:
 *
 *   bytes            content
 *   8                "RIDFMU02": what it is, and the version of this form
 *   64               digest of the model, hexadecimal
 *   8                phase
 *   8                1 where a stop time is defined, else 0
 *   8                stop time [s]
 *   8                communication point [s]
 *   8, 8             the clock: whole periods; rest [s]
 *   8                ticks that have run
 *   8 (2q+m+n+p)     parameters (q), their slopes (q), u - u0 of the last tick (m), x (n), y (p)
 *   8                FNV-1a of all bytes before
 *
 * Numbers have their lowest byte first; a double is kept by its bits. The bytes fit any instance of
 * the same model on any machine.
 */
#ifndef REIDENT_SAVED_STATE_H
#define REIDENT_SAVED_STATE_H

#include "run.h"

static const char saved_mark[] = "RIDFMU02";

enum { saved_head = 8 + model_digest_length, saved_fields = 7 };

typedef struct {
  char mark[8];
  char digest[model_digest_length];
  Run run;
} SavedState;

/* Frees the state; NULL is allowed. */
static void saved_free(SavedState* state) {
  if (state == NULL) return;
  free(state->run.values);
  free(state);
}

/* Returns a state of the model with all values 0, which saved_free frees; NULL without memory. */
static SavedState* saved_new(const Model* model) {
  SavedState* const state = calloc(1, sizeof *state);
  if (state == NULL) return NULL;
  memcpy(state->mark, saved_mark, sizeof state->mark);
  memcpy(state->digest, model->digest, sizeof state->digest);
  state->run.values = calloc(run_values(model) + 1, sizeof *state->run.values);
  if (state->run.values != NULL) return state;
  free(state);
  return NULL;
}

/* Whether it is a state of this model. */
static int saved_fits(const SavedState* state, const Model* model) {
  return memcmp(state->mark, saved_mark, sizeof state->mark) == 0 &&
         memcmp(state->digest, model->digest, sizeof state->digest) == 0;
}

/* Returns how many bytes a state of this model takes. */
static size_t saved_size(const Model* model) {
  return saved_head + 8 * (saved_fields + run_values(model) + 1);
}

/* Writes the state as saved_size() bytes. */
static void saved_write(const Model* model, const SavedState* state, unsigned char* bytes) {
  const Run* const run = &state->run;
  unsigned char* at = bytes;
  memcpy(at, state->mark, sizeof state->mark);
  memcpy(at + sizeof state->mark, state->digest, sizeof state->digest);
  at = put_whole(at + saved_head, (uint64_t)run->phase);
  at = put_whole(at, (uint64_t)run->stop_defined);
  at = put_real(at, run->stop_s);
  at = put_real(at, run->point_s);
  at = put_whole(at, (uint64_t)run->clock.periods);
  at = put_real(at, run->clock.rest_s);
  at = put_whole(at, (uint64_t)run->ticks);
  for (size_t i = 0; i < run_values(model); ++i) at = put_real(at, run->values[i]);
  put_whole(at, bytes_checksum(bytes, (size_t)(at - bytes)));
}

/* Whether numbers that came as bytes can be those of a run. Outputs need not be finite:
 * before the first tick those of inputs that were discarded may be kept, and they are computed
 * again before they are read. */
static int fields_are_sound(const Model* model, const Run* run) {
  const int64_t most = INT64_C(1) << 53;
  int finite =
      isfinite(run->stop_s) && isfinite(run->point_s) && fabs(run->clock.rest_s) <= model->period_s;
  for (size_t i = 0; i < run_values(model) - model->outputs; ++i)
    finite = finite && isfinite(run->values[i]);
  return finite && run->clock.periods >= 0 && run->clock.periods <= most && run->ticks >= 0 &&
         run->ticks <= run->clock.periods + 1;
}

/* Reads `size` bytes into `state`, which was made for the model (saved_new). Returns what is wrong
 * with them, or NULL. After a mistake the content of `state` is not to be used. */
static const char* saved_read(const Model* model, const unsigned char* bytes, size_t size,
                              SavedState* state) {
  Run* const run = &state->run;
  if (size != saved_size(model)) return "they are not as many as a state of this model has";
  if (memcmp(bytes, saved_mark, 8) != 0) return "they are no state of this version of the program";
  if (memcmp(bytes + 8, model->digest, model_digest_length) != 0)
    return "they are the state of another model";
  if (get_whole(bytes + size - 8) != bytes_checksum(bytes, size - 8)) return "they are damaged";
  const unsigned char* at = bytes + saved_head;
  const uint64_t phase = get_whole(at), stop = get_whole(at + 8);
  if (phase > phase_event || stop > 1) return "they are damaged";
  run->phase = (Phase)phase;
  run->stop_defined = (int)stop;
  run->stop_s = get_real(at + 16);
  run->point_s = get_real(at + 24);
  run->clock.periods = (int64_t)get_whole(at + 32);
  run->clock.rest_s = get_real(at + 40);
  run->ticks = (int64_t)get_whole(at + 48);
  at += (size_t)8 * saved_fields;
  for (size_t i = 0; i < run_values(model); ++i) run->values[i] = get_real(at + 8 * i);
  return fields_are_sound(model, run) ? NULL : "they are damaged";
}

#endif
