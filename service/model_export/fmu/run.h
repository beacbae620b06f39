/* A free run of the model, and all of it that changes:
 *
 *   y[k]   = C x[k] + D (u[k] - u0) + y0
 *   x[k+1] = A x[k] + B (u[k] - u0),    x[0] = 0 at the operating point
 *
 * where u follows from the parameters by the inputs' programs. Where one has no finite value, the
 * last that it had stays, at first the operating point.
 */
#ifndef REIDENT_RUN_H
#define REIDENT_RUN_H

#include "clock.h"
#include "model_file.h"

/* Between which calls of the standard an instance is. */
typedef enum {
  phase_instantiated,
  phase_initialisation,
  phase_stepping,
  phase_terminated,
  phase_event /* of FMI 3.0 */
} Phase;

/* All that a saved state has to hold (saved_state.h). It owns `values`. */
typedef struct {
  Phase phase;
  int stop_defined;
  double stop_s;
  double point_s; /* the communication point, in the words of who steps */
  Clock clock;
  int64_t ticks;  /* that have run */
  double* values; /* parameters, their slopes, u - u0 of the last tick, x, y: run_values() */
} Run;

/* How many values a run of the model has, and where its parts begin. */
static size_t run_values(const Model* model) {
  return 2 * model->parameters + model->inputs + model->order + model->outputs;
}

/* How fast each parameter changes over the step that follows [1/s]; 0 after it. */
static double* run_slopes(const Model* model, const Run* run) {
  return run->values + model->parameters;
}

static double* run_inputs(const Model* model, const Run* run) {
  return run_slopes(model, run) + model->parameters;
}

static double* run_state(const Model* model, const Run* run) {
  return run_inputs(model, run) + model->inputs;
}

static double* run_outputs(const Model* model, const Run* run) {
  return run_state(model, run) + model->order;
}

/* Sets the run to before its initialisation; `values` has to have room. */
static void run_reset(const Model* model, Run* run) {
  double* const values = run->values;
  memset(run, 0, sizeof *run);
  run->values = values;
  memset(values, 0, run_values(model) * sizeof *values);
  memcpy(values, model->start, model->parameters * sizeof *values);
  memcpy(run_state(model, run), model->state, model->order * sizeof *values);
}

/* Copies a run of the same model; each keeps its own memory. */
static void run_copy(const Model* model, const Run* from, Run* to) {
  double* const values = to->values;
  *to = *from;
  to->values = values;
  memcpy(values, from->values, run_values(model) * sizeof *values);
}

/* Sets `du` (m) to u - u0 of `parameters` (q). An input without a finite value keeps
 * that of the last tick. Returns the first such input, or m. */
static size_t inputs_of(const Model* model, const Run* run, const double* parameters, double* du) {
  size_t first = model->inputs;
  for (size_t i = 0; i < model->inputs; ++i) {
    const Program* const program = &model->programs[i];
    const double value = postfix_value(program->steps, program->count, parameters);
    du[i] = isfinite(value) ? value - model->u0[i] : run_inputs(model, run)[i];
    if (!isfinite(value) && first == model->inputs) first = i;
  }
  return first;
}

static double row_times(const double* row, const double* vector, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; ++i) sum += row[i] * vector[i];
  return sum;
}

/* Sets `y` (p) to the outputs of x (n) and du (m). Returns whether all are finite. */
static int outputs_of(const Model* model, const double* x, const double* du, double* y) {
  int finite = 1;
  for (size_t i = 0; i < model->outputs; ++i) {
    y[i] = row_times(model->C + i * model->order, x, model->order) +
           row_times(model->D + i * model->inputs, du, model->inputs) + model->y0[i];
    finite = finite && isfinite(y[i]);
  }
  return finite;
}

/* One tick: y of x and du, then the x that follows, by way of `next` (n). Returns whether all is
 * finite; x and y are changed either way. */
static int tick(const Model* model, const double* du, double* x, double* y, double* next) {
  int finite = outputs_of(model, x, du, y);
  for (size_t i = 0; i < model->order; ++i) {
    next[i] = row_times(model->A + i * model->order, x, model->order) +
              row_times(model->B + i * model->inputs, du, model->inputs);
    finite = finite && isfinite(next[i]);
  }
  memcpy(x, next, model->order * sizeof *x);
  return finite;
}

#endif
