/* FMI 2.0 for co-simulation around the compiled kernels.  Nothing here knows a model: model.h, which is generated, holds the
   interface table, the rules and the kernels. */
#include <time.h>

#include "component.h"

typedef struct {
    uint64_t size; /* numbers in `state` */
    Core core;
    double state[];
} Saved;

typedef struct {
    char magic[8], guid[40];
    uint64_t checksum;
} Head;

/* -- life of an instance */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)n, (void)categories;
    ((Instance *)c)->logging = on;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *m = c;
    memset(&m->core, 0, sizeof m->core);
    for (int vr = 0; vr < N_VARIABLES; vr++)
        m->core.values[vr] = variables[vr].start;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    Instance caller = {.name = (char *)(name ? name : ""), .logging = logging};
    (void)resources, (void)visible;
    if (!functions)
        return NULL;
    caller.call = *functions;
    const char *wrong = !name || !*name ? "instance name: must not be empty. Give the instance a name." : NULL;
    if (type != fmi2CoSimulation)
        wrong = "type: must be fmi2CoSimulation. This FMU is no model exchange.";
    if (!guid || strcmp(guid, MODEL_GUID) != 0)
        wrong = "GUID: must be " MODEL_GUID ". The library and modelDescription.xml do not belong together.";
    Instance *m = wrong ? NULL : take(&caller, sizeof *m);
    if (!m) {
        fail(&caller, "%s", wrong ? wrong : "memory: must be available. Close something.");
        return NULL;
    }
    *m = caller;
    m->name = take(m, strlen(name) + 1);
    if (!m->name) {
        give_back(&caller, m);
        return NULL;
    }
    strcpy(m->name, name);
    fmi2Reset(m);
    return m;
}

void fmi2FreeInstance(fmi2Component c)
{
    Instance *m = c;
    if (!m)
        return;
    give_back(m, m->state);
    give_back(m, m->name);
    give_back(m, m);
}

static fmi2Status expect(const Instance *m, Phase phase, const char *rule)
{
    return m->core.phase == phase ? fmi2OK : fail(m, "instance = '%s': must be %s", phases[(int)m->core.phase], rule);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean with_stop,
                               fmi2Real stop)
{
    Instance *m = c;
    (void)with_tolerance, (void)tolerance, (void)with_stop, (void)stop;
    if (expect(m, INSTANTIATED, "new. Reset it first.") != fmi2OK)
        return fmi2Error;
    if (!isfinite(start))
        return fail(m, "start time = %.10g s: must be finite. Give the time at which the simulation starts.", isnan(start) ? fabs(start) : start);
    m->core.start_time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *m = c;
    if (expect(m, INSTANTIATED, "new. Reset it first.") != fmi2OK)
        return fmi2Error;
    m->core.phase = INITIALIZING;
    m->core.outdated = 1.0;
    return fmi2OK;
}

/* While initialization lasts, outputs are those of the equilibrium under the values that are set by then. */
static fmi2Status preview(Instance *m)
{
    return m->core.phase == INITIALIZING && m->core.outdated != 0.0 ? initialize(m) : fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *m = c;
    if (expect(m, INITIALIZING, "initializing. Enter the initialization mode first.") != fmi2OK)
        return fmi2Error;
    if (preview(m) != fmi2OK)
        return fmi2Error;
    m->core.phase = RUNNING;
    inform(m, "%s simulates: %s", MODEL_NAME, active_effects(m));
    return fmi2OK;
}

static double processor_time(void)
{
    struct timespec now = {0};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_return)
{
    Instance *m = c;
    double outputs[N_OUTPUTS], begun = processor_time();
    (void)no_return;
    if (expect(m, RUNNING, "initialized and running. Initialize, reset or restore it first.") != fmi2OK)
        return fmi2Error;
    if (!isfinite(now))
        return fail(m, "communication point = %.10g s: must be finite. Give the time at which the step begins.", isnan(now) ? fabs(now) : now);
    if (check_inputs(m, m->core.values) != fmi2OK)
        return fmi2Error;
    if (!isfinite(step) || !(step > 0.0))
        return fail(m, "communication step = %.10g s: must be %s", isnan(step) ? fabs(step) : step, STEP_TEXT);
    int64_t status = run(m, STEP, now, step, m->core.values, outputs);
    if (status != OK) {
        m->core.phase = status == TOO_FAST ? RUNNING : FAILED;
        return report(m, status, now, outputs[0]);
    }
    memcpy(m->core.values + N_INPUTS, outputs, sizeof outputs);
    m->core.last_time = now + step;
    m->core.values[CPU_TIME] += processor_time() - begun;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return fail(c, "step: must not be cancelled: it is never asynchronous. Wait for fmi2DoStep."); }

fmi2Status fmi2Terminate(fmi2Component c)
{
    ((Instance *)c)->core.phase = TERMINATED;
    return fmi2OK;
}

/* -- values */

/* Whether vr is a variable of this kind. */
static fmi2Status known(const Instance *m, fmi2ValueReference vr, char kind)
{
    if (vr < N_VARIABLES && variables[vr].kind == kind)
        return fmi2OK;
    const char *name = kind == 'R' ? "Real" : kind == 'I' ? "Integer" : kind == 'B' ? "Boolean" : "String";
    return fail(m, "value reference = %u: must be of a %s. Use the references of modelDescription.xml.", vr, name);
}

static fmi2Status set(Instance *m, fmi2ValueReference vr, char kind, double value)
{
    if (known(m, vr, kind) != fmi2OK)
        return fmi2Error;
    if (variables[vr].causality == 'p') {
        if (m->core.phase > INITIALIZING)
            return refuse(m, (int)vr, value, "set before the end of initialization. Reset the FMU first.");
    } else if (variables[vr].causality != 'i')
        return refuse(m, (int)vr, value, "left alone: it is calculated. Set inputs and parameters only.");
    m->core.outdated = 1.0;
    m->core.values[vr] = value;
    return fmi2OK;
}

#define GETTER(Kind, letter)                                                                                     \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##Kind value[])       \
    {                                                                                                            \
        Instance *m = c;                                                                                         \
        if (preview(m) != fmi2OK)                                                                                \
            return fmi2Error;                                                                                    \
        for (size_t k = 0; k < n; k++) {                                                                         \
            if (known(m, vr[k], letter) != fmi2OK)                                                               \
                return fmi2Error;                                                                                \
            value[k] = (fmi2##Kind)m->core.values[vr[k]];                                                        \
        }                                                                                                        \
        return fmi2OK;                                                                                           \
    }
#define SETTER(Kind, letter, as_number)                                                                          \
    fmi2Status fmi2Set##Kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2##Kind value[]) \
    {                                                                                                            \
        for (size_t k = 0; k < n; k++)                                                                           \
            if (set(c, vr[k], letter, as_number) != fmi2OK)                                                      \
                return fmi2Error;                                                                                \
        return fmi2OK;                                                                                           \
    }
GETTER(Real, 'R')
GETTER(Integer, 'I')
GETTER(Boolean, 'B')
SETTER(Real, 'R', value[k])
SETTER(Integer, 'I', value[k])
SETTER(Boolean, 'B', value[k] != fmi2False)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
{
    Instance *m = c;
    if (preview(m) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (known(m, vr[k], 'S') != fmi2OK)
            return fmi2Error;
        value[k] = active_effects(m);
    }
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
{
    for (size_t k = 0; k < n; k++)
        if (known(c, vr[k], 'S') == fmi2OK)
            return fail(c, "%s = '%s': must be left alone: it is calculated. Set inputs and parameters only.", variables[vr[k]].name, value[k]);
        else
            return fmi2Error;
    return fmi2OK;
}

/* -- complete state */

static const char magic[8] = "CABLEFM2";

static size_t bytes(const Saved *saved) { return sizeof *saved + saved->size * sizeof(double); }

static uint64_t checksum(const void *data, size_t size) /* FNV-1a */
{
    uint64_t sum = 14695981039346656037u;
    for (const unsigned char *at = data, *end = at + size; at < end; at++)
        sum = (sum ^ *at) * 1099511628211u;
    return sum;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (state) {
        give_back(c, *state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    const Instance *m = c;
    uint64_t size = m->core.initialized != 0.0 ? (uint64_t)m->n_state : 0;
    Saved *saved = take(m, sizeof *saved + size * sizeof(double));
    if (!saved)
        return fail(m, "memory: must be available for the saved state. Free some states.");
    saved->size = size;
    saved->core = m->core;
    if (size > 0)
        memcpy(saved->state, m->state, size * sizeof(double));
    fmi2FreeFMUstate(c, state);
    *state = saved;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Instance *m = c;
    const Saved *saved = state;
    if (!saved)
        return fail(m, "saved state: must not be empty. Save one first.");
    Core before = m->core;
    m->core = saved->core;
    if (saved->size > 0 && (prepare(m) != fmi2OK || (uint64_t)m->n_state != saved->size)) {
        m->core = before;
        m->core.phase = FAILED;
        return fail(m, "saved state = %.0f numbers: must be those of its own parameters. Restore only what the same FMU has saved.",
                    (double)saved->size);
    }
    if (saved->size > 0)
        memcpy(m->state, saved->state, saved->size * sizeof(double));
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    if (!state)
        return fail(c, "saved state: must not be empty. Save one first.");
    *size = sizeof(Head) + bytes(state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte to[], size_t size)
{
    size_t wanted = 0;
    if (fmi2SerializedFMUstateSize(c, state, &wanted) != fmi2OK)
        return fmi2Error;
    if (size < wanted)
        return fail(c, "room for the saved state = %zu bytes: must be at least %zu. Ask fmi2SerializedFMUstateSize.", size, wanted);
    Head head = {.checksum = checksum(state, bytes(state))};
    memcpy(head.magic, magic, sizeof magic);
    strncpy(head.guid, MODEL_GUID, sizeof head.guid - 1);
    memcpy(to, &head, sizeof head);
    memcpy(to + sizeof head, state, bytes(state));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte from[], size_t size, fmi2FMUstate *state)
{
    Head head;
    Saved begin;
    const char *advice = "Restore only what the same FMU has saved.";
    if (size < sizeof head + sizeof begin)
        return fail(c, "saved state = %zu bytes: must be at least %zu. %s", size, sizeof head + sizeof begin, advice);
    memcpy(&head, from, sizeof head);
    memcpy(&begin, from + sizeof head, sizeof begin);
    if (memcmp(head.magic, magic, sizeof magic) != 0 || strncmp(head.guid, MODEL_GUID, sizeof head.guid) != 0)
        return fail(c, "saved state: must be of this build of the FMU. %s", advice);
    if (begin.size > size / sizeof(double) || size != sizeof head + bytes(&begin))
        return fail(c, "saved state = %zu bytes: must be complete. %s", size, advice);
    if (head.checksum != checksum(from + sizeof head, size - sizeof head))
        return fail(c, "saved state: must have its checksum. It was changed; restore only what the same FMU has saved.");
    Saved *saved = take(c, bytes(&begin));
    if (!saved)
        return fail(c, "memory: must be available for the saved state. Free some states.");
    memcpy(saved, from + sizeof head, bytes(&begin));
    fmi2FreeFMUstate(c, state);
    *state = saved;
    return fmi2OK;
}

/* -- what the capability flags leave out */

static fmi2Status absent(fmi2Component c, const char *call)
{
    return fail(c, "%s: must not be called: the capability flags of modelDescription.xml leave it out.", call);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference from[], size_t n_known, const fmi2Real seed[], fmi2Real made[])
{
    (void)unknown, (void)n_unknown, (void)from, (void)n_known, (void)seed, (void)made;
    return absent(c, "fmi2GetDirectionalDerivative");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return absent(c, "fmi2SetRealInputDerivatives");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                        fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return absent(c, "fmi2GetRealOutputDerivatives");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = ((Instance *)c)->core.last_time;
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = ((Instance *)c)->core.phase == TERMINATED;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define NO_STATUS(Kind, type)                                                                  \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2StatusKind kind, type *value)          \
    {                                                                                          \
        (void)c, (void)kind, (void)value;                                                      \
        return fmi2Discard; /* steps are never pending */                                      \
    }
NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(StringStatus, fmi2String)
