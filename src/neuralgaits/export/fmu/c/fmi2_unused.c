/*
 * Functions of FMI 2.0 that an FMU for co-simulation has to have, for what this one does not:
 * strings, derivatives, states as bytes, and steps that go on in the background.
 */
#include "fmi2Functions.h"

#include "fmu.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

static fmi2Status refused(fmi2Component c, const char *message)
{
    if (c != NULL) {
        ng_fmu_refuse(c, message);
    }
    return fmi2Error;
}

#define NO_FUNCTION(name, ...)                                  \
    fmi2Status name(fmi2Component c, __VA_ARGS__)               \
    {                                                           \
        return refused(c, #name ": not a function of this FMU"); \
    }

#define NO_VARIABLES(name, ...)                                                               \
    fmi2Status name(fmi2Component c, const fmi2ValueReference references[], size_t count,     \
                    __VA_ARGS__)                                                              \
    {                                                                                         \
        return count == 0 && c != NULL ? fmi2OK                                               \
                                       : refused(c, #name ": not a function of this FMU");    \
    }

NO_VARIABLES(fmi2GetString, fmi2String values[])
NO_VARIABLES(fmi2SetString, const fmi2String values[])
NO_VARIABLES(fmi2SetRealInputDerivatives, const fmi2Integer orders[], const fmi2Real values[])
NO_VARIABLES(fmi2GetRealOutputDerivatives, const fmi2Integer orders[], fmi2Real values[])
NO_FUNCTION(fmi2GetDirectionalDerivative, const fmi2ValueReference unknowns[], size_t n_unknowns,
            const fmi2ValueReference knowns[], size_t n_knowns, const fmi2Real known[],
            fmi2Real unknown[])
NO_FUNCTION(fmi2SerializedFMUstateSize, fmi2FMUstate state, size_t *size)
NO_FUNCTION(fmi2SerializeFMUstate, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
NO_FUNCTION(fmi2DeSerializeFMUstate, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)

#define NO_STATUS(name, type)                                                \
    fmi2Status name(fmi2Component c, const fmi2StatusKind kind, type *value) \
    {                                                                        \
        return c == NULL ? fmi2Error : fmi2Discard;                          \
    }

NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)
