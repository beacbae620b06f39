/* One instance of the FMU, and what it says to whoever runs it. Nothing here depends on the version
 * of the standard: fmi2_functions.h and fmi3_functions.h turn their calls into those of calls.h. */
#ifndef REIDENT_INSTANCE_H
#define REIDENT_INSTANCE_H

#include <stdarg.h>

#include "run.h"

/* How a call ended. Both versions of the standard give these numbers their names. */
typedef enum { status_ok, status_warning, status_discard, status_error } Status;

/* Who runs the instance, by which version of the standard. */
typedef struct Host {
  const char* calls; /* what the names of calls begin with: "fmi2" */
  /* Hands a message to `logger`, which is not NULL. */
  void (*hand_over)(const struct Host* host, const char* instance, Status status,
                    const char* category, const char* text);
  void (*logger)(void); /* of a type that hand_over knows; NULL where there is none */
  void* environment;
} Host;

/* What an instantiation makes and instance_free() ends. Instances share nothing, so that any number
 * may run in one process, each on one thread at a time. */
typedef struct {
  Model model;
  Run run;
  double*
      scratch; /* du (m), next x (n), copies of du, x and y (m + n + p), parameters at a tick (q) */
  char* name;
  Host host;
  int has_event_mode; /* whether the host uses it */
} Instance;

enum { message_bytes = 600 };

/* Hands `text` to the logger, where there is one, under the category of `status`. */
static void log_text(const Host* host, const char* name, Status status, const char* text) {
  if (host->logger == NULL) return;
  host->hand_over(host, name, status,
                  status == status_warning   ? "logStatusWarning"
                  : status == status_discard ? "logStatusDiscard"
                                             : "logStatusError",
                  text);
}

/* Logs a message of at most message_bytes and returns `status`. */
static Status say(const Instance* instance, Status status, const char* format, va_list values) {
  char text[message_bytes];
  vsnprintf(text, sizeof text, format, values);
  log_text(&instance->host, instance->name, status, text);
  return status;
}

#if defined(__GNUC__)
#define LIKE_PRINTF __attribute__((format(printf, 2, 3)))
#else
#define LIKE_PRINTF
#endif

/* A call that must not be made so. It changes nothing. */
static LIKE_PRINTF Status refuse(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const Status status = say(instance, status_error, format, values);
  va_end(values);
  return status;
}

/* A call that cannot be answered for the values of now. It changes nothing. */
static LIKE_PRINTF Status discard(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const Status status = say(instance, status_discard, format, values);
  va_end(values);
  return status;
}

/* A call that was carried out, but not quite as it was meant. */
static LIKE_PRINTF Status warn(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const Status status = say(instance, status_warning, format, values);
  va_end(values);
  return status;
}

static const char* phase_name(Phase phase) {
  switch (phase) {
    case phase_instantiated:
      return "before initialisation";
    case phase_initialisation:
      return "in initialisation mode";
    case phase_stepping:
      return "between steps";
    case phase_event:
      return "in event mode";
    default:
      return "terminated";
  }
}

/* Whether the instance is in one of `phases`, a sum of 1 << phase; refused where it is not. `call`
 * is its name without the prefix of the standard. */
static int is_in(const Instance* instance, int phases, const char* call) {
  if (instance == NULL) return 0;
  if (phases >> instance->run.phase & 1) return 1;
  refuse(instance, "%s%s must not be called %s", instance->host.calls, call,
         phase_name(instance->run.phase));
  return 0;
}

/* Frees the instance and all that it owns; NULL is allowed. */
static void instance_free(Instance* instance) {
  if (instance == NULL) return;
  model_free(&instance->model);
  free(instance->run.values);
  free(instance->scratch);
  free(instance->name);
  free(instance);
}

/* Gives the instance a run of the model that was read for it, at its start. Returns what is wrong
 * with the model, or NULL. */
static const char* instance_prepare(Instance* instance, const char* token) {
  const Model* const model = &instance->model;
  if (strcmp(model->digest, token) != 0)
    return "it holds the model of another guid: modelDescription.xml and resources do not belong "
           "together";
  instance->run.values = calloc(run_values(model) + 1, sizeof *instance->run.values);
  instance->scratch =
      calloc(2 * model->inputs + 2 * model->order + model->outputs + model->parameters + 1,
             sizeof *instance->scratch);
  if (instance->run.values == NULL || instance->scratch == NULL) return "there is no memory for it";
  run_reset(model, &instance->run);
  return NULL;
}

/* Returns an instance of the model in the file `path`; NULL, and a message, where there is none.
 * `token` is the guid or the instantiation token of modelDescription.xml. */
static Instance* instance_of(const Host* host, const char* name, const char* token,
                             const char* path) {
  char text[message_bytes];
  Instance* const instance = calloc(1, sizeof *instance);
  const char* mistake = NULL;
  if (instance == NULL || (instance->name = malloc(strlen(name) + 1)) == NULL) {
    mistake = "there is no memory for an instance";
  } else {
    strcpy(instance->name, name);
    instance->host = *host;
    mistake = model_read(path, &instance->model);
    if (mistake == NULL) mistake = instance_prepare(instance, token);
  }
  if (mistake == NULL) return instance;
  snprintf(text, sizeof text, "%s: %s", path, mistake);
  log_text(host, name, status_error, text);
  instance_free(instance);
  return NULL;
}

/* Whether an instance is asked for with all that it needs; logged where it is not. */
static int is_request(const Host* host, const char* name, const char* token,
                      const char* resources) {
  const char* const mistake =
      name == NULL || *name == '\0' ? "an instance needs a name"
      : token == NULL     ? "the guid or instantiation token of modelDescription.xml is missing"
      : resources == NULL ? "the place of the unpacked resources is missing"
                          : NULL;
  if (mistake != NULL) log_text(host, name == NULL ? "" : name, status_error, mistake);
  return mistake == NULL;
}

#endif
