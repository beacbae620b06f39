/* The functions of FMI 3.0 that co-simulation needs, by way of calls.h. */
#ifndef REIDENT_FMI3_FUNCTIONS_H
#define REIDENT_FMI3_FUNCTIONS_H

#include "calls.h"
#include "fmi3.h"

static void fmi3_hand_over(const Host* host, const char* instance, Status status,
                           const char* category, const char* text) {
  (void)instance; /* an environment belongs to one instance */
  ((fmi3LogMessageCallback)host->logger)(host->environment, (fmi3Status)status, category, text);
}

fmi3String FMI3(GetVersion)(void) {
  return "3.0";
}

fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t count,
                                 const fmi3String categories[]) {
  (void)on;
  return (fmi3Status)call_set_logging(instance, count, categories);
}

fmi3Instance FMI3(InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
    fmi3IntermediateUpdateCallback intermediate_update) {
  (void)visible, (void)logging_on, (void)early_return_allowed;
  (void)intermediate, (void)intermediate_count, (void)intermediate_update;
  const Host host = {"fmi3", fmi3_hand_over, (void (*)(void))log_message, environment};
  if (!is_request(&host, name, token, resource_path)) return NULL;
  char* const path = malloc(strlen(resource_path) + sizeof "/model.txt");
  if (path == NULL) return NULL;
  strcpy(path, resource_path);
  strcat(path, "/model.txt"); /* the path may end in a separator: two are one */
  Instance* const instance = instance_of(&host, name, token, path);
  free(path);
  if (instance != NULL) instance->has_event_mode = event_mode_used;
  return instance;
}

void FMI3(FreeInstance)(fmi3Instance instance) {
  instance_free(instance);
}

fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                         fmi3Float64 tolerance, fmi3Float64 start_time,
                                         fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
  static const char call[] = "EnterInitializationMode";
  (void)tolerance_defined, (void)tolerance; /* nothing here is iterated */
  const Status status = call_set_times(instance, start_time, stop_time_defined, stop_time, call);
  if (status != status_ok) return (fmi3Status)status;
  return (fmi3Status)move_on(instance, in_instantiated, phase_initialisation, call);
}

fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance) {
  const Instance* const one = instance;
  return (fmi3Status)move_on(instance, in_initialisation,
                             one != NULL && one->has_event_mode ? phase_event : phase_stepping,
                             "ExitInitializationMode");
}

/* In event mode the importer sets the inputs of this very time, which outputs follow at once. */
fmi3Status FMI3(EnterEventMode)(fmi3Instance instance) {
  const Instance* const one = instance;
  if (one != NULL && !one->has_event_mode)
    return (fmi3Status)refuse_call(one, "event mode was not asked for at the instantiation");
  return (fmi3Status)move_on(instance, in_stepping, phase_event, "EnterEventMode");
}

fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean* need_update,
                                      fmi3Boolean* terminate, fmi3Boolean* nominals_changed,
                                      fmi3Boolean* states_changed, fmi3Boolean* next_event_defined,
                                      fmi3Float64* next_event_time) {
  if (!is_in(instance, in_event, "UpdateDiscreteStates")) return fmi3Error;
  if (need_update) *need_update = false;
  if (terminate) *terminate = false;
  if (nominals_changed) *nominals_changed = false;
  if (states_changed) *states_changed = false;
  if (next_event_defined) *next_event_defined = false;
  if (next_event_time) *next_event_time = 0;
  return fmi3OK;
}

fmi3Status FMI3(EnterStepMode)(fmi3Instance instance) {
  return (fmi3Status)move_on(instance, in_event, phase_stepping, "EnterStepMode");
}

fmi3Status FMI3(Terminate)(fmi3Instance instance) {
  return (fmi3Status)move_on(instance, in_stepping | in_event, phase_terminated, "Terminate");
}

fmi3Status FMI3(Reset)(fmi3Instance instance) {
  return (fmi3Status)call_reset(instance);
}

static fmi3Status fmi3_refuse_sizes(const Instance* instance) {
  return (fmi3Status)refuse_call(instance,
                                 "as many values as references are needed: all are scalars");
}

fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
                            size_t count, fmi3Float64 values[], size_t value_count) {
  if (count != value_count) return fmi3_refuse_sizes(instance);
  return (fmi3Status)call_get(instance, references, count, values, "GetFloat64");
}

fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
                            size_t count, const fmi3Float64 values[], size_t value_count) {
  if (count != value_count) return fmi3_refuse_sizes(instance);
  return (fmi3Status)call_set(instance, references, count, values, "SetFloat64");
}

fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState* state) {
  return (fmi3Status)call_get_state(instance, state);
}

fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state) {
  return (fmi3Status)call_set_state(instance, state);
}

fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState* state) {
  return (fmi3Status)call_free_state(instance, state);
}

fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t* size) {
  return (fmi3Status)call_state_size(instance, state, size);
}

fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                   size_t size) {
  return (fmi3Status)call_write_state(instance, state, bytes, size);
}

fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                     fmi3FMUState* state) {
  return (fmi3Status)call_read_state(instance, bytes, size, state);
}

fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 point, fmi3Float64 step,
                        fmi3Boolean no_earlier_state, fmi3Boolean* event_needed,
                        fmi3Boolean* terminate, fmi3Boolean* early_return,
                        fmi3Float64* last_successful_time) {
  (void)no_earlier_state; /* nothing is kept for going back */
  const Status status = call_step(instance, point, step);
  if (event_needed) *event_needed = false;
  if (terminate) *terminate = false;
  if (early_return) *early_return = false;
  if (last_successful_time && instance) *last_successful_time = ((Instance*)instance)->run.point_s;
  return (fmi3Status)status;
}

#define FMI3_NO_VARIABLES_OF(type)                                                                 \
  FMI3_API fmi3Status FMI3(Get##type)(fmi3Instance instance, const fmi3ValueReference* references, \
                                      size_t count, fmi3##type* values, size_t value_count) {      \
    (void)references, (void)values, (void)value_count;                                             \
    return (fmi3Status)refuse_type(instance, count, #type);                                        \
  }                                                                                                \
  FMI3_API fmi3Status FMI3(Set##type)(fmi3Instance instance, const fmi3ValueReference* references, \
                                      size_t count, const fmi3##type* values,                      \
                                      size_t value_count) {                                        \
    (void)references, (void)values, (void)value_count;                                             \
    return (fmi3Status)refuse_type(instance, count, #type);                                        \
  }

FMI3_NO_VARIABLES_OF(Float32)
FMI3_NO_VARIABLES_OF(Int8)
FMI3_NO_VARIABLES_OF(UInt8)
FMI3_NO_VARIABLES_OF(Int16)
FMI3_NO_VARIABLES_OF(UInt16)
FMI3_NO_VARIABLES_OF(Int32)
FMI3_NO_VARIABLES_OF(UInt32)
FMI3_NO_VARIABLES_OF(Int64)
FMI3_NO_VARIABLES_OF(UInt64)
FMI3_NO_VARIABLES_OF(Boolean)
FMI3_NO_VARIABLES_OF(String)

#endif
