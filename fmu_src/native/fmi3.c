/* FMI 3.0 for co-simulation: a thin layer over that of FMI 2.0, which is included as it is and whose calls nobody else sees.
   Value references are those of FMI 2.0; an array has that of its first element, and N_VARIABLES is the time. */
#include "fmi2FunctionTypes.h"
#define fmi2Functions_h /* that header would export the calls */
#define fmi2Version "2.0"
#define FMI "fmi3"
#define FMU_STATE "FMUState"
#define TOKEN "instantiation token"
#define REAL "Float64"
#define INTEGER "Int32"
#include "fmu.c"

#include "fmi3Functions.h"

#include "absent3.h"

/* -- what a host is told */

typedef struct {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Host;

/* FMI 3.0 takes a text as it is, where that of FMI 2.0 is a printf format without arguments: two per cent signs are one. */
static void tell_host(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String format, ...)
{
    const Host *host = environment;
    char text[4096];
    size_t n = 0;
    (void)name;
    for (; *format && n < sizeof text - 1; format += format[0] == '%' ? 2 : 1)
        text[n++] = *format;
    text[n] = 0;
    if (host->log)
        host->log(host->environment, (fmi3Status)status, category, text);
}

/* -- life of an instance */

const char *fmi3GetVersion(void) { return fmi3Version; }

static fmi3Instance no_instance(const char *call, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    Host host = {environment, log};
    Instance caller = {.log = {.logger = tell_host, .environment = &host}};
    choose_categories(&caller.log, 0, 0);
    absent(&caller, call);
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    return no_instance("fmi3InstantiateModelExchange", environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    return no_instance("fmi3InstantiateScheduledExecution", environment, log);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference wanted[], size_t n_wanted,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    if (events)
        return no_instance("fmi3InstantiateCoSimulation with eventModeUsed", environment, log);
    Host *host = malloc(sizeof *host);
    if (!host)
        return NULL;
    *host = (Host){environment, log};
    fmi2CallbackFunctions functions = {.logger = tell_host, .componentEnvironment = host};
    fmi3Instance made = fmi2Instantiate(name, fmi2CoSimulation, token, resources, &functions, visible, logging);
    if (!made)
        free(host);
    return made;
}

void fmi3FreeInstance(fmi3Instance c)
{
    void *host = c ? log_of(c)->environment : NULL;
    fmi2FreeInstance(c);
    free(host);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    return (fmi3Status)fmi2SetDebugLogging(c, on, n, categories);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean with_tolerance, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean with_stop, fmi3Float64 stop)
{
    fmi2Status status = fmi2SetupExperiment(c, with_tolerance, tolerance, start, with_stop, stop);
    return (fmi3Status)(status == fmi2OK ? fmi2EnterInitializationMode(c) : status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return (fmi3Status)fmi2ExitInitializationMode(c); }
fmi3Status fmi3Terminate(fmi3Instance c) { return (fmi3Status)fmi2Terminate(c); }
fmi3Status fmi3Reset(fmi3Instance c) { return (fmi3Status)fmi2Reset(c); }

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate,
                      fmi3Boolean *early, fmi3Float64 *last)
{
    const Instance *m = c;
    if (!m)
        return fmi3Error;
    if (!event || !terminate || !early || !last)
        return (fmi3Status)fail(m, "places of what a step tells: must be given. Pass the addresses of all four.");
    fmi2Status status = fmi2DoStep(c, now, step, no_return);
    *event = *terminate = *early = fmi3False;
    *last = m->core.last_time;
    return (fmi3Status)status;
}

/* -- variables */

/* An array for each quantity of the shape's points: its elements are QUANTITIES apart. */
static size_t elements(fmi3ValueReference vr) { return vr >= SHAPE_AT && vr < SHAPE_AT + N_SHAPE ? N_SHAPE / QUANTITIES : 1; }

/* Known variables of a kind, and as many values as they have elements. */
static fmi2Status counted(const Instance *m, const fmi3ValueReference vr[], size_t n, char kind, const void *values, size_t n_values)
{
    size_t wanted = 0;
    if (handed(m, vr, n, values) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        int is_time = kind == 'R' && vr[k] == N_VARIABLES;
        if (!is_time && known(m, vr[k], kind) != fmi2OK)
            return fmi2Error;
        if (elements(vr[k]) > 1 && vr[k] >= SHAPE_AT + QUANTITIES)
            return fail(m, "value reference = %u: must be that of a whole array. Use the references of modelDescription.xml.", vr[k]);
        wanted += elements(vr[k]);
    }
    if (n_values != wanted)
        return fail(m, "values = %zu: must be %zu, as many as the variables have elements. Pass room for all.", n_values, wanted);
    return fmi2OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t n_values)
{
    const Instance *m = c;
    fmi2Status status = counted(m, vr, n, 'R', value, n_values);
    for (size_t k = 0; status == fmi2OK && k < n; k++) {
        if (vr[k] == N_VARIABLES) {
            *value++ = m->core.last_time;
            continue;
        }
        for (size_t i = 0; status == fmi2OK && i < elements(vr[k]); i++) {
            fmi2ValueReference element = vr[k] + QUANTITIES * (fmi2ValueReference)i;
            status = fmi2GetReal(c, &element, 1, value++);
        }
    }
    return (fmi3Status)status;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[], size_t n_values)
{
    if (counted(c, vr, n, 'R', value, n_values) != fmi2OK)
        return fmi3Error;
    for (size_t k = 0; k < n; k++)
        if (vr[k] == N_VARIABLES)
            return (fmi3Status)fail(c, "time: must be left alone: it is the host's. Give it to fmi3DoStep.");
    return (fmi3Status)fmi2SetReal(c, vr, n, value); /* arrays are outputs and refused there: a value a reference */
}

/* A Boolean of FMI 2.0 is an int. */
typedef fmi3Boolean fmi2Bool;
static GETTER(Bool, 'B')
static SETTER(Bool, 'B', value[k])

#define SCALARS(Kind, letter, Old)                                                                                                   \
    fmi3Status fmi3Get##Kind(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##Kind value[], size_t n_values)           \
    {                                                                                                                                \
        fmi2Status status = counted(c, vr, n, letter, value, n_values);                                                              \
        return (fmi3Status)(status == fmi2OK ? fmi2Get##Old(c, vr, n, value) : status);                                              \
    }                                                                                                                                \
    fmi3Status fmi3Set##Kind(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3##Kind value[], size_t n_values)     \
    {                                                                                                                                \
        fmi2Status status = counted(c, vr, n, letter, value, n_values);                                                              \
        return (fmi3Status)(status == fmi2OK ? fmi2Set##Old(c, vr, n, value) : status);                                              \
    }
SCALARS(Int32, 'I', Integer)
SCALARS(Boolean, 'B', Bool)
SCALARS(String, 'S', String)

/* -- states */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) { return (fmi3Status)fmi2GetFMUstate(c, state); }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) { return (fmi3Status)fmi2SetFMUstate(c, state); }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) { return (fmi3Status)fmi2FreeFMUstate(c, state); }

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    return (fmi3Status)fmi2SerializedFMUstateSize(c, state, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte to[], size_t size)
{
    return (fmi3Status)fmi2SerializeFMUstate(c, state, (fmi2Byte *)to, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte from[], size_t size, fmi3FMUState *state)
{
    return (fmi3Status)fmi2DeSerializeFMUstate(c, (const fmi2Byte *)from, size, state);
}
