/* FMI 2.0 for co-simulation; fmu.c has what is common to both versions of the standard. */
#include "fmi2Functions.h"

#include <stdlib.h>
#include <string.h>

#include "fmu.h"

typedef struct {
    ng_fmu fmu; /* first: messages come with its address */
    char *name;
    double start_time; /* of fmi2SetupExperiment [s] */
    const fmi2CallbackFunctions *host;
} instance2;

static const fmi2Status statuses[] = {fmi2OK, fmi2Discard, fmi2Error};

/* Messages are formats to the host: none of them has a percent sign. */
static void pass_on(ng_fmu *fmu, ng_fmu_status status, const char *message)
{
    const instance2 *own = (const instance2 *)(const void *)fmu;
    if (own->host->logger != NULL) {
        own->host->logger(own->host->componentEnvironment, own->name, statuses[status],
                          status == NG_FMU_OK ? "logEvents" : "logStatusError", message);
    }
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    instance2 *own = c;
    int named = nCategories == 0 || categories == NULL;
    if (own == NULL) {
        return fmi2Error;
    }
    for (size_t i = 0; !named && i < nCategories; ++i) {
        named = categories[i] != NULL && strcmp(categories[i], "logEvents") == 0;
    }
    if (named) {
        own->fmu.events = loggingOn != fmi2False;
    }
    return fmi2OK;
}

/* A refusal before there is an instance. */
static fmi2Component nothing(const fmi2CallbackFunctions *host, fmi2String name, const char *text)
{
    if (host != NULL && host->logger != NULL) {
        host->logger(host->componentEnvironment, name, fmi2Error, "logStatusError", text);
    }
    return NULL;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    const char *name = instanceName == NULL ? "" : instanceName;
    (void)fmuResourceLocation, (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    if (fmuType != fmi2CoSimulation) {
        return nothing(functions, name, "instantiate: expected co-simulation");
    }
    if (fmuGUID == NULL || strcmp(fmuGUID, NG_FMU_TOKEN) != 0) {
        return nothing(functions, name,
                       "instantiate: expected the guid of modelDescription.xml: the binary is of "
                       "another export");
    }
    instance2 *own = calloc(1, sizeof *own);
    char *copy = malloc(strlen(name) + 1);
    if (own == NULL || copy == NULL) {
        free(own);
        free(copy);
        return nothing(functions, name, "instantiate: out of memory");
    }
    strcpy(copy, name);
    own->name = copy;
    own->host = functions;
    own->fmu.log = pass_on;
    own->fmu.events = loggingOn != fmi2False;
    ng_fmu_reset(&own->fmu);
    return own;
}

void fmi2FreeInstance(fmi2Component c)
{
    instance2 *own = c;
    if (own != NULL) {
        free(own->name);
        free(own);
    }
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    instance2 *own = c;
    (void)toleranceDefined, (void)tolerance, (void)stopTimeDefined, (void)stopTime;
    if (own == NULL) {
        return fmi2Error;
    }
    own->start_time = startTime;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    instance2 *own = c;
    return own == NULL ? fmi2Error
                       : statuses[ng_fmu_enter_initialization(&own->fmu, own->start_time)];
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return c == NULL ? fmi2Error : statuses[ng_fmu_exit_initialization(c)];
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return c == NULL ? fmi2Error : statuses[ng_fmu_terminate(c)];
}

fmi2Status fmi2Reset(fmi2Component c)
{
    instance2 *own = c;
    if (own == NULL) {
        return fmi2Error;
    }
    own->start_time = 0.0;
    ng_fmu_reset(&own->fmu);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    return c == NULL
               ? fmi2Error
               : statuses[ng_fmu_step(c, currentCommunicationPoint, communicationStepSize)];
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return c == NULL ? fmi2Error
                     : statuses[ng_fmu_refuse(c, "fmi2CancelStep: expected a step under way")];
}

/* Whether there is something to read or write. */
static fmi2Status fits(fmi2Component c, const void *references, size_t count, const void *values)
{
    if (c == NULL) {
        return fmi2Error;
    }
    if (count > 0 && (references == NULL || values == NULL)) {
        return statuses[ng_fmu_refuse(c, "expected value references and values, found none")];
    }
    return fmi2OK;
}

#define GETTER(name, type, held, read)                                                            \
    fmi2Status name(fmi2Component c, const fmi2ValueReference references[], size_t count,         \
                    type values[])                                                                \
    {                                                                                             \
        fmi2Status status = fits(c, references, count, values);                                   \
        for (size_t i = 0; status == fmi2OK && i < count; ++i) {                                  \
            held value;                                                                           \
            status = statuses[read(c, references[i], &value)];                                    \
            values[i] = (type)value;                                                              \
        }                                                                                         \
        return status;                                                                            \
    }

#define SETTER(name, type, write)                                                                 \
    fmi2Status name(fmi2Component c, const fmi2ValueReference references[], size_t count,         \
                    const type values[])                                                          \
    {                                                                                             \
        fmi2Status status = fits(c, references, count, values);                                   \
        for (size_t i = 0; status == fmi2OK && i < count; ++i) {                                  \
            status = statuses[write(c, references[i], values[i])];                                \
        }                                                                                         \
        return status;                                                                            \
    }

GETTER(fmi2GetReal, fmi2Real, double, ng_fmu_read_real)
GETTER(fmi2GetInteger, fmi2Integer, int32_t, ng_fmu_read_integer)
GETTER(fmi2GetBoolean, fmi2Boolean, int, ng_fmu_read_boolean)
SETTER(fmi2SetReal, fmi2Real, ng_fmu_write_real)
SETTER(fmi2SetInteger, fmi2Integer, ng_fmu_write_integer)
SETTER(fmi2SetBoolean, fmi2Boolean, ng_fmu_write_boolean)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    const instance2 *own = c;
    if (own == NULL || FMUstate == NULL) {
        return fmi2Error;
    }
    if (*FMUstate == NULL) {
        *FMUstate = ng_fmu_save(&own->fmu);
    } else {
        *(ng_fmu_memory *)*FMUstate = own->fmu.memory;
    }
    return *FMUstate == NULL ? fmi2Error : fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    instance2 *own = c;
    if (own == NULL || FMUstate == NULL) {
        return fmi2Error;
    }
    own->fmu.memory = *(const ng_fmu_memory *)FMUstate;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    if (c == NULL || FMUstate == NULL) {
        return fmi2Error;
    }
    free(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    const instance2 *own = c;
    if (own == NULL || value == NULL) {
        return fmi2Error;
    }
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = own->fmu.memory.time;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (c == NULL || value == NULL) {
        return fmi2Error;
    }
    *value = fmi2False; /* a step never ends the simulation by itself */
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}
