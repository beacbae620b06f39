/* What an FMU for co-simulation declares by the Functional Mock-up Interface 3.0
 * (fmi-standard.org), in words of our own: its types, and the functions that importers of
 * co-simulation call.
 *
 * Where FMI3_FUNCTION_PREFIX is defined, every function's name begins with it, so that several FMUs
 * can be linked into one program; FMI3_OVERRIDE_FUNCTION_PREFIX takes it away again.
 */
#ifndef REIDENT_FMI3_H
#define REIDENT_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void* fmi3Instance;
typedef void* fmi3InstanceEnvironment;
typedef void* fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char* fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte* fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status,
                                       fmi3String category, fmi3String message);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment,
                                               fmi3Float64 time, fmi3Boolean set_requested,
                                               fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early,
                                               fmi3Boolean* early_return_requested,
                                               fmi3Float64* early_return_time);

#if defined(_WIN32) || defined(__CYGWIN__)
#define FMI3_API __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_API __attribute__((visibility("default")))
#else
#define FMI3_API
#endif

#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define FMI3_JOIN_EXPANDED(prefix, name) prefix##name
#define FMI3_JOIN(prefix, name) FMI3_JOIN_EXPANDED(prefix, name)
#define FMI3(name) FMI3_JOIN(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define FMI3(name) fmi3##name
#endif

FMI3_API fmi3String FMI3(GetVersion)(void);
FMI3_API fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t count,
                                          const fmi3String categories[]);
FMI3_API fmi3Instance FMI3(InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
    fmi3IntermediateUpdateCallback intermediate_update);
FMI3_API void FMI3(FreeInstance)(fmi3Instance instance);

FMI3_API fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance,
                                                  fmi3Boolean tolerance_defined,
                                                  fmi3Float64 tolerance, fmi3Float64 start_time,
                                                  fmi3Boolean stop_time_defined,
                                                  fmi3Float64 stop_time);
FMI3_API fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance);
FMI3_API fmi3Status FMI3(EnterEventMode)(fmi3Instance instance);
FMI3_API fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean* need_update,
                                               fmi3Boolean* terminate,
                                               fmi3Boolean* nominals_changed,
                                               fmi3Boolean* states_changed,
                                               fmi3Boolean* next_event_defined,
                                               fmi3Float64* next_event_time);
FMI3_API fmi3Status FMI3(EnterStepMode)(fmi3Instance instance);
FMI3_API fmi3Status FMI3(Terminate)(fmi3Instance instance);
FMI3_API fmi3Status FMI3(Reset)(fmi3Instance instance);

FMI3_API fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
                                     size_t count, fmi3Float64 values[], size_t value_count);
FMI3_API fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
                                     size_t count, const fmi3Float64 values[], size_t value_count);

FMI3_API fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState* state);
FMI3_API fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state);
FMI3_API fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState* state);
FMI3_API fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state,
                                                 size_t* size);
FMI3_API fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state,
                                            fmi3Byte bytes[], size_t size);
FMI3_API fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[],
                                              size_t size, fmi3FMUState* state);

FMI3_API fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 point, fmi3Float64 step,
                                 fmi3Boolean no_earlier_state, fmi3Boolean* event_needed,
                                 fmi3Boolean* terminate, fmi3Boolean* early_return,
                                 fmi3Float64* last_successful_time);

#endif
