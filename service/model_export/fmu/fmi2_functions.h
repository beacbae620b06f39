/* The functions of FMI 2.0, by way of calls.h. */
#ifndef REIDENT_FMI2_FUNCTIONS_H
#define REIDENT_FMI2_FUNCTIONS_H

#include "calls.h"
#include "fmi2.h"
#include "resource_path.h"
#include "state_calls.h"

/* Doubles % and #, which have meanings in the format that the logger takes. Text that does not fit
 * is cut. */
static void fmi2_escape(const char* text, char* escaped, size_t size) {
  size_t length = 0;
  for (; *text != '\0' && length + 3 < size; ++text) {
    if (*text == '%' || *text == '#') escaped[length++] = *text;
    escaped[length++] = *text;
  }
  escaped[length] = '\0';
}

static void fmi2_hand_over(const Host* host, const char* instance, Status status,
                           const char* category, const char* text) {
  char escaped[2 * message_bytes];
  fmi2_escape(text, escaped, sizeof escaped);
  ((fmi2CallbackLogger)host->logger)(host->environment, instance, (fmi2Status)status, category,
                                     escaped);
}

fmi2String FMI2(GetTypesPlatform)(void) {
  return "default";
}

fmi2String FMI2(GetVersion)(void) {
  return "2.0";
}

fmi2Status FMI2(SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count,
                                 const fmi2String categories[]) {
  (void)on;
  return (fmi2Status)call_set_logging(component, count, categories);
}

/* The callbacks' memory functions are not used. */
fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                fmi2String resources, const fmi2CallbackFunctions* functions,
                                fmi2Boolean visible, fmi2Boolean logging_on) {
  (void)visible, (void)logging_on;
  if (functions == NULL) return NULL;
  const Host host = {"fmi2", fmi2_hand_over, (void (*)(void))functions->logger,
                     functions->componentEnvironment};
  if (!is_request(&host, name, guid, resources)) return NULL;
  if (type != fmi2CoSimulation) {
    log_text(&host, name, status_error, only_co_simulation);
    return NULL;
  }
  char* const path = resource_path(resources, "model.txt");
  Instance* const instance = path == NULL ? NULL : instance_of(&host, name, guid, path);
  if (path == NULL) {
    char text[message_bytes];
    snprintf(text, sizeof text,
             "%s: is no file: URI of a folder, such as file:///tmp/fmu/resources", resources);
    log_text(&host, name, status_error, text);
  }
  free(path);
  return instance;
}

void FMI2(FreeInstance)(fmi2Component component) {
  instance_free(component);
}

fmi2Status FMI2(SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_defined,
                                 fmi2Real tolerance, fmi2Real start_time,
                                 fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  (void)tolerance_defined, (void)tolerance; /* nothing here is iterated */
  return (fmi2Status)call_set_times(component, start_time, stop_time_defined, stop_time,
                                    "SetupExperiment");
}

fmi2Status FMI2(EnterInitializationMode)(fmi2Component component) {
  return (fmi2Status)move_on(component, in_instantiated, phase_initialisation,
                             "EnterInitializationMode");
}

fmi2Status FMI2(ExitInitializationMode)(fmi2Component component) {
  return (fmi2Status)move_on(component, in_initialisation, phase_stepping,
                             "ExitInitializationMode");
}

fmi2Status FMI2(Terminate)(fmi2Component component) {
  return (fmi2Status)move_on(component, in_stepping, phase_terminated, "Terminate");
}

fmi2Status FMI2(Reset)(fmi2Component component) {
  return (fmi2Status)call_reset(component);
}

fmi2Status FMI2(GetReal)(fmi2Component component, const fmi2ValueReference references[],
                         size_t count, fmi2Real values[]) {
  return (fmi2Status)call_get(component, references, count, values, "GetReal");
}

fmi2Status FMI2(SetReal)(fmi2Component component, const fmi2ValueReference references[],
                         size_t count, const fmi2Real values[]) {
  return (fmi2Status)call_set(component, references, count, values, "SetReal");
}

#define FMI2_NO_VARIABLES_OF(type)                                                           \
  fmi2Status FMI2(Get##type)(fmi2Component component, const fmi2ValueReference references[], \
                             size_t count, fmi2##type values[]) {                            \
    (void)references, (void)values;                                                          \
    return (fmi2Status)refuse_type(component, count, #type);                                 \
  }                                                                                          \
  fmi2Status FMI2(Set##type)(fmi2Component component, const fmi2ValueReference references[], \
                             size_t count, const fmi2##type values[]) {                      \
    (void)references, (void)values;                                                          \
    return (fmi2Status)refuse_type(component, count, #type);                                 \
  }

FMI2_NO_VARIABLES_OF(Integer)
FMI2_NO_VARIABLES_OF(Boolean)
FMI2_NO_VARIABLES_OF(String)

fmi2Status FMI2(GetFMUstate)(fmi2Component component, fmi2FMUstate* state) {
  return (fmi2Status)call_get_state(component, state);
}

fmi2Status FMI2(SetFMUstate)(fmi2Component component, fmi2FMUstate state) {
  return (fmi2Status)call_set_state(component, state);
}

fmi2Status FMI2(FreeFMUstate)(fmi2Component component, fmi2FMUstate* state) {
  return (fmi2Status)call_free_state(component, state);
}

fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return (fmi2Status)call_state_size(component, state, size);
}

fmi2Status FMI2(SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                   size_t size) {
  return (fmi2Status)call_write_state(component, state, (unsigned char*)bytes, size);
}

fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                     fmi2FMUstate* state) {
  return (fmi2Status)call_read_state(component, (const unsigned char*)bytes, size, state);
}

fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component component,
                                          const fmi2ValueReference unknowns[], size_t unknown_count,
                                          const fmi2ValueReference knowns[], size_t known_count,
                                          const fmi2Real known_changes[],
                                          fmi2Real unknown_changes[]) {
  (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count;
  (void)known_changes, (void)unknown_changes;
  return (fmi2Status)refuse_call(component, no_directional_derivatives);
}

fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component component,
                                         const fmi2ValueReference references[], size_t count,
                                         const fmi2Integer orders[], const fmi2Real values[]) {
  return (fmi2Status)call_set_slopes(component, references, count, orders, values);
}

fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component component,
                                          const fmi2ValueReference references[], size_t count,
                                          const fmi2Integer orders[], fmi2Real values[]) {
  (void)references, (void)count, (void)orders, (void)values;
  return (fmi2Status)refuse_call(component, no_output_derivatives);
}

fmi2Status FMI2(DoStep)(fmi2Component component, fmi2Real point, fmi2Real step,
                        fmi2Boolean no_earlier_state) {
  (void)no_earlier_state; /* nothing is kept for going back */
  return (fmi2Status)call_step(component, point, step);
}

fmi2Status FMI2(CancelStep)(fmi2Component component) {
  return (fmi2Status)refuse_call(component,
                                 "no step is ever pending: fmi2DoStep returns when it is done");
}

static fmi2Status fmi2_no_status(const Instance* instance) {
  if (instance == NULL) return fmi2Error;
  return (fmi2Status)discard(instance,
                             "this FMU keeps no such status: fmi2DoStep returns when it is done");
}

fmi2Status FMI2(GetStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Status* value) {
  (void)kind, (void)value;
  return fmi2_no_status(component);
}

fmi2Status FMI2(GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real* value) {
  const Instance* const instance = component;
  if (instance == NULL || kind != fmi2LastSuccessfulTime || value == NULL)
    return fmi2_no_status(instance);
  *value = instance->run.point_s;
  return fmi2OK;
}

fmi2Status FMI2(GetIntegerStatus)(fmi2Component component, fmi2StatusKind kind,
                                  fmi2Integer* value) {
  (void)kind, (void)value;
  return fmi2_no_status(component);
}

/* Answers fmi2Terminated alone: this FMU never ends a simulation by itself. */
fmi2Status FMI2(GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind,
                                  fmi2Boolean* value) {
  const Instance* const instance = component;
  if (instance == NULL || kind != fmi2Terminated || value == NULL) return fmi2_no_status(instance);
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status FMI2(GetStringStatus)(fmi2Component component, fmi2StatusKind kind, fmi2String* value) {
  (void)kind, (void)value;
  return fmi2_no_status(component);
}

#endif
