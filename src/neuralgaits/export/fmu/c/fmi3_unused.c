/*
 * Functions of FMI 3.0 that every FMU has to have, for what this one does not: variables of other
 * types, clocks, derivatives, events, configuration, model exchange, scheduled execution, and
 * states as bytes. They change nothing; unless they are asked for nothing, they return an error.
 */
#include "fmi3Functions.h"

#include "fmu.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

static fmi3Status refused(fmi3Instance instance, const char *message)
{
    if (instance != NULL) {
        ng_fmu_refuse(instance, message);
    }
    return fmi3Error;
}

#define REFUSED(name) return refused(instance, #name ": not a function of this FMU");

/* The last parameters of many of them. */
#define REFERENCES const fmi3ValueReference references[], size_t count
#define VECTOR(name) const fmi3Float64 name[], size_t n_##name

#define NO_VALUES(type)                                                                           \
    fmi3Status fmi3Get##type(fmi3Instance instance, REFERENCES, fmi3##type values[], size_t size) \
    {                                                                                             \
        return count == 0 && instance != NULL                                                     \
                   ? fmi3OK                                                                       \
                   : refused(instance, "fmi3Get" #type ": no variable has this type");            \
    }                                                                                             \
    fmi3Status fmi3Set##type(fmi3Instance instance, REFERENCES, const fmi3##type values[],        \
                             size_t size)                                                         \
    {                                                                                             \
        return count == 0 && instance != NULL                                                     \
                   ? fmi3OK                                                                       \
                   : refused(instance, "fmi3Set" #type ": no variable has this type");            \
    }

NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(UInt32)
NO_VALUES(Int64)
NO_VALUES(UInt64)
NO_VALUES(String)

#define NO_FUNCTION(name, ...) \
    fmi3Status name(fmi3Instance instance, __VA_ARGS__) { REFUSED(name) }

NO_FUNCTION(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t size)
NO_FUNCTION(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t size)
NO_FUNCTION(fmi3GetClock, REFERENCES, fmi3Clock values[])
NO_FUNCTION(fmi3SetClock, REFERENCES, const fmi3Clock values[])
NO_FUNCTION(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
NO_FUNCTION(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elements[],
            fmi3ValueReference independents[], size_t others[], fmi3DependencyKind kinds[],
            size_t count)
NO_FUNCTION(fmi3SerializedFMUStateSize, fmi3FMUState state, size_t *size)
NO_FUNCTION(fmi3SerializeFMUState, fmi3FMUState state, fmi3Byte bytes[], size_t size)
NO_FUNCTION(fmi3DeserializeFMUState, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
NO_FUNCTION(fmi3GetDirectionalDerivative, REFERENCES, const fmi3ValueReference knowns[],
            size_t n_knowns, VECTOR(seed), fmi3Float64 sensitivity[], size_t size)
NO_FUNCTION(fmi3GetAdjointDerivative, REFERENCES, const fmi3ValueReference knowns[],
            size_t n_knowns, VECTOR(seed), fmi3Float64 sensitivity[], size_t size)
NO_FUNCTION(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[],
            fmi3IntervalQualifier qualifiers[])
NO_FUNCTION(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
            fmi3IntervalQualifier qualifiers[])
NO_FUNCTION(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
NO_FUNCTION(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NO_FUNCTION(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
NO_FUNCTION(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NO_FUNCTION(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
NO_FUNCTION(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NO_FUNCTION(fmi3UpdateDiscreteStates, fmi3Boolean *more, fmi3Boolean *terminate,
            fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
NO_FUNCTION(fmi3CompletedIntegratorStep, fmi3Boolean no_set, fmi3Boolean *enter,
            fmi3Boolean *terminate)
NO_FUNCTION(fmi3SetTime, fmi3Float64 time)
NO_FUNCTION(fmi3SetContinuousStates, VECTOR(states))
NO_FUNCTION(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t size)
NO_FUNCTION(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t size)
NO_FUNCTION(fmi3GetContinuousStates, fmi3Float64 states[], size_t size)
NO_FUNCTION(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t size)
NO_FUNCTION(fmi3GetNumberOfEventIndicators, size_t *size)
NO_FUNCTION(fmi3GetNumberOfContinuousStates, size_t *size)
NO_FUNCTION(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
            size_t size)
NO_FUNCTION(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

#define NO_MODE(name) \
    fmi3Status name(fmi3Instance instance) { REFUSED(name) }

NO_MODE(fmi3EnterEventMode)
NO_MODE(fmi3EnterStepMode)
NO_MODE(fmi3EnterContinuousTimeMode)
NO_MODE(fmi3EnterConfigurationMode)
NO_MODE(fmi3ExitConfigurationMode)
NO_MODE(fmi3EvaluateDiscreteStates)
