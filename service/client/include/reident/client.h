/* The approved models of a satellite's equipment, in a simulator.
 *
 * A client joins a partition, receives the approved versions of the equipment that it subscribes
 * to, verifies each (digest, sizes, finite, stable, newer than the one before unless it is a
 * rollback) and keeps the last good one of each in a file, so that a simulator starts at once when
 * no service answers. A runner runs the model of one equipment, step by step, and changes to a new
 * version between two steps: the output continues where it was. README.md beside the sources has
 * complete examples.
 *
 * Threads. A client works on a thread of its own. Each runner, and each client, is for one thread
 * at a time; several runners may run on several threads. reident_step, reident_follow and
 * reident_observe allocate nothing, take no lock and make no system call, also when they change to
 * a new version.
 *
 * The ABI is stable: structures carry their size and only ever grow at the end, values of
 * enumerations never change, and unknown events and flags are to be ignored. Texts are UTF-8. Times
 * are nanoseconds since 1970-01-01T00:00:00 UTC. This header is C99 and C++.
 */
#ifndef REIDENT_CLIENT_H
#define REIDENT_CLIENT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__GNUC__)
#define REIDENT_API __attribute__((visibility("default")))
#else
#define REIDENT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct reident_client reident_client;
typedef struct reident_runner reident_runner;

/* What a call says when it could not do what it was asked to; the text that goes with it says what
 * is wrong and what would mend it. */
enum {
  REIDENT_BAD_ARGUMENT = -1, /* the request can never be met */
  REIDENT_UNAVAILABLE = -2,  /* not now: no model, no offer, no answer from a service */
  REIDENT_FAILED = -3        /* the machine or the middleware would not */
};

/* The text of the last call on this thread that failed; never NULL. Good until the next call. */
REIDENT_API const char* reident_last_error(void);

/* The library's version, such as "0.1.0 (1a2b3c4)". */
REIDENT_API const char* reident_library_version(void);

/* ---- client ---- */

typedef struct {
  size_t size;                  /* set by reident_options_init */
  const char* simulator;        /* name, unique in the partition; NULL: host and process id */
  uint32_t domain;              /* DDS domain, 0 to 230 */
  const char* partition;        /* NULL: "operations" */
  const char* spacecraft;       /* name or pattern with * and ?; NULL: every one */
  const char* const* equipment; /* names or patterns; with a count of 0: every one */
  size_t equipment_count;
  const char* cache_folder; /* NULL: $XDG_CACHE_HOME/reident or ~/.cache/reident; "": none */
} reident_options;

/* Everything by default. Compiled into the program, which knows how large its own structure is. */
static inline void reident_options_init(reident_options* options) {
  memset(options, 0, sizeof *options);
  options->size = sizeof *options;
}

/* NULL when it cannot be opened. Does not wait for a service. Versions kept from an earlier run are
 * there when it returns. */
REIDENT_API reident_client* reident_client_open(const reident_options* options);
/* Ends the client and its runners. NULL is allowed. */
REIDENT_API void reident_client_close(reident_client* client);

enum {
  REIDENT_EVENT_AVAILABLE = 1, /* a verified version; runners whose signals it has change to it */
  REIDENT_EVENT_SWAPPED = 2,   /* a runner made its first step on the version */
  REIDENT_EVENT_REFUSED = 3,   /* the version must not run; the one before goes on */
  REIDENT_EVENT_OFFERED = 4,   /* its signals differ from those that run: reident_accept takes it */
  REIDENT_EVENT_CACHE = 5,     /* the file of last good versions could not be read or written */
  REIDENT_EVENT_FAULT = 6      /* the middleware would not; the runs go on */
};

typedef struct {
  size_t size;            /* in: sizeof(reident_event) */
  int32_t kind;           /* REIDENT_EVENT_... */
  int32_t from_cache;     /* 1: of the local file, no service has confirmed it in this run */
  const char* spacecraft; /* the texts are good until the next call of reident_next_event */
  const char* equipment;
  const char* text; /* one sentence for a log */
  int64_t version;
  int64_t time_ns;       /* when it happened: SWAPPED, the first step; else when it was received */
  int64_t decided_ns;    /* when the version was approved, 0 where it is not known */
  int64_t published_ns;  /* when the service sent it, 0 where it is not known */
  double remaining_step; /* SWAPPED: largest difference between the two models at the last step, in
                            the output's unit; it comes in over transition_steps steps */
  int32_t transition_steps;
  int32_t matched_rows; /* SWAPPED: steps that the new state was estimated from */
} reident_event;

/* Waits at most timeout_ms (0: not at all, -1: for ever) for the next event. 1: `event` is filled
 * in; 0: none came; REIDENT_BAD_ARGUMENT. At most 1024 events are kept: the oldest go first. */
REIDENT_API int reident_next_event(reident_client* client, reident_event* event, int timeout_ms);

/* Instead of waiting: called on the client's thread for each event from now on. It must not block
 * and must not call this client. NULL: events are kept again. */
typedef void (*reident_event_callback)(const reident_event* event, void* user);
REIDENT_API void reident_on_event(reident_client* client, reident_event_callback call, void* user);

/* The newest verified version of an equipment as a JSON object: version, digest, decided_ns,
 * decided_by, rollback, and model (signals with units and ranges, matrices, scores); good until the
 * next call for this client; NULL where there is none. */
REIDENT_API const char* reident_version_json(reident_client* client, const char* spacecraft,
                                             const char* equipment);

/* ---- history ---- */

typedef struct {
  size_t size;            /* set by reident_history_init */
  const char* subject;    /* "decisions", ...: "History" in idl/README.md; NULL: "versions" */
  const char* spacecraft; /* NULL: every one */
  const char* equipment;  /* NULL: every one */
  int64_t begin_ns;       /* begin == end: all of time */
  int64_t end_ns;
  int64_t version;      /* 0: every one */
  uint32_t page_size;   /* rows, at most 10000; 0: 1000 */
  int32_t newest_first; /* 1: descending */
  int32_t simulated;    /* of telemetry: 1: the simulator's own */
  uint32_t parameter;   /* of telemetry: id within the spacecraft */
} reident_history_query;

static inline void reident_history_init(reident_history_query* query) {
  memset(query, 0, sizeof *query);
  query->size = sizeof *query;
}

/* One row: a JSON object, good during the call, which must not throw. */
typedef void (*reident_history_row)(const char* json, void* user);

/* Asks the running service for one page and calls `row` for each of its rows, on this thread.
 * `cursor` is "" for the first page, then what the page before wrote into `next`; "" there says
 * that it was the last. Returns the number of rows; REIDENT_BAD_ARGUMENT, also where the service
 * says so or `next` has no room (a cursor takes at most a few hundred bytes); REIDENT_UNAVAILABLE
 * when no service answered in timeout_ms; REIDENT_FAILED. */
REIDENT_API int reident_history_page(reident_client* client, const reident_history_query* query,
                                     const char* cursor, int timeout_ms, reident_history_row row,
                                     void* user, char* next, size_t next_size);

/* ---- runner ---- */

typedef struct {
  const char* name; /* SATCS parameter (of an output: the model's output) */
  const char* unit; /* NULL: not checked */
} reident_signal;

/* A runner of one equipment: `u` of reident_step and reident_follow are `inputs` in this order, `y`
 * are `outputs`. A version that needs an input that is not among them is not run. The simulator may
 * declare more than a version needs. NULL: REIDENT_BAD_ARGUMENT, such as a name twice. */
REIDENT_API reident_runner* reident_runner_open(reident_client* client, const char* spacecraft,
                                                const char* equipment, const reident_signal* inputs,
                                                size_t input_count, const reident_signal* outputs,
                                                size_t output_count);
/* Ends it; runners that are left end with their client. NULL is allowed. */
REIDENT_API void reident_runner_close(reident_runner* runner);

/* What a step says: a sum of these, 0 where all is well. */
enum {
  REIDENT_NO_MODEL = 1,       /* no version yet: the outputs are NaN */
  REIDENT_SWAPPED = 2,        /* the first step on another version */
  REIDENT_IN_TRANSITION = 4,  /* the output still moves over from the version before */
  REIDENT_INPUT_MISSING = 8,  /* an input was not finite: its last value is used, and before the
                                 first one the operating point's */
  REIDENT_INPUT_OUTSIDE = 16, /* an input was outside the range that the model was identified in; it
                                 is used as it is */
  REIDENT_NOT_FOLLOWING =
      32,               /* reident_follow ran free: the version has no gain, or y is missing */
  REIDENT_DIVERGED = 64 /* a state or output was not finite: the run started over at the
                           operating point */
};

/* Runs free: y follows from the inputs alone. Returns flags. Call it once a sample period. */
REIDENT_API int reident_step(reident_runner* runner, const double* u, double* y);

/* Follows the satellite: the run is corrected by the measured outputs (NaN where one is missing),
 * by the version's integral feedback, else by its Kalman gain. `y` is said before `measured` is
 * looked at. Changing between reident_step and reident_follow makes no jump: the correction comes
 * in, and fades, over many steps. Returns flags. */
REIDENT_API int reident_follow(reident_runner* runner, const double* u, const double* measured,
                               double* y);

/* Tells a free run what was measured at its last step: running errors count, and a swap estimates
 * its state from it. */
REIDENT_API void reident_observe(reident_runner* runner, const double* measured);

/* Takes the version that is offered at the next step: 0; REIDENT_UNAVAILABLE: none is offered, or
 * an input or output of it was not declared, or has another unit. */
REIDENT_API int reident_accept(reident_runner* runner);

/* What one declared input was at the last step: REIDENT_INPUT_MISSING, REIDENT_INPUT_OUTSIDE, both
 * or 0. REIDENT_BAD_ARGUMENT beyond the last input. */
REIDENT_API int reident_input_flags(const reident_runner* runner, size_t input);

typedef struct {
  size_t size;             /* in: sizeof(reident_runner_state) */
  int64_t version;         /* 0: none */
  int64_t offered_version; /* 0: none */
  int64_t decided_ns;      /* when it was approved */
  int64_t age_ns;          /* since then, never negative; 0 where there is none */
  int64_t swapped_ns;      /* its first step */
  int32_t following;       /* 1: the last step followed the satellite */
  int32_t from_cache;      /* 1: no service has confirmed it in this run */
  double sample_period_s;  /* 0 without a version */
  double
      running_mrse_percent; /* of all steps since the swap with measured outputs; NaN: none yet */
  uint64_t steps;           /* since the swap */
  uint64_t steps_outside;
  uint64_t steps_missing;
  double remaining_step; /* of the last swap */
  int32_t transition_steps;
  int32_t transition_left; /* steps until the transition has ended */
} reident_runner_state;

/* 0, or REIDENT_BAD_ARGUMENT. On the thread of the runner. */
REIDENT_API int reident_runner_get_state(const reident_runner* runner, reident_runner_state* state);

#ifdef __cplusplus
}
#endif
#endif
