/* The state of a run, kept in memory or as bytes:
 *
 *   8 bytes    "RIDFMU01": what it is, and the version of this form
 *   64 bytes   digest of the model
 *   8 bytes    each: phase, whether a stop time is defined, start and stop time, communication
 * point, whole periods and rest of the clock, ticks that have run 8 bytes    each: parameters, u -
 * u0 of the last tick, x, y 8 bytes    FNV-1a of all before
 *
 * Lowest byte first, doubles by their bits.
 */
#ifndef REIDENT_SAVED_STATE_H
#define REIDENT_SAVED_STATE_H

#include "run.h"

static const char saved_mark[] = "RIDFMU01";

enum { saved_head = 8 + model_digest_length, saved_fields = 7 };

typedef struct {
  char mark[8];
  char digest[model_digest_length];
  Run run;
} SavedState;

static void saved_free(SavedState* state) {
  if (state == NULL) return;
  free(state->run.values);
  free(state);
}

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

static size_t saved_size(const Model* model) {
  return saved_head + 8 * (saved_fields + run_values(model) + 1);
}

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

static int fields_are_sound(const Model* model, const Run* run) {
  const int64_t most = INT64_C(1) << 53;
  int finite =
      isfinite(run->stop_s) && isfinite(run->point_s) && fabs(run->clock.rest_s) <= model->period_s;
  for (size_t i = 0; i < run_values(model) - model->outputs; ++i)
    finite = finite && isfinite(run->values[i]);
  return finite && run->clock.periods >= 0 && run->clock.periods <= most && run->ticks >= 0 &&
         run->ticks <= run->clock.periods + 1;
}

/* What is wrong with the bytes, or NULL and the state in `state`, which was made for the model. */
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
  if (phase > phase_terminated || stop > 1) return "they are damaged";
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
