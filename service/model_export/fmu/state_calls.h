/* The calls by which an importer keeps a state of an instance and returns to it. */
#ifndef REIDENT_STATE_CALLS_H
#define REIDENT_STATE_CALLS_H

#include "calls.h"
#include "saved_state.h"

static Status call_get_state(const Instance* instance, void** state) {
  if (!is_in(instance, in_any, "GetFMUstate")) return status_error;
  if (state == NULL) return refuse(instance, "a place for the state is missing");
  if (*state != NULL && !saved_fits(*state, &instance->model))
    return refuse(instance, "the state to be overwritten is not one of this model");
  SavedState* const saved = *state != NULL ? *state : saved_new(&instance->model);
  if (saved == NULL) return refuse(instance, "there is no memory for a state");
  run_copy(&instance->model, &instance->run, &saved->run);
  *state = saved;
  return status_ok;
}

/* Whether a state is there and of this model; refused where it is not. */
static int is_state(const Instance* instance, const void* state, const char* call) {
  if (!is_in(instance, in_any, call)) return 0;
  if (state != NULL && saved_fits(state, &instance->model)) return 1;
  refuse(instance, "%s%s needs a state of this model", instance->host.calls, call);
  return 0;
}

static Status call_set_state(Instance* instance, const void* state) {
  if (!is_state(instance, state, "SetFMUstate")) return status_error;
  run_copy(&instance->model, &((const SavedState*)state)->run, &instance->run);
  return status_ok;
}

static Status call_free_state(const Instance* instance, void** state) {
  if (!is_in(instance, in_any, "FreeFMUstate")) return status_error;
  if (state == NULL || *state == NULL) return status_ok;
  saved_free(*state);
  *state = NULL;
  return status_ok;
}

static Status call_state_size(const Instance* instance, const void* state, size_t* size) {
  if (!is_state(instance, state, "SerializedFMUstateSize")) return status_error;
  if (size == NULL) return refuse(instance, "a place for the size of the state is missing");
  *size = saved_size(&instance->model);
  return status_ok;
}

static Status call_write_state(const Instance* instance, const void* state, unsigned char bytes[],
                               size_t size) {
  if (!is_state(instance, state, "SerializeFMUstate")) return status_error;
  if (bytes == NULL || size < saved_size(&instance->model))
    return refuse(instance, "a state takes %zu bytes", saved_size(&instance->model));
  saved_write(&instance->model, state, bytes);
  return status_ok;
}

static Status call_read_state(const Instance* instance, const unsigned char bytes[], size_t size,
                              void** state) {
  if (!is_in(instance, in_any, "DeSerializeFMUstate")) return status_error;
  if (bytes == NULL || state == NULL)
    return refuse(instance, "reading a state needs bytes and a place for the state");
  SavedState* const saved = saved_new(&instance->model);
  if (saved == NULL) return refuse(instance, "there is no memory for a state");
  const char* const mistake = saved_read(&instance->model, bytes, size, saved);
  if (mistake != NULL) {
    saved_free(saved);
    return refuse(instance, "these bytes are not taken for a state: %s", mistake);
  }
  *state = saved;
  return status_ok;
}

#endif
