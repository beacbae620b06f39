/* Where a simulation stands between the ticks of a sampled model.
 *
 * Ticks stand at start + k period, k = 0, 1, 2, ... The time since the start is kept as a whole
 * number of periods and a rest, so that no sum of doubles decides whether a tick is due: a step of
 * any whole multiple of the period adds an integer. What rounding leaves (0.1 three times is not
 * 0.3) stays in the rest and is not lost.
 */
#ifndef REIDENT_CLOCK_H
#define REIDENT_CLOCK_H

#include <math.h>
#include <stdint.h>

/* The time since the start: periods * period + rest_s. */
typedef struct {
  int64_t periods;
  double rest_s; /* in [-tolerance, period - tolerance) */
} Clock;

/* How far from a tick a time counts as on it: a millionth of a period, or what a double near
 * `time_s` can resolve, but never more than a quarter of a period. */
static double clock_tolerance(double period_s, double time_s) {
  const double size = fabs(time_s);
  const double resolution = 4 * (nextafter(size, INFINITY) - size);
  return fmin(fmax(1e-6 * period_s, resolution), period_s / 4);
}

/* Returns the clock `step_s` later; step_s is above 0 and at most 1e9 periods. The remainder is
 * exact, so that a whole multiple of the period leaves the rest as it is. */
static Clock clock_after(Clock clock, double step_s, double period_s, double tolerance_s) {
  const double beyond = remainder(step_s, period_s);
  clock.periods += (int64_t)llround((step_s - beyond) / period_s);
  clock.rest_s += beyond;
  while (clock.rest_s < -tolerance_s) {
    clock.rest_s += period_s;
    clock.periods -= 1;
  }
  while (clock.rest_s >= period_s - tolerance_s) {
    clock.rest_s -= period_s;
    clock.periods += 1;
  }
  return clock;
}

/* Returns how many ticks lie before the time of the clock; a tick at that time is not one of
 * them. */
static int64_t clock_ticks(Clock clock, double tolerance_s) {
  return clock.periods + (clock.rest_s > tolerance_s ? 1 : 0);
}

#endif
