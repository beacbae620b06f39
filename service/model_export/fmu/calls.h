/* What an importer can ask of an instance, the same for both versions of the standard.
 *
 * A step [t, t + h) runs the ticks in it, each with the inputs that are set. A call that is refused
 * (status_error) or cannot be answered (status_discard) changes nothing and says why by the logger.
 *
 * Value references count parameters (q), outputs (p), states (n), and last the time.
 */
#ifndef REIDENT_CALLS_H
#define REIDENT_CALLS_H

#include "instance.h"

enum {
  in_instantiated = 1 << phase_instantiated,
  in_initialisation = 1 << phase_initialisation,
  in_stepping = 1 << phase_stepping,
  in_terminated = 1 << phase_terminated,
  in_event = 1 << phase_event,
  in_any = in_instantiated | in_initialisation | in_stepping | in_terminated | in_event
};

static const double most_ticks_of_a_step = 1e9;

/* There are no debugging messages: what is refused is always logged. */
static Status call_set_logging(const Instance* instance, size_t count,
                               const char* const categories[]) {
  if (!is_in(instance, in_any, "SetDebugLogging")) return status_error;
  if (count > 0 && categories == NULL) return refuse(instance, "the log categories are missing");
  for (size_t i = 0; i < count; ++i) {
    if (categories[i] == NULL) return refuse(instance, "a log category is missing");
    if (strcmp(categories[i], "logStatusWarning") != 0 &&
        strcmp(categories[i], "logStatusDiscard") != 0 &&
        strcmp(categories[i], "logStatusError") != 0 && strcmp(categories[i], "logAll") != 0)
      return refuse(instance, "%.200s is no log category of this FMU", categories[i]);
  }
  return status_ok;
}

/* Sets when the simulation begins and ends [s]. */
static Status call_set_times(Instance* instance, double start, int stop_defined, double stop,
                             const char* call) {
  if (!is_in(instance, in_instantiated, call)) return status_error;
  if (!isfinite(start)) return refuse(instance, "the start time %g is not finite", start);
  if (stop_defined && !(isfinite(stop) && stop >= start))
    return refuse(instance, "the stop time %g is not finite or before the start time %g", stop,
                  start);
  Run* const run = &instance->run;
  run->point_s = start;
  run->stop_defined = stop_defined != 0;
  run->stop_s = run->stop_defined ? stop : 0;
  return status_ok;
}

/* From one of `phases` to `next`. */
static Status move_on(Instance* instance, int phases, Phase next, const char* call) {
  if (!is_in(instance, phases, call)) return status_error;
  instance->run.phase = next;
  return status_ok;
}

static Status call_reset(Instance* instance) {
  if (!is_in(instance, in_any, "Reset")) return status_error;
  run_reset(&instance->model, &instance->run);
  return status_ok;
}

/* Where the communication point is a tick that has not run, its outputs follow from the state and
 * the inputs that are set. Between ticks those of the last one stay. */
static Status expect_outputs(Instance* instance) {
  const Model* const model = &instance->model;
  Run* const run = &instance->run;
  if (run->ticks > run->clock.periods) return status_ok;
  double* const du = instance->scratch;
  inputs_of(model, run, run->values, du);
  if (!outputs_of(model, run_state(model, run), du, run_outputs(model, run)))
    return discard(instance, "an output is beyond what a double can hold");
  return status_ok;
}

static double value_at(const Instance* instance, size_t reference) {
  const Model* const model = &instance->model;
  const Run* const run = &instance->run;
  const size_t states = model->parameters + model->outputs;
  if (reference < model->parameters) return run->values[reference];
  if (reference < states) return run_outputs(model, run)[reference - model->parameters];
  if (reference < states + model->order) return run_state(model, run)[reference - states];
  return run->point_s;
}

static Status call_get(Instance* instance, const unsigned references[], size_t count,
                       double values[], const char* call) {
  if (!is_in(instance, in_initialisation | in_stepping | in_event | in_terminated, call))
    return status_error;
  if (count > 0 && (references == NULL || values == NULL))
    return refuse(instance, "%s%s needs references and a place for values", instance->host.calls,
                  call);
  const Model* const model = &instance->model;
  const size_t states = model->parameters + model->outputs;
  int any_output = 0;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] > states + model->order)
      return refuse(instance, "%u is no value reference of this FMU", references[i]);
    any_output = any_output || (references[i] >= model->parameters && references[i] < states);
  }
  if (any_output) {
    const Status status = expect_outputs(instance);
    if (status != status_ok) return status;
  }
  for (size_t i = 0; i < count; ++i) values[i] = value_at(instance, references[i]);
  return status_ok;
}

/* Returns where a value reference can be set now; NULL where it cannot, which is refused. */
static double* place_of(Instance* instance, size_t reference) {
  const Model* const model = &instance->model;
  const size_t states = model->parameters + model->outputs;
  if (reference < model->parameters) return &instance->run.values[reference];
  if (reference < states || reference >= states + model->order)
    refuse(instance, "%zu is no value reference of an input or a state", reference);
  else if (!((in_instantiated | in_initialisation) >> instance->run.phase & 1))
    refuse(instance, "state %zu can be set before the first step alone", reference);
  else
    return &run_state(model, &instance->run)[reference - states];
  return NULL;
}

static Status call_set(Instance* instance, const unsigned references[], size_t count,
                       const double values[], const char* call) {
  if (!is_in(instance, in_instantiated | in_initialisation | in_stepping | in_event, call))
    return status_error;
  if (count > 0 && (references == NULL || values == NULL))
    return refuse(instance, "%s%s needs references and values", instance->host.calls, call);
  for (size_t i = 0; i < count; ++i) {
    if (place_of(instance, references[i]) == NULL) return status_error;
    if (!isfinite(values[i]))
      return discard(instance, "variable %u cannot be %g; it keeps its value", references[i],
                     values[i]);
  }
  for (size_t i = 0; i < count; ++i) *place_of(instance, references[i]) = values[i];
  return status_ok;
}

static Status refuse_type(const Instance* instance, size_t count, const char* type) {
  if (instance == NULL) return status_error;
  return count == 0 ? status_ok : refuse(instance, "this FMU has no %s variables", type);
}

static const char only_co_simulation[] = "this FMU is for co-simulation alone";
static const char no_directional_derivatives[] = "this FMU gives no directional derivatives";
static const char no_output_derivatives[] =
    "the outputs of this FMU hold between ticks and have no derivatives";

/* A call of what this FMU does not have; modelDescription.xml says that it has not. */
static Status refuse_call(const Instance* instance, const char* why) {
  return instance == NULL ? status_error : refuse(instance, "%s", why);
}

/* Sets the slopes of parameters over the step that follows [1/s]. */
static Status call_set_slopes(Instance* instance, const unsigned references[], size_t count,
                              const int orders[], const double values[]) {
  if (!is_in(instance, in_initialisation | in_stepping, "SetRealInputDerivatives"))
    return status_error;
  if (count > 0 && (references == NULL || orders == NULL || values == NULL))
    return refuse(instance, "input derivatives need references, orders and values");
  for (size_t i = 0; i < count; ++i) {
    if (references[i] >= instance->model.parameters)
      return refuse(instance, "%u is no value reference of an input", references[i]);
    if (orders[i] != 1)
      return refuse(instance, "inputs are interpolated by their first derivative alone");
    if (!isfinite(values[i]))
      return discard(instance, "the derivative of input %u cannot be %g", references[i], values[i]);
  }
  for (size_t i = 0; i < count; ++i)
    run_slopes(&instance->model, &instance->run)[references[i]] = values[i];
  return status_ok;
}

/* Sets `parameters` (q) to those at `after_s` behind the communication point. */
static void parameters_at(const Instance* instance, double after_s, double* parameters) {
  const double* const slopes = run_slopes(&instance->model, &instance->run);
  for (size_t i = 0; i < instance->model.parameters; ++i)
    parameters[i] = instance->run.values[i] + slopes[i] * after_s;
}

/* Returns the first parameter that is not finite `after_s` behind the communication point, or q. */
static size_t endless_slope(const Instance* instance, double after_s) {
  const Run* const run = &instance->run;
  const size_t count = instance->model.parameters;
  for (size_t i = 0; i < count; ++i)
    if (!isfinite(run->values[i] + run_slopes(&instance->model, run)[i] * after_s)) return i;
  return count;
}

/* Runs `count` ticks with the parameters that are set and their slopes, or none of them. */
static Status run_ticks(Instance* instance, int64_t count) {
  const Model* const model = &instance->model;
  Run* const run = &instance->run;
  double* const du = instance->scratch;
  double* const next = du + model->inputs;
  double* const before = next + model->order;
  const size_t moving = model->inputs + model->order + model->outputs;
  double* const parameters = before + moving;
  size_t missing = model->inputs;
  memcpy(before, run_inputs(model, run), moving * sizeof *before);
  for (int64_t k = 0; k < count; ++k) {
    const double periods = (double)(run->ticks + k - run->clock.periods);
    parameters_at(instance, periods * model->period_s - run->clock.rest_s, parameters);
    const size_t lacking = inputs_of(model, run, parameters, du);
    if (missing == model->inputs) missing = lacking;
    memcpy(run_inputs(model, run), du, model->inputs * sizeof *du);
    if (tick(model, du, run_state(model, run), run_outputs(model, run), next)) continue;
    memcpy(run_inputs(model, run), before, moving * sizeof *before);
    return discard(instance, "the inputs drive the model beyond what a double can hold: no step");
  }
  run->ticks += count;
  if (missing == model->inputs) return status_ok;
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

/* Steps from `point` to point + step [s]. */
static Status call_step(Instance* instance, double point, double step) {
  if (!is_in(instance, in_stepping, "DoStep")) return status_error;
  Run* const run = &instance->run;
  const double period = instance->model.period_s;
  const double tolerance = clock_tolerance(period, point + step);
  const char* const mistake = step_mistake(instance, point, step, tolerance);
  if (mistake != NULL)
    return refuse(instance, "a step from %.17g over %.17g s, where the last ended at %.17g, %s",
                  point, step, run->point_s, mistake);
  const size_t steep = endless_slope(instance, step);
  if (steep < instance->model.parameters)
    return discard(instance, "the derivative of input %zu leads beyond what a double can hold",
                   steep);
  const Clock after = clock_after(run->clock, step, period, tolerance);
  const int64_t due = clock_ticks(after, tolerance) - run->ticks;
  const Status status = due > 0 ? run_ticks(instance, due) : status_ok;
  if (status > status_warning) return status;
  parameters_at(instance, step, run->values);
  memset(run_slopes(&instance->model, run), 0, instance->model.parameters * sizeof *run->values);
  run->clock = after;
  run->point_s = point + step;
  return status;
}

#endif
