/* Functions of FMI 3.0 that importers look up although the model description declares their features
 * as absent: other interface types, clocks, derivatives, serialised states, and variables of types that
 * no variable has. All refuse, without a look at their arguments. */
#include "fmu.h"

#define REFUSE(NAME, WHY, ...)                                                                      \
   FMI3 fmi3Status NAME(fmi3Instance handle, ##__VA_ARGS__) { return refuse(handle, #NAME, WHY); }

/* --- other interface types --- */

static fmi3Instance refuse_type(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
   if (log) log(environment, fmi3Error, "logStatusError", "this FMU is for co-simulation only");
   return NULL;
}

FMI3 fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                               fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log) {
   (void)name, (void)token, (void)resources, (void)visible, (void)logging;
   return refuse_type(environment, log);
}

FMI3 fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
   (void)name, (void)token, (void)resources, (void)visible, (void)logging;
   (void)update, (void)lock, (void)unlock;
   return refuse_type(environment, log);
}

#pragma GCC diagnostic ignored "-Wunused-parameter"

#define MODEL_EXCHANGE "this FMU is for co-simulation only"
REFUSE(fmi3EnterContinuousTimeMode, MODEL_EXCHANGE)
REFUSE(fmi3CompletedIntegratorStep, MODEL_EXCHANGE, fmi3Boolean no_set_state, fmi3Boolean *enter_event,
       fmi3Boolean *terminate)
REFUSE(fmi3SetTime, MODEL_EXCHANGE, double t)
REFUSE(fmi3SetContinuousStates, MODEL_EXCHANGE, const double x[], size_t n)
REFUSE(fmi3GetContinuousStateDerivatives, MODEL_EXCHANGE, double x_dot[], size_t n)
REFUSE(fmi3GetEventIndicators, MODEL_EXCHANGE, double z[], size_t n)
REFUSE(fmi3GetContinuousStates, MODEL_EXCHANGE, double x[], size_t n)
REFUSE(fmi3GetNominalsOfContinuousStates, MODEL_EXCHANGE, double nominals[], size_t n)
REFUSE(fmi3GetNumberOfEventIndicators, MODEL_EXCHANGE, size_t *n)
REFUSE(fmi3GetNumberOfContinuousStates, MODEL_EXCHANGE, size_t *n)
REFUSE(fmi3ActivateModelPartition, MODEL_EXCHANGE, fmi3ValueReference clock, double t)

/* --- variables of other types --- */

typedef const fmi3ValueReference references[];
#define NO_VARIABLE "no variable has this type"
#define OTHER_TYPE(NAME, TYPE)                                                                      \
   REFUSE(fmi3Get##NAME, NO_VARIABLE, references which, size_t n, TYPE values[], size_t n_values)    \
   REFUSE(fmi3Set##NAME, NO_VARIABLE, references which, size_t n, const TYPE values[], size_t n_values)
OTHER_TYPE(Float32, float)
OTHER_TYPE(Int8, int8_t)
OTHER_TYPE(UInt8, uint8_t)
OTHER_TYPE(Int16, int16_t)
OTHER_TYPE(UInt16, uint16_t)
OTHER_TYPE(Int32, int32_t)
OTHER_TYPE(UInt32, uint32_t)
OTHER_TYPE(UInt64, uint64_t)
OTHER_TYPE(String, fmi3String)
REFUSE(fmi3GetBinary, NO_VARIABLE, references which, size_t n, size_t sizes[], fmi3Binary values[],
       size_t n_values)
REFUSE(fmi3SetBinary, NO_VARIABLE, references which, size_t n, const size_t sizes[],
       const fmi3Binary values[], size_t n_values)

/* --- clocks --- */

#define NO_CLOCK "there are no clocks"
REFUSE(fmi3GetClock, NO_CLOCK, references which, size_t n, fmi3Clock values[])
REFUSE(fmi3SetClock, NO_CLOCK, references which, size_t n, const fmi3Clock values[])
REFUSE(fmi3GetIntervalDecimal, NO_CLOCK, references which, size_t n, double intervals[],
       fmi3IntervalQualifier qualifiers[])
REFUSE(fmi3GetIntervalFraction, NO_CLOCK, references which, size_t n, uint64_t counters[],
       uint64_t resolutions[], fmi3IntervalQualifier qualifiers[])
REFUSE(fmi3GetShiftDecimal, NO_CLOCK, references which, size_t n, double shifts[])
REFUSE(fmi3GetShiftFraction, NO_CLOCK, references which, size_t n, uint64_t counters[],
       uint64_t resolutions[])
REFUSE(fmi3SetIntervalDecimal, NO_CLOCK, references which, size_t n, const double intervals[])
REFUSE(fmi3SetIntervalFraction, NO_CLOCK, references which, size_t n, const uint64_t counters[],
       const uint64_t resolutions[])
REFUSE(fmi3SetShiftDecimal, NO_CLOCK, references which, size_t n, const double shifts[])
REFUSE(fmi3SetShiftFraction, NO_CLOCK, references which, size_t n, const uint64_t counters[],
       const uint64_t resolutions[])

/* --- features declared as absent --- */

#define NOT_DECLARED "not provided, as the model description declares"
REFUSE(fmi3EvaluateDiscreteStates, NOT_DECLARED)
REFUSE(fmi3EnterConfigurationMode, NOT_DECLARED)
REFUSE(fmi3ExitConfigurationMode, NOT_DECLARED)
REFUSE(fmi3GetNumberOfVariableDependencies, NOT_DECLARED, fmi3ValueReference which, size_t *n)
REFUSE(fmi3GetVariableDependencies, NOT_DECLARED, fmi3ValueReference dependent,
       size_t elements_of_dependent[], fmi3ValueReference independents[],
       size_t elements_of_independents[], fmi3DependencyKind kinds[], size_t n)
REFUSE(fmi3SerializedFMUStateSize, NOT_DECLARED, fmi3FMUState state, size_t *size)
REFUSE(fmi3SerializeFMUState, NOT_DECLARED, fmi3FMUState state, fmi3Byte bytes[], size_t size)
REFUSE(fmi3DeserializeFMUState, NOT_DECLARED, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
REFUSE(fmi3GetDirectionalDerivative, NOT_DECLARED, references unknowns, size_t n_unknowns,
       references knowns, size_t n_knowns, const double seed[], size_t n_seed, double sensitivity[],
       size_t n_sensitivity)
REFUSE(fmi3GetAdjointDerivative, NOT_DECLARED, references unknowns, size_t n_unknowns,
       references knowns, size_t n_knowns, const double seed[], size_t n_seed, double sensitivity[],
       size_t n_sensitivity)
REFUSE(fmi3GetOutputDerivatives, NOT_DECLARED, references which, size_t n, const int32_t orders[],
       double values[], size_t n_values)
