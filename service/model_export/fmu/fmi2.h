/* What an FMU for co-simulation declares by the Functional Mock-up Interface 2.0
 * (fmi-standard.org), in words of our own: the types of the platform "default", and the functions
 * that this one defines.
 *
 * Where FMI2_FUNCTION_PREFIX is defined, every function's name begins with it, so that several FMUs
 * can be linked into one program; FMI2_OVERRIDE_FUNCTION_PREFIX takes it away again, as a shared
 * library needs.
 */
#ifndef REIDENT_FMI2_H
#define REIDENT_FMI2_H

#include <stddef.h>

typedef void* fmi2Component;
typedef void* fmi2ComponentEnvironment;
typedef void* fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char* fmi2String;
typedef char fmi2Byte;

enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;

typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;

typedef enum {
  fmi2DoStepStatus,
  fmi2PendingStatus,
  fmi2LastSuccessfulTime,
  fmi2Terminated
} fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment environment, fmi2String instance,
                                   fmi2Status status, fmi2String category, fmi2String message, ...);
typedef void* (*fmi2CallbackAllocateMemory)(size_t count, size_t size);
typedef void (*fmi2CallbackFreeMemory)(void* memory);
typedef void (*fmi2StepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);

typedef struct {
  fmi2CallbackLogger logger;
  fmi2CallbackAllocateMemory allocateMemory;
  fmi2CallbackFreeMemory freeMemory;
  fmi2StepFinished stepFinished;
  fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined(_WIN32) || defined(__CYGWIN__)
#define FMI2_API __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_API __attribute__((visibility("default")))
#else
#define FMI2_API
#endif

#if defined(FMI2_FUNCTION_PREFIX) && !defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define FMI2_JOIN_EXPANDED(prefix, name) prefix##name
#define FMI2_JOIN(prefix, name) FMI2_JOIN_EXPANDED(prefix, name)
#define FMI2(name) FMI2_JOIN(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define FMI2(name) fmi2##name
#endif

FMI2_API fmi2String FMI2(GetTypesPlatform)(void);
FMI2_API fmi2String FMI2(GetVersion)(void);
FMI2_API fmi2Status FMI2(SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count,
                                          const fmi2String categories[]);

FMI2_API fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                         fmi2String resources,
                                         const fmi2CallbackFunctions* functions,
                                         fmi2Boolean visible, fmi2Boolean logging_on);
FMI2_API void FMI2(FreeInstance)(fmi2Component component);

FMI2_API fmi2Status FMI2(SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_defined,
                                          fmi2Real tolerance, fmi2Real start_time,
                                          fmi2Boolean stop_time_defined, fmi2Real stop_time);
FMI2_API fmi2Status FMI2(EnterInitializationMode)(fmi2Component component);
FMI2_API fmi2Status FMI2(ExitInitializationMode)(fmi2Component component);
FMI2_API fmi2Status FMI2(Terminate)(fmi2Component component);
FMI2_API fmi2Status FMI2(Reset)(fmi2Component component);

FMI2_API fmi2Status FMI2(GetReal)(fmi2Component component, const fmi2ValueReference references[],
                                  size_t count, fmi2Real values[]);
FMI2_API fmi2Status FMI2(GetInteger)(fmi2Component component, const fmi2ValueReference references[],
                                     size_t count, fmi2Integer values[]);
FMI2_API fmi2Status FMI2(GetBoolean)(fmi2Component component, const fmi2ValueReference references[],
                                     size_t count, fmi2Boolean values[]);
FMI2_API fmi2Status FMI2(GetString)(fmi2Component component, const fmi2ValueReference references[],
                                    size_t count, fmi2String values[]);
FMI2_API fmi2Status FMI2(SetReal)(fmi2Component component, const fmi2ValueReference references[],
                                  size_t count, const fmi2Real values[]);
FMI2_API fmi2Status FMI2(SetInteger)(fmi2Component component, const fmi2ValueReference references[],
                                     size_t count, const fmi2Integer values[]);
FMI2_API fmi2Status FMI2(SetBoolean)(fmi2Component component, const fmi2ValueReference references[],
                                     size_t count, const fmi2Boolean values[]);
FMI2_API fmi2Status FMI2(SetString)(fmi2Component component, const fmi2ValueReference references[],
                                    size_t count, const fmi2String values[]);

FMI2_API fmi2Status FMI2(GetFMUstate)(fmi2Component component, fmi2FMUstate* state);
FMI2_API fmi2Status FMI2(SetFMUstate)(fmi2Component component, fmi2FMUstate state);
FMI2_API fmi2Status FMI2(FreeFMUstate)(fmi2Component component, fmi2FMUstate* state);
FMI2_API fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state,
                                                 size_t* size);
FMI2_API fmi2Status FMI2(SerializeFMUstate)(fmi2Component component, fmi2FMUstate state,
                                            fmi2Byte bytes[], size_t size);
FMI2_API fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[],
                                              size_t size, fmi2FMUstate* state);

FMI2_API fmi2Status FMI2(GetDirectionalDerivative)(
    fmi2Component component, const fmi2ValueReference unknowns[], size_t unknown_count,
    const fmi2ValueReference knowns[], size_t known_count, const fmi2Real known_changes[],
    fmi2Real unknown_changes[]);
FMI2_API fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component component,
                                                  const fmi2ValueReference references[],
                                                  size_t count, const fmi2Integer orders[],
                                                  const fmi2Real values[]);
FMI2_API fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component component,
                                                   const fmi2ValueReference references[],
                                                   size_t count, const fmi2Integer orders[],
                                                   fmi2Real values[]);

FMI2_API fmi2Status FMI2(DoStep)(fmi2Component component, fmi2Real point, fmi2Real step,
                                 fmi2Boolean no_earlier_state);
FMI2_API fmi2Status FMI2(CancelStep)(fmi2Component component);
FMI2_API fmi2Status FMI2(GetStatus)(fmi2Component component, fmi2StatusKind kind,
                                    fmi2Status* value);
FMI2_API fmi2Status FMI2(GetRealStatus)(fmi2Component component, fmi2StatusKind kind,
                                        fmi2Real* value);
FMI2_API fmi2Status FMI2(GetIntegerStatus)(fmi2Component component, fmi2StatusKind kind,
                                           fmi2Integer* value);
FMI2_API fmi2Status FMI2(GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind,
                                           fmi2Boolean* value);
FMI2_API fmi2Status FMI2(GetStringStatus)(fmi2Component component, fmi2StatusKind kind,
                                          fmi2String* value);

#endif
