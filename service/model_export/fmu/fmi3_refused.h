/* The functions of FMI 3.0 that this FMU has nothing for: the standard wants all of them defined.
 * Each logs that and gives fmi3Error. */
#ifndef REIDENT_FMI3_REFUSED_H
#define REIDENT_FMI3_REFUSED_H

#include "calls.h"
#include "fmi3.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

typedef enum { fmi3DependencyKindOfNone } fmi3DependencyKind;
typedef enum { fmi3IntervalOfNone } fmi3IntervalQualifier;
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment environment);
typedef void (*fmi3PreemptionCallback)(void);

#define FMI3_REFUSED(name, parameters)                                                          \
  FMI3_API fmi3Status FMI3(name) parameters;                                                    \
  FMI3_API fmi3Status FMI3(name) parameters {                                                   \
    return (fmi3Status)refuse_call(instance, "this FMU has nothing that fmi3" #name " is for"); \
  }

FMI3_API fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token,
                                                     fmi3String resource_path, fmi3Boolean visible,
                                                     fmi3Boolean logging_on,
                                                     fmi3InstanceEnvironment environment,
                                                     fmi3LogMessageCallback log_message);
FMI3_API fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
    fmi3ClockUpdateCallback clock_update, fmi3PreemptionCallback lock,
    fmi3PreemptionCallback unlock);

static fmi3Instance fmi3_refuse_instance(fmi3String name, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log_message) {
  const Host host = {"fmi3", fmi3_hand_over, (void (*)(void))log_message, environment};
  log_text(&host, name == NULL ? "" : name, status_error, only_co_simulation);
  return NULL;
}

fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token,
                                            fmi3String resource_path, fmi3Boolean visible,
                                            fmi3Boolean logging_on,
                                            fmi3InstanceEnvironment environment,
                                            fmi3LogMessageCallback log_message) {
  return fmi3_refuse_instance(name, environment, log_message);
}

fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
    fmi3ClockUpdateCallback clock_update, fmi3PreemptionCallback lock,
    fmi3PreemptionCallback unlock) {
  return fmi3_refuse_instance(name, environment, log_message);
}

FMI3_REFUSED(GetBinary, (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
                         size_t* sizes, fmi3Binary* values, size_t value_count))
FMI3_REFUSED(SetBinary, (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
                         const size_t* sizes, const fmi3Binary* values, size_t value_count))
FMI3_REFUSED(GetClock, (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
                        fmi3Clock* values))
FMI3_REFUSED(SetClock, (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
                        const fmi3Clock* values))
FMI3_REFUSED(GetIntervalDecimal,
             (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
              fmi3Float64* intervals, fmi3IntervalQualifier* qualifiers))
FMI3_REFUSED(GetIntervalFraction,
             (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
              fmi3UInt64* counters, fmi3UInt64* resolutions, fmi3IntervalQualifier* qualifiers))
FMI3_REFUSED(GetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference* references,
                               size_t count, fmi3Float64* shifts))
FMI3_REFUSED(GetShiftFraction, (fmi3Instance instance, const fmi3ValueReference* references,
                                size_t count, fmi3UInt64* counters, fmi3UInt64* resolutions))
FMI3_REFUSED(SetIntervalDecimal, (fmi3Instance instance, const fmi3ValueReference* references,
                                  size_t count, const fmi3Float64* intervals))
FMI3_REFUSED(SetIntervalFraction,
             (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
              const fmi3UInt64* counters, const fmi3UInt64* resolutions))
FMI3_REFUSED(SetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference* references,
                               size_t count, const fmi3Float64* shifts))
FMI3_REFUSED(SetShiftFraction,
             (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
              const fmi3UInt64* counters, const fmi3UInt64* resolutions))
FMI3_REFUSED(ActivateModelPartition,
             (fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time))

FMI3_REFUSED(GetNumberOfVariableDependencies,
             (fmi3Instance instance, fmi3ValueReference reference, size_t* count))
FMI3_REFUSED(GetVariableDependencies,
             (fmi3Instance instance, fmi3ValueReference dependent, size_t* elements,
              fmi3ValueReference* independents, size_t* independent_elements,
              fmi3DependencyKind* kinds, size_t count))
FMI3_REFUSED(GetDirectionalDerivative,
             (fmi3Instance instance, const fmi3ValueReference* unknowns, size_t unknown_count,
              const fmi3ValueReference* knowns, size_t known_count, const fmi3Float64* seed,
              size_t seed_count, fmi3Float64* sensitivity, size_t sensitivity_count))
FMI3_REFUSED(GetAdjointDerivative,
             (fmi3Instance instance, const fmi3ValueReference* unknowns, size_t unknown_count,
              const fmi3ValueReference* knowns, size_t known_count, const fmi3Float64* seed,
              size_t seed_count, fmi3Float64* sensitivity, size_t sensitivity_count))
FMI3_REFUSED(GetOutputDerivatives,
             (fmi3Instance instance, const fmi3ValueReference* references, size_t count,
              const fmi3Int32* orders, fmi3Float64* values, size_t value_count))

FMI3_REFUSED(EnterConfigurationMode, (fmi3Instance instance))
FMI3_REFUSED(ExitConfigurationMode, (fmi3Instance instance))
FMI3_REFUSED(EvaluateDiscreteStates, (fmi3Instance instance))
FMI3_REFUSED(EnterContinuousTimeMode, (fmi3Instance instance))
FMI3_REFUSED(CompletedIntegratorStep, (fmi3Instance instance, fmi3Boolean no_earlier_state,
                                       fmi3Boolean* enter_event_mode, fmi3Boolean* terminate))
FMI3_REFUSED(SetTime, (fmi3Instance instance, fmi3Float64 time))
FMI3_REFUSED(SetContinuousStates, (fmi3Instance instance, const fmi3Float64* states, size_t count))
FMI3_REFUSED(GetContinuousStates, (fmi3Instance instance, fmi3Float64* states, size_t count))
FMI3_REFUSED(GetContinuousStateDerivatives,
             (fmi3Instance instance, fmi3Float64* derivatives, size_t count))
FMI3_REFUSED(GetEventIndicators, (fmi3Instance instance, fmi3Float64* indicators, size_t count))
FMI3_REFUSED(GetNominalsOfContinuousStates,
             (fmi3Instance instance, fmi3Float64* nominals, size_t count))
FMI3_REFUSED(GetNumberOfEventIndicators, (fmi3Instance instance, size_t* count))
FMI3_REFUSED(GetNumberOfContinuousStates, (fmi3Instance instance, size_t* count))

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
