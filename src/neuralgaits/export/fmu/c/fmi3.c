/*
 * FMI 3.0 for co-simulation; fmu.c has what is common to both versions of the standard, and
 * fmi3_unused.c the functions that have to be there for what this FMU does not have.
 */
#include "fmi3Functions.h"

#include <stdlib.h>
#include <string.h>

#include "fmu.h"

typedef struct {
    ng_fmu fmu; /* first: messages come with its address */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback message;
} instance3;

static const fmi3Status statuses[] = {fmi3OK, fmi3Discard, fmi3Error};

static void pass_on(ng_fmu *fmu, ng_fmu_status status, const char *message)
{
    const instance3 *own = (const instance3 *)(const void *)fmu;
    if (own->message != NULL) {
        own->message(own->environment, statuses[status],
                     status == NG_FMU_OK ? "logEvents" : "logStatusError", message);
    }
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    instance3 *own = instance;
    int named = nCategories == 0 || categories == NULL;
    if (own == NULL) {
        return fmi3Error;
    }
    for (size_t i = 0; !named && i < nCategories; ++i) {
        named = categories[i] != NULL && strcmp(categories[i], "logEvents") == 0;
    }
    if (named) {
        own->fmu.events = loggingOn;
    }
    return fmi3OK;
}

/* A refusal before there is an instance. */
static fmi3Instance nothing(fmi3InstanceEnvironment environment, fmi3LogMessageCallback message,
                            const char *text)
{
    if (message != NULL) {
        message(environment, fmi3Error, "logStatusError", text);
    }
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)instanceName, (void)resourcePath, (void)visible, (void)eventModeUsed;
    (void)earlyReturnAllowed, (void)requiredIntermediateVariables;
    (void)nRequiredIntermediateVariables, (void)intermediateUpdate;
    if (instantiationToken == NULL || strcmp(instantiationToken, NG_FMU_TOKEN) != 0) {
        return nothing(instanceEnvironment, logMessage,
                       "instantiate: expected the token of modelDescription.xml: the binary is of "
                       "another export");
    }
    instance3 *own = calloc(1, sizeof *own);
    if (own == NULL) {
        return nothing(instanceEnvironment, logMessage, "instantiate: out of memory");
    }
    own->environment = instanceEnvironment;
    own->message = logMessage;
    own->fmu.log = pass_on;
    own->fmu.events = loggingOn;
    ng_fmu_reset(&own->fmu);
    return own;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible,
                                          fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)instanceName, (void)instantiationToken, (void)resourcePath, (void)visible;
    (void)loggingOn;
    return nothing(instanceEnvironment, logMessage, "instantiate: expected co-simulation");
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
    fmi3LockPreemptionCallback lockPreemption, fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instanceName, (void)instantiationToken, (void)resourcePath, (void)visible;
    (void)loggingOn, (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    return nothing(instanceEnvironment, logMessage, "instantiate: expected co-simulation");
}

void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    (void)toleranceDefined, (void)tolerance, (void)stopTimeDefined, (void)stopTime;
    return instance == NULL ? fmi3Error
                            : statuses[ng_fmu_enter_initialization(instance, startTime)];
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    return instance == NULL ? fmi3Error : statuses[ng_fmu_exit_initialization(instance)];
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    return instance == NULL ? fmi3Error : statuses[ng_fmu_terminate(instance)];
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    if (instance == NULL) {
        return fmi3Error;
    }
    ng_fmu_reset(instance);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    fmi3Boolean *const never[] = {eventHandlingNeeded, terminateSimulation, earlyReturn};
    instance3 *own = instance;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (own == NULL) {
        return fmi3Error;
    }
    const ng_fmu_status status =
        ng_fmu_step(&own->fmu, currentCommunicationPoint, communicationStepSize);
    for (size_t i = 0; i < sizeof never / sizeof never[0]; ++i) {
        if (never[i] != NULL) {
            *never[i] = fmi3False;
        }
    }
    if (lastSuccessfulTime != NULL) {
        *lastSuccessfulTime = own->fmu.memory.time;
    }
    return statuses[status];
}

/* Values in this order: as many as references, since no variable is an array. */
static fmi3Status fits(fmi3Instance instance, const void *references, size_t count,
                       const void *values, size_t size)
{
    if (instance == NULL) {
        return fmi3Error;
    }
    if (count != size || (count > 0 && (references == NULL || values == NULL))) {
        return statuses[ng_fmu_refuse(instance, "expected as many values as value references")];
    }
    return fmi3OK;
}

#define GETTER(name, type, held, read)                                                            \
    fmi3Status name(fmi3Instance instance, const fmi3ValueReference references[], size_t count,   \
                    type values[], size_t size)                                                   \
    {                                                                                             \
        fmi3Status status = fits(instance, references, count, values, size);                      \
        for (size_t i = 0; status == fmi3OK && i < count; ++i) {                                  \
            held value;                                                                           \
            status = statuses[read(instance, references[i], &value)];                             \
            values[i] = (type)value;                                                              \
        }                                                                                         \
        return status;                                                                            \
    }

#define SETTER(name, type, write)                                                                 \
    fmi3Status name(fmi3Instance instance, const fmi3ValueReference references[], size_t count,   \
                    const type values[], size_t size)                                             \
    {                                                                                             \
        fmi3Status status = fits(instance, references, count, values, size);                      \
        for (size_t i = 0; status == fmi3OK && i < count; ++i) {                                  \
            status = statuses[write(instance, references[i], values[i])];                         \
        }                                                                                         \
        return status;                                                                            \
    }

GETTER(fmi3GetFloat64, fmi3Float64, double, ng_fmu_read_real)
GETTER(fmi3GetInt32, fmi3Int32, int32_t, ng_fmu_read_integer)
GETTER(fmi3GetBoolean, fmi3Boolean, int, ng_fmu_read_boolean)
SETTER(fmi3SetFloat64, fmi3Float64, ng_fmu_write_real)
SETTER(fmi3SetInt32, fmi3Int32, ng_fmu_write_integer)
SETTER(fmi3SetBoolean, fmi3Boolean, ng_fmu_write_boolean)

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    const instance3 *own = instance;
    if (own == NULL || FMUState == NULL) {
        return fmi3Error;
    }
    if (*FMUState == NULL) {
        *FMUState = ng_fmu_save(&own->fmu);
    } else {
        *(ng_fmu_memory *)*FMUState = own->fmu.memory;
    }
    return *FMUState == NULL ? fmi3Error : fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    instance3 *own = instance;
    if (own == NULL || FMUState == NULL) {
        return fmi3Error;
    }
    own->fmu.memory = *(const ng_fmu_memory *)FMUState;
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    if (instance == NULL || FMUState == NULL) {
        return fmi3Error;
    }
    free(*FMUState);
    *FMUState = NULL;
    return fmi3OK;
}
