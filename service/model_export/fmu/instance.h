/* One instance of the FMU, and what it says to whoever runs it. */
#ifndef REIDENT_INSTANCE_H
#define REIDENT_INSTANCE_H

#include <stdarg.h>

#include "fmi2.h"
#include "resource_path.h"
#include "run.h"

/* What fmi2Instantiate makes and fmi2FreeInstance ends. Instances share nothing, so that any number
 * may run in one process, each on one thread at a time. */
typedef struct {
  Model model;
  Run run;
  double* scratch; /* du (m), next x (n), a copy of x and y (n + p) */
  char* name;
  fmi2CallbackLogger logger;
  fmi2ComponentEnvironment environment;
} Instance;

enum { message_bytes = 600 };

/* Doubles % and #, which have meanings in the format that the logger takes. Text that does not fit
 * is cut. */
static void escape(const char* text, char* escaped, size_t size) {
  size_t length = 0;
  for (; *text != '\0' && length + 3 < size; ++text) {
    if (*text == '%' || *text == '#') escaped[length++] = *text;
    escaped[length++] = *text;
  }
  escaped[length] = '\0';
}

/* Hands `text` to the logger, where there is one, under the category of `status`. */
static void log_text(fmi2CallbackLogger logger, fmi2ComponentEnvironment environment,
                     const char* name, fmi2Status status, const char* text) {
  char escaped[2 * message_bytes];
  if (logger == NULL) return;
  escape(text, escaped, sizeof escaped);
  logger(environment, name, status,
         status == fmi2Warning   ? "logStatusWarning"
         : status == fmi2Discard ? "logStatusDiscard"
                                 : "logStatusError",
         escaped);
}

/* Logs a message of at most message_bytes and returns `status`. */
static fmi2Status say(const Instance* instance, fmi2Status status, const char* format,
                      va_list values) {
  char text[message_bytes];
  vsnprintf(text, sizeof text, format, values);
  log_text(instance->logger, instance->environment, instance->name, status, text);
  return status;
}

#if defined(__GNUC__)
#define LIKE_PRINTF __attribute__((format(printf, 2, 3)))
#else
#define LIKE_PRINTF
#endif

/* A call that must not be made so. It changes nothing. */
static LIKE_PRINTF fmi2Status refuse(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const fmi2Status status = say(instance, fmi2Error, format, values);
  va_end(values);
  return status;
}

/* A call that cannot be answered for the values of now. It changes nothing. */
static LIKE_PRINTF fmi2Status discard(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const fmi2Status status = say(instance, fmi2Discard, format, values);
  va_end(values);
  return status;
}

/* A call that was carried out, but not quite as it was meant. */
static LIKE_PRINTF fmi2Status warn(const Instance* instance, const char* format, ...) {
  va_list values;
  va_start(values, format);
  const fmi2Status status = say(instance, fmi2Warning, format, values);
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
    default:
      return "terminated";
  }
}

/* Whether the instance is in one of `phases`, a sum of 1 << phase; refused where it is not. */
static int is_in(const Instance* instance, int phases, const char* call) {
  if (instance == NULL) return 0;
  if (phases >> instance->run.phase & 1) return 1;
  refuse(instance, "%s must not be called %s", call, phase_name(instance->run.phase));
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
static const char* instance_prepare(Instance* instance, const char* guid) {
  const Model* const model = &instance->model;
  if (strcmp(model->digest, guid) != 0)
    return "it holds the model of another guid: modelDescription.xml and resources do not belong "
           "together";
  instance->run.values = calloc(run_values(model) + 1, sizeof *instance->run.values);
  instance->scratch =
      calloc(model->inputs + 2 * model->order + model->outputs + 1, sizeof *instance->scratch);
  if (instance->run.values == NULL || instance->scratch == NULL) return "there is no memory for it";
  run_reset(model, &instance->run);
  return NULL;
}

/* Returns what is wrong with the way in which an instance is asked for, or NULL. */
static const char* request_mistake(fmi2String name, fmi2Type type, fmi2String guid,
                                   fmi2String resources) {
  if (name == NULL || *name == '\0') return "an instance needs a name";
  if (type != fmi2CoSimulation) return "this FMU is for co-simulation alone";
  if (guid == NULL) return "the guid of modelDescription.xml is missing";
  if (resources == NULL) return "the URI of the unpacked resources is missing";
  return NULL;
}

/* Returns an instance of the model in the folder that the URI `resources` names; NULL, and a
 * message, where there is none. The callbacks' memory functions are not used. */
static Instance* instance_of(const fmi2CallbackFunctions* functions, fmi2String name,
                             fmi2String guid, fmi2String resources) {
  char text[message_bytes];
  char* const path = resource_path(resources, "model.txt");
  Instance* const instance = calloc(1, sizeof *instance);
  const char* mistake = NULL;
  if (path == NULL) {
    mistake = "is no file: URI of a folder, such as file:///tmp/fmu/resources";
  } else if (instance == NULL || (instance->name = malloc(strlen(name) + 1)) == NULL) {
    mistake = "there is no memory for an instance";
  } else {
    strcpy(instance->name, name);
    instance->logger = functions->logger;
    instance->environment = functions->componentEnvironment;
    mistake = model_read(path, &instance->model);
    if (mistake == NULL) mistake = instance_prepare(instance, guid);
  }
  if (mistake != NULL) {
    snprintf(text, sizeof text, "%s: %s", path == NULL ? resources : path, mistake);
    log_text(functions->logger, functions->componentEnvironment, name, fmi2Error, text);
    instance_free(instance);
  }
  free(path);
  return mistake == NULL ? instance : NULL;
}

#endif
