/* The approved models of a satellite's equipment, in a simulator.
 *
 * A client joins a partition and receives the approved versions of the equipment that it
 * subscribes to. It verifies each version (digest, sizes, finite, stable, newer than the one before
 * unless it is a rollback). It keeps the last good version of each equipment in a file, so that a
 * simulator starts at once when no service answers. A runner runs the model of one equipment, step
 * by step. It changes to a new version between two steps, and the output continues where it was.
 * README.md next to the sources has complete examples.
 *
 * Threads: a client works on a thread of its own. Each runner, and each client, is for one thread
 * at a time; several runners may run on several threads. reident_step, reident_follow and
 * reident_observe allocate nothing, take no lock and make no system call, also when they change to
 * a new version.
 *
 * Errors: a call that fails returns NULL or a negative code, and reident_last_error has the reason.
 * No call throws.
 *
 * ABI: structures carry their size and only ever grow at the end; values of enumerations never
 * change; unknown events and flags are to be ignored. Texts are UTF-8. Times are nanoseconds since
 * 1970-01-01T00:00:00 UTC. This header is C99 and C++.
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

/* Codes of calls that could not do what they were asked to do. */
enum {
  REIDENT_BAD_ARGUMENT = -1, /* the request can never be met */
  REIDENT_UNAVAILABLE = -2,  /* not now: no model, no offer, no answer from a service */
  REIDENT_FAILED = -3        /* the machine or the middleware failed */
};

/* Returns what was wrong with the last call on this thread that failed, and what would mend it.
 * Never NULL; "" before the first failure. Good until the next call on this thread. */
REIDENT_API const char* reident_last_error(void);

/* Returns the library's version, such as "0.1.0 (1a2b3c4)". Never NULL. Any thread. */
REIDENT_API const char* reident_library_version(void);

/* ---- client ---- */

/* What reident_client_open takes. */
typedef struct {
  size_t size;                  /* set by reident_options_init */
  const char* simulator;        /* name, unique in the partition; NULL: host and process id */
  uint32_t domain;              /* DDS domain, 0 to 230 */
  const char* partition;        /* NULL: "operations" */
  const char* spacecraft;       /* name or pattern with * and ?; NULL: every one */
  const char* const* equipment; /* names or patterns; with a count of 0: every one */
  size_t equipment_count;
  const char* cache_folder; /* NULL: $XDG_CACHE_HOME/reident or ~/.cache/reident; "": none */
  /* On a secured domain: folder of the simulator's certificate (deploy/SECURITY.md). NULL:
   * $REIDENT_SECURITY, or not secured where that is not set; "": not secured. */
  const char* security_folder;
} reident_options;

/* Sets every option to its default. Compiled into the program, which knows its structure's size. */
static inline void reident_options_init(reident_options* options) {
  memset(options, 0, sizeof *options);
  options->size = sizeof *options;
}

/* Joins the partition and starts the client's thread. Does not wait for a service.
 * Requires: options from reident_options_init; the library copies them.
 * Returns: the client, to be closed by reident_client_close. Versions that an earlier run kept are
 *   there already. NULL: wrong options, or the middleware failed.
 * Threads: any; then one thread at a time. The client's own thread takes no signals. */
REIDENT_API reident_client* reident_client_open(const reident_options* options);

/* Ends the client, its thread and its runners. NULL is allowed.
 * Requires: no call for the client or its runners is running or follows; not in a callback. */
REIDENT_API void reident_client_close(reident_client* client);

/* Kinds of events. */
enum {
  REIDENT_EVENT_AVAILABLE = 1,  /* a verified version; runners whose signals it has change to it */
  REIDENT_EVENT_SWAPPED = 2,    /* a runner made its first step on the version */
  REIDENT_EVENT_REFUSED = 3,    /* the version must not run; the one before goes on */
  REIDENT_EVENT_OFFERED = 4,    /* its inputs, outputs or period are others than those that run, or
                                   not what the runner declares: see reident_accept */
  REIDENT_EVENT_CACHE = 5,      /* the file of last good versions could not be read or written */
  REIDENT_EVENT_FAULT = 6,      /* the middleware failed; the runs go on */
  REIDENT_EVENT_UNPUBLISHED = 7 /* none was published within 5 s after a runner was opened */
};

/* One event. What does not belong to its kind is 0 or "". */
typedef struct {
  size_t size;            /* in: sizeof(reident_event) */
  int32_t kind;           /* REIDENT_EVENT_... */
  int32_t from_cache;     /* 1: from the local file, no service has confirmed it in this run */
  const char* spacecraft; /* the texts are good until the next call of reident_next_event */
  const char* equipment;
  const char* text; /* one sentence for a log */
  int64_t version;
  int64_t time_ns;       /* SWAPPED: the first step; AVAILABLE, OFFERED: when it was received (a
                            kept version: in the earlier run); else when it happened */
  int64_t decided_ns;    /* when the version was approved, 0 where it is not known */
  int64_t published_ns;  /* when the service sent it, 0 where it is not known */
  double remaining_step; /* SWAPPED: largest difference between the two models at the last step, in
                            the output's unit; it comes in over transition_steps steps */
  int32_t transition_steps;
  int32_t matched_rows; /* SWAPPED: steps that the new state was estimated from */
} reident_event;

/* Waits for the next event. The library keeps at most 1024; beyond that the oldest are lost.
 * Units: timeout_ms in milliseconds; 0: do not wait; -1: for ever.
 * Requires: `event` with its size set. Returns: 1: `event` is filled in; 0: none came in time.
 * Errors: REIDENT_BAD_ARGUMENT (NULL, or a size of 0), REIDENT_FAILED.
 * Threads: the client's user; blocks that thread alone. */
REIDENT_API int reident_next_event(reident_client* client, reident_event* event, int timeout_ms);

/* Takes one event, on the client's thread. The event and its texts are good during the call, which
 * must not block, must not throw and must not call this client. */
typedef void (*reident_event_callback)(const reident_event* event, void* user);

/* Has `call` called with `user` for each event from now on, also for those that are kept, instead
 * of keeping them. NULL: events are kept again.
 * Requires: `user` stays good until another callback or NULL takes its place, or the client closes.
 * Returns: when the callback before is not called any more. Threads: the client's user. */
REIDENT_API void reident_on_event(reident_client* client, reident_event_callback call, void* user);

/* Writes the newest verified version of an equipment as a JSON object: version, digest, decided_ns,
 * decided_by, rollback, and model (signals with units and ranges, matrices, scores).
 * Returns: the text, good until the next call for this client; NULL: no version has come.
 * Threads: the client's user. */
REIDENT_API const char* reident_version_json(reident_client* client, const char* spacecraft,
                                             const char* equipment);

/* ---- history ---- */

/* A question about the history. */
typedef struct {
  size_t size;            /* set by reident_history_init */
  const char* subject;    /* "decisions", ...: "History" in idl/README.md; NULL: "versions" */
  const char* spacecraft; /* NULL: every one */
  const char* equipment;  /* NULL: every one */
  int64_t begin_ns;       /* the range is [begin, end); begin == end: all of time */
  int64_t end_ns;
  int64_t version;      /* 0: every one */
  uint32_t page_size;   /* rows, at most 10000; 0: 1000 */
  int32_t newest_first; /* 1: descending */
  int32_t simulated;    /* of telemetry: 1: the simulator's own */
  uint32_t parameter;   /* of telemetry: id within the spacecraft */
} reident_history_query;

/* Sets a query to its defaults: all versions, ascending. */
static inline void reident_history_init(reident_history_query* query) {
  memset(query, 0, sizeof *query);
  query->size = sizeof *query;
}

/* Takes one row: a JSON object, good during the call, which must not throw. */
typedef void (*reident_history_row)(const char* json, void* user);

/* Asks the running service for one page and calls `row` for each of its rows, on this thread.
 * Units: timeout_ms in milliseconds; next_size in bytes, with the closing 0.
 * Requires: a query from reident_history_init. `cursor` is "" for the first page, and then what the
 *   page before wrote into `next`. A cursor takes at most a few hundred bytes.
 * Returns: the number of rows. `next` is "" after the last page.
 * Errors: REIDENT_BAD_ARGUMENT: NULL, a size of 0, a question that the service refuses, or no room
 *   in `next` (no row was given); REIDENT_UNAVAILABLE: no answer in time; REIDENT_FAILED.
 * Threads: the client's user; blocks that thread alone. */
REIDENT_API int reident_history_page(reident_client* client, const reident_history_query* query,
                                     const char* cursor, int timeout_ms, reident_history_row row,
                                     void* user, char* next, size_t next_size);

/* ---- runner ---- */

/* One declared input or output. */
typedef struct {
  const char* name; /* SATCS parameter (of an output: the model's output) */
  const char* unit; /* NULL: not checked */
} reident_signal;

/* Opens the run of one equipment; its first step has the newest version, where there is one.
 * Shapes: `inputs` is the order of `u`, `outputs` that of `y` and `measured`, in these units.
 * Requires: at least one output, each name once, one runner of an equipment in a client. The
 *   library copies the names. More inputs may be declared than a version needs, but its outputs are
 *   exactly those declared. A version that needs an input that is not declared does not run.
 * Returns: the runner, to be closed by reident_runner_close; NULL where a requirement is not met.
 * Threads: the client's user; afterwards the runner is for one thread at a time. */
REIDENT_API reident_runner* reident_runner_open(reident_client* client, const char* spacecraft,
                                                const char* equipment, const reident_signal* inputs,
                                                size_t input_count, const reident_signal* outputs,
                                                size_t output_count);

/* Ends the run; operators then see that nothing runs here. NULL is allowed.
 * Requires: the client is open, and no call for the runner is running or follows. Runners that are
 *   left end with their client.
 * Threads: the client's user. */
REIDENT_API void reident_runner_close(reident_runner* runner);

/* Flags of a step: a sum of these, 0 where all is well. */
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

/* Runs one tick freely: y follows from the inputs alone.
 * Shapes: `u` input_count values, `y` output_count values, in the declared order and units.
 * Requires: an open runner and both arrays, which are not checked; one call each sample period.
 * Returns: flags; with REIDENT_NO_MODEL `y` is NaN. No errors.
 * Threads: the runner's. Allocates nothing, takes no lock, makes no system call. */
REIDENT_API int reident_step(reident_runner* runner, const double* u, double* y);

/* Runs one tick and follows the satellite: the measured outputs correct the run, by the version's
 * integral feedback, else by its Kalman gain. `y` is computed before `measured` is used. Changing
 * between reident_step and reident_follow makes no jump: the correction comes in, and fades, over
 * many steps.
 * Shapes: as reident_step; `measured` output_count values, NaN where one is missing.
 * Requires, returns, threads: as reident_step. */
REIDENT_API int reident_follow(reident_runner* runner, const double* u, const double* measured,
                               double* y);

/* Gives a free run what was measured at its last step: the running error counts it, and a swap
 * estimates its state from it. Does nothing before the first step on a version.
 * Shapes: `measured` output_count values, NaN where one is missing.
 * Requires, threads: as reident_step. */
REIDENT_API void reident_observe(reident_runner* runner, const double* measured);

/* Takes the version that is offered, at the next step. Returns: 0.
 * Errors: REIDENT_UNAVAILABLE: none is offered, or an input or output of it was not declared, or
 *   has another unit; REIDENT_BAD_ARGUMENT: NULL; REIDENT_FAILED.
 * Threads: the runner's; takes a lock. */
REIDENT_API int reident_accept(reident_runner* runner);

/* Returns what one declared input, counted from 0, was at the last step: REIDENT_INPUT_MISSING,
 * REIDENT_INPUT_OUTSIDE, both or 0. For a derived input, each of its parameters has its flags.
 * Errors: REIDENT_BAD_ARGUMENT: NULL, or beyond the last input.
 * Threads: the runner's. */
REIDENT_API int reident_input_flags(const reident_runner* runner, size_t input);

/* Where a run stands after its last step. */
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

/* Fills in where the run stands. Requires: `state` with its size set. Returns: 0.
 * Errors: REIDENT_BAD_ARGUMENT: NULL, or a size of 0; REIDENT_FAILED.
 * Threads: the runner's; takes a lock. */
REIDENT_API int reident_runner_get_state(const reident_runner* runner, reident_runner_state* state);

#ifdef __cplusplus
}
#endif
#endif
