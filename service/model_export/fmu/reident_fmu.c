/* An FMU for co-simulation (FMI 2.0) of one identified model, which it reads from its resources.
 *
 * This is the one file to compile; all else is included:
 *
 *   cc -std=c11 -O2 -ffp-contract=off -fPIC -fvisibility=hidden -shared reident_fmu.c -lm \
 *      -o NAME.so
 *
 * A step [t, t + h) runs the ticks in it, each with the inputs that are set. Between ticks the
 * outputs hold. Before the first tick they are those that it would give. A call that is refused
 * (fmi2Error) or cannot be answered (fmi2Discard) changes nothing and says why by the logger.
 */
#include "instance.h"
#include "saved_state.h"

enum {
  in_instantiated = 1 << phase_instantiated,
  in_initialisation = 1 << phase_initialisation,
  in_stepping = 1 << phase_stepping,
  in_terminated = 1 << phase_terminated,
  in_any = in_instantiated | in_initialisation | in_stepping | in_terminated
};

static const double most_ticks_of_a_step = 1e9;

fmi2String FMI2(GetTypesPlatform)(void) {
  return "default";
}

fmi2String FMI2(GetVersion)(void) {
  return "2.0";
}

/* There are no debugging messages: what is refused is always logged. */
fmi2Status FMI2(SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count,
                                 const fmi2String categories[]) {
  const Instance* const instance = component;
  (void)on;
  if (!is_in(instance, in_any, "fmi2SetDebugLogging")) return fmi2Error;
  if (count > 0 && categories == NULL) return refuse(instance, "the log categories are missing");
  for (size_t i = 0; i < count; ++i) {
    if (categories[i] == NULL) return refuse(instance, "a log category is missing");
    if (strcmp(categories[i], "logStatusWarning") != 0 &&
        strcmp(categories[i], "logStatusDiscard") != 0 &&
        strcmp(categories[i], "logStatusError") != 0 && strcmp(categories[i], "logAll") != 0)
      return refuse(instance, "%.200s is no log category of this FMU", categories[i]);
  }
  return fmi2OK;
}

fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                fmi2String resources, const fmi2CallbackFunctions* functions,
                                fmi2Boolean visible, fmi2Boolean logging_on) {
  (void)visible;
  (void)logging_on;
  if (functions == NULL) return NULL;
  const char* const mistake = request_mistake(name, type, guid, resources);
  if (mistake != NULL) {
    log_text(functions->logger, functions->componentEnvironment, name == NULL ? "" : name,
             fmi2Error, mistake);
    return NULL;
  }
  return instance_of(functions, name, guid, resources);
}

void FMI2(FreeInstance)(fmi2Component component) {
  instance_free(component);
}

fmi2Status FMI2(SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_defined,
                                 fmi2Real tolerance, fmi2Real start_time,
                                 fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  Instance* const instance = component;
  (void)tolerance_defined; /* nothing here is iterated */
  (void)tolerance;
  if (!is_in(instance, in_instantiated, "fmi2SetupExperiment")) return fmi2Error;
  if (!isfinite(start_time)) return refuse(instance, "the start time %g is not finite", start_time);
  if (stop_time_defined && !(isfinite(stop_time) && stop_time >= start_time))
    return refuse(instance, "the stop time %g is not finite or before the start time %g", stop_time,
                  start_time);
  Run* const run = &instance->run;
  run->point_s = start_time;
  run->stop_defined = stop_time_defined != fmi2False;
  run->stop_s = run->stop_defined ? stop_time : 0;
  return fmi2OK;
}

/* From one of `phases` to `next`. */
static fmi2Status move_on(Instance* instance, int phases, Phase next, const char* call) {
  if (!is_in(instance, phases, call)) return fmi2Error;
  instance->run.phase = next;
  return fmi2OK;
}

fmi2Status FMI2(EnterInitializationMode)(fmi2Component component) {
  return move_on(component, in_instantiated, phase_initialisation, "fmi2EnterInitializationMode");
}

fmi2Status FMI2(ExitInitializationMode)(fmi2Component component) {
  return move_on(component, in_initialisation, phase_stepping, "fmi2ExitInitializationMode");
}

fmi2Status FMI2(Terminate)(fmi2Component component) {
  return move_on(component, in_stepping, phase_terminated, "fmi2Terminate");
}

fmi2Status FMI2(Reset)(fmi2Component component) {
  Instance* const instance = component;
  if (!is_in(instance, in_any, "fmi2Reset")) return fmi2Error;
  run_reset(&instance->model, &instance->run);
  return fmi2OK;
}

/* Before the first tick the outputs follow from the inputs that are set. */
static fmi2Status expect_outputs(Instance* instance) {
  const Model* const model = &instance->model;
  Run* const run = &instance->run;
  if (run->ticks > 0) return fmi2OK;
  double* const du = instance->scratch;
  inputs_of(model, run, du);
  if (!outputs_of(model, run_state(model, run), du, run_outputs(model, run)))
    return discard(instance, "an output is beyond what a double can hold");
  return fmi2OK;
}

fmi2Status FMI2(GetReal)(fmi2Component component, const fmi2ValueReference references[],
                         size_t count, fmi2Real values[]) {
  Instance* const instance = component;
  if (!is_in(instance, in_initialisation | in_stepping | in_terminated, "fmi2GetReal"))
    return fmi2Error;
  if (count > 0 && (references == NULL || values == NULL))
    return refuse(instance, "fmi2GetReal needs references and a place for values");
  const Model* const model = &instance->model;
  int any_output = 0;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] >= model->parameters + model->outputs)
      return refuse(instance, "%u is no value reference of this FMU", references[i]);
    any_output = any_output || references[i] >= model->parameters;
  }
  if (any_output) {
    const fmi2Status status = expect_outputs(instance);
    if (status != fmi2OK) return status;
  }
  for (size_t i = 0; i < count; ++i)
    values[i] = references[i] < model->parameters
                    ? instance->run.values[references[i]]
                    : run_outputs(model, &instance->run)[references[i] - model->parameters];
  return fmi2OK;
}

fmi2Status FMI2(SetReal)(fmi2Component component, const fmi2ValueReference references[],
                         size_t count, const fmi2Real values[]) {
  Instance* const instance = component;
  if (!is_in(instance, in_instantiated | in_initialisation | in_stepping, "fmi2SetReal"))
    return fmi2Error;
  if (count > 0 && (references == NULL || values == NULL))
    return refuse(instance, "fmi2SetReal needs references and values");
  for (size_t i = 0; i < count; ++i) {
    if (references[i] >= instance->model.parameters)
      return refuse(instance, "%u is no value reference of an input", references[i]);
    if (!isfinite(values[i]))
      return discard(instance, "input %u cannot be %g; it keeps its value", references[i],
                     values[i]);
  }
  for (size_t i = 0; i < count; ++i) instance->run.values[references[i]] = values[i];
  return fmi2OK;
}

static fmi2Status refuse_type(const Instance* instance, size_t count, const char* type) {
  if (instance == NULL) return fmi2Error;
  return count == 0 ? fmi2OK : refuse(instance, "this FMU has no %s variables", type);
}

#define NO_VARIABLES_OF(type, getter, setter)                                             \
  fmi2Status FMI2(getter)(fmi2Component component, const fmi2ValueReference references[], \
                          size_t count, fmi2##type values[]) {                            \
    (void)references;                                                                     \
    (void)values;                                                                         \
    return refuse_type(component, count, #type);                                          \
  }                                                                                       \
  fmi2Status FMI2(setter)(fmi2Component component, const fmi2ValueReference references[], \
                          size_t count, const fmi2##type values[]) {                      \
    (void)references;                                                                     \
    (void)values;                                                                         \
    return refuse_type(component, count, #type);                                          \
  }

NO_VARIABLES_OF(Integer, GetInteger, SetInteger)
NO_VARIABLES_OF(Boolean, GetBoolean, SetBoolean)
NO_VARIABLES_OF(String, GetString, SetString)

fmi2Status FMI2(GetFMUstate)(fmi2Component component, fmi2FMUstate* state) {
  const Instance* const instance = component;
  if (!is_in(instance, in_any, "fmi2GetFMUstate")) return fmi2Error;
  if (state == NULL) return refuse(instance, "fmi2GetFMUstate needs a place for the state");
  if (*state != NULL && !saved_fits(*state, &instance->model))
    return refuse(instance, "the state to be overwritten is not one of this model");
  SavedState* const saved = *state != NULL ? *state : saved_new(&instance->model);
  if (saved == NULL) return refuse(instance, "there is no memory for a state");
  run_copy(&instance->model, &instance->run, &saved->run);
  *state = saved;
  return fmi2OK;
}

/* Whether a state is there and of this model; refused where it is not. */
static int is_state(const Instance* instance, fmi2FMUstate state, const char* call) {
  if (!is_in(instance, in_any, call)) return 0;
  if (state != NULL && saved_fits(state, &instance->model)) return 1;
  refuse(instance, "%s needs a state of this model", call);
  return 0;
}

fmi2Status FMI2(SetFMUstate)(fmi2Component component, fmi2FMUstate state) {
  Instance* const instance = component;
  if (!is_state(instance, state, "fmi2SetFMUstate")) return fmi2Error;
  run_copy(&instance->model, &((const SavedState*)state)->run, &instance->run);
  return fmi2OK;
}

fmi2Status FMI2(FreeFMUstate)(fmi2Component component, fmi2FMUstate* state) {
  const Instance* const instance = component;
  if (!is_in(instance, in_any, "fmi2FreeFMUstate")) return fmi2Error;
  if (state == NULL || *state == NULL) return fmi2OK;
  saved_free(*state);
  *state = NULL;
  return fmi2OK;
}

fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t* size) {
  const Instance* const instance = component;
  if (!is_state(instance, state, "fmi2SerializedFMUstateSize")) return fmi2Error;
  if (size == NULL) return refuse(instance, "fmi2SerializedFMUstateSize needs a place for it");
  *size = saved_size(&instance->model);
  return fmi2OK;
}

fmi2Status FMI2(SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                   size_t size) {
  const Instance* const instance = component;
  if (!is_state(instance, state, "fmi2SerializeFMUstate")) return fmi2Error;
  if (bytes == NULL || size < saved_size(&instance->model))
    return refuse(instance, "a state takes %zu bytes", saved_size(&instance->model));
  saved_write(&instance->model, state, (unsigned char*)bytes);
  return fmi2OK;
}

fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                     fmi2FMUstate* state) {
  const Instance* const instance = component;
  if (!is_in(instance, in_any, "fmi2DeSerializeFMUstate")) return fmi2Error;
  if (bytes == NULL || state == NULL)
    return refuse(instance, "fmi2DeSerializeFMUstate needs bytes and a place for the state");
  SavedState* const saved = saved_new(&instance->model);
  if (saved == NULL) return refuse(instance, "there is no memory for a state");
  const char* const mistake =
      saved_read(&instance->model, (const unsigned char*)bytes, size, saved);
  if (mistake != NULL) {
    saved_free(saved);
    return refuse(instance, "these bytes are not taken for a state: %s", mistake);
  }
  *state = saved;
  return fmi2OK;
}

fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component component,
                                          const fmi2ValueReference unknowns[], size_t unknown_count,
                                          const fmi2ValueReference knowns[], size_t known_count,
                                          const fmi2Real known_changes[],
                                          fmi2Real unknown_changes[]) {
  const Instance* const instance = component;
  (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count;
  (void)known_changes, (void)unknown_changes;
  if (instance == NULL) return fmi2Error;
  return refuse(instance, "this FMU gives no directional derivatives");
}

fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component component,
                                         const fmi2ValueReference references[], size_t count,
                                         const fmi2Integer orders[], const fmi2Real values[]) {
  const Instance* const instance = component;
  (void)references, (void)count, (void)orders, (void)values;
  if (instance == NULL) return fmi2Error;
  return refuse(instance, "this FMU does not interpolate inputs: it samples them at its ticks");
}

fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component component,
                                          const fmi2ValueReference references[], size_t count,
                                          const fmi2Integer orders[], fmi2Real values[]) {
  const Instance* const instance = component;
  (void)references, (void)count, (void)orders, (void)values;
  if (instance == NULL) return fmi2Error;
  return refuse(instance, "the outputs of this FMU hold between ticks and have no derivatives");
}

/* Runs `count` ticks with the parameters that are set, or none of them. */
static fmi2Status run_ticks(Instance* instance, int64_t count) {
  const Model* const model = &instance->model;
  Run* const run = &instance->run;
  double* const du = instance->scratch;
  double* const next = du + model->inputs;
  double* const before = next + model->order;
  const size_t moving = (model->order + model->outputs) * sizeof *before;
  const size_t missing = inputs_of(model, run, du);
  memcpy(before, run_state(model, run), moving);
  for (int64_t k = 0; k < count; ++k) {
    if (tick(model, du, run_state(model, run), run_outputs(model, run), next)) continue;
    memcpy(run_state(model, run), before, moving);
    return discard(instance, "the inputs drive the model beyond what a double can hold: no step");
  }
  memcpy(run_inputs(model, run), du, model->inputs * sizeof *du);
  run->ticks += count;
  if (missing == model->inputs) return fmi2OK;
  return warn(instance,
              "input %zu of the model has no finite value for the parameters that are set; "
              "it keeps its last",
              missing);
}

/* What is wrong with a step from `point`, or NULL. */
static const char* step_mistake(const Instance* instance, double point, double step,
                                double tolerance) {
  const Run* const run = &instance->run;
  if (!isfinite(point) || !isfinite(step) || !(step > 0)) return "must be finite and above 0";
  if (step / instance->model.period_s > most_ticks_of_a_step)
    return "is more than 1e9 sample periods";
  if (!(fabs(point - run->point_s) <= tolerance)) return "does not begin where the last ended";
  if (run->stop_defined && point + step > run->stop_s + tolerance)
    return "ends after the stop time";
  return NULL;
}

fmi2Status FMI2(DoStep)(fmi2Component component, fmi2Real point, fmi2Real step,
                        fmi2Boolean no_earlier_state) {
  Instance* const instance = component;
  (void)no_earlier_state; /* nothing is kept for going back */
  if (!is_in(instance, in_stepping, "fmi2DoStep")) return fmi2Error;
  Run* const run = &instance->run;
  const double period = instance->model.period_s;
  const double tolerance = clock_tolerance(period, point + step);
  const char* const mistake = step_mistake(instance, point, step, tolerance);
  if (mistake != NULL)
    return refuse(instance, "a step from %.17g over %.17g s, where the last ended at %.17g, %s",
                  point, step, run->point_s, mistake);
  const Clock after = clock_after(run->clock, step, period, tolerance);
  const int64_t due = clock_ticks(after, tolerance) - run->ticks;
  const fmi2Status status = due > 0 ? run_ticks(instance, due) : fmi2OK;
  if (status > fmi2Warning) return status;
  run->clock = after;
  run->point_s = point + step;
  return status;
}

fmi2Status FMI2(CancelStep)(fmi2Component component) {
  const Instance* const instance = component;
  if (instance == NULL) return fmi2Error;
  return refuse(instance, "no step is ever pending: fmi2DoStep returns when it is done");
}

static fmi2Status no_status(const Instance* instance) {
  if (instance == NULL) return fmi2Error;
  return discard(instance, "this FMU keeps no such status: fmi2DoStep returns when it is done");
}

fmi2Status FMI2(GetStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Status* value) {
  (void)kind, (void)value;
  return no_status(component);
}

fmi2Status FMI2(GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real* value) {
  const Instance* const instance = component;
  if (instance == NULL || kind != fmi2LastSuccessfulTime || value == NULL)
    return no_status(instance);
  *value = instance->run.point_s;
  return fmi2OK;
}

fmi2Status FMI2(GetIntegerStatus)(fmi2Component component, fmi2StatusKind kind,
                                  fmi2Integer* value) {
  (void)kind, (void)value;
  return no_status(component);
}

/* Answers fmi2Terminated alone: this FMU never ends a simulation by itself. */
fmi2Status FMI2(GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind,
                                  fmi2Boolean* value) {
  const Instance* const instance = component;
  if (instance == NULL || kind != fmi2Terminated || value == NULL) return no_status(instance);
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status FMI2(GetStringStatus)(fmi2Component component, fmi2StatusKind kind, fmi2String* value) {
  (void)kind, (void)value;
  return no_status(component);
}
